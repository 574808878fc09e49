/* Surfaces that stay open: the solid is where the generalised winding number exceeds a level, one half unless told otherwise.
 *
 * In: a mended surface with its tree, winding number and rim (the edges not used as often forwards as backwards).
 * Out: which triangles bound the solid, and distance, projection and side for it.
 *
 * Across a triangle the winding number drops by one, so where the mean of both sides lies between 0 and 1 the triangle bounds the
 * solid; elsewhere it is a wall inside or a sheet outside. Away from triangles the number is smooth; there {w = 1/2} closes the
 * holes. Its gradient is a line integral over the rim alone (the law of Biot and Savart), so
 *
 *   |grad w| <= sum of L_i / (4 pi rho_i^2)   over pieces of length L_i at distances rho_i,
 *
 * which tells how far a ball without triangles is certain to stay on its side. How far the cap of a hole is, is
 * estimated as |w - 1/2| / |grad w|. Beside a straight rim |grad w| is 1 / (2 pi rho): near a face across which the number
 * passes 1/2 by a wide margin, and four times as far from the rim, there is no cap, and the normal tells the sign. */
#include <string.h>

#include "domain/surface.h"

static const double four_pi = 12.566370614359172;
/* More than the error of the expansions: 0.013 at most on real models with the factor for caps. */
static const double winding_error = 0.015;
/* How far from 1/2 the mean of both sides of a face may be for it to count as plain; 1/2 would be its limit. */
static const double plain_margin = 0.3;
/* How much further than the face the rim must be for it not to matter. */
static const double rim_room = 4;
/* A node of the rim's tree is taken as a whole from this many of its widths on. */
static const double whole_node = 1;
/* A place where the number is this near to one half is on the cap. */
static const double on_cap = 1e-9;
/* Diagonals: brackets of the cap this narrow are searched no further. */
static const double narrow = 1e-12;

enum { SAMPLES = 32, ROUNDS = 8, CAP_STEPS = 60, EXPANSIONS = 6, LONG_RIM = 4096 };

/* ---- building ---- */

/* Winding numbers at four places of a face, its middle and near its corners: the least and the greatest distance from the level.
 */
static void judge_face(const laves__surface *s, uint32_t f, double *least, double *most) {
  const laves__triangle *t = &s->bvh.triangles[f];
  const laves__vec3 middle = v3_scale(v3_add(t->a, v3_add(t->b, t->c)), 1.0 / 3);
  const laves__vec3 places[4] = {middle, v3_lerp(t->a, middle, 0.1), v3_lerp(t->b, middle, 0.1), v3_lerp(t->c, middle, 0.1)};
  *least = INFINITY;
  *most = 0;
  for (int k = 0; k < 4; k++) {
    const double off = fabs(laves__winding_number(&s->winding, places[k], f, LAVES__NONE) - s->level);
    *least = fmin(*least, off);
    *most = fmax(*most, off);
  }
}

typedef struct judgement {
  laves__surface *s;
  bool *keep;
} judgement;

static void judge_faces(void *user, size_t begin, size_t end, int worker) {
  judgement *j = user;
  (void)worker;
  for (size_t f = begin; f < end; f++) {
    double least, most;
    judge_face(j->s, (uint32_t)f, &least, &most);
    uint8_t *flags = &j->s->face_flags[f];
    j->keep[f] = least < 0.5 || (*flags & LAVES__PARTIAL);
    if (most >= 0.5) *flags |= LAVES__PARTIAL;
    if (!(*flags & LAVES__PARTIAL) && most < plain_margin) *flags |= LAVES__PLAIN;
  }
}

bool laves__surface_judge_open(laves__surface *s, bool *keep) {
  judgement j = {s, keep};
  return laves__parallel_for(s->context, "surface", s->face_count, 64, judge_faces, &j);
}

static double leaf_length(const laves__bvh *tree, uint32_t child) {
  double sum = 0;
  for (uint32_t slot = laves__leaf_first(child); slot <= laves__leaf_last(child); slot++)
    sum += v3_distance(tree->triangles[slot].a, tree->triangles[slot].b);
  return sum;
}

/* Nodes come before their children, so the sums are made from the last node on. */
static bool sum_lengths(laves__surface *s) {
  const laves__bvh *tree = &s->rim_tree;
  s->rim_lengths = laves__alloc_zeroed(s->context, tree->node_capacity, sizeof *s->rim_lengths);
  if (!s->rim_lengths) return false;
  for (size_t k = tree->node_count; k-- > 0;)
    for (int i = 0; i < 4; i++) {
      const uint32_t child = tree->nodes[k].child[i];
      if (!laves__bvh_is_used(&tree->nodes[k], i)) continue;
      s->rim_lengths[k] += child & LAVES__LEAF_BIT ? leaf_length(tree, child) : s->rim_lengths[child];
    }
  return true;
}

bool laves__surface_build_rim(laves__surface *s) {
  bool done = false;
  const size_t count = s->rim_count;
  uint32_t(*edges)[3] = laves__alloc(s->context, count, sizeof *edges);
  uint32_t *order = laves__alloc(s->context, count, sizeof *order);
  if (edges && order) {
    for (size_t i = 0; i < count; i++) {
      const uint32_t half = s->rim[i];
      edges[i][0] = s->faces[half / 3][half % 3];
      edges[i][1] = edges[i][2] = s->faces[half / 3][(half % 3 + 1) % 3];
    }
    done = laves__bvh_build(s->context, s->points, (const uint32_t(*)[3])edges, count, order, &s->rim_tree) && sum_lengths(s);
  }
  laves__free(s->context, edges, count, sizeof *edges);
  laves__free(s->context, order, count, sizeof *order);
  return done;
}

typedef struct sampling {
  const laves__surface *s;
  laves__box3 box;
  int first;        /* layer of this round; the others follow at steps of ROUNDS */
  uint32_t *inside; /* [SAMPLES / ROUNDS] in each layer of the round */
} sampling;

static void sample_layers(void *user, size_t begin, size_t end, int worker) {
  sampling *m = user;
  (void)worker;
  const laves__vec3 width = v3_scale(v3_sub(m->box.upper, m->box.lower), 1.0 / SAMPLES);
  for (size_t k = begin; k < end; k++) {
    const double x = (m->first + (int)k * ROUNDS + 0.5) * width.x;
    m->inside[k] = 0;
    for (int i = 0; i < SAMPLES * SAMPLES; i++) {
      const laves__vec3 at = v3(x, (i / SAMPLES + 0.5) * width.y, (i % SAMPLES + 0.5) * width.z);
      m->inside[k] += laves__winding_number(&m->s->winding, v3_add(m->box.lower, at), LAVES__NONE, LAVES__NONE) > m->s->level;
    }
  }
}

/* A few layers at a time, since those of a solid's surface soon tell. */
bool laves__surface_encloses(const laves__surface *s, laves__box3 box, double share) {
  uint32_t inside[SAMPLES / ROUNDS] = {0}, sum = 0;
  for (int first = 0; first < ROUNDS; first++) {
    sampling m = {s, box, first, inside};
    if (!laves__parallel_for(s->context, "surface", SAMPLES / ROUNDS, 1, sample_layers, &m)) return false;
    for (int k = 0; k < SAMPLES / ROUNDS; k++) sum += inside[k];
    if (sum >= share * (SAMPLES * SAMPLES * SAMPLES)) return true;
  }
  return false;
}

/* ---- asking ---- */

static double excess(const laves__surface *s, laves__vec3 p) {
  return laves__winding_number(&s->winding, p, LAVES__NONE, LAVES__NONE) - s->level;
}

static double rim_distance(const laves__surface *s, laves__vec3 p, double reach) {
  laves__nearest n = {reach * reach, LAVES__NONE};
  laves__bvh_nearest(&s->rim_tree, p, &n);
  return n.slot == LAVES__NONE ? reach : sqrt(n.distance2);
}

/* Exact, in time that grows with the rim. */
static laves__vec3 gradient_by_rim(const laves__surface *s, laves__vec3 p) {
  laves__vec3 sum = v3(0, 0, 0);
  for (size_t i = 0; i < s->rim_tree.count; i++) {
    const laves__triangle *edge = &s->rim_tree.triangles[i];
    sum = v3_add(sum, laves__edge_winding_gradient(edge->a, edge->b, p));
  }
  return v3_scale(sum, 1 / four_pi);
}

bool laves__open_rim_is_far(const laves__surface *s, laves__vec3 p, double distance) {
  return rim_distance(s, p, rim_room * distance) >= rim_room * distance;
}

double laves__open_cap_distance(const laves__surface *s, laves__vec3 p, double e, double distance) {
  /* Right on the axis of a round hole, and at most three times too small beside a rim, where triangles are near. */
  const double per_rim = 2 * fabs(e);
  return per_rim < 1 ? per_rim * rim_distance(s, p, distance / fmax(per_rim, 1e-3)) : INFINITY;
}

double laves__open_cap_guess(const laves__surface *s, laves__vec3 p, double e, double distance, laves__vec3 *uphill) {
  const double e_abs = fabs(e);
  if (!(e_abs < 0.5)) return INFINITY;
  const double rim = rim_distance(s, p, distance / fmax(2 * e_abs, 1e-3));
  if (2 * e_abs * rim >= distance) return INFINITY;
  const laves__vec3 g = s->rim_tree.count <= LONG_RIM ? gradient_by_rim(s, p) : laves__winding_gradient(&s->winding, p);
  const double slope = v3_norm(g);
  if (!(slope > 0)) return INFINITY;
  *uphill = v3_scale(g, 1 / slope);
  return e_abs / slope;
}

double laves__open_excess(const laves__surface *s, laves__vec3 p) { return excess(s, p); }

/* Places along a ray on both sides of the cap, and w - 1/2 there. */
typedef struct bracket {
  double low, high, at_low, at_high;
} bracket;

/* Chords between the ends of the bracket, and every third step its middle: the number is smooth but where expansions take turns
 * and at triangles, where it jumps and chords don't help. An end that stays while the other moves twice counts half, or chords
 * would creep up to the cap from one side [dowell1971]. */
static double narrow_down(const laves__surface *s, laves__vec3 p, laves__vec3 direction, bracket b) {
  int stays = 0; /* how often in turn the high end did, or minus the low one */
  for (int i = 1; i <= CAP_STEPS && b.high - b.low > narrow * s->diagonal; i++) {
    const bool halve = i % 3 == 0;
    const double share = halve ? 0.5 : b.at_low / (b.at_low - b.at_high);
    const double place = b.low + share * (b.high - b.low), e = excess(s, v3_mad(p, direction, place));
    if (fabs(e) < on_cap) return place;
    if ((e > 0) == (b.at_low > 0)) {
      stays = stays > 0 ? stays + 1 : 1;
      b.low = place;
      b.at_low = e;
      if (stays > 1) b.at_high *= 0.5;
    } else {
      stays = stays < 0 ? stays - 1 : -1;
      b.high = place;
      b.at_high = e;
      if (stays < -1) b.at_low *= 0.5;
    }
  }
  return 0.5 * (b.low + b.high);
}

bool laves__open_project(const laves__surface *s, laves__vec3 p, double e, double guess, laves__vec3 uphill, double reach,
                         laves__vec3 *foot, laves__vec3 *normal) {
  *normal = v3_scale(uphill, -1);
  *foot = p;
  if (fabs(e) < on_cap) return true;
  const laves__vec3 direction = e > 0 ? *normal : uphill;
  bracket b = {0, guess, e, excess(s, v3_mad(p, direction, guess))};
  for (int tries = 0; (b.at_high > 0) == (e > 0); tries++) {
    if (tries == EXPANSIONS || b.high > reach) return false;
    b.low = b.high;
    b.at_low = b.at_high;
    b.high *= 1.5;
    b.at_high = excess(s, v3_mad(p, direction, b.high));
  }
  const double place = narrow_down(s, p, direction, b);
  *foot = v3_mad(p, direction, place);
  return place <= reach;
}

/* The greatest |grad w| in the ball, bounded by the sum over the rim; INFINITY when the rim touches it. */
static double steepest(const laves__surface *s, laves__vec3 p, double radius) {
  const laves__bvh *tree = &s->rim_tree;
  const double scale = tree->scale;
  uint32_t stack[LAVES__BVH_STACK];
  int top = 0;
  double sum = 0;
  stack[top++] = 0;
  while (top > 0) {
    const laves__bvh_node *n = &tree->nodes[stack[--top]];
    for (int i = 0; i < 4; i++) {
      if (!laves__bvh_is_used(n, i)) continue;
      const uint32_t child = n->child[i];
      const laves__vec3 half = v3((double)n->half[0][i], (double)n->half[1][i], (double)n->half[2][i]);
      const laves__vec3 centre = v3((double)n->centre[0][i], (double)n->centre[1][i], (double)n->centre[2][i]);
      const laves__vec3 off =
          v3(fabs(p.x * scale - centre.x) - half.x, fabs(p.y * scale - centre.y) - half.y, fabs(p.z * scale - centre.z) - half.z);
      const double gap = v3_norm(v3_max(off, v3(0, 0, 0))) / scale - radius;
      const double length = child & LAVES__LEAF_BIT ? leaf_length(tree, child) : s->rim_lengths[child];
      if ((child & LAVES__LEAF_BIT) || gap * scale > whole_node * v3_norm(half)) {
        if (!(gap > 0)) return INFINITY;
        sum += length / (gap * gap);
      } else {
        stack[top++] = child;
      }
    }
  }
  return sum / four_pi;
}

/* The number is asked last: it costs several searches. */
laves__side laves__open_side(const laves__surface *s, laves__vec3 p, double radius) {
  laves__nearest n = {radius * radius * (1 + 1e-9), LAVES__NONE};
  laves__bvh_nearest(s->winding.bvh, p, &n);
  if (n.slot != LAVES__NONE) return LAVES__UNDECIDED;
  const double change = radius * steepest(s, p, radius) + winding_error;
  if (!isfinite(change)) return LAVES__UNDECIDED;
  const double e = excess(s, p);
  if (!(fabs(e) > change)) return LAVES__UNDECIDED;
  return e > 0 ? LAVES__INSIDE : LAVES__OUTSIDE;
}
