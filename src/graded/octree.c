/* From wishes to leaves, in four steps: halve cubes by the field, level by level; halve them by the samples; carry each
 * size outwards to where it may have grown enough (in the order of the sizes, as Dijkstra does), and halve what is then too
 * large or more than twice as large as a neighbour; see which leaves are among their like.
 *
 * A cube is halved while its side is more than `roundness` times the wished size. A plateau of C15 has a mean edge of 0.80
 * sides, so edges lie between 0.72 and 1.43 of the least wish, and a uniform wish is met exactly. */
#include "graded/octree.h"

#include "background/c15_table.h"

#include <stdio.h>
#include <string.h>

static const double roundness = 1.8;
/* The same where the wish is a sample's, which is just what it says and not the least of several. */
static const double sample_roundness = 1.65;
/* Sizes between the corners of a leaf of the asked size: half a period. */
static const double whole_side = LAVES__C15_PERIOD / 2 / LAVES__C15_MEAN_EDGE;
static const double widening = 1.5;     /* sides around a leaf within which nothing of the solid may lie for it to be outside */
static const double sample_reach = 0.8; /* sizes around a sample, along each axis, within which its size is wished too */
enum {
  LEVELS_MAX = 18, /* three coordinates must fit a key of 64 bits */
  NODES_MAX = 1 << 28,
  SPREAD = 9,       /* places at which a cube asks for sizes */
  DENSE_SPREAD = 5, /* in each direction, for cubes that are large beside the solid */
  DENSE_LEVELS = 4, /* from the root */
};

/* ---- nodes ---- */

int32_t laves__octree_locate(const laves__octree *tree, int32_t x, int32_t y, int32_t z) {
  const laves__node *n = tree->node;
  if (x < 0 || y < 0 || z < 0 || x >= n->side || y >= n->side || z >= n->side) return -1;
  int32_t index = 0;
  while (n->child >= 0) {
    const int32_t half = n->side / 2;
    index = n->child + (x >= n->at[0] + half) + 2 * (y >= n->at[1] + half) + 4 * (z >= n->at[2] + half);
    n = &tree->node[index];
  }
  return index;
}

double laves__octree_size(const laves__octree *tree, laves__vec3 point, double *halving) {
  const laves__vec3 p = v3_scale(v3_sub(point, tree->lower), 1 / tree->unit);
  const double side = tree->node->side;
  if (!(p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < side && p.y < side && p.z < side)) return 0;
  const laves__node *n = &tree->node[laves__octree_locate(tree, (int32_t)p.x, (int32_t)p.y, (int32_t)p.z)];
  *halving = n->side * tree->unit / sample_roundness * (1 - 1e-6);
  return n->outside ? 0 : (double)n->size;
}

static laves__vec3 centre_of(const laves__octree *tree, const laves__node *n) {
  const double half = 0.5 * n->side;
  return laves__octree_point(tree, n->at[0] + half, n->at[1] + half, n->at[2] + half);
}

/* Makes eight leaves of one, of the same size; false when memory is short. */
static bool split(laves__octree *tree, int32_t index) {
  if (!laves__grow(tree->context, &tree->node, &tree->node_capacity, tree->node_count + 8, sizeof *tree->node)) return false;
  laves__node *parent = &tree->node[index];
  parent->child = (int32_t)tree->node_count;
  for (int k = 0; k < 8; k++) {
    laves__node *n = &tree->node[tree->node_count++];
    *n = (laves__node){.side = parent->side / 2, .child = -1, .size = parent->size};
    for (int axis = 0; axis < 3; axis++) n->at[axis] = parent->at[axis] + (k >> axis & 1) * n->side;
  }
  return true;
}

static bool is_too_large(const laves__octree *tree, const laves__node *n, double longest) {
  return n->side > 4 && n->side * tree->unit > longest;
}

static laves_result make_root(const laves__frame *frame, const laves__demand *demand, laves__octree *tree, laves_error *error) {
  const laves__box3 bounds = laves__frame_bounds(frame);
  const laves__vec3 far = v3_max(bounds.upper, v3_scale(bounds.lower, -1));
  const double margin = (0.5 + widening) * roundness * demand->largest; /* room for the largest leaves around the solid */
  int above = 1, below = 0;
  double half = whole_side; /* of the root: a power of two of whole periods, so that all lattices start at its corner */
  while (above <= LEVELS_MAX && half < fmax(far.x, fmax(far.y, far.z)) + margin) {
    half *= 2;
    above++;
  }
  for (double side = whole_side; below <= LEVELS_MAX && side > sample_roundness * demand->smallest; side /= 2) below++;
  if (above + below > LEVELS_MAX)
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "sizes from %g on are too small for a solid that is %g wide; choose a larger smallest size",
                       demand->smallest * frame->size, box3_diagonal(bounds) * frame->size);
  if (!laves__grow(tree->context, &tree->node, &tree->node_capacity, 1, sizeof *tree->node))
    return laves__fail_memory(tree->context, error);
  tree->unit = whole_side / 4 / (double)(1 << below);
  tree->lower = v3(-half, -half, -half);
  tree->node[0] = (laves__node){.side = 4 << (above + below), .child = -1, .size = (float)demand->largest};
  tree->node_count = 1;
  return LAVES_OK;
}

/* ---- the field, level by level ---- */

typedef struct sounding {
  const laves__frame *frame;
  const laves__demand *demand;
  laves__octree *tree;
  size_t first; /* node of the level */
  int level;
} sounding;

/* The least of the wishes at places in a cube: small sizes hold. */
static double least_wish(const laves__demand *demand, size_t count, const laves__vec3 *at) {
  double sizes[DENSE_SPREAD * DENSE_SPREAD * DENSE_SPREAD], least = HUGE_VAL;
  demand->evaluate(demand->self, count, at, sizes);
  for (size_t i = 0; i < count; i++) least = fmin(least, sizes[i]);
  return fmin(fmax(least, demand->smallest), demand->largest);
}

/* From the wishes at the centre and at eight places around it; for the first levels at many more. */
static double wish_of_cube(const sounding *s, const laves__node *n) {
  laves__vec3 at[DENSE_SPREAD * DENSE_SPREAD * DENSE_SPREAD];
  const laves__vec3 c = centre_of(s->tree, n);
  const double side = n->side * s->tree->unit, reach = 0.3 * side, step = side / DENSE_SPREAD;
  size_t count = 0;
  if (s->level >= DENSE_LEVELS) {
    for (; count < SPREAD - 1; count++)
      at[count] = v3(c.x + (count & 1 ? reach : -reach), c.y + (count & 2 ? reach : -reach), c.z + (count & 4 ? reach : -reach));
    at[count++] = c;
  } else {
    for (int z = 0; z < DENSE_SPREAD; z++)
      for (int y = 0; y < DENSE_SPREAD; y++)
        for (int x = 0; x < DENSE_SPREAD; x++)
          at[count++] =
              v3(c.x + (x - DENSE_SPREAD / 2) * step, c.y + (y - DENSE_SPREAD / 2) * step, c.z + (z - DENSE_SPREAD / 2) * step);
  }
  return least_wish(s->demand, count, at);
}

static bool is_outside(const laves__frame *frame, const laves__octree *tree, const laves__node *n) {
  return laves__frame_side(frame, centre_of(tree, n), (0.5 + widening) * n->side * tree->unit) == LAVES__OUTSIDE;
}

static void sound(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const sounding *s = user;
  for (size_t i = s->first + begin; i < s->first + end; i++) {
    laves__node *n = &s->tree->node[i];
    n->outside = is_outside(s->frame, s->tree, n);
    if (!n->outside) n->size = (float)wish_of_cube(s, n);
  }
}

double laves__graded_bytes(size_t leaves) {
  static const double at_start = 2e6, per_leaf = 1370;
  return at_start + per_leaf * (double)leaves;
}

/* Of the children of a cube one at least is not outside, and becomes a leaf or several. */
static size_t leaves_at_least(const laves__octree *tree) { return tree->node_count / 8; }

/* What is still to be taken when there are so many leaves. */
static double bytes_to_come(const laves__octree *tree, size_t leaves) {
  return fmax(laves__graded_bytes(leaves) - (double)tree->node_capacity * sizeof *tree->node, 0);
}

/* Whether the nodes are more than there may be, or than will fit into memory with what is made of them. */
static bool is_too_many(const laves__octree *tree) {
  return tree->node_count > NODES_MAX || !laves__may_fit(tree->context, bytes_to_come(tree, leaves_at_least(tree)));
}

static laves_result fail_room(const laves__octree *tree, size_t leaves, laves_error *error) {
  static const double tets_per_leaf = 14;
  const double bytes = bytes_to_come(tree, leaves), tets = tets_per_leaf * (double)leaves;
  char what[120], remedy[160];
  snprintf(what, sizeof what, "what the sizes ask for (%s%.2g tetrahedra)", leaves == tree->leaf_count ? "about " : "more than ",
           tets);
  snprintf(remedy, sizeof remedy, "raise it, choose larger sizes, or have them scaled to a count: %.1g tetrahedra fit",
           0.8 * tets * fmin(1, laves__room(tree->context) / bytes));
  return laves__fail_room(tree->context, bytes, what, remedy, error);
}

static laves_result too_many(const laves__octree *tree, laves_error *error) {
  if (tree->node_count <= NODES_MAX) return fail_room(tree, leaves_at_least(tree), error);
  return laves__fail(error, LAVES_ERROR_OPTION, "the sizes ask for more than %d cubes; choose larger ones", NODES_MAX);
}

static laves_result refine_by_field(const laves__frame *frame, const laves__demand *demand, laves__octree *tree,
                                    laves_error *error) {
  sounding s = {.frame = frame, .demand = demand, .tree = tree};
  for (size_t end = tree->node_count; s.first < end; s.level++) {
    if (!laves__parallel_for(tree->context, "background", end - s.first, 16, sound, &s)) return laves__fail_cancelled(error);
    for (size_t i = s.first; i < end; i++) {
      if (tree->node[i].outside || !is_too_large(tree, &tree->node[i], roundness * tree->node[i].size)) continue;
      if (!split(tree, (int32_t)i)) return laves__fail_memory(tree->context, error);
      if (is_too_many(tree)) return too_many(tree, error);
    }
    s.first = end;
    end = tree->node_count;
  }
  return LAVES_OK;
}

/* ---- samples ---- */

/* Children know whether they are outside. */
static bool split_and_sound(const laves__frame *frame, laves__octree *tree, int32_t index) {
  if (!split(tree, index)) return false;
  for (int k = 0; k < 8; k++) {
    laves__node *n = &tree->node[tree->node[index].child + k];
    n->outside = is_outside(frame, tree, n);
  }
  return true;
}

/* Halves the leaf at a place until it fits the size; false when memory is short. */
static bool refine_at(const laves__frame *frame, laves__octree *tree, laves__vec3 place, double size) {
  const laves__vec3 p = v3_scale(v3_sub(place, tree->lower), 1 / tree->unit);
  const int32_t at[3] = {(int32_t)floor(p.x), (int32_t)floor(p.y), (int32_t)floor(p.z)};
  int32_t leaf = laves__octree_locate(tree, at[0], at[1], at[2]);
  if (leaf < 0) return true;
  while (!tree->node[leaf].outside && is_too_large(tree, &tree->node[leaf], sample_roundness * size)) {
    if (!split_and_sound(frame, tree, leaf)) return false;
    leaf = laves__octree_locate(tree, at[0], at[1], at[2]);
  }
  tree->node[leaf].size = fminf(tree->node[leaf].size, (float)size);
  return true;
}

/* Samples stand on the surface, which may run close beside a face of leaves; those beyond take part in the boundary as well. */
static laves_result refine_by_samples(const laves__frame *frame, const laves__demand *demand, laves__octree *tree,
                                      laves_error *error) {
  for (size_t i = 0; i < demand->sample_count; i++) {
    const laves__vec3 p = demand->sample[i];
    const double size = fmin(fmax(demand->sample_size[i], demand->smallest), demand->largest), reach = sample_reach * size;
    bool memory = refine_at(frame, tree, p, size);
    for (int k = 0; memory && k < 8; k++)
      memory = refine_at(
          frame, tree, v3(p.x + (k & 1 ? reach : -reach), p.y + (k & 2 ? reach : -reach), p.z + (k & 4 ? reach : -reach)), size);
    if (!memory) return laves__fail_memory(tree->context, error);
    if (is_too_many(tree)) return too_many(tree, error);
    if (i % 256 == 0 && laves__cancelled(tree->context, "background", 0)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

/* ---- gradient and balance ---- */

/* Leaves in the order of their sizes: a binary heap; an entry whose size is no longer the leaf's is stale. */
typedef struct entry {
  float size;
  int32_t node;
} entry;

typedef struct front {
  const laves__frame *frame;
  laves__octree *tree;
  double grading;
  entry *heap;
  size_t count, capacity;
} front;

static bool comes_before(entry a, entry b) { return a.size != b.size ? a.size < b.size : a.node < b.node; }

static bool push(front *f, int32_t node) {
  if (!laves__grow(f->tree->context, &f->heap, &f->capacity, f->count + 1, sizeof *f->heap)) return false;
  const entry e = {f->tree->node[node].size, node};
  size_t i = f->count++;
  for (; i > 0 && comes_before(e, f->heap[(i - 1) / 2]); i = (i - 1) / 2) f->heap[i] = f->heap[(i - 1) / 2];
  f->heap[i] = e;
  return true;
}

static entry pop(front *f) {
  const entry top = f->heap[0], last = f->heap[--f->count];
  size_t i = 0;
  for (;;) {
    size_t child = 2 * i + 1;
    if (child >= f->count) break;
    if (child + 1 < f->count && comes_before(f->heap[child + 1], f->heap[child])) child++;
    if (!comes_before(f->heap[child], last)) break;
    f->heap[i] = f->heap[child];
    i = child;
  }
  if (f->count) f->heap[i] = last;
  return top;
}

/* Places just beyond a leaf's faces (four each), edges (two) and corners, in quarters of its side: every leaf that touches it
 * and is at least half as large holds one. */
enum { PROBES = 56 };

static void list_probes(int8_t probe[PROBES][3]) {
  static const int8_t place[4] = {-1, 1, 3, 5}; /* quarters; the first and last are beyond */
  int count = 0;
  for (int k = 0; k < 64; k++) {
    const int x = k & 3, y = k >> 2 & 3, z = k >> 4;
    if ((x == 1 || x == 2) && (y == 1 || y == 2) && (z == 1 || z == 2)) continue;
    probe[count][0] = place[x];
    probe[count][1] = place[y];
    probe[count++][2] = place[z];
  }
}

static int32_t probe_leaf(const laves__octree *tree, int32_t leaf, const int8_t probe[3]) {
  const laves__node *n = &tree->node[leaf];
  const int32_t quarter = n->side / 4;
  return laves__octree_locate(tree, n->at[0] + probe[0] * quarter, n->at[1] + probe[1] * quarter, n->at[2] + probe[2] * quarter);
}

static float size_at(const front *f, int32_t from, int32_t to) {
  const laves__node *a = &f->tree->node[from], *b = &f->tree->node[to];
  return (float)(a->size + f->grading * v3_distance(centre_of(f->tree, a), centre_of(f->tree, b)));
}

/* The children of a leaf that was split, with the sizes that their neighbours allow. */
static bool admit_children(front *f, int32_t parent, int8_t (*probe)[3]) {
  laves__octree *tree = f->tree;
  for (int32_t child = tree->node[parent].child; child < tree->node[parent].child + 8; child++) {
    if (tree->node[child].outside) continue;
    for (int k = 0; k < PROBES; k++) {
      const int32_t around = probe_leaf(tree, child, probe[k]);
      if (around >= 0 && !tree->node[around].outside)
        tree->node[child].size = fminf(tree->node[child].size, size_at(f, around, child));
    }
    if (!push(f, child)) return false;
  }
  return true;
}

/* Halves the leaf at a place until it is no more than twice as large as `leaf` and fits what that allows it; false when memory
 * is short. */
static bool carry(front *f, int32_t leaf, const int8_t place[3], int8_t (*probe)[3]) {
  laves__octree *tree = f->tree;
  for (;;) {
    const int32_t to = probe_leaf(tree, leaf, place);
    if (to < 0 || tree->node[to].outside) return true;
    const float allowed = size_at(f, leaf, to);
    const bool steep = tree->node[to].size > allowed;
    if (tree->node[to].side <= 2 * tree->node[leaf].side &&
        !(steep && is_too_large(tree, &tree->node[to], roundness * allowed))) {
      if (!steep) return true;
      tree->node[to].size = allowed;
      return push(f, to);
    }
    if (!split_and_sound(f->frame, tree, to) || !admit_children(f, to, probe)) return false;
  }
}

static laves_result limit(const laves__frame *frame, const laves__demand *demand, laves__octree *tree, laves_error *error) {
  front f = {.frame = frame, .tree = tree, .grading = demand->grading};
  laves_result result = LAVES_OK;
  bool memory = true;
  int8_t probe[PROBES][3];
  list_probes(probe);
  for (size_t i = 0; memory && i < tree->node_count; i++)
    if (tree->node[i].child < 0 && !tree->node[i].outside) memory = push(&f, (int32_t)i);
  for (size_t step = 0; memory && result == LAVES_OK && f.count > 0; step++) {
    const entry e = pop(&f);
    if (tree->node[e.node].child >= 0 || tree->node[e.node].size != e.size) continue;
    for (int k = 0; memory && k < PROBES; k++) memory = carry(&f, e.node, probe[k], probe);
    if (is_too_many(tree)) result = too_many(tree, error);
    if (step % 1024 == 0 && laves__cancelled(tree->context, "background", 0)) result = laves__fail_cancelled(error);
  }
  laves__free(tree->context, f.heap, f.capacity, sizeof *f.heap);
  return memory ? result : laves__fail_memory(tree->context, error);
}

/* ---- leaves ---- */

/* Lists leaves in the order of a depth-first walk: along the Morton curve. With `list` NULL they are only counted. */
static size_t walk(const laves__octree *tree, int32_t index, int32_t *list, size_t count) {
  const laves__node *n = &tree->node[index];
  if (n->child >= 0) {
    for (int k = 0; k < 8; k++) count = walk(tree, n->child + k, list, count);
    return count;
  }
  if (n->outside) return count;
  if (list) list[count] = index;
  return count + 1;
}

/* See laves__node.even; leaves that are outside have no corners, but there must be one on each face. */
static bool is_even(const laves__octree *tree, int32_t leaf, int8_t (*probe)[3]) {
  const int32_t side = tree->node[leaf].side;
  for (int k = 0; k < PROBES; k++) {
    int beyond = 0;
    for (int axis = 0; axis < 3; axis++) beyond += probe[k][axis] < 0 || probe[k][axis] > 4;
    if (beyond == 3) continue;
    const int32_t around = probe_leaf(tree, leaf, probe[k]);
    const bool there = around >= 0 && !tree->node[around].outside;
    if (beyond == 1 && !(there && tree->node[around].side == side)) return false;
    if (there && tree->node[around].side < side) return false;
  }
  return true;
}

static void find_even(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  laves__octree *tree = user;
  int8_t probe[PROBES][3];
  list_probes(probe);
  for (size_t i = begin; i < end; i++) tree->node[tree->leaf[i]].even = is_even(tree, tree->leaf[i], probe);
}

laves_result laves__octree_build(const laves__frame *frame, const laves__demand *demand, laves_context *context,
                                 laves__octree *tree, laves_error *error) {
  memset(tree, 0, sizeof *tree);
  tree->context = context;
  laves_result result = make_root(frame, demand, tree, error);
  if (result == LAVES_OK) result = refine_by_field(frame, demand, tree, error);
  if (result == LAVES_OK) result = refine_by_samples(frame, demand, tree, error);
  if (result == LAVES_OK) result = limit(frame, demand, tree, error);
  if (result != LAVES_OK) return result;
  tree->leaf_count = walk(tree, 0, NULL, 0);
  if (!laves__may_fit(context, bytes_to_come(tree, tree->leaf_count))) return fail_room(tree, tree->leaf_count, error);
  tree->leaf = laves__alloc(context, tree->leaf_count, sizeof *tree->leaf);
  if (!tree->leaf) return laves__fail_memory(context, error);
  walk(tree, 0, tree->leaf, 0);
  for (size_t i = 0; i < tree->leaf_count; i++) tree->node[tree->leaf[i]].order = (int32_t)i;
  if (!laves__parallel_for(context, "background", tree->leaf_count, 64, find_even, tree)) return laves__fail_cancelled(error);
  return LAVES_OK;
}

void laves__octree_free(laves__octree *tree) {
  if (!tree->context) return;
  laves__free(tree->context, tree->leaf, tree->leaf_count, sizeof *tree->leaf);
  laves__free(tree->context, tree->node, tree->node_capacity, sizeof *tree->node);
  memset(tree, 0, sizeof *tree);
}
