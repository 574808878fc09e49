/* Exodus II, in a classic NetCDF file: each region is a block of elements, each face tag a side set and a node set, with names;
 * their ids are the numbers of regions and tags, or 1, 2, ... where one of them is not positive. Elements stand in the order of
 * their blocks; elem_num_map tells their numbers in the mesh, from 1.
 *
 * Side 1 of a tetrahedron is opposite the third corner, side 2 the first, side 3 the second and side 4 the fourth.
 * Source: Schoof and Yarberry, "EXODUS II: A Finite Element Data Model", SAND92-2137, 1994, and its update of 2018. */
#include <string.h>

#include "io/big_endian.h"
#include "io/boundary_sets.h"
#include "io/netcdf_file.h"
#include "io/write_mesh.h"

enum { NAME_BYTES = LAVES__TAG_NAME_MAX, LINE_BYTES = 81, STRING_BYTES = 33 };
static const uint32_t side_of_corner[4] = {2, 3, 1, 4};

/* One group of elements or sides and what it belongs to: what the writers of arrays get. */
typedef struct set {
  const struct model *model;
  size_t index;
} set;

typedef struct model {
  const laves_mesh *mesh;
  laves__tag_order regions;
  laves__boundary_sets boundary;
  int32_t *places; /* [tet_count] where each tet stands in the file, or NULL: as in the mesh */
  set *sets;       /* [the larger number of groups] */
  size_t set_count;
} model;

static size_t put_int(char *bytes, int64_t value) {
  laves__put_big32(bytes, (uint32_t)value);
  return 4;
}

/* ---- coordinates ---- */

static size_t pack_axis(const laves_mesh *mesh, int axis, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++, bytes += 8) laves__put_big_double(bytes, v3_at(mesh->points[i], axis));
  return (end - begin) * 8;
}

static size_t pack_x(const void *user, size_t begin, size_t end, char *bytes) { return pack_axis(user, 0, begin, end, bytes); }
static size_t pack_y(const void *user, size_t begin, size_t end, char *bytes) { return pack_axis(user, 1, begin, end, bytes); }
static size_t pack_z(const void *user, size_t begin, size_t end, char *bytes) { return pack_axis(user, 2, begin, end, bytes); }

static size_t pack_axis_names(const void *user, size_t begin, size_t end, char *bytes) {
  (void)user;
  memset(bytes, 0, (end - begin) * NAME_BYTES);
  for (size_t i = begin; i < end; i++) bytes[(i - begin) * NAME_BYTES] = (char)('x' + i);
  return (end - begin) * NAME_BYTES;
}

/* ---- groups ---- */

static size_t pack_ones(const void *user, size_t begin, size_t end, char *bytes) {
  (void)user;
  for (size_t i = begin; i < end; i++) bytes += put_int(bytes, 1);
  return (end - begin) * 4;
}

static size_t pack_ids(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) bytes += put_int(bytes, laves__tag_number(user, i));
  return (end - begin) * 4;
}

static size_t pack_names(const model *m, int dimension, const laves__tag_order *order, size_t begin, size_t end, char *bytes) {
  memset(bytes, 0, (end - begin) * NAME_BYTES);
  for (size_t i = begin; i < end; i++) laves__tag_name(m->mesh, dimension, order, i, bytes + (i - begin) * NAME_BYTES);
  for (char *c = bytes; c < bytes + (end - begin) * NAME_BYTES; c += NAME_BYTES) {
    const size_t length = strlen(c);
    memset(c + length, 0, NAME_BYTES - length);
  }
  return (end - begin) * NAME_BYTES;
}

static size_t pack_block_names(const void *user, size_t begin, size_t end, char *bytes) {
  const model *m = user;
  return pack_names(m, 3, &m->regions, begin, end, bytes);
}

static size_t pack_set_names(const void *user, size_t begin, size_t end, char *bytes) {
  const model *m = user;
  return pack_names(m, 2, &m->boundary.tags, begin, end, bytes);
}

static size_t pack_block(const void *user, size_t begin, size_t end, char *bytes) {
  const set *s = user;
  const model *m = s->model;
  const int width = laves__tet_width(m->mesh);
  for (size_t i = begin; i < end; i++) {
    const int32_t *t = laves__tet_nodes(m->mesh, laves__tag_order_item(&m->regions, m->regions.first[s->index] + i));
    for (int j = 0; j < width; j++) bytes += put_int(bytes, (int64_t)t[j] + 1);
  }
  return (end - begin) * 4 * (size_t)width;
}

static size_t pack_numbers(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) bytes += put_int(bytes, (int64_t)laves__tag_order_item(user, i) + 1);
  return (end - begin) * 4;
}

/* The side that is number i of a set: 4 * tet + corner. */
static uint64_t side_at(const set *s, size_t i) {
  const laves__boundary_sets *b = &s->model->boundary;
  return b->sides[laves__tag_order_item(&b->tags, b->tags.first[s->index] + i)];
}

static size_t pack_side_elements(const void *user, size_t begin, size_t end, char *bytes) {
  const set *s = user;
  const int32_t *places = s->model->places;
  for (size_t i = begin; i < end; i++) {
    const size_t tet = (size_t)(side_at(s, i) / 4);
    bytes += put_int(bytes, (places ? (int64_t)places[tet] : (int64_t)tet) + 1);
  }
  return (end - begin) * 4;
}

static size_t pack_sides(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) bytes += put_int(bytes, side_of_corner[side_at(user, i) % 4]);
  return (end - begin) * 4;
}

static size_t pack_nodes(const void *user, size_t begin, size_t end, char *bytes) {
  const set *s = user;
  const laves__boundary_sets *b = &s->model->boundary;
  for (size_t i = begin; i < end; i++) bytes += put_int(bytes, (int64_t)b->vertices[b->first[s->index] + i] + 1);
  return (end - begin) * 4;
}

/* ---- the file ---- */

static laves__netcdf_attribute no_attribute(void) { return (laves__netcdf_attribute){.name = NULL}; }

/* Status, ids and names of the groups of one kind. */
static void add_groups(laves__netcdf_file *file, const model *m, const laves__tag_order *order, int count, int name_bytes,
                       const char *const names[3], laves__output_items_fn *pack) {
  const laves__netcdf_attribute id = {.name = "name", .text = "ID"};
  laves__netcdf_add_variable(file, names[0], 0, LAVES__NETCDF_INT, count, -1, no_attribute(), pack_ones, NULL);
  laves__netcdf_add_variable(file, names[1], 0, LAVES__NETCDF_INT, count, -1, id, pack_ids, order);
  laves__netcdf_add_variable(file, names[2], 0, LAVES__NETCDF_CHAR, count, name_bytes, no_attribute(), pack, m);
}

static void add_blocks(laves__netcdf_file *file, const model *m, int elements, int name_bytes) {
  static const char *const names[] = {"eb_status", "eb_prop1", "eb_names"};
  const laves__netcdf_attribute type = {.name = "elem_type", .text = m->mesh->quadratic ? "TETRA10" : "TETRA"};
  const laves__tag_order *order = &m->regions;
  const int blocks = laves__netcdf_add_dimension(file, "num_el_blk", 0, order->count);
  add_groups(file, m, order, blocks, name_bytes, names, pack_block_names);
  if (order->order)
    laves__netcdf_add_variable(file, "elem_num_map", 0, LAVES__NETCDF_INT, elements, -1, no_attribute(), pack_numbers, order);
  for (size_t i = 0; i < order->count; i++) {
    const int count = laves__netcdf_add_dimension(file, "num_el_in_blk", i + 1, order->first[i + 1] - order->first[i]);
    const int corners = laves__netcdf_add_dimension(file, "num_nod_per_el", i + 1, (uint64_t)laves__tet_width(m->mesh));
    laves__netcdf_add_variable(file, "connect", i + 1, LAVES__NETCDF_INT, count, corners, type, pack_block, &m->sets[i]);
  }
}

static void add_boundary(laves__netcdf_file *file, const model *m, int name_bytes) {
  static const char *const side_names[] = {"ss_status", "ss_prop1", "ss_names"};
  static const char *const node_names[] = {"ns_status", "ns_prop1", "ns_names"};
  const laves__boundary_sets *b = &m->boundary;
  const int side_sets = laves__netcdf_add_dimension(file, "num_side_sets", 0, b->tags.count);
  const int node_sets = laves__netcdf_add_dimension(file, "num_node_sets", 0, b->tags.count);
  add_groups(file, m, &b->tags, side_sets, name_bytes, side_names, pack_set_names);
  add_groups(file, m, &b->tags, node_sets, name_bytes, node_names, pack_set_names);
  for (size_t i = 0; i < b->tags.count; i++) {
    const int sides = laves__netcdf_add_dimension(file, "num_side_ss", i + 1, b->tags.first[i + 1] - b->tags.first[i]);
    const int nodes = laves__netcdf_add_dimension(file, "num_nod_ns", i + 1, b->first[i + 1] - b->first[i]);
    const set *s = &m->sets[i];
    laves__netcdf_add_variable(file, "elem_ss", i + 1, LAVES__NETCDF_INT, sides, -1, no_attribute(), pack_side_elements, s);
    laves__netcdf_add_variable(file, "side_ss", i + 1, LAVES__NETCDF_INT, sides, -1, no_attribute(), pack_sides, s);
    laves__netcdf_add_variable(file, "node_ns", i + 1, LAVES__NETCDF_INT, nodes, -1, no_attribute(), pack_nodes, s);
  }
}

static void write_file(laves__output *out, const model *m) {
  static const laves__netcdf_attribute globals[] = {
      {.name = "api_version", .real = 5.22f, .is_real = true},
      {.name = "version", .real = 5.22f, .is_real = true},
      {.name = "floating_point_word_size", .integer = 8},
      {.name = "file_size", .integer = 1},
      {.name = "maximum_name_length", .integer = NAME_BYTES - 1},
      {.name = "int64_status", .integer = 0},
      {.name = "title", .text = "tetrahedral mesh"},
  };
  laves__netcdf_file file;
  laves__netcdf_begin(&file, out);
  for (size_t i = 0; i < LAVES__COUNT_OF(globals); i++) laves__netcdf_global(&file, globals[i]);
  laves__netcdf_add_dimension(&file, "len_string", 0, STRING_BYTES);
  laves__netcdf_add_dimension(&file, "len_line", 0, LINE_BYTES);
  laves__netcdf_add_dimension(&file, "four", 0, 4);
  const int name_bytes = laves__netcdf_add_dimension(&file, "len_name", 0, NAME_BYTES);
  const int times = laves__netcdf_add_dimension(&file, "time_step", 0, 0);
  const int axes = laves__netcdf_add_dimension(&file, "num_dim", 0, 3);
  const int nodes = laves__netcdf_add_dimension(&file, "num_nodes", 0, m->mesh->vertex_count);
  const int elements = laves__netcdf_add_dimension(&file, "num_elem", 0, m->mesh->tet_count);
  laves__netcdf_add_variable(&file, "time_whole", 0, LAVES__NETCDF_DOUBLE, times, -1, no_attribute(), NULL, NULL);
  laves__netcdf_add_variable(&file, "coor_names", 0, LAVES__NETCDF_CHAR, axes, name_bytes, no_attribute(), pack_axis_names, NULL);
  laves__netcdf_add_variable(&file, "coordx", 0, LAVES__NETCDF_DOUBLE, nodes, -1, no_attribute(), pack_x, m->mesh);
  laves__netcdf_add_variable(&file, "coordy", 0, LAVES__NETCDF_DOUBLE, nodes, -1, no_attribute(), pack_y, m->mesh);
  laves__netcdf_add_variable(&file, "coordz", 0, LAVES__NETCDF_DOUBLE, nodes, -1, no_attribute(), pack_z, m->mesh);
  add_blocks(&file, m, elements, name_bytes);
  if (m->mesh->face_count > 0) add_boundary(&file, m, name_bytes);
  laves__netcdf_write(&file);
}

/* Where each tet stands in the file. */
static void find_places(laves__output *out, model *m) {
  const size_t tets = m->mesh->tet_count;
  if (!m->regions.order) return;
  m->places = laves__alloc(out->context, tets, sizeof *m->places);
  if (!m->places) {
    laves__output_fail_memory(out);
    return;
  }
  for (size_t i = 0; i < tets; i++) {
    m->places[m->regions.order[i]] = (int32_t)i;
    if (!laves__cancelled_at(out->context, "write", i, 2 * tets)) continue;
    laves__fail_cancelled(&out->error);
    return;
  }
}

static void make_sets(laves__output *out, model *m) {
  m->set_count = m->regions.count > m->boundary.tags.count ? m->regions.count : m->boundary.tags.count;
  m->sets = laves__alloc(out->context, m->set_count, sizeof *m->sets);
  for (size_t i = 0; i < m->set_count && m->sets; i++) m->sets[i] = (set){m, i};
  if (!m->sets) laves__output_fail_memory(out);
}

void laves__write_exodus(laves__output *out, const laves_mesh *mesh) {
  if (mesh->tet_count == 0 || mesh->tet_count > INT32_MAX) {
    laves__output_fail(out, LAVES_ERROR_WRITE, "an Exodus file holds from 1 to 2147483647 tetrahedra, not %zu; choose VTU",
                       mesh->tet_count);
    return;
  }
  model m = {.mesh = mesh};
  if (!laves__boundary_sets_make(out, mesh, &m.boundary)) return;
  const bool ordered = laves__tag_order_make(out->context, mesh->regions, mesh->tet_count, &m.regions);
  if (!ordered) laves__output_fail_memory(out);
  if (ordered) make_sets(out, &m);
  if (out->error.result == LAVES_OK) find_places(out, &m);
  if (out->error.result == LAVES_OK) write_file(out, &m);
  laves__free(out->context, m.sets, m.set_count, sizeof *m.sets);
  laves__free(out->context, m.places, mesh->tet_count, sizeof *m.places);
  if (ordered) laves__tag_order_free(out->context, &m.regions);
  laves__boundary_sets_free(out->context, mesh, &m.boundary);
}
