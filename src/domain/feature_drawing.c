/* Drawn points are put on the surface, and drawn lines are cut to pieces that follow it.
 *
 * A point that is on the surface but for rounding stays where it is; else it goes to its foot. Between two points of a line the
 * chord is halved, the middle put on the surface, until the chord's middle and quarters are near enough. A chord that spans a gap
 * never comes near, however short its half: then the line leaves the surface, which is an error. */
#include <stdio.h>
#include <string.h>

#include "domain/feature_lines.h"

/* Halvings of one stretch: a chord of the diagonal is shorter than twice LAVES__DRAWN_FOLLOW after 15, and then is near by
 * itself. Feet do not halve exactly: at an edge of the surface only each second one helps. */
enum { DEPTH_LIMIT = 64, PIECES_LIMIT = 1 << 16, PARTS_LIMIT = 1 << 10 };

/* Of the diagonal: gaps that are wider are found. */
static const double probe_step = 1.0 / 128;

typedef struct tracer {
  laves__drawing *drawing;
  const laves_features *drawn;
  size_t line, vertex; /* of the user's, for messages; line SIZE_MAX: a single point */
  uint32_t hint;
  size_t pieces; /* of the stretch */
  laves_error *error;
} tracer;

static bool project(tracer *t, laves__vec3 p, double reach, laves__vec3 *foot) {
  laves__vec3 normal;
  const laves__oracle *o = t->drawing->oracle;
  return o->project(o->self, p, reach, &t->hint, foot, &normal) && v3_finite(*foot);
}

static laves_result add_node(tracer *t, laves__vec3 place) {
  laves__drawing *d = t->drawing;
  if (!laves__grow(d->context, &d->node, &d->node_capacity, d->node_count + 1, sizeof *d->node))
    return laves__fail_memory(d->context, t->error);
  d->node[d->node_count++] = place;
  if (d->node_count % 1024 == 0 && laves__cancelled(d->context, "features", 0)) return laves__fail_cancelled(t->error);
  return LAVES_OK;
}

static bool is_same(const laves__drawing *d, laves__vec3 a, laves__vec3 b) {
  return v3_distance(a, b) <= LAVES__DRAWN_SAME * d->diagonal;
}

/* ---- points ---- */

static laves_result fail_off(tracer *t, laves__vec3 input, double distance) {
  char where[120], far[80] = "far";
  if (t->line == SIZE_MAX)
    snprintf(where, sizeof where, "point %zu", t->vertex + 1);
  else
    snprintf(where, sizeof where, "point %zu of line %zu", t->vertex + 1, t->line + 1);
  if (isfinite(distance)) snprintf(far, sizeof far, "%.3g", distance);
  return laves__fail(t->error, LAVES_ERROR_INPUT,
                     "the features drawn: %s (counted from 1), at (%.9g, %.9g, %.9g), is %s off the surface, but at most %.3g is "
                     "allowed (%g of the diagonal of the solid's box); draw it on the surface",
                     where, input.x, input.y, input.z, far, LAVES__DRAWN_OFF * t->drawing->diagonal, LAVES__DRAWN_OFF);
}

/* The place on the surface that a drawn point means. */
static laves_result place_point(tracer *t, laves__vec3 input, laves__vec3 *place) {
  const laves__drawing *d = t->drawing;
  const laves__vec3 p = v3_sub(input, d->oracle->origin);
  const double limit = LAVES__DRAWN_OFF * d->diagonal;
  laves__vec3 foot;
  if (project(t, p, limit, &foot) && v3_distance(p, foot) <= limit) {
    *place = v3_distance(p, foot) <= LAVES__DRAWN_EXACT * d->diagonal ? p : foot;
    return LAVES_OK;
  }
  const double far = 2 * (d->diagonal + v3_distance(p, box3_centre(d->oracle->bounds)));
  t->hint = LAVES__NO_HINT;
  const bool found = isfinite(far) && project(t, p, far, &foot);
  return fail_off(t, input, found ? v3_distance(p, foot) : INFINITY);
}

static laves_result trace_singles(tracer *t) {
  laves__drawing *d = t->drawing;
  laves_result result = LAVES_OK;
  t->line = SIZE_MAX;
  d->single_first = d->node_count;
  for (size_t i = 0; i < t->drawn->point_count && result == LAVES_OK; i++) {
    laves__vec3 place;
    t->vertex = i;
    t->hint = LAVES__NO_HINT;
    result = place_point(t, t->drawn->point[i], &place);
    if (result == LAVES_OK) result = add_node(t, place);
  }
  return result;
}

/* ---- lines ---- */

/* Whether a place of the chord is near the surface; its foot is near that of places near by. */
static bool is_near(tracer *t, laves__vec3 p, double reach, laves__vec3 *foot, bool *found) {
  *found = project(t, p, reach, foot);
  return *found && v3_distance(p, *foot) <= LAVES__DRAWN_FOLLOW * t->drawing->diagonal;
}

/* Whether the chord is near the surface all along: at its middle and quarters, and in steps that no gap of their width escapes.
 * *middle receives the middle's foot; *lost: it has none. */
static bool follows(tracer *t, laves__vec3 a, laves__vec3 b, laves__vec3 *middle, bool *lost) {
  const double length = v3_distance(a, b), step = probe_step * t->drawing->diagonal;
  laves__vec3 foot;
  bool found, near = is_near(t, v3_lerp(a, b, 0.5), length, middle, &found);
  int parts = 4;
  *lost = !found;
  while (parts < PARTS_LIMIT && length > parts * step) parts *= 2;
  for (int i = 1; i < parts && near; i++) near = is_near(t, v3_lerp(a, b, (double)i / parts), length, &foot, &found);
  return near;
}

static laves_result fail_jump(const tracer *t, laves__vec3 a) {
  const laves__vec3 input = v3_add(a, t->drawing->oracle->origin);
  return laves__fail(t->error, LAVES_ERROR_INPUT,
                     "the features drawn: line %zu (counted from 1) leaves the surface near (%.9g, %.9g, %.9g), between its "
                     "points %zu and %zu; draw it with more points, or as two lines",
                     t->line + 1, input.x, input.y, input.z, t->vertex, t->vertex + 1);
}

/* The nodes behind a, up to b. */
static laves_result trace_chord(tracer *t, laves__vec3 a, laves__vec3 b, int depth) {
  laves__vec3 middle;
  bool lost = false;
  const bool is_short = v3_distance(a, b) <= 2 * LAVES__DRAWN_FOLLOW * t->drawing->diagonal;
  if (is_short || follows(t, a, b, &middle, &lost)) {
    t->pieces++;
    return add_node(t, b);
  }
  if (lost || depth == DEPTH_LIMIT || t->pieces >= PIECES_LIMIT) return fail_jump(t, a);
  if (is_same(t->drawing, a, middle) || is_same(t->drawing, middle, b)) return fail_jump(t, a);
  const laves_result result = trace_chord(t, a, middle, depth + 1);
  return result == LAVES_OK ? trace_chord(t, middle, b, depth + 1) : result;
}

/* Where the last node is the first again, it goes. */
static void close_line(const laves__drawing *d, laves__drawn_line *line, size_t *node_count) {
  if (line->count < 4) return;
  const laves__vec3 first = d->node[line->first], last = d->node[*node_count - 1];
  if (!is_same(d, first, last)) return;
  line->closed = true;
  line->count--;
  (*node_count)--;
}

static laves_result trace_line(tracer *t, size_t index) {
  laves__drawing *d = t->drawing;
  const size_t first = index ? t->drawn->line_end[index - 1] : 0, end = t->drawn->line_end[index];
  laves__drawn_line *line = &d->line[index];
  laves__vec3 last = v3(0, 0, 0), place;
  laves_result result = LAVES_OK;
  t->line = index;
  t->hint = LAVES__NO_HINT;
  *line = (laves__drawn_line){.first = d->node_count};
  for (size_t i = first; i < end && result == LAVES_OK; i++) {
    t->vertex = i - first;
    t->pieces = 0;
    result = place_point(t, t->drawn->vertex[i], &place);
    if (result != LAVES_OK || (i > first && is_same(d, last, place))) continue;
    result = i == first ? add_node(t, place) : trace_chord(t, last, place, 0);
    last = place;
  }
  line->count = d->node_count - line->first;
  if (result == LAVES_OK) close_line(d, line, &d->node_count);
  return result;
}

laves_result laves__drawing_trace(laves__drawing *d, const laves_features *drawn, laves_error *error) {
  tracer t = {.drawing = d, .drawn = drawn, .error = error};
  d->diagonal = box3_diagonal(d->oracle->bounds);
  d->line = laves__alloc(d->context, drawn->line_count, sizeof *d->line);
  if (!d->line && drawn->line_count > 0) return laves__fail_memory(d->context, error);
  d->line_count = drawn->line_count;
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < drawn->line_count && result == LAVES_OK; i++) result = trace_line(&t, i);
  return result == LAVES_OK ? trace_singles(&t) : result;
}

void laves__drawing_free(laves__drawing *d) {
  if (!d->context) return;
  laves__free(d->context, d->node, d->node_capacity, sizeof *d->node);
  laves__free(d->context, d->line, d->line_count, sizeof *d->line);
  memset(d, 0, sizeof *d);
}
