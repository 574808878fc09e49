/* The size of elements over space, bound to a domain.
 *
 * In: options, with the sources of laves_options.sizing, and a domain.  Out: sizes anywhere; what asks at the surface only is in
 * size_samples.c.
 *
 *   ceiling: size, or with interior growth, size + growth * (depth below the rind), up to max_size
 *   sources: expressions, scripts, backgrounds, points, curves, tags
 *   size = clamp(min(ceiling, sources), floor, ceiling)
 *
 * An expression that is one number lowers the base. Expressions are asked at the
 * nearest place of the domain's box, as the background reaches beyond it. Where an expression yields no size (zero, less, or
 * not finite) outside the solid, it asks for nothing; inside, it is at fault, which is looked for at the start at a grid of
 * places, and noted ever after. */
#include <stdatomic.h>
#include <stdio.h>

#include "size/size_parts.h"

/* Where none is asked for: the finest is this part of the size, and growth ends at this many sizes. */
static const double standard_floor = 1.0 / 64, standard_growth_end = 16;
/* Growth begins this many sizes below the surface, so that the boundary layer is made of tiles of one size: without it the
 * distance to the surface is a fifth larger and angles are some degrees worse, for a quarter less elements. */
static const double rind_sizes = 0.75;
/* Points along each axis at which sources are tried at the start. */
enum { TRIAL_GRID = 12, TRIAL_SAMPLES = 2048 };
/* A place is inside when phi is below this part of the diagonal: the surface's own points are. */
static const double surface_slack = 1e-9;

struct laves__size_failure {
  atomic_flag lock;
  bool failed;
  const laves__source *source;
  laves__vec3 point; /* of several the first by coordinates, so that it does not depend on threads */
  double value;
};

/* ---- asking ---- */

static bool comes_before(laves__vec3 a, laves__vec3 b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }

/* A source yields no size at a point of the solid. */
static void note_failure(const laves__size *s, const laves__source *source, laves__vec3 point, double value) {
  struct laves__size_failure *f = s->failure;
  while (atomic_flag_test_and_set_explicit(&f->lock, memory_order_acquire)) {
  }
  if (!f->failed || comes_before(point, f->point)) {
    f->failed = true;
    f->source = source;
    f->point = point;
    f->value = value;
  }
  atomic_flag_clear_explicit(&f->lock, memory_order_release);
}

static bool is_inside(const laves__size *s, laves__vec3 point) {
  double phi;
  s->oracle->evaluate(s->oracle->self, 1, &point, &phi, NULL);
  return phi <= surface_slack * box3_diagonal(s->oracle->bounds);
}

static laves__vec3 nearest_in_box(laves__box3 box, laves__vec3 p) { return v3_min(v3_max(p, box.lower), box.upper); }

static void apply_field(const laves__size *s, const laves__size_field *field, size_t count, const laves__vec3 *points,
                        double *sizes) {
  laves__vec3 places[LAVES__SIZE_BATCH];
  double values[LAVES__SIZE_BATCH];
  for (size_t i = 0; i < count; i++) places[i] = nearest_in_box(s->oracle->bounds, points[i]);
  laves__tape_evaluate(&field->tape, count, places, values);
  for (size_t i = 0; i < count; i++) {
    if (values[i] > 0 && values[i] < LAVES__TAPE_NOWHERE)
      sizes[i] = fmin(sizes[i], values[i]);
    else if (is_inside(s, places[i]))
      note_failure(s, field->source, places[i], values[i]);
  }
}

static void apply_background(const laves__size *s, const laves__background_sizes *background, size_t count,
                             const laves__vec3 *points, double *sizes) {
  laves__vec3 places[LAVES__SIZE_BATCH];
  double values[LAVES__SIZE_BATCH];
  for (size_t i = 0; i < count; i++) places[i] = v3_add(points[i], s->oracle->origin);
  laves__background_evaluate(background, count, places, values);
  for (size_t i = 0; i < count; i++) sizes[i] = fmin(sizes[i], values[i]);
}

static void start_at_ceiling(const laves__size *s, size_t count, const laves__vec3 *points, double *sizes) {
  if (s->growth > 0) laves__depth_evaluate(&s->depth, count, points, sizes);
  const double rind = rind_sizes * s->base;
  for (size_t i = 0; i < count; i++)
    sizes[i] = s->growth > 0 ? fmin(s->ceiling, s->base + s->growth * fmax(0, sizes[i] - rind)) : s->ceiling;
}

static void evaluate_batch(const laves__size *s, size_t count, const laves__vec3 *points, double *sizes) {
  start_at_ceiling(s, count, points, sizes);
  for (size_t k = 0; k < s->field_count; k++) apply_field(s, &s->fields[k], count, points, sizes);
  for (size_t k = 0; k < s->background_count; k++) apply_background(s, s->backgrounds[k]->background, count, points, sizes);
  for (size_t k = 0; k < s->place_count; k++)
    for (size_t i = 0; i < count; i++) sizes[i] = laves__size_place_least(&s->places[k], s->grading, points[i], sizes[i]);
  for (size_t i = 0; i < count; i++) sizes[i] = fmax(s->floor, sizes[i]);
}

void laves__size_evaluate(const laves__size *size, size_t count, const laves__vec3 *points, double *sizes) {
  for (size_t begin = 0; begin < count; begin += LAVES__SIZE_BATCH) {
    const size_t n = count - begin < LAVES__SIZE_BATCH ? count - begin : LAVES__SIZE_BATCH;
    evaluate_batch(size, n, points + begin, sizes + begin);
  }
}

laves_result laves__size_status(const laves__size *size, laves_error *error) {
  const struct laves__size_failure *f = size->failure;
  if (!f->failed) return LAVES_OK;
  const laves__vec3 p = v3_add(f->point, size->oracle->origin);
  const bool finite = fabs(f->value) < LAVES__TAPE_NOWHERE;
  char value[40] = "not a finite number";
  if (finite) snprintf(value, sizeof value, "%.6g", f->value);
  return laves__fail(error, LAVES_ERROR_INPUT, "%s: the size at (%.6g, %.6g, %.6g) is %s, but sizes must be positive%s",
                     f->source->name, p.x, p.y, p.z, value, finite ? "" : " and finite");
}

bool laves__size_is_constant(const laves__size *s) {
  return s->growth == 0 && s->field_count == 0 && s->place_count == 0 && s->background_count == 0 && s->curvature_elements == 0 &&
         s->thickness_elements == 0 && s->feature_elements == 0 && s->max_distance == 0;
}

double laves__size_grading(const laves__size *size) { return size->grading; }
double laves__size_floor(const laves__size *size) { return size->floor; }
double laves__size_ceiling(const laves__size *size) { return size->ceiling; }

/* ---- binding ---- */

/* A field that is one number lowers the base instead. */
static laves_result add_field(laves__size *s, const laves__source *source, laves_error *error) {
  if (!laves__grow(s->context, &s->fields, &s->field_capacity, s->field_count + 1, sizeof *s->fields))
    return laves__fail_memory(s->context, error);
  laves__size_field *field = &s->fields[s->field_count];
  double value;
  laves_result result = laves__size_field_make(s->context, source, s->oracle->origin, field, error);
  if (result == LAVES_OK && laves__size_field_is_constant(field, &value)) {
    if (!(value > 0) || !isfinite(value))
      result = laves__fail(error, LAVES_ERROR_INPUT, "%s: the size is %g, but sizes must be positive", source->name, value);
    s->base = fmin(s->base, value);
    laves__size_field_free(s->context, field);
    return result;
  }
  s->field_count++;
  return result;
}

static laves_result add_place(laves__size *s, const laves__source *source, laves_error *error) {
  if (!laves__grow(s->context, &s->places, &s->place_capacity, s->place_count + 1, sizeof *s->places))
    return laves__fail_memory(s->context, error);
  return laves__size_place_make(s->context, source, s->domain, &s->places[s->place_count++], error);
}

static laves_result add_source(laves__size *s, const laves__source *source, laves_error *error) {
  switch (source->kind) {
    case LAVES__SOURCE_SCRIPT:
      return add_field(s, source, error);
    case LAVES__SOURCE_BACKGROUND:
      if (!laves__grow(s->context, &s->backgrounds, &s->background_capacity, s->background_count + 1, sizeof *s->backgrounds))
        return laves__fail_memory(s->context, error);
      s->backgrounds[s->background_count++] = source;
      return LAVES_OK;
    default:
      return add_place(s, source, error);
  }
}

/* Ceiling and floor, once the base is known. */
static laves_result set_limits(laves__size *s, const laves_options *options, double base_size, laves_error *error) {
  if (options->min_size > base_size)
    return laves__fail(error, LAVES_ERROR_OPTION, "min_size is %g but the size is %g; the first must not be greater",
                       options->min_size, base_size);
  if (options->max_size != 0 && options->max_size < base_size)
    return laves__fail(error, LAVES_ERROR_OPTION, "max_size is %g but the size is %g; the first must not be less",
                       options->max_size, base_size);
  s->floor = options->min_size > 0 ? options->min_size : standard_floor * base_size;
  s->base = fmax(s->base, s->floor);
  s->grading = options->grading;
  s->growth = fmin(options->interior_growth, options->grading);
  s->ceiling = s->base;
  if (s->growth > 0 && options->max_size > 0) {
    const double deepest = 0.5 * box3_diagonal(s->oracle->bounds);
    s->ceiling = fmin(options->max_size, s->base + s->growth * deepest);
  } else if (s->growth > 0) {
    s->ceiling = standard_growth_end * s->base;
  }
  return LAVES_OK;
}

static laves_result bind_depth(laves__size *s, laves_error *error) {
  bool needed = s->growth > 0;
  for (size_t k = 0; k < s->field_count; k++) needed |= s->fields[k].uses_depth;
  if (!needed) return LAVES_OK;
  const laves_result result = laves__depth_build(s->context, s->domain, 0.5 * s->base, &s->depth, error);
  if (result != LAVES_OK) return result;
  for (size_t k = 0; k < s->field_count; k++) laves__size_field_bind(&s->fields[k], &s->depth);
  return LAVES_OK;
}

/* Asks expressions at a grid in the box and at points of the surface, so that mistakes are found at once. */
static laves_result try_fields(laves__size *s, laves_error *error) {
  if (s->field_count == 0) return LAVES_OK;
  enum { COUNT = TRIAL_GRID * TRIAL_GRID * TRIAL_GRID + TRIAL_SAMPLES };
  laves__vec3 *points = laves__alloc(s->context, COUNT, sizeof *points);
  double *sizes = laves__alloc(s->context, COUNT, sizeof *sizes);
  laves_result result = LAVES_OK;
  if (points && sizes) {
    const laves__box3 box = s->oracle->bounds;
    const laves__vec3 width = v3_scale(v3_sub(box.upper, box.lower), 1.0 / (TRIAL_GRID - 1));
    size_t count = 0;
    for (int k = 0; k < TRIAL_GRID; k++)
      for (int j = 0; j < TRIAL_GRID; j++)
        for (int i = 0; i < TRIAL_GRID; i++) points[count++] = v3_add(box.lower, v3(i * width.x, j * width.y, k * width.z));
    if (s->oracle->sample) count += s->oracle->sample(s->oracle->self, 0.05 * box3_diagonal(box), points + count, TRIAL_SAMPLES);
    laves__size_evaluate(s, count, points, sizes);
    result = laves__size_status(s, error);
  } else {
    result = laves__fail_memory(s->context, error);
  }
  laves__free(s->context, points, COUNT, sizeof *points);
  laves__free(s->context, sizes, COUNT, sizeof *sizes);
  return result;
}

static laves_result bind(laves__size *s, const laves_options *options, double base_size, laves_error *error) {
  const laves_sizing *sizing = options->sizing;
  laves_result result = LAVES_OK;
  s->failure = laves__alloc_zeroed(s->context, 1, sizeof *s->failure);
  if (!s->failure) return laves__fail_memory(s->context, error);
  atomic_flag_clear(&s->failure->lock);
  for (size_t i = 0; result == LAVES_OK && sizing && i < sizing->count; i++) result = add_source(s, &sizing->sources[i], error);
  if (result == LAVES_OK) result = set_limits(s, options, base_size, error);
  if (result == LAVES_OK) result = bind_depth(s, error);
  if (result == LAVES_OK) result = try_fields(s, error);
  return result;
}

laves_result laves__size_create(laves_context *context, const laves_domain *domain, const laves_options *options,
                                double base_size, laves__size **size, laves_error *error) {
  *size = NULL;
  laves__size *s = laves__alloc_zeroed(context, 1, sizeof *s);
  if (!s) return laves__fail_memory(context, error);
  s->context = context;
  s->domain = domain;
  s->oracle = &domain->oracle;
  s->base = base_size;
  s->curvature_elements = options->curvature_elements;
  s->thickness_elements = options->thickness_elements;
  s->feature_elements = options->feature_elements;
  s->max_distance = options->max_distance;
  const laves_result result = bind(s, options, base_size, error);
  if (result != LAVES_OK) {
    laves__size_free(s);
    return result;
  }
  *size = s;
  return LAVES_OK;
}

void laves__size_free(laves__size *s) {
  if (!s) return;
  laves_context *context = s->context;
  for (size_t k = 0; k < s->field_count; k++) laves__size_field_free(context, &s->fields[k]);
  for (size_t k = 0; k < s->place_count; k++) laves__bvh_free(context, &s->places[k].bvh);
  laves__free(context, s->fields, s->field_capacity, sizeof *s->fields);
  laves__free(context, s->places, s->place_capacity, sizeof *s->places);
  laves__free(context, s->backgrounds, s->background_capacity, sizeof *s->backgrounds);
  laves__depth_free(&s->depth);
  laves__free(context, s->failure, 1, sizeof *s->failure);
  laves__free(context, s, 1, sizeof *s);
}
