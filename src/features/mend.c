/* Faces whose corners have no patch in common, though each two of them do: near corners, and where features crowd.
 *
 * In: holds after the cover.  Out: fewer such faces.
 *
 * Two remedies, tried in turn until neither helps: a vertex of the face takes another hold that is known around it, if that
 * leaves fewer illegal faces and edges around it; or a corner near by moves to another vertex, and the old one takes what suits
 * it. The second is dear, and where many faces are illegal corners are closer than vertices, and have nowhere to go. */
#include "features/keep.h"

enum { CANDIDATES_MAX = 48, ROUNDS = 4 };

typedef struct candidates {
  laves__hold hold[CANDIDATES_MAX];
  int count;
} candidates;

static void add(candidates *c, laves__hold hold) {
  for (int i = 0; i < c->count; i++)
    if (c->hold[i].kind == hold.kind && c->hold[i].id == hold.id) return;
  if (c->count < CANDIDATES_MAX) c->hold[c->count++] = hold;
}

static void add_patches(const laves__features *f, laves__hold of, candidates *c) {
  int32_t room[2];
  const int32_t *list;
  const int count = laves__hold_patches(f, of, room, &list);
  for (int i = 0; i < count; i++) add(c, (laves__hold){list[i], LAVES__HOLD_PATCH});
}

/* What a neighbour is held to, as far as another vertex could be, too. */
static void add_neighbour(const laves__features *f, laves__hold hold, candidates *c) {
  if (hold.kind == LAVES__HOLD_SURFACE) return;
  add_patches(f, hold, c);
  if (hold.kind == LAVES__HOLD_CREASE) add(c, hold);
  if (hold.kind != LAVES__HOLD_CORNER) return;
  const laves__corner *corner = &f->corner[hold.id];
  for (uint32_t i = 0; i < corner->crease_count; i++)
    add(c, (laves__hold){f->corner_crease[corner->first_crease + i], LAVES__HOLD_CREASE});
}

static void list_candidates(const laves__keeping *k, int32_t vertex, candidates *c) {
  const laves__rim *rim = &k->rim;
  c->count = 0;
  if (k->start_patch[vertex] != LAVES__NO_FEATURE) add(c, (laves__hold){k->start_patch[vertex], LAVES__HOLD_PATCH});
  for (uint32_t i = rim->first[vertex]; i < rim->first[vertex + 1]; i++)
    add_neighbour(k->features, k->layer->hold[laves__rim_next(rim, rim->at[i], vertex)], c);
}

/* The hold that leaves the fewest illegal faces and edges around a vertex, of several the nearest; it is given. Returns how many
 * remain. */
static int relabel(const laves__keeping *k, int32_t vertex) {
  laves__hold *hold = &k->layer->hold[vertex];
  laves__hold best = *hold;
  int fewest = best.kind == LAVES__HOLD_CORNER ? INT32_MAX : laves__illegal_around(k, vertex);
  double nearest = 0;
  candidates c;
  list_candidates(k, vertex, &c);
  for (int i = 0; i < c.count; i++) {
    laves__vec3 place;
    *hold = c.hold[i];
    const int illegal = laves__illegal_around(k, vertex);
    if (illegal > fewest || (illegal == fewest && nearest == 0) || !laves__held_place(k, vertex, *hold, &place)) continue;
    const double way = v3_distance(place, k->start[vertex]);
    if (illegal == fewest && !(way < nearest)) continue;
    fewest = illegal;
    nearest = way;
    best = *hold;
  }
  *hold = best;
  return fewest;
}

static bool relabel_face(const laves__keeping *k, uint32_t face) {
  for (int j = 0; j < 3; j++) {
    const int32_t v = k->rim.face[face][j];
    if (k->layer->hold[v].kind == LAVES__HOLD_CORNER) continue;
    const int before = laves__illegal_around(k, v);
    if (relabel(k, v) < before) return true;
  }
  return false;
}

static bool is_legal(const laves__keeping *k, uint32_t face) {
  laves__hold hold[3];
  laves__face_holds(k, face, hold);
  return laves__face_is_legal(k->features, hold);
}

/* Illegal faces and edges around the ends of an edge. Those at both count once: when this falls there are fewer in all, so moves
 * that lower it come to an end. */
static int illegal_about(const laves__keeping *k, int32_t a, int32_t b) {
  const laves__rim *rim = &k->rim;
  int count = laves__illegal_around(k, a) + laves__illegal_around(k, b) - !laves__edge_is_legal(k, a, b);
  for (uint32_t i = rim->first[a]; i < rim->first[a + 1]; i++) {
    const int32_t *face = rim->face[rim->at[i]];
    if (face[0] == b || face[1] == b || face[2] == b) count -= !is_legal(k, rim->at[i]);
  }
  return count;
}

/* Lets a neighbour stand at the corner in a vertex's place, if that leaves fewer illegal faces about both. */
static bool move_corner(laves__keeping *k, int32_t vertex) {
  const laves__rim *rim = &k->rim;
  laves__hold *hold = k->layer->hold;
  const laves__hold corner = hold[vertex];
  for (uint32_t i = rim->first[vertex]; i < rim->first[vertex + 1]; i++) {
    const int32_t other = laves__rim_next(rim, rim->at[i], vertex);
    const laves__hold was = hold[other];
    if (was.kind == LAVES__HOLD_CORNER) continue;
    const int before = illegal_about(k, vertex, other);
    hold[other] = corner;
    relabel(k, vertex);
    if (hold[vertex].kind != LAVES__HOLD_CORNER && illegal_about(k, vertex, other) < before) {
      k->claimed[corner.id] = other;
      return true;
    }
    hold[other] = was;
    hold[vertex] = corner;
  }
  return false;
}

static bool move_corner_near(laves__keeping *k, uint32_t face) {
  const laves__rim *rim = &k->rim;
  for (int j = 0; j < 3; j++) {
    const int32_t v = rim->face[face][j];
    if (k->layer->hold[v].kind == LAVES__HOLD_CORNER && move_corner(k, v)) return true;
    for (uint32_t i = rim->first[v]; i < rim->first[v + 1]; i++) {
      const int32_t w = laves__rim_next(rim, rim->at[i], v);
      if (k->layer->hold[w].kind == LAVES__HOLD_CORNER && move_corner(k, w)) return true;
    }
  }
  return false;
}

/* Where more faces than these are illegal, in number and share, corners stay. */
static const size_t crowd_min = 100;
static const double crowd_share = 0.05;

static bool is_crowded(const laves__keeping *k) {
  size_t illegal = 0;
  for (uint32_t f = 0; f < k->rim.face_count; f++) illegal += !is_legal(k, f);
  return illegal > crowd_min && (double)illegal > crowd_share * (double)k->rim.face_count;
}

void laves__mend_faces(laves__keeping *k) {
  const bool corners_stay = is_crowded(k);
  bool again = true;
  for (int round = 0; round < ROUNDS && again; round++) {
    again = false;
    for (uint32_t f = 0; f < k->rim.face_count && !laves__cancelled_at(k->context, "features", f, k->rim.face_count); f++)
      while (!is_legal(k, f) && (relabel_face(k, f) || (!corners_stay && move_corner_near(k, f)))) again = true;
  }
}
