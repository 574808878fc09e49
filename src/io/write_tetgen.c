/* TetGen's three files: .node (points), .ele (tetrahedra, with their region as attribute where there are regions) and .face
 * (boundary triangles with their tag as marker), numbered from 0. Names are comments at the end, such as "# marker 3 inlet".
 * Source: Hang Si, TetGen manual, section 5, "File formats". */
#include "io/tag_order.h"
#include "io/write_mesh.h"
#include "io/write_text.h"

enum { ROW_MAX = 6 * (LAVES__INTEGER_TEXT_MAX + 1) };

static size_t put_points(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    text = laves__put_integer(text, (int64_t)i);
    *text++ = ' ';
    text = laves__put_point(text, mesh->points[i]);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

/* "number corners", with " tag" where there are tags. */
static char *put_row(char *text, size_t number, const int32_t *corners, int corner_count, const int32_t *tag) {
  text = laves__put_integer(text, (int64_t)number);
  *text++ = ' ';
  text = laves__put_indices(text, corners, corner_count, 0);
  if (tag) {
    *text++ = ' ';
    text = laves__put_integer(text, *tag);
  }
  *text++ = '\n';
  return text;
}

static size_t put_tets(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) text = put_row(text, i, mesh->tets[i], 4, mesh->regions ? &mesh->regions[i] : NULL);
  return (size_t)(text - bytes);
}

static size_t put_faces(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  const int32_t one = 1;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) text = put_row(text, i, mesh->faces[i], 3, mesh->face_tags ? &mesh->face_tags[i] : &one);
  return (size_t)(text - bytes);
}

void laves__write_tetgen_node(laves__output *out, const laves_mesh *mesh) {
  out->expected = 60.0 * (double)mesh->vertex_count;
  laves__output_printf(out, "%zu 3 0 0\n", mesh->vertex_count);
  laves__output_items(out, mesh->vertex_count, LAVES__POINT_TEXT_MAX + LAVES__INTEGER_TEXT_MAX + 2, put_points, mesh);
}

void laves__write_tetgen_ele(laves__output *out, const laves_mesh *mesh) {
  out->expected = 35.0 * (double)mesh->tet_count;
  laves__output_printf(out, "%zu 4 %d\n", mesh->tet_count, mesh->regions ? 1 : 0);
  laves__output_items(out, mesh->tet_count, ROW_MAX, put_tets, mesh);
  laves__tag_comments(out, mesh, 3, "# attribute ");
}

void laves__write_tetgen_face(laves__output *out, const laves_mesh *mesh) {
  out->expected = 30.0 * (double)mesh->face_count;
  laves__output_printf(out, "%zu 1\n", mesh->face_count);
  laves__output_items(out, mesh->face_count, ROW_MAX, put_faces, mesh);
  laves__tag_comments(out, mesh, 2, "# marker ");
}
