/* Closed parts of a surface, which can be regions of the mesh.
 *
 * In: faces, tags, sources.  Out: the part of each face; later, from the final triangles, an answer to "which part is this point
 * in?".
 *
 * Files tell parts apart in two ways. Where there are several tags and the faces of one are closed by themselves, they are a part
 * (an STL solid of an assembly). All other faces (tags that are patches of one body, and files without tags) are joined over
 * edges. At an edge of more than two faces, where bodies touch, faces are sorted by angle about the edge and joined
 * over the wedges of inside between them, as brackets are:
 *
 *          |  B  /          from the edge, counter-clockwise: A opens, A closes, B opens, B closes.
 *          |____/           The two faces of the wall between A and B have the same angle there: closing goes before opening,
 *          |  A             since a wedge without angle is no inside.
 *
 * A part is asked by its own winding number, within its box; smaller parts first, so that the innermost of nested ones is found.
 */
#include <stdlib.h>
#include <string.h>

#include "domain/surface.h"

/* Radians within which two faces about an edge count as one plane: far more than laves__angle errs, and less than any wedge that
 * could hold a tetrahedron. */
static const double flat_angle = 1e-6;

/* ---- joining faces ---- */

typedef struct finder {
  laves__surface *s;
  uint32_t *group;  /* [face_count] of equal tags, counted from 0 */
  uint32_t *parent; /* [face_count] union-find; the least face is the root */
  int64_t *balance; /* [face_count] scratch for groups or parts: uses forwards less uses backwards, of one edge */
  bool *open;       /* [face_count] groups, later roots, that are not closed by themselves */
  struct spoke *spoke;
  size_t spoke_capacity, group_count;
  bool short_of_memory;
} finder;

/* A face at an edge. */
typedef struct spoke {
  double angle;
  uint32_t face;
  bool closes; /* the wedge of inside ends at it, going counter-clockwise about the edge */
} spoke;

static uint32_t find_root(uint32_t *parent, uint32_t f) {
  while (parent[f] != f) {
    parent[f] = parent[parent[f]];
    f = parent[f];
  }
  return f;
}

static void join(finder *g, uint32_t a, uint32_t b) {
  a = find_root(g->parent, a);
  b = find_root(g->parent, b);
  g->parent[a > b ? a : b] = a > b ? b : a;
}

/* Whether a use runs from the lesser point to the greater. */
static bool is_forward(const laves__surface *s, const laves__edge_use *use) {
  return s->faces[use->half / 3][use->half % 3] < use->other;
}

/* Notes which of the numbers `of` of the faces at an edge (groups, or roots) don't balance. */
static void note_open(finder *g, const uint32_t *of, const laves__edge_use *uses, size_t count) {
  for (size_t i = 0; i < count; i++) g->balance[of[uses[i].half / 3]] += is_forward(g->s, &uses[i]) ? 1 : -1;
  for (size_t i = 0; i < count; i++) g->open[of[uses[i].half / 3]] |= g->balance[of[uses[i].half / 3]] != 0;
  for (size_t i = 0; i < count; i++) g->balance[of[uses[i].half / 3]] = 0;
}

static void note_open_groups(void *user, laves__edge_use *uses, size_t count) {
  finder *g = user;
  note_open(g, g->group, uses, count);
}

static void note_open_parts(void *user, laves__edge_use *uses, size_t count) {
  finder *g = user;
  note_open(g, g->s->part, uses, count);
}

static int compare_spokes(const void *a, const void *b) {
  const spoke *x = a, *y = b;
  if (x->angle != y->angle) return x->angle < y->angle ? -1 : 1;
  return (x->face > y->face) - (x->face < y->face);
}

/* Puts what closes before what opens, where angles are equal but for rounding. */
static void close_first(spoke *spokes, size_t count) {
  for (size_t begin = 0, end; begin < count; begin = end) {
    size_t closing = begin;
    for (end = begin; end < count && spokes[end].angle <= spokes[begin].angle + flat_angle; end++)
      if (spokes[end].closes) {
        const spoke swap = spokes[closing];
        spokes[closing++] = spokes[end];
        spokes[end] = swap;
      }
  }
}

/* Joins each face that opens a wedge with the one that closes it; the first may stand amid a wedge, so it goes round twice. */
static void join_wedges(finder *g, spoke *spokes, size_t count) {
  size_t depth = 0;
  uint32_t *stack = laves__alloc(g->s->context, 2 * count, sizeof *stack);
  if (!stack) {
    g->short_of_memory = true;
    return;
  }
  for (size_t i = 0; i < 2 * count; i++) {
    const spoke *p = &spokes[i % count];
    if (!p->closes)
      stack[depth++] = p->face;
    else if (depth > 0)
      join(g, stack[--depth], p->face);
  }
  laves__free(g->s->context, stack, 2 * count, sizeof *stack);
}

/* Faces about an edge by angle. The angle is that of the face's third point about the edge, from the first face on. */
static void join_by_angle(finder *g, const laves__edge_use *uses, size_t count) {
  const laves__surface *s = g->s;
  if (!laves__grow(s->context, &g->spoke, &g->spoke_capacity, count, sizeof *g->spoke)) {
    g->short_of_memory = true;
    return;
  }
  const uint32_t *first = s->faces[uses[0].half / 3];
  const uint32_t corner = uses[0].half % 3, high = uses[0].other;
  const uint32_t low = first[corner] == high ? first[(corner + 1) % 3] : first[corner];
  const laves__vec3 along = v3_unit(v3_sub(s->points[high], s->points[low]));
  laves__vec3 x = {0, 0, 0}, y = {0, 0, 0};
  for (size_t i = 0; i < count; i++) {
    const uint32_t *face = s->faces[uses[i].half / 3];
    const laves__vec3 out = v3_sub(s->points[face[(uses[i].half % 3 + 2) % 3]], s->points[low]);
    const laves__vec3 across = v3_unit(v3_mad(out, along, -v3_dot(out, along)));
    if (i == 0) {
      x = across;
      y = v3_cross(along, x);
    }
    double angle = laves__angle(v3_dot(across, y), v3_dot(across, x));
    if (angle < -flat_angle) angle += 6.283185307179586;
    g->spoke[i] = (spoke){angle, uses[i].half / 3, is_forward(s, &uses[i])};
  }
  qsort(g->spoke, count, sizeof *g->spoke, compare_spokes);
  close_first(g->spoke, count);
  join_wedges(g, g->spoke, count);
}

/* Faces of closed groups are joined already. */
static void join_edge(void *user, laves__edge_use *uses, size_t count) {
  finder *g = user;
  size_t left = 0;
  for (size_t i = 0; i < count; i++)
    if (g->group_count < 2 || g->open[g->group[uses[i].half / 3]]) uses[left++] = uses[i];
  if (left == 2)
    join(g, uses[0].half / 3, uses[1].half / 3);
  else if (left > 2)
    join_by_angle(g, uses, left);
}

/* ---- numbering ---- */

typedef struct tagged {
  int32_t tag;
  uint32_t face;
} tagged;

static int compare_tagged(const void *a, const void *b) {
  const tagged *x = a, *y = b;
  if (x->tag != y->tag) return x->tag < y->tag ? -1 : 1;
  return (x->face > y->face) - (x->face < y->face);
}

/* Groups of equal tags; without tags all is one. */
static bool find_groups(finder *g) {
  const laves__surface *s = g->s;
  const size_t count = s->face_count;
  memset(g->group, 0, count * sizeof *g->group);
  g->group_count = 1;
  if (!s->tags) return true;
  tagged *list = laves__alloc(s->context, count, sizeof *list);
  if (!list) return false;
  for (size_t f = 0; f < count; f++) list[f] = (tagged){s->tags[f], (uint32_t)f};
  qsort(list, count, sizeof *list, compare_tagged);
  g->group_count = 0;
  for (size_t i = 0; i < count; i++) {
    g->group_count += i == 0 || list[i].tag != list[i - 1].tag;
    g->group[list[i].face] = (uint32_t)(g->group_count - 1);
  }
  laves__free(s->context, list, count, sizeof *list);
  return true;
}

/* Joins all faces of each closed group with its first. */
static void join_groups(finder *g) {
  const size_t count = g->s->face_count;
  uint32_t *first = g->s->part; /* scratch */
  memset(first, 0xff, count * sizeof *first);
  for (uint32_t f = 0; f < count; f++) {
    const uint32_t group = g->group[f];
    if (g->open[group]) continue;
    if (first[group] == LAVES__NONE) first[group] = f;
    join(g, first[group], f);
  }
}

typedef struct root {
  uint32_t source, face;
} root;

static int compare_roots(const void *a, const void *b) {
  const root *x = a, *y = b;
  if (x->source != y->source) return x->source < y->source ? -1 : 1;
  return (x->face > y->face) - (x->face < y->face);
}

/* Numbers the parts by the first of their faces in the file. */
static bool number_parts(finder *g) {
  laves__surface *s = g->s;
  const size_t count = s->face_count;
  root *roots = laves__alloc(s->context, count, sizeof *roots);
  if (!roots) return false;
  size_t parts = 0;
  for (uint32_t f = 0; f < count; f++) { /* roots come before the other faces of their part */
    const uint32_t r = find_root(g->parent, f);
    if (r == f) {
      roots[parts] = (root){s->sources[f], f};
      s->part[f] = (uint32_t)parts++;
    } else {
      root *of = &roots[s->part[r]];
      if (s->sources[f] < of->source) of->source = s->sources[f];
    }
  }
  qsort(roots, parts, sizeof *roots, compare_roots);
  for (size_t i = 0; i < parts; i++) s->part[roots[i].face] = (uint32_t)i;
  for (uint32_t f = 0; f < count; f++) s->part[f] = s->part[find_root(g->parent, f)];
  s->part_count = parts;
  laves__free(s->context, roots, count, sizeof *roots);
  return true;
}

/* Tags that stand for one part alone. A group is in several parts, or a part of several groups: no tag. */
static bool tag_parts(finder *g) {
  laves__surface *s = g->s;
  const size_t count = s->face_count;
  s->part_tag = laves__alloc(s->context, s->part_count, sizeof *s->part_tag);
  uint32_t *part_of_group = laves__alloc(s->context, g->group_count, sizeof *part_of_group);
  uint32_t *group_of_part = laves__alloc(s->context, s->part_count, sizeof *group_of_part);
  const bool done = s->part_tag && part_of_group && group_of_part;
  if (done) {
    enum { SEVERAL = LAVES__FACES_MAX };
    memset(part_of_group, 0xff, g->group_count * sizeof *part_of_group);
    memset(group_of_part, 0xff, s->part_count * sizeof *group_of_part);
    for (size_t f = 0; f < count; f++) {
      uint32_t *part = &part_of_group[g->group[f]], *group = &group_of_part[s->part[f]];
      *part = *part == LAVES__NONE || *part == s->part[f] ? s->part[f] : SEVERAL;
      *group = *group == LAVES__NONE || *group == g->group[f] ? g->group[f] : SEVERAL;
    }
    for (size_t i = 0; i < s->part_count; i++) s->part_tag[i] = -1;
    for (size_t f = 0; f < count && s->tags; f++)
      if (part_of_group[g->group[f]] == s->part[f] && group_of_part[s->part[f]] == g->group[f])
        s->part_tag[s->part[f]] = s->tags[f];
  }
  laves__free(s->context, part_of_group, g->group_count, sizeof *part_of_group);
  laves__free(s->context, group_of_part, s->part_count, sizeof *group_of_part);
  return done;
}

/* After the groups were asked, `open` is asked anew for parts. */
static bool judge_parts(finder *g) {
  laves__surface *s = g->s;
  s->part_closed = laves__alloc(s->context, s->part_count, sizeof *s->part_closed);
  if (!s->part_closed) return false;
  memset(g->open, 0, s->face_count * sizeof *g->open);
  if (!laves__surface_each_edge(s, note_open_parts, g)) return false;
  for (size_t i = 0; i < s->part_count; i++) s->part_closed[i] = !g->open[i];
  return true;
}

bool laves__surface_find_parts(laves__surface *s) {
  laves_context *context = s->context;
  const size_t count = s->face_count;
  finder g = {.s = s};
  bool done = false;
  s->part = laves__alloc(context, count, sizeof *s->part);
  s->part_capacity = s->part ? count : 0;
  g.group = laves__alloc(context, count, sizeof *g.group);
  g.parent = laves__alloc(context, count, sizeof *g.parent);
  g.balance = laves__alloc_zeroed(context, count, sizeof *g.balance);
  g.open = laves__alloc_zeroed(context, count, sizeof *g.open);
  if (!s->part || !g.group || !g.parent || !g.balance || !g.open || !find_groups(&g)) goto clean_up;
  for (uint32_t f = 0; f < count; f++) g.parent[f] = f;
  if (g.group_count > 1) {
    if (!laves__surface_each_edge(s, note_open_groups, &g)) goto clean_up;
    join_groups(&g);
  }
  if (!laves__surface_each_edge(s, join_edge, &g) || g.short_of_memory) goto clean_up;
  done = number_parts(&g) && tag_parts(&g) && judge_parts(&g);
clean_up:
  laves__free(context, g.group, count, sizeof *g.group);
  laves__free(context, g.parent, count, sizeof *g.parent);
  laves__free(context, g.balance, count, sizeof *g.balance);
  laves__free(context, g.open, count, sizeof *g.open);
  laves__free(context, g.spoke, g.spoke_capacity, sizeof *g.spoke);
  return done;
}

/* ---- asking ---- */

typedef struct solid_part {
  laves__bvh tree;
  laves__winding winding;
  laves__box3 box;
  double volume;
  uint32_t number; /* among all parts of the surface */
  int32_t tag;
} solid_part;

struct laves__parts {
  laves_context *context;
  const laves__surface *surface;
  solid_part *part; /* [capacity]; kept ones first, as the file gives them */
  size_t count, capacity;
  uint32_t *rank;    /* [capacity] of each by volume: 0 has the least */
  laves__bvh boxes;  /* over the parts' boxes, as triangles that have these for theirs */
  uint32_t *part_at; /* [capacity] the part at each slot of it */
};

/* All triangles, walls inside the solid included. */
static const laves__bvh *whole_tree(const laves__surface *s) { return s->winding.bvh ? s->winding.bvh : &s->bvh; }

static double volume_of(const laves__bvh *tree, const uint32_t *slots, size_t count) {
  const laves__vec3 centre = tree->triangles[slots[0]].a;
  double volume6 = 0;
  for (size_t i = 0; i < count; i++) {
    const laves__triangle *t = &tree->triangles[slots[i]];
    volume6 += v3_det(centre, t->a, t->b, t->c);
  }
  return volume6 / 6;
}

/* A tree of its own over the triangles in these slots. */
static bool build_part(laves_context *context, const laves__bvh *whole, const uint32_t *slots, size_t count, solid_part *part) {
  laves__vec3 *points = laves__alloc(context, 3 * count, sizeof *points);
  uint32_t(*faces)[3] = laves__alloc(context, count, sizeof *faces);
  uint32_t *order = laves__alloc(context, count, sizeof *order);
  bool done = points && faces && order;
  part->box = box3_empty();
  for (size_t i = 0; done && i < count; i++) {
    const laves__triangle *t = &whole->triangles[slots[i]];
    const laves__vec3 corners[3] = {t->a, t->b, t->c};
    for (int k = 0; k < 3; k++) {
      points[3 * i + (size_t)k] = corners[k];
      faces[i][k] = (uint32_t)(3 * i) + (uint32_t)k;
      part->box = box3_add(part->box, corners[k]);
    }
  }
  done = done && laves__bvh_build(context, points, (const uint32_t(*)[3])faces, count, order, &part->tree) &&
         laves__winding_build(context, &part->tree, &part->winding);
  laves__free(context, points, 3 * count, sizeof *points);
  laves__free(context, faces, count, sizeof *faces);
  laves__free(context, order, count, sizeof *order);
  return done;
}

static void free_part(laves_context *context, solid_part *part) {
  laves__winding_free(context, &part->winding);
  laves__bvh_free(context, &part->tree);
}

typedef struct measured {
  double volume;
  uint32_t part;
} measured;

static int compare_measured(const void *a, const void *b) {
  const measured *x = a, *y = b;
  if (x->volume != y->volume) return x->volume < y->volume ? -1 : 1;
  return (x->part > y->part) - (x->part < y->part);
}

static bool rank_parts(laves__parts *parts) {
  measured *list = laves__alloc(parts->context, parts->count, sizeof *list);
  if (!list) return false;
  for (size_t i = 0; i < parts->count; i++) list[i] = (measured){parts->part[i].volume, (uint32_t)i};
  qsort(list, parts->count, sizeof *list, compare_measured);
  for (size_t i = 0; i < parts->count; i++) parts->rank[list[i].part] = (uint32_t)i;
  laves__free(parts->context, list, parts->count, sizeof *list);
  return true;
}

/* The tree over the boxes. */
static bool build_boxes(laves__parts *parts) {
  const size_t count = parts->count;
  laves__vec3 *points = laves__alloc(parts->context, 2 * count, sizeof *points);
  uint32_t(*faces)[3] = laves__alloc(parts->context, count, sizeof *faces);
  const bool enough = points && faces;
  for (uint32_t i = 0; enough && i < count; i++) {
    points[2 * i] = parts->part[i].box.lower;
    points[2 * i + 1] = parts->part[i].box.upper;
    faces[i][0] = 2 * i;
    faces[i][1] = faces[i][2] = 2 * i + 1;
  }
  const bool done =
      enough && laves__bvh_build(parts->context, points, (const uint32_t(*)[3])faces, count, parts->part_at, &parts->boxes);
  laves__free(parts->context, points, 2 * count, sizeof *points);
  laves__free(parts->context, faces, count, sizeof *faces);
  return done;
}

/* Keeps the closed parts: those that have an inside, or also hollows, whose volume is negative and which bound what is around
 * them. */
static bool keep_parts(laves__parts *parts, bool hollows, const laves__part_faces *of) {
  const laves__surface *s = parts->surface;
  const laves__bvh *whole = whole_tree(s);
  for (size_t p = 0; p < s->part_count; p++) {
    const uint32_t *mine = of->slots + of->starts[p];
    const size_t count = of->starts[p + 1] - of->starts[p];
    const double volume = volume_of(whole, mine, count);
    if (!s->part_closed[p] || !(hollows ? volume != 0 : volume > 0)) continue;
    solid_part *kept = &parts->part[parts->count];
    *kept = (solid_part){.volume = volume, .number = (uint32_t)p, .tag = s->part_tag[p]};
    if (!build_part(parts->context, whole, mine, count, kept)) {
      free_part(parts->context, kept);
      return false;
    }
    parts->count++;
  }
  return parts->count == 0 || (rank_parts(parts) && build_boxes(parts));
}

bool laves__part_faces_list(const laves__surface *s, laves__part_faces *of) {
  *of = (laves__part_faces){.face_count = whole_tree(s)->count, .part_count = s->part_count};
  of->starts = laves__alloc_zeroed(s->context, of->part_count + 2, sizeof *of->starts);
  of->slots = laves__alloc(s->context, of->face_count, sizeof *of->slots);
  if (!of->starts || !of->slots) return false;
  /* starts[p + 1] runs from the start of p to its end. */
  for (size_t f = 0; f < of->face_count; f++) of->starts[s->part[f] + 2]++;
  for (size_t p = 0; p < of->part_count; p++) of->starts[p + 2] += of->starts[p + 1];
  for (size_t f = 0; f < of->face_count; f++) of->slots[of->starts[s->part[f] + 1]++] = (uint32_t)f;
  return true;
}

void laves__part_faces_free(laves_context *context, laves__part_faces *of) {
  laves__free(context, of->starts, of->part_count + 2, sizeof *of->starts);
  laves__free(context, of->slots, of->face_count, sizeof *of->slots);
  *of = (laves__part_faces){0};
}

laves__parts *laves__parts_create(const laves__surface *s, bool hollows) {
  laves_context *context = s->context;
  laves__parts *parts = laves__alloc_zeroed(context, 1, sizeof *parts);
  if (!parts) return NULL;
  *parts = (laves__parts){.context = context, .surface = s};
  if (!s->part) return parts;
  laves__part_faces of;
  bool done = laves__part_faces_list(s, &of);
  parts->part = laves__alloc(context, s->part_count, sizeof *parts->part);
  parts->rank = laves__alloc(context, s->part_count, sizeof *parts->rank);
  parts->part_at = laves__alloc(context, s->part_count, sizeof *parts->part_at);
  parts->capacity = s->part_count;
  done = done && parts->part && parts->rank && parts->part_at && keep_parts(parts, hollows, &of);
  laves__part_faces_free(context, &of);
  if (done) return parts;
  laves__parts_free(parts);
  return NULL;
}

void laves__parts_free(laves__parts *parts) {
  if (!parts) return;
  laves_context *context = parts->context;
  for (size_t i = 0; i < parts->count; i++) free_part(context, &parts->part[i]);
  laves__free(context, parts->part, parts->capacity, sizeof *parts->part);
  laves__free(context, parts->rank, parts->capacity, sizeof *parts->rank);
  laves__free(context, parts->part_at, parts->capacity, sizeof *parts->part_at);
  laves__bvh_free(context, &parts->boxes);
  laves__free(context, parts, 1, sizeof *parts);
}

size_t laves__parts_count(const laves__parts *parts) { return parts->count; }

uint32_t laves__parts_number(const laves__parts *parts, size_t part) { return parts->part[part].number; }

double laves__parts_volume(const laves__parts *parts, size_t part) { return parts->part[part].volume; }

int32_t laves__parts_tag(const laves__parts *parts, size_t part) { return parts->part[part].tag; }

static bool box_holds(laves__box3 b, laves__vec3 p) {
  return p.x >= b.lower.x && p.x <= b.upper.x && p.y >= b.lower.y && p.y <= b.upper.y && p.z >= b.lower.z && p.z <= b.upper.z;
}

static bool part_holds(const solid_part *part, laves__vec3 p) {
  return box_holds(part->box, p) && fabs(laves__winding_number(&part->winding, p, LAVES__NONE, LAVES__NONE)) > 0.5;
}

typedef struct question {
  const laves__parts *parts;
  laves__vec3 point;
  int32_t best; /* part so far, or -1 */
} question;

static void ask_part(void *user, uint32_t slot) {
  question *q = user;
  const laves__parts *parts = q->parts;
  const uint32_t index = parts->part_at[slot];
  if (q->best >= 0 && parts->rank[q->best] < parts->rank[index]) return;
  if (part_holds(&parts->part[index], q->point)) q->best = (int32_t)index;
}

int32_t laves__parts_at(const laves__parts *parts, laves__vec3 p) {
  question q = {parts, p, -1};
  if (parts->count > 0) laves__bvh_overlaps(&parts->boxes, (laves__box3){p, p}, ask_part, &q);
  return q.best;
}

typedef struct telling {
  const laves__parts *parts;
  laves__vec3 point;
  laves__part_fn *fn;
  void *user;
} telling;

static void tell_part(void *user, uint32_t slot) {
  const telling *r = user;
  const uint32_t index = r->parts->part_at[slot];
  if (part_holds(&r->parts->part[index], r->point)) r->fn(r->user, index);
}

void laves__parts_around(const laves__parts *parts, laves__vec3 p, laves__part_fn *fn, void *user) {
  telling r = {parts, p, fn, user};
  if (parts->count > 0) laves__bvh_overlaps(&parts->boxes, (laves__box3){p, p}, tell_part, &r);
}

bool laves__parts_touch(const laves__parts *parts, laves__vec3 p, double distance) {
  laves__nearest best = {distance * distance, LAVES__NONE};
  laves__bvh_nearest(whole_tree(parts->surface), p, &best);
  return best.slot != LAVES__NONE;
}
