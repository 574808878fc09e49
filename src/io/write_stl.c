/* The boundary as STL.  Binary: 80 bytes of header, a count, and for each triangle its normal and corners as floats and two
 * unused bytes; floats round the coordinates to 24 bits. Text: one solid for each face tag, coordinates in full. */
#include <string.h>

#include "io/tag_order.h"
#include "io/write_mesh.h"
#include "io/write_text.h"

enum { TRIANGLE_BYTES = 50, HEADER_BYTES = 80 };

static laves__vec3 normal(const laves_mesh *mesh, const int32_t face[3]) {
  const laves__vec3 a = mesh->points[face[0]], b = mesh->points[face[1]], c = mesh->points[face[2]];
  return v3_unit(v3_cross(v3_sub(b, a), v3_sub(c, a)));
}

static char *pack_vector(char *bytes, laves__vec3 v) {
  const float xyz[3] = {(float)v.x, (float)v.y, (float)v.z};
  memcpy(bytes, xyz, sizeof xyz);
  return bytes + sizeof xyz;
}

static size_t pack_triangles(const void *user, size_t begin, size_t end, char *bytes) {
  const laves_mesh *mesh = user;
  for (size_t i = begin; i < end; i++) {
    const int32_t *face = mesh->faces[i];
    bytes = pack_vector(bytes, normal(mesh, face));
    for (int j = 0; j < 3; j++) bytes = pack_vector(bytes, mesh->points[face[j]]);
    *bytes++ = 0;
    *bytes++ = 0;
  }
  return (end - begin) * TRIANGLE_BYTES;
}

void laves__write_stl_binary(laves__output *out, const laves_mesh *mesh) {
  if (mesh->face_count > UINT32_MAX) {
    laves__output_fail(out, LAVES_ERROR_WRITE, "a binary STL file holds at most 4294967295 triangles; choose another format");
    return;
  }
  /* Must not begin with "solid", which would mean text. */
  char header[HEADER_BYTES] = "boundary of a tetrahedral mesh, by laves";
  const uint32_t count = (uint32_t)mesh->face_count;
  out->expected = (double)count * TRIANGLE_BYTES;
  laves__output_bytes(out, header, sizeof header);
  laves__output_bytes(out, &count, sizeof count);
  laves__output_items(out, count, TRIANGLE_BYTES, pack_triangles, mesh);
}

typedef struct part {
  const laves_mesh *mesh;
  const laves__tag_order *order;
  size_t first;
} part;

static char *put(char *text, const char *words) {
  const size_t length = strlen(words);
  memcpy(text, words, length);
  return text + length;
}

static size_t put_triangles(const void *user, size_t begin, size_t end, char *bytes) {
  const part *p = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    const int32_t *face = p->mesh->faces[laves__tag_order_item(p->order, p->first + i)];
    text = laves__put_point(put(text, "facet normal "), normal(p->mesh, face));
    text = put(text, "\nouter loop\n");
    for (int j = 0; j < 3; j++) {
      text = laves__put_point(put(text, "vertex "), p->mesh->points[face[j]]);
      *text++ = '\n';
    }
    text = put(text, "endloop\nendfacet\n");
  }
  return (size_t)(text - bytes);
}

void laves__write_stl_text(laves__output *out, const laves_mesh *mesh) {
  laves__tag_order order;
  if (!laves__tag_order_make(out->context, mesh->face_tags, mesh->face_count, &order)) {
    laves__output_fail_memory(out);
    return;
  }
  out->expected = 270.0 * (double)mesh->face_count;
  for (size_t i = 0; i < order.count; i++) {
    char name[LAVES__TAG_NAME_MAX];
    laves__tag_name(mesh, 2, &order, i, name);
    const part p = {mesh, &order, order.first[i]};
    laves__output_printf(out, "solid %s\n", name);
    laves__output_items(out, order.first[i + 1] - p.first, 4 * LAVES__POINT_TEXT_MAX + 70, put_triangles, &p);
    laves__output_printf(out, "endsolid %s\n", name);
  }
  laves__tag_order_free(out->context, &order);
}
