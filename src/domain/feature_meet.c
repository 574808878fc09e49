/* Where drawn points and lines meet creases that are there, and one another.
 *
 * Everything that can be met is an item of one tree. First each node looks for what comes before it and is near: of creases
 * rather than of drawn lines, an end of theirs or else a place between. Then each piece looks for ends of what comes before it
 * that lie on it, and for crossings. So each pair is looked at once, and what comes first gives the place, but for the exact
 * places of the user's. A line does not meet itself within a few reaches along it, where it always is near.
 *
 * Points that are one are joined by `same`; two points that were there before never become one. */
#include "domain/feature_lines.h"

#include <stdlib.h>
#include <string.h>

/* In reaches: nearer along a line it is no meeting with itself. */
static const double own_range = 8;
/* Squared sine below which two pieces run side by side and cannot cross: about 0.6 degrees. */
static const double parallel_sine2 = 1e-4;

static double reach_of(const laves__meeting *m) { return LAVES__DRAWN_MEET * m->drawing->diagonal; }

uint32_t laves__meeting_root(const laves__meeting *m, uint32_t point) {
  while (m->point[point].same != point) point = m->point[point].same;
  return point;
}

/* ---- items ---- */

static uint32_t node_point(const laves__meeting *m, size_t node) { return (uint32_t)(m->old_count + node); }

static void add_item(laves__meeting *m, uint32_t a, uint32_t b, uint32_t line) {
  m->item[m->item_count++] = (laves__meet_item){{a, b}, line};
}

static void list_items(laves__meeting *m) {
  const laves__drawing *d = m->drawing;
  const laves__feature_lines *l = m->lines;
  for (size_t i = 0; i < l->segment_count; i++) add_item(m, l->segment[i].ends[0], l->segment[i].ends[1], 0);
  for (size_t i = 0; i < l->fixed_count; i++) add_item(m, l->fixed[i].point, l->fixed[i].point, 0);
  m->piece_first = m->item_count;
  for (size_t i = 0; i < d->line_count; i++) {
    const laves__drawn_line *line = &d->line[i];
    for (size_t k = 1; k < line->count + line->closed; k++)
      add_item(m, node_point(m, line->first + k - 1), node_point(m, line->first + k % line->count), (uint32_t)i + 1);
  }
  for (size_t i = d->single_first; i < d->node_count; i++)
    add_item(m, node_point(m, i), node_point(m, i), (uint32_t)(d->line_count + 1 + i - d->single_first));
}

/* How many segments that were there end at each point. */
static void count_degrees(laves__meeting *m) {
  const laves__feature_lines *l = m->lines;
  for (size_t i = 0; i < 2 * l->segment_count; i++) {
    laves__meet_point *p = &m->point[l->segment[i / 2].ends[i % 2]];
    if (p->degree < 3) p->degree++;
  }
  for (size_t i = 0; i < l->fixed_count; i++) m->point[l->fixed[i].point].degree = 3;
}

static void list_points(laves__meeting *m) {
  const laves__drawing *d = m->drawing;
  const size_t old = m->old_count;
  m->point_count = old + d->node_count;
  for (size_t i = 0; i < m->point_count; i++)
    m->point[i] = (laves__meet_point){.place = i < old ? m->lines->point[i] : d->node[i - old], .same = (uint32_t)i};
  for (size_t i = 0; i < d->line_count; i++) {
    const laves__drawn_line *line = &d->line[i];
    double way = 0;
    for (size_t k = line->first; k < line->first + line->count; k++) {
      if (k > line->first) way += v3_distance(d->node[k - 1], d->node[k]);
      m->way[k] = way;
    }
    const size_t last = line->first + line->count - 1;
    m->line_length[i] = way + (line->closed ? v3_distance(d->node[last], d->node[line->first]) : 0);
    for (int k = 0; k < 2 && !line->closed; k++) {
      laves__meet_point *p = &m->point[node_point(m, k ? last : line->first)];
      p->fixed = p->exact = true;
    }
  }
  for (size_t i = d->single_first; i < d->node_count; i++)
    m->point[node_point(m, i)].fixed = m->point[node_point(m, i)].exact = true;
}

/* ---- the tree ---- */

static bool build_tree(laves__meeting *m) {
  laves_context *context = m->drawing->context;
  laves__vec3 *places = laves__alloc(context, m->point_count, sizeof *places);
  uint32_t(*faces)[3] = laves__alloc(context, m->item_count, sizeof *faces);
  bool done = places && faces;
  if (done) {
    for (size_t i = 0; i < m->point_count; i++) places[i] = m->point[i].place;
    for (size_t i = 0; i < m->item_count; i++) {
      faces[i][0] = m->item[i].ends[0];
      faces[i][1] = faces[i][2] = m->item[i].ends[1];
    }
    done = laves__bvh_build(context, places, (const uint32_t(*)[3])faces, m->item_count, m->order, &m->tree);
  }
  laves__free(context, places, m->point_count, sizeof *places);
  laves__free(context, faces, m->item_count, sizeof *faces);
  return done;
}

/* Who asks: a stretch of item `index`, between two ways along its line. */
typedef struct asker {
  const laves__meeting *m;
  uint32_t index;
  double way[2];
} asker;

/* Whether an item comes before the asker, and is not the same stretch of the same line. */
static bool comes_before(const asker *a, uint32_t other) {
  const laves__meeting *m = a->m;
  if (other >= a->index) return false;
  const uint32_t line = m->item[other].line;
  if (line == 0 || line != m->item[a->index].line || line > m->drawing->line_count) return true;
  const size_t old = m->old_count;
  const double from = m->way[m->item[other].ends[0] - old], to = m->way[m->item[other].ends[1] - old];
  const double range = own_range * reach_of(m);
  if (a->way[0] - to <= range) return false;
  return !m->drawing->line[line - 1].closed || m->line_length[line - 1] - a->way[1] + from > range;
}

static laves__box3 box_around(const laves__meeting *m, laves__vec3 a, laves__vec3 b) {
  const double reach = reach_of(m);
  const laves__vec3 room = v3(reach, reach, reach);
  return (laves__box3){v3_sub(v3_min(a, b), room), v3_add(v3_max(a, b), room)};
}

/* The place of an item's end, as it is by now. */
static laves__vec3 end_place(const laves__meeting *m, uint32_t item, int end) {
  return m->point[laves__meeting_root(m, m->item[item].ends[end])].place;
}

/* The point of a..b nearest to p, and where on the way it is. */
static laves__vec3 nearest_on(laves__vec3 a, laves__vec3 b, laves__vec3 p, double *share) {
  const laves__vec3 along = v3_sub(b, a);
  const double length2 = v3_norm2(along), t = length2 > 0 ? v3_dot(v3_sub(p, a), along) / length2 : 0;
  *share = t <= 0 ? 0 : t >= 1 ? 1 : t;
  return t <= 0 ? a : t >= 1 ? b : v3_mad(a, along, t);
}

/* ---- nodes ---- */

/* What is best near a node: items of creases before those of drawn lines, then the nearer, then the lesser index. */
typedef struct search {
  asker who;
  laves__vec3 place;
  uint32_t item, end_item; /* LAVES__NONE: none */
  int end;
  double distance, end_distance, share;
} search;

static bool is_better(const laves__meeting *m, uint32_t item, double distance, uint32_t best, double best_distance) {
  if (best == LAVES__NONE) return true;
  const bool was_there = m->item[item].line == 0, best_was_there = m->item[best].line == 0;
  if (was_there != best_was_there) return was_there;
  return distance != best_distance ? distance < best_distance : item < best;
}

static void look_at_item(void *user, uint32_t slot) {
  search *s = user;
  const laves__meeting *m = s->who.m;
  const uint32_t item = m->order[slot];
  const double reach = reach_of(m);
  if (!comes_before(&s->who, item)) return;
  double share;
  const laves__vec3 a = end_place(m, item, 0), b = end_place(m, item, 1);
  const double distance = v3_distance(nearest_on(a, b, s->place, &share), s->place);
  if (!(distance <= reach)) return;
  if (is_better(m, item, distance, s->item, s->distance)) {
    s->item = item;
    s->distance = distance;
    s->share = share;
  }
  for (int end = 0; end < 2; end++) {
    const double end_distance = v3_distance(end ? b : a, s->place);
    if (end_distance <= reach && is_better(m, item, end_distance, s->end_item, s->end_distance)) {
      s->end_item = item;
      s->end = end;
      s->end_distance = end_distance;
    }
  }
}

/* Whether a point may go to a place of the user's within reach: inside a crease, but not at a corner. */
static bool may_move(const laves__meeting *m, uint32_t point) {
  return point < m->old_count ? m->point[point].degree == 2 : !m->point[point].exact;
}

static bool add_cut(laves__meeting *m, uint32_t item, uint32_t point, bool own, double share) {
  if (!laves__grow(m->drawing->context, &m->cut, &m->cut_capacity, m->cut_count + 1, sizeof *m->cut)) return false;
  m->cut[m->cut_count++] = (laves__meet_cut){item, point, own, share};
  return true;
}

/* The node is another name of the end found. */
static void join_end(laves__meeting *m, uint32_t point, const search *s) {
  const uint32_t root = laves__meeting_root(m, m->item[s->end_item].ends[s->end]);
  laves__meet_point *p = &m->point[point], *to = &m->point[root];
  if (p->exact && may_move(m, root) && s->end_distance > LAVES__DRAWN_SAME * m->drawing->diagonal) {
    to->place = p->place;
    to->exact = true;
  }
  to->fixed |= p->fixed;
  to->exact |= p->exact;
  to->touched = true;
  p->same = root;
}

/* The node lies on the item found, between its ends. */
static bool join_between(laves__meeting *m, uint32_t point, const search *s) {
  laves__meet_point *p = &m->point[point];
  p->touched = true;
  if (!p->exact && m->item[s->item].line == 0) p->place = v3_lerp(end_place(m, s->item, 0), end_place(m, s->item, 1), s->share);
  return add_cut(m, s->item, point, false, s->share);
}

/* The end of an item is taken rather than a place between its ends, but for the user's own places, which must stay. */
static bool meet_node(laves__meeting *m, uint32_t point, uint32_t index, double way) {
  const laves__meet_point *p = &m->point[point];
  search s = {.who = {m, index, {way, way}}, .place = p->place, .item = LAVES__NONE, .end_item = LAVES__NONE};
  laves__bvh_overlaps(&m->tree, box_around(m, s.place, s.place), look_at_item, &s);
  if (s.item == LAVES__NONE) return true;
  const bool is_between = s.share > 0 && s.share < 1;
  const bool end_serves = s.end_item != LAVES__NONE &&
                          (!p->exact || !is_between || s.end_distance <= LAVES__DRAWN_SAME * m->drawing->diagonal) &&
                          (m->item[s.end_item].line == 0 || m->item[s.item].line != 0);
  if (end_serves) {
    join_end(m, point, &s);
    return true;
  }
  return !is_between || join_between(m, point, &s);
}

static laves_result meet_nodes(laves__meeting *m, laves_error *error) {
  const laves__drawing *d = m->drawing;
  uint32_t index = (uint32_t)m->piece_first;
  for (size_t i = 0; i < d->line_count; i++) {
    const laves__drawn_line *line = &d->line[i];
    for (size_t k = 0; k < line->count; k++) {
      const uint32_t own = index + (uint32_t)(k ? k - 1 : 0);
      if (!meet_node(m, node_point(m, line->first + k), own, m->way[line->first + k]))
        return laves__fail_memory(d->context, error);
      if (k % 1024 == 1023 && laves__cancelled(d->context, "features", 0.3)) return laves__fail_cancelled(error);
    }
    index += (uint32_t)(line->count - 1 + line->closed);
  }
  for (size_t i = d->single_first; i < d->node_count; i++)
    if (!meet_node(m, node_point(m, i), index++, 0)) return laves__fail_memory(d->context, error);
  return LAVES_OK;
}

/* ---- pieces ---- */

/* Segments a..b and c..d cross as seen along their common normal, within reach of one another: where on the way of each. */
static bool cross(laves__vec3 a, laves__vec3 b, laves__vec3 c, laves__vec3 d, double reach, double *share, double *other_share) {
  const laves__vec3 u = v3_sub(b, a), v = v3_sub(d, c), w = v3_sub(a, c);
  const double uu = v3_norm2(u), uv = v3_dot(u, v), vv = v3_norm2(v), uw = v3_dot(u, w), vw = v3_dot(v, w);
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > parallel_sine2 * uu * vv)) return false;
  const double s = (uv * vw - vv * uw) / determinant, t = (uu * vw - uv * uw) / determinant;
  if (!(s >= 0 && s <= 1 && t >= 0 && t <= 1)) return false;
  *share = s;
  *other_share = t;
  return v3_distance(v3_mad(a, u, s), v3_mad(c, v, t)) <= reach;
}

typedef struct piece_search {
  asker who;
  laves__meeting *m;
  bool short_of_memory;
} piece_search;

/* Ends of an item that lie on the piece. Returns whether there is one. */
static bool take_ends(piece_search *s, uint32_t item) {
  laves__meeting *m = s->m;
  const uint32_t piece = s->who.index;
  const laves__vec3 a = end_place(m, piece, 0), b = end_place(m, piece, 1);
  const double reach = reach_of(m);
  bool found = false;
  for (int end = 0; end < 2; end++) {
    const uint32_t root = laves__meeting_root(m, m->item[item].ends[end]);
    const laves__vec3 q = m->point[root].place;
    double share;
    if (v3_distance(nearest_on(a, b, q, &share), q) > reach) continue;
    found = true;
    if (v3_distance(q, a) <= reach || v3_distance(q, b) <= reach) continue; /* the node there has met it */
    m->point[root].touched = true;
    s->short_of_memory |= !add_cut(m, piece, root, true, share);
  }
  return found;
}

/* A new point where a piece crosses an item: on the crease that was there, else between the two. */
static bool add_crossing(laves__meeting *m, uint32_t piece, double share, uint32_t item, double other_share) {
  const laves__vec3 on = v3_lerp(end_place(m, item, 0), end_place(m, item, 1), other_share);
  laves__vec3 place = on, foot, normal;
  uint32_t hint = LAVES__NO_HINT;
  const laves__oracle *o = m->drawing->oracle;
  if (m->item[item].line != 0) {
    place = v3_lerp(on, v3_lerp(end_place(m, piece, 0), end_place(m, piece, 1), share), 0.5);
    if (o->project(o->self, place, 2 * reach_of(m), &hint, &foot, &normal)) place = foot;
  }
  if (!laves__grow(m->drawing->context, &m->point, &m->point_capacity, m->point_count + 1, sizeof *m->point)) return false;
  const uint32_t point = (uint32_t)m->point_count++;
  m->point[point] = (laves__meet_point){.place = place, .same = point, .fixed = true, .touched = true};
  return add_cut(m, piece, point, true, share) && add_cut(m, item, point, true, other_share);
}

/* Whether a place is near an end of the piece that has met something: then that is the meeting. */
static bool end_has_met(const laves__meeting *m, uint32_t piece, laves__vec3 place) {
  for (int end = 0; end < 2; end++) {
    const laves__meet_point *p = &m->point[laves__meeting_root(m, m->item[piece].ends[end])];
    if (p->touched && v3_distance(p->place, place) <= 2 * reach_of(m)) return true;
  }
  return false;
}

static bool share_an_end(const laves__meeting *m, uint32_t piece, uint32_t item) {
  for (int i = 0; i < 4; i++)
    if (laves__meeting_root(m, m->item[piece].ends[i / 2]) == laves__meeting_root(m, m->item[item].ends[i % 2])) return true;
  return false;
}

static void cross_item(void *user, uint32_t slot) {
  piece_search *s = user;
  laves__meeting *m = s->m;
  const uint32_t item = m->order[slot], piece = s->who.index;
  double share, other_share;
  if (!comes_before(&s->who, item) || take_ends(s, item) || share_an_end(m, piece, item)) return;
  const laves__vec3 a = end_place(m, piece, 0), b = end_place(m, piece, 1);
  if (!cross(a, b, end_place(m, item, 0), end_place(m, item, 1), reach_of(m), &share, &other_share)) return;
  if (end_has_met(m, piece, v3_lerp(a, b, share))) return;
  s->short_of_memory |= !add_crossing(m, piece, share, item, other_share);
}

/* The stretch of a piece along its line. */
static void ways_of(const laves__meeting *m, uint32_t piece, double way[2]) {
  const laves__meet_item *i = &m->item[piece];
  const size_t old = m->old_count;
  way[0] = m->way[i->ends[0] - old];
  way[1] = m->way[i->ends[1] - old];
  if (way[1] < way[0]) way[1] = m->line_length[i->line - 1]; /* the one that closes a line */
}

static laves_result meet_pieces(laves__meeting *m, laves_error *error) {
  laves_context *context = m->drawing->context;
  for (uint32_t i = (uint32_t)m->piece_first; i < m->item_count && m->item[i].line <= m->drawing->line_count; i++) {
    piece_search s = {.who = {.m = m, .index = i}, .m = m};
    ways_of(m, i, s.who.way);
    if (laves__meeting_root(m, m->item[i].ends[0]) == laves__meeting_root(m, m->item[i].ends[1])) continue;
    laves__bvh_overlaps(&m->tree, box_around(m, end_place(m, i, 0), end_place(m, i, 1)), cross_item, &s);
    if (s.short_of_memory) return laves__fail_memory(context, error);
    if (i % 1024 == 1023 && laves__cancelled(context, "features", 0.6)) return laves__fail_cancelled(error);
  }
  return LAVES_OK;
}

/* ---- what is taken ---- */

typedef struct taken {
  asker who;
  laves__vec3 place;
  bool found;
} taken;

static void look_if_taken(void *user, uint32_t slot) {
  taken *t = user;
  const laves__meeting *m = t->who.m;
  const uint32_t item = m->order[slot];
  double share;
  if (t->found || m->item[item].ends[0] == m->item[item].ends[1] || !comes_before(&t->who, item)) return;
  const laves__vec3 on = nearest_on(end_place(m, item, 0), end_place(m, item, 1), t->place, &share);
  t->found = v3_distance(on, t->place) <= reach_of(m);
}

bool laves__meeting_is_taken(const laves__meeting *m, uint32_t piece, laves__vec3 place) {
  taken t = {.who = {.m = m, .index = piece}, .place = place};
  ways_of(m, piece, t.who.way);
  laves__bvh_overlaps(&m->tree, box_around(m, place, place), look_if_taken, &t);
  return t.found;
}

/* ---- all ---- */

static int compare_cuts(const void *a, const void *b) {
  const laves__meet_cut *x = a, *y = b;
  if (x->item != y->item) return x->item < y->item ? -1 : 1;
  if (x->share != y->share) return x->share < y->share ? -1 : 1;
  if (x->point != y->point) return x->point < y->point ? -1 : 1;
  return (int)x->own - (int)y->own;
}

/* Cuts of one item within reach of the first of them become one point, where the user has not set the place of both. */
static void join_cuts(laves__meeting *m) {
  for (size_t first = 0, i = 1; i < m->cut_count; i++) {
    const laves__meet_cut *a = &m->cut[first], *b = &m->cut[i];
    const uint32_t p = laves__meeting_root(m, a->point), q = laves__meeting_root(m, b->point);
    const bool near = a->item == b->item && v3_distance(m->point[p].place, m->point[q].place) <= reach_of(m);
    const bool both_given = (p < m->old_count || m->point[p].exact) && (q < m->old_count || m->point[q].exact);
    if (!near || both_given) {
      first = i;
      continue;
    }
    if (p == q) continue;
    const bool keep_q = q < m->old_count || m->point[q].exact;
    m->point[keep_q ? p : q].same = keep_q ? q : p;
    m->point[keep_q ? q : p].touched = true;
    m->point[keep_q ? q : p].fixed |= m->point[keep_q ? p : q].fixed;
  }
}

static bool allocate(laves__meeting *m) {
  laves_context *c = m->drawing->context;
  const size_t nodes = m->drawing->node_count;
  const size_t items = m->lines->segment_count + m->lines->fixed_count + nodes + m->drawing->line_count;
  m->way = laves__alloc_zeroed(c, nodes, sizeof *m->way);
  m->line_length = laves__alloc_zeroed(c, m->drawing->line_count, sizeof *m->line_length);
  m->item = laves__alloc(c, items, sizeof *m->item);
  m->order = laves__alloc(c, items, sizeof *m->order);
  m->item_capacity = items;
  return m->way && m->line_length && m->item && m->order &&
         laves__grow(c, &m->point, &m->point_capacity, m->old_count + nodes, sizeof *m->point);
}

laves_result laves__meeting_find(laves__meeting *m, const laves__drawing *drawing, const laves__feature_lines *lines,
                                 laves_error *error) {
  *m = (laves__meeting){.drawing = drawing, .lines = lines, .old_count = lines->point_count};
  if (lines->segment_count + lines->fixed_count + 2 * drawing->node_count >= LAVES__FACES_MAX ||
      lines->point_count + 2 * drawing->node_count >= UINT32_MAX / 2)
    return laves__fail(error, LAVES_ERROR_INPUT, "the features drawn have too many pieces (%zu); draw fewer or shorter lines",
                       drawing->node_count);
  if (!allocate(m)) return laves__fail_memory(drawing->context, error);
  list_points(m);
  count_degrees(m);
  list_items(m);
  if (!build_tree(m)) return laves__fail_memory(drawing->context, error);
  laves_result result = meet_nodes(m, error);
  if (result == LAVES_OK) result = meet_pieces(m, error);
  if (result != LAVES_OK || m->cut_count == 0) return result;
  qsort(m->cut, m->cut_count, sizeof *m->cut, compare_cuts);
  join_cuts(m);
  return LAVES_OK;
}

void laves__meeting_free(laves__meeting *m) {
  if (!m->drawing) return;
  laves_context *c = m->drawing->context;
  laves__free(c, m->point, m->point_capacity, sizeof *m->point);
  laves__free(c, m->item, m->item_capacity, sizeof *m->item);
  laves__free(c, m->order, m->item_capacity, sizeof *m->order);
  laves__free(c, m->way, m->drawing->node_count, sizeof *m->way);
  laves__free(c, m->line_length, m->drawing->line_count, sizeof *m->line_length);
  laves__free(c, m->cut, m->cut_capacity, sizeof *m->cut);
  laves__bvh_free(c, &m->tree);
  memset(m, 0, sizeof *m);
}
