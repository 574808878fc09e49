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

/* Improvement aims a little inside the asked window, so that the last digits of its iterations do not matter. */
static laves_result improve(laves__run *r, bool again) {
  if (!r->options->improve) return LAVES_OK;
  laves__stage_begin(r);
  const bool held = r->guarantee && laves__count_broken(r->guarantee, &r->layer, NULL) == 0;
  const laves__window aim = {.min_dihedral = r->options->min_dihedral + 1.5,
                             .max_dihedral = fmin(r->options->max_dihedral - 3, 179),
                             .volume_length = r->options->volume_length > 0 ? r->options->volume_length + 0.05 : 0,
                             .held_min = held ? r->guarantee->min_dihedral + held_slack : 0,
                             .held_max = held ? r->guarantee->max_dihedral - held_slack : 180,
                             .again = again,
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
    if (released > 0) result = improve(r, true);
  }
  return result;
}

static laves_result improve_layer(laves__run *r) {
  const laves_result result = improve(r, false);
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

/* Improves a layer that was made anew: only those components that are not as they were before, or were broken. `improved`: what
 * was made of the layer whose components were `before`. */
static laves_result improve_changed(laves__run *r, const laves__layer *improved, const laves__components *before,
                                    const laves__components *now, const bool *broken) {
  laves__twins twins;
  laves_result result = LAVES_OK;
  if (!laves__twins_find(improved, before, now, broken, &twins)) {
    result = laves__fail_memory(r->context, r->error);
  } else {
    laves__twins_set_aside(&twins, &r->layer);
    result = improve_layer(r);
    if (result == LAVES_OK && !laves__twins_bring_back(&twins, &r->layer)) result = laves__fail_memory(r->context, r->error);
  }
  laves__twins_free(&twins);
  return result;
}

/* The boundary made anew by stuffing in the lattice's zone, held to features and improved. */
static laves_result mend_zone(laves__run *r, laves__components *before, const bool *broken) {
  laves__layer improved = r->layer;
  laves__components now = {0};
  memset(&r->layer, 0, sizeof r->layer);
  laves_result result = laves__stuff_zone(r);
  if (result == LAVES_OK && r->frame.features) result = hold_features(r);
  if (result == LAVES_OK && !laves__components_find(&r->layer, &now)) result = laves__fail_memory(r->context, r->error);
  if (result == LAVES_OK) result = improve_changed(r, &improved, before, &now, broken);
  laves__layer_free(&improved);
  laves__components_free(before);
  *before = now;
  return result;
}

/* Where the promised window is broken, the boundary is made anew by stuffing: around the place, in a wider neighbourhood, in
 * all of the layer that hangs together with it, in the end in all of the solid that does, where the window is proved. `before`:
 * the components of the layer before it was improved. */
static laves_result mend_promise(laves__run *r, laves__components *before) {
  enum { WALLS = 2, ALL = 6, ROUNDS }; /* the first rounds of those kinds */
  for (int round = 0; round < ROUNDS; round++) {
    laves_result result = find_forced(r);
    if (result != LAVES_OK) return result;
    const size_t broken = laves__count_broken(r->guarantee, &r->layer, r->forced);
    if (laves__is_cancelled(r->context)) return laves__fail_cancelled(r->error);
    if (broken == 0) {
      r->report->forced_tets = r->forced ? laves__count_broken(r->guarantee, &r->layer, NULL) : 0;
      return LAVES_OK;
    }
    const bool crowd = (double)broken > crowded * (double)r->layer.tet_count;
    const size_t walls = before->count;
    bool *broken_wall = laves__alloc(r->context, walls, sizeof *broken_wall);
    bool memory = broken_wall != NULL;
    if (memory) laves__find_broken_walls(r->guarantee, &r->layer, r->forced, before, broken_wall);
    if (memory && round >= WALLS) laves__zone_walls(&r->layer, before, broken_wall, &r->lattice);
    laves__zone_around(r->guarantee, &r->layer, r->forced, round == 0 ? 1 : 3, &r->lattice);
    if (crowd || round == ALL) memory = memory && laves__zone_components(&r->lattice);
    result = memory ? mend_zone(r, before, broken_wall) : laves__fail_memory(r->context, r->error);
    laves__free(r->context, broken_wall, walls, sizeof *broken_wall);
    if (result != LAVES_OK) return result;
  }
  return LAVES_OK;
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
