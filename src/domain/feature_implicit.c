/* Features of implicit solids: the story, and what is asked of them afterwards. */
#include "domain/feature_implicit.h"

#include <string.h>

#include "domain/elementary.h"

/* Fractions of the diagonal: how far to the side a point of a crease is looked at (thinner parts are not seen; rounding is
 * a millionth of it), and by how much a chord may miss its crease. */
static const double probe_part = 1e-6, sagitta_part = 5e-5;
/* Cells in which corners are looked up, in probes: wider than those that are merged. */
static const double corner_cell = 64;
/* Half the widths of the boxes of local codes, in sizes. */
static const double near_reach = 1.5, wide_reach = 12;
/* Sizes above this part of the diagonal are too coarse to find a solid's own creases, those below too fine to search. */
static const double largest_size = 1.0 / 24, least_size = 1.0 / 3000;
/* Parts of the size: the longest step along a crease, and by how much a chord may miss it where that is less than the above. */
static const double step_part = 0.25, sagitta_of_size = 0.01;
/* Up to so many branches of a patch are tried one by one when nothing tells which one is near. */
/* Where no branch of a patch has a foot on the surface, distance from it counts so much more than distance to the foot. */
static const double off_surface_cost = 2;
enum { TRIED_MEMBERS = 16, NEAR_MEMBERS = 32 };

/* ---- the search ---- */

bool laves__search_goes_on(laves__crease_search *s) {
  if (s->out_of_memory || s->cancelled || s->work > LAVES__SEARCH_WORK) return false;
  if (++s->asked % 256 == 0) s->cancelled = laves__cancelled(s->context, "features", s->fraction);
  return !s->cancelled;
}

static bool contains(laves__box3 box, laves__vec3 p, double by) {
  for (int i = 0; i < 3; i++)
    if (!(v3_at(p, i) - by >= v3_at(box.lower, i) && v3_at(p, i) + by <= v3_at(box.upper, i))) return false;
  return true;
}

static bool cut_around(laves__crease_search *s, const laves__code *code, laves__vec3 p, double by, laves__code *cut,
                       laves__box3 *box) {
  const laves__vec3 reach = v3(by, by, by);
  *box = (laves__box3){v3_sub(p, reach), v3_add(p, reach)};
  s->work += 2 * (double)code->tape.count;
  if (laves__code_cut(s->context, code, *box, &s->room, cut)) return true;
  *box = box3_empty();
  s->out_of_memory = true;
  return false;
}

/* In two steps, as the whole tape may be long: the wide one serves many places. */
const laves__code *laves__local_code(laves__crease_search *s, laves__vec3 p) {
  const double size = s->all->size;
  if (contains(s->near_box, p, size)) return &s->near;
  if (!contains(s->wide_box, p, near_reach * size) &&
      !cut_around(s, &s->all->whole, p, wide_reach * size, &s->wide, &s->wide_box))
    return &s->all->whole;
  if (!cut_around(s, &s->wide, p, near_reach * size, &s->near, &s->near_box)) return &s->all->whole;
  return &s->near;
}

static laves_result outcome_of(const laves__crease_search *s, laves_error *error) {
  if (s->cancelled) return laves__fail_cancelled(error);
  return s->out_of_memory ? laves__fail_memory(s->context, error) : LAVES_OK;
}

static void search(laves__crease_search *s) {
  s->out_of_memory = !laves__branch_room_make(s->context, s->all->solid.tape, &s->room);
  if (!s->out_of_memory) laves__search_cells(s);
  if (!s->out_of_memory) laves__search_walks(s);
  if (!s->out_of_memory) laves__corners_complete(s);
  if (!s->out_of_memory) laves__weak_borders_join(s);
  laves__free(s->context, s->weak, s->weak_capacity, sizeof *s->weak);
  laves__free(s->context, s->loose, s->loose_capacity, sizeof *s->loose);
  laves__free(s->context, s->sample, s->sample_capacity, sizeof *s->sample);
  laves__branch_room_free(s->context, &s->room);
  laves__code_free(s->context, &s->near);
  laves__code_free(s->context, &s->wide);
}

/* ---- patches ---- */

/* Numbers the patches by their first branches and lists the branches of each. Branches without a point are left out. */
static bool number_patches(laves__implicit_features *all, laves_context *context, int32_t *patch_count) {
  const size_t count = all->branches.count;
  int32_t *number = laves__alloc(context, count + 1, sizeof *number);
  all->members = laves__alloc(context, count + 1, sizeof *all->members);
  all->member_end = laves__alloc_zeroed(context, count + 1, sizeof *all->member_end);
  const bool made = number && all->members && all->member_end;
  if (made) {
    *patch_count = 0;
    for (size_t i = 0; i < count; i++) number[i] = LAVES__NO_FEATURE;
    for (size_t i = 0; i < count; i++) {
      const int32_t root = laves__branch_root(all, (int32_t)i);
      if (all->seen[i] && number[root] < 0) number[root] = (*patch_count)++;
    }
    for (size_t i = 0; i < count; i++) /* roots come before their branches, so theirs is taken over last */
      if (all->patch[i] != (int32_t)i) number[i] = number[laves__branch_root(all, (int32_t)i)];
    for (size_t i = 0; i < count; i++) all->patch[i] = all->seen[i] ? number[i] : LAVES__NO_FEATURE;
    for (size_t i = 0; i < count; i++)
      if (all->patch[i] >= 0) all->member_end[all->patch[i]]++;
    for (int32_t k = 1; k < *patch_count; k++) all->member_end[k] += all->member_end[k - 1];
    for (size_t i = count; i-- > 0;) /* ends run down to the starts, and are put right below */
      if (all->patch[i] >= 0) all->members[--all->member_end[all->patch[i]]] = (uint32_t)i;
    uint32_t total = 0;
    for (size_t i = 0; i < count; i++) total += all->patch[i] >= 0;
    for (int32_t k = 0; k < *patch_count; k++) all->member_end[k] = k + 1 < *patch_count ? all->member_end[k + 1] : total;
  }
  laves__free(context, number, count + 1, sizeof *number);
  return made;
}

static bool give_segments(const laves__crease_search *s) {
  const laves__implicit_features *all = s->all;
  laves__feature_lines *lines = s->lines;
  for (size_t i = 0; i < all->piece_grid.count; i++) {
    const laves__crease_piece *c = &all->piece[i];
    const laves__feature_segment segment = {
        .ends = {c->points[0], c->points[1]}, .patch = {all->patch[c->branch[0]], all->patch[c->branch[1]]}, .angle = c->angle};
    if (!laves__feature_lines_add_segment(lines, &segment)) return false;
  }
  for (size_t i = s->first_fixed; i < lines->fixed_count; i++) lines->fixed[i].patch = all->patch[lines->fixed[i].patch];
  return true;
}

/* ---- questions ---- */

static int32_t known_branch_with(const laves__implicit_features *all, laves__vec3 foot, laves__vec3 normal,
                                 laves__branch_room *room) {
  const double depth = probe_part * all->solid.diagonal;
  for (int side = -1; side <= 1; side += 2) {
    laves__signature signature;
    const laves__vec3 at = v3_mad(foot, normal, side * depth);
    if (!laves__signature_at(all->features->context, all->branches.whole, &all->whole, at, room, &signature)) break;
    const int32_t b = laves__branches_find(&all->branches, &signature);
    laves__vec3 own;
    if (b != LAVES__NO_BRANCH && all->patch[b] >= 0 && laves__branch_passes(&all->branches.tape[b], foot, depth, &own)) return b;
  }
  return LAVES__NO_BRANCH;
}

/* The branch at a foot, as laves__branch_of_foot, but none is added. Only very long tapes need memory for that; when there is
 * none, no branch is known. */
static int32_t known_branch(const laves__implicit_features *all, laves__vec3 foot, laves__vec3 normal) {
  enum { FEW = 8192 };
  if (all->whole.tape.count <= FEW) {
    int32_t number[FEW], side[FEW];
    bool live[FEW];
    laves__choice choices[FEW];
    laves__branch_room room = {.number = number, .live = live, .side = side, .choices = choices};
    return known_branch_with(all, foot, normal, &room);
  }
  laves__branch_room room;
  if (!laves__branch_room_make(all->features->context, all->solid.tape, &room)) return LAVES__NO_BRANCH;
  const int32_t found = known_branch_with(all, foot, normal, &room);
  laves__branch_room_free(all->features->context, &room);
  return found;
}

typedef struct site_question {
  const laves__implicit_features *all;
  laves__vec3 p;
  int32_t patch; /* LAVES__NO_FEATURE: any */
  int32_t near[NEAR_MEMBERS];
  int count;
} site_question;

static void collect_branch(void *user, uint32_t index) {
  site_question *q = user;
  const int32_t b = q->all->site_branch[index];
  if (q->all->patch[b] < 0 || (q->patch >= 0 && q->all->patch[b] != q->patch)) return;
  for (int i = 0; i < q->count; i++)
    if (q->near[i] == b) return;
  if (q->count < NEAR_MEMBERS) q->near[q->count++] = b;
}

/* Branches of a patch (or of all) that are met near p; where there are none, its first ones. */
static void find_near(site_question *q) {
  laves__point_grid_near(&q->all->site_grid, q->p, collect_branch, q);
  if (q->count > 0 || q->patch < 0) return;
  const laves__implicit_features *all = q->all;
  const uint32_t begin = q->patch > 0 ? all->member_end[q->patch - 1] : 0, end = all->member_end[q->patch];
  for (uint32_t i = begin; i < end && q->count < TRIED_MEMBERS; i++) q->near[q->count++] = (int32_t)all->members[i];
}

static int32_t patch_at(const void *self, laves__vec3 foot, uint32_t hint) {
  const laves__implicit_features *all = self;
  (void)hint;
  if (all->features->patch_count == 1) return 0;
  const laves__vec3 normal = v3_unit(laves__tape_gradient(all->solid.tape, foot).gradient);
  const int32_t b = known_branch(all, foot, normal);
  if (b != LAVES__NO_BRANCH) return all->patch[b];
  site_question q = {.all = all, .p = foot, .patch = LAVES__NO_FEATURE};
  find_near(&q);
  for (size_t i = 0; q.count == 0 && i < all->branches.count && i < TRIED_MEMBERS; i++)
    if (all->patch[i] >= 0) q.near[q.count++] = (int32_t)i;
  int32_t best = 0;
  double least = INFINITY;
  for (int i = 0; i < q.count; i++) {
    const laves__dual at = laves__tape_gradient(&all->branches.tape[q.near[i]], foot);
    const double distance = fabs(at.value) / v3_norm(at.gradient);
    if (!(distance < least)) continue;
    least = distance;
    best = all->patch[q.near[i]];
  }
  return best;
}

static bool foot_on(const laves__implicit_features *all, int32_t branch, laves__vec3 point, double reach, laves__vec3 *foot,
                    laves__vec3 *normal) {
  laves__dual there;
  if (!laves__tape_foot(&all->branches.tape[branch], all->solid.diagonal, point, reach, foot, &there)) return false;
  *normal = v3_unit(there.gradient);
  return true;
}

static double value_at(const laves__implicit_features *all, laves__vec3 p) {
  double phi;
  laves__tape_evaluate(all->solid.tape, 1, &p, &phi);
  return phi;
}

/* Whether a foot is on the solid's surface, and not only on the continuation of one of its branches. */
static bool is_real(const laves__implicit_features *all, laves__vec3 foot) {
  return fabs(value_at(all, foot)) <= probe_part * all->solid.diagonal;
}

/* Of the branches of a patch: the hint's where its foot is real; the one that makes the surface nearby; of those met around here
 * the one whose foot is near, and near the surface. */
static bool project_patch(const void *self, int32_t patch, laves__vec3 point, double reach, uint32_t *hint, laves__vec3 *foot,
                          laves__vec3 *normal) {
  const laves__implicit_features *all = self;
  const uint32_t begin = patch > 0 ? all->member_end[patch - 1] : 0, end = all->member_end[patch];
  laves__dual there;
  if (all->features->patch_count == 1) {
    *hint = LAVES__NO_HINT;
    if (!laves__tape_foot(all->solid.tape, all->solid.diagonal, point, reach, foot, &there)) return false;
    *normal = v3_unit(there.gradient);
    return true;
  }
  if (end == begin + 1) {
    *hint = all->members[begin];
    return foot_on(all, (int32_t)all->members[begin], point, reach, foot, normal);
  }
  if (*hint < all->branches.count && all->patch[*hint] == patch && foot_on(all, (int32_t)*hint, point, reach, foot, normal) &&
      is_real(all, *foot))
    return true;
  if (laves__tape_foot(all->solid.tape, all->solid.diagonal, point, reach, foot, &there)) {
    const int32_t b = known_branch(all, *foot, v3_unit(there.gradient));
    if (b != LAVES__NO_BRANCH && all->patch[b] == patch && foot_on(all, b, point, reach, foot, normal)) {
      *hint = (uint32_t)b;
      return true;
    }
  }
  site_question q = {.all = all, .p = point, .patch = patch};
  find_near(&q);
  double least = INFINITY;
  for (int i = 0; i < q.count; i++) {
    laves__vec3 trial, n;
    if (!foot_on(all, q.near[i], point, reach, &trial, &n)) continue;
    const double cost = v3_distance(trial, point) + off_surface_cost * fabs(value_at(all, trial));
    if (!(cost < least)) continue;
    least = cost;
    *foot = trial;
    *normal = n;
    *hint = (uint32_t)q.near[i];
  }
  return least < INFINITY;
}

/* The nearest piece of a crease between the same patches. */
typedef struct refine_question {
  const laves__implicit_features *all;
  laves__vec3 p;
  const int32_t *patch;
  double distance2;
  uint32_t best;
} refine_question;

static void measure(void *user, uint32_t index) {
  refine_question *q = user;
  const laves__crease_piece *c = &q->all->piece[index];
  const double distance2 = laves__piece_distance2(c, q->p);
  const int32_t l = q->all->patch[c->branch[0]], r = q->all->patch[c->branch[1]];
  if (!(l == q->patch[0] && r == q->patch[1]) && !(l == q->patch[1] && r == q->patch[0])) return;
  if (distance2 > q->distance2 || (distance2 == q->distance2 && index >= q->best)) return;
  q->distance2 = distance2;
  q->best = index;
}

/* Corners and other ends stay: the functions' common point nearest to them is they themselves. */
static void refine(const void *self, int32_t crease, laves__vec3 *foot, laves__vec3 *tangent) {
  const laves__implicit_features *all = self;
  const laves__crease *c = &all->features->crease[crease];
  if (c->drawn) return;
  refine_question q = {all, *foot, c->patch, INFINITY, LAVES__NONE};
  laves__point_grid_near(&all->piece_grid, *foot, measure, &q);
  if (q.best == LAVES__NONE) return;
  const int32_t *branch = all->piece[q.best].branch;
  const laves__tape *f[2] = {&all->branches.tape[branch[0]], &all->branches.tape[branch[1]]};
  if (!laves__tapes_meet(f, 2, all->solid.diagonal, all->size, foot)) return;
  const laves__vec3 a = v3_unit(laves__tape_gradient(f[0], *foot).gradient);
  const laves__vec3 b = v3_unit(laves__tape_gradient(f[1], *foot).gradient);
  const laves__vec3 along = v3_unit(v3_cross(a, b));
  *tangent = v3_dot(along, *tangent) < 0 ? v3_scale(along, -1) : along;
}

/* ---- all ---- */

static void free_features(laves_context *context, void *self) {
  laves__implicit_features *all = self;
  if (!all) return;
  const size_t count = all->branches.count;
  laves__free(context, all->members, count + 1, sizeof *all->members);
  laves__free(context, all->member_end, count + 1, sizeof *all->member_end);
  laves__free(context, all->patch, all->branch_capacity, sizeof *all->patch);
  laves__free(context, all->seen, all->seen_capacity, sizeof *all->seen);
  laves__free(context, all->piece, all->piece_capacity, sizeof *all->piece);
  laves__free(context, all->site_branch, all->site_capacity, sizeof *all->site_branch);
  laves__point_grid_free(&all->piece_grid);
  laves__point_grid_free(&all->site_grid);
  laves__code_free(context, &all->whole);
  laves__branches_free(&all->branches);
  laves__free(context, all, 1, sizeof *all);
}

static double usable_size(const laves__implicit_solid *solid, double size) {
  return min_of(max_of(size, least_size * solid->diagonal), largest_size * solid->diagonal);
}

laves_result laves__features_of_implicit(const laves__implicit_solid *solid, const laves__feature_wish *wish,
                                         laves__features *features, laves__feature_lines *lines, laves_error *error) {
  laves_context *context = features->context;
  if (!(wish->angle > 0)) return LAVES_OK;
  laves__implicit_features *all = laves__alloc_zeroed(context, 1, sizeof *all);
  if (!all) return laves__fail_memory(context, error);
  all->features = features;
  all->solid = *solid;
  all->size = usable_size(solid, wish->size);
  laves__branches_init(&all->branches, context, solid->tape);
  laves__point_grid_init(&all->piece_grid, context, all->size);
  laves__point_grid_init(&all->site_grid, context, all->size);
  laves__crease_search s = {.all = all,
                            .context = context,
                            .wish = wish,
                            .lines = lines,
                            .first_point = lines->point_count,
                            .first_fixed = lines->fixed_count,
                            .probe = probe_part * solid->diagonal,
                            .near_box = box3_empty(),
                            .wide_box = box3_empty(),
                            .step = step_part * all->size,
                            .sagitta = min_of(sagitta_part * solid->diagonal, sagitta_of_size * all->size)};
  laves__point_grid_init(&s.corner_grid, context, corner_cell * s.probe);
  s.out_of_memory = !laves__code_whole(context, solid->tape, &all->whole);
  if (!s.out_of_memory) search(&s);
  laves__free(context, s.corner_point, s.corner_capacity, sizeof *s.corner_point);
  laves__point_grid_free(&s.corner_grid);
  int32_t patch_count = 0;
  s.out_of_memory = s.out_of_memory || !number_patches(all, context, &patch_count) || !give_segments(&s);
  const laves_result result = outcome_of(&s, error);
  if (result != LAVES_OK || patch_count == 0) {
    free_features(context, all);
    return result;
  }
  features->patch_count = patch_count;
  features->self = all;
  features->patch_at = patch_at;
  features->project_patch = project_patch;
  features->refine = refine;
  features->free_self = free_features;
  return LAVES_OK;
}
