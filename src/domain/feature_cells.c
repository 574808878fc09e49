/* The search for borders between branches.
 *
 * An octree down to the wished size; intervals drop cells that the surface misses, and cut the tape to what matters in
 * and around the cell. Where no choice is left open there is one branch and nothing to find. In the smallest cells that are
 * left, a few points are put on the surface; each tells its branch. Between feet of different branches halving finds
 * the border: smooth, and the branches are one patch, or sharp, and a crease is followed from there. */
#include <string.h>

#include "domain/elementary.h"
#include "domain/feature_implicit.h"

/* Feet are looked for from the middle of a cell and from eight points around it. */
enum {
  FEET = 9,
  BESIDE = 6,
  LOOKED = 2,
  FEET_MAX = FEET + LOOKED * BESIDE,
  ROUNDS = 4,
  BISECTION_LIMIT = 40,
  TIP_DIRECTIONS = 26
};
/* How far beyond a cell codes are valid and feet are taken, in widths; and how near to the surface (parts of the diagonal) a foot
 * must be for its branch to be told, which is looked at a thousand times deeper. */
static const double margin = 0.25, near_enough = 1e-9;
/* Walks go by half sizes or this part of the diagonal, whichever is less. */
static const double walk_step = 0.005;
/* From how many patches is walked, how many steps, in how many directions. */
enum { WALK_LIMIT = 4096, WALK_STEPS = 32, WALK_DIRECTIONS = 27 };
/* The eight points' place between the middle (0) and the cell's corners (1). */
static const double spread = 0.75;
/* How far beside a foot that tells nothing others are looked for, in widths of the cell and its surroundings. */
static const double beside = 0.1;
/* A foot between two that is further from both than this part of their distance is on another sheet. */
static const double no_nearer = 0.95;
/* Around tips normals are compared so many probes away; a tip is on the surface where the value is below this part of the
 * diagonal. */
static const double tip_radius = 8, zero_part = 1e-9;
/* Feet of different branches closer than this part of the size lie on both sides of their border. */
static const double adjacent = 1e-3;
/* Smooth borders that are known are not looked at where normals turn by less than this part of the wished angle. */
static const double plainly_smooth = 0.5;
/* Borders found by halving are smooth where the normals turn by less than this part of it. */
static const double plainly_joined = 0.2;

/* By this part a function may differ from a linear one over the depth at which it is looked at, and still be smooth. */
static const double unlike = 0.05;

typedef struct labelled_foot {
  laves__vec3 p, normal;
  int32_t branch;
} labelled_foot;

/* ---- the forest of branches that are one patch ---- */

int32_t laves__branch_root(const laves__implicit_features *all, int32_t branch) {
  while (all->patch[branch] != branch) branch = all->patch[branch];
  return branch;
}

/* The lesser number becomes the root, so that the order of joining does not matter. */
void laves__branches_join(laves__implicit_features *all, int32_t a, int32_t b) {
  const int32_t ra = laves__branch_root(all, a), rb = laves__branch_root(all, b), root = ra < rb ? ra : rb;
  all->patch[ra] = all->patch[rb] = root;
  while (all->patch[a] != root) { /* shortens the ways */
    const int32_t next = all->patch[a];
    all->patch[a] = root;
    a = next;
  }
  while (all->patch[b] != root) {
    const int32_t next = all->patch[b];
    all->patch[b] = root;
    b = next;
  }
}

static bool enter_branches(laves__crease_search *s, size_t known) {
  laves__implicit_features *all = s->all;
  const size_t count = all->branches.count;
  if (!laves__grow(s->context, &all->patch, &all->branch_capacity, count, sizeof *all->patch) ||
      !laves__grow(s->context, &all->seen, &all->seen_capacity, count, sizeof *all->seen) ||
      !laves__grow(s->context, &s->sample, &s->sample_capacity, count, sizeof *s->sample)) {
    s->out_of_memory = true;
    return false;
  }
  for (size_t i = known; i < count; i++) {
    all->patch[i] = (int32_t)i;
    all->seen[i] = false;
  }
  return true;
}

bool laves__branch_passes(const laves__tape *f, laves__vec3 foot, double depth, laves__vec3 *normal) {
  const laves__dual at = laves__tape_gradient(f, foot);
  const double slope = v3_norm(at.gradient);
  *normal = v3_unit(at.gradient);
  if (!(slope > 0) || fabs(at.value) > unlike * depth * slope) return false;
  const laves__vec3 inside = v3_mad(foot, *normal, -depth);
  double phi;
  laves__tape_evaluate(f, 1, &inside, &phi);
  return fabs(phi + depth * slope) <= unlike * depth * slope;
}

/* Whether the solid is on one side of a foot only: parts that touch, face to face, have none of it between them. */
static bool parts_space(const laves__tape *solid, laves__vec3 foot, laves__vec3 normal, double depth) {
  const laves__vec3 sides[2] = {v3_mad(foot, normal, -depth), v3_mad(foot, normal, depth)};
  double phi[2];
  laves__tape_evaluate(solid, 2, sides, phi);
  return phi[0] < 0 && phi[1] > 0;
}

/* Inside first; where the function there does not pass through the foot (a rounded corner that only the outside of a box
 * has, met within the depth of its edge) the outside is asked. */
int32_t laves__branch_of_foot(laves__crease_search *s, const laves__code *code, laves__vec3 foot, laves__vec3 *normal,
                              double depth) {
  laves__branches *branches = &s->all->branches;
  s->work += 8 * (double)code->tape.count;
  if (s->out_of_memory) return LAVES__NO_BRANCH; /* the last branch may have no place in the lists */
  if (!parts_space(&code->tape, foot, *normal, depth)) return LAVES__NO_BRANCH;
  for (int side = -1; side <= 1; side += 2) {
    laves__signature signature;
    if (!laves__signature_at(s->context, branches->whole, code, v3_mad(foot, *normal, side * depth), &s->room, &signature)) {
      s->out_of_memory = true;
      return LAVES__NO_BRANCH;
    }
    const size_t known = branches->count;
    const int32_t b = laves__branches_add(branches, &signature);
    s->out_of_memory = s->out_of_memory || branches->out_of_memory;
    if (branches->count > known && !enter_branches(s, known)) return LAVES__NO_BRANCH;
    if (b == LAVES__NO_BRANCH) continue;
    laves__vec3 own;
    if (!laves__branch_passes(&branches->tape[b], foot, depth, &own)) continue;
    *normal = own;
    if (!s->all->seen[b]) s->sample[b] = foot;
    s->all->seen[b] = true;
    return b;
  }
  return LAVES__NO_BRANCH;
}

/* ---- borders ---- */

static bool find_foot(const laves__crease_search *s, const laves__code *code, laves__vec3 from, double reach,
                      labelled_foot *found) {
  laves__dual there;
  if (!laves__tape_foot(&code->tape, s->all->solid.diagonal, from, reach, &found->p, &there)) return false;
  found->normal = v3_unit(there.gradient);
  return true;
}

static bool label_foot(laves__crease_search *s, const laves__code *code, labelled_foot *foot) {
  foot->branch = laves__branch_of_foot(s, code, foot->p, &foot->normal, s->probe);
  return foot->branch != LAVES__NO_BRANCH;
}

static bool turns_less(const laves__crease_search *s, laves__vec3 a, laves__vec3 b, double part) {
  const double turn = 57.29577951308232 * laves__angle(v3_norm(v3_cross(a, b)), v3_dot(a, b));
  return turn < part * s->wish->angle;
}

/* Halves the way between two feet until they stand on both sides of a border. */
static void cross_border(laves__crease_search *s, const laves__code *code, labelled_foot a, labelled_foot b) {
  const laves__implicit_features *all = s->all;
  if (laves__branch_root(all, a.branch) == laves__branch_root(all, b.branch) && turns_less(s, a.normal, b.normal, plainly_smooth))
    return;
  const double close = adjacent * all->size;
  for (int i = 0; i < BISECTION_LIMIT; i++) {
    const double distance = v3_distance(a.p, b.p);
    labelled_foot m;
    if (distance <= close) break;
    if (!find_foot(s, code, v3_lerp(a.p, b.p, 0.5), distance, &m) || !label_foot(s, code, &m)) break;
    if (v3_distance(m.p, a.p) > no_nearer * distance && v3_distance(m.p, b.p) > no_nearer * distance) break;
    if (m.branch == a.branch)
      a = m;
    else
      b = m;
  }
  if (v3_distance(a.p, b.p) <= close && turns_less(s, a.normal, b.normal, plainly_joined))
    laves__branches_join(s->all, a.branch, b.branch);
  else
    laves__crease_trace(s, v3_lerp(a.p, b.p, 0.5), a.branch, b.branch);
}

/* ---- tips ---- */

/* A tape for the value of an operand of instruction k. `room` serves for bare coordinates. */
static laves__tape operand_tape(const laves__tape *tape, size_t k, int operand, laves__instruction *room) {
  laves__tape part = *tape;
  const uint16_t reg = tape->instructions[k].operand[operand];
  for (size_t i = k; i-- > 0;)
    if (tape->instructions[i].out == reg) {
      part.count = i + 1;
      return part;
    }
  *room = (laves__instruction){.op = LAVES__OP_ADD, .out = 3, .operand = {reg, LAVES__OPERAND_CONSTANT, 0}};
  part.instructions = room;
  part.count = 1;
  return part;
}

/* Whether the surface around p turns by more than the wished angle. */
static bool is_pointed(laves__crease_search *s, laves__vec3 p) {
  laves__vec3 normal[TIP_DIRECTIONS + 1];
  const laves__code *code = laves__local_code(s, p);
  int count = 0;
  for (int k = 0; k <= TIP_DIRECTIONS; k++) {
    const laves__vec3 direction = v3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    laves__dual there;
    laves__vec3 foot;
    if (!laves__tape_foot(&code->tape, s->all->solid.diagonal, v3_mad(p, v3_unit(direction), tip_radius * s->probe),
                          2 * tip_radius * s->probe, &foot, &there))
      continue;
    normal[count] = v3_unit(there.gradient);
    for (int i = 0; i < count; i++)
      if (!turns_less(s, normal[i], normal[count], 1)) return true;
    count++;
  }
  return false;
}

/* The point of the surface where the vector of a norm vanishes, so that the function has no slope: the tip of a cone. The
 * norm itself is taken as zero meanwhile. */
static bool find_tip(laves__crease_search *s, const laves__tape *tape, size_t k, laves__vec3 *p) {
  laves__instruction room[3];
  laves__tape part[3];
  const laves__tape *f[3] = {&part[0], &part[1], &part[2]};
  const laves__instruction *norm = &tape->instructions[k];
  const double diagonal = s->all->solid.diagonal, reach = 2 * s->all->size;
  int count = norm->op == LAVES__OP_SQRT ? 1 : laves__op_operands[norm->op];
  for (int i = 0; i < count && norm->op != LAVES__OP_SQRT; i++) {
    if (norm->operand[i] == LAVES__OPERAND_CONSTANT) return false;
    part[i] = operand_tape(tape, k, i, &room[i]);
  }
  if (count == 3) return laves__tapes_meet(f, 3, diagonal, reach, p);
  if (count == 1) { /* a root's own slope leads straight to where it vanishes */
    part[0] = *tape;
    part[0].count = k + 1;
  }
  laves__instruction *copy = laves__alloc(s->context, tape->count, sizeof *copy);
  if (!copy) {
    s->out_of_memory = true;
    return false;
  }
  memcpy(copy, tape->instructions, tape->count * sizeof *copy);
  copy[k] = (laves__instruction){.op = LAVES__OP_MUL, .out = norm->out, .operand = {0, LAVES__OPERAND_CONSTANT, 0}};
  part[count] = *tape;
  part[count].instructions = copy;
  const bool found = laves__tapes_meet(f, count + 1, diagonal, reach, p);
  laves__free(s->context, copy, tape->count, sizeof *copy);
  return found;
}

static bool is_fixed(const laves__feature_lines *lines, uint32_t point) {
  for (size_t i = lines->fixed_count; i-- > 0;)
    if (lines->fixed[i].point == point) return true;
  return false;
}

/* The patch of a fixed point is the branch until patches are numbered. */
static void find_tips(laves__crease_search *s, laves__box3 around, int32_t branch) {
  const laves__tape tape = s->all->branches.tape[branch]; /* the store may move while branches are added */
  const laves__vec3 c = box3_centre(around);
  for (size_t k = 0; k < tape.count; k++) {
    const uint16_t op = tape.instructions[k].op;
    if (op != LAVES__OP_NORM2 && op != LAVES__OP_NORM3 && op != LAVES__OP_SQRT) continue;
    laves__tape norm = tape;
    norm.count = k + 1;
    const laves__dual at = laves__tape_gradient(&norm, c);
    if (at.value > v3_norm(at.gradient) * box3_diagonal(around)) continue;
    laves__vec3 p = c;
    double phi;
    uint32_t point;
    if (!find_tip(s, &tape, k, &p)) continue;
    if (!(p.x >= around.lower.x && p.y >= around.lower.y && p.z >= around.lower.z && p.x <= around.upper.x &&
          p.y <= around.upper.y && p.z <= around.upper.z))
      continue;
    laves__tape_evaluate(&laves__local_code(s, p)->tape, 1, &p, &phi);
    if (fabs(phi) > zero_part * s->all->solid.diagonal || !is_pointed(s, p)) continue;
    if (!laves__corner_add(s, p, &point) || is_fixed(s->lines, point)) continue;
    if (!laves__feature_lines_fix(s->lines, point, branch)) s->out_of_memory = true;
  }
}

/* ---- cells ---- */

/* A cell and what is around it. */
static laves__box3 grown(laves__box3 cell) {
  const laves__vec3 by = v3_scale(v3_sub(cell.upper, cell.lower), margin);
  return (laves__box3){v3_sub(cell.lower, by), v3_add(cell.upper, by)};
}

static bool holds(laves__box3 box, laves__vec3 p) {
  return p.x >= box.lower.x && p.x <= box.upper.x && p.y >= box.lower.y && p.y <= box.upper.y && p.z >= box.lower.z &&
         p.z <= box.upper.z;
}

/* A cell of one branch: notes that it has a part of the surface, if a foot can be found. */
static bool see_branch(laves__crease_search *s, const laves__code *code, laves__box3 cell) {
  labelled_foot foot;
  const laves__vec3 c = box3_centre(cell);
  return find_foot(s, code, c, v3_distance(c, cell.upper), &foot) && holds(grown(cell), foot.p) && label_foot(s, code, &foot);
}

/* The middle, a tetrahedron of points around it, and the opposite one. */
static void place_points(laves__box3 cell, laves__vec3 *points) {
  static const int corner[FEET - 1] = {0, 3, 5, 6, 7, 4, 2, 1};
  const laves__vec3 c = box3_centre(cell), out = v3_scale(v3_sub(cell.upper, c), spread);
  points[0] = c;
  for (int k = 0; k < FEET - 1; k++) {
    const int i = corner[k];
    points[k + 1] = v3_add(c, v3(i & 1 ? out.x : -out.x, i & 2 ? out.y : -out.y, i & 4 ? out.z : -out.z));
  }
}

/* Plain Newton steps, all points side by side; done[i]: the i-th is at the surface. */
static void step_to_surface(const laves__crease_search *s, const laves__code *code, int count, double longest, laves__vec3 *p,
                            laves__dual *at, bool *done) {
  for (int round = 0;; round++) {
    bool all_done = true;
    for (int i = 0; i < count; i++) {
      const double slope2 = v3_norm2(at[i].gradient);
      done[i] = fabs(at[i].value) <= near_enough * s->all->solid.diagonal * sqrt(slope2) && slope2 > 0;
      all_done = all_done && done[i];
      if (!done[i] && round < ROUNDS && fabs(at[i].value) < longest * sqrt(slope2))
        p[i] = v3_mad(p[i], at[i].gradient, -at[i].value / slope2);
    }
    if (all_done || round == ROUNDS) return;
    laves__tape_gradients(&code->tape, (size_t)count, p, at);
  }
}

/* Outside of a box points have feet on its edges, where no branch goes through; those around them tell. */
static int look_beside(laves__crease_search *s, const laves__code *code, laves__box3 around, laves__vec3 foot,
                       labelled_foot *feet) {
  const double away = beside * (around.upper.x - around.lower.x);
  int count = 0;
  for (int k = 0; k < BESIDE; k++) {
    laves__vec3 from = foot;
    *v3_slot(&from, k / 2) += k % 2 ? away : -away;
    if (find_foot(s, code, from, 2 * away, &feet[count]) && holds(around, feet[count].p))
      count += label_foot(s, code, &feet[count]);
  }
  return count;
}

/* Feet in and around a cell, with their branches: feet[FEET_MAX]. *smooth: the gradient turns so little over the cell that no
 * crease is likely; then there are fewer. */
static int find_feet(laves__crease_search *s, const laves__code *code, laves__box3 cell, labelled_foot *feet, bool *smooth) {
  laves__vec3 start[FEET], p[FEET];
  laves__dual at[FEET];
  bool done[FEET];
  const laves__box3 around = grown(cell);
  const double reach = v3_distance(cell.lower, cell.upper);
  place_points(cell, start);
  memcpy(p, start, sizeof p);
  laves__tape_gradients(&code->tape, FEET, p, at);
  *smooth = true;
  for (int i = 1; i < FEET && *smooth; i++) *smooth = turns_less(s, at[0].gradient, at[i].gradient, plainly_smooth);
  const int tried = *smooth ? 1 + (FEET - 1) / 2 : FEET;
  step_to_surface(s, code, tried, reach, p, at, done);
  int count = 0, looked = 0;
  for (int i = 0; i < tried; i++) {
    labelled_foot *foot = &feet[count];
    *foot = (labelled_foot){p[i], v3_unit(at[i].gradient), LAVES__NO_BRANCH};
    if (!done[i] && !find_foot(s, code, start[i], reach, foot)) continue;
    if (!holds(around, foot->p)) continue;
    if (label_foot(s, code, foot))
      count++;
    else if (looked++ < LOOKED)
      count += look_beside(s, code, around, foot->p, foot);
  }
  return count;
}

/* The first foot of each branch goes to the front; returns how many branches there are. */
static int sort_out(labelled_foot *feet, int count) {
  int branches = 0;
  for (int i = 0; i < count; i++) {
    int k = 0;
    while (k < branches && feet[k].branch != feet[i].branch) k++;
    if (k < branches) continue;
    const labelled_foot swap = feet[branches];
    feet[branches++] = feet[i];
    feet[i] = swap;
  }
  return branches;
}

static void add_sites(laves__crease_search *s, const labelled_foot *feet, int branches) {
  laves__implicit_features *all = s->all;
  for (int i = 0; i < branches && !s->out_of_memory; i++) {
    const size_t count = all->site_grid.count;
    s->out_of_memory = !laves__grow(s->context, &all->site_branch, &all->site_capacity, count + 1, sizeof *all->site_branch) ||
                       !laves__point_grid_add(&all->site_grid, feet[i].p);
    if (!s->out_of_memory) all->site_branch[count] = feet[i].branch;
  }
}

/* The nearest pair of feet of two branches. */
static void cross_between(laves__crease_search *s, const laves__code *code, const labelled_foot *feet, int count, int32_t a,
                          int32_t b) {
  double least = INFINITY;
  labelled_foot best_a = feet[0], best_b = feet[0];
  for (int i = 0; i < count; i++)
    for (int j = 0; feet[i].branch == a && j < count; j++) {
      const double distance = v3_distance(feet[i].p, feet[j].p);
      if (feet[j].branch != b || distance >= least) continue;
      least = distance;
      best_a = feet[i];
      best_b = feet[j];
    }
  cross_border(s, code, best_a, best_b);
}

/* In smooth cells only branches are compared that are not known to be one patch. */
static void search_cell(laves__crease_search *s, const laves__code *code, laves__box3 cell) {
  labelled_foot feet[FEET_MAX];
  bool smooth;
  const int count = find_feet(s, code, cell, feet, &smooth), branches = sort_out(feet, count);
  if (branches > 1) add_sites(s, feet, branches);
  for (int i = 0; i < branches; i++)
    for (int j = 0; j < i && !s->out_of_memory; j++)
      if (!smooth || laves__branch_root(s->all, feet[i].branch) != laves__branch_root(s->all, feet[j].branch))
        cross_between(s, code, feet, count, feet[j].branch, feet[i].branch);
  for (int i = 0; i < branches && code->norm_count > 0 && !s->out_of_memory; i++) find_tips(s, grown(cell), feet[i].branch);
}

/* ---- walks ---- */

/* Where a branch was met and is not met again, it is thinner than the depth at which branches are told. */
static void join_at_once(laves__crease_search *s, int32_t branch, const labelled_foot *here) {
  if (here->branch == branch) return;
  const laves__vec3 normal = laves__tape_gradient(&s->all->branches.tape[branch], here->p).gradient;
  if (turns_less(s, normal, here->normal, plainly_joined)) laves__branches_join(s->all, branch, here->branch);
}

/* From a point of a patch straight ahead over the surface until a crease comes.
 * So slivers between cells come to their patches, and creases are met that all cells missed. */
static void walk_away(laves__crease_search *s, int32_t branch, laves__vec3 direction) {
  const double step = min_of(0.5 * s->all->size, walk_step * s->all->solid.diagonal);
  const laves__code *code = laves__local_code(s, s->sample[branch]);
  labelled_foot here, next;
  if (!find_foot(s, code, s->sample[branch], step, &here) || !label_foot(s, code, &here)) return;
  join_at_once(s, branch, &here);
  for (int i = 0; i < WALK_STEPS && laves__search_goes_on(s); i++) {
    code = laves__local_code(s, here.p);
    const laves__vec3 along = v3_unit(v3_mad(direction, here.normal, -v3_dot(direction, here.normal)));
    if (!find_foot(s, code, v3_mad(here.p, along, step), step, &next) || !label_foot(s, code, &next)) return;
    if (laves__branch_root(s->all, here.branch) != laves__branch_root(s->all, next.branch)) {
      cross_border(s, code, here, next);
      if (laves__branch_root(s->all, here.branch) != laves__branch_root(s->all, next.branch)) return;
    }
    direction = along;
    here = next;
  }
}

void laves__search_walks(laves__crease_search *s) {
  const laves__implicit_features *all = s->all;
  int walks = 0;
  for (size_t b = 0; b < all->branches.count && walks < WALK_LIMIT; b++) {
    if (!all->seen[b] || laves__branch_root(all, (int32_t)b) != (int32_t)b) continue;
    for (int k = 0; k < WALK_DIRECTIONS && laves__branch_root(all, (int32_t)b) == (int32_t)b; k++) {
      if (k == WALK_DIRECTIONS / 2) continue; /* all around a cube, but not from its middle to its middle */
      walk_away(s, (int32_t)b, v3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
      walks++;
    }
  }
}

/* How many of the smallest cells are searched at most; then cells twice as wide are taken. */
enum { CELL_LIMIT = 2000000, DEPTH_LIMIT = 12 };

/* What the cells take of the whole search, roughly. */
static const double cells_part = 0.9;

static void visit(laves__crease_search *s, laves__box3 cell, int level, int depth) {
  if (!laves__search_goes_on(s) || s->crowded) return;
  const laves__code *code = &s->level[level];
  s->work += 2 * (double)code->tape.count;
  bool may_be_nan;
  const laves__interval value = laves__tape_interval(&code->tape, cell, &may_be_nan);
  if (!may_be_nan && (value.lower > 0 || value.upper < 0)) return;
  if (!laves__code_cut(s->context, code, grown(cell), &s->room, &s->level[level + 1])) {
    s->out_of_memory = true;
    return;
  }
  code = &s->level[level + 1];
  if (code->open_count == 0 && see_branch(s, code, cell)) return;
  if (level == depth) {
    s->crowded = ++s->cell_count > CELL_LIMIT || s->work > LAVES__CELL_WORK;
    if (code->open_count > 0) search_cell(s, code, cell);
    return;
  }
  const laves__vec3 c = box3_centre(cell);
  for (int i = 0; i < 8; i++) {
    const laves__box3 part = {{i & 1 ? c.x : cell.lower.x, i & 2 ? c.y : cell.lower.y, i & 4 ? c.z : cell.lower.z},
                              {i & 1 ? cell.upper.x : c.x, i & 2 ? cell.upper.y : c.y, i & 4 ? cell.upper.z : c.z}};
    visit(s, part, level + 1, depth);
    if (level == 1) s->fraction += cells_part / 64;
  }
}

/* The middle is off by a little, so that planes of symmetry do not run between cells. */
static laves__box3 root_cell(const laves__implicit_features *all, double *width) {
  const laves__vec3 widths = v3_sub(all->solid.bounds.upper, all->solid.bounds.lower);
  *width = max_of(widths.x, max_of(widths.y, widths.z)) * 1.02;
  const laves__vec3 half = v3_scale(v3(*width, *width, *width), 0.5);
  const laves__vec3 c = v3_mad(box3_centre(all->solid.bounds), v3(0.0031, 0.0047, 0.0059), *width);
  return (laves__box3){v3_sub(c, half), v3_add(c, half)};
}

static void forget(laves__crease_search *s) {
  laves__implicit_features *all = s->all;
  laves_context *context = s->context;
  const double piece_width = all->piece_grid.width, site_width = all->site_grid.width, corner_width = s->corner_grid.width;
  laves__point_grid_free(&all->piece_grid);
  laves__point_grid_free(&all->site_grid);
  laves__point_grid_free(&s->corner_grid);
  laves__point_grid_init(&all->piece_grid, context, piece_width);
  laves__point_grid_init(&all->site_grid, context, site_width);
  laves__point_grid_init(&s->corner_grid, context, corner_width);
  s->lines->point_count = s->first_point;
  s->lines->fixed_count = s->first_fixed;
  s->weak_count = s->loose_count = 0;
  s->cell_count = 0;
  s->work = s->fraction = 0;
  s->crowded = false;
}

void laves__search_cells(laves__crease_search *s) {
  double width;
  const laves__box3 root = root_cell(s->all, &width);
  int depth = 0;
  while (depth < DEPTH_LIMIT && width > s->all->size) {
    width *= 0.5;
    depth++;
  }
  laves__code level[DEPTH_LIMIT + 2];
  memset(level, 0, sizeof level);
  s->level = level;
  level[0] = s->all->whole;
  visit(s, root, 0, depth);
  while (s->crowded && !s->out_of_memory && !s->cancelled && depth > 1) {
    forget(s);
    visit(s, root, 0, --depth);
  }
  for (int i = 1; i < DEPTH_LIMIT + 2; i++) laves__code_free(s->context, &level[i]);
  s->level = NULL;
}
