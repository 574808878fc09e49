/* Implicit solids: a script or an expression becomes an oracle.
 *
 * The script leaves an expression; its coordinate changes are worked out, constants folded, and the rest compiled to a
 * tape. Projection is Newton's method along the gradient, p -= phi g / |g|^2, with steps that never let |phi| grow; many
 * points go side by side, as gradients are cheaper by the batch. Sides of boxes come from intervals. Far from the zero point the
 * tape is compiled once more in coordinates relative to the solid's middle, where transforms and that shift merge into one matrix
 * and lose no digits. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "domain/elementary.h"
#include "domain/feature_implicit.h"
#include "domain/implicit_bounds.h"
#include "domain/script.h"
#include "domain/tape.h"

/* A foot has |phi| below this fraction of |gradient| * diagonal: near the rounding of coordinates. */
static const double foot_tolerance = 1e-13;
/* What is accepted where rounding in phi forbids more, as a fraction of the same. */
static const double foot_tolerance_worst = 1e-10;
enum { NEWTON_LIMIT = 24, HALVING_LIMIT = 12, SAMPLE_DEPTH_LIMIT = 20, PROJECT_BATCH = 64 };
/* How much of the promised decrease a step must keep. */
static const double sufficient_decrease = 1e-3;
/* Solids further from the zero point than this many diagonals get an origin of their own. */
static const double far_away = 16;

typedef struct implicit {
  laves__tape tape; /* in local coordinates */
  laves__oracle *leaves;
  laves__model model; /* owns the domains of the leaves; its expression is freed once the tape is made */
  laves__box3 bounds; /* local */
  double diagonal;
  bool is_distance;
} implicit;

/* ---- the oracle ---- */

static void evaluate(const void *self, size_t count, const laves__vec3 *points, double *phi, uint32_t *hints) {
  const implicit *s = self;
  laves__tape_evaluate(&s->tape, count, points, phi);
  for (size_t i = 0; hints && i < count; i++) hints[i] = LAVES__NO_HINT;
}

/* Newton's method from one point on its way to the surface. */
typedef struct newton {
  laves__vec3 start, point, step, trial; /* trial = point + share * step */
  laves__dual here;                      /* at point */
  double share;
  int steps, halvings;
  bool lost; /* too far from the start */
} newton;

/* Whether a slope can be divided by: its square neither overflows nor loses digits. */
static bool is_usable(double slope2) { return slope2 >= DBL_MIN && slope2 <= DBL_MAX; }

/* Makes the next trial; false when there is none: the foot is found, or the slope lost. */
static bool begin_step(const implicit *s, double longest, newton *n) {
  const double slope2 = v3_norm2(n->here.gradient), length = fabs(n->here.value) / sqrt(slope2);
  if (n->steps == NEWTON_LIMIT || fabs(n->here.value) <= foot_tolerance * s->diagonal * sqrt(slope2)) return false;
  if (!is_usable(slope2) || !isfinite(length)) return false;
  n->share = length > longest ? longest / length : 1;
  n->step = v3_scale(n->here.gradient, -n->here.value / slope2);
  n->halvings = 0;
  n->trial = v3_mad(n->point, n->step, n->share);
  return true;
}

/* Judges a trial: the step is taken when it lowers |phi| enough, else halved. False when that is all. */
static bool end_step(const implicit *s, double reach, laves__dual there, newton *n) {
  if (fabs(there.value) <= (1 - sufficient_decrease * n->share) * fabs(n->here.value)) {
    n->point = n->trial;
    n->here = there;
    n->steps++;
    n->lost = v3_distance(n->point, n->start) > 2 * reach;
    return !n->lost && begin_step(s, reach, n);
  }
  n->share *= 0.5;
  n->trial = v3_mad(n->point, n->step, n->share);
  return ++n->halvings < HALVING_LIMIT;
}

/* Gradients at one point, or several times as fast at many. */
static void find_gradients(const implicit *s, size_t count, const laves__vec3 *points, laves__dual *duals) {
  if (count == 1)
    duals[0] = laves__tape_gradient(&s->tape, points[0]);
  else
    laves__tape_gradients(&s->tape, count, points, duals);
}

/* Whether the way ended on the surface, and within reach. */
static bool has_arrived(const implicit *s, double reach, const newton *n) {
  const double slope2 = v3_norm2(n->here.gradient);
  if (n->lost || !is_usable(slope2)) return false;
  if (!(fabs(n->here.value) <= foot_tolerance_worst * s->diagonal * sqrt(slope2))) return false;
  return v3_distance(n->point, n->start) <= reach;
}

/* Walks up to PROJECT_BATCH points to the surface, all a step at a time. Each goes as it would alone. */
static void walk(const implicit *s, size_t count, const laves__vec3 *points, double reach, newton *ways) {
  laves__vec3 at[PROJECT_BATCH];
  laves__dual found[PROJECT_BATCH];
  newton *active[PROJECT_BATCH];
  size_t active_count = 0;
  find_gradients(s, count, points, found);
  for (size_t i = 0; i < count; i++) {
    ways[i] = (newton){.start = points[i], .point = points[i], .here = found[i]};
    ways[i].lost = s->is_distance && fabs(found[i].value) > reach * (1 + 1e-9);
    if (!ways[i].lost && begin_step(s, reach, &ways[i])) active[active_count++] = &ways[i];
  }
  while (active_count > 0) {
    for (size_t i = 0; i < active_count; i++) at[i] = active[i]->trial;
    find_gradients(s, active_count, at, found);
    size_t left = 0;
    for (size_t i = 0; i < active_count; i++)
      if (end_step(s, reach, found[i], active[i])) active[left++] = active[i];
    active_count = left;
  }
}

static bool project(const void *self, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal) {
  newton way;
  *hint = LAVES__NO_HINT;
  walk(self, 1, &point, reach, &way);
  *foot = way.point;
  *normal = v3_unit(way.here.gradient);
  return has_arrived(self, reach, &way);
}

static void project_many(const void *self, size_t count, const laves__vec3 *points, double reach, laves__projection *feet) {
  newton ways[PROJECT_BATCH];
  for (size_t begin = 0; begin < count; begin += PROJECT_BATCH) {
    const size_t n = count - begin < PROJECT_BATCH ? count - begin : PROJECT_BATCH;
    walk(self, n, points + begin, reach, ways);
    for (size_t i = 0; i < n; i++)
      feet[begin + i] = (laves__projection){.found = has_arrived(self, reach, &ways[i]),
                                            .hint = LAVES__NO_HINT,
                                            .foot = ways[i].point,
                                            .normal = v3_unit(ways[i].here.gradient)};
  }
}

static laves__side side(const void *self, laves__vec3 centre, double radius, laves__vec3 half) {
  const implicit *s = self;
  bool may_be_nan;
  const laves__interval value =
      laves__tape_interval(&s->tape, (laves__box3){v3_sub(centre, half), v3_add(centre, half)}, &may_be_nan);
  if (may_be_nan) return LAVES__UNDECIDED;
  if (value.lower > 0) return LAVES__OUTSIDE;
  if (value.upper < 0) return LAVES__INSIDE;
  if (!s->is_distance) return LAVES__UNDECIDED;
  double phi;
  laves__tape_evaluate(&s->tape, 1, &centre, &phi);
  if (fabs(phi) <= radius * (1 + 1e-9)) return LAVES__UNDECIDED;
  return phi > 0 ? LAVES__OUTSIDE : LAVES__INSIDE;
}

static void free_implicit(laves_context *context, void *self) {
  implicit *s = self;
  if (!s) return;
  laves__tape_free(context, &s->tape);
  laves__free(context, s->leaves, s->model.leaf_count, sizeof *s->leaves);
  laves__model_free(context, &s->model);
  laves__free(context, s, 1, sizeof *s);
}

/* Two parts of the surface that are nearer to one another than this share of the diagonal are in one place: far more than the
 * rounding of values, far less than what a mesh resolves. */
static const double tag_tolerance = 1e-9;

static int32_t tag(const void *self, laves__vec3 foot, uint32_t hint) {
  const implicit *s = self;
  (void)hint;
  const double slope = v3_norm(laves__tape_gradient(&s->tape, foot).gradient);
  const double tolerance = tag_tolerance * s->diagonal * (isfinite(slope) ? slope : 1);
  const laves__leaf_tags leaf_tags = {s->model.leaf_tag_first, s->model.leaf_tags};
  const int32_t found = laves__tape_tag(&s->tape, &leaf_tags, foot, tolerance);
  return found == LAVES__NO_TAG ? 0 : found;
}

static int32_t region(const void *self, laves__vec3 point) {
  const int32_t found = laves__tape_region_at(&((const implicit *)self)->tape, point);
  return found == LAVES__NO_TAG ? 0 : found;
}

/* ---- samples: where cells of a grid meet the surface ---- */

typedef struct sampler {
  const implicit *solid;
  laves__vec3 *points;
  size_t count, capacity;
} sampler;

static bool holds(laves__box3 box, laves__vec3 p) {
  return p.x >= box.lower.x && p.x < box.upper.x && p.y >= box.lower.y && p.y < box.upper.y && p.z >= box.lower.z &&
         p.z < box.upper.z;
}

/* Asks at the cells of 64 leaves, or at each where one takes long; after a cancel it is true everywhere. */
static bool is_cancelled(const sampler *s, int depth) {
  enum { LONG_TAPE = 1000 };
  laves_context *context = s->solid->model.expression.context;
  return depth >= 2 || s->solid->tape.count > LONG_TAPE ? laves__cancelled(context, "samples", 0) : laves__is_cancelled(context);
}

/* After a cancel what is left has no samples; the caller asks whether there was one.
 * A cell that the surface crosses gives the foot of its centre, if that lies within the cell, so feet come about evenly. */
static void sample_cell(sampler *s, laves__box3 cell, int depth) {
  if (s->count == s->capacity || is_cancelled(s, depth)) return;
  const laves__vec3 c = box3_centre(cell), half = v3_sub(cell.upper, c);
  if (side(s->solid, c, v3_norm(half), half) != LAVES__UNDECIDED) return;
  if (depth == 0) {
    uint32_t hint = LAVES__NO_HINT;
    laves__vec3 foot, normal;
    if (project(s->solid, c, 2 * v3_norm(half), &hint, &foot, &normal) && holds(cell, foot)) s->points[s->count++] = foot;
    return;
  }
  for (int i = 0; i < 8; i++) {
    const laves__box3 part = {{i & 1 ? c.x : cell.lower.x, i & 2 ? c.y : cell.lower.y, i & 4 ? c.z : cell.lower.z},
                              {i & 1 ? cell.upper.x : c.x, i & 2 ? cell.upper.y : c.y, i & 4 ? cell.upper.z : c.z}};
    sample_cell(s, part, depth - 1);
  }
}

static size_t sample(const void *self, double spacing, laves__vec3 *points, size_t capacity) {
  const implicit *solid = self;
  sampler s = {.solid = solid, .points = points, .capacity = capacity};
  const laves__vec3 widths = v3_sub(solid->bounds.upper, solid->bounds.lower);
  const double width = max_of(widths.x, max_of(widths.y, widths.z)) * 1.001;
  int depth = 0;
  while (depth < SAMPLE_DEPTH_LIMIT && ldexp(width, -depth) > spacing) depth++;
  const laves__vec3 half = v3(width / 2, width / 2, width / 2), c = box3_centre(solid->bounds);
  do { /* too many: start again with cells twice as wide, rather than leave a part without samples */
    s.count = 0;
    sample_cell(&s, (laves__box3){v3_sub(c, half), v3_add(c, half)}, depth);
  } while (s.count == capacity && depth-- > 0);
  return s.count;
}

/* ---- features ---- */

static laves_result find_features(const laves__feature_wish *wish, laves__features *features, laves__feature_lines *lines,
                                  laves_error *error) {
  const implicit *s = features->oracle->self;
  const laves__implicit_solid solid = {.tape = &s->tape, .bounds = s->bounds, .diagonal = s->diagonal};
  return laves__features_of_implicit(&solid, wish, features, lines, error);
}

/* ---- making ---- */

static laves_result build_tape(implicit *s, const char *name, laves__vec3 origin, laves_error *error) {
  laves__expression *e = &s->model.expression;
  laves__affine shift = laves__affine_identity();
  shift.t = origin;
  const laves__node root = laves__expression_lower(e, s->model.shape.node, &shift);
  if (root == LAVES__NO_NODE) {
    if (!e->too_large) return laves__fail_memory(e->context, error);
    return laves__fail(error, LAVES_ERROR_INPUT, "%s: the solid needs more than %d operations; make it of fewer parts", name,
                       (int)LAVES__NODE_LIMIT);
  }
  return laves__tape_build(e, root, s->leaves, &s->tape, error);
}

static laves_result find_bounds(implicit *s, const char *name, laves__box3 *box, laves_error *error) {
  *box = s->model.shape.box;
  laves_context *context = s->model.expression.context;
  switch (laves__bounds_find(context, &s->tape, box)) {
    case LAVES__BOUNDS_CANCELLED:
      return laves__fail_cancelled(error);
    case LAVES__BOUNDS_EMPTY:
      return laves__fail(error, LAVES_ERROR_INPUT, "%s: the solid is empty: nothing is inside", name);
    case LAVES__BOUNDS_ENDLESS:
      return laves__fail(
          error, LAVES_ERROR_INPUT,
          "%s: the solid has no bounds that can be found; intersect it with a box or wrap it in bounds(solid, {x0, "
          "y0, z0}, {x1, y1, z1})",
          name);
    default:
      break;
  }
  const double diagonal = box3_diagonal(*box);
  if (diagonal > 0 && diagonal < 1e100) return LAVES_OK;
  return laves__fail(error, LAVES_ERROR_INPUT, "%s: the solid is empty, or its size is beyond all measure (diagonal %g)", name,
                     diagonal);
}

static laves_result copy_leaves(implicit *s, laves_context *context, laves_error *error) {
  const laves__model *m = &s->model;
  if (!m->leaf_count) return LAVES_OK;
  s->leaves = laves__alloc(context, m->leaf_count, sizeof *s->leaves);
  if (!s->leaves) return laves__fail_memory(context, error);
  for (size_t i = 0; i < m->leaf_count; i++) s->leaves[i] = m->leaves[i]->oracle;
  return LAVES_OK;
}

/* Takes the names out of a list, in an array of just their number. */
static bool take_names(laves_context *context, laves__tag_list *list, char ***names, int *count) {
  if (list->count == 0) return true;
  char **fitted = laves__realloc(context, list->names, list->capacity, list->count, sizeof *list->names);
  if (!fitted) return false;
  *names = fitted;
  *count = (int)list->count;
  list->names = NULL;
  list->count = list->capacity = 0;
  return true;
}

static laves_result fill_names(laves_domain *domain, implicit *s, laves_error *error) {
  if (!take_names(domain->context, &s->model.names, &domain->tag_names, &domain->info.tag_count) ||
      !take_names(domain->context, &s->model.regions, &domain->region_names, &domain->region_count))
    return laves__fail_memory(domain->context, error);
  if (domain->info.tag_count > 0) domain->oracle.tag = tag;
  if (s->tape.region_count > 0) domain->oracle.region = region;
  return LAVES_OK;
}

static void fill_domain(laves_domain *domain, implicit *s, laves__box3 box, laves__vec3 origin, bool is_expression) {
  const laves__shape *shape = &s->model.shape;
  domain->oracle = (laves__oracle){.self = s,
                                   .origin = origin,
                                   .bounds = s->bounds,
                                   .is_distance = s->is_distance,
                                   .volume = shape->volume,
                                   .area = shape->area,
                                   .evaluate = evaluate,
                                   .project = project,
                                   .project_many = project_many,
                                   .side = side,
                                   .sample = sample,
                                   .find_features = find_features,
                                   .drawn = s->model.kept,
                                   .free = free_implicit};
  snprintf(domain->format, sizeof domain->format, "%s", is_expression ? "Lua expression" : "Lua script");
  domain->info =
      (laves_domain_info){.kind = LAVES_DOMAIN_IMPLICIT, .format = domain->format, .volume = shape->volume, .area = shape->area};
  memcpy(domain->info.lower, &box.lower, sizeof domain->info.lower);
  memcpy(domain->info.upper, &box.upper, sizeof domain->info.upper);
}

laves_result laves__implicit_build(laves_context *context, const char *text, size_t length, bool is_expression, const char *name,
                                   const char *folder, laves_domain *domain, laves_error *error) {
  implicit *s = laves__alloc_zeroed(context, 1, sizeof *s);
  if (!s) return laves__fail_memory(context, error);
  laves__box3 box;
  laves__vec3 origin = v3(0, 0, 0);
  laves_result result = laves__script_run(context, text, length, is_expression, name, folder, &s->model, error);
  if (result == LAVES_OK) result = copy_leaves(s, context, error);
  if (result == LAVES_OK) result = build_tape(s, name, origin, error);
  if (result == LAVES_OK) result = find_bounds(s, name, &box, error);
  if (result == LAVES_OK && v3_norm(box3_centre(box)) > far_away * box3_diagonal(box)) {
    origin = box3_centre(box);
    laves__tape_free(context, &s->tape);
    result = build_tape(s, name, origin, error);
  }
  if (result != LAVES_OK) {
    free_implicit(context, s);
    return result;
  }
  s->bounds = (laves__box3){v3_sub(box.lower, origin), v3_sub(box.upper, origin)};
  s->diagonal = box3_diagonal(box);
  s->is_distance = s->model.shape.exact;
  laves__expression_free(&s->model.expression);
  fill_domain(domain, s, box, origin, is_expression);
  return fill_names(domain, s, error); /* the domain owns s now, and frees it */
}
