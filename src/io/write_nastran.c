/* Nastran's bulk data: GRID, CTETRA with the region as property, CTRIA3 (CTRIA6 of a mesh of second order) with the face tag as
 * property; neither properties nor materials, which the user adds. Numbers count from 1, triangles after the tetrahedra.
 *
 * Coordinates are in the long form, whose fields have 16 characters; elements in the short one, of 8, while their numbers fit.
 * Solids and shells share the numbers of properties: where a tag is also the number of a region, a power of ten above all regions
 * is added to every tag. Names are comments, "$ CTRIA3 13 inlet", by the property. Source: MSC Nastran Quick Reference Guide,
 * "Bulk data entries". */
#include <string.h>

#include "io/tag_order.h"
#include "io/write_mesh.h"
#include "io/write_text.h"

enum { SHORT = 8, LONG = 16, ROW_MAX = 300 };
static const size_t largest_short = 99999999;

typedef struct deck {
  const laves_mesh *mesh;
  bool wide;     /* elements too are in the long form */
  int64_t raise; /* added to tags */
  laves__tag_order regions, tags;
} deck;

/* ---- fields ---- */

static char *pad(char *start, const char *end, int width) {
  memset(start + (end - start), ' ', (size_t)(width - (end - start)));
  return start + width;
}

static char *put_name(char *text, const char *name, bool wide) {
  const size_t length = strlen(name);
  memcpy(text, name, length);
  if (wide) text[length] = '*';
  return pad(text, text + length + wide, SHORT);
}

static char *put_number(char *text, int64_t number, bool wide) {
  return pad(text, laves__put_integer(text, number), wide ? LONG : SHORT);
}

/* A card of integers; the long form has four of them a line, the short one eight. */
static char *put_card(char *text, const char *name, const int64_t *numbers, int count, bool wide) {
  text = put_name(text, name, wide);
  for (int i = 0; i < count; i++) {
    if (i > 0 && i % (wide ? 4 : 8) == 0) {
      *text++ = '\n';
      text = put_name(text, wide ? "" : "+", wide);
    }
    text = put_number(text, numbers[i], wide);
  }
  *text++ = '\n';
  return text;
}

static size_t put_points(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    text = put_number(put_name(text, "GRID", true), (int64_t)i + 1, true);
    text = pad(text, text, LONG); /* coordinates are in the basic system */
    for (int axis = 0; axis < 3; axis++) {
      if (axis == 2) {
        *text++ = '\n';
        text = put_name(text, "", true);
      }
      text = pad(text, laves__put_double_field(text, v3_at(mesh->points[i], axis), LONG), LONG);
    }
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

/* ---- elements ---- */

static const char *triangle_card(const deck *d) { return d->mesh->quadratic ? "CTRIA6" : "CTRIA3"; }

static int64_t number_of(const laves__tag_order *order, const int32_t *tags, size_t i) {
  if (!tags) return 1;
  if (order->tags[0] > 0) return tags[i];
  size_t low = 0, high = order->count; /* the place of the tag */
  while (high - low > 1) {
    const size_t middle = low + (high - low) / 2;
    if (order->tags[middle] <= tags[i])
      low = middle;
    else
      high = middle;
  }
  return (int64_t)low + 1;
}

static size_t put_tets(const void *user, size_t begin, size_t end, char *bytes) {
  const deck *d = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    const int32_t *t = laves__tet_nodes(d->mesh, i);
    const int width = laves__tet_width(d->mesh);
    int64_t card[2 + 10] = {(int64_t)i + 1, number_of(&d->regions, d->mesh->regions, i)};
    for (int j = 0; j < width; j++) card[2 + j] = t[j] + INT64_C(1);
    text = put_card(text, "CTETRA", card, 2 + width, d->wide);
  }
  return (size_t)(text - bytes);
}

static size_t put_faces(const void *user, size_t begin, size_t end, char *bytes) {
  const deck *d = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    const int32_t *f = laves__face_nodes(d->mesh, i);
    const int width = laves__face_width(d->mesh);
    int64_t card[2 + 6] = {(int64_t)(d->mesh->tet_count + i) + 1, number_of(&d->tags, d->mesh->face_tags, i) + d->raise};
    for (int j = 0; j < width; j++) card[2 + j] = f[j] + INT64_C(1);
    text = put_card(text, triangle_card(d), card, 2 + width, d->wide);
  }
  return (size_t)(text - bytes);
}

/* ---- the file ---- */

/* Whether a tag and a region have one number; both orders are ascending. */
static bool numbers_meet(const deck *d) {
  for (size_t i = 0, j = 0; i < d->regions.count && j < d->tags.count;) {
    const int32_t region = laves__tag_number(&d->regions, i), tag = laves__tag_number(&d->tags, j);
    if (region == tag) return true;
    *(region < tag ? &i : &j) += 1;
  }
  return false;
}

static void number_properties(deck *d) {
  const int64_t last_region = laves__tag_number(&d->regions, d->regions.count - 1);
  const int64_t last_tag = laves__tag_number(&d->tags, d->tags.count - 1);
  if (numbers_meet(d))
    for (d->raise = 10; d->raise <= last_region;) d->raise *= 10;
  const int64_t last_property = last_tag + d->raise > last_region ? last_tag + d->raise : last_region;
  const size_t last_element = d->mesh->tet_count + d->mesh->face_count;
  d->wide = last_element > largest_short || d->mesh->vertex_count > largest_short || (size_t)last_property > largest_short;
}

static void write_names(laves__output *out, const deck *d, int dimension, const laves__tag_order *order, const char *card) {
  for (size_t i = 0; i < order->count; i++) {
    char name[LAVES__TAG_NAME_MAX];
    laves__tag_name(d->mesh, dimension, order, i, name);
    laves__output_printf(out, "$ %s %lld %s\n", card, (long long)laves__tag_number(order, i) + (dimension == 2 ? d->raise : 0),
                         name);
  }
}

void laves__write_nastran(laves__output *out, const laves_mesh *mesh) {
  deck d = {.mesh = mesh};
  if (!laves__tag_order_make(out->context, mesh->regions, mesh->tet_count, &d.regions) ||
      !laves__tag_order_make(out->context, mesh->face_tags, mesh->face_count, &d.tags)) {
    laves__output_fail_memory(out);
    laves__tag_order_free(out->context, &d.regions);
    return;
  }
  number_properties(&d);
  out->expected = 83.0 * (double)mesh->vertex_count + 57.0 * (double)mesh->tet_count + 49.0 * (double)mesh->face_count;
  laves__output_printf(out, "$ %zu vertices, %zu tetrahedra\n", mesh->vertex_count, mesh->tet_count);
  write_names(out, &d, 3, &d.regions, "CTETRA");
  if (mesh->face_count > 0) write_names(out, &d, 2, &d.tags, triangle_card(&d));
  laves__output_printf(out, "BEGIN BULK\n");
  laves__output_items(out, mesh->vertex_count, ROW_MAX, put_points, mesh);
  laves__output_items(out, mesh->tet_count, ROW_MAX, put_tets, &d);
  laves__output_items(out, mesh->face_count, ROW_MAX, put_faces, &d);
  laves__output_printf(out, "ENDDATA\n");
  laves__tag_order_free(out->context, &d.regions);
  laves__tag_order_free(out->context, &d.tags);
}
