/* What a mesh will hold, before it is made.
 *
 * In: what laves_generate() takes.  Out: counts. Sizes that vary are made into the octree that the mesh would have, whose leaves
 * are counted by the share of each that is inside; one size everywhere goes by the volume. With a target, all sizes are scaled
 * together until the estimate meets it, as the pipeline does with the counts themselves. */
#include "estimate.h"

#include "background/c15_table.h"
#include "graded/graded.h"
#include "options.h"

static const double cell_side = LAVES__C15_PERIOD / LAVES__C15_MEAN_EDGE;
enum { CORRECTIONS = 8 };

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
    laves_result result = laves__graded_estimate(frame, &demand, context, &counts->tets, &counts->vertices, error);
    if (result == LAVES_OK) result = laves__size_status(wishes->size, error);
    if (result != LAVES_OK) return result;
    const double factor = laves__options_correction(options, (int64_t)counts->tets, (int64_t)counts->vertices);
    if (factor == 1 || correction == CORRECTIONS) return LAVES_OK;
    frame->size *= factor;
  }
}

static void count_uniform(const estimating *e, double size, laves_expectation *out) {
  const double cells = e->volume / (cell_side * size * cell_side * size * cell_side * size);
  out->tets = LAVES__C15_TETS * cells;
  out->vertices = LAVES__C15_SITES * cells;
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
    count_uniform(&e, e.frame.size, expectation);
  } else if (result == LAVES_OK) {
    result = laves__wishes_make(context, e.sizes, e.frame.size, &e.wishes, error);
    if (result == LAVES_OK) result = laves__estimate_graded(context, options, &e.wishes, &e.frame, expectation, error);
  }
  expectation->size = e.frame.size;
  laves__wishes_free(&e.wishes);
  laves__size_free(e.sizes);
  return result;
}
