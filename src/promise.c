/* The boundary layer held to features, improved, and inside the promised window.
 *
 *     features -> improve -> (let go of features that cost too much -> improve)
 *     and where the promise is broken: stuff around the place -> features beyond it -> improve, in growing zones */
#include <string.h>

#include "improve/release.h"
#include "mesh/components.h"
#include "run.h"
#include "stuff/zone.h"

/* The smallest size at the boundary. */
double laves__least_size(const laves__run *r) {
  double least = 1;
  for (size_t v = 0; v < r->layer.vertex_count; v++)
    if (r->layer.depth[v] == 0) least = fmin(least, laves__layer_scale(&r->layer, (int32_t)v));
  return least * r->frame.size;
}

/* What is sharp, or drawn. */
static laves_result find_features(laves__run *r) {
  const laves_options *o = r->options;
  const laves__feature_wish wish = {
      .angle = o->feature_angle, .tags = o->feature_tags, .drawn = o->features, .size = laves__least_size(r)};
  laves__stage_begin(r);
  laves__features_free(&r->features);
  const laves_result result = laves__features_find(r->context, &r->domain->oracle, &wish, &r->features, r->error);
  r->frame.features = r->features.crease_count || r->features.corner_count ? &r->features : NULL;
  if (r->frame.features) laves__stage_end(r, "features");
  return result;
}

/* Boundary vertices are held to features, but for those where tets were cut. */
static laves_result hold_features(laves__run *r) {
  bool *in_zone = NULL;
  const size_t vertices = r->layer.vertex_count;
  laves__stage_begin(r);
  if (r->stuffed.vertices > 0) {
    in_zone = laves__alloc(r->context, vertices, sizeof *in_zone);
    if (!in_zone) return laves__fail_memory(r->context, r->error);
    laves__zone_vertices(&r->lattice, &r->layer, in_zone);
  }
  const laves_result result =
      laves__keep_features(&r->frame, in_zone, !r->options->improve, &r->layer, &r->kept_features, r->error);
  laves__free(r->context, in_zone, vertices, sizeof *in_zone);
  laves__stage_end(r, "features");
  return result;
}

/* Where more than this share of the layer is far outside once features are held, and no few tets, nearly all of the solid is
 * thinner than the size (models: at most 0.1; sheets a small part of the size: 0.8). */
static const laves__window feature_window = {.min_dihedral = 25, .max_dihedral = 140};
static const double noise_share = 0.3;
static const size_t noise_count = 1000;

static bool is_noise(const laves__run *r) {
  const size_t bad = laves__improve_outside(&feature_window, &r->layer);
  return bad > noise_count && (double)bad > noise_share * (double)r->layer.tet_count;
}

laves_result laves__hold_boundary(laves__run *r) {
  r->released = 0;
  r->frame.features = NULL;
  if (r->stuffed.vertices > 0) return LAVES_OK; /* all is cut: by wish, or since the solid is too thin to be snapped */
  laves_result result = find_features(r);
  if (result == LAVES_OK && r->rough && !r->frame.features) return laves__stuff_everything(r);
  if (result != LAVES_OK || !r->frame.features) return result;
  r->rough = false; /* features make it so */
  result = hold_features(r);
  if (result != LAVES_OK || !laves__may_mend(r) || !is_noise(r)) return result;
  result = laves__stuff_everything(r); /* improvement would be long, and come to this in the end */
  return result == LAVES_OK ? hold_features(r) : result;
}

/* Angles that are held while improving are this much, in degrees, inside the promised ones: rounding must not matter. */
static const double held_slack = 0.005;
/* Where more than this share of the layer breaks the promise, small repairs are not tried. */
static const double crowded = 0.001;

/* What improvement is for. */
typedef enum purpose {
  ALL_OF_IT, /* the first time */
  AGAIN,     /* after features were let go of */
  RESCUE,    /* only what is outside the promised window */
} purpose;

/* Improvement aims a little inside the asked window, so that the last digits of its iterations do not matter. */
static laves_result improve(laves__run *r, purpose why) {
  if (!r->options->improve) return LAVES_OK;
  laves__stage_begin(r);
  const bool rescues = why == RESCUE && r->guarantee;
  const bool held = r->guarantee && laves__count_broken(r->guarantee, &r->layer, NULL) == 0;
  const laves__window aim = {.min_dihedral = r->options->min_dihedral + 1.5,
                             .max_dihedral = fmin(r->options->max_dihedral - 3, 179),
                             .volume_length = r->options->volume_length > 0 ? r->options->volume_length + 0.05 : 0,
                             .held_min = held ? r->guarantee->min_dihedral + held_slack : 0,
                             .held_max = held ? r->guarantee->max_dihedral - held_slack : 180,
                             .again = why == AGAIN,
                             .rescue_min = rescues ? r->guarantee->min_dihedral : 0,
                             .rescue_max = rescues ? r->guarantee->max_dihedral : 180,
                             .brief = r->rough};
  const laves_result result =
      laves__is_cancelled(r->context) ? laves__fail_cancelled(r->error) : laves__improve(&r->frame, &aim, &r->layer, r->error);
  laves__stage_end(r, "improve");
  return result;
}

/* Where features come closer than the size allows, angles go before them: step by step vertices are let go of, and improved
 * again, until all is inside a wide window. */
static laves_result release_features(laves__run *r) {
  laves_result result = LAVES_OK;
  for (int what = LAVES__RELEASE_OFF; what < LAVES__RELEASES && result == LAVES_OK && r->options->improve; what++) {
    const size_t released = laves__release_features(&r->frame, &feature_window, what, &r->layer);
    if (laves__is_cancelled(r->context)) return laves__fail_cancelled(r->error);
    r->released += released;
    if (released > 0) result = improve(r, AGAIN);
  }
  return result;
}

static laves_result improve_layer(laves__run *r) {
  const laves_result result = improve(r, ALL_OF_IT);
  return result == LAVES_OK && r->frame.features ? release_features(r) : result;
}

/* Tets whose angles the input fixes below what is promised; they are listed anew when asked for. */
static laves_result find_forced(laves__run *r) {
  laves_context *context = r->context;
  laves__free(context, r->forced, r->forced_count, sizeof *r->forced);
  r->forced = NULL;
  bool sharp = false;
  for (size_t i = 0; r->layer.hold && i < r->features.crease_count; i++)
    sharp |= r->features.crease[i].least_angle < r->guarantee->min_dihedral;
  if (!sharp) return LAVES_OK;
  r->forced_count = r->layer.tet_count;
  r->forced = laves__alloc(context, r->forced_count, sizeof *r->forced);
  if (!r->forced) return laves__fail_memory(context, r->error);
  laves__mark_forced(&r->frame, r->guarantee->min_dihedral, &r->layer, r->forced);
  return LAVES_OK;
}

/* Only what is outside the promised window is improved, and features are let go of only there. */
static laves_result rescue(laves__run *r) {
  const laves__window promised = {.min_dihedral = r->guarantee->min_dihedral, .max_dihedral = r->guarantee->max_dihedral};
  laves_result result = improve(r, RESCUE);
  for (int what = LAVES__RELEASE_OFF; what < LAVES__RELEASES && result == LAVES_OK && r->frame.features; what++) {
    const size_t released = laves__release_features(&r->frame, &promised, what, &r->layer);
    if (laves__is_cancelled(r->context)) return laves__fail_cancelled(r->error);
    r->released += released;
    if (released > 0) result = improve(r, RESCUE);
  }
  return result;
}

/* Tets that break the promise. */
static size_t count_broken(const laves__run *r) { return laves__count_broken(r->guarantee, &r->layer, r->forced); }

/* Adds to the zone that is stuffed: what is around the broken tets; in later rounds a wider neighbourhood, then all of the layer
 * that hangs together with them, in the end all of the solid that does, where the window is proved. */
static bool widen_zone(laves__run *r, const laves__components *now, int round) {
  enum { WALLS = 2, ALL = 6 }; /* the first rounds of those kinds */
  const bool crowd = (double)count_broken(r) > crowded * (double)r->layer.tet_count;
  if (round >= WALLS) {
    bool *broken_wall = laves__alloc(r->context, now->count, sizeof *broken_wall);
    if (!broken_wall) return false;
    laves__find_broken_walls(r->guarantee, &r->layer, r->forced, now, broken_wall);
    laves__zone_walls(&r->layer, now, broken_wall, &r->lattice);
    laves__free(r->context, broken_wall, now->count, sizeof *broken_wall);
  }
  laves__zone_around(r->guarantee, &r->layer, r->forced, round == 0 ? 1 : 3, &r->lattice);
  return !(crowd || round >= ALL) || laves__zone_components(&r->lattice);
}

/* What is mended: the layer as it was improved last, its components before that, and those of what takes its place. */
typedef struct mending {
  laves__layer improved;
  laves__components *before, now;
  bool *again; /* [before->count] components that do not come back as they are */
  laves__twins twins;
  bool complete; /* what was made anew is improved as far as it can be */
} mending;

/* The boundary made anew by stuffing in the lattice's zone, held to features, without the components that come back. */
static laves_result make_zone(laves__run *r, mending *m) {
  laves__layer_free(&r->layer);
  laves__components_free(&m->now);
  laves__twins_free(&m->twins);
  laves_result result = laves__stuff_zone(r);
  if (result == LAVES_OK && r->frame.features) result = hold_features(r);
  if (result != LAVES_OK) return result;
  if (!laves__components_find(&r->layer, &m->now) || !laves__twins_find(&m->improved, m->before, &m->now, m->again, &m->twins))
    return laves__fail_memory(r->context, r->error);
  laves__twins_set_aside(&m->twins, &r->layer);
  return LAVES_OK;
}

/* What was made anew and improved is what comes back in the next round. */
static laves_result start_from_here(laves__run *r, mending *m) {
  bool *again = laves__alloc(r->context, m->now.count, sizeof *again);
  if (again) laves__find_broken_walls(r->guarantee, &r->layer, r->forced, &m->now, again);
  const bool memory = again && laves__twins_bring_back(&m->twins, &r->layer);
  laves__twins_free(&m->twins);
  laves__free(r->context, m->again, m->before->count, sizeof *m->again);
  m->again = again;
  laves__layer_free(&m->improved);
  laves__components_free(m->before);
  m->improved = r->layer;
  *m->before = m->now;
  memset(&r->layer, 0, sizeof r->layer);
  memset(&m->now, 0, sizeof m->now);
  return memory ? LAVES_OK : laves__fail_memory(r->context, r->error);
}

/* Where more than this share of what was made anew breaks the promise before it is improved, only all of improvement helps. */
static const double dense_share = 0.003;

/* One round: what was made anew, improved; *broken: how many tets break the promise then. */
static laves_result improve_zone(laves__run *r, mending *m, size_t *broken) {
  m->complete =
      m->complete || (double)laves__count_broken(r->guarantee, &r->layer, NULL) > dense_share * (double)m->now.vertex_count;
  laves_result result = m->complete ? improve_layer(r) : rescue(r);
  if (result == LAVES_OK) result = find_forced(r);
  if (result != LAVES_OK) return result;
  *broken = count_broken(r);
  if (*broken > 0 || m->complete) return LAVES_OK;
  m->complete = true;
  result = improve_layer(r);
  if (result == LAVES_OK) result = find_forced(r);
  if (result == LAVES_OK) *broken = count_broken(r);
  return result;
}

/* Stuffing in a growing zone, until no tet breaks the promise or nothing more can be stuffed. Where few do, only those are
 * improved meanwhile: it is the zone that is looked for, and to improve all of it in each round would take long. */
static laves_result find_zone(laves__run *r, mending *m) {
  enum { ROUNDS = 8 };
  for (int round = 0; round < ROUNDS; round++) {
    size_t broken = 0;
    laves_result result = make_zone(r, m);
    if (result == LAVES_OK) result = improve_zone(r, m, &broken);
    if (result == LAVES_OK && laves__is_cancelled(r->context)) result = laves__fail_cancelled(r->error);
    if (result != LAVES_OK || broken == 0) return result;
    if (!widen_zone(r, &m->now, round + 1)) return laves__fail_memory(r->context, r->error);
    if (m->complete && round + 1 < ROUNDS) result = start_from_here(r, m);
    if (result != LAVES_OK) return result;
  }
  return m->complete ? LAVES_OK : improve_layer(r);
}

/* Mends the promise. */
static laves_result mend(laves__run *r, mending *m) {
  m->again = laves__alloc(r->context, m->before->count, sizeof *m->again);
  if (!m->again) return laves__fail_memory(r->context, r->error);
  laves__find_broken_walls(r->guarantee, &r->layer, r->forced, m->before, m->again);
  if (!widen_zone(r, m->before, 0)) return laves__fail_memory(r->context, r->error);
  m->improved = r->layer;
  memset(&r->layer, 0, sizeof r->layer);
  laves_result result = find_zone(r, m);
  if (result == LAVES_OK && !laves__twins_bring_back(&m->twins, &r->layer)) result = laves__fail_memory(r->context, r->error);
  return result;
}

/* Where the promised window is broken, but for what the input forces. `before`: the components of the layer before it was
 * improved. */
static laves_result mend_promise(laves__run *r, laves__components *before) {
  laves_result result = find_forced(r);
  if (result == LAVES_OK && count_broken(r) > 0) {
    mending m = {.before = before};
    result = laves__is_cancelled(r->context) ? laves__fail_cancelled(r->error) : mend(r, &m);
    laves__twins_free(&m.twins);
    laves__components_free(&m.now);
    laves__layer_free(&m.improved);
    laves__free(r->context, m.again, before->count, sizeof *m.again);
    if (result == LAVES_OK) result = find_forced(r);
  }
  if (result == LAVES_OK && r->forced) r->report->forced_tets = laves__count_broken(r->guarantee, &r->layer, NULL);
  return result == LAVES_OK && laves__is_cancelled(r->context) ? laves__fail_cancelled(r->error) : result;
}

/* The layer improved, and inside the promised window. */
laves_result laves__improve_boundary(laves__run *r) {
  laves__components before = {0};
  bool memory = !laves__may_mend(r) || laves__components_find(&r->layer, &before);
  laves_result result = memory ? improve_layer(r) : laves__fail_memory(r->context, r->error);
  if (result == LAVES_OK && laves__may_mend(r) && laves__filled_share(r) == 0) { /* flat tets only, all peeled off */
    result = laves__stuff_everything(r);
    laves__components_free(&before);
    if (result == LAVES_OK) memory = laves__components_find(&r->layer, &before);
    if (result == LAVES_OK) result = memory ? improve_layer(r) : laves__fail_memory(r->context, r->error);
  }
  if (result == LAVES_OK && laves__may_mend(r)) result = mend_promise(r, &before);
  laves__components_free(&before);
  return result;
}
