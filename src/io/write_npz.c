/* NumPy's .npz, in two forms.
 *
 * The mesh: points float64 (n, 3), tets int32 (m, 4), faces int32 (k, 3), face_tags int32 (k,), regions int32 (m,), face_sources
 * int32 (k,) where they are known; and group_names, group_dimensions, group_tags: the names of regions (3) and face tags (2).
 *
 * A grid for deep marching tetrahedra: vertices float32 (n, 3) in the cube [-1/2, 1/2]^3 and indices int64 (m, 4), which are the
 * names, and the cube, that programs for it expect. The longest side of the box fills the cube. Source: Shen et al., "Deep
 * Marching Tetrahedra: a Hybrid Representation for High-Resolution 3D Shape Synthesis", 2021. */
#include <stdio.h>
#include <string.h>

#include "io/mesh_pack.h"
#include "io/npz_file.h"
#include "io/write_mesh.h"

/* ---- the mesh ---- */

static size_t pack_faces(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  const size_t size = 4 * (size_t)laves__face_width(mesh);
  if (end > begin) memcpy(bytes, laves__face_nodes(mesh, begin), (end - begin) * size);
  return (end - begin) * size;
}

static size_t pack_numbers(const int32_t *numbers, size_t begin, size_t end, char *bytes) {
  const int32_t one = 1;
  for (size_t i = begin; i < end; i++) memcpy(bytes + 4 * (i - begin), numbers ? &numbers[i] : &one, 4);
  return (end - begin) * 4;
}

static size_t pack_regions(const void *user, size_t begin, size_t end, char *bytes) {
  return pack_numbers(((const laves_mesh *)user)->regions, begin, end, bytes);
}

static size_t pack_tags(const void *user, size_t begin, size_t end, char *bytes) {
  return pack_numbers(((const laves_mesh *)user)->face_tags, begin, end, bytes);
}

static size_t pack_sources(const void *user, size_t begin, size_t end, char *bytes) {
  return pack_numbers(((const laves_mesh *)user)->face_sources, begin, end, bytes);
}

static size_t pack_group_dimensions(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  for (size_t i = begin; i < end; i++) {
    const int32_t dimension = mesh->groups[i].dimension;
    memcpy(bytes + 4 * (i - begin), &dimension, 4);
  }
  return (end - begin) * 4;
}

static size_t pack_group_tags(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  for (size_t i = begin; i < end; i++) memcpy(bytes + 4 * (i - begin), &mesh->groups[i].tag, 4);
  return (end - begin) * 4;
}

/* The next character of UTF-8; a byte that begins none stands for itself, as in Latin-1. */
static uint32_t next_character(const char **text) {
  const unsigned char *c = (const unsigned char *)*text;
  const int more = c[0] < 0xc0 ? 0 : c[0] < 0xe0 ? 1 : c[0] < 0xf0 ? 2 : c[0] < 0xf8 ? 3 : 0;
  uint32_t value = more ? c[0] & (0x3fu >> more) : c[0];
  for (int i = 1; i <= more; i++) {
    if ((c[i] & 0xc0) != 0x80) {
      *text += 1;
      return c[0];
    }
    value = value << 6 | (c[i] & 0x3fu);
  }
  *text += 1 + more;
  return value <= 0x10ffff && (value & 0xfffff800u) != 0xd800 ? value : 0xfffd;
}

/* Names have so many characters each, 0 behind the end. */
enum { NAME_CHARACTERS = sizeof((laves__group *)0)->name };

static size_t pack_group_names(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  memset(bytes, 0, (end - begin) * NAME_CHARACTERS * 4);
  for (size_t i = begin; i < end; i++, bytes += NAME_CHARACTERS * 4) {
    const char *name = mesh->groups[i].name;
    for (size_t k = 0; *name; k++) {
      const uint32_t character = next_character(&name);
      memcpy(bytes + 4 * k, &character, 4);
    }
  }
  return (end - begin) * NAME_CHARACTERS * 4;
}

void laves__write_npz(laves__output *out, const laves_mesh *mesh) {
  char name_type[10];
  snprintf(name_type, sizeof name_type, "<U%d", (int)NAME_CHARACTERS);
  laves__npz_array arrays[] = {
      {"points", "<f8", mesh->vertex_count, 3, 24, laves__pack_points, mesh, 0, 0},
      {"tets", "<i4", mesh->tet_count, laves__tet_width(mesh), 4 * (size_t)laves__tet_width(mesh), laves__pack_tets, mesh, 0, 0},
      {"faces", "<i4", mesh->face_count, laves__face_width(mesh), 4 * (size_t)laves__face_width(mesh), pack_faces, mesh, 0, 0},
      {"face_tags", "<i4", mesh->face_count, 0, 4, pack_tags, mesh, 0, 0},
      {"regions", "<i4", mesh->tet_count, 0, 4, pack_regions, mesh, 0, 0},
      {"group_names", name_type, mesh->group_count, 0, NAME_CHARACTERS * 4, pack_group_names, mesh, 0, 0},
      {"group_dimensions", "<i4", mesh->group_count, 0, 4, pack_group_dimensions, mesh, 0, 0},
      {"group_tags", "<i4", mesh->group_count, 0, 4, pack_group_tags, mesh, 0, 0},
      {"face_sources", "<i4", mesh->face_count, 0, 4, pack_sources, mesh, 0, 0},
  };
  const int count = LAVES__COUNT_OF(arrays);
  laves__write_npz_arrays(out, arrays, mesh->face_sources ? count : count - 1);
}

/* ---- the grid ---- */

typedef struct unit_grid {
  const laves_mesh *mesh;
  laves__vec3 middle;
  double side;
} unit_grid;

static size_t pack_vertices(const void *user, size_t begin, size_t end, char *bytes) {
  const unit_grid *g = user;
  for (size_t i = begin; i < end; i++, bytes += 12) {
    const laves__vec3 p = v3_sub(g->mesh->points[i], g->middle);
    const float row[3] = {(float)(p.x / g->side), (float)(p.y / g->side), (float)(p.z / g->side)};
    memcpy(bytes, row, sizeof row);
  }
  return (end - begin) * 12;
}

static size_t pack_indices(const void *user, size_t begin, size_t end, char *bytes) {
  const unit_grid *g = user;
  for (size_t i = begin; i < end; i++, bytes += 32) {
    const int32_t *t = g->mesh->tets[i];
    const int64_t row[4] = {t[0], t[1], t[2], t[3]};
    memcpy(bytes, row, sizeof row);
  }
  return (end - begin) * 32;
}

void laves__write_dmtet(laves__output *out, const laves_mesh *mesh) {
  laves__box3 box = box3_empty();
  for (size_t i = 0; i < mesh->vertex_count; i++) box = box3_add(box, mesh->points[i]);
  if (mesh->vertex_count == 0) box = (laves__box3){v3(0, 0, 0), v3(0, 0, 0)};
  const laves__vec3 size = v3_sub(box.upper, box.lower);
  const double longest = size.x > size.y ? size.x : size.y, side = longest > size.z ? longest : size.z;
  const unit_grid grid = {mesh, v3_scale(v3_add(box.lower, box.upper), 0.5), side > 0 ? side : 1};
  laves__npz_array arrays[] = {
      {"vertices", "<f4", mesh->vertex_count, 3, 12, pack_vertices, &grid, 0, 0},
      {"indices", "<i8", mesh->tet_count, 4, 32, pack_indices, &grid, 0, 0},
  };
  laves__write_npz_arrays(out, arrays, LAVES__COUNT_OF(arrays));
}
