/* What a mesh file holds, and the mesh made from that.
 *
 * Triangles are matched with boundary faces by sorting them by their corners: n log n whatever the file holds. */
#include "io/mesh_input.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GROUPS_MAX = 1 << 16 }; /* names beyond are ignored; looking one up is linear */

bool laves__mesh_input_add_point(laves__mesh_input *input, laves__vec3 point) {
  const size_t needed = input->point_count + 1;
  if (!laves__grow(input->context, &input->points, &input->point_capacity, needed, sizeof *input->points)) return false;
  input->points[input->point_count++] = point;
  return true;
}

bool laves__mesh_input_add_tet(laves__mesh_input *input, const int32_t corners[4], int32_t region) {
  const size_t needed = input->tet_count + 1;
  if (!laves__grow(input->context, &input->tets, &input->tet_capacity, needed, sizeof *input->tets) ||
      !laves__grow(input->context, &input->regions, &input->region_capacity, needed, sizeof *input->regions))
    return false;
  memcpy(input->tets[input->tet_count], corners, sizeof *input->tets);
  input->regions[input->tet_count++] = region;
  return true;
}

bool laves__mesh_input_add_face(laves__mesh_input *input, const int32_t corners[3], int32_t tag) {
  const size_t needed = input->face_count + 1;
  if (!laves__grow(input->context, &input->faces, &input->face_capacity, needed, sizeof *input->faces) ||
      !laves__grow(input->context, &input->face_tags, &input->face_tag_capacity, needed, sizeof *input->face_tags))
    return false;
  memcpy(input->faces[input->face_count], corners, sizeof *input->faces);
  input->face_tags[input->face_count++] = tag;
  return true;
}

bool laves__mesh_input_add_value(laves__mesh_input *input, double value) {
  laves__mesh_values *values = &input->values;
  if (!laves__grow(input->context, &values->items, &values->capacity, values->count + 1, sizeof *values->items)) return false;
  values->items[values->count++] = value;
  return true;
}

bool laves__mesh_input_add_group(laves__mesh_input *input, int dimension, int32_t tag, const char *name, size_t length) {
  if (input->group_count == GROUPS_MAX) return true;
  if (!laves__grow(input->context, &input->groups, &input->group_capacity, input->group_count + 1, sizeof *input->groups))
    return false;
  laves__group *group = &input->groups[input->group_count++];
  group->dimension = dimension;
  group->tag = tag;
  snprintf(group->name, sizeof group->name, "%.*s", (int)(length < sizeof group->name ? length : sizeof group->name), name);
  return true;
}

bool laves__mesh_input_mentions(const laves__mesh_input *input, const char *text) {
  enum { LOOK = 4096 };
  const size_t available = (size_t)(input->end - input->begin), length = strlen(text);
  for (size_t i = 0; i < LOOK && i + length <= available; i++)
    if (memcmp(input->begin + i, text, length) == 0) return true;
  return false;
}

bool laves__mesh_input_cancelled(const laves__mesh_input *input, const char *at) {
  const double length = (double)(input->end - input->begin);
  return laves__cancelled(input->context, "read", length > 0 ? (double)(at - input->begin) / length : 1);
}

laves_result laves__mesh_input_fail(const laves__mesh_input *input, laves_error *error, const char *format, ...) {
  char sentence[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  return laves__fail(error, LAVES_ERROR_INPUT, "%s: %s", input->name, sentence);
}

/* ---- choosing an array ---- */

static bool same_name(laves__word a, laves__word b) { return a.length == b.length && memcmp(a.at, b.at, a.length) == 0; }

/* The first with this name; count: none. */
static size_t find_name(const laves__word *names, size_t count, laves__word name) {
  size_t i = 0;
  while (i < count && !same_name(names[i], name)) i++;
  return i;
}

/* "'a', 'b', 'c'", each name once, cut when long. */
static void list_names(const laves__word *names, size_t count, char *text, size_t size) {
  enum { LISTED_MAX = 8, LOOKED_AT_MAX = 1000 }; /* looking is quadratic */
  size_t used = 0, listed = 0;
  count = count < LOOKED_AT_MAX ? count : LOOKED_AT_MAX;
  text[0] = 0;
  for (size_t i = 0; i < count && listed <= LISTED_MAX && used < size; i++) {
    if (find_name(names, i, names[i]) < i) continue;
    char quote[LAVES__QUOTE_SIZE];
    if (listed++ < LISTED_MAX)
      used += (size_t)snprintf(text + used, size - used, "%s'%s'", used ? ", " : "", laves__quote(names[i], quote));
    else
      snprintf(text + used, size - used, ", ...");
  }
}

laves_result laves__mesh_input_choose_array(const laves__mesh_input *input, const laves__word *names, size_t count,
                                            size_t *chosen, laves_error *error) {
  const char *wanted = input->values.array;
  if (count == 0) return laves__mesh_input_fail(input, error, "there is no array in it with one number for each point or tet");
  bool only = wanted == NULL;
  for (size_t i = 1; i < count && only; i++) only = same_name(names[i], names[0]);
  const char *name = wanted ? wanted : "size";
  *chosen = only ? 0 : find_name(names, count, (laves__word){name, strlen(name)});
  if (*chosen < count) return LAVES_OK;
  char list[220], quote[LAVES__QUOTE_SIZE];
  list_names(names, count, list, sizeof list);
  if (!wanted) return laves__mesh_input_fail(input, error, "it has several arrays; name one of %s", list);
  return laves__mesh_input_fail(input, error, "it has no array '%s'; its arrays are %s",
                                laves__quote((laves__word){wanted, strlen(wanted)}, quote), list);
}

void laves__mesh_input_free(laves__mesh_input *input) {
  laves_context *context = input->context;
  laves__free(context, input->points, input->point_capacity, sizeof *input->points);
  laves__free(context, input->tets, input->tet_capacity, sizeof *input->tets);
  laves__free(context, input->regions, input->region_capacity, sizeof *input->regions);
  laves__free(context, input->faces, input->face_capacity, sizeof *input->faces);
  laves__free(context, input->face_tags, input->face_tag_capacity, sizeof *input->face_tags);
  laves__free(context, input->face_elements, input->face_element_capacity, sizeof *input->face_elements);
  laves__free(context, input->values.items, input->values.capacity, sizeof *input->values.items);
  laves__free(context, input->groups, input->group_capacity, sizeof *input->groups);
  memset(input, 0, sizeof *input);
}

/* ---- making the mesh ---- */

static laves_result check_corners(const laves__mesh_input *input, const char *what, const int32_t *corners, size_t count,
                                  int per_item, laves_error *error) {
  const size_t all = count * (size_t)per_item;
  for (size_t i = 0; i < all; i++) {
    if (laves__cancelled_at(input->context, "read", i, all)) return laves__fail_cancelled(error);
    if (corners[i] < 0 || (size_t)corners[i] >= input->point_count)
      return laves__mesh_input_fail(input, error, "%s %zu uses vertex %ld, but there are %zu (counted from 1)", what,
                                    i / (size_t)per_item + 1, (long)corners[i] + 1, input->point_count);
  }
  return LAVES_OK;
}

laves_result laves__mesh_input_check(const laves__mesh_input *input, laves_error *error) {
  if (input->tet_count == 0) return laves__mesh_input_fail(input, error, "there are no tetrahedra in it");
  if (input->point_count > INT32_MAX) return laves__mesh_input_fail(input, error, "it has more than 2147483647 vertices");
  for (size_t i = 0; i < input->point_count; i++)
    if (!v3_finite(input->points[i]))
      return laves__mesh_input_fail(input, error, "vertex %zu (counted from 1) has a coordinate that is not finite", i + 1);
  const laves_result result = check_corners(input, "tetrahedron", *input->tets, input->tet_count, 4, error);
  if (result != LAVES_OK || input->face_count == 0) return result;
  return check_corners(input, "triangle", *input->faces, input->face_count, 3, error);
}

/* Leaves only vertices that are corners of tets; triangles with other vertices are dropped, as they can't be boundary. */
static bool drop_unused(laves__mesh_input *input) {
  int32_t *places = laves__alloc_zeroed(input->context, input->point_count, sizeof *places);
  if (!places) return false;
  int32_t *corners = *input->tets;
  for (size_t i = 0; i < 4 * input->tet_count; i++) places[corners[i]] = 1;
  int32_t kept = 0;
  for (size_t i = 0; i < input->point_count; i++) {
    if (places[i]) input->points[kept] = input->points[i];
    places[i] = places[i] ? kept++ : -1;
  }
  for (size_t i = 0; i < 4 * input->tet_count; i++) corners[i] = places[corners[i]];
  size_t faces = 0;
  for (size_t i = 0; i < input->face_count; i++) {
    const int32_t *f = input->faces[i];
    const int32_t renamed[3] = {places[f[0]], places[f[1]], places[f[2]]};
    if (renamed[0] < 0 || renamed[1] < 0 || renamed[2] < 0) continue;
    memcpy(input->faces[faces], renamed, sizeof renamed);
    input->face_tags[faces++] = input->face_tags[i];
  }
  laves__free(input->context, places, input->point_count, sizeof *places);
  input->point_count = (size_t)kept;
  input->face_count = faces;
  return true;
}

static void turn_if_all_negative(laves__mesh_input *input) {
  size_t negative = 0;
  for (size_t i = 0; i < input->tet_count && !laves__cancelled_at(input->context, "read", i, input->tet_count); i++) {
    const int32_t *t = input->tets[i];
    const double det = v3_det(input->points[t[0]], input->points[t[1]], input->points[t[2]], input->points[t[3]]);
    if (det > 0) return;
    negative += det < 0;
  }
  for (size_t i = 0; i < input->tet_count && negative > 0; i++) {
    int32_t *t = input->tets[i];
    const int32_t swapped = t[2];
    t[2] = t[3];
    t[3] = swapped;
  }
}

static bool all_one(const int32_t *values, size_t count) {
  for (size_t i = 0; i < count; i++)
    if (values[i] != 1) return false;
  return true;
}

typedef struct tagged_face {
  int32_t corners[3]; /* ascending */
  int32_t tag;
  size_t index;
} tagged_face;

static tagged_face make_tagged_face(const int32_t corners[3], int32_t tag, size_t index) {
  int32_t a = corners[0], b = corners[1], c = corners[2], swapped;
  if (a > b) swapped = a, a = b, b = swapped;
  if (b > c) swapped = b, b = c, c = swapped;
  if (a > b) swapped = a, a = b, b = swapped;
  return (tagged_face){{a, b, c}, tag, index};
}

static int compare_corners(const tagged_face *a, const tagged_face *b) {
  for (int i = 0; i < 3; i++)
    if (a->corners[i] != b->corners[i]) return a->corners[i] < b->corners[i] ? -1 : 1;
  return 0;
}

/* By corners, then by place in the file, so that the order does not depend on the sort. */
static int compare_faces(const void *a, const void *b) {
  const tagged_face *x = a, *y = b;
  const int order = compare_corners(x, y);
  return order ? order : (x->index > y->index) - (x->index < y->index);
}

/* The first with these corners, or NULL. */
static const tagged_face *find_face(const tagged_face *faces, size_t count, const tagged_face *wanted) {
  size_t low = 0, high = count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (compare_corners(&faces[middle], wanted) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && compare_corners(&faces[low], wanted) == 0 ? &faces[low] : NULL;
}

static bool transfer_tags(const laves__mesh_input *input, laves_mesh *mesh) {
  if (input->face_count == 0) return true;
  tagged_face *known = laves__alloc(input->context, input->face_count, sizeof *known);
  int32_t *tags = laves__alloc(input->context, mesh->face_count, sizeof *tags);
  if (known && tags) {
    for (size_t i = 0; i < input->face_count; i++) known[i] = make_tagged_face(input->faces[i], input->face_tags[i], i);
    qsort(known, input->face_count, sizeof *known, compare_faces);
    for (size_t i = 0; i < mesh->face_count && !laves__cancelled_at(input->context, "read", i, mesh->face_count); i++) {
      const tagged_face wanted = make_tagged_face(mesh->faces[i], 0, 0);
      const tagged_face *found = find_face(known, input->face_count, &wanted);
      tags[i] = found ? found->tag : 0;
    }
  }
  const bool done = known && tags && !laves__is_cancelled(input->context);
  laves__free(input->context, known, input->face_count, sizeof *known);
  if (done && !all_one(tags, mesh->face_count)) {
    mesh->face_tags = tags;
    return true;
  }
  laves__free(input->context, tags, mesh->face_count, sizeof *tags);
  return done;
}

laves_result laves__mesh_input_finish(laves__mesh_input *input, laves_mesh **mesh, laves_error *error) {
  laves_result result = laves__mesh_input_check(input, error);
  if (result != LAVES_OK) return result;
  if (input->higher_order && !drop_unused(input)) return laves__fail_memory(input->context, error);
  turn_if_all_negative(input);
  if (laves__is_cancelled(input->context)) return laves__fail_cancelled(error);
  const int32_t *regions = all_one(input->regions, input->tet_count) ? NULL : input->regions;
  laves_mesh *made = NULL;
  result = laves_mesh_from_arrays(input->context, &input->points->x, input->point_count, *input->tets, input->tet_count, regions,
                                  &made, error);
  if (result != LAVES_OK) return result;
  bool enough = transfer_tags(input, made);
  for (size_t i = 0; i < input->group_count && enough; i++) {
    const laves__group *group = &input->groups[i];
    enough = laves__mesh_add_group(made, group->dimension, group->tag, group->name);
  }
  if (!enough) {
    laves_mesh_free(made);
    return laves__fail_memory(input->context, error);
  }
  *mesh = made;
  return LAVES_OK;
}
