/* Medit's .mesh (text) and .meshb (binary): vertices, tetrahedra with their region and boundary triangles with their tag as
 * reference, numbered from 1. Names of both are comments in the text, such as "# Triangles 3 inlet". Of a mesh of second order
 * they are TetrahedraP2 and TrianglesP2.
 *
 * Binary files are chains of blocks: a keyword's number, the position of the next block, a count, the items. Version 2 has
 * positions of 32 bits, version 3 of 64; both have 32-bit integers and doubles. Source: libMeshb (Inria), "The GMF file
 * format", https://github.com/LoicMarechal/libMeshb. */
#include "io/tag_order.h"
#include "io/write_mesh.h"
#include "io/write_text.h"

#include <string.h>

/* ---- text ---- */

static size_t put_vertices(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    text = laves__put_point(text, mesh->points[i]);
    memcpy(text, " 0\n", 3);
    text += 3;
  }
  return (size_t)(text - bytes);
}

static char *put_element(char *text, const int32_t *corners, int corner_count, int32_t reference) {
  text = laves__put_indices(text, corners, corner_count, 1);
  *text++ = ' ';
  text = laves__put_integer(text, reference);
  *text++ = '\n';
  return text;
}

static size_t put_tets(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++)
    text = put_element(text, laves__tet_nodes(mesh, i), laves__tet_width(mesh), mesh->regions ? mesh->regions[i] : 1);
  return (size_t)(text - bytes);
}

static size_t put_faces(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++)
    text = put_element(text, laves__face_nodes(mesh, i), laves__face_width(mesh), mesh->face_tags ? mesh->face_tags[i] : 1);
  return (size_t)(text - bytes);
}

void laves__write_medit_text(laves__output *out, const laves_mesh *mesh) {
  out->expected = 55.0 * (double)mesh->vertex_count + 30.0 * (double)(mesh->tet_count + mesh->face_count);
  laves__output_printf(out, "MeshVersionFormatted 2\nDimension 3\n");
  laves__tag_comments(out, mesh, 3, "# Tetrahedra ");
  laves__tag_comments(out, mesh, 2, "# Triangles ");
  laves__output_printf(out, "\nVertices\n%zu\n", mesh->vertex_count);
  laves__output_items(out, mesh->vertex_count, LAVES__POINT_TEXT_MAX + 3, put_vertices, mesh);
  const char *order = mesh->quadratic ? "P2" : "";
  laves__output_printf(out, "\nTetrahedra%s\n%zu\n", order, mesh->tet_count);
  laves__output_items(out, mesh->tet_count, 11 * (LAVES__INTEGER_TEXT_MAX + 1), put_tets, mesh);
  laves__output_printf(out, "\nTriangles%s\n%zu\n", order, mesh->face_count);
  laves__output_items(out, mesh->face_count, 7 * (LAVES__INTEGER_TEXT_MAX + 1), put_faces, mesh);
  laves__output_printf(out, "\nEnd\n");
}

/* ---- binary ---- */

enum {
  KEY_DIMENSION = 3,
  KEY_VERTICES = 4,
  KEY_TRIANGLES = 6,
  KEY_TETS = 8,
  KEY_TRIANGLES_2 = 24,
  KEY_TETS_2 = 30,
  KEY_END = 54
};
enum { VERTEX_BYTES = 28 };

/* Of an element: its nodes and its reference. */
static size_t tet_bytes(const laves_mesh *mesh) { return 4 * (size_t)laves__tet_width(mesh) + 4; }
static size_t face_bytes(const laves_mesh *mesh) { return 4 * (size_t)laves__face_width(mesh) + 4; }

static size_t pack_vertices(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  for (size_t i = begin; i < end; i++, bytes += VERTEX_BYTES) {
    memcpy(bytes, &mesh->points[i], 24);
    memset(bytes + 24, 0, 4);
  }
  return (end - begin) * VERTEX_BYTES;
}

static char *pack_element(char *bytes, const int32_t *nodes, int count, int32_t reference) {
  int32_t row[11];
  for (int i = 0; i < count; i++) row[i] = nodes[i] + 1;
  row[count] = reference;
  memcpy(bytes, row, 4 * (size_t)count + 4);
  return bytes + 4 * (size_t)count + 4;
}

static size_t pack_tets(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  for (size_t i = begin; i < end; i++)
    bytes = pack_element(bytes, laves__tet_nodes(mesh, i), laves__tet_width(mesh), mesh->regions ? mesh->regions[i] : 1);
  return (end - begin) * tet_bytes(mesh);
}

static size_t pack_faces(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  for (size_t i = begin; i < end; i++)
    bytes = pack_element(bytes, laves__face_nodes(mesh, i), laves__face_width(mesh), mesh->face_tags ? mesh->face_tags[i] : 1);
  return (end - begin) * face_bytes(mesh);
}

static void write_int(laves__output *out, int32_t value) { laves__output_bytes(out, &value, sizeof value); }

/* Starts a block whose content, after the position, takes `bytes`. */
static void begin_block(laves__output *out, int version, int key, uint64_t bytes) {
  write_int(out, key);
  const uint64_t next = out->written + (version == 2 ? 4 : 8) + bytes;
  laves__output_bytes(out, &next, version == 2 ? 4 : 8);
}

static void write_block(laves__output *out, int version, int key, const laves_mesh *mesh, size_t count, size_t item_bytes,
                        laves__output_items_fn *pack) {
  begin_block(out, version, key, 4 + (uint64_t)count * item_bytes);
  write_int(out, (int32_t)count);
  laves__output_items(out, count, item_bytes, pack, mesh);
}

void laves__write_medit_binary(laves__output *out, const laves_mesh *mesh) {
  if (mesh->tet_count > INT32_MAX || mesh->face_count > INT32_MAX) {
    laves__output_fail(out, LAVES_ERROR_WRITE,
                       "a .meshb file of this version holds at most 2147483647 tetrahedra; choose VTU or .mesh");
    return;
  }
  const uint64_t bytes = 100 + (uint64_t)mesh->vertex_count * VERTEX_BYTES + (uint64_t)mesh->tet_count * tet_bytes(mesh) +
                         (uint64_t)mesh->face_count * face_bytes(mesh);
  const int version = bytes <= INT32_MAX ? 2 : 3;
  out->expected = (double)bytes;
  write_int(out, 1); /* tells the byte order */
  write_int(out, version);
  begin_block(out, version, KEY_DIMENSION, 4);
  write_int(out, 3);
  write_block(out, version, KEY_VERTICES, mesh, mesh->vertex_count, VERTEX_BYTES, pack_vertices);
  write_block(out, version, mesh->quadratic ? KEY_TETS_2 : KEY_TETS, mesh, mesh->tet_count, tet_bytes(mesh), pack_tets);
  write_block(out, version, mesh->quadratic ? KEY_TRIANGLES_2 : KEY_TRIANGLES, mesh, mesh->face_count, face_bytes(mesh),
              pack_faces);
  const uint64_t last = 0;
  write_int(out, KEY_END);
  laves__output_bytes(out, &last, version == 2 ? 4 : 8);
}
