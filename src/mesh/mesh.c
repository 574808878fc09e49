/* The mesh handle: arrays, names of groups, and the accessors of the public header. */
#include "mesh/mesh.h"

#include <stdio.h>
#include <string.h>

laves_mesh *laves__mesh_create(laves_context *context, size_t vertex_count, size_t tet_count, size_t face_count, bool regions,
                               bool face_tags) {
  laves_mesh *mesh = laves__alloc_zeroed(context, 1, sizeof *mesh);
  if (!mesh) return NULL;
  mesh->context = context;
  mesh->vertex_count = vertex_count;
  mesh->tet_count = tet_count;
  mesh->face_count = face_count;
  mesh->points = laves__alloc(context, vertex_count, sizeof *mesh->points);
  mesh->tets = laves__alloc(context, tet_count, sizeof *mesh->tets);
  mesh->faces = laves__alloc(context, face_count, sizeof *mesh->faces);
  if (regions) mesh->regions = laves__alloc(context, tet_count, sizeof *mesh->regions);
  if (face_tags) mesh->face_tags = laves__alloc(context, face_count, sizeof *mesh->face_tags);
  if (mesh->points && mesh->tets && mesh->faces && (!regions || mesh->regions) && (!face_tags || mesh->face_tags)) return mesh;
  laves_mesh_free(mesh);
  return NULL;
}

void laves_mesh_free(laves_mesh *mesh) {
  if (!mesh) return;
  laves_context *context = mesh->context;
  laves__free(context, mesh->points, mesh->vertex_count, sizeof *mesh->points);
  laves__free(context, mesh->tets, mesh->tet_count, sizeof *mesh->tets);
  laves__free(context, mesh->faces, mesh->face_count, sizeof *mesh->faces);
  laves__free(context, mesh->regions, mesh->tet_count, sizeof *mesh->regions);
  laves__free(context, mesh->face_tags, mesh->face_count, sizeof *mesh->face_tags);
  laves__free(context, mesh->face_sources, mesh->face_count, sizeof *mesh->face_sources);
  laves__free(context, mesh->groups, mesh->group_count, sizeof *mesh->groups);
  laves__free(context, mesh, 1, sizeof *mesh);
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
size_t laves_mesh_lattice_tet_count(const laves_mesh *mesh) { return mesh->lattice_tet_count; }

const char *laves_mesh_group_name(const laves_mesh *mesh, int dimension, int32_t tag) {
  for (size_t i = 0; i < mesh->group_count; i++)
    if (mesh->groups[i].dimension == dimension && mesh->groups[i].tag == tag) return mesh->groups[i].name;
  return NULL;
}
