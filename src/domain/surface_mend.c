/* Mends what scans and exports do to surfaces that were closed once: cracks, repeats, faces turned over.
 *
 * In: a welded surface with open or contradicting edges.  Out: the same with nearly equal points made one where that closes
 * edges, with one of each repeated face, with T-junctions stitched, and with directions that agree over edges.
 *
 * Several tolerances are tried, from 1e-6 to 1e-4 of the diagonal but at most half the shortest edge between two faces; the least
 * one that leaves the fewest open edges is taken. Directions are carried from face to face over edges with exactly two faces;
 * each piece keeps the direction of most of its area, or where that is a close call, the one that makes its volume about its own
 * centre positive. */
#include <string.h>

#include "domain/surface.h"

/* Parts of the diagonal. */
static const double tolerances[] = {1e-6, 3e-6, 1e-5, 3e-5, 1e-4};
/* A vote of the area less clear than this is left to the volume. */
static const double clear_vote = 0.2;

/* ---- nearly equal points ---- */

typedef struct grid {
  uint32_t *heads, *next;
  size_t size; /* a power of two */
  double per_length;
} grid;

static size_t cell_of(const grid *g, int64_t x, int64_t y, int64_t z) {
  uint64_t h = (uint64_t)x * 0x9e3779b97f4a7c15u ^ (uint64_t)y * 0xc2b2ae3d27d4eb4fu ^ (uint64_t)z * 0x165667b19e3779f9u;
  h = (h ^ h >> 29) * 0xbf58476d1ce4e5b9u;
  return (size_t)(h >> 32) & (g->size - 1);
}

/* The least earlier point within the tolerance that stands for itself, or NONE. Cells are two tolerances wide, so eight of
 * them hold the ball. */
static uint32_t find_near(const grid *g, const laves__vec3 *points, const uint32_t *number, laves__vec3 p, double tolerance) {
  const int64_t x = (int64_t)floor((p.x - tolerance) * g->per_length), y = (int64_t)floor((p.y - tolerance) * g->per_length),
                z = (int64_t)floor((p.z - tolerance) * g->per_length);
  uint32_t found = LAVES__NONE;
  for (int k = 0; k < 8; k++)
    for (uint32_t q = g->heads[cell_of(g, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))]; q != LAVES__NONE; q = g->next[q])
      if (q < found && number[q] == q && v3_distance(points[q], p) <= tolerance) found = q;
  return found;
}

/* number[p]: the point that stands for p. */
static bool merge_points(const laves__surface *s, double tolerance, uint32_t *number) {
  const size_t count = s->point_count;
  grid g = {.size = 16, .per_length = 0.5 / tolerance};
  while (g.size < count) g.size *= 2;
  g.heads = laves__alloc(s->context, g.size, sizeof *g.heads);
  g.next = laves__alloc(s->context, count, sizeof *g.next);
  bool done = g.heads && g.next;
  if (done) memset(g.heads, 0xff, g.size * sizeof *g.heads);
  for (uint32_t p = 0; done && p < count; p++) {
    done = !laves__cancelled_at(s->context, "surface", p, count);
    const laves__vec3 q = s->points[p];
    const uint32_t near = find_near(&g, s->points, number, q, tolerance);
    number[p] = near == LAVES__NONE ? p : near;
    if (near != LAVES__NONE) continue;
    const size_t cell =
        cell_of(&g, (int64_t)floor(q.x * g.per_length), (int64_t)floor(q.y * g.per_length), (int64_t)floor(q.z * g.per_length));
    g.next[p] = g.heads[cell];
    g.heads[cell] = p;
  }
  laves__free(s->context, g.heads, g.size, sizeof *g.heads);
  laves__free(s->context, g.next, count, sizeof *g.next);
  return done;
}

/* A surface of its own faces, tags and sources over s's points, with points numbered anew; free with trial_free(). */
static bool trial_create(const laves__surface *s, const uint32_t *number, laves__surface *t) {
  *t = (laves__surface){.context = s->context,
                        .points = s->points,
                        .point_count = s->point_count,
                        .point_capacity = s->point_capacity,
                        .face_capacity = s->face_capacity};
  t->faces = laves__alloc(s->context, t->face_capacity, sizeof *t->faces);
  if (s->tags) t->tags = laves__alloc(s->context, t->face_capacity, sizeof *t->tags);
  t->sources = laves__alloc(s->context, t->face_capacity, sizeof *t->sources);
  if (!t->faces || (s->tags && !t->tags) || !t->sources) return false;
  for (size_t f = 0; f < s->face_count; f++) {
    const uint32_t a = number[s->faces[f][0]], b = number[s->faces[f][1]], c = number[s->faces[f][2]];
    if (a == b || b == c || c == a) continue;
    if (t->tags) t->tags[t->face_count] = s->tags[f];
    t->sources[t->face_count] = s->sources[f];
    uint32_t *face = t->faces[t->face_count++];
    face[0] = a;
    face[1] = b;
    face[2] = c;
  }
  laves_domain_info scratch = {0};
  return laves__surface_drop_repeats(t, true, &scratch);
}

static void trial_free(laves__surface *t) {
  laves_context *context = t->context;
  laves__free(context, t->faces, t->face_capacity, sizeof *t->faces);
  laves__free(context, t->tags, t->face_capacity, sizeof *t->tags);
  laves__free(context, t->sources, t->face_capacity, sizeof *t->sources);
  laves__free(context, t->across, 3 * t->face_capacity, sizeof *t->across);
  laves__free(context, t->doubtful_points, t->point_capacity, sizeof *t->doubtful_points);
  laves__free(context, t->rim, t->rim_capacity, sizeof *t->rim);
  *t = (laves__surface){0};
}

static double shortest_good_edge(const laves__surface *s) {
  double shortest = INFINITY;
  for (size_t h = 0; h < 3 * s->face_count; h++) {
    if (s->across[h] == LAVES__NONE) continue;
    shortest = fmin(shortest, v3_distance(s->points[s->faces[h / 3][h % 3]], s->points[s->faces[h / 3][(h % 3 + 1) % 3]]));
  }
  return shortest;
}

/* What mends s best: faces and tags of `best` (which is freed by the caller), none when nothing helps. */
static bool try_tolerances(const laves__surface *s, size_t open_edges, laves__surface *best) {
  const double most = 0.5 * shortest_good_edge(s);
  bool done = false;
  laves__surface trial = {.context = s->context};
  uint32_t *number = laves__alloc(s->context, s->point_count, sizeof *number);
  if (!number) goto clean_up;
  for (size_t p = 0; p < s->point_count; p++) number[p] = (uint32_t)p;
  if (!trial_create(s, number, best)) goto clean_up;
  for (size_t k = 0; k < LAVES__COUNT_OF(tolerances) && open_edges > 0; k++) {
    const double tolerance = tolerances[k] * s->diagonal;
    laves_domain_info facts = {0};
    if (tolerance > most) break;
    if (!merge_points(s, tolerance, number)) goto clean_up;
    if (!trial_create(s, number, &trial) || !laves__surface_topology(&trial, &facts)) goto clean_up;
    if (trial.face_count > 0 && facts.defects[LAVES_DEFECT_OPEN_EDGE] < open_edges) {
      const laves__surface swap = *best;
      *best = trial;
      trial = swap;
      open_edges = facts.defects[LAVES_DEFECT_OPEN_EDGE];
    }
    trial_free(&trial);
    trial.context = s->context;
  }
  done = true;
clean_up:
  trial_free(&trial);
  laves__free(s->context, number, s->point_count, sizeof *number);
  return done;
}

/* ---- directions ---- */

typedef struct piece {
  const uint32_t *faces;
  size_t count;
} piece;

/* Collects the faces reached from `first`, marking which must be turned to agree with it. state: 0 not seen, 1 as it is,
 * 2 to be turned. */
static piece collect(const laves__surface *s, uint32_t first, uint8_t *state, uint32_t *list) {
  size_t count = 0;
  list[count++] = first;
  state[first] = 1;
  for (size_t at = 0; at < count; at++) {
    const uint32_t f = list[at];
    for (int i = 0; i < 3; i++) {
      const uint32_t half = s->across[3 * (size_t)f + (size_t)i];
      if (half == LAVES__NONE || state[half / 3]) continue;
      const bool agree = s->faces[f][i] != s->faces[half / 3][half % 3];
      state[half / 3] = agree ? state[f] : (uint8_t)(3 - state[f]);
      list[count++] = half / 3;
    }
  }
  return (piece){list, count};
}

/* Share of the area that need not be turned, less the share that must. */
static double vote_by_area(const laves__surface *s, const piece *p, const uint8_t *state) {
  double sum = 0, all = 0;
  for (size_t k = 0; k < p->count; k++) {
    const uint32_t *f = s->faces[p->faces[k]];
    const laves__vec3 a = s->points[f[0]];
    const double area = v3_norm(v3_cross(v3_sub(s->points[f[1]], a), v3_sub(s->points[f[2]], a)));
    all += area;
    sum += state[p->faces[k]] == 1 ? area : -area;
  }
  return all > 0 ? sum / all : 1;
}

static double vote_by_volume(const laves__surface *s, const piece *p, const uint8_t *state) {
  laves__box3 b = box3_empty();
  for (size_t k = 0; k < p->count; k++)
    for (int i = 0; i < 3; i++) b = box3_add(b, s->points[s->faces[p->faces[k]][i]]);
  const laves__vec3 centre = box3_centre(b);
  double sum = 0;
  for (size_t k = 0; k < p->count; k++) {
    const uint32_t *f = s->faces[p->faces[k]];
    const double volume = v3_det(centre, s->points[f[0]], s->points[f[1]], s->points[f[2]]);
    sum += state[p->faces[k]] == 1 ? volume : -volume;
  }
  return sum;
}

static void turn_piece(laves__surface *s, const piece *p, const uint8_t *state, uint8_t turned) {
  for (size_t k = 0; k < p->count; k++) {
    uint32_t *f = s->faces[p->faces[k]];
    if (state[p->faces[k]] != turned) continue;
    const uint32_t swap = f[1];
    f[1] = f[2];
    f[2] = swap;
  }
}

static bool agree_on_directions(laves__surface *s) {
  const size_t count = s->face_count;
  uint8_t *state = laves__alloc_zeroed(s->context, count, 1);
  uint32_t *list = laves__alloc(s->context, count, sizeof *list);
  const bool done = state && list;
  for (uint32_t f = 0; done && f < count; f++) {
    if (state[f]) continue;
    const piece p = collect(s, f, state, list);
    double vote = vote_by_area(s, &p, state);
    if (fabs(vote) < clear_vote) vote = vote_by_volume(s, &p, state);
    turn_piece(s, &p, state, vote >= 0 ? 2 : 1);
  }
  laves__free(s->context, state, count, 1);
  laves__free(s->context, list, count, sizeof *list);
  return done;
}

/* Makes nearly equal points one where that closes edges. */
static bool close_cracks(laves__surface *s, size_t open_edges) {
  laves__surface best = {.context = s->context};
  const bool done = try_tolerances(s, open_edges, &best);
  if (done) {
    memcpy(s->faces, best.faces, best.face_count * sizeof *s->faces);
    if (s->tags) memcpy(s->tags, best.tags, best.face_count * sizeof *s->tags);
    memcpy(s->sources, best.sources, best.face_count * sizeof *s->sources);
    s->face_count = best.face_count;
  }
  trial_free(&best);
  return done;
}

bool laves__surface_mend(laves__surface *s, size_t open_edges) {
  laves_domain_info facts = {0}, scratch = {0};
  bool parted = false;
  if (!close_cracks(s, open_edges) || !laves__surface_stitch(s, &parted) || !laves__surface_topology(s, &facts)) return false;
  /* Stitched edges that end at points nearly equal are cracks. */
  if (parted && facts.defects[LAVES_DEFECT_OPEN_EDGE] > 0) {
    if (!close_cracks(s, facts.defects[LAVES_DEFECT_OPEN_EDGE]) || !laves__surface_topology(s, &scratch)) return false;
  }
  return agree_on_directions(s);
}
