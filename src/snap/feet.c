/* The search for feet, and the memory of what was found. */
#include "snap/feet.h"

#include <string.h>

/* How far, in local sizes, a foot may be: the longest edge and room for projection errors. */
static const double foot_reach = 1.25;
/* How far, in local sizes, a crossing found by bisection may be moved when it is polished by projection. */
static const double polish_reach = 1e-3;

/* The crossing of the edge from a to b nearest to a, by bisection on the sign at a, as a share of the edge. */
static double bisect_edge(const laves__frame *frame, laves__vec3 a, laves__vec3 b, int sign_a) {
  enum { STEPS = 40 };
  double low = 0, high = 1;
  for (int i = 0; i < STEPS; i++) {
    const double middle = 0.5 * (low + high);
    const laves__vec3 p = v3_lerp(a, b, middle);
    double phi;
    laves__frame_evaluate(frame, 1, &p, &phi, NULL);
    if ((phi < 0 ? -1 : 1) == sign_a)
      low = middle;
    else
      high = middle;
  }
  return high;
}

static void set_normal(laves__foot *foot, laves__vec3 n) {
  foot->normal[0] = (float)n.x;
  foot->normal[1] = (float)n.y;
  foot->normal[2] = (float)n.z;
}

static bool nearest_crossing(const laves__frame *frame, const laves__lattice *lattice, laves__site s, laves__foot *foot) {
  const laves__vec3 a = laves__site_place(lattice, s);
  const int sign = laves__site_sign(lattice, s);
  const double polish = polish_reach * laves__site_scale(lattice, s);
  const laves__ring ring = laves__ring_of(lattice, s);
  double nearest = HUGE_VAL;
  for (int k = 0; k < ring.count; k++) {
    const laves__site n = laves__ring_at(&ring, k);
    if (n.cell < 0 || laves__site_sign(lattice, n) == sign || laves__is_hull(lattice, n)) continue;
    const laves__vec3 b = laves__site_place(lattice, n);
    const laves__vec3 crossing = v3_lerp(a, b, bisect_edge(frame, a, b, sign));
    const double distance = v3_distance(a, crossing);
    if (distance >= nearest) continue;
    nearest = distance;
    foot->position = crossing;
    set_normal(foot, v3_unit(v3_scale(v3_sub(b, a), -sign)));
  }
  foot->hint = LAVES__NO_HINT;
  if (nearest == HUGE_VAL) return false;
  laves__vec3 polished, normal;
  if (laves__frame_project(frame, foot->position, polish, &foot->hint, &polished, &normal) &&
      v3_distance(polished, foot->position) < polish) {
    foot->position = polished;
    set_normal(foot, normal);
  }
  return true;
}

/* Sites whose feet are asked for in one call: those of one record, or of several for oracles that like large calls. */
enum { ASKED_MAX = 256 };

typedef struct question {
  size_t count;
  double furthest; /* the largest reach of the record that they are of, or of each of the records */
  laves__site site[ASKED_MAX];
  laves__vec3 at[ASKED_MAX];
  double reach[ASKED_MAX];
  laves__projection answer[ASKED_MAX];
} question;

/* The feet of the sites: the nearest points of the surface or, where one can't be found, the nearest crossing of the site's own
 * edges. */
static void find_asked_feet(const laves__frame *frame, const laves__lattice *lattice, question *q, laves__feet *feet) {
  for (size_t i = 0; i < q->count; i++) q->answer[i].found = false;
  laves__frame_project_many(frame, q->count, q->at, q->furthest, q->answer);
  for (size_t i = 0; i < q->count; i++) {
    const laves__projection *a = &q->answer[i];
    const laves__site s = q->site[i];
    laves__foot *foot = &feet->block[feet->block_of[s.cell]][s.site];
    if (a->found && v3_distance(q->at[i], a->foot) <= q->reach[i]) {
      foot->position = a->foot;
      foot->hint = a->hint;
      set_normal(foot, a->normal);
      foot->state = LAVES__FOOT_FOUND;
    } else {
      foot->state = nearest_crossing(frame, lattice, s, foot) ? LAVES__FOOT_FOUND : LAVES__FOOT_NONE;
    }
  }
  q->count = 0;
}

static double furthest_reach(const laves__lattice *lattice, size_t record, uint32_t sites) {
  double furthest = 0;
  for (uint32_t mask = sites; mask; mask &= mask - 1) {
    const laves__site s = {(int32_t)record, (uint8_t)__builtin_ctz(mask)};
    furthest = fmax(furthest, foot_reach * laves__site_scale(lattice, s));
  }
  return furthest;
}

static void ask(const laves__lattice *lattice, size_t record, uint32_t sites, question *q) {
  for (uint32_t mask = sites; mask; mask &= mask - 1) {
    const laves__site s = {(int32_t)record, (uint8_t)__builtin_ctz(mask)};
    const size_t i = q->count++;
    q->site[i] = s;
    q->at[i] = laves__site_place(lattice, s);
    q->reach[i] = foot_reach * laves__site_scale(lattice, s);
    q->answer[i].hint = lattice->record[record].hint[s.site];
  }
}

/* Whether a point with the value phi lies on a side (-1 inside, 1 outside), at least `depth` from the surface. */
static bool is_beyond(const laves__frame *frame, laves__vec3 point, double phi, double depth, int side) {
  if (!(side * phi > 0)) return false;
  if (frame->oracle->is_distance) return side * phi > depth;
  uint32_t hint = LAVES__NO_HINT; /* phi has no unit: the foot tells */
  laves__vec3 foot, normal;
  return !laves__frame_project(frame, point, depth, &hint, &foot, &normal) || v3_distance(point, foot) > depth;
}

static bool lies_beyond(const laves__frame *frame, laves__vec3 point, double depth, int side) {
  double phi;
  laves__frame_evaluate(frame, 1, &point, &phi, NULL);
  return is_beyond(frame, point, phi, depth, side);
}

bool laves__lies_inside(const laves__frame *frame, laves__vec3 point, double depth) {
  return lies_beyond(frame, point, depth, -1);
}

bool laves__lies_outside(const laves__frame *frame, laves__vec3 point, double depth) {
  return lies_beyond(frame, point, depth, 1);
}

bool laves__any_lies_outside(const laves__frame *frame, int count, const laves__vec3 *points, double depth) {
  double phi[LAVES__POINTS_MAX];
  LAVES_ASSERT(count <= LAVES__POINTS_MAX);
  laves__frame_evaluate(frame, (size_t)count, points, phi, NULL);
  for (int i = 0; i < count; i++)
    if (is_beyond(frame, points[i], phi[i], depth, 1)) return true;
  return false;
}

typedef struct search {
  const laves__frame *frame;
  const laves__lattice *lattice;
  const uint32_t *wanted;
  laves__feet *feet;
} search;

static void find_feet(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const search *s = user;
  const size_t wished = s->frame->oracle->batch, most = wished < ASKED_MAX ? wished : ASKED_MAX;
  question q;
  q.count = 0;
  q.furthest = 0;
  for (size_t i = begin; i < end; i++) {
    uint32_t unknown = 0;
    for (uint32_t mask = s->wanted[i]; mask; mask &= mask - 1)
      if (laves__feet_at(s->feet, i, __builtin_ctz(mask))->state == LAVES__FOOT_UNKNOWN) unknown |= mask & -mask;
    if (!unknown) continue;
    /* What is found depends on the reach, so no record is asked for with another's. */
    const double reach = furthest_reach(s->lattice, i, unknown);
    const bool full = q.count + LAVES__C15_SITES > most || reach != q.furthest;
    if (q.count > 0 && full) find_asked_feet(s->frame, s->lattice, &q, s->feet);
    q.furthest = reach;
    ask(s->lattice, i, unknown, &q);
  }
  if (q.count > 0) find_asked_feet(s->frame, s->lattice, &q, s->feet);
}

bool laves__feet_make(const laves__lattice *lattice, const uint32_t *wanted, laves__feet *feet) {
  feet->context = lattice->context;
  laves_context *context = lattice->context;
  if (feet->record_count < lattice->record_count) {
    int32_t *grown = laves__realloc(context, feet->block_of, feet->record_count, lattice->record_count, sizeof *grown);
    if (!grown) return false;
    feet->block_of = grown;
    while (feet->record_count < lattice->record_count) feet->block_of[feet->record_count++] = -1;
  }
  for (size_t i = 0; i < lattice->record_count; i++) {
    if (!wanted[i] || feet->block_of[i] >= 0) continue;
    if (!laves__grow(context, &feet->block, &feet->block_capacity, feet->block_count + 1, sizeof *feet->block)) return false;
    memset(feet->block[feet->block_count], 0, sizeof *feet->block);
    feet->block_of[i] = (int32_t)feet->block_count++;
  }
  return true;
}

laves_result laves__feet_find(const laves__frame *frame, const laves__lattice *lattice, const uint32_t *wanted, laves__feet *feet,
                              laves_error *error) {
  if (!laves__feet_make(lattice, wanted, feet)) return laves__fail_memory(lattice->context, error);
  search s = {frame, lattice, wanted, feet};
  if (!laves__parallel_for(lattice->context, "snap", lattice->record_count, 8, find_feet, &s))
    return laves__fail_cancelled(error);
  return LAVES_OK;
}

const laves__foot *laves__feet_get(const laves__feet *feet, int32_t record, int site) {
  if ((size_t)record >= feet->record_count || feet->block_of[record] < 0) return NULL;
  const laves__foot *foot = laves__feet_at(feet, (size_t)record, site);
  return foot->state == LAVES__FOOT_FOUND || foot->state == LAVES__FOOT_OFF ? foot : NULL;
}

void laves__feet_free(laves__feet *feet) {
  if (!feet->context) return;
  laves__free(feet->context, feet->block_of, feet->record_count, sizeof *feet->block_of);
  laves__free(feet->context, feet->block, feet->block_capacity, sizeof *feet->block);
  memset(feet, 0, sizeof *feet);
}
