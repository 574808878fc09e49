/* The mesh handle: arrays, names of groups, and the accessors of the public header. */
#include "mesh/mesh.h"

#include <stdio.h>
#include <string.h>

static laves_mesh *create(laves_context *context, size_t vertex_count, size_t tet_count, size_t face_count, bool regions,
                          bool face_tags, bool hollow) {
  laves_mesh *mesh = laves__alloc_zeroed(context, 1, sizeof *mesh);
  if (!mesh) return NULL;
  mesh->context = context;
  mesh->vertex_count = vertex_count;
  mesh->tet_count = tet_count;
  mesh->face_count = face_count;
  if (!hollow) mesh->points = laves__alloc(context, vertex_count, sizeof *mesh->points);
  if (!hollow) mesh->tets = laves__alloc(context, tet_count, sizeof *mesh->tets);
  mesh->faces = laves__alloc(context, face_count, sizeof *mesh->faces);
  if (regions) mesh->regions = laves__alloc(context, tet_count, sizeof *mesh->regions);
  if (face_tags) mesh->face_tags = laves__alloc(context, face_count, sizeof *mesh->face_tags);
  const bool filled = hollow || (mesh->points && mesh->tets);
  if (filled && mesh->faces && (!regions || mesh->regions) && (!face_tags || mesh->face_tags)) return mesh;
  laves_mesh_free(mesh);
  return NULL;
}

laves_mesh *laves__mesh_create(laves_context *context, size_t vertex_count, size_t tet_count, size_t face_count, bool regions,
                               bool face_tags) {
  return create(context, vertex_count, tet_count, face_count, regions, face_tags, false);
}

laves_mesh *laves__mesh_create_hollow(laves_context *context, size_t vertex_count, size_t tet_count, size_t face_count,
                                      bool regions, bool face_tags) {
  return create(context, vertex_count, tet_count, face_count, regions, face_tags, true);
}

void laves__quadratic_free(laves_context *context, const laves_mesh *mesh, laves__quadratic *quadratic) {
  if (!quadratic) return;
  laves__free(context, quadratic->points, quadratic->node_count, sizeof *quadratic->points);
  laves__free(context, quadratic->tets, mesh->tet_count, sizeof *quadratic->tets);
  laves__free(context, quadratic->faces, mesh->face_count, sizeof *quadratic->faces);
  laves__free(context, quadratic, 1, sizeof *quadratic);
}

void laves_mesh_free(laves_mesh *mesh) {
  if (!mesh) return;
  laves_context *context = mesh->context;
  if (mesh->maker.self) mesh->maker.free(mesh->maker.self);
  laves__quadratic_free(context, mesh, mesh->quadratic);
  laves__free(context, mesh->points, mesh->vertex_count, sizeof *mesh->points);
  laves__free(context, mesh->tets, mesh->tet_count, sizeof *mesh->tets);
  laves__free(context, mesh->faces, mesh->face_count, sizeof *mesh->faces);
  laves__free(context, mesh->regions, mesh->tet_count, sizeof *mesh->regions);
  laves__free(context, mesh->face_tags, mesh->face_count, sizeof *mesh->face_tags);
  laves__free(context, mesh->face_sources, mesh->face_count, sizeof *mesh->face_sources);
  laves__free(context, mesh->groups, mesh->group_count, sizeof *mesh->groups);
  laves__free(context, mesh, 1, sizeof *mesh);
}

/* ---- arrays by ranges ---- */

bool laves__mesh_points(const laves_mesh *mesh, size_t begin, size_t end, laves__vec3 *out) {
  if (mesh->maker.self) return mesh->maker.points(mesh->maker.self, begin, end, out);
  memcpy(out, mesh->points + begin, (end - begin) * sizeof *out);
  return true;
}

bool laves__mesh_tets(const laves_mesh *mesh, size_t begin, size_t end, int32_t (*out)[4]) {
  if (mesh->maker.self) return mesh->maker.tets(mesh->maker.self, begin, end, out);
  memcpy(out, mesh->tets + begin, (end - begin) * sizeof *out);
  return true;
}

/* A range of numbers as whole items between two ends that may be parts of one. */
typedef struct ends {
  size_t first, last;       /* whole items [first, last) */
  size_t head, tail, total; /* numbers before them, behind them, and all */
} ends;

static ends split(size_t begin, size_t end, size_t per_item) {
  ends e = {.first = (begin + per_item - 1) / per_item, .last = end / per_item, .total = end - begin};
  if (e.first > e.last) { /* within one item */
    e.head = e.total;
    e.first = e.last;
    return e;
  }
  e.head = e.first * per_item - begin;
  e.tail = end - e.last * per_item;
  return e;
}

bool laves__mesh_coordinates(const laves_mesh *mesh, size_t begin, size_t end, double *out) {
  if (!mesh->maker.self) {
    if (end > begin) memcpy(out, &mesh->points->x + begin, (end - begin) * sizeof *out);
    return true;
  }
  const ends e = split(begin, end, 3);
  laves__vec3 one;
  if (e.head && !laves__mesh_points(mesh, begin / 3, begin / 3 + 1, &one)) return false;
  for (size_t i = 0; i < e.head; i++) out[i] = v3_at(one, (int)((begin + i) % 3));
  if (e.last > e.first && !laves__mesh_points(mesh, e.first, e.last, (laves__vec3 *)(void *)(out + e.head))) return false;
  if (e.tail && !laves__mesh_points(mesh, end / 3, end / 3 + 1, &one)) return false;
  for (size_t i = 0; i < e.tail; i++) out[e.total - e.tail + i] = v3_at(one, (int)i);
  return true;
}

bool laves__mesh_corners(const laves_mesh *mesh, size_t begin, size_t end, int32_t *out) {
  if (!mesh->maker.self) {
    if (end > begin) memcpy(out, *mesh->tets + begin, (end - begin) * sizeof *out);
    return true;
  }
  const ends e = split(begin, end, 4);
  int32_t one[1][4];
  if (e.head && !laves__mesh_tets(mesh, begin / 4, begin / 4 + 1, one)) return false;
  for (size_t i = 0; i < e.head; i++) out[i] = one[0][(begin + i) % 4];
  if (e.last > e.first && !laves__mesh_tets(mesh, e.first, e.last, (int32_t(*)[4])(void *)(out + e.head))) return false;
  if (e.tail && !laves__mesh_tets(mesh, end / 4, end / 4 + 1, one)) return false;
  for (size_t i = 0; i < e.tail; i++) out[e.total - e.tail + i] = one[0][i];
  return true;
}

laves_result laves__mesh_require_arrays(const laves_mesh *mesh, const char *what, laves_error *error) {
  if (!mesh->maker.self) return LAVES_OK;
  return laves__fail(error, LAVES_ERROR_OPTION, "%s needs a mesh in memory, and this one is streamed", what);
}

bool laves__mesh_add_group(laves_mesh *mesh, int dimension, int32_t tag, const char *name) {
  laves__group *groups = laves__realloc(mesh->context, mesh->groups, mesh->group_count, mesh->group_count + 1, sizeof *groups);
  if (!groups) return false;
  mesh->groups = groups;
  laves__group *group = &groups[mesh->group_count++];
  group->dimension = dimension;
  group->tag = tag;
  snprintf(group->name, sizeof group->name, "%s", name);
  return true;
}

size_t laves_mesh_vertex_count(const laves_mesh *mesh) { return mesh->vertex_count; }
size_t laves_mesh_tet_count(const laves_mesh *mesh) { return mesh->tet_count; }
size_t laves_mesh_face_count(const laves_mesh *mesh) { return mesh->face_count; }
const double *laves_mesh_points(const laves_mesh *mesh) { return mesh->points ? &mesh->points->x : NULL; }
const int32_t *laves_mesh_tets(const laves_mesh *mesh) { return mesh->tets ? *mesh->tets : NULL; }
const int32_t *laves_mesh_faces(const laves_mesh *mesh) { return mesh->faces ? *mesh->faces : NULL; }
const int32_t *laves_mesh_regions(const laves_mesh *mesh) { return mesh->regions; }
const int32_t *laves_mesh_face_tags(const laves_mesh *mesh) { return mesh->face_tags; }
const int32_t *laves_mesh_face_sources(const laves_mesh *mesh) { return mesh->face_sources; }
int laves_mesh_order(const laves_mesh *mesh) { return mesh->quadratic ? 2 : 1; }
size_t laves_mesh_node_count(const laves_mesh *mesh) {
  return mesh->quadratic ? mesh->quadratic->node_count : mesh->vertex_count;
}
const double *laves_mesh_node_points(const laves_mesh *mesh) {
  return mesh->quadratic ? &mesh->quadratic->points->x : laves_mesh_points(mesh);
}
const int32_t *laves_mesh_tet_nodes(const laves_mesh *mesh) {
  return mesh->quadratic ? *mesh->quadratic->tets : laves_mesh_tets(mesh);
}
const int32_t *laves_mesh_face_nodes(const laves_mesh *mesh) {
  return mesh->quadratic ? *mesh->quadratic->faces : laves_mesh_faces(mesh);
}
bool laves_mesh_is_streamed(const laves_mesh *mesh) { return mesh->maker.self != NULL; }

static laves_result check_read(size_t first, size_t count, size_t total, const char *what, laves_error *error) {
  if (first <= total && count <= total - first) return LAVES_OK;
  return laves__fail(error, LAVES_ERROR_OPTION, "%zu %s from number %zu on were asked for, but the mesh has %zu", count, what,
                     first, total);
}

static laves_result unreadable(laves_error *error) {
  return laves__fail(error, LAVES_ERROR_INPUT, "the mesh could not be read from its file");
}

laves_result laves_mesh_read_points(const laves_mesh *mesh, size_t first, size_t count, double *points, laves_error *error) {
  const laves_result result = check_read(first, count, mesh->vertex_count, "points", error);
  if (result != LAVES_OK || count == 0) return result;
  return laves__mesh_points(mesh, first, first + count, (laves__vec3 *)(void *)points) ? LAVES_OK : unreadable(error);
}

laves_result laves_mesh_read_tets(const laves_mesh *mesh, size_t first, size_t count, int32_t *tets, laves_error *error) {
  const laves_result result = check_read(first, count, mesh->tet_count, "tetrahedra", error);
  if (result != LAVES_OK || count == 0) return result;
  return laves__mesh_tets(mesh, first, first + count, (int32_t(*)[4])(void *)tets) ? LAVES_OK : unreadable(error);
}

size_t laves_mesh_lattice_tet_count(const laves_mesh *mesh) { return mesh->lattice_tet_count; }

const char *laves_mesh_group_name(const laves_mesh *mesh, int dimension, int32_t tag) {
  for (size_t i = 0; i < mesh->group_count; i++)
    if (mesh->groups[i].dimension == dimension && mesh->groups[i].tag == tag) return mesh->groups[i].name;
  return NULL;
}
