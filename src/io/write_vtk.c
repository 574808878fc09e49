/* VTK's older "legacy" file, version 3.0, text or binary (big-endian, as the format wants): points as doubles, cells with a count
 * before their corners, cell data "region", "class" and, where it is known, "source_face", as in VTU. Names of groups are field
 * data as there: arrays of pairs (number, dimension).
 * Source: VTK file formats, "Simple Legacy Formats", https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html
 */
#include <string.h>

#include "io/big_endian.h"
#include "io/mesh_cells.h"
#include "io/mesh_items.h"
#include "io/write_mesh.h"
#include "io/write_text.h"

/* ---- binary ---- */

static size_t pack_points(const void *user, size_t begin, size_t end, char *bytes) {
  laves__point_reader reader = {.mesh = user};
  for (size_t i = begin; i < end; i++, bytes += 24) {
    const laves__vec3 p = laves__point_at(&reader, i);
    laves__put_big_double(bytes, p.x);
    laves__put_big_double(bytes + 8, p.y);
    laves__put_big_double(bytes + 16, p.z);
  }
  return (end - begin) * 24;
}

static void put_corners(char *bytes, const int32_t *corners, int count) {
  laves__put_big32(bytes, (uint32_t)count);
  for (int i = 0; i < count; i++) laves__put_big32(bytes + 4 + 4 * i, (uint32_t)corners[i]);
}

static size_t pack_tets(const void *user, size_t begin, size_t end, char *bytes) {
  laves__tet_reader reader = {.mesh = user};
  const int width = laves__tet_width(user);
  const size_t size = 4 + 4 * (size_t)width;
  for (size_t i = begin; i < end; i++, bytes += size) put_corners(bytes, laves__tet_at(&reader, i), width);
  return (end - begin) * size;
}

static size_t pack_faces(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  const int width = laves__face_width(mesh);
  const size_t size = 4 + 4 * (size_t)width;
  for (size_t i = begin; i < end; i++, bytes += size) put_corners(bytes, laves__face_nodes(mesh, i), width);
  return (end - begin) * size;
}

static size_t pack_types(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++, bytes += 4) laves__put_big32(bytes, laves__cell_type(user, i));
  return (end - begin) * 4;
}

static size_t pack_regions(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++, bytes += 4) laves__put_big32(bytes, (uint32_t)laves__cell_region(user, i));
  return (end - begin) * 4;
}

static size_t pack_classes(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++) *bytes++ = (char)laves__cell_class(user, i);
  return end - begin;
}

static size_t pack_sources(const void *user, size_t begin, size_t end, char *bytes) {
  for (size_t i = begin; i < end; i++, bytes += 4) laves__put_big32(bytes, (uint32_t)laves__cell_source(user, i));
  return (end - begin) * 4;
}

/* ---- text ---- */

static size_t text_points(const void *user, size_t begin, size_t end, char *bytes) {
  laves__point_reader reader = {.mesh = user};
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    text = laves__put_point(text, laves__point_at(&reader, i));
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

static char *text_corners(char *text, const int32_t *corners, int count) {
  text = laves__put_integer(text, count);
  *text++ = ' ';
  text = laves__put_indices(text, corners, count, 0);
  *text++ = '\n';
  return text;
}

static size_t text_tets(const void *user, size_t begin, size_t end, char *bytes) {
  laves__tet_reader reader = {.mesh = user};
  char *text = bytes;
  for (size_t i = begin; i < end; i++) text = text_corners(text, laves__tet_at(&reader, i), laves__tet_width(user));
  return (size_t)(text - bytes);
}

static size_t text_faces(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) text = text_corners(text, laves__face_nodes(mesh, i), laves__face_width(mesh));
  return (size_t)(text - bytes);
}

static char *text_number(char *text, int32_t number) {
  text = laves__put_integer(text, number);
  *text++ = '\n';
  return text;
}

static size_t text_types(const void *user, size_t begin, size_t end, char *bytes) {
  char *text = bytes;
  for (size_t i = begin; i < end; i++) text = text_number(text, laves__cell_type(user, i));
  return (size_t)(text - bytes);
}

static size_t text_regions(const void *user, size_t begin, size_t end, char *bytes) {
  char *text = bytes;
  for (size_t i = begin; i < end; i++) text = text_number(text, laves__cell_region(user, i));
  return (size_t)(text - bytes);
}

static size_t text_classes(const void *user, size_t begin, size_t end, char *bytes) {
  char *text = bytes;
  for (size_t i = begin; i < end; i++) text = text_number(text, laves__cell_class(user, i));
  return (size_t)(text - bytes);
}

static size_t text_sources(const void *user, size_t begin, size_t end, char *bytes) {
  char *text = bytes;
  for (size_t i = begin; i < end; i++) text = text_number(text, laves__cell_source(user, i));
  return (size_t)(text - bytes);
}

/* ---- the file ---- */

typedef struct kind {
  laves__output_items_fn *pack, *text;
  size_t bytes, text_bytes; /* of an item; the second is a bound */
} kind;

enum { NUMBER_TEXT = LAVES__INTEGER_TEXT_MAX + 1, CORNERS_TEXT = 11 * NUMBER_TEXT };

static const kind points = {pack_points, text_points, 24, LAVES__POINT_TEXT_MAX + 1};
static const kind tets = {pack_tets, text_tets, 20, CORNERS_TEXT}, faces = {pack_faces, text_faces, 16, CORNERS_TEXT};
static const kind quadratic_tets = {pack_tets, text_tets, 44, CORNERS_TEXT};
static const kind quadratic_faces = {pack_faces, text_faces, 28, CORNERS_TEXT};
static const kind types = {pack_types, text_types, 4, NUMBER_TEXT}, regions = {pack_regions, text_regions, 4, NUMBER_TEXT};
static const kind classes = {pack_classes, text_classes, 1, NUMBER_TEXT}, sources = {pack_sources, text_sources, 4, NUMBER_TEXT};

static void write_items(laves__output *out, const kind *k, size_t count, const laves_mesh *mesh, bool ascii) {
  if (ascii)
    laves__output_items(out, count, k->text_bytes, k->text, mesh);
  else
    laves__output_rows(out, count, k->bytes, k->pack, mesh);
}

/* A name as one word: what could end it is spelled as %20. */
static void write_word(laves__output *out, const char *name) {
  for (; *name; name++) {
    const unsigned char c = (unsigned char)*name;
    if (c <= ' ' || c > '~' || c == '"' || c == '%')
      laves__output_printf(out, "%%%02X", c);
    else
      laves__output_bytes(out, name, 1);
  }
}

static void write_pair(laves__output *out, const laves__group *group, bool ascii) {
  char pair[8];
  laves__put_big32(pair, (uint32_t)group->tag);
  laves__put_big32(pair + 4, (uint32_t)group->dimension);
  if (ascii)
    laves__output_printf(out, "%ld %d\n", (long)group->tag, group->dimension);
  else
    laves__output_bytes(out, pair, sizeof pair);
}

static void write_names(laves__output *out, const laves_mesh *mesh, bool ascii) {
  const size_t names = laves__cell_name_count(mesh);
  if (names > 0) laves__output_printf(out, "FIELD FieldData %zu\n", names);
  for (size_t i = 0; i < mesh->group_count && names > 0; i++) {
    const size_t pairs = laves__cell_name_pairs(mesh, i);
    if (pairs == 0) continue;
    write_word(out, mesh->groups[i].name);
    laves__output_printf(out, " 2 %zu int\n", pairs);
    for (size_t j = i; j < mesh->group_count; j++)
      if (laves__cell_same_name(mesh, i, j)) write_pair(out, &mesh->groups[j], ascii);
    if (!ascii) laves__output_printf(out, "\n");
  }
}

static void write_data(laves__output *out, const laves_mesh *mesh, bool ascii) {
  const size_t cells = laves__cell_count(mesh);
  const char *end = ascii ? "" : "\n"; /* binary data ends without one */
  laves__output_printf(out, "CELL_DATA %zu\nFIELD FieldData %d\nregion 1 %zu int\n", cells, mesh->face_sources ? 3 : 2, cells);
  write_items(out, &regions, cells, mesh, ascii);
  laves__output_printf(out, "%sclass 1 %zu unsigned_char\n", end, cells);
  write_items(out, &classes, cells, mesh, ascii);
  if (mesh->face_sources) {
    laves__output_printf(out, "%ssource_face 1 %zu int\n", end, cells);
    write_items(out, &sources, cells, mesh, ascii);
  }
  laves__output_printf(out, "%s", end);
}

void laves__write_vtk(laves__output *out, const laves_mesh *mesh, bool ascii) {
  const size_t cells = laves__cell_count(mesh), triangles = laves__cell_faces(mesh);
  const char *end = ascii ? "" : "\n";
  out->expected = (ascii ? 56.0 : 24.0) * (double)mesh->vertex_count + (ascii ? 38.0 : 29.0) * (double)cells;
  laves__output_printf(out, "# vtk DataFile Version 3.0\ntetrahedral mesh\n%s\nDATASET UNSTRUCTURED_GRID\n",
                       ascii ? "ASCII" : "BINARY");
  laves__output_printf(out, "POINTS %zu double\n", mesh->vertex_count);
  write_items(out, &points, mesh->vertex_count, mesh, ascii);
  laves__output_printf(out, "%sCELLS %zu %zu\n", end, cells, cells + laves__cell_corners(mesh));
  write_items(out, mesh->quadratic ? &quadratic_tets : &tets, mesh->tet_count, mesh, ascii);
  write_items(out, mesh->quadratic ? &quadratic_faces : &faces, triangles, mesh, ascii);
  laves__output_printf(out, "%sCELL_TYPES %zu\n", end, cells);
  write_items(out, &types, cells, mesh, ascii);
  laves__output_printf(out, "%s", end);
  write_names(out, mesh, ascii); /* here, since Gmsh wants the points first and VTK takes them anywhere */
  write_data(out, mesh, ascii);
}
