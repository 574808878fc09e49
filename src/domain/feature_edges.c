/* Which edges of a triangle surface are creases.
 *
 * In: a welded surface, an angle, a size.  Out: a flag for each half-edge.
 *
 *   normals    of slivers say nothing: they take that of the neighbour across their longest edge, in whose plane they lie
 *   mark       edges whose faces' normals are further apart than the angle, and, when asked, edges between tags
 *   confirm    what looks sharp between two small triangles must be so between the means of what lies around, within half a size
 *   join       where a crease ends, it may go on along blunter edges if that leads to another one soon
 *   prune      ends shorter than the size, and groups of creases that are no longer together, are noise
 *
 * All in the order of half-edges and points, so that the result depends on nothing else. */
#include "domain/feature_edges.h"

#include <string.h>

#include "domain/elementary.h"

/* A face is a sliver when its height is below this share of the size: it can't matter to the mesh. */
static const double sliver_height = 1e-4;
enum { SLIVER_STEPS = 16, JOIN_STEPS = 64, AROUND_MAX = 256 };
static const double around_range = 0.5;   /* sizes: how far from an edge normals are averaged */
static const double confirm_share = 0.75; /* of the angle: what the means must still be apart */
static const double surely_sharp = 70;    /* degrees: an edge that turns by more is sharp whatever is beside it */
static const double facet_height = 2.5;   /* sizes */
static const double blunt_share = 0.5;    /* of the angle: what a join may follow */
static const double faded_share = 0.3;    /* of the angle: what a crease that fades away may follow */
static const double fade_length = 4;      /* sizes: how long it is by then */
static const double join_range = 2;       /* sizes: how long it may be */
static const double join_cosine = 0.766;  /* it goes on within 40 degrees of its direction */
static const double short_end = 2;        /* sizes: a dangling end below that goes */
static const double short_group = 4;      /* sizes: as does a group of creases of less length in all */

static uint32_t start_of(const laves__feature_edges *e, uint32_t h) { return laves__half_start(e->surface, h); }
static uint32_t end_of(const laves__feature_edges *e, uint32_t h) { return laves__half_end(e->surface, h); }

static double length_of(const laves__feature_edges *e, uint32_t h) {
  return v3_distance(e->surface->points[start_of(e, h)], e->surface->points[end_of(e, h)]);
}

/* ---- normals ---- */

static uint32_t longest_edge(const laves__feature_edges *e, uint32_t f, double *length) {
  uint32_t longest = 3 * f;
  for (uint32_t h = 3 * f; h < 3 * f + 3; h++)
    if (length_of(e, h) > length_of(e, longest)) longest = h;
  *length = length_of(e, longest);
  return longest;
}

static bool is_sliver(const laves__feature_edges *e, uint32_t f, uint32_t *longest) {
  const uint32_t *p = e->surface->faces[f];
  const laves__vec3 a = e->surface->points[p[0]], b = e->surface->points[p[1]], c = e->surface->points[p[2]];
  double length;
  *longest = longest_edge(e, f, &length);
  return v3_norm(v3_cross(v3_sub(b, a), v3_sub(c, a))) < sliver_height * e->wish->size * length;
}

static void find_normals(const laves__feature_edges *e) {
  const laves__surface *s = e->surface;
  for (uint32_t f = 0; f < s->face_count; f++) {
    uint32_t at = f, longest;
    int steps = 0;
    while (steps < SLIVER_STEPS && is_sliver(e, at, &longest) && s->across[longest] != LAVES__NONE) {
      at = s->across[longest] / 3;
      steps++;
    }
    e->normal[f] = steps < SLIVER_STEPS ? laves__face_normal(s, at) : v3(0, 0, 0);
  }
}

/* ---- marks ---- */

/* Whether the faces at an edge are turned against one another by more than an angle of that cosine. */
static bool is_turned(const laves__feature_edges *e, uint32_t h, double cosine) {
  const uint32_t g = e->surface->across[h];
  if (g == LAVES__NONE || start_of(e, g) != end_of(e, h)) return false; /* two faces of opposite directions tell nothing */
  const laves__vec3 a = e->normal[h / 3], b = e->normal[g / 3];
  return v3_norm2(a) > 0 && v3_norm2(b) > 0 && v3_dot(a, b) < cosine;
}

static bool parts_tags(const laves__feature_edges *e, uint32_t h) {
  const laves__surface *s = e->surface;
  return e->wish->tags && s->tags && s->across[h] != LAVES__NONE && s->tags[h / 3] != s->tags[s->across[h] / 3];
}

static void set_crease(const laves__feature_edges *e, uint32_t h, bool is) {
  const uint32_t g = e->surface->across[h];
  if (e->is_crease[h] == is) return;
  e->is_crease[h] = e->is_crease[g] = is;
  e->degree[start_of(e, h)] += is ? 1u : UINT32_MAX;
  e->degree[end_of(e, h)] += is ? 1u : UINT32_MAX;
}

static double cosine_of(double degrees) { return cos_of(degrees * 0.017453292519943295); }

static void mark(const laves__feature_edges *e) {
  const double cosine = e->wish->angle > 0 ? cosine_of(e->wish->angle) : -2;
  for (uint32_t h = 0; h < 3 * e->surface->face_count; h++)
    if (is_turned(e, h, cosine) || parts_tags(e, h)) set_crease(e, h, true);
}

/* The mean normals on both sides of an edge, of the faces around it whose centroid is near; each face counts at most for the area
 * of a disk of that radius. The sides are those of the plane through the edge that halves the angle between its faces. */
static void mean_normals(const laves__feature_edges *e, uint32_t h, uint32_t *stamp, laves__vec3 mean[2]) {
  const laves__surface *s = e->surface;
  const double range = around_range * e->wish->size;
  const uint32_t g = s->across[h];
  const laves__vec3 a = s->points[start_of(e, h)], b = s->points[end_of(e, h)], middle = v3_lerp(a, b, 0.5);
  const laves__vec3 aside = v3_cross(v3_sub(b, a), v3_add(e->normal[h / 3], e->normal[g / 3])); /* to the right */
  uint32_t list[AROUND_MAX];
  size_t count = 0;
  list[count++] = h / 3;
  list[count++] = g / 3;
  stamp[h / 3] = stamp[g / 3] = h;
  mean[0] = mean[1] = v3(0, 0, 0);
  for (size_t head = 0; head < count; head++) {
    const uint32_t f = list[head], *p = s->faces[f];
    const laves__vec3 u = s->points[p[0]], v = s->points[p[1]], w = s->points[p[2]];
    const laves__vec3 from = v3_sub(v3_scale(v3_add(u, v3_add(v, w)), 1.0 / 3), middle);
    const bool near = v3_norm2(from) <= range * range;
    if (head > 1 && !near) continue;
    const double area = 0.5 * v3_norm(v3_cross(v3_sub(v, u), v3_sub(w, u)));
    const int side = head < 2 ? (int)head : v3_dot(from, aside) > 0;
    mean[side] = v3_mad(mean[side], e->normal[f], fmin(area, range * range));
    for (uint32_t k = 3 * f; k < 3 * f + 3 && count < AROUND_MAX; k++) {
      const uint32_t next = s->across[k];
      if (next == LAVES__NONE || stamp[next / 3] == h) continue;
      stamp[next / 3] = h;
      list[count++] = next / 3;
    }
  }
}

/* The largest turn, as the least cosine, at the other edges of the two faces beside an edge, those left out that are as sharp. */
static double bend_beside(const laves__feature_edges *e, uint32_t h, double sharp) {
  const uint32_t sides[2] = {h, e->surface->across[h]};
  double least = 1;
  for (int side = 0; side < 2; side++)
    for (uint32_t k = 3 * (sides[side] / 3); k < 3 * (sides[side] / 3) + 3; k++) {
      const uint32_t g = e->surface->across[k];
      if (k == sides[side] || g == LAVES__NONE) continue;
      const double cosine = v3_dot(e->normal[k / 3], e->normal[g / 3]);
      if (cosine > sharp) least = fmin(least, cosine);
    }
  return least;
}

/* The height of a face over one of its edges. */
static double height_over(const laves__feature_edges *e, uint32_t h) {
  const uint32_t *p = e->surface->faces[h / 3];
  const laves__vec3 a = e->surface->points[p[0]], b = e->surface->points[p[1]], c = e->surface->points[p[2]];
  const double length = length_of(e, h);
  return length > 0 ? v3_norm(v3_cross(v3_sub(b, a), v3_sub(c, a))) / length : 0;
}

/* Whether an edge is one of several that make a bend, a curved surface in coarse triangles: those beside it turn by more than
 * half as much. Faces much larger than the size are facets, which the mesh shows. */
static bool is_bend(const laves__feature_edges *e, uint32_t h, double sharp) {
  if (fmin(height_over(e, h), height_over(e, e->surface->across[h])) > facet_height * e->wish->size) return false;
  const double cosine = v3_dot(e->normal[h / 3], e->normal[e->surface->across[h] / 3]);
  if (cosine < sharp) return false;
  const double half = sqrt(0.5 * (1 + cosine)); /* the cosine of half the turn */
  return bend_beside(e, h, sharp) < half;
}

/* Takes away marks that stand for the roughness of a surface finer than the size. */
static void confirm(const laves__feature_edges *e, uint32_t *stamp) {
  if (!(e->wish->angle > 0)) return;
  const double cosine = cosine_of(confirm_share * e->wish->angle), sharp = cosine_of(surely_sharp);
  memset(stamp, 0xff, e->surface->face_count * sizeof *stamp);
  for (uint32_t h = 0; h < 3 * e->surface->face_count; h++) {
    laves__vec3 mean[2];
    if (!e->is_crease[h] || e->surface->across[h] < h || parts_tags(e, h)) continue;
    mean_normals(e, h, stamp, mean);
    if (v3_dot(v3_unit(mean[0]), v3_unit(mean[1])) > cosine || is_bend(e, h, sharp)) set_crease(e, h, false);
  }
}

static void list_half_edges(const laves__feature_edges *e) {
  const uint32_t count = (uint32_t)(3 * e->surface->face_count);
  uint32_t sum = 0;
  for (uint32_t h = 0; h < count; h++) e->first[start_of(e, h)]++;
  for (size_t p = 0; p <= e->surface->point_count; p++) {
    sum += e->first[p];
    e->first[p] = sum;
  }
  for (uint32_t h = count; h-- > 0;) e->at[--e->first[start_of(e, h)]] = h;
}

/* The half-edge of the next crease edge at a point, from list place k on; NONE: there is no more. Of an edge whose two faces have
 * opposite directions only one half-edge starts there, and every edge of a closed fan has one. */
static uint32_t crease_at(const laves__feature_edges *e, uint32_t p, uint32_t *k) {
  for (; *k < e->first[p + 1]; ++*k)
    if (e->is_crease[e->at[*k]]) return e->at[(*k)++];
  return LAVES__NONE;
}

/* The only crease edge at a point, as the half-edge that starts there. */
static uint32_t only_crease(const laves__feature_edges *e, uint32_t p) {
  uint32_t k = e->first[p];
  return crease_at(e, p, &k);
}

static laves__vec3 direction_of(const laves__feature_edges *e, uint32_t h) {
  return v3_unit(v3_sub(e->surface->points[end_of(e, h)], e->surface->points[start_of(e, h)]));
}

/* The crease edge at a point other than the one that came in, as it leaves. */
static uint32_t other_crease(const laves__feature_edges *e, uint32_t p, uint32_t from) {
  for (uint32_t k = e->first[p], h; (h = crease_at(e, p, &k)) != LAVES__NONE;)
    if (end_of(e, h) != from) return h;
  return LAVES__NONE;
}

/* ---- joins ---- */

/* The edge that goes on from a point in a direction, the straightest of those that are blunt creases; NONE: there is none. */
static uint32_t goes_on(const laves__feature_edges *e, uint32_t p, laves__vec3 direction, double cosine) {
  uint32_t best = LAVES__NONE;
  double straightest = join_cosine;
  for (uint32_t k = e->first[p]; k < e->first[p + 1]; k++) {
    const uint32_t h = e->at[k];
    const double along = v3_dot(direction_of(e, h), direction);
    if (along <= straightest || !is_turned(e, h, cosine) || is_bend(e, h, -1)) continue;
    straightest = along;
    best = h;
  }
  return best;
}

/* Follows blunt edges from the end of a crease: the way is in path[0 .. result), and *meets tells whether it ends at another. */
static int follow_blunt(const laves__feature_edges *e, uint32_t p, double cosine, double range, uint32_t path[JOIN_STEPS],
                        bool *meets) {
  laves__vec3 direction = v3_scale(direction_of(e, only_crease(e, p)), -1);
  double length = 0;
  *meets = false;
  for (int count = 0; count < JOIN_STEPS; count++) {
    const uint32_t h = goes_on(e, p, direction, cosine);
    if (h == LAVES__NONE) return count;
    length += length_of(e, h);
    if (length > range) return count;
    path[count] = h;
    direction = direction_of(e, h);
    p = end_of(e, h);
    *meets = e->degree[p] > 0;
    if (*meets) return count + 1;
  }
  return JOIN_STEPS;
}

/* The length of the crease that ends at a point, as far as it matters. */
static double length_behind(const laves__feature_edges *e, uint32_t p, double enough) {
  double length = 0;
  uint32_t h = only_crease(e, p), from = p;
  while (h != LAVES__NONE && length < enough) {
    length += length_of(e, h);
    const uint32_t at = end_of(e, h);
    if (e->degree[at] != 2) break;
    h = other_crease(e, at, from);
    from = at;
  }
  return length;
}

/* Closes gaps; a crease of some length that fades away goes on as long as it can still be seen. */
static void join(laves__feature_edges *e) {
  if (!(e->wish->angle > 0)) return;
  const double blunt = cosine_of(blunt_share * e->wish->angle), faded = cosine_of(faded_share * e->wish->angle);
  for (uint32_t p = 0; p < e->surface->point_count; p++) {
    uint32_t path[JOIN_STEPS];
    bool meets;
    if (e->degree[p] != 1 || only_crease(e, p) == LAVES__NONE) continue;
    int count = follow_blunt(e, p, blunt, join_range * e->wish->size, path, &meets);
    e->joined += meets;
    if (!meets && length_behind(e, p, fade_length * e->wish->size) >= fade_length * e->wish->size)
      count = follow_blunt(e, p, faded, HUGE_VAL, path, &meets);
    else if (!meets)
      count = 0;
    for (int i = 0; i < count; i++) set_crease(e, path[i], true);
  }
}

/* ---- noise ---- */

/* Takes away the way from a loose end to the next branch, if it is short. */
static void prune_end(laves__feature_edges *e, uint32_t p) {
  const double limit = short_end * e->wish->size;
  double length = 0;
  uint32_t at = p, from = LAVES__NONE;
  do {
    const uint32_t h = from == LAVES__NONE ? only_crease(e, at) : other_crease(e, at, from);
    if (h == LAVES__NONE) return;
    length += length_of(e, h);
    if (length >= limit) return;
    from = at;
    at = end_of(e, h);
  } while (e->degree[at] == 2);
  while (p != at) { /* what lies behind p is gone, so one crease is left there */
    const uint32_t h = only_crease(e, p);
    p = end_of(e, h);
    set_crease(e, h, false);
  }
  e->dropped++;
}

static void prune_ends(laves__feature_edges *e) {
  for (bool again = true; again;) {
    const size_t before = e->dropped;
    for (uint32_t p = 0; p < e->surface->point_count; p++)
      if (e->degree[p] == 1) prune_end(e, p);
    again = e->dropped > before;
  }
}

/* Takes away groups of creases that hang together but are short in all. `stack` and `seen` have a place for each point. */
static void prune_groups(laves__feature_edges *e, uint32_t *stack, bool *seen) {
  const double limit = short_group * e->wish->size;
  for (uint32_t first = 0; first < e->surface->point_count; first++) {
    if (seen[first] || e->degree[first] == 0) continue;
    size_t count = 0;
    double length = 0;
    stack[count++] = first;
    seen[first] = true;
    for (size_t head = 0; head < count; head++)
      for (uint32_t k = e->first[stack[head]], h; (h = crease_at(e, stack[head], &k)) != LAVES__NONE;) {
        length += 0.5 * length_of(e, h);
        if (seen[end_of(e, h)]) continue;
        seen[end_of(e, h)] = true;
        stack[count++] = end_of(e, h);
      }
    if (length >= limit) continue;
    for (size_t i = 0; i < count; i++)
      for (uint32_t k = e->first[stack[i]], h; (h = crease_at(e, stack[i], &k)) != LAVES__NONE;) set_crease(e, h, false);
    e->dropped++;
  }
}

/* ---- all ---- */

bool laves__feature_edges_find(laves_context *context, const laves__surface *s, const laves__feature_wish *wish,
                               laves__feature_edges *e) {
  const size_t points = s->point_count, halves = 3 * s->face_count;
  *e = (laves__feature_edges){.context = context, .surface = s, .wish = wish};
  e->normal = laves__alloc(context, s->face_count, sizeof *e->normal);
  e->is_crease = laves__alloc_zeroed(context, halves, sizeof *e->is_crease);
  e->first = laves__alloc_zeroed(context, points + 1, sizeof *e->first);
  e->at = laves__alloc(context, halves, sizeof *e->at);
  e->degree = laves__alloc_zeroed(context, points, sizeof *e->degree);
  uint32_t *stack = laves__alloc(context, points, sizeof *stack);
  bool *seen = laves__alloc_zeroed(context, points, sizeof *seen);
  uint32_t *stamp = laves__alloc(context, s->face_count, sizeof *stamp);
  const bool done = stamp && e->normal && e->is_crease && e->first && e->at && e->degree && stack && seen;
  if (done) {
    find_normals(e);
    list_half_edges(e);
    mark(e);
    confirm(e, stamp);
    join(e);
    prune_ends(e);
    prune_groups(e, stack, seen);
  }
  laves__free(context, stamp, s->face_count, sizeof *stamp);
  laves__free(context, stack, points, sizeof *stack);
  laves__free(context, seen, points, sizeof *seen);
  return done;
}

void laves__feature_edges_free(laves__feature_edges *e) {
  if (!e->context) return;
  const size_t points = e->surface->point_count, halves = 3 * e->surface->face_count;
  laves__free(e->context, e->normal, e->surface->face_count, sizeof *e->normal);
  laves__free(e->context, e->is_crease, halves, sizeof *e->is_crease);
  laves__free(e->context, e->first, points + 1, sizeof *e->first);
  laves__free(e->context, e->at, halves, sizeof *e->at);
  laves__free(e->context, e->degree, points, sizeof *e->degree);
  memset(e, 0, sizeof *e);
}
