/* The boundary as OBJ, PLY and OFF: only vertices that boundary triangles use, in the order of the mesh.
 *
 * OBJ has a group for each face tag; PLY has the tag as the property "label" of each face where there are tags, and their names
 * in comments such as "comment label 3 inlet"; OFF has none. Coordinates are in full: shortest text that reads back the same, or
 * doubles. */
#include <string.h>

#include "io/tag_order.h"
#include "io/write_mesh.h"
#include "io/write_text.h"

/* The vertices that faces use, and each vertex's place among them. */
typedef struct surface {
  const laves_mesh *mesh;
  size_t count;
  int32_t *vertices; /* [count] */
  int32_t *places;   /* [vertex_count]; undefined for unused vertices */
  const laves__tag_order *order;
  size_t first; /* of the group being written */
} surface;

static void free_surface(laves__output *out, surface *s) {
  laves__free(out->context, s->vertices, s->mesh->vertex_count, sizeof *s->vertices);
  laves__free(out->context, s->places, s->mesh->vertex_count, sizeof *s->places);
}

static bool make_surface(laves__output *out, const laves_mesh *mesh, surface *s) {
  *s = (surface){.mesh = mesh};
  s->places = laves__alloc_zeroed(out->context, mesh->vertex_count, sizeof *s->places);
  s->vertices = laves__alloc(out->context, mesh->vertex_count, sizeof *s->vertices);
  if (!s->places || !s->vertices) {
    laves__output_fail_memory(out);
    free_surface(out, s);
    return false;
  }
  for (size_t i = 0; i < mesh->face_count; i++)
    for (int j = 0; j < 3; j++) s->places[mesh->faces[i][j]] = 1;
  for (size_t i = 0; i < mesh->vertex_count; i++) {
    if (!s->places[i]) continue;
    s->vertices[s->count] = (int32_t)i;
    s->places[i] = (int32_t)s->count++;
  }
  out->expected = 60.0 * (double)s->count + 25.0 * (double)mesh->face_count;
  return true;
}

/* Lines "[prefix]x y z". */
static size_t put_points(const surface *s, const char *prefix, size_t begin, size_t end, char *bytes) {
  const size_t length = strlen(prefix);
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    memcpy(text, prefix, length);
    text = laves__put_point(text + length, s->mesh->points[s->vertices[i]]);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

static size_t put_bare_points(const void *user, size_t begin, size_t end, char *bytes) {
  return put_points(user, "", begin, end, bytes);
}

static size_t put_v_points(const void *user, size_t begin, size_t end, char *bytes) {
  return put_points(user, "v ", begin, end, bytes);
}

static void face_corners(const surface *s, size_t i, int32_t corners[3]) {
  for (int j = 0; j < 3; j++) corners[j] = s->places[s->mesh->faces[i][j]];
}

/* ---- OBJ ---- */

static size_t put_f_faces(const void *user, size_t begin, size_t end, char *bytes) {
  const surface *s = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    int32_t corners[3];
    face_corners(s, laves__tag_order_item(s->order, s->first + i), corners);
    *text++ = 'f';
    *text++ = ' ';
    text = laves__put_indices(text, corners, 3, 1);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

void laves__write_obj(laves__output *out, const laves_mesh *mesh) {
  laves__tag_order order;
  surface s;
  if (!laves__tag_order_make(out->context, mesh->face_tags, mesh->face_count, &order)) {
    laves__output_fail_memory(out);
    return;
  }
  if (make_surface(out, mesh, &s)) {
    laves__output_items(out, s.count, LAVES__POINT_TEXT_MAX + 3, put_v_points, &s);
    s.order = &order;
    for (size_t i = 0; i < order.count; i++) {
      char name[LAVES__TAG_NAME_MAX];
      laves__tag_name(mesh, 2, &order, i, name);
      s.first = order.first[i];
      laves__output_printf(out, "g %s\n", name);
      laves__output_items(out, order.first[i + 1] - s.first, 3 * (LAVES__INTEGER_TEXT_MAX + 1) + 3, put_f_faces, &s);
    }
    free_surface(out, &s);
  }
  laves__tag_order_free(out->context, &order);
}

/* ---- OFF, and the text form of PLY ---- */

static size_t put_polygons(const void *user, size_t begin, size_t end, char *bytes) {
  const surface *s = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    int32_t corners[3];
    face_corners(s, i, corners);
    *text++ = '3';
    *text++ = ' ';
    text = laves__put_indices(text, corners, 3, 0);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

static size_t put_labelled_polygons(const void *user, size_t begin, size_t end, char *bytes) {
  const surface *s = user;
  char *text = bytes;
  for (size_t i = begin; i < end; i++) {
    text += put_polygons(s, i, i + 1, text);
    text[-1] = ' ';
    text = laves__put_integer(text, s->mesh->face_tags[i]);
    *text++ = '\n';
  }
  return (size_t)(text - bytes);
}

enum { POLYGON_TEXT_MAX = 4 * (LAVES__INTEGER_TEXT_MAX + 1) + 3 };

void laves__write_off(laves__output *out, const laves_mesh *mesh) {
  surface s;
  if (!make_surface(out, mesh, &s)) return;
  laves__output_printf(out, "OFF\n%zu %zu 0\n", s.count, mesh->face_count);
  laves__output_items(out, s.count, LAVES__POINT_TEXT_MAX + 1, put_bare_points, &s);
  laves__output_items(out, mesh->face_count, POLYGON_TEXT_MAX, put_polygons, &s);
  free_surface(out, &s);
}

/* ---- PLY ---- */

static size_t pack_points(const void *user, size_t begin, size_t end, char *bytes) {
  const surface *s = user;
  for (size_t i = begin; i < end; i++, bytes += sizeof(laves__vec3))
    memcpy(bytes, &s->mesh->points[s->vertices[i]], sizeof(laves__vec3));
  return (end - begin) * sizeof(laves__vec3);
}

enum { PLY_FACE_BYTES = 1 + 3 * 4, PLY_LABEL_BYTES = 4 };

static size_t pack_polygons(const void *user, size_t begin, size_t end, char *bytes) {
  const surface *s = user;
  const int32_t *labels = s->mesh->face_tags;
  const char *start = bytes;
  for (size_t i = begin; i < end; i++) {
    int32_t corners[3];
    face_corners(s, i, corners);
    bytes[0] = 3;
    memcpy(bytes + 1, corners, sizeof corners);
    bytes += PLY_FACE_BYTES;
    if (!labels) continue;
    memcpy(bytes, &labels[i], PLY_LABEL_BYTES);
    bytes += PLY_LABEL_BYTES;
  }
  return (size_t)(bytes - start);
}

void laves__write_ply(laves__output *out, const laves_mesh *mesh, bool ascii) {
  surface s;
  if (!make_surface(out, mesh, &s)) return;
  laves__output_printf(out, "ply\nformat %s 1.0\ncomment boundary of a tetrahedral mesh, by laves\n",
                       ascii ? "ascii" : "binary_little_endian");
  laves__tag_comments(out, mesh, 2, "comment label ");
  laves__output_printf(out,
                       "element vertex %zu\nproperty double x\nproperty double y\nproperty double z\n"
                       "element face %zu\nproperty list uchar int vertex_indices\n%send_header\n",
                       s.count, mesh->face_count, mesh->face_tags ? "property int label\n" : "");
  if (ascii) {
    laves__output_items(out, s.count, LAVES__POINT_TEXT_MAX + 1, put_bare_points, &s);
    laves__output_items(out, mesh->face_count, POLYGON_TEXT_MAX, mesh->face_tags ? put_labelled_polygons : put_polygons, &s);
  } else {
    laves__output_items(out, s.count, sizeof(laves__vec3), pack_points, &s);
    laves__output_items(out, mesh->face_count, PLY_FACE_BYTES + PLY_LABEL_BYTES, pack_polygons, &s);
  }
  free_surface(out, &s);
}
