/* What the user drew becomes points and segments beside those that were found.
 *
 * In: points and polylines in input coordinates, the segments that were found.  Out: those with more of them.
 *
 * The drawing is put on the surface and cut to pieces; then it is found where it meets what is there. What of a line runs along a
 * crease, or along an earlier line, is dropped. Segments that something drawn meets are split there, so that both share the
 * point, which becomes a corner. The rest of a line lies on one patch between two such points: that of the middle of its longest
 * piece, which is further from other patches than short pieces that stand at a crease.
 *
 *        crease ______________________        ______o_______________
 *                     /                            /
 *        drawn   o---/---------.          o-------o---------.            o corners
 *               (runs along) __/                            (dropped where it runs along)          */
#include "domain/feature_lines.h"

#include <string.h>

/* A stretch of a line between two neighbouring points, of those where it was cut too. */
typedef struct stretch {
  uint32_t ends[2]; /* roots of the meeting */
  uint32_t item;
  bool kept;
} stretch;

typedef struct story {
  const laves__features *features;
  laves__feature_lines *lines;
  laves__drawing drawing;
  laves__meeting meeting;
  stretch *stretch; /* of all lines, in their order */
  size_t stretch_count, stretch_capacity;
  bool *used;   /* [points of the meeting] an end of something kept, or of a crease */
  uint32_t *id; /* [points of the meeting] the point in lines, or LAVES__NONE */
  laves_error *error;
} story;

static laves_result fail_memory(const story *s) { return laves__fail_memory(s->drawing.context, s->error); }

static laves__vec3 place_of(const story *s, uint32_t point) { return s->meeting.point[point].place; }

/* ---- stretches ---- */

/* The cuts of an item are [first, *end) of the sorted list; `first` moves on from item to item. */
static size_t cuts_of(const laves__meeting *m, uint32_t item, size_t *end) {
  size_t low = 0, high = m->cut_count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (m->cut[middle].item < item)
      low = middle + 1;
    else
      high = middle;
  }
  *end = low;
  while (*end < m->cut_count && m->cut[*end].item == item) ++*end;
  return low;
}

/* Whether a stretch runs along what was there before: both ends are on it, and the middle. */
static bool runs_along(const story *s, const stretch *t) {
  const laves__meeting *m = &s->meeting;
  if (!m->point[t->ends[0]].touched || !m->point[t->ends[1]].touched) return false;
  return laves__meeting_is_taken(m, t->item, v3_lerp(place_of(s, t->ends[0]), place_of(s, t->ends[1]), 0.5));
}

static bool add_stretch(story *s, uint32_t item, uint32_t from, uint32_t to) {
  stretch t = {{from, to}, item, true};
  if (from == to) return true;
  t.kept = !runs_along(s, &t);
  if (!laves__grow(s->drawing.context, &s->stretch, &s->stretch_capacity, s->stretch_count + 1, sizeof *s->stretch)) return false;
  s->stretch[s->stretch_count++] = t;
  return true;
}

/* One piece, from cut to cut; with only_used, from one that counts to the next. */
static bool add_piece(story *s, uint32_t item, bool only_used) {
  const laves__meeting *m = &s->meeting;
  size_t end;
  uint32_t from = laves__meeting_root(m, m->item[item].ends[0]);
  for (size_t i = cuts_of(m, item, &end); i < end; i++) {
    const uint32_t root = laves__meeting_root(m, m->cut[i].point);
    if (only_used && !m->point[root].fixed && !s->used[root]) continue;
    if (!add_stretch(s, item, from, root)) return false;
    from = root;
  }
  return add_stretch(s, item, from, laves__meeting_root(m, m->item[item].ends[1]));
}

static laves_result add_pieces(story *s, bool only_used) {
  const laves__meeting *m = &s->meeting;
  s->stretch_count = 0;
  for (uint32_t i = (uint32_t)m->piece_first; i < m->item_count && m->item[i].line <= s->drawing.line_count; i++) {
    if (!add_piece(s, i, only_used)) return fail_memory(s);
    if (i % 1024 == 1023 && laves__cancelled(s->drawing.context, "features", 0.8)) return laves__fail_cancelled(s->error);
  }
  return LAVES_OK;
}

/* Marks the points that a piece itself brings to where something of it is kept: its ends, and the points of others that it goes
 * through. Points of others that only lie on it do not count, as their own line may be dropped there. */
static void mark_used(story *s) {
  const laves__meeting *m = &s->meeting;
  for (size_t i = 0; i < s->stretch_count; i++) {
    const stretch *t = &s->stretch[i];
    size_t end;
    if (!t->kept) continue;
    for (int k = 0; k < 2; k++) s->used[t->ends[k]] |= laves__meeting_root(m, m->item[t->item].ends[k]) == t->ends[k];
    for (size_t j = cuts_of(m, t->item, &end); j < end; j++) {
      const uint32_t root = laves__meeting_root(m, m->cut[j].point);
      s->used[root] |= m->cut[j].own && (root == t->ends[0] || root == t->ends[1]);
    }
  }
}

/* Once with all cuts, to see which count, and once with those. */
static laves_result find_stretches(story *s) {
  laves_result result = add_pieces(s, false);
  if (result != LAVES_OK) return result;
  mark_used(s);
  result = add_pieces(s, true);
  for (size_t i = 0; result == LAVES_OK && i < s->stretch_count; i++)
    for (int k = 0; k < 2 && s->stretch[i].kept; k++) s->used[s->stretch[i].ends[k]] = true;
  return result;
}

/* ---- points ---- */

/* The point of lines that a point of the meeting is; new ones are added. */
static bool give_point(story *s, uint32_t root, uint32_t *id) {
  if (s->id[root] == LAVES__NONE && !laves__feature_lines_add_point(s->lines, place_of(s, root), &s->id[root])) return false;
  *id = s->id[root];
  return true;
}

/* Points that were there and now stand where the user drew one. */
static void move_points(story *s) {
  for (uint32_t i = 0; i < s->meeting.old_count; i++)
    if (s->meeting.point[i].exact) s->lines->point[i] = place_of(s, i);
}

/* Whether a point splits what goes through it: the user's points and ends, and where something drawn comes in. */
static bool is_corner(const story *s, uint32_t root) {
  const laves__meet_point *p = &s->meeting.point[root];
  return p->fixed || (p->touched && s->used[root]);
}

/* ---- segments that were there ---- */

/* The segment ends at its first cut, and what is behind comes anew. */
static bool split_segment(story *s, uint32_t item) {
  const laves__meeting *m = &s->meeting;
  size_t end;
  laves__feature_segment rest = s->lines->segment[item];
  const uint32_t last = rest.ends[1];
  bool whole = true;
  for (size_t i = cuts_of(m, item, &end); i < end; i++) {
    const uint32_t root = laves__meeting_root(m, m->cut[i].point);
    uint32_t id;
    if (!is_corner(s, root)) continue;
    if (!give_point(s, root, &id)) return false;
    if (id == rest.ends[0] || id == last) continue;
    s->used[root] = true;
    rest.ends[1] = id;
    if (whole)
      s->lines->segment[item] = rest;
    else if (!laves__feature_lines_add_segment(s->lines, &rest))
      return false;
    whole = false;
    rest.ends[0] = id;
    rest.ends[1] = last;
  }
  return whole || laves__feature_lines_add_segment(s->lines, &rest);
}

static laves_result split_segments(story *s, size_t segment_count) {
  for (size_t i = 0; i < s->meeting.cut_count; i++) {
    const uint32_t item = s->meeting.cut[i].item;
    if (item >= segment_count || (i > 0 && s->meeting.cut[i - 1].item == item)) continue;
    if (!split_segment(s, item)) return fail_memory(s);
  }
  return LAVES_OK;
}

/* ---- what was drawn ---- */

static int32_t patch_at(const story *s, laves__vec3 place, double reach) {
  const laves__features *f = s->features;
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  if (!f->oracle->project(f->oracle->self, place, reach, &hint, &foot, &normal)) foot = place;
  return f->patch_at(f->self, foot, hint);
}

/* Stretches [begin, end), which lie on one patch. */
static bool give_run(story *s, size_t begin, size_t end) {
  double longest = -1;
  laves__vec3 middle = v3(0, 0, 0);
  for (size_t i = begin; i < end; i++) {
    const laves__vec3 a = place_of(s, s->stretch[i].ends[0]), b = place_of(s, s->stretch[i].ends[1]);
    if (!(v3_distance(a, b) > longest)) continue;
    longest = v3_distance(a, b);
    middle = v3_lerp(a, b, 0.5);
  }
  const int32_t patch = patch_at(s, middle, longest + LAVES__DRAWN_MEET * s->drawing.diagonal);
  for (size_t i = begin; i < end; i++) {
    laves__feature_segment segment = {.patch = {patch, patch}, .angle = 180, .drawn = true};
    if (!give_point(s, s->stretch[i].ends[0], &segment.ends[0]) || !give_point(s, s->stretch[i].ends[1], &segment.ends[1]) ||
        !laves__feature_lines_add_segment(s->lines, &segment))
      return false;
  }
  return true;
}

/* A run ends at corners, at what was dropped, and with its line. */
static laves_result give_segments(story *s) {
  const laves__meet_item *item = s->meeting.item;
  for (size_t begin = 0, end; begin < s->stretch_count; begin = end) {
    end = begin + 1;
    if (!s->stretch[begin].kept) continue;
    while (end < s->stretch_count && s->stretch[end].kept &&
           item[s->stretch[end].item].line == item[s->stretch[begin].item].line &&
           s->stretch[end].ends[0] == s->stretch[end - 1].ends[1] && !is_corner(s, s->stretch[end].ends[0]))
      end++;
    if (!give_run(s, begin, end)) return fail_memory(s);
  }
  return LAVES_OK;
}

/* Corners: on the patch there where no segment ends. Those that were corners before stay so. */
static laves_result give_corners(story *s, size_t fixed_count) {
  const laves__meeting *m = &s->meeting;
  bool *done = laves__alloc_zeroed(s->drawing.context, m->point_count, sizeof *done);
  if (!done) return fail_memory(s);
  for (size_t i = 0; i < fixed_count; i++) done[s->lines->fixed[i].point] = true;
  bool enough = true;
  for (uint32_t i = 0; i < m->point_count && enough; i++) {
    const uint32_t root = laves__meeting_root(m, i);
    uint32_t id = 0;
    if (done[root] || !is_corner(s, root)) continue;
    done[root] = true;
    const bool alone = !s->used[root] && m->point[root].degree == 0;
    const int32_t patch = alone ? patch_at(s, place_of(s, root), LAVES__DRAWN_MEET * s->drawing.diagonal) : LAVES__NO_FEATURE;
    enough = give_point(s, root, &id) && laves__feature_lines_fix(s->lines, id, patch);
  }
  laves__free(s->drawing.context, done, m->point_count, sizeof *done);
  return enough ? LAVES_OK : fail_memory(s);
}

static laves_result give_all(story *s) {
  const size_t points = s->meeting.point_count, segment_count = s->lines->segment_count, fixed_count = s->lines->fixed_count;
  s->used = laves__alloc_zeroed(s->drawing.context, points, sizeof *s->used);
  s->id = laves__alloc(s->drawing.context, points, sizeof *s->id);
  if (!s->used || !s->id) return fail_memory(s);
  for (uint32_t i = 0; i < points; i++) s->id[i] = i < s->lines->point_count ? i : LAVES__NONE;
  laves_result result = find_stretches(s);
  if (result != LAVES_OK) return result;
  move_points(s);
  result = split_segments(s, segment_count);
  if (result == LAVES_OK) result = give_segments(s);
  return result == LAVES_OK ? give_corners(s, fixed_count) : result;
}

laves_result laves__features_drawn(const laves__feature_wish *wish, const laves__features *features, laves__feature_lines *lines,
                                   laves_error *error) {
  laves_context *context = features->context;
  story s = {.features = features, .lines = lines, .drawing = {.context = context, .oracle = features->oracle}, .error = error};
  if (!wish->drawn || wish->drawn->point_count + wish->drawn->line_count == 0) return LAVES_OK;
  laves_result result = laves__drawing_trace(&s.drawing, wish->drawn, error);
  if (result == LAVES_OK) result = laves__meeting_find(&s.meeting, &s.drawing, lines, error);
  if (result == LAVES_OK) result = give_all(&s);
  laves__free(context, s.stretch, s.stretch_capacity, sizeof *s.stretch);
  if (s.meeting.drawing) {
    laves__free(context, s.used, s.meeting.point_count, sizeof *s.used);
    laves__free(context, s.id, s.meeting.point_count, sizeof *s.id);
  }
  laves__meeting_free(&s.meeting);
  laves__drawing_free(&s.drawing);
  return result;
}
