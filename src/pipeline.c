/* The story from domain to mesh, in one function: laves_generate().
 *
 *     domain -> sizes -> background -> classify -> snap -> features -> improve -> (stuff -> improve, where the promise is broken)
 *     -> mesh -> verdict
 *
 * Each stage is one call with one promise, told in its header; each is timed. run.h tells which file takes which steps. All
 * coordinates between classify and mesh are those of the frame: centred on the domain, turned as wished, in units of the size. */
#include <string.h>

#include "assemble/assemble.h"
#include "estimate.h"
#include "run.h"

/* Where the lattice lies and how large it is. */
static laves_result choose_frame(laves__run *r) {
  const laves__oracle *oracle = &r->domain->oracle;
  laves__stage_begin(r);
  r->report->volume = laves__domain_volume(r->context, oracle);
  if (laves__is_cancelled(r->context)) return laves__fail_cancelled(r->error);
  r->frame.oracle = oracle;
  r->frame.centre = box3_centre(oracle->bounds);
  r->frame.rotation = laves__options_rotation(r->options, oracle);
  r->frame.face_sources = r->options->face_sources;
  r->frame.size = laves__options_size(r->options, oracle, r->report->volume);
  laves__stage_end(r, "background");
  if (r->frame.size > 0 && isfinite(r->frame.size)) return LAVES_OK;
  char gaps[160];
  if (laves__tell_gaps(r, gaps, sizeof gaps)) return laves__fail(r->error, LAVES_ERROR_INPUT, "no inside was found: %s", gaps);
  return laves__fail(r->error, LAVES_ERROR_INPUT, "no inside was found: the volume of the solid is %g", r->report->volume);
}

static bool has_target(const laves_options *o) { return o->tet_target > 0 || o->vertex_target > 0; }

/* Regions are found tetrahedron by tetrahedron, which a streamed mesh does not hold. */
static laves_result check_streaming(const laves__run *r) {
  const bool regions = r->domain->oracle.region || r->options->regions != LAVES_REGIONS_NONE;
  if (!r->options->streamed || !regions) return LAVES_OK;
  return laves__fail(r->error, LAVES_ERROR_OPTION,
                     "regions need a mesh in memory, but it was asked to be streamed; leave one of the two away");
}

/* What is wished where. A field that turns out to be the same everywhere is none. */
static laves_result choose_sizes(laves__run *r) {
  const double base = r->frame.size;
  laves__stage_begin(r);
  laves_result result = laves__size_create(r->context, r->domain, r->options, base, &r->sizes, r->error);
  if (result == LAVES_OK && laves__size_is_constant(r->sizes)) {
    r->frame.size = laves__size_ceiling(r->sizes);
    laves__size_free(r->sizes);
    r->sizes = NULL;
    result = laves__refuse_uniform(r->context, r->options, r->frame.oracle, r->report->volume, r->frame.size, r->error);
  } else if (result == LAVES_OK && (r->options->method == LAVES_METHOD_STUFF || r->options->streamed)) {
    result = laves__fail(r->error, LAVES_ERROR_OPTION,
                         "%s needs one size everywhere, but sizes that vary were asked for; leave one of the two away",
                         r->options->streamed ? "streaming" : "stuffing");
  } else if (result == LAVES_OK) {
    r->guarantee = NULL; /* what is proved is proved for one size */
    result = laves__wishes_make(r->context, r->sizes, base, &r->wishes, r->error);
    if (result == LAVES_OK && has_target(r->options)) {
      laves_expectation counts;
      result = laves__estimate_graded(r->context, r->options, &r->wishes, &r->frame, &counts, r->error);
    }
  }
  if (r->sizes) laves__stage_end(r, "sizes");
  return result;
}

static laves_result name_groups(const laves__run *r, laves_mesh *mesh) {
  if (!mesh->regions && !laves__mesh_add_group(mesh, 3, 1, "solid")) return laves__fail_memory(r->context, r->error);
  const int tags = mesh->face_tags ? r->domain->info.tag_count : 0;
  if (tags == 0 && !laves__mesh_add_group(mesh, 2, 1, "boundary")) return laves__fail_memory(r->context, r->error);
  for (int i = 0; i < tags; i++)
    if (!laves__mesh_add_group(mesh, 2, i + 1, r->domain->tag_names[i])) return laves__fail_memory(r->context, r->error);
  return LAVES_OK;
}

static laves_result find_regions(laves__run *r, laves_mesh *mesh) {
  const bool named = r->domain->oracle.region != NULL;
  if (!named && r->options->regions == LAVES_REGIONS_NONE) return LAVES_OK;
  laves__stage_begin(r);
  const laves_result result =
      (named ? laves__regions_of_names : laves__regions_of_parts)(r->context, r->domain, mesh, &r->regions, r->error);
  laves__stage_end(r, "regions");
  return result;
}

static laves_result make_mesh(laves__run *r, laves_mesh **mesh) {
  laves__stage_begin(r);
  laves_result result = laves__assemble(&r->frame, &r->lattice, &r->layer, r->options->streamed, mesh, r->error);
  if (result == LAVES_OK && (*mesh)->tet_count == 0) result = laves__nothing_resolved(r); /* slivers, all contracted away */
  laves__stage_end(r, "mesh");
  return result;
}

/* Where sizes vary or features are kept improvement may cost some per cent of a count that was asked for; then all is made again
 * for a count that is larger by as much. Where features crowd, that share jumps with the size: some sizes are tried, and in the
 * end the best of them is taken. Where much is outside the window each takes long: there it is the second, unless that is far
 * off. */
static laves_result count_again(laves__run *r, laves_mesh **mesh, bool *again) {
  enum { RECOUNTS = 5, SLOW_RECOUNTS = 1 };
  static const double tolerance = 0.025, far_off = 0.1;
  static const double slow_share = 0.05; /* of the tetrahedra, outside the window, the first time */
  const laves_options *o = r->options;
  const double wished = o->tet_target ? (double)o->tet_target : (double)o->vertex_target;
  const double got = o->tet_target ? (double)(*mesh)->tet_count : (double)(*mesh)->vertex_count;
  *again = (r->sizes || r->frame.features) && has_target(o) && !r->settled && fabs(got / wished - 1) > tolerance;
  if (!*again) return LAVES_OK;
  if (r->recounts == 0) {
    const bool slow = o->improve && (double)laves__count_outside(r) > slow_share * (double)(*mesh)->tet_count;
    r->recounts_max = slow ? SLOW_RECOUNTS : RECOUNTS;
  }
  if (r->recounts == 0 || fabs(log(got / wished)) < r->least_miss) {
    r->least_miss = fabs(log(got / wished));
    r->best_size = r->frame.size;
  }
  r->kept = got / r->counted;
  r->settled = r->recounts++ >= r->recounts_max;
  if (r->settled) *again = r->frame.size != r->best_size && (r->recounts_max > SLOW_RECOUNTS || fabs(got / wished - 1) > far_off);
  if (!*again) return LAVES_OK;
  if (r->settled) r->frame.size = r->best_size;
  laves_mesh_free(*mesh);
  *mesh = NULL;
  return LAVES_OK;
}

/* Where the boundary is further from the surface than asked, smaller sizes are wished; then all is made again. *again: it must
 * be. */
static laves_result refine_where_distant(laves__run *r, laves_mesh **mesh, bool *again) {
  enum { ROUNDS = 5, PLACES = 4096 };
  const double wished = r->options->max_distance;
  *again = false;
  r->distant = 0;
  if (!(wished > 0)) return LAVES_OK;
  laves_place *place = laves__alloc(r->context, PLACES, sizeof *place);
  if (!place) return laves__fail_memory(r->context, r->error);
  laves__stage_begin(r);
  laves_result result = laves_check_distance(r->context, *mesh, r->domain, wished, place, PLACES, &r->distant, r->error);
  if (r->distant > 0) r->distant_place = v3(place[0].place[0], place[0].place[1], place[0].place[2]);
  const size_t known = r->distant < PLACES ? r->distant : PLACES;
  if (result == LAVES_OK && r->round++ < ROUNDS && !laves__wishes_approach(&r->wishes, &r->tree, wished, place, known, again))
    result = laves__fail_memory(r->context, r->error);
  laves__stage_end(r, "distance");
  laves__free(r->context, place, PLACES, sizeof *place);
  if (*again && result == LAVES_OK) {
    laves_mesh_free(*mesh);
    *mesh = NULL;
  }
  return result;
}

laves_result laves_generate(laves_context *context, const laves_domain *domain, const laves_options *options, laves_mesh **mesh,
                            laves_report *report, laves_error *error) {
  laves_report own_report;
  laves__run r = {.context = context,
                  .domain = domain,
                  .options = options,
                  .report = report ? report : &own_report,
                  .error = error,
                  .kept = 1};
  laves__vec3 place;
  memset(r.report, 0, sizeof *r.report);
  r.gaps_before = laves__function_gaps(domain, &place);
  *mesh = NULL;
  laves__progress_reset(context);

  laves_result result = laves__options_check(options, error);
  if (result == LAVES_OK) result = check_streaming(&r);
  if (result == LAVES_OK) result = choose_frame(&r);
  if (result == LAVES_OK) r.guarantee = laves__options_guarantee(options);
  if (result == LAVES_OK) result = choose_sizes(&r);
  for (bool again = true; again && result == LAVES_OK;) {
    result = laves__make_boundary(&r);
    if (result == LAVES_OK) result = laves__hold_boundary(&r);
    if (result == LAVES_OK) result = laves__improve_boundary(&r);
    if (result == LAVES_OK) result = make_mesh(&r, mesh);
    if (result == LAVES_OK) result = refine_where_distant(&r, mesh, &again);
    if (result == LAVES_OK && !again) result = count_again(&r, mesh, &again);
  }
  if (result == LAVES_OK) result = find_regions(&r, *mesh);
  if (result == LAVES_OK) result = name_groups(&r, *mesh);
  if (result == LAVES_OK) result = laves__judge(&r, *mesh);

  if (result != LAVES_OK && result != LAVES_TARGET_MISSED) {
    laves_mesh_free(*mesh);
    *mesh = NULL;
  }
  laves__free(context, r.forced, r.forced_count, sizeof *r.forced);
  laves__features_free(&r.features);
  laves__layer_free(&r.layer);
  laves__lattice_free(&r.lattice);
  laves__graph_free(&r.graph);
  laves__octree_free(&r.tree);
  laves__wishes_free(&r.wishes);
  laves__size_free(r.sizes);
  return result;
}
