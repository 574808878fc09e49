/* Gmsh's MSH files as surfaces: their triangles and quadrangles, whatever else they hold.
 *
 * read_gmsh.c collects the elements; here they become faces, quadrangles as fans of two triangles. Only nodes that they use are
 * points. An element's tag is its physical group, by its name, else "surface 7"; so is the entity where there is no group.
 * Elements of higher order give their corners. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/mesh_input.h"
#include "io/surface_build.h"

bool laves__is_gmsh(laves__scan scan) {
  laves__word word;
  return laves__scan_space(&scan) && laves__scan_word(&scan, &word) &&
         (laves__word_is(word, "$MeshFormat") || laves__word_is(word, "$Comments"));
}

/* "Gmsh 4.1 (binary)", from the section $MeshFormat. */
static void name_format(laves__scan scan, char format[48]) {
  double version = 0;
  int64_t binary = 0;
  laves__word word;
  while (laves__scan_space(&scan) && laves__scan_word(&scan, &word) && !laves__word_is(word, "$MeshFormat"))
    laves__scan_next_line(&scan);
  laves__scan_space(&scan);
  if (laves__scan_double(&scan, &version)) laves__scan_int(&scan, &binary);
  snprintf(format, 48, "Gmsh %g (%s)", version, binary ? "binary" : "ASCII");
}

static int compare_groups(const void *a, const void *b) {
  const laves__group *x = a, *y = b;
  if (x->dimension != y->dimension) return x->dimension < y->dimension ? -1 : 1;
  if (x->tag != y->tag) return x->tag < y->tag ? -1 : 1;
  return strcmp(x->name, y->name);
}

/* The groups are sorted. */
static const char *group_name(const laves__mesh_input *mesh, int32_t tag, char *text, size_t size) {
  size_t low = 0, high = mesh->group_count;
  const laves__group wanted = {.dimension = 2, .tag = tag, .name = ""};
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (compare_groups(&mesh->groups[middle], &wanted) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  const laves__group *found = low < mesh->group_count ? &mesh->groups[low] : NULL;
  if (found && found->dimension == 2 && found->tag == tag && found->name[0])
    snprintf(text, size, "%s", found->name);
  else
    snprintf(text, size, "surface %ld", (long)tag);
  return text;
}

/* Whether there is anything to tell apart, or a name to keep. */
static bool has_tags(const laves__mesh_input *mesh) {
  for (size_t i = 1; i < mesh->face_count; i++)
    if (mesh->face_tags[i] != mesh->face_tags[0]) return true;
  for (size_t i = 0; mesh->face_count > 0 && i < mesh->group_count; i++)
    if (mesh->groups[i].dimension == 2 && mesh->groups[i].tag == mesh->face_tags[0]) return true;
  return false;
}

static laves_result start_tag(laves__surface_build *build, const laves__mesh_input *mesh, int32_t tag) {
  char text[sizeof mesh->groups->name];
  const char *name = group_name(mesh, tag, text, sizeof text);
  return laves__build_tag(build, (laves__word){name, strlen(name)}, "");
}

/* number[i]: the point that node i became, or -1. */
static laves_result add_points(laves__surface_build *build, const laves__mesh_input *mesh, int32_t *number) {
  LAVES_ASSERT(number);
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < mesh->point_count; i++) number[i] = -1;
  for (size_t f = 0; f < mesh->face_count; f++)
    for (int k = 0; k < 3; k++) number[mesh->faces[f][k]] = 0;
  for (size_t i = 0; i < mesh->point_count && result == LAVES_OK; i++) {
    if (number[i] < 0) continue;
    const laves__vec3 p = mesh->points[i];
    if (!v3_finite(p)) return laves__build_fail(build, "node %zu (counted from 1) has a coordinate that is not finite", i + 1);
    number[i] = (int32_t)build->input->point_count;
    result = laves__build_point(build, p.x, p.y, p.z);
  }
  return result;
}

static laves_result add_faces(laves__surface_build *build, const laves__mesh_input *mesh, const int32_t *number) {
  laves_result result = LAVES_OK;
  const bool tagged = has_tags(mesh);
  for (size_t f = 0, end; f < mesh->face_count && result == LAVES_OK; f = end) {
    if (tagged && (f == 0 || mesh->face_tags[f] != mesh->face_tags[f - 1])) result = start_tag(build, mesh, mesh->face_tags[f]);
    laves__build_face(build);
    for (int k = 0; k < 3 && result == LAVES_OK; k++) result = laves__build_corner(build, number[mesh->faces[f][k]]);
    for (end = f + 1; end < mesh->face_count && mesh->face_elements[end] == mesh->face_elements[f]; end++)
      if (result == LAVES_OK) result = laves__build_corner(build, number[mesh->faces[end][2]]);
    if (result == LAVES_OK) result = laves__build_face_end(build);
  }
  return result;
}

laves_result laves__read_gmsh_surface(laves__surface_build *build) {
  const laves__scan *scan = &build->scan;
  laves__mesh_input mesh = {.context = build->context,
                            .name = scan->name ? scan->name : "the file",
                            .begin = scan->begin,
                            .end = scan->end,
                            .polygons = true};
  name_format(*scan, build->input->format);
  build->binary = strstr(build->input->format, "binary") != NULL;
  laves_result result = laves__read_gmsh(&mesh, build->error);
  int32_t *number = result == LAVES_OK ? laves__alloc(build->context, mesh.point_count, sizeof *number) : NULL;
  if (result == LAVES_OK && !number) result = laves__fail_memory(build->context, build->error);
  if (result == LAVES_OK) {
    if (mesh.group_count > 0) qsort(mesh.groups, mesh.group_count, sizeof *mesh.groups, compare_groups);
    result = add_points(build, &mesh, number);
  }
  if (result == LAVES_OK) result = add_faces(build, &mesh, number);
  laves__free(build->context, number, mesh.point_count, sizeof *number);
  laves__mesh_input_free(&mesh);
  return result;
}
