/* The story from domain to mesh, in one function: laves_generate().
 *
 *     domain -> sizes -> background -> classify -> snap -> improve -> (stuff -> improve, where the promise is broken) -> mesh
 *
 * Each stage is one call with one promise, told in its header; each is timed. All coordinates between classify and mesh are
 * those of the frame: centred on the domain, turned as wished, in units of the size. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "assemble/assemble.h"
#include "classify/classify.h"
#include "estimate.h"
#include "graded/graded.h"
#include "graded/wishes.h"
#include "improve/improve.h"
#include "losses.h"
#include "options.h"
#include "snap/snap.h"
#include "stuff/stuff.h"
#include "stuff/zone.h"

/* What lives from stage to stage. */
typedef struct run {
  laves_context *context;
  const laves_domain *domain;
  const laves_options *options;
  laves_report *report;
  laves_error *error;
  laves__frame frame;
  laves__size *sizes; /* NULL: the size is the same everywhere, and the next three are not used */
  laves__wishes wishes;
  laves__octree tree;
  laves__graph graph;
  laves__lattice lattice;
  laves__layer layer;
  laves__snap_counts counts;
  laves__stuff_counts stuffed;
  const laves__guarantee *guarantee; /* NULL: nothing is promised */
  double counted, kept;              /* tets or vertices before improvement, whichever are asked for; their share after it */
  bool recounted;                    /* once is enough */
  int round;                         /* of refinement for the sake of the distance */
  size_t distant;                    /* places still further away than asked */
  bool rough;                        /* the solid is rougher than the size */
  double wall, cpu;                  /* at the start of the stage under way */
} run;

static void begin_stage(run *r) {
  r->wall = laves__wall_seconds();
  r->cpu = laves__cpu_seconds();
}

/* Adds the time since begin_stage() to the stage's line in the report. */
static void end_stage(run *r, const char *name) {
  laves_report *report = r->report;
  int i = 0;
  while (i < report->stage_count && strcmp(report->stages[i].name, name) != 0) i++;
  if (i == LAVES_STAGE_CAPACITY) return;
  if (i == report->stage_count) {
    report->stages[i].name = name;
    report->stages[i].wall_seconds = report->stages[i].cpu_seconds = 0;
    report->stage_count++;
  }
  report->stages[i].wall_seconds += laves__wall_seconds() - r->wall;
  report->stages[i].cpu_seconds += laves__cpu_seconds() - r->cpu;
}

static void warn(run *r, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void warn(run *r, const char *format, ...) {
  laves_report *report = r->report;
  if (report->warning_count == LAVES_WARNING_CAPACITY) return;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(report->warnings[report->warning_count++], sizeof report->warnings[0], format, arguments);
  va_end(arguments);
}

/* Where the lattice lies and how large it is. */
static laves_result choose_frame(run *r) {
  const laves__oracle *oracle = &r->domain->oracle;
  begin_stage(r);
  r->report->volume = laves__domain_volume(r->context, oracle);
  if (laves__is_cancelled(r->context)) return laves__fail_cancelled(r->error);
  r->frame.oracle = oracle;
  r->frame.centre = box3_centre(oracle->bounds);
  r->frame.rotation = laves__options_rotation(r->options, oracle);
  r->frame.size = laves__options_size(r->options, oracle, r->report->volume);
  end_stage(r, "background");
  if (r->frame.size > 0 && isfinite(r->frame.size)) return LAVES_OK;
  return laves__fail(r->error, LAVES_ERROR_INPUT, "no inside was found: the volume of the solid is %g", r->report->volume);
}

static bool has_target(const laves_options *o) { return o->tet_target > 0 || o->vertex_target > 0; }

/* What is wished where. A field that turns out to be the same everywhere is none. */
static laves_result choose_sizes(run *r) {
  const double base = r->frame.size;
  begin_stage(r);
  laves_result result = laves__size_create(r->context, r->domain, r->options, base, &r->sizes, r->error);
  if (result == LAVES_OK && laves__size_is_constant(r->sizes)) {
    r->frame.size = laves__size_ceiling(r->sizes);
    laves__size_free(r->sizes);
    r->sizes = NULL;
  } else if (result == LAVES_OK && r->options->method == LAVES_METHOD_STUFF) {
    result = laves__fail(r->error, LAVES_ERROR_OPTION,
                         "stuffing needs one size everywhere, but sizes that vary were asked for; leave one of the two away");
  } else if (result == LAVES_OK) {
    r->guarantee = NULL; /* what is proved is proved for one size */
    result = laves__wishes_make(r->context, r->sizes, base, &r->wishes, r->error);
    if (result == LAVES_OK && has_target(r->options)) {
      laves_expectation counts;
      result = laves__estimate_graded(r->context, r->options, &r->wishes, &r->frame, &counts, r->error);
    }
  }
  if (r->sizes) end_stage(r, "sizes");
  return result;
}

static laves_result make_graded_background(run *r) {
  laves__demand demand;
  laves__graph_free(&r->graph);
  laves__octree_free(&r->tree);
  if (!laves__wishes_demand(&r->wishes, &r->frame, &demand)) return laves__fail_memory(r->context, r->error);
  laves_result result = laves__graded_background(&r->frame, &demand, r->context, &r->tree, &r->graph, r->error);
  if (result == LAVES_OK) result = laves__size_status(r->sizes, r->error);
  if (result == LAVES_OK) result = laves__lattice_of_graph(r->context, &r->graph, &r->lattice, r->error);
  return result;
}

static laves_result make_background(run *r) {
  begin_stage(r);
  laves__lattice_free(&r->lattice);
  const laves_result result = r->sizes ? make_graded_background(r)
                                       : laves__lattice_create(r->context, laves__frame_bounds(&r->frame), &r->lattice, r->error);
  end_stage(r, "background");
  return result;
}

static laves_result classify(run *r) {
  begin_stage(r);
  const laves_result result = laves__classify(&r->frame, &r->lattice, r->error);
  end_stage(r, "classify");
  return result;
}

static laves_result snap(run *r) {
  begin_stage(r);
  laves__layer_free(&r->layer);
  memset(&r->counts, 0, sizeof r->counts);
  memset(&r->stuffed, 0, sizeof r->stuffed);
  const laves_result result = laves__snap(&r->frame, r->options->keep_thin, &r->lattice, &r->layer, &r->counts, r->error);
  end_stage(r, "snap");
  return result;
}

static laves_result stuff(run *r) {
  begin_stage(r);
  laves__layer_free(&r->layer);
  const laves_result result = laves__stuff(&r->frame, r->guarantee, &r->lattice, &r->layer, &r->stuffed, r->error);
  if (r->stuffed.left == 0) { /* they tell of a boundary that is gone, but for the places, which are as thin as before */
    r->counts.pinches = 0;
    r->counts.off_surface = 0;
  }
  r->counts.snapped = r->stuffed.left;
  r->counts.specks = r->stuffed.specks;
  end_stage(r, "stuff");
  return result;
}

/* The whole boundary by stuffing. */
static laves_result stuff_everything(run *r) {
  laves__zone_everything(&r->lattice);
  return stuff(r);
}

/* Shares of the solid's volume: below the first, snapping is not the way; beyond the others, no mesh is of use. (A site that
 * alone stands for a small part makes a piece as large as an edge.) */
static const double least_snapped = 0.5, least_filled = 0.25, most_filled = 2;

/* Volume of the mesh as it is now, over that of the solid. */
static double filled_share(const run *r) {
  const double size = r->frame.size;
  return laves__assemble_volume(&r->lattice, &r->layer) * size * size * size / r->report->volume;
}

/* Whether stuffing may take the place of snapping. */
static bool may_mend(const run *r) { return r->guarantee && r->options->method == LAVES_METHOD_AUTO; }

/* The boundary in the way that was asked for. Snapping needs walls of a size or so; where it loses too much of a thinner solid,
 * stuffing, which keeps every inner site, takes its place. */
static laves_result conform(run *r) {
  if (r->options->method == LAVES_METHOD_STUFF) return stuff_everything(r);
  const laves_result result = snap(r);
  return result == LAVES_OK && may_mend(r) && filled_share(r) < least_snapped ? stuff_everything(r) : result;
}

static laves_result nothing_resolved(const run *r) {
  return laves__fail(
      r->error, LAVES_ERROR_INPUT,
      "nothing of the solid is resolved at size %g (the box around it has a diagonal of %g); choose a smaller size",
      r->frame.size, box3_diagonal(r->domain->oracle.bounds));
}

static laves_result hardly_resolved(const run *r, double share) {
  return laves__fail(r->error, LAVES_ERROR_INPUT,
                     "a mesh of size %g would have %.2g times the volume of the solid, which is so thin or small; choose a "
                     "smaller size",
                     r->frame.size, share);
}

/* The next size to try for a count. Where sizes vary, counts jump as leaves are halved, all those of a sphere at once: later
 * steps are shorter, so that sizes near by are tried, and the last goes back to the best so far. */
typedef struct count_search {
  int step, steps;
  double best_size, best_factor;
} count_search;

static void correct_size(run *r, count_search *s, double factor) {
  enum { WHOLE_STEPS = 4 };
  if (s->step == 0 || fabs(log(factor)) < fabs(log(s->best_factor))) {
    s->best_factor = factor;
    s->best_size = r->frame.size;
  }
  if (r->sizes && s->step >= WHOLE_STEPS) factor = sqrt(factor);
  r->frame.size = r->sizes && s->step == s->steps - 1 ? s->best_size : r->frame.size * factor;
  s->step++;
}

/* Background to boundary; repeated with a corrected size when a count was asked for and missed. */
static laves_result make_boundary(run *r) {
  count_search search = {.steps = r->sizes ? 10 : 4};
  for (;;) {
    laves_result result = make_background(r);
    if (result == LAVES_OK) result = classify(r);
    if (result == LAVES_OK) result = conform(r);
    if (result != LAVES_OK) return result;
    int64_t vertices, tets;
    laves__assemble_estimate(&r->lattice, &r->layer, &vertices, &tets);
    r->counted = r->options->tet_target ? (double)tets : (double)vertices;
    const double factor =
        laves__options_correction(r->options, (int64_t)((double)tets * r->kept), (int64_t)((double)vertices * r->kept));
    if (tets == 0) return nothing_resolved(r);
    if (factor == 1 || search.step == search.steps) break;
    correct_size(r, &search, factor);
  }
  const double share = filled_share(r);
  return share < least_filled || share > most_filled ? hardly_resolved(r, share) : LAVES_OK;
}

/* Angles that are held while improving are this much, in degrees, inside the promised ones: rounding must not matter. */
static const double held_slack = 0.005;
/* Where more than this share of the layer breaks the promise, small repairs are not tried. */
static const double crowded = 0.001;
/* Where snapping leaves more than this share, and this many, of the tets outside a window of 25 to 140 degrees, the solid is
 * rougher than the size, and improvement would be long and in vain (models: at most 0.7 %, or a few; noise: 1.4 % and more). */
static const laves__window rough_window = {.min_dihedral = 25, .max_dihedral = 140};
static const double rough_share = 0.012;
static const size_t rough_count = 250;

/* Improvement aims a little inside the asked window, so that the last digits of its iterations do not matter. */
static laves_result improve(run *r) {
  if (!r->options->improve) return LAVES_OK;
  begin_stage(r);
  const bool held = r->guarantee && laves__count_broken(r->guarantee, &r->layer) == 0;
  const laves__window aim = {.min_dihedral = r->options->min_dihedral + 1.5,
                             .max_dihedral = fmin(r->options->max_dihedral - 3, 179),
                             .volume_length = r->options->volume_length > 0 ? r->options->volume_length + 0.05 : 0,
                             .held_min = held ? r->guarantee->min_dihedral + held_slack : 0,
                             .held_max = held ? r->guarantee->max_dihedral - held_slack : 180,
                             .brief = r->rough};
  const laves_result result = laves__improve(&r->frame, &aim, &r->layer, r->error);
  end_stage(r, "improve");
  return result;
}

/* Whether so much is bad after snapping that all is better made by stuffing at once. */
static bool is_rough(const run *r) {
  const size_t bad = laves__improve_outside(&rough_window, &r->layer);
  return bad > rough_count && (double)bad > rough_share * (double)r->layer.tet_count;
}

/* Where the promised window is broken, the boundary is made anew by stuffing: around the place, in a wider neighbourhood, in
 * the end in all that hangs together with it, where the window is proved. */
static laves_result mend_promise(run *r) {
  enum { REACHES = 2 };
  static const int reach[REACHES] = {1, 3}; /* cells */
  for (int round = 0; round <= REACHES; round++) {
    const size_t broken = laves__count_broken(r->guarantee, &r->layer);
    if (broken == 0) return LAVES_OK;
    const bool crowd = (double)broken > crowded * (double)r->layer.tet_count;
    laves__zone_around(r->guarantee, &r->layer, &r->lattice, reach[round < REACHES ? round : REACHES - 1]);
    if ((crowd || round == REACHES) && !laves__zone_components(&r->lattice)) return laves__fail_memory(r->context, r->error);
    laves_result result = stuff(r);
    if (result == LAVES_OK) result = improve(r);
    if (result != LAVES_OK) return result;
  }
  return LAVES_OK;
}

/* The layer improved, and inside the promised window. */
static laves_result improve_and_keep_promise(run *r) {
  laves_result result = LAVES_OK;
  r->rough = may_mend(r) && is_rough(r);
  if (r->rough) result = stuff_everything(r);
  if (result == LAVES_OK) result = improve(r);
  if (result == LAVES_OK && may_mend(r) && filled_share(r) == 0) { /* flat tets only, all peeled off */
    result = stuff_everything(r);
    if (result == LAVES_OK) result = improve(r);
  }
  if (result == LAVES_OK && may_mend(r)) result = mend_promise(r);
  return result;
}

static laves_result name_groups(const run *r, laves_mesh *mesh) {
  if (!laves__mesh_add_group(mesh, 3, 1, "solid")) return laves__fail_memory(r->context, r->error);
  const int tags = mesh->face_tags ? r->domain->info.tag_count : 0;
  if (tags == 0 && !laves__mesh_add_group(mesh, 2, 1, "boundary")) return laves__fail_memory(r->context, r->error);
  for (int i = 0; i < tags; i++)
    if (!laves__mesh_add_group(mesh, 2, i + 1, r->domain->tag_names[i])) return laves__fail_memory(r->context, r->error);
  return LAVES_OK;
}

static laves_result make_mesh(run *r, laves_mesh **mesh) {
  begin_stage(r);
  laves_result result = laves__assemble(&r->frame, &r->lattice, &r->layer, mesh, r->error);
  if (result == LAVES_OK && (*mesh)->tet_count == 0) result = nothing_resolved(r); /* slivers, all contracted away */
  if (result == LAVES_OK) result = name_groups(r, *mesh);
  end_stage(r, "mesh");
  return result;
}

/* Where sizes vary improvement may cost some per cent of a count that was asked for; then all is made again, once, for a count
 * that is larger by as much. */
static laves_result count_again(run *r, laves_mesh **mesh, bool *again) {
  static const double tolerance = 0.02;
  const laves_options *o = r->options;
  const double wished = o->tet_target ? (double)o->tet_target : (double)o->vertex_target;
  const double got = o->tet_target ? (double)(*mesh)->tet_count : (double)(*mesh)->vertex_count;
  *again = r->sizes && has_target(o) && !r->recounted && fabs(got / wished - 1) > tolerance;
  if (!*again) return LAVES_OK;
  r->recounted = true;
  r->kept = got / r->counted;
  laves_mesh_free(*mesh);
  *mesh = NULL;
  return LAVES_OK;
}

/* Where the boundary is further from the surface than asked, smaller sizes are wished; then all is made again. *again: it must
 * be. */
static laves_result refine_where_distant(run *r, laves_mesh **mesh, bool *again) {
  enum { ROUNDS = 5, PLACES = 4096 };
  const double wished = r->options->max_distance;
  *again = false;
  r->distant = 0;
  if (!(wished > 0)) return LAVES_OK;
  laves_place *place = laves__alloc(r->context, PLACES, sizeof *place);
  if (!place) return laves__fail_memory(r->context, r->error);
  begin_stage(r);
  laves_result result = laves_check_distance(r->context, *mesh, r->domain, wished, place, PLACES, &r->distant, r->error);
  const size_t known = r->distant < PLACES ? r->distant : PLACES;
  if (result == LAVES_OK && r->round++ < ROUNDS && !laves__wishes_approach(&r->wishes, &r->tree, wished, place, known, again))
    result = laves__fail_memory(r->context, r->error);
  end_stage(r, "distance");
  laves__free(r->context, place, PLACES, sizeof *place);
  if (*again && result == LAVES_OK) {
    laves_mesh_free(*mesh);
    *mesh = NULL;
  }
  return result;
}

/* What became of thin parts. Where a place is known the sentence about pinches names the first. */
static laves_result judge_thin(run *r, const laves_mesh *mesh) {
  laves_report *report = r->report;
  char text[sizeof report->warnings[0]];
  report->lost_count = r->counts.lost_count;
  memcpy(report->lost, r->counts.lost, sizeof report->lost);
  if (report->pinches) {
    const laves_thin_place *p = &report->lost[0];
    char place[80] = "";
    if (report->lost_count) snprintf(place, sizeof place, ", as at (%.6g, %.6g, %.6g)", p->place[0], p->place[1], p->place[2]);
    warn(r,
         "at %zu places the solid is thinner than the size, or its parts closer; walls were trimmed or parts set apart there%s",
         report->pinches, place);
  }
  if (r->counts.specks)
    warn(r, "%zu parts of a few tetrahedra, beyond places thinner than the size, were dropped", r->counts.specks);
  begin_stage(r);
  const laves_result result = laves__find_losses(&r->frame, r->domain, mesh, report, text, sizeof text, r->error);
  if (text[0]) { /* else it took no time */
    end_stage(r, "topology");
    warn(r, "%s", text);
  }
  return result;
}

/* The last word on targets: what was asked and is not there. */
static laves_result judge(run *r, const laves_mesh *mesh) {
  const laves_options *o = r->options;
  laves_report *report = r->report;
  report->size = r->frame.size;
  report->lattice_tets = mesh->lattice_tet_count;
  report->snapped_vertices = r->counts.snapped;
  report->pinches = r->counts.pinches + r->stuffed.unsnapped;
  const bool promised = r->guarantee && o->guarantee > 0; /* stuffing needs thresholds, promised or not */
  report->promised_min_dihedral = promised ? r->guarantee->min_dihedral : 0;
  report->promised_max_dihedral = promised ? r->guarantee->max_dihedral : 180;
  report->stuffed_vertices = r->stuffed.vertices;
  report->relaxed_vertices = r->stuffed.relaxed;
  report->relaxed_max = r->stuffed.relaxed_max * r->frame.size;
  report->off_surface = 0;
  for (size_t v = 0; v < r->layer.vertex_count; v++) report->off_surface += r->layer.off_surface[v] && r->layer.star[v].count > 0;
  report->outside_window = laves__improve_outside(
      &(laves__window){.min_dihedral = o->min_dihedral, .max_dihedral = o->max_dihedral, .volume_length = o->volume_length},
      &r->layer);
  report->peak_bytes = laves_context_peak_bytes(r->context);
  const laves_result known = judge_thin(r, mesh);
  if (known != LAVES_OK) return known;
  if (report->off_surface)
    warn(r, "%zu boundary vertices stand off the surface, where it is too sharp or thin for the size%s", report->off_surface,
         report->relaxed_vertices ? ", or where the guarantee moved them" : "");
  if (report->outside_window)
    warn(r, "%zu tetrahedra are outside the asked window of %g to %g degrees and volume-length %g", report->outside_window,
         o->min_dihedral, o->max_dihedral, o->volume_length);
  const size_t broken = r->guarantee ? laves__count_broken(r->guarantee, &r->layer) : 0;
  if (broken)
    warn(r, "%zu tetrahedra are outside the promised window of %g to %g degrees, which should not happen; please report it",
         broken, report->promised_min_dihedral, report->promised_max_dihedral);
  if (r->distant)
    warn(r, "at %zu places mesh and surface are further apart than the %g asked for; a smaller min_size may help", r->distant,
         o->max_distance);
  const double wished = o->tet_target ? (double)o->tet_target : (double)o->vertex_target;
  const double got = o->tet_target ? (double)mesh->tet_count : (double)mesh->vertex_count;
  if (wished > 0 && fabs(got / wished - 1) > 0.03) {
    warn(r, "%.0f %s were asked for and %.0f made: the count can't be met within 3 %%", wished,
         o->tet_target ? "tetrahedra" : "vertices", got);
    return LAVES_TARGET_MISSED;
  }
  return r->distant ? LAVES_TARGET_MISSED : LAVES_OK;
}

laves_result laves_generate(laves_context *context, const laves_domain *domain, const laves_options *options, laves_mesh **mesh,
                            laves_report *report, laves_error *error) {
  laves_report own_report;
  run r = {.context = context,
           .domain = domain,
           .options = options,
           .report = report ? report : &own_report,
           .error = error,
           .kept = 1};
  memset(r.report, 0, sizeof *r.report);
  *mesh = NULL;
  laves__progress_reset(context);

  laves_result result = laves__options_check(options, error);
  if (result == LAVES_OK) result = choose_frame(&r);
  if (result == LAVES_OK) r.guarantee = laves__options_guarantee(options);
  if (result == LAVES_OK) result = choose_sizes(&r);
  for (bool again = true; again && result == LAVES_OK;) {
    result = make_boundary(&r);
    if (result == LAVES_OK) result = improve_and_keep_promise(&r);
    if (result == LAVES_OK) result = make_mesh(&r, mesh);
    if (result == LAVES_OK) result = refine_where_distant(&r, mesh, &again);
    if (result == LAVES_OK && !again) result = count_again(&r, mesh, &again);
  }
  if (result == LAVES_OK) result = judge(&r, *mesh);

  if (result != LAVES_OK && result != LAVES_TARGET_MISSED) {
    laves_mesh_free(*mesh);
    *mesh = NULL;
  }
  laves__layer_free(&r.layer);
  laves__lattice_free(&r.lattice);
  laves__graph_free(&r.graph);
  laves__octree_free(&r.tree);
  laves__wishes_free(&r.wishes);
  laves__size_free(r.sizes);
  return result;
}
