/* What a mesh will hold, before it is made.
 *
 * In: what laves_generate() takes.  Out: counts. Sizes that vary are made into the octree that the mesh would have, whose leaves
 * are counted by the share of each that is inside; one size everywhere goes by the volume. With a target, all sizes are scaled
 * together until the estimate meets it, as the pipeline does with the counts themselves. */
#include "estimate.h"

#include <stdio.h>

#include "background/c15_table.h"
#include "domain/features.h"
#include "graded/graded.h"
#include "options.h"

static const double cell_side = LAVES__C15_PERIOD / LAVES__C15_MEAN_EDGE;
enum { CORRECTIONS = 8 };

/* Bytes of the context, measured on balls, a plate, a torus, a gyroid, surfaces and machine parts of 0.05 to 8 million tets.
 * While the mesh is filled and the layer still stands: per tet, and per tet of the layer, which takes up so many for each size^2
 * of surface. */
static const double bytes_at_start = 2e6, made_per_tet = 22, made_per_layer_tet = 121, layer_per_area = 16.1;
/* While it is certified: faces are matched in ranges, so that many tets take less each; samples go with the surface. */
static const double certified_per_tet = 90, matched_at_most = 160e6, certified_beyond = 25, certified_per_area = 2600;
static const double certified_per_varying_tet = 200;

typedef struct estimating {
  laves_context *context;
  const laves_options *options;
  laves__frame frame;
  double volume;
  laves__size *sizes;
  laves__wishes wishes;
} estimating;

laves_result laves__estimate_graded(laves_context *context, const laves_options *options, laves__wishes *wishes,
                                    laves__frame *frame, laves_expectation *counts, laves_error *error) {
  for (int correction = 0;; correction++) {
    laves__demand demand;
    if (!laves__wishes_demand(wishes, frame, &demand)) return laves__fail_memory(context, error);
    size_t leaves = 0;
    laves_result result = laves__graded_estimate(frame, &demand, context, &counts->tets, &counts->vertices, &leaves, error);
    counts->peak_bytes = laves__graded_bytes(leaves);
    counts->certify_bytes = bytes_at_start + certified_per_varying_tet * counts->tets;
    if (result == LAVES_OK) result = laves__size_status(wishes->size, error);
    if (result != LAVES_OK) return result;
    const double factor = laves__options_correction(options, (int64_t)counts->tets, (int64_t)counts->vertices);
    if (factor == 1 || correction == CORRECTIONS) return LAVES_OK;
    frame->size *= factor;
  }
}

static void count_uniform(const laves_options *options, double volume, double area, double size, laves_expectation *out) {
  const double cells = volume / (cell_side * size * cell_side * size * cell_side * size), places = area / (size * size);
  out->size = size;
  out->tets = LAVES__C15_TETS * cells;
  out->vertices = LAVES__C15_SITES * cells;
  out->peak_bytes = bytes_at_start + (options->streamed ? 0 : made_per_tet * out->tets) +
                    made_per_layer_tet * fmin(out->tets, layer_per_area * places);
  out->certify_bytes = bytes_at_start + certified_per_area * places +
                       fmin(certified_per_tet * out->tets, matched_at_most + certified_beyond * out->tets);
}

/* The least size, to two digits, whose mesh fits into `room`. */
static double fitting_size(const laves_options *options, double volume, double area, double size, double room) {
  laves_expectation of = {0};
  double low = size, high = size;
  do {
    high *= 2;
    count_uniform(options, volume, area, high, &of);
  } while (of.peak_bytes > room && isfinite(high));
  while (high / low > 1.001) {
    const double middle = sqrt(low) * sqrt(high);
    count_uniform(options, volume, area, middle, &of);
    *(of.peak_bytes > room ? &low : &high) = middle;
  }
  const double digit = pow(10, floor(log10(high)) - 1);
  return ceil(high / digit) * digit;
}

laves_result laves__refuse_uniform(laves_context *context, const laves_options *options, const laves__oracle *oracle,
                                   double volume, double size, laves_error *error) {
  if (laves__may_fit(context, INFINITY)) return LAVES_OK;
  const double area = laves__domain_area(context, oracle), room = laves__room(context);
  laves_expectation of = {0}, fitting = {0};
  if (laves__is_cancelled(context)) return laves__fail_cancelled(error);
  count_uniform(options, volume, area, size, &of);
  if (laves__may_fit(context, of.peak_bytes)) return LAVES_OK;
  char what[120], remedy[160] = "raise it";
  static const double countless = 1e15;
  if (of.tets < countless)
    snprintf(what, sizeof what, "a mesh of size %.3g (about %.2g tetrahedra)", size, of.tets);
  else
    snprintf(what, sizeof what, "a mesh of so small a size as %.3g", size);
  if (room > bytes_at_start) {
    count_uniform(options, volume, area, fitting_size(options, volume, area, size, room), &fitting);
    snprintf(remedy, sizeof remedy, "raise it, or choose a size of %.2g, which fits (about %.2g tetrahedra)", fitting.size,
             fitting.tets);
  }
  return laves__fail_room(context, of.peak_bytes, what, remedy, error);
}

static laves_result find_frame(estimating *e, const laves_domain *domain, laves_error *error) {
  const laves__oracle *oracle = &domain->oracle;
  e->volume = laves__domain_volume(e->context, oracle);
  if (laves__is_cancelled(e->context)) return laves__fail_cancelled(error);
  e->frame = (laves__frame){.oracle = oracle,
                            .centre = box3_centre(oracle->bounds),
                            .rotation = laves__options_rotation(e->options, oracle),
                            .size = laves__options_size(e->options, oracle, e->volume)};
  if (e->frame.size > 0 && isfinite(e->frame.size)) return LAVES_OK;
  return laves__fail(error, LAVES_ERROR_INPUT, "no inside was found: the volume of the solid is %g", e->volume);
}

/* As the pipeline looks for them where sizes do not vary. */
static laves_result count_creases(const estimating *e, size_t *count, laves_error *error) {
  const laves_options *o = e->options;
  const laves__feature_wish wish = {
      .angle = o->feature_angle, .tags = o->feature_tags, .drawn = o->features, .size = e->frame.size};
  laves__features features = {0};
  const laves_result result = laves__features_find(e->context, e->frame.oracle, &wish, &features, error);
  *count = features.crease_count;
  laves__features_free(&features);
  return result;
}

laves_result laves_estimate(laves_context *context, const laves_domain *domain, const laves_options *options,
                            laves_expectation *expectation, laves_error *error) {
  estimating e = {.context = context, .options = options};
  *expectation = (laves_expectation){0};
  laves__progress_reset(context);
  laves_result result = laves__options_check(options, error);
  if (result == LAVES_OK) result = find_frame(&e, domain, error);
  if (result == LAVES_OK) result = laves__size_create(context, domain, options, e.frame.size, &e.sizes, error);
  if (result == LAVES_OK && laves__size_is_constant(e.sizes)) {
    e.frame.size = laves__size_ceiling(e.sizes);
    count_uniform(options, e.volume, laves__domain_area(context, &domain->oracle), e.frame.size, expectation);
    if (laves__is_cancelled(context)) result = laves__fail_cancelled(error);
  } else if (result == LAVES_OK) {
    result = laves__wishes_make(context, e.sizes, e.frame.size, &e.wishes, error);
    if (result == LAVES_OK) result = laves__estimate_graded(context, options, &e.wishes, &e.frame, expectation, error);
  }
  if (result == LAVES_OK && domain->info.kind == LAVES_DOMAIN_SURFACE) result = count_creases(&e, &expectation->creases, error);
  expectation->size = e.frame.size;
  laves__wishes_free(&e.wishes);
  laves__size_free(e.sizes);
  expectation->peak_bytes += (double)laves_context_bytes(context);
  expectation->certify_bytes += (double)laves_context_bytes(context);
  return result;
}
