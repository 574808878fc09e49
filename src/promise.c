/* The boundary layer held to features, improved, and inside the promised window.
 *
 *     features -> improve -> (let go of features that cost too much -> improve)
 *     and where the promise is broken: stuff around the place -> features beyond it -> graft -> improve, in growing zones */
#include "improve/release.h"
#include "mesh/components.h"
#include "run.h"
#include "stuff/graft.h"
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

/* Boundary vertices are held to features, but for those where tets were cut, and so many cells around. */
static laves_result hold_features(laves__run *r, int cells) {
  laves_result result = LAVES_OK;
  bool *in_zone = NULL;
  const size_t vertices = r->layer.vertex_count;
  laves__stage_begin(r);
  if (r->stuffed.vertices > 0) {
    in_zone = laves__alloc(r->context, vertices, sizeof *in_zone);
    if (!in_zone || !laves__zone_vertices(&r->lattice, &r->layer, cells, in_zone))
      result = laves__fail_memory(r->context, r->error);
  }
  if (result == LAVES_OK)
    result = laves__keep_features(&r->frame, in_zone, !r->options->improve, &r->layer, &r->kept_features, r->error);
  laves__free(r->context, in_zone, vertices, sizeof *in_zone);
  laves__stage_end(r, "features");
  return result;
}

/* Where more than this share of the layer is far outside once features are held, and no few tets, nearly all of the solid is
 * thinner than the size (models: at most 0.1; sheets a small part of the size: 0.8). */
static const laves__window feature_window = {.min_dihedral = 25, .max_dihedral = 140};
static const double noise_share = 0.3;
static const size_t noise_count = 1000;

/* Whether more of the layer than a share and a number is outside the wide window. */
static bool is_rougher(const laves__run *r, double share, size_t least) {
  const size_t bad = laves__improve_outside(&feature_window, &r->layer);
  return bad > least && (double)bad > share * (double)r->layer.tet_count;
}

laves_result laves__hold_boundary(laves__run *r) {
  r->released = 0;
  r->noise = false;
  r->frame.features = NULL;
  if (r->stuffed.vertices > 0) return LAVES_OK; /* all is cut: by wish, or since the solid is too thin to be snapped */
  laves_result result = find_features(r);
  if (result == LAVES_OK && r->rough && !r->frame.features) return laves__stuff_everything(r);
  if (result != LAVES_OK || !r->frame.features) return result;
  r->rough = false; /* features make it so */
  result = hold_features(r, 0);
  if (result != LAVES_OK || !laves__may_mend(r) || !is_rougher(r, noise_share, noise_count)) return result;
  result = laves__stuff_everything(r); /* improvement would be long, and come to this in the end */
  return result == LAVES_OK ? hold_features(r, 0) : result;
}

/* Angles that are held while improving are this much, in degrees, inside the promised ones: rounding must not matter. */
static const double held_slack = 0.005;
/* Where more than this share of the layer breaks the promise, small repairs are not tried. */
static const double crowded = 0.001;

/* Improvement aims a little inside the asked window, so that the last digits of its iterations do not matter. */
static laves_result improve(laves__run *r, laves__improve_when when) {
  if (!r->options->improve) return LAVES_OK;
  laves__stage_begin(r);
  const bool held = r->guarantee && !laves__is_broken(r->guarantee, &r->layer);
  const laves__window aim = {.min_dihedral = r->options->min_dihedral + 1.5,
                             .max_dihedral = fmin(r->options->max_dihedral - 3, 179),
                             .volume_length = r->options->volume_length > 0 ? r->options->volume_length + 0.05 : 0,
                             .held_min = held ? r->guarantee->min_dihedral + held_slack : 0,
                             .held_max = held ? r->guarantee->max_dihedral - held_slack : 180,
                             .when = when,
                             .noise = r->noise,
                             .brief = r->rough};
  const laves_result result =
      laves__is_cancelled(r->context) ? laves__fail_cancelled(r->error) : laves__improve(&r->frame, &aim, &r->layer, r->error);
  laves__stage_end(r, "improve");
  return result;
}

/* Where more than this share of the layer is outside that window after improvement, and no few tets, features are the noise of a
 * surface rougher than the size, or crowd too much. */
static const double unkept_share = 0.01;
static const size_t unkept_count = 100;

/* Where features come closer than the size allows, angles go before them: step by step vertices are let go of, and improved
 * again, until all is inside a wide window. Of noise all that is near goes at once, since each step takes long there. Once no
 * more are let go of, the few that are left well outside the asked window get room. */
static laves_result release_features(laves__run *r) {
  laves_result result = LAVES_OK;
  if (!r->options->improve) return LAVES_OK;
  const size_t before = r->released;
  r->noise = r->noise || is_rougher(r, unkept_share, unkept_count);
  for (int what = r->noise ? LAVES__RELEASE_AROUND : LAVES__RELEASE_OFF; what < LAVES__RELEASES && result == LAVES_OK; what++) {
    const size_t released = laves__release_features(&r->frame, &feature_window, what, &r->layer);
    if (laves__is_cancelled(r->context)) return laves__fail_cancelled(r->error);
    r->released += released;
    if (released > 0) result = improve(r, LAVES__IMPROVE_RELEASED);
  }
  return result == LAVES_OK && r->released > before ? improve(r, LAVES__IMPROVE_LAST) : result;
}

static laves_result improve_layer(laves__run *r) {
  const laves_result result = improve(r, LAVES__IMPROVE_FIRST);
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

/* Tets that break the promise. */
static size_t count_broken(const laves__run *r) { return laves__count_broken(r->guarantee, &r->layer, r->forced); }

/* The walls in which the promise is broken, whole; false when memory is short. */
static bool zone_broken_walls(laves__run *r) {
  laves__components walls;
  bool memory = laves__components_find(&r->layer, &walls);
  bool *broken = memory ? laves__alloc(r->context, walls.count, sizeof *broken) : NULL;
  memory = broken != NULL;
  if (memory) {
    laves__find_broken_walls(r->guarantee, &r->layer, r->forced, &walls, broken);
    laves__zone_walls(&r->layer, &walls, broken, &r->lattice);
  }
  laves__free(r->context, broken, walls.count, sizeof *broken);
  laves__components_free(&walls);
  return memory;
}

/* All of the solid that hangs together with the zone is made anew; false when memory is short. */
static bool zone_everything_near(laves__run *r, laves__known_lattice *known) {
  if (!laves__zone_components(&r->lattice)) return false;
  for (size_t i = 0; i < r->lattice.record_count; i++)
    if (r->lattice.record[i].zone) laves__known_forget(known, i);
  return true;
}

/* Adds to the zone that is stuffed: what is around the broken tets; in later rounds a wider neighbourhood, then all of the layer
 * that hangs together with them, in the end all of the solid that does, where the window is proved. Nearly always two rounds do,
 * and each may cost as much as the first improvement; so these come soon where they cost no creases. What must be made anew is
 * what differs from `known`. False when memory is short. */
static bool widen_zone(laves__run *r, int round, size_t broken, laves__known_lattice *known) {
  const int walls = r->frame.features ? 5 : 2, all = r->frame.features ? 9 : 3; /* the first rounds of those kinds */
  const bool crowd = (double)broken > crowded * (double)r->layer.tet_count;
  if (!laves__known_take(&r->lattice, known) || (round >= walls && !zone_broken_walls(r))) return false;
  laves__zone_around(r->guarantee, &r->layer, r->forced, round == 0 ? 1 : 3, &r->lattice, known);
  return !(crowd || round >= all) || zone_everything_near(r, known);
}

/* The boundary made anew by stuffing in the lattice's zone, and held to features. What is near the zone is grafted into the layer
 * as it was; where that does not fit, all of it is taken. In later rounds nothing that is made near a zone is held: where
 * features crowd, each round would break the promise in another place. */
static laves_result make_zone(laves__run *r, int round, const laves__known_lattice *known, laves__layer *improved) {
  enum { FREE_FROM = 2, FREE_CELLS = 4 }; /* rounds; about what a graft takes at least */
  bool fits = false;
  *improved = r->layer;
  r->layer = (laves__layer){0};
  laves_result result = laves__stuff_zone(r);
  if (result == LAVES_OK && r->frame.features) result = hold_features(r, round >= FREE_FROM ? FREE_CELLS : 0);
  if (result != LAVES_OK) return result;
  laves__stage_begin(r);
  result = laves__graft(known, &r->lattice, &r->layer, improved, &fits, r->error);
  laves__stage_end(r, "stuff");
  if (!fits) return result;
  r->layer = *improved;
  *improved = (laves__layer){0};
  return result;
}

/* One round: stuffing in the zone, and what was made anew improved. */
static laves_result mend_zone(laves__run *r, int round, const laves__known_lattice *known) {
  laves__layer improved = {0};
  laves_result result = make_zone(r, round, known, &improved);
  laves__layer_free(&improved);
  if (result == LAVES_OK) result = improve_layer(r);
  if (result == LAVES_OK) result = find_forced(r);
  return result == LAVES_OK && laves__is_cancelled(r->context) ? laves__fail_cancelled(r->error) : result;
}

/* Where the promised window is broken, but for what the input forces: stuffing in a growing zone, until no tet breaks the promise
 * or nothing more can be stuffed. */
static laves_result mend_promise(laves__run *r) {
  enum { ROUNDS = 11 };
  laves__known_lattice known = {0};
  laves_result result = find_forced(r);
  size_t broken = result == LAVES_OK ? count_broken(r) : 0;
  if (laves__is_cancelled(r->context)) result = laves__fail_cancelled(r->error);
  for (int round = 0; result == LAVES_OK && round < ROUNDS && broken > 0; round++) {
    result = widen_zone(r, round, broken, &known) ? mend_zone(r, round, &known) : laves__fail_memory(r->context, r->error);
    if (result == LAVES_OK) broken = count_broken(r);
    if (laves__is_cancelled(r->context)) result = laves__fail_cancelled(r->error);
  }
  laves__known_free(&known);
  if (result == LAVES_OK && r->forced) r->report->forced_tets = laves__count_broken(r->guarantee, &r->layer, NULL);
  return result == LAVES_OK && laves__is_cancelled(r->context) ? laves__fail_cancelled(r->error) : result;
}

/* The layer improved, and inside the promised window. */
laves_result laves__improve_boundary(laves__run *r) {
  laves_result result = improve_layer(r);
  if (result == LAVES_OK && laves__may_mend(r) && laves__filled_share(r) == 0) { /* flat tets only, all peeled off */
    result = laves__stuff_everything(r);
    if (result == LAVES_OK) result = improve_layer(r);
  }
  return result == LAVES_OK && laves__may_mend(r) ? mend_promise(r) : result;
}
