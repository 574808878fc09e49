/* Which tetrahedron has a boundary face, and which faces lie open when whole tetrahedra on one side of a plane are taken away.
 *
 * Both match faces by their sorted corners in a hash table that holds only those that can matter: of the boundary, or between
 * three vertices that have tetrahedra on both sides of the plane. So tables grow with the surface, not with the volume. */
#include "report_faces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "interrupt.h"

const int report_tet_face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

enum { BELOW = 1, ABOVE = 2 };

typedef struct face_entry {
  int32_t key[3];
  uint32_t value;
  bool used, above;
} face_entry;

typedef struct face_table {
  face_entry *entries;
  size_t mask, count;
} face_table;

static bool table_reserve(face_table *table, size_t capacity) {
  size_t size = 1024;
  while (size < capacity) size *= 2;
  *table = (face_table){.entries = calloc(size, sizeof *table->entries), .mask = size - 1};
  return table->entries != NULL;
}

static void sort_corners(const int32_t *corners, int32_t key[3]) {
  const int32_t a = corners[0], b = corners[1], c = corners[2];
  const int32_t low = a < b ? a : b, high = a < b ? b : a;
  key[0] = low < c ? low : c;
  key[2] = high > c ? high : c;
  key[1] = low < c ? (high < c ? high : c) : low;
}

static face_entry *table_find(face_table *table, const int32_t key[3]) {
  uint64_t hash = (uint32_t)key[0] * UINT64_C(0x9e3779b97f4a7c15);
  hash = (hash ^ (uint32_t)key[1]) * UINT64_C(0xbf58476d1ce4e5b9);
  hash = (hash ^ (uint32_t)key[2]) * UINT64_C(0x94d049bb133111eb);
  size_t slot = (size_t)(hash >> 20) & table->mask;
  while (table->entries[slot].used && memcmp(table->entries[slot].key, key, sizeof table->entries[slot].key) != 0)
    slot = (slot + 1) & table->mask;
  return &table->entries[slot];
}

static bool table_grow(face_table *table) {
  face_table bigger;
  if (!table_reserve(&bigger, 4 * (table->mask + 1))) return false;
  for (size_t i = 0; i <= table->mask; ++i)
    if (table->entries[i].used) *table_find(&bigger, table->entries[i].key) = table->entries[i];
  bigger.count = table->count;
  free(table->entries);
  *table = bigger;
  return true;
}

static bool in_range(const laves_mesh *mesh, const int32_t *corners, int count) {
  for (int i = 0; i < count; ++i)
    if (corners[i] < 0 || (size_t)corners[i] >= laves_mesh_vertex_count(mesh)) return false;
  return true;
}

static void face_key(const int32_t *tet, int face, int32_t key[3]) {
  const int *at = report_tet_face[face];
  sort_corners((const int32_t[3]){tet[at[0]], tet[at[1]], tet[at[2]]}, key);
}

/* ---- owners ---- */

static void find_owners(const laves_mesh *mesh, face_table *table, const uint8_t *marks, uint32_t *owners) {
  for (size_t t = 0; t < laves_mesh_tet_count(mesh) && !interrupt_asked(); ++t) {
    const int32_t *tet = laves_mesh_tets(mesh) + 4 * t;
    if (!in_range(mesh, tet, 4) || marks[tet[0]] + marks[tet[1]] + marks[tet[2]] + marks[tet[3]] < 3) continue;
    for (int f = 0; f < 4; ++f) {
      int32_t key[3];
      face_key(tet, f, key);
      if (!(marks[key[0]] & marks[key[1]] & marks[key[2]])) continue;
      const face_entry *entry = table_find(table, key);
      if (entry->used) owners[entry->value] = (uint32_t)(4 * t + (size_t)f);
    }
  }
}

bool report_face_owners(const laves_mesh *mesh, uint32_t *owners) {
  const size_t count = laves_mesh_face_count(mesh);
  uint8_t *marks = calloc(laves_mesh_vertex_count(mesh) + 1, 1);
  face_table table = {0};
  const bool ready = marks && table_reserve(&table, 3 * count);
  for (size_t i = 0; ready && i < count; ++i) {
    const int32_t *face = laves_mesh_faces(mesh) + 3 * i;
    int32_t key[3];
    owners[i] = UINT32_MAX;
    if (!in_range(mesh, face, 3)) continue;
    sort_corners(face, key);
    face_entry *entry = table_find(&table, key);
    *entry = (face_entry){.key = {key[0], key[1], key[2]}, .value = (uint32_t)i, .used = true};
    for (int k = 0; k < 3; ++k) marks[key[k]] = 1;
  }
  if (ready) find_owners(mesh, &table, marks, owners);
  free(table.entries);
  free(marks);
  return ready && !interrupt_asked();
}

/* ---- sections ---- */

typedef struct cutter {
  const laves_mesh *mesh;
  const float *centroids;
  float position;
  uint8_t *marks;
  face_table table;
  report_section *section;
} cutter;

static void section_add(report_section *section, const face_entry *entry, uint32_t tet, bool above) {
  report_open_face *face = &section->faces[section->count++];
  memcpy(face->corners, entry->key, sizeof face->corners);
  face->low = above ? entry->value : tet;
  face->high = above ? tet : entry->value;
}

/* A face that comes a second time, from the other side of the plane, is open. */
static bool match_faces(cutter *cut, uint32_t tet) {
  const int32_t *corners = laves_mesh_tets(cut->mesh) + 4 * (size_t)tet;
  const bool above = cut->centroids[tet] > cut->position;
  for (int f = 0; f < 4; ++f) {
    int32_t key[3];
    face_key(corners, f, key);
    if ((cut->marks[key[0]] & cut->marks[key[1]] & cut->marks[key[2]]) != (BELOW | ABOVE)) continue;
    if (2 * cut->table.count > cut->table.mask && !table_grow(&cut->table)) return false;
    face_entry *entry = table_find(&cut->table, key);
    if (!entry->used) {
      *entry = (face_entry){.key = {key[0], key[1], key[2]}, .value = tet, .used = true, .above = above};
      ++cut->table.count;
    } else if (entry->above != above) {
      section_add(cut->section, entry, tet, above);
      entry->above = above; /* no third tet has it, but in meshes that are not valid */
    }
  }
  return true;
}

static void mark_corners(const cutter *cut, uint32_t tet, bool clear) {
  const int32_t *corners = laves_mesh_tets(cut->mesh) + 4 * (size_t)tet;
  const uint8_t side = cut->centroids[tet] > cut->position ? ABOVE : BELOW;
  for (int k = 0; k < 4; ++k) cut->marks[corners[k]] = clear ? 0 : cut->marks[corners[k]] | side;
}

/* Whether a tetrahedron's centroid is within reach of the plane; not where it is NAN, for its corners are out of range then. */
static bool is_near(const cutter *cut, size_t tet, float reach) { return fabsf(cut->centroids[tet] - cut->position) <= reach; }

/* The tetrahedra that are near; NULL when memory is short. */
static uint32_t *find_near(const cutter *cut, float reach, size_t *count) {
  const size_t tet_count = laves_mesh_tet_count(cut->mesh);
  size_t capacity = 1;
  for (size_t t = 0; t < tet_count; ++t) capacity += is_near(cut, t, reach);
  uint32_t *near = malloc(capacity * sizeof *near);
  *count = 0;
  for (size_t t = 0; near && t < tet_count; ++t)
    if (is_near(cut, t, reach)) near[(*count)++] = (uint32_t)t;
  return near;
}

bool report_section_make(const laves_mesh *mesh, const float *centroids, float position, float reach, uint8_t *marks,
                         report_section *section) {
  cutter cut = {.mesh = mesh, .centroids = centroids, .position = position, .marks = marks, .section = section};
  size_t count;
  *section = (report_section){0};
  uint32_t *near = find_near(&cut, reach, &count);
  section->faces = malloc((4 * count + 1) * sizeof *section->faces); /* each tet has four */
  bool done = near && section->faces && table_reserve(&cut.table, count);
  for (size_t i = 0; done && i < count; ++i) mark_corners(&cut, near[i], false);
  for (size_t i = 0; done && i < count; ++i) done = !interrupt_asked() && match_faces(&cut, near[i]);
  for (size_t i = 0; near && i < count; ++i) mark_corners(&cut, near[i], true);
  free(cut.table.entries);
  free(near);
  return done;
}
