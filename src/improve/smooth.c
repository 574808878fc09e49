/* Max-min smoothing of one vertex by a proximal bundle step.
 *
 * The worst quality around a vertex is a minimum of smooth functions f_k of its place: two for each dihedral angle, one
 * volume-length ratio for each tet. Near the minimum several are nearly equal, and following the gradient of one lowers
 * another; so the step d maximises the minimum of all their linear models, with a penalty for length:
 *
 *     max over d of   min_k (f_k + g_k . d)  -  |d|^2 / (2 tau)
 *
 * whose dual is a small quadratic programme over the simplex, d = tau sum_k lambda_k g_k, solved by moving weight between
 * two functions at a time. The step is taken only when the worst truly rises by a tenth of what the model foretells; tau
 * grows when the model is good and shrinks when it is not. For a surface vertex gradients lose their normal part, for one on a
 * crease they keep their tangential part alone, and the trial point is projected before it is measured.
 *
 * Gradient of n_k . n_l, for unit normals of two faces: each face that holds the vertex adds
 * e x (n_other - (n_k . n_l) n_own) / |N_own|, where e runs along the edge opposite the vertex in that face. */
#include "improve/smooth.h"

#include "base/predicates.h"
#include "improve/guard.h"

enum {
  TERMS_MAX = 640,    /* functions in a bundle; more are left out (a star of 50 tets has 650, and few are active) */
  STEPS_MAX = 6,      /* accepted steps for one call */
  TRIES_MAX = 4,      /* shrinks of tau for one step */
  WORKING_MAX = 24,   /* functions that share the weight; four suffice in theory */
  EXCHANGES_MAX = 60, /* of weight, for one dual problem */
};
static const double active_range = 0.4;   /* functions this far above the least take part */
static const double first_tau = 0.05;     /* local size^2; typical steps are a tenth of the size */
static const double longest_step = 0.5;   /* local sizes */
static const double surface_reach = 0.75; /* local sizes: how far a trial point may be from the surface */
static const double feature_reach = 4;    /* local sizes: how far from its crease or corner a vertex may still be */
static const double least_gain = 0.005;   /* foretold gains below this are not worth a trial */
static const double leap_below = 0.05, leap_gain = 0.01; /* quality; the first is about 7 degrees */
static const double accept_share = 0.1, good_share = 0.5, exact_enough = 0.02;

/* Functions by their value and gradient, coordinate by coordinate, so that several are looked at in one step. Behind the last
 * stand zeros up to a multiple of STEP. */
enum { STEP = 4 };
_Static_assert(TERMS_MAX % STEP == 0 && WORKING_MAX % STEP == 0, "room for the zeros");

typedef struct bundle {
  int count;
  double value[TERMS_MAX], x[TERMS_MAX], y[TERMS_MAX], z[TERMS_MAX];
  /* The functions that may carry weight: which they are, and copies of them, which lie side by side. */
  int working_count, working[WORKING_MAX];
  double working_value[WORKING_MAX], working_x[WORKING_MAX], working_y[WORKING_MAX], working_z[WORKING_MAX];
  double weight[WORKING_MAX], model[WORKING_MAX];
} bundle;

static inline laves__vec3 gradient_of(const bundle *b, int k) { return v3(b->x[k], b->y[k], b->z[k]); }

static inline void set_gradient(bundle *b, int k, laves__vec3 gradient) {
  b->x[k] = gradient.x;
  b->y[k] = gradient.y;
  b->z[k] = gradient.z;
}

static void add_term(bundle *b, double value, laves__vec3 gradient) {
  if (b->count == TERMS_MAX) return;
  b->value[b->count] = value;
  set_gradient(b, b->count++, gradient);
}

static void add_working(bundle *b, int k, double weight) {
  const int at = b->working_count++;
  if (at % STEP == 0)
    for (int i = at; i < at + STEP; i++) b->working_value[i] = b->working_x[i] = b->working_y[i] = b->working_z[i] = 0;
  b->working[at] = k;
  b->working_value[at] = b->value[k];
  b->working_x[at] = b->x[k];
  b->working_y[at] = b->y[k];
  b->working_z[at] = b->z[k];
  b->weight[at] = weight;
}

/* model = value + tau * gradient . sum, of STEP functions. */
static inline void find_models(const double *value, const double *x, const double *y, const double *z, double tau,
                               laves__vec3 sum, double *model) {
  for (int i = 0; i < STEP; i++) model[i] = value[i] + tau * (x[i] * sum.x + y[i] * sum.y + z[i] * sum.z);
}

/* The gradient, with respect to corner c, of the dot product d of unit normals i and j. */
static laves__vec3 dot_gradient(const laves__vec3 p[4], int c, const laves__vec3 unit[4], const double per_length[4], int i,
                                int j, double d) {
  laves__vec3 g = {0, 0, 0};
  for (int side = 0; side < 2; side++) {
    const int own = side ? j : i, other = side ? i : j;
    if (own == c) continue; /* the face opposite the vertex does not move */
    const uint8_t *face = laves__tet_face[own];
    const int at = face[0] == c ? 0 : face[1] == c ? 1 : 2;
    const laves__vec3 e = v3_sub(p[face[(at + 1) % 3]], p[face[(at + 2) % 3]]);
    g = v3_add(g, v3_cross(e, v3_scale(v3_mad(unit[other], unit[own], -d), per_length[own])));
  }
  return g;
}

/* Adds the functions of one tet that lie below `ceiling`; `cube` is that of the local size, `fixed` edges are left out. */
static void add_tet(bundle *b, const laves__measure *m, const laves__vec3 p[4], double cube, unsigned fixed, int c,
                    double ceiling) {
  laves__vec3 n[4], unit[4];
  double per_length[4];
  laves__face_normals(p, n);
  const double volume6 = -v3_dot(n[3], v3_sub(p[3], p[0]));
  if (!(volume6 > LAVES__FLAT * cube)) {
    add_term(b, volume6 / cube, v3_scale(n[c], -1 / cube));
    return;
  }
  for (int i = 0; i < 4; i++) {
    per_length[i] = 1 / sqrt(v3_norm2(n[i]));
    unit[i] = v3_scale(n[i], per_length[i]);
  }
  for (int e = 0; e < 6; e++) {
    const int i = laves__face_pair[e][0], j = laves__face_pair[e][1];
    const double d = v3_dot(unit[i], unit[j]);
    const double low = (1 + d) * m->low_scale, high = (1 - d) * m->high_scale;
    if ((low >= ceiling && high >= ceiling) || laves__is_fixed(fixed, e)) continue;
    const laves__vec3 g = dot_gradient(p, c, unit, per_length, i, j, d);
    if (low < ceiling) add_term(b, low, v3_scale(g, m->low_scale));
    if (high < ceiling) add_term(b, high, v3_scale(g, -m->high_scale));
  }
  const double mean = laves__edge_sum(p) / 6;
  const double scale = LAVES__SQRT2 * m->length_scale / (mean * sqrt(mean)), length = scale * volume6;
  if (length >= ceiling || fixed) return;
  laves__vec3 spread = {0, 0, 0}; /* half the gradient of the sum of squared edges */
  for (int k = 0; k < 4; k++) spread = v3_add(spread, v3_sub(p[c], p[k]));
  add_term(b, length, v3_add(v3_scale(n[c], -scale), v3_scale(spread, -length / (2 * mean))));
}

static void fill_bundle(bundle *b, const laves__measure *m, const laves__layer *layer, int32_t vertex, double least) {
  const laves__star *star = &layer->star[vertex];
  b->count = 0;
  for (int i = 0; i < star->count; i++) {
    if (layer->quality[star->tet[i]] >= least + active_range) continue; /* none of its functions is below that */
    laves__vec3 p[4];
    laves__layer_points(layer, star->tet[i], p);
    add_tet(b, m, p, laves__layer_cube(layer, star->tet[i]), laves__measure_fixed(m, layer, star->tet[i]),
            laves__layer_corner(layer, star->tet[i], vertex), least + active_range);
  }
  if (layer->depth[vertex] == 0) {
    const laves__vec3 n = layer->normal[vertex];
    const bool on_crease = laves__layer_hold(layer, vertex).kind == LAVES__HOLD_CREASE;
    for (int k = 0; k < b->count; k++) {
      const laves__vec3 g = gradient_of(b, k), along = v3_scale(n, v3_dot(g, n));
      set_gradient(b, k, on_crease ? along : v3_sub(g, along));
    }
  }
  for (int k = b->count; k % STEP != 0; k++) {
    b->value[k] = 0;
    set_gradient(b, k, v3(0, 0, 0));
  }
  int worst = 0;
  for (int k = 1; k < b->count; k++)
    if (b->value[k] < b->value[worst]) worst = k;
  b->working_count = 0;
  if (b->count > 0) add_working(b, worst, 1);
}

/* Moves weight among the working set, from the function with the largest model to the one with the least, until they are
 * level; returns the least model. */
static double level_working_set(bundle *b, double tau, double least, laves__vec3 *sum) {
  for (int exchange = 0;; exchange++) {
    int low = 0, high = -1;
    for (int i = 0; i < b->working_count; i += STEP)
      find_models(b->working_value + i, b->working_x + i, b->working_y + i, b->working_z + i, tau, *sum, b->model + i);
    for (int i = 0; i < b->working_count; i++) {
      if (b->model[i] < b->model[low]) low = i;
      if (b->weight[i] > 0 && (high < 0 || b->model[i] > b->model[high])) high = i;
    }
    LAVES_ASSERT(high >= 0); /* weights sum to 1 */
    const double difference = b->model[high] - b->model[low];
    if (difference <= exact_enough * fabs(b->model[low] - least) || exchange == EXCHANGES_MAX) return b->model[low];
    const laves__vec3 across = v3(b->working_x[low] - b->working_x[high], b->working_y[low] - b->working_y[high],
                                  b->working_z[low] - b->working_z[high]);
    const double curvature = tau * v3_norm2(across);
    double move = b->weight[high];
    if (curvature * move > difference) move = difference / curvature;
    b->weight[high] -= move;
    b->weight[low] += move;
    *sum = v3_mad(*sum, across, move);
  }
}

/* The function with the least model for a step of tau * sum. */
static int least_model(const bundle *b, double tau, laves__vec3 sum, double *model) {
  int low = 0;
  *model = HUGE_VAL;
  for (int k = 0; k < b->count; k += STEP) {
    double models[STEP];
    find_models(b->value + k, b->x + k, b->y + k, b->z + k, tau, sum, models);
    for (int i = 0; i < STEP && k + i < b->count; i++) {
      if (models[i] < *model) {
        *model = models[i];
        low = k + i;
      }
    }
  }
  return low;
}

/* Solves the dual for one tau; returns the step and the gain that the model foretells. Only a handful of functions carry
 * weight, so the problem is solved on a working set that grows by the function which the last step would make the worst. */
static laves__vec3 solve_bundle(bundle *b, double tau, double least, double longest, double *gain) {
  laves__vec3 sum = {0, 0, 0};
  for (int i = 0; i < b->working_count; i++) sum = v3_mad(sum, gradient_of(b, b->working[i]), b->weight[i]);
  for (;;) {
    const double level = level_working_set(b, tau, least, &sum);
    double model;
    const int low = least_model(b, tau, sum, &model);
    *gain = model - least;
    if (model >= level - exact_enough * fabs(level - least) || b->working_count == WORKING_MAX) break;
    bool known = false;
    for (int i = 0; i < b->working_count; i++) known |= b->working[i] == low;
    if (known) break;
    add_working(b, low, 0);
  }
  laves__vec3 step = v3_scale(sum, tau);
  const double length = v3_norm(step);
  if (length > longest) step = v3_scale(step, longest / length);
  return step;
}

double laves__star_quality(const laves__layer *layer, int32_t vertex) {
  const laves__star *star = &layer->star[vertex];
  double worst = HUGE_VAL;
  for (int i = 0; i < star->count; i++)
    if (layer->quality[star->tet[i]] < worst) worst = layer->quality[star->tet[i]];
  return worst;
}

/* Puts the vertex at `place` and measures its star; false, with everything as it was, when a tet is not above `limit` or
 * not positive. */
static bool try_place(const laves__measure *m, laves__layer *layer, int32_t vertex, laves__vec3 place, double limit,
                      laves__journal *journal) {
  enum { STAR_MAX = 128 };
  double quality[STAR_MAX];
  const laves__star *star = &layer->star[vertex];
  if (star->count > STAR_MAX) return false;
  const laves__vec3 old = layer->position[vertex];
  layer->position[vertex] = place;
  bool good = true;
  for (int i = 0; good && i < star->count; i++) {
    laves__vec3 p[4];
    laves__layer_points(layer, star->tet[i], p);
    quality[i] = laves__quality(m, p, laves__layer_cube(layer, star->tet[i]), laves__measure_fixed(m, layer, star->tet[i]));
    /* A volume well above rounding is positive without an exact test; coordinates are some thousands at most. */
    good = quality[i] > limit && (quality[i] > LAVES__FLAT || laves__orient3d(p[0], p[1], p[2], p[3]) > 0);
  }
  layer->position[vertex] = old;
  if (!good || !laves__journal_vertex(journal, layer, vertex)) return false;
  for (int i = 0; i < star->count; i++)
    if (!laves__journal_tet(journal, layer, star->tet[i])) return false;
  layer->position[vertex] = place;
  for (int i = 0; i < star->count; i++) layer->quality[star->tet[i]] = quality[i];
  return true;
}

/* Whether the chords of a crease at a vertex stay near it, or as near as they are, when it moves along. */
static bool keeps_chords(const laves__frame *frame, laves__layer *layer, int32_t vertex, laves__vec3 place) {
  const laves__vec3 here = layer->position[vertex];
  layer->position[vertex] = place;
  const double sag = laves__crease_sag(frame, layer, vertex);
  layer->position[vertex] = here;
  return sag <= LAVES__SAG_LIMIT || sag <= laves__crease_sag(frame, layer, vertex);
}

/* Brings a trial place to where the vertex may stand. */
static bool find_place(const laves__frame *frame, laves__layer *layer, int32_t vertex, double reach, laves__vec3 *place,
                       uint32_t *hint, laves__vec3 *normal) {
  const laves__hold hold = laves__layer_hold(layer, vertex);
  if (layer->patch) { /* a plane or a line through where it stands */
    const laves__vec3 here = layer->position[vertex], n = *normal = layer->normal[vertex], step = v3_sub(*place, here);
    const laves__vec3 along = v3_scale(n, v3_dot(step, n));
    *place = v3_add(here, hold.kind == LAVES__HOLD_CREASE ? along : v3_sub(step, along));
    return true;
  }
  laves__vec3 foot = *place;
  const bool there =
      laves__frame_project_held(frame, hold, *place, reach, hint, &foot, normal) && v3_distance(foot, *place) <= reach;
  *place = foot;
  return there && (hold.kind != LAVES__HOLD_CREASE || keeps_chords(frame, layer, vertex, *place));
}

/* Near flat tets angles hardly change with a vertex's place, and no gradient leads away. There the middle of all around is tried,
 * or half the way. */
static bool leap(const laves__measure *m, laves__layer *layer, int32_t vertex, double least, laves__journal *journal) {
  const laves__star *star = &layer->star[vertex];
  laves__vec3 sum = {0, 0, 0};
  for (int i = 0; i < star->count; i++)
    for (int k = 0; k < 4; k++) sum = v3_add(sum, v3_sub(layer->position[layer->tet[star->tet[i]][k]], layer->position[vertex]));
  const laves__vec3 way = v3_scale(sum, 1 / (3.0 * star->count)), here = layer->position[vertex];
  for (int part = 1; part <= 2; part++)
    if (try_place(m, layer, vertex, v3_mad(here, way, 1.0 / part), least + leap_gain, journal)) return true;
  return false;
}

bool laves__smooth_vertex(const laves__frame *frame, const laves__measure *m, double target, laves__layer *layer, int32_t vertex,
                          laves__journal *journal) {
  const bool on_surface = layer->depth[vertex] == 0;
  const double scale = laves__layer_scale(layer, vertex), reach = surface_reach * scale;
  const laves__hold hold = laves__layer_hold(layer, vertex);
  double tau = first_tau * scale * scale;
  bool moved = false;
  if (on_surface && hold.kind == LAVES__HOLD_CORNER) return false;
  bundle b;
  for (int step = 0; step < STEPS_MAX; step++) {
    const double least = laves__star_quality(layer, vertex);
    if (least >= target) break;
    if (layer->patch && !on_surface && least < leap_below && leap(m, layer, vertex, least, journal)) {
      moved = true;
      continue;
    }
    fill_bundle(&b, m, layer, vertex, least);
    if (b.count == 0) break;
    bool accepted = false;
    for (int attempt = 0; attempt < TRIES_MAX && !accepted; attempt++) {
      double gain;
      laves__vec3 place = v3_add(layer->position[vertex], solve_bundle(&b, tau, least, longest_step * scale, &gain));
      laves__vec3 normal = {0, 0, 0};
      if (gain < least_gain) return moved;
      uint32_t hint = layer->hint[vertex];
      const bool there = !on_surface || find_place(frame, layer, vertex, reach, &place, &hint, &normal);
      if (there && try_place(m, layer, vertex, place, least + accept_share * gain, journal)) {
        accepted = moved = true;
        if (on_surface) {
          layer->normal[vertex] = normal;
          layer->hint[vertex] = hint;
          layer->off_surface[vertex] = false;
        }
        if (laves__star_quality(layer, vertex) - least > good_share * gain) tau *= 2;
      } else {
        tau *= 0.3;
      }
    }
    if (!accepted) break;
  }
  return moved;
}

bool laves__settle_vertex(const laves__frame *frame, const laves__measure *m, double floor, laves__layer *layer, int32_t vertex) {
  enum { PARTS = 3 }; /* the whole way, half of it, a quarter */
  uint32_t hint = layer->hint[vertex];
  const laves__hold hold = laves__layer_hold(layer, vertex);
  laves__vec3 foot, normal;
  const double reach = hold.kind >= LAVES__HOLD_CREASE ? feature_reach : 2 * surface_reach;
  if (!laves__frame_project_held(frame, hold, layer->position[vertex], reach * laves__layer_scale(layer, vertex), &hint, &foot,
                                 &normal))
    return false;
  const double least = laves__star_quality(layer, vertex), limit = least < floor ? least : floor;
  for (int part = 0; part < PARTS; part++) {
    const laves__vec3 place = part == 0 ? foot : v3_lerp(layer->position[vertex], foot, 1.0 / (1 << part));
    if (!try_place(m, layer, vertex, place, limit, NULL)) continue;
    layer->normal[vertex] = normal;
    layer->hint[vertex] = hint;
    layer->off_surface[vertex] = part > 0;
    return true;
  }
  return false;
}
