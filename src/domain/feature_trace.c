/* One crease, followed from a point of it to its ends.
 *
 * A step goes along the tangent and then, by the shortest way, back to where both functions vanish; it is as long as the
 * chord stays near the crease. At every point the sides are looked at: a convex edge is where the solid is the larger of the
 * two functions, a notch where it is the smaller.
 *
 *         d_s  <--+--> s            n_s, n_t the normals; d_s points along face s, away from t's side. At a convex edge s
 *                 |                 goes on the other way, at a notch this way.
 *                 t
 *
 * Where that ends, a third function has taken over. Halving finds the place, and the functions found around it give the corner
 * as the point where three vanish. Where the third continues one of the two smoothly the crease goes on with it. */
#include <string.h>

#include "domain/elementary.h"
#include "domain/feature_implicit.h"

/* All steps of all creases (190 MB); more than a mesh of a hundred million tets could follow. And so many steps must lead a
 * crease further than one size: what takes more writhes below the size. */
enum { PIECE_LIMIT = 1000000, STEPS_PER_SIZE = 512 };
/* Around an end so many functions are looked at, and so many times in a row may a crease go on with another one. */
enum { RIVAL_LIMIT = 16, CHANGE_LIMIT = 64 };
/* Cosine of the angle by which the tangent may turn in a step. */
static const double least_cosine = 0.9;
/* Probed values that differ by less than this part of what a face's turning makes over the probe are equal. */
static const double equal_part = 1e-3;
/* A crease goes on with another function if that turns the normals by less than this (sine of 3 degrees). */
static const double smooth_turn = 0.052;
/* Distances around an end, in probes: where rivals are looked for, how far a corner or what goes on may lie, how far ahead
 * a crease is picked up again; how far it must lead at least. */
static const double rival_radius = 6, corner_reach = 64, ahead = 16, lead = 8;

/* A crease goes on until its angle is below this part of the wished one: fewer ends in the open, and patches that stay apart. */
static const double weak_part = 0.25;

/* Below this sine two normals are one: the probes would be too far off the faces. */
static const double least_sine = 1e-6;
/* A value of the solid below this part of the diagonal is zero at a corner that was solved for: far above rounding, and below
 * what any third function makes of the distances looked at here. */
static const double zero_part = 1e-9;
/* In probes: corners that are one, the depth at which rivals are told, steps that are too short to be halved, how exactly ends
 * are found. */
static const double corner_merge = 8, rival_depth = 0.25, least_step = 4, end_width = 0.5;
/* Parts of the longest step below which a crease that fades is given up. */
static const double fade_step = 1.0 / 16;
/* A ring is closed by a step of at most so many planned ones that ends within this part of its length from the start. */
static const double closing_reach = 1.5, closing_miss = 0.05;
/* A crease was found before where a piece passes within so many of the distances that chords may miss their creases by. */
static const double found_before = 4;
/* Cosine of the angle below which gradients of twins are the same. */
static const double twin_cosine = 0.9999;

static const double degrees = 57.29577951308232;

/* ---- how branches meet ---- */

typedef enum meeting_kind { NOT_MET, CONVEX, CONCAVE } meeting_kind;

static const laves__tape *tape_of(const laves__crease_search *s, int32_t branch) { return &s->all->branches.tape[branch]; }

static meeting_kind branches_meet(laves__crease_search *s, laves__vec3 p, const int32_t branch[2], laves__vec3 normal[2],
                                  double *turn) {
  double slope[2];
  const laves__code *code = laves__local_code(s, p);
  s->work += 5 * (double)code->tape.count;
  for (int i = 0; i < 2; i++) {
    const laves__dual at = laves__tape_gradient(tape_of(s, branch[i]), p);
    slope[i] = v3_norm(at.gradient);
    normal[i] = v3_unit(at.gradient);
  }
  const double cosine = v3_dot(normal[0], normal[1]), sine = v3_norm(v3_cross(normal[0], normal[1]));
  *turn = degrees * laves__angle(sine, cosine);
  if (!(slope[0] > 0 && slope[1] > 0 && sine > least_sine)) return NOT_MET;
  laves__vec3 probes[5]; /* on face 0 before and beyond the crease, on face 1 before and beyond; on it */
  double phi[5], own[4];
  for (int i = 0; i < 2; i++) {
    const laves__vec3 beyond = v3_scale(v3_mad(normal[1 - i], normal[i], -cosine), s->probe / sine);
    probes[2 * i] = v3_sub(p, beyond);
    probes[2 * i + 1] = v3_add(p, beyond);
    laves__tape_evaluate(tape_of(s, branch[i]), 2, probes + 2 * i, own + 2 * i);
  }
  probes[4] = p;
  laves__tape_evaluate(&code->tape, 5, probes, phi);
  const double equal = equal_part * s->probe * sine * min_of(slope[0], slope[1]);
  if (!(fabs(phi[4]) <= equal)) return NOT_MET;
  const bool before = fabs(phi[0] - own[0]) <= equal && fabs(phi[2] - own[2]) <= equal;
  const bool beyond = fabs(phi[1] - own[1]) <= equal && fabs(phi[3] - own[3]) <= equal;
  if (before == beyond) return NOT_MET;
  if (before) return phi[1] > own[1] && phi[3] > own[3] ? CONVEX : NOT_MET;
  return phi[0] < own[0] && phi[2] < own[2] ? CONCAVE : NOT_MET;
}

/* ---- points of a crease ---- */

typedef struct spot {
  laves__vec3 p, tangent; /* the first branch is on the left along the tangent */
  laves__vec3 normal[2];
  int32_t branch[2];
  meeting_kind meeting;
  double turn; /* between the normals, degrees */
  uint32_t point;
} spot;

static double inner_angle(const spot *a) { return a->meeting == CONVEX ? 180 - a->turn : 180 + a->turn; }

/* Seen from outside, the face of n is left of n x m where that face ends at a convex edge, right of it at a notch. */
static void look_around(laves__crease_search *s, spot *a) {
  a->meeting = branches_meet(s, a->p, a->branch, a->normal, &a->turn);
  const laves__vec3 along = v3_unit(v3_cross(a->normal[0], a->normal[1]));
  a->tangent = a->meeting == CONCAVE ? v3_scale(along, -1) : along;
}

static bool put_on_crease(const laves__crease_search *s, const int32_t branch[2], double reach, laves__vec3 *p) {
  const laves__tape *f[2] = {tape_of(s, branch[0]), tape_of(s, branch[1])};
  return laves__tapes_meet(f, 2, s->all->solid.diagonal, reach, p);
}

typedef enum outcome { WENT, TOO_LONG, ENDED, FADED } outcome;

/* A step of length h, along the tangent for way = 1, against it for -1. */
static outcome advance(laves__crease_search *s, const spot *from, double way, double h, spot *to) {
  *to = *from;
  const laves__vec3 ahead_of = v3_scale(from->tangent, way);
  to->p = v3_mad(from->p, ahead_of, h);
  if (!put_on_crease(s, from->branch, 0.5 * h, &to->p)) return TOO_LONG;
  if (v3_dot(v3_sub(to->p, from->p), ahead_of) < 0.5 * h) return TOO_LONG;
  look_around(s, to);
  if (to->meeting == NOT_MET && from->meeting == CONCAVE) to->tangent = v3_scale(to->tangent, -1);
  if (v3_dot(to->tangent, from->tangent) < least_cosine) return to->meeting == from->meeting ? TOO_LONG : ENDED;
  if (h * v3_distance(to->tangent, from->tangent) > 8 * s->sagitta) return TOO_LONG; /* of an arc: h turn / 8 */
  if (to->meeting != from->meeting) return ENDED;
  return to->turn < weak_part * s->wish->angle ? FADED : WENT;
}

/* ---- what has been found ---- */

static bool add_piece(laves__crease_search *s, const spot *a, const spot *b) {
  laves__implicit_features *all = s->all;
  const laves__crease_piece piece = {.ends = {a->p, b->p},
                                     .points = {a->point, b->point},
                                     .branch = {a->branch[0], a->branch[1]},
                                     .angle = 0.5 * (inner_angle(a) + inner_angle(b))};
  const size_t count = all->piece_grid.count;
  if (!laves__grow(s->context, &all->piece, &all->piece_capacity, count + 1, sizeof piece) ||
      !laves__point_grid_add(&all->piece_grid, v3_lerp(a->p, b->p, 0.5))) {
    s->out_of_memory = true;
    return false;
  }
  all->piece[count] = piece;
  return true;
}

/* The piece between two spots, of which `to` was reached in direction `way`. */
static bool add_step(laves__crease_search *s, const spot *from, const spot *to, double way) {
  return way > 0 ? add_piece(s, from, to) : add_piece(s, to, from);
}

static bool add_point(laves__crease_search *s, spot *a) {
  if (laves__feature_lines_add_point(s->lines, a->p, &a->point)) return true;
  s->out_of_memory = true;
  return false;
}

double laves__piece_distance2(const laves__crease_piece *c, laves__vec3 p) {
  const laves__vec3 along = v3_sub(c->ends[1], c->ends[0]);
  const double length2 = v3_norm2(along), t = length2 > 0 ? v3_dot(v3_sub(p, c->ends[0]), along) / length2 : 0;
  return v3_norm2(v3_sub(p, v3_mad(c->ends[0], along, min_of(max_of(t, 0), 1))));
}

typedef struct piece_question {
  const laves__implicit_features *all;
  laves__vec3 p;
  int32_t a, b; /* roots */
  double distance2;
  uint32_t best;
} piece_question;

static void measure_piece(void *user, uint32_t index) {
  piece_question *q = user;
  const laves__crease_piece *c = &q->all->piece[index];
  const double distance2 = laves__piece_distance2(c, q->p);
  if (distance2 > q->distance2 || (distance2 == q->distance2 && index >= q->best)) return;
  const int32_t l = laves__branch_root(q->all, c->branch[0]), r = laves__branch_root(q->all, c->branch[1]);
  if (!(l == q->a && r == q->b) && !(l == q->b && r == q->a)) return;
  q->distance2 = distance2;
  q->best = index;
}

/* The piece nearest to p, within reach, of two patches (left and right in any order), or LAVES__NONE. */
static uint32_t piece_near(const laves__implicit_features *all, laves__vec3 p, double reach, int32_t a, int32_t b) {
  piece_question q = {all, p, laves__branch_root(all, a), laves__branch_root(all, b), reach * reach, LAVES__NONE};
  laves__point_grid_near(&all->piece_grid, p, measure_piece, &q);
  return q.best;
}

typedef struct corner_question {
  const laves__crease_search *s;
  laves__vec3 p;
  double distance;
  uint32_t best;
} corner_question;

static void measure_corner(void *user, uint32_t index) {
  corner_question *q = user;
  const double distance = v3_distance(q->s->corner_grid.at[index], q->p);
  if (distance > q->distance || (distance == q->distance && index >= q->best)) return;
  q->distance = distance;
  q->best = index;
}

bool laves__corner_add(laves__crease_search *s, laves__vec3 p, uint32_t *point) {
  corner_question q = {s, p, corner_merge * s->probe, LAVES__NONE};
  laves__point_grid_near(&s->corner_grid, p, measure_corner, &q);
  if (q.best != LAVES__NONE) {
    *point = s->corner_point[q.best];
    return true;
  }
  const size_t count = s->corner_grid.count;
  s->out_of_memory = !laves__grow(s->context, &s->corner_point, &s->corner_capacity, count + 1, sizeof *s->corner_point) ||
                     !laves__feature_lines_add_point(s->lines, p, point) || !laves__point_grid_add(&s->corner_grid, p);
  if (!s->out_of_memory) s->corner_point[count] = *point;
  return !s->out_of_memory;
}

/* ---- ends ---- */

typedef struct rivals {
  const laves__crease_search *s;
  laves__vec3 c;
  int32_t branch[RIVAL_LIMIT];
  int count;
} rivals;

static void add_rival(rivals *r, int32_t branch) {
  for (int i = 0; i < r->count; i++)
    if (r->branch[i] == branch) return;
  if (r->count < RIVAL_LIMIT) r->branch[r->count++] = branch;
}

/* A branch met in the cells around here is a rival if its zero passes close by. */
static void consider_site(void *user, uint32_t index) {
  rivals *r = user;
  const int32_t branch = r->s->all->site_branch[index];
  const laves__dual at = laves__tape_gradient(tape_of(r->s, branch), r->c);
  if (fabs(at.value) <= rival_radius * r->s->probe * v3_norm(at.gradient)) add_rival(r, branch);
}

/* Branches that make the surface around a place: feet of points around it, in the 26 directions of a cube, and what the
 * cells know, as from outside an edge all feet may be on the edge. */
static rivals find_rivals(laves__crease_search *s, laves__vec3 c) {
  rivals r = {.s = s, .c = c};
  const laves__code *code = laves__local_code(s, c);
  for (int k = 0; k < 27; k++) {
    const laves__vec3 direction = v3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    laves__vec3 foot;
    laves__dual there;
    const laves__vec3 from = v3_mad(c, v3_unit(direction), rival_radius * s->probe);
    if (!laves__tape_foot(&code->tape, s->all->solid.diagonal, from, 2 * rival_radius * s->probe, &foot, &there)) continue;
    laves__vec3 normal = v3_unit(there.gradient);
    const int32_t b = laves__branch_of_foot(s, code, foot, &normal, rival_depth * s->probe);
    if (b != LAVES__NO_BRANCH) add_rival(&r, b);
  }
  laves__point_grid_near(&s->all->site_grid, c, consider_site, &r);
  return r;
}

/* The point near the end where a third function vanishes as well. */
static bool find_corner(laves__crease_search *s, const spot *last, const rivals *r, laves__vec3 *corner) {
  const double reach = corner_reach * s->probe, diagonal = s->all->solid.diagonal;
  double least = INFINITY;
  for (int i = 0; i < r->count; i++) {
    if (r->branch[i] == last->branch[0] || r->branch[i] == last->branch[1]) continue;
    const laves__tape *f[3] = {tape_of(s, last->branch[0]), tape_of(s, last->branch[1]), tape_of(s, r->branch[i])};
    const laves__vec3 normal = v3_unit(laves__tape_gradient(f[2], last->p).gradient);
    if (fabs(v3_dot(normal, last->tangent)) < smooth_turn) continue; /* touches the crease, if at all */
    laves__vec3 p = last->p;
    double phi;
    if (!laves__tapes_meet(f, 3, diagonal, reach, &p)) continue;
    laves__tape_evaluate(&laves__local_code(s, p)->tape, 1, &p, &phi);
    const double distance = v3_distance(p, last->p);
    if (fabs(phi) > zero_part * diagonal || distance >= least) continue;
    least = distance;
    *corner = p;
  }
  return least < INFINITY;
}

static bool has_leaf(const laves__tape *tape) {
  for (size_t i = 0; i < tape->count; i++)
    if (tape->instructions[i].op == LAVES__OP_LEAF) return true;
  return false;
}

/* By how much normals may turn where a crease goes on: leaves are made of flat faces, and turn from one to the next. */
static double smooth_limit(const laves__crease_search *s, int32_t branch) {
  const double half = 0.5 / degrees * s->wish->angle;
  return has_leaf(tape_of(s, branch)) ? 2 * sin_of(half) : smooth_turn;
}

/* Picks the crease up again, with other functions that continue those of `last` smoothly, or on the next face of a leaf. */
static bool find_continuation(laves__crease_search *s, const spot *last, double way, const rivals *r, spot *next) {
  const double limit[2] = {smooth_limit(s, last->branch[0]), smooth_limit(s, last->branch[1])};
  double least = INFINITY;
  for (int i = -1; i < r->count; i++)
    for (int j = -1; j < r->count; j++) {
      spot a = *last;
      if (i >= 0) a.branch[0] = r->branch[i];
      if (j >= 0) a.branch[1] = r->branch[j];
      const bool same = a.branch[0] == last->branch[0] && a.branch[1] == last->branch[1];
      if ((same && max_of(limit[0], limit[1]) == smooth_turn) || a.branch[0] == a.branch[1]) continue;
      a.p = v3_mad(last->p, last->tangent, way * ahead * s->probe);
      if (!put_on_crease(s, a.branch, 0.5 * ahead * s->probe, &a.p)) continue;
      look_around(s, &a);
      if (a.meeting != last->meeting || a.turn < weak_part * s->wish->angle) continue;
      const double turn0 = v3_distance(a.normal[0], last->normal[0]), turn1 = v3_distance(a.normal[1], last->normal[1]);
      if (turn0 > limit[0] || turn1 > limit[1] || turn0 + turn1 >= least) continue;
      least = turn0 + turn1;
      *next = a;
    }
  return least < INFINITY;
}

/* The last spot before the end that a step of length h has passed. */
static spot find_end(laves__crease_search *s, const spot *from, double way, double h) {
  spot last = *from, trial;
  double sure = 0;
  while (h - sure > end_width * s->probe) {
    const double middle = 0.5 * (sure + h);
    if (advance(s, from, way, middle, &trial) == WENT) {
      sure = middle;
      last = trial;
    } else {
      h = middle;
    }
  }
  return last;
}

/* ---- following ---- */

static void join_sides(laves__crease_search *s, const spot *a, const spot *b) {
  for (int i = 0; i < 2; i++) laves__branches_join(s->all, a->branch[i], b->branch[i]);
}

static void note_loose(laves__crease_search *s, const spot *last, double way) {
  if (!laves__grow(s->context, &s->loose, &s->loose_capacity, s->loose_count + 1, sizeof *s->loose)) {
    s->out_of_memory = true;
    return;
  }
  s->loose[s->loose_count++] = (laves__loose_end){last->p, {last->branch[0], last->branch[1]}, last->point, way};
}

/* Ends a crease, or goes on with other functions: then true, and `here` is the first spot of them. */
static bool pass_end(laves__crease_search *s, spot *here, double way, double h) {
  spot last = find_end(s, here, way, h), next;
  const rivals r = find_rivals(s, v3_mad(last.p, last.tangent, 2 * way * s->probe));
  laves__vec3 corner;
  if (find_corner(s, &last, &r, &corner)) {
    if (!laves__corner_add(s, corner, &last.point)) return false;
    last.p = s->lines->point[last.point];
    if (last.point != here->point) add_step(s, here, &last, way);
    return false;
  }
  if (find_continuation(s, &last, way, &r, &next)) {
    join_sides(s, &last, &next);
    if (last.point == here->point && v3_distance(last.p, here->p) > 0) {
      if (!add_point(s, &last) || !add_step(s, here, &last, way)) return false;
    }
    if (!add_point(s, &next)) return false;
    spot end = last; /* the piece has the functions that it started with */
    end.p = next.p;
    end.point = next.point;
    if (!add_step(s, &last, &end, way)) return false;
    *here = next;
    return true;
  }
  if (v3_distance(last.p, here->p) > s->probe && add_point(s, &last) && add_step(s, here, &last, way)) note_loose(s, &last, way);
  return false;
}

/* Whether the next step leads back to the start; then the piece that does is added. */
static bool close_ring(laves__crease_search *s, const spot *here, double way, double h, const spot *start) {
  const laves__vec3 rest = v3_sub(start->p, here->p);
  const double length = v3_norm(rest);
  spot there;
  if (length > closing_reach * h || v3_dot(rest, here->tangent) * way < 0.5 * length) return false;
  if (advance(s, here, way, length, &there) != WENT || v3_distance(there.p, start->p) > closing_miss * length) return false;
  spot end = *start;
  end.branch[0] = here->branch[0];
  end.branch[1] = here->branch[1];
  if (way < 0) { /* the piece takes the functions of its first spot */
    spot from = *here;
    return add_piece(s, &end, &from), true;
  }
  return add_piece(s, here, &end), true;
}

/* Where a crease may go on below the wished angle, it is not known yet whether this is one. */
static void note_weak(laves__crease_search *s, const spot *a) {
  if (a->turn < weak_part * s->wish->angle) {
    laves__branches_join(s->all, a->branch[0], a->branch[1]);
    return;
  }
  if (laves__branch_root(s->all, a->branch[0]) == laves__branch_root(s->all, a->branch[1])) return;
  if (!laves__grow(s->context, &s->weak, &s->weak_capacity, s->weak_count + 1, sizeof *s->weak)) {
    s->out_of_memory = true;
    return;
  }
  s->weak[s->weak_count++] = (laves__weak_border){a->p, {a->branch[0], a->branch[1]}};
}

/* Bounds hold the surface; where they were cut short, creases may lead out of them. */
static bool has_left(const laves__crease_search *s, laves__vec3 p) {
  const laves__box3 box = s->all->solid.bounds;
  for (int i = 0; i < 3; i++)
    if (!(fabs(v3_at(p, i) - 0.5 * (v3_at(box.lower, i) + v3_at(box.upper, i))) <
          0.5 * (v3_at(box.upper, i) - v3_at(box.lower, i)) + s->all->size))
      return true;
  return false;
}

/* True when the crease closed. */
static bool follow(laves__crease_search *s, const spot *start, double way) {
  spot here = *start, there;
  double h = s->step;
  int steps = 0, changes = 0;
  laves__vec3 milestone = start->p;
  while (laves__search_goes_on(s) && s->all->piece_grid.count < PIECE_LIMIT) {
    if (has_left(s, here.p)) return false;
    if (steps % STEPS_PER_SIZE == STEPS_PER_SIZE - 1) {
      if (v3_distance(here.p, milestone) < s->all->size) return false;
      milestone = here.p;
    }
    if (steps > 2 && close_ring(s, &here, way, h, start)) return true;
    outcome o = advance(s, &here, way, h, &there);
    if ((o == TOO_LONG && h > least_step * s->probe) || (o == FADED && h > fade_step * s->step)) {
      h *= 0.5;
      continue;
    }
    if (o == FADED) {
      laves__branches_join(s->all, here.branch[0], here.branch[1]);
      return false;
    }
    if (o != WENT) {
      if (changes++ == CHANGE_LIMIT || !pass_end(s, &here, way, h)) return false;
      h = s->step;
      steps++;
      continue;
    }
    if (!add_point(s, &there) || !add_step(s, &here, &there, way)) return false;
    const bool straight = h * v3_distance(there.tangent, here.tangent) < 2 * s->sagitta;
    here = there;
    if (straight) h = min_of(2 * h, s->step);
    steps++;
    changes = 0;
  }
  return false;
}

/* At corners faces touch that have no crease in common. */
static bool leads_on(laves__crease_search *s, const spot *a) {
  spot there;
  return advance(s, a, 1, lead * s->probe, &there) == WENT || advance(s, a, -1, lead * s->probe, &there) == WENT;
}

/* Other branches may be the same functions but for rounding, as the tops of boxes that stand side by side. */
typedef struct twin_question {
  const laves__crease_search *s;
  const spot *a;
  double reach;
  int32_t twin[2]; /* of the spot's branches */
  bool found;
} twin_question;

static bool is_twin(const laves__crease_search *s, const spot *a, int side, int32_t branch) {
  if (branch == a->branch[side]) return true;
  const laves__dual at = laves__tape_gradient(tape_of(s, branch), a->p);
  const double slope = v3_norm(at.gradient);
  return fabs(at.value) <= equal_part * s->probe * slope && v3_dot(at.gradient, a->normal[side]) > twin_cosine * slope;
}

static void look_for_twins(void *user, uint32_t index) {
  twin_question *q = user;
  const laves__crease_piece *c = &q->s->all->piece[index];
  if (q->found || laves__piece_distance2(c, q->a->p) > q->reach * q->reach) return;
  for (int k = 0; k < 2 && !q->found; k++) {
    q->found = is_twin(q->s, q->a, 0, c->branch[k]) && is_twin(q->s, q->a, 1, c->branch[1 - k]);
    q->twin[0] = c->branch[k];
    q->twin[1] = c->branch[1 - k];
  }
}

static bool has_twin(laves__crease_search *s, const spot *a, double reach) {
  twin_question q = {.s = s, .a = a, .reach = reach};
  laves__point_grid_near(&s->all->piece_grid, a->p, look_for_twins, &q);
  for (int k = 0; k < 2 && q.found; k++) laves__branches_join(s->all, a->branch[k], q.twin[k]);
  return q.found;
}

/* reach: how far the crease may be from the start; near: how near a piece that has been found must be to be the same. */
static void trace(laves__crease_search *s, laves__vec3 start, int32_t a, int32_t b, double reach, double near) {
  spot first = {.p = start, .branch = {a, b}};
  if (!put_on_crease(s, first.branch, reach, &first.p)) return;
  look_around(s, &first);
  if (first.meeting == NOT_MET) return;
  if (first.turn < s->wish->angle) {
    note_weak(s, &first);
    return;
  }
  if (piece_near(s->all, first.p, near, a, b) != LAVES__NONE || has_twin(s, &first, near)) return;
  if (!leads_on(s, &first) || !add_point(s, &first)) return;
  if (!follow(s, &first, 1)) follow(s, &first, -1);
}

void laves__crease_trace(laves__crease_search *s, laves__vec3 start, int32_t a, int32_t b) {
  trace(s, start, a, b, s->all->size, found_before * s->sagitta);
}

/* Ends that came when the cells around were still to be searched. */
static void tie_loose_ends(laves__crease_search *s) {
  for (size_t i = 0; i < s->loose_count && laves__search_goes_on(s); i++) {
    const laves__loose_end end = s->loose[i];
    spot last = {.p = end.p, .branch = {end.branch[0], end.branch[1]}, .point = end.point};
    look_around(s, &last);
    if (last.meeting == NOT_MET) continue;
    const rivals r = find_rivals(s, v3_mad(last.p, last.tangent, 2 * end.way * s->probe));
    laves__vec3 corner;
    spot there = last;
    if (!find_corner(s, &last, &r, &corner) || !laves__corner_add(s, corner, &there.point)) continue;
    there.p = s->lines->point[there.point];
    add_step(s, &last, &there, end.way);
  }
}

void laves__corners_complete(laves__crease_search *s) {
  tie_loose_ends(s);
  for (size_t i = 0; i < s->corner_grid.count && laves__search_goes_on(s); i++) { /* corners are added on the way */
    const laves__vec3 p = s->corner_grid.at[i];
    const rivals r = find_rivals(s, p);
    for (int k = 0; k < r.count * r.count; k++) {
      const int32_t a = r.branch[k / r.count], b = r.branch[k % r.count];
      if (a == b) continue; /* both orders: the crease may leave on either side */
      const laves__vec3 along =
          v3_unit(v3_cross(laves__tape_gradient(tape_of(s, a), p).gradient, laves__tape_gradient(tape_of(s, b), p).gradient));
      trace(s, v3_mad(p, along, corner_reach * s->probe), a, b, ahead * s->probe, ahead * s->probe);
    }
  }
}

/* ---- weak borders ---- */

void laves__weak_borders_join(laves__crease_search *s) {
  for (size_t i = 0; i < s->weak_count; i++) {
    const laves__weak_border *w = &s->weak[i];
    if (piece_near(s->all, w->p, found_before * s->sagitta, w->branch[0], w->branch[1]) == LAVES__NONE)
      laves__branches_join(s->all, w->branch[0], w->branch[1]);
  }
}
