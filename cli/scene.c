/* The triangles of a mesh that can be seen, with their colours.
 *
 * Input: a mesh and, perhaps, a cutting plane. Output: the faces that exactly one of the kept tetrahedra owns.
 * Whole tetrahedra are kept or dropped, never cut, so that the picture of a section shows the elements themselves.
 *
 * A face can only be exposed when its three corners all lie on the boundary or on a dropped tetrahedron. Such vertices
 * are marked first, and only faces between three marked ones are matched in a hash table, which therefore grows with
 * the surface and not with the volume. */
#include "scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "interrupt.h"
#include "tet_shape.h"

enum { dropped_side = 1, near_face = 2 };

/* A face by its sorted corners; `owner` is 4 * tet + corner of the kept tetrahedron, `kept` and `all` count owners. */
typedef struct face_entry {
  int32_t key[3];
  uint8_t kept, all;
  int64_t owner;
} face_entry;

typedef struct face_table {
  face_entry *entries;
  size_t mask, count;
} face_table;

static bool table_reserve(face_table *table, size_t capacity) {
  size_t size = 1024;
  while (size < capacity) {
    size *= 2;
  }
  table->entries = calloc(size, sizeof *table->entries);
  table->mask = size - 1;
  table->count = 0;
  return table->entries != NULL;
}

static face_entry *table_find(face_table *table, const int32_t key[3]) {
  uint64_t hash = (uint32_t)key[0] * UINT64_C(0x9e3779b97f4a7c15);
  hash = (hash ^ (uint32_t)key[1]) * UINT64_C(0xbf58476d1ce4e5b9);
  hash = (hash ^ (uint32_t)key[2]) * UINT64_C(0x94d049bb133111eb);
  size_t slot = (size_t)(hash >> 20) & table->mask;
  while (table->entries[slot].all > 0 && memcmp(table->entries[slot].key, key, sizeof table->entries[slot].key) != 0) {
    slot = (slot + 1) & table->mask;
  }
  return &table->entries[slot];
}

static bool table_grow(face_table *table) {
  face_table bigger;
  if (!table_reserve(&bigger, 4 * (table->mask + 1))) {
    return false;
  }
  for (size_t i = 0; i <= table->mask; i++) {
    if (table->entries[i].all > 0) {
      *table_find(&bigger, table->entries[i].key) = table->entries[i];
    }
  }
  bigger.count = table->count;
  free(table->entries);
  *table = bigger;
  return true;
}

static void sort3(int32_t v[3]) {
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < 2; i++) {
      if (v[i] > v[i + 1]) {
        int32_t swap = v[i];
        v[i] = v[i + 1];
        v[i + 1] = swap;
      }
    }
  }
}

static bool table_add(face_table *table, const int32_t corners[3], int64_t owner, bool kept) {
  int32_t key[3] = {corners[0], corners[1], corners[2]};
  sort3(key);
  if (2 * table->count > table->mask && !table_grow(table)) {
    return false;
  }
  face_entry *entry = table_find(table, key);
  if (entry->all == 0) {
    memcpy(entry->key, key, sizeof entry->key);
    table->count++;
  }
  entry->all += entry->all < UINT8_MAX;
  if (kept) {
    entry->kept += entry->kept < UINT8_MAX;
    entry->owner = owner;
  }
  return true;
}

/* Whether a tetrahedron has every corner on the kept side; `marks` of laves_mesh_points. */
static bool tet_is_kept(const int32_t tet[4], const uint8_t *marks) {
  return !((marks[tet[0]] | marks[tet[1]] | marks[tet[2]] | marks[tet[3]]) & dropped_side);
}

static uint8_t *mark_vertices(const laves_mesh *mesh, const scene_options *options) {
  size_t vertex_count = laves_mesh_vertex_count(mesh), tet_count = laves_mesh_tet_count(mesh);
  const double *points = laves_mesh_points(mesh);
  const int32_t *tets = laves_mesh_tets(mesh), *faces = laves_mesh_faces(mesh);
  uint8_t *marks = calloc(vertex_count + 1, 1);
  if (!marks) {
    return NULL;
  }
  for (size_t i = 0; options->cut && i < vertex_count; i++) {
    const double *p = points + 3 * i, *plane = options->plane;
    marks[i] = plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] > plane[3] ? dropped_side : 0;
  }
  for (size_t i = 0; i < 3 * laves_mesh_face_count(mesh); i++) {
    marks[faces[i]] |= near_face;
  }
  for (size_t i = 0; options->cut && i < tet_count; i++) {
    if (!tet_is_kept(tets + 4 * i, marks)) {
      for (int k = 0; k < 4; k++) {
        marks[tets[4 * i + (size_t)k]] |= near_face;
      }
    }
  }
  return marks;
}

/* Matches the faces that may be exposed; false when memory is short or the work is to stop. */
static bool collect_faces(const laves_mesh *mesh, const uint8_t *marks, face_table *table, size_t *kept_tets) {
  const int32_t *tets = laves_mesh_tets(mesh);
  size_t tet_count = laves_mesh_tet_count(mesh);
  for (size_t i = 0; i < tet_count; i++) {
    const int32_t *tet = tets + 4 * i;
    if (interrupt_asked()) {
      return false;
    }
    bool kept = tet_is_kept(tet, marks);
    *kept_tets += kept;
    for (int f = 0; f < 4; f++) {
      int32_t corners[3] = {tet[tet_face[f][0]], tet[tet_face[f][1]], tet[tet_face[f][2]]};
      int common = marks[corners[0]] & marks[corners[1]] & marks[corners[2]];
      int any = marks[corners[0]] | marks[corners[1]] | marks[corners[2]];
      if (common & near_face && !(any & dropped_side) && !table_add(table, corners, 4 * (int64_t)i + f, kept)) {
        return false;
      }
    }
  }
  return true;
}

static void subtract(const double a[3], const double b[3], double out[3]) {
  for (int i = 0; i < 3; i++) {
    out[i] = a[i] - b[i];
  }
}

static void cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The range that colours span. Where sizes hardly vary it is wider than theirs, lest a uniform mesh look graded. */
static void size_range(const laves_mesh *mesh, double range[2]) {
  static const double least_span = 4;
  double low = INFINITY, high = 0, p[4][3];
  for (size_t i = 0; i < laves_mesh_tet_count(mesh) && !interrupt_asked(); i++) {
    tet_corners(mesh, (int64_t)i, p);
    low = fmin(low, tet_edge_length(p));
    high = fmax(high, tet_edge_length(p));
  }
  double widen = sqrt(fmax(1, least_span * low / high));
  range[0] = low / widen;
  range[1] = high * widen;
}

/* sRGB to linear light. */
static void linear_colour(uint32_t rgb, float out[3]) {
  for (int i = 0; i < 3; i++) {
    double s = (rgb >> (16 - 8 * i) & 255) / 255.0;
    out[i] = (float)(s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4));
  }
}

/* A colour of a scale at `value`. */
typedef struct colour_stop {
  double value;
  uint32_t rgb;
} colour_stop;

static void scale_colour(const colour_stop *stops, int count, double value, float out[3]) {
  int k = 0;
  while (k < count - 2 && value > stops[k + 1].value) {
    k++;
  }
  double t = fmax(0, fmin(1, (value - stops[k].value) / (stops[k + 1].value - stops[k].value)));
  float low[3], high[3];
  linear_colour(stops[k].rgb, low);
  linear_colour(stops[k + 1].rgb, high);
  for (int i = 0; i < 3; i++) {
    out[i] = (float)(low[i] + t * (high[i] - low[i]));
  }
}

/* Red for 0 through amber to blue for 1. */
static void score_colour(double score, float out[3]) {
  static const colour_stop stops[] = {{0, 0x8c1c3a},   {0.3, 0xd9482f},  {0.5, 0xf2a541},
                                      {0.7, 0xf4e3a1}, {0.85, 0x8cc5b4}, {1, 0x3d7ea6}};
  scale_colour(stops, sizeof stops / sizeof *stops, score, out);
}

/* Purple for the shortest edges through green to yellow for the longest, by their logarithm. */
static void size_colour(double length, const double range[2], float out[3]) {
  static const colour_stop stops[] = {{0, 0x6a3d9a}, {0.25, 0x4a78b8}, {0.5, 0x46ab9c}, {0.75, 0xa3cf62}, {1, 0xfbe78a}};
  scale_colour(stops, sizeof stops / sizeof *stops, log(length / range[0]) / log(range[1] / range[0]), out);
}

/* Colours of the surface and of the inside; the inside of further regions takes the further ones. */
static void class_colour(bool boundary, int32_t region, float out[3]) {
  static const uint32_t inside[] = {0xffd070, 0x9fc66d, 0xe58f7b, 0xb79ad6, 0x6fc3c0, 0xd9b48f};
  enum { inside_count = sizeof inside / sizeof inside[0] };
  uint32_t row = (uint32_t)(region - 1) % inside_count;
  linear_colour(boundary ? 0x8fb8dc : inside[row], out);
}

/* Where distances are told apart: what is no part of the surface is grey. */
static const uint32_t neutral = 0xcfcfcf;

static void tet_colour(double p[4][3], scene_colour colour, const double sizes[2], float out[3]) {
  if (colour == SCENE_SIZE) {
    size_colour(tet_edge_length(p), sizes, out);
  } else {
    score_colour(colour == SCENE_QUALITY ? tet_volume_length(p) : tet_dihedral_score(p), out);
  }
}

/* Places the face of a tetrahedron opposite a corner; colours are left to the caller. */
static void place_face(const laves_mesh *mesh, int64_t tet, int corner, double p[4][3], scene_face *out) {
  double u[3], v[3], inwards[3];
  for (int k = 0; k < 3; k++) {
    memcpy(out->points[k], p[tet_face[corner][k]], sizeof p[k]);
    out->vertex[k] = laves_mesh_tets(mesh)[4 * tet + tet_face[corner][k]];
  }
  out->boundary = false;
  out->creases = 0;
  subtract(out->points[1], out->points[0], u);
  subtract(out->points[2], out->points[0], v);
  subtract(p[corner], out->points[0], inwards);
  cross(u, v, out->normal);
  double length = sqrt(dot(out->normal, out->normal));
  double scale = length > 0 ? (dot(out->normal, inwards) > 0 ? -1 : 1) / length : 0;
  for (int i = 0; i < 3; i++) {
    out->normal[i] *= scale;
  }
}

static void fill_face(const laves_mesh *mesh, const face_entry *entry, scene_colour colour, const double sizes[2],
                      scene_face *out) {
  const int32_t *regions = laves_mesh_regions(mesh);
  int64_t tet = entry->owner / 4;
  double p[4][3];
  tet_corners(mesh, tet, p);
  place_face(mesh, tet, (int)(entry->owner % 4), p, out);
  out->boundary = entry->all == 1;
  if (colour == SCENE_CLASS) {
    class_colour(entry->all == 1, regions ? regions[tet] : 1, out->colour);
  } else if (colour == SCENE_DISTANCE) {
    linear_colour(neutral, out->colour);
  } else {
    tet_colour(p, colour, sizes, out->colour);
  }
}

/* ---- single tetrahedra ---- */

/* The scores of the worst so far, worst first: a new one is put in its place. */
static size_t insert_worst(int64_t *tets, double *scores, size_t count, size_t capacity, int64_t tet, double score) {
  if (count == capacity && !(score < scores[count - 1])) {
    return count;
  }
  size_t place = count < capacity ? count : count - 1;
  for (; place > 0 && score < scores[place - 1]; place--) {
    tets[place] = tets[place - 1];
    scores[place] = scores[place - 1];
  }
  tets[place] = tet;
  scores[place] = score;
  return count < capacity ? count + 1 : count;
}

size_t scene_worst_tets(const laves_mesh *mesh, scene_colour colour, int64_t *tets, double *scores, size_t capacity) {
  size_t count = 0;
  double p[4][3];
  for (size_t i = 0; i < laves_mesh_tet_count(mesh) && capacity > 0 && !interrupt_asked(); i++) {
    tet_corners(mesh, (int64_t)i, p);
    double score = colour == SCENE_QUALITY ? tet_volume_length(p) : tet_dihedral_score(p);
    count = insert_worst(tets, scores, count, capacity, (int64_t)i, score);
  }
  return count;
}

bool scene_build_tets(const laves_mesh *mesh, const int64_t *tets, size_t count, scene_colour colour, scene *out) {
  *out = (scene){.faces = calloc(4 * count + 1, sizeof *out->faces), .face_count = 4 * count, .kept_tets = count};
  for (size_t i = 0; out->faces && i < count; i++) {
    double p[4][3];
    tet_corners(mesh, tets[i], p);
    for (int f = 0; f < 4; f++) {
      scene_face *face = &out->faces[4 * i + (size_t)f];
      place_face(mesh, tets[i], f, p, face);
      tet_colour(p, colour == SCENE_QUALITY ? SCENE_QUALITY : SCENE_DIHEDRAL, out->sizes, face->colour);
    }
  }
  return out->faces != NULL;
}

void scene_colour_distances(scene *subject, const double *distances, double furthest) {
  for (size_t i = 0; i < subject->face_count; i++) {
    if (subject->faces[i].boundary) {
      score_colour(1 - (furthest > 0 ? fmin(1, distances[i] / furthest) : 0), subject->faces[i].colour);
    }
  }
}

/* ---- creases ---- */

/* An edge by its sorted ends, and where it was met first: 3 * face + the corner that it is opposite to. */
typedef struct edge_entry {
  int32_t low, high;
  int64_t first; /* plus one; 0: free */
} edge_entry;

static edge_entry *edge_find(edge_entry *table, size_t mask, int32_t low, int32_t high) {
  uint64_t hash = ((uint32_t)low * UINT64_C(0x9e3779b97f4a7c15) ^ (uint32_t)high) * UINT64_C(0xbf58476d1ce4e5b9);
  size_t slot = (size_t)(hash >> 20) & mask;
  while (table[slot].first && (table[slot].low != low || table[slot].high != high)) {
    slot = (slot + 1) & mask;
  }
  return &table[slot];
}

static void mark_edge(scene *out, edge_entry *table, size_t mask, int64_t half, double cosine) {
  scene_face *face = &out->faces[half / 3];
  int32_t a = face->vertex[(half % 3 + 1) % 3], b = face->vertex[(half % 3 + 2) % 3];
  edge_entry *edge = edge_find(table, mask, a < b ? a : b, a < b ? b : a);
  if (!edge->first) {
    *edge = (edge_entry){a < b ? a : b, a < b ? b : a, half + 1};
    return;
  }
  scene_face *other = &out->faces[(edge->first - 1) / 3];
  if (dot(face->normal, other->normal) < cosine) {
    face->creases |= (uint8_t)(1 << half % 3);
    other->creases |= (uint8_t)(1 << (edge->first - 1) % 3);
  }
}

/* Edges between two faces of the boundary that are turned against one another. Returns false when memory is short. */
static bool mark_creases(scene *out, double angle) {
  size_t size = 1024;
  while (size < 4 * out->face_count) {
    size *= 2;
  }
  edge_entry *table = calloc(size, sizeof *table);
  if (!table) {
    return false;
  }
  for (size_t i = 0; i < 3 * out->face_count && !interrupt_asked(); i++) {
    if (out->faces[i / 3].boundary) {
      mark_edge(out, table, size - 1, (int64_t)i, cos(angle * 3.14159265358979323846 / 180));
    }
  }
  free(table);
  return true;
}

bool scene_build(const laves_mesh *mesh, const scene_options *options, scene *out) {
  bool done = false;
  face_table table = {0};
  *out = (scene){0};
  uint8_t *marks = mark_vertices(mesh, options);
  if (!marks || !table_reserve(&table, 4 * laves_mesh_face_count(mesh)) || !collect_faces(mesh, marks, &table, &out->kept_tets)) {
    goto done;
  }
  out->faces = calloc(table.count + 1, sizeof *out->faces);
  if (!out->faces) {
    goto done;
  }
  if (options->colour == SCENE_SIZE) {
    size_range(mesh, out->sizes);
  }
  for (size_t i = 0; i <= table.mask && !interrupt_asked(); i++) {
    if (table.entries[i].kept == 1) {
      fill_face(mesh, &table.entries[i], options->colour, out->sizes, &out->faces[out->face_count++]);
    }
  }
  done = (!(options->crease_angle > 0) || mark_creases(out, options->crease_angle)) && !interrupt_asked();
done:
  free(marks);
  free(table.entries);
  return done;
}

void scene_free(scene *subject) {
  free(subject->faces);
  *subject = (scene){0};
}
