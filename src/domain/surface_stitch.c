/* T-junctions: open edges on which points of other open edges stand.
 *
 * In: a surface with open edges.  Out: the same with the faces at such edges parted, so that edges meet edges.
 *
 *        c                 c          Exports of solid modellers and of meshes that were refined in part are full of them: the
 *       / \               /|\         surface is closed to the eye, and no two of these edges are the same. A point counts that
 *      /   \     ->      / | \        is as near to the edge as cracks are mended, and further from its ends. A face is parted
 *     /     \           /  |  \       at one of its edges at a time, in a few rounds.
 *    a___q___b         a___q___b */
#include <stdlib.h>
#include <string.h>

#include "domain/surface.h"

/* How near a point must be to an edge, as a share of the diagonal: as the middle one of the tolerances for cracks. */
static const double tolerance = 1e-5;

enum { ROUNDS_MAX = 6 };
/* Edges and points looked at between two reports of progress: some milliseconds. */
enum { WORK_PER_REPORT = 1 << 14 };

/* A point on an open edge, which starts at half-edge `half`. */
typedef struct junction {
  uint32_t half, point;
  double along; /* 0..1 */
} junction;

typedef struct stitcher {
  laves__surface *s;
  double reach;
  uint32_t *open; /* half-edges of edges with one face */
  size_t open_count, open_capacity;
  uint32_t *order; /* [open_count] which of them stands at each slot of the tree */
  size_t order_capacity;
  laves__bvh tree;  /* over the open edges */
  uint32_t current; /* the point in question */
  junction *found;
  size_t found_count, found_capacity;
  size_t work; /* edges and points looked at since progress was reported */
  bool short_of_memory;
} stitcher;

static uint32_t start_of(const laves__surface *s, uint32_t half) { return s->faces[half / 3][half % 3]; }
static uint32_t end_of(const laves__surface *s, uint32_t half) { return s->faces[half / 3][(half % 3 + 1) % 3]; }

/* ---- finding ---- */

static void note_open(void *user, laves__edge_use *uses, size_t count) {
  stitcher *t = user;
  if (count != 1 || t->short_of_memory) return;
  t->short_of_memory = !laves__grow(t->s->context, &t->open, &t->open_capacity, t->open_count + 1, sizeof *t->open);
  if (!t->short_of_memory) t->open[t->open_count++] = uses[0].half;
}

static bool build_tree(stitcher *t) {
  laves__surface *s = t->s;
  uint32_t(*edges)[3] = laves__alloc(s->context, t->open_count, sizeof *edges);
  t->order = laves__alloc(s->context, t->open_count, sizeof *t->order);
  if (t->order) t->order_capacity = t->open_count;
  bool done = edges && t->order;
  for (size_t i = 0; done && i < t->open_count; i++) {
    edges[i][0] = start_of(s, t->open[i]);
    edges[i][1] = edges[i][2] = end_of(s, t->open[i]);
  }
  done = done && laves__bvh_build(s->context, s->points, (const uint32_t(*)[3])edges, t->open_count, t->order, &t->tree);
  laves__free(s->context, edges, t->open_count, sizeof *edges);
  return done;
}

/* The tree hands over the edges near the current point. */
static void judge_edge(void *user, uint32_t slot) {
  stitcher *t = user;
  const laves__surface *s = t->s;
  t->work++;
  const uint32_t half = t->open[t->order[slot]], a = start_of(s, half), b = end_of(s, half);
  if (t->current == a || t->current == b || t->short_of_memory) return;
  const laves__vec3 p = s->points[t->current], u = s->points[a], uv = v3_sub(s->points[b], u);
  const double length2 = v3_norm2(uv), along = v3_dot(v3_sub(p, u), uv) / length2;
  const double room = t->reach / sqrt(length2);
  if (!(along > room && along < 1 - room) || v3_distance(p, v3_mad(u, uv, along)) > t->reach) return;
  t->short_of_memory = !laves__grow(s->context, &t->found, &t->found_capacity, t->found_count + 1, sizeof *t->found);
  if (!t->short_of_memory) t->found[t->found_count++] = (junction){half, t->current, along};
}

static int compare_junctions(const void *a, const void *b) {
  const junction *x = a, *y = b;
  if (x->half != y->half) return x->half < y->half ? -1 : 1;
  if (x->along != y->along) return x->along < y->along ? -1 : 1;
  return (x->point > y->point) - (x->point < y->point);
}

static bool is_cancelled(stitcher *t) {
  if (++t->work < WORK_PER_REPORT) return false;
  t->work = 0;
  return laves__cancelled(t->s->context, "surface", 0.3);
}

/* Every point of an open edge is asked once, from the edge that ends at it. False when memory is short or it is cancelled. */
static bool find_junctions(stitcher *t) {
  const laves__surface *s = t->s;
  t->open_count = t->found_count = 0;
  if (!laves__surface_each_edge(s, note_open, t) || t->short_of_memory) return false;
  if (t->open_count == 0) return true;
  if (!build_tree(t)) return false;
  const laves__vec3 around = v3(t->reach, t->reach, t->reach);
  for (size_t i = 0; i < 2 * t->open_count; i++) {
    if (is_cancelled(t)) return false;
    t->current = i % 2 ? end_of(s, t->open[i / 2]) : start_of(s, t->open[i / 2]);
    const laves__vec3 p = s->points[t->current];
    laves__bvh_overlaps(&t->tree, (laves__box3){v3_sub(p, around), v3_add(p, around)}, judge_edge, t);
  }
  if (t->found_count) qsort(t->found, t->found_count, sizeof *t->found, compare_junctions);
  return !t->short_of_memory;
}

/* ---- parting ---- */

/* Room for `count` faces; all or nothing. What topology makes of faces is given up. */
static bool grow_faces(laves__surface *s, size_t count) {
  laves_context *context = s->context;
  const size_t old = s->face_capacity, wanted = count > 2 * old ? count : 2 * old;
  if (count <= old) return true;
  uint32_t(*faces)[3] = laves__alloc(context, wanted, sizeof *faces);
  int32_t *tags = s->tags ? laves__alloc(context, wanted, sizeof *tags) : NULL;
  uint32_t *sources = laves__alloc(context, wanted, sizeof *sources);
  uint8_t *flags = laves__alloc_zeroed(context, wanted, sizeof *flags);
  if (!faces || (s->tags && !tags) || !sources || !flags) {
    laves__free(context, faces, wanted, sizeof *faces);
    laves__free(context, tags, wanted, sizeof *tags);
    laves__free(context, sources, wanted, sizeof *sources);
    laves__free(context, flags, wanted, sizeof *flags);
    return false;
  }
  memcpy(faces, s->faces, s->face_count * sizeof *faces);
  if (tags) memcpy(tags, s->tags, s->face_count * sizeof *tags);
  memcpy(sources, s->sources, s->face_count * sizeof *sources);
  laves__free(context, s->faces, old, sizeof *s->faces);
  laves__free(context, s->tags, old, sizeof *s->tags);
  laves__free(context, s->sources, old, sizeof *s->sources);
  laves__free(context, s->face_flags, old, sizeof *s->face_flags);
  laves__free(context, s->across, 3 * old, sizeof *s->across);
  s->faces = faces;
  s->tags = tags;
  s->sources = sources;
  s->face_flags = flags;
  s->across = NULL;
  s->face_capacity = wanted;
  return true;
}

/* Parts a face at junctions of one of its edges: the first piece takes its place. */
static void part_face(laves__surface *s, const junction *j, size_t count) {
  const uint32_t f = j->half / 3, i = j->half % 3, apex = s->faces[f][(i + 2) % 3];
  uint32_t end = s->faces[f][(i + 1) % 3];
  for (size_t k = count; k-- > 0;) { /* from the far end of the edge on */
    if (j[k].point == apex || j[k].point == end) continue;
    uint32_t *face = s->faces[s->face_count];
    face[0] = j[k].point;
    face[1] = end;
    face[2] = apex;
    if (s->tags) s->tags[s->face_count] = s->tags[f];
    s->sources[s->face_count++] = s->sources[f];
    end = j[k].point;
  }
  s->faces[f][(i + 1) % 3] = end;
}

/* Each face at one of its edges. */
static bool part_faces(stitcher *t) {
  if (!grow_faces(t->s, t->s->face_count + t->found_count)) return false;
  uint32_t parted = LAVES__NONE;
  for (size_t begin = 0, end; begin < t->found_count; begin = end) {
    for (end = begin + 1; end < t->found_count && t->found[end].half == t->found[begin].half; end++) {
    }
    if (t->found[begin].half / 3 == parted) continue;
    parted = t->found[begin].half / 3;
    part_face(t->s, &t->found[begin], end - begin);
  }
  return true;
}

bool laves__surface_stitch(laves__surface *s, bool *parted) {
  stitcher t = {.s = s, .reach = tolerance * s->diagonal};
  bool done = true;
  *parted = false;
  for (int round = 0; done && round < ROUNDS_MAX; round++) {
    done = find_junctions(&t);
    laves__bvh_free(s->context, &t.tree);
    laves__free(s->context, t.order, t.order_capacity, sizeof *t.order);
    t.order = NULL;
    t.order_capacity = 0;
    if (!done || t.found_count == 0) break;
    *parted = true;
    done = part_faces(&t);
  }
  laves__free(s->context, t.open, t.open_capacity, sizeof *t.open);
  laves__free(s->context, t.found, t.found_capacity, sizeof *t.found);
  return done;
}
