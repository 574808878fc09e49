/* The regions of a mesh and the named parts of its boundary, counted and measured for JSON. */
#include "groups.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct group {
  int32_t number;
  int64_t count;
  double measure; /* volume or area */
} group;

typedef struct group_list {
  group *items; /* by ascending number */
  size_t count, capacity;
} group_list;

/* The place of a number in the list, made if it is new; NULL when memory is short. */
static group *find_group(group_list *list, int32_t number) {
  size_t low = 0, high = list->count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (list->items[middle].number < number)
      low = middle + 1;
    else
      high = middle;
  }
  if (low < list->count && list->items[low].number == number) return &list->items[low];
  if (list->count == list->capacity) {
    const size_t capacity = list->capacity ? 2 * list->capacity : 16;
    group *items = realloc(list->items, capacity * sizeof *items);
    if (!items) return NULL;
    list->items = items;
    list->capacity = capacity;
  }
  memmove(list->items + low + 1, list->items + low, (list->count - low) * sizeof *list->items);
  list->items[low] = (group){.number = number};
  list->count++;
  return &list->items[low];
}

static void edges_from(const double *points, const int32_t *corners, int count, double edges[3][3]) {
  for (int k = 0; k < count; ++k)
    for (int i = 0; i < 3; ++i) edges[k][i] = points[3 * (size_t)corners[k + 1] + i] - points[3 * (size_t)corners[0] + i];
}

static void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Volume of a tet, or area of a triangle. */
static double measure(const double *points, const int32_t *corners, int corner_count) {
  double e[3][3], n[3];
  edges_from(points, corners, corner_count - 1, e);
  cross(e[0], e[1], n);
  if (corner_count == 3) return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
  return (n[0] * e[2][0] + n[1] * e[2][1] + n[2] * e[2][2]) / 6;
}

/* Elements with `dimension` + 1 corners each. */
static void write_groups(json *out, const char *key, const char *count_key, const char *measure_key, const laves_mesh *mesh,
                         int dimension, const int32_t *corners, const int32_t *numbers, size_t count) {
  group_list list = {0};
  group *at = NULL;
  for (size_t i = 0; i < count; ++i) {
    if (!at || at->number != numbers[i]) at = find_group(&list, numbers[i]);
    if (!at) break;
    at->count++;
    at->measure += measure(laves_mesh_points(mesh), corners + (size_t)(dimension + 1) * i, dimension + 1);
  }
  json_open_array(out, key);
  for (size_t i = 0; i < list.count; ++i) {
    json_open_object(out, NULL);
    json_integer(out, "number", list.items[i].number);
    json_text(out, "name", laves_mesh_group_name(mesh, dimension, list.items[i].number));
    json_integer(out, count_key, list.items[i].count);
    json_number(out, measure_key, list.items[i].measure);
    json_close(out);
  }
  json_close(out);
  free(list.items);
}

void groups_write_json(json *out, const laves_mesh *mesh) {
  if (laves_mesh_regions(mesh))
    write_groups(out, "regions", "tets", "volume", mesh, 3, laves_mesh_tets(mesh), laves_mesh_regions(mesh),
                 laves_mesh_tet_count(mesh));
  if (laves_mesh_face_tags(mesh))
    write_groups(out, "boundaries", "faces", "area", mesh, 2, laves_mesh_faces(mesh), laves_mesh_face_tags(mesh),
                 laves_mesh_face_count(mesh));
}
