/* Abaqus's input file, as CalculiX reads it too: the mesh without materials, steps and loads, which the user adds.
 *
 *   *NODE, NSET=Nall                  all vertices
 *   *ELEMENT, TYPE=C3D4, ELSET=core   the tetrahedra of a region; C3D10 of a mesh of second order
 *   *NSET, NSET=inlet                 the vertices of a face tag
 *   *ELSET, ELSET=inlet_S1            the tetrahedra whose first face has the tag, for S1 .. S4
 *   *SURFACE, NAME=inlet              the faces of the tag
 *
 * Numbers count from 1 and are those of the mesh: elements stand in blocks of one region. Real numbers take 20 characters at
 * most, all that the format reads. Abaqus's face S1 is opposite the fourth corner, S2 the third, S3 the first and S4 the second.
 * Source: Abaqus documentation, "Input syntax rules" and "Three-dimensional solid element library". */
#include "io/boundary_sets.h"
#include "io/write_mesh.h"
#include "io/write_text.h"

enum { REAL_WIDTH = 20, PER_LINE = 16, SIDES = 4 };
static const char side_of_corner[4] = {2, 3, 1, 0}; /* S3, S4, S2, S1 */

static char *put_comma(char *text) {
  *text++ = ',';
  *text++ = ' ';
  return text;
}

static size_t put_nodes(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    text = laves__put_integer(text, (int64_t)i + 1);
    for (int axis = 0; axis < 3; axis++)
      text = laves__put_double_field(put_comma(text), v3_at(mesh->points[i], axis), REAL_WIDTH);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

/* ---- lists ---- */

/* The elements of one region, or a list of numbers from 0. */
typedef struct elements {
  const laves_mesh *mesh;
  const laves__tag_order *order;
  size_t first;
} elements;

static size_t put_elements(const void *user, size_t begin, size_t end, char *bytes) {
  const elements *e = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    const size_t tet = laves__tag_order_item(e->order, e->first + i);
    text = laves__put_integer(text, (int64_t)tet + 1);
    const int32_t *nodes = laves__tet_nodes(e->mesh, tet);
    for (int j = 0; j < laves__tet_width(e->mesh); j++) text = laves__put_integer(put_comma(text), (int64_t)nodes[j] + 1);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

typedef struct list {
  const int32_t *numbers;
  size_t count;
} list;

static size_t put_list(const void *user, size_t begin, size_t end, char *bytes) {
  const list *l = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    text = laves__put_integer(text, (int64_t)l->numbers[i] + 1);
    if (i % PER_LINE == PER_LINE - 1 || i + 1 == l->count)
      *text++ = '\n';
    else
      text = put_comma(text);
  }
  return (size_t)(text - bytes);
}

static void write_list(laves__output *out, const int32_t *numbers, size_t count) {
  const list l = {numbers, count};
  laves__output_items(out, count, LAVES__INTEGER_TEXT_MAX + 2, put_list, &l);
}

/* ---- the file ---- */

static void write_regions(laves__output *out, const laves_mesh *mesh, const laves__tag_order *order, laves__label *labels) {
  for (size_t i = 0; i < order->count; i++) {
    const elements e = {mesh, order, order->first[i]};
    laves__output_printf(out, "*ELEMENT, TYPE=%s, ELSET=%s\n", mesh->quadratic ? "C3D10" : "C3D4", labels[i]);
    laves__output_items(out, order->first[i + 1] - order->first[i], 11 * (LAVES__INTEGER_TEXT_MAX + 2), put_elements, &e);
  }
}

/* The tetrahedra of each tag by the side that has it, in one list; first[4 * tag + side] tells where each begins. */
static void list_sides(const laves__boundary_sets *sets, int32_t *tets, size_t *first) {
  size_t count = 0;
  for (size_t tag = 0; tag < sets->tags.count; tag++)
    for (int side = 0; side < SIDES; side++) {
      first[SIDES * tag + (size_t)side] = count;
      for (size_t i = sets->tags.first[tag]; i < sets->tags.first[tag + 1]; i++) {
        const uint64_t slot = sets->sides[laves__tag_order_item(&sets->tags, i)];
        if (side_of_corner[slot % 4] == side) tets[count++] = (int32_t)(slot / 4);
      }
    }
  first[SIDES * sets->tags.count] = count;
}

static void write_tag(laves__output *out, const laves__boundary_sets *sets, size_t tag, const char *label, const int32_t *tets,
                      const size_t *first) {
  laves__output_printf(out, "*NSET, NSET=%s\n", label);
  write_list(out, sets->vertices + sets->first[tag], sets->first[tag + 1] - sets->first[tag]);
  for (int side = 0; side < SIDES; side++) {
    if (first[side + 1] == first[side]) continue;
    laves__output_printf(out, "*ELSET, ELSET=%s_S%d\n", label, side + 1);
    write_list(out, tets + first[side], first[side + 1] - first[side]);
  }
  laves__output_printf(out, "*SURFACE, NAME=%s, TYPE=ELEMENT\n", label);
  for (int side = 0; side < SIDES; side++)
    if (first[side + 1] > first[side]) laves__output_printf(out, "%s_S%d, S%d\n", label, side + 1, side + 1);
}

static void write_boundary(laves__output *out, const laves_mesh *mesh) {
  laves__boundary_sets sets;
  if (!laves__boundary_sets_make(out, mesh, &sets)) return;
  const size_t tags = sets.tags.count;
  laves__label *labels = laves__labels_make(out->context, mesh, 2, &sets.tags);
  int32_t *tets = laves__alloc(out->context, mesh->face_count, sizeof *tets);
  size_t *first = laves__alloc(out->context, SIDES * tags + 1, sizeof *first);
  if (labels && tets && first) {
    list_sides(&sets, tets, first);
    for (size_t tag = 0; tag < tags && out->error.result == LAVES_OK && mesh->face_count > 0; tag++)
      write_tag(out, &sets, tag, labels[tag], tets, first + SIDES * tag);
  } else {
    laves__output_fail_memory(out);
  }
  laves__free(out->context, first, SIDES * tags + 1, sizeof *first);
  laves__free(out->context, tets, mesh->face_count, sizeof *tets);
  laves__free(out->context, labels, tags, sizeof *labels);
  laves__boundary_sets_free(out->context, mesh, &sets);
}

void laves__write_abaqus(laves__output *out, const laves_mesh *mesh) {
  if (mesh->tet_count > INT32_MAX) {
    laves__output_fail(out, LAVES_ERROR_WRITE, "an Abaqus file holds at most 2147483647 tetrahedra; choose VTU");
    return;
  }
  laves__tag_order order;
  laves__label *labels = NULL;
  if (!laves__tag_order_make(out->context, mesh->regions, mesh->tet_count, &order)) {
    laves__output_fail_memory(out);
    return;
  }
  out->expected = 68.0 * (double)mesh->vertex_count + 42.0 * (double)mesh->tet_count + 16.0 * (double)mesh->face_count;
  labels = laves__labels_make(out->context, mesh, 3, &order);
  if (!labels) laves__output_fail_memory(out);
  laves__output_printf(out, "*HEADING\n%zu vertices, %zu tetrahedra\n*NODE, NSET=Nall\n", mesh->vertex_count, mesh->tet_count);
  laves__output_items(out, mesh->vertex_count, LAVES__INTEGER_TEXT_MAX + 3 * (REAL_WIDTH + 2) + 1, put_nodes, mesh);
  if (out->error.result == LAVES_OK) write_regions(out, mesh, &order, labels);
  laves__free(out->context, labels, order.count, sizeof *labels);
  laves__tag_order_free(out->context, &order);
  if (out->error.result == LAVES_OK) write_boundary(out, mesh);
}
