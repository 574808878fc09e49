/* Directions of closed parts: what it means that one lies within another, or crosses it.
 *
 * In: a surface with its parts and crossings, and what the caller wants.  Out: parts turned so that {winding number > level} is
 * the solid wanted, and facts for people.
 *
 *   union     every part faces outwards: the number is at least one wherever any part encloses
 *   nested    parts within an even number of others face outwards, the rest inwards: +1 -1 +1 from outside in
 *   direction nothing is turned here
 *
 * A part lies within another when most of some places on it do and the two do not cross. A place is asked by the other part's
 * own winding number. */
#include <stdlib.h>
#include <string.h>

#include "domain/surface.h"

enum { PLACES = 9 };

/* ---- which parts cross ---- */

typedef struct part_pair {
  uint32_t low, high;
} part_pair;

typedef struct part_pairs {
  part_pair *pair; /* [capacity] sorted, each once */
  size_t count, capacity;
} part_pairs;

static int compare_pairs(const void *a, const void *b) {
  const part_pair *x = a, *y = b;
  if (x->low != y->low) return x->low < y->low ? -1 : 1;
  return (x->high > y->high) - (x->high < y->high);
}

static bool find_crossing_parts(const laves__surface *s, const laves__crossings *c, part_pairs *pairs) {
  pairs->pair = laves__alloc(s->context, c->count, sizeof *pairs->pair);
  if (!pairs->pair) return false;
  pairs->capacity = c->count;
  for (size_t i = 0; i < c->count; i++) {
    const uint32_t a = s->part[c->pairs[i][0]], b = s->part[c->pairs[i][1]];
    if (a != b) pairs->pair[pairs->count++] = a < b ? (part_pair){a, b} : (part_pair){b, a};
  }
  qsort(pairs->pair, pairs->count, sizeof *pairs->pair, compare_pairs);
  size_t kept = 0;
  for (size_t i = 0; i < pairs->count; i++)
    if (kept == 0 || compare_pairs(&pairs->pair[kept - 1], &pairs->pair[i]) != 0) pairs->pair[kept++] = pairs->pair[i];
  pairs->count = kept;
  return true;
}

static bool cross(const part_pairs *pairs, uint32_t a, uint32_t b) {
  const part_pair wanted = a < b ? (part_pair){a, b} : (part_pair){b, a};
  return pairs->count > 0 && bsearch(&wanted, pairs->pair, pairs->count, sizeof wanted, compare_pairs) != NULL;
}

/* ---- depth ---- */

typedef struct nesting {
  laves__surface *s;
  laves__parts *parts;
  laves__part_faces faces;
  part_pairs crossing;
  bool *crossed;   /* [part count] by number: crosses another */
  uint32_t *votes; /* [part count] of the part in question: places within each other part; zero between questions */
  uint32_t *asked; /* [part count] parts with votes */
  size_t asked_count;
} nesting;

static void vote(void *user, size_t part) {
  nesting *n = user;
  if (n->votes[part]++ == 0) n->asked[n->asked_count++] = (uint32_t)part;
}

/* In how many others a part lies. Its places are the middles of faces spread over it. */
static uint32_t depth_of(nesting *n, size_t part) {
  const uint32_t own = laves__parts_number(n->parts, part), first = n->faces.starts[own];
  const size_t count = n->faces.starts[own + 1] - first, places = count < PLACES ? count : PLACES;
  n->asked_count = 0;
  for (size_t i = 0; i < places; i++) {
    const laves__triangle *t = &n->s->bvh.triangles[n->faces.slots[first + i * count / places]];
    laves__parts_around(n->parts, v3_scale(v3_add(t->a, v3_add(t->b, t->c)), 1.0 / 3), vote, n);
  }
  uint32_t depth = 0;
  for (size_t i = 0; i < n->asked_count; i++) {
    const uint32_t other = n->asked[i];
    depth += other != part && 2 * n->votes[other] > places && !cross(&n->crossing, own, laves__parts_number(n->parts, other));
    n->votes[other] = 0;
  }
  return depth;
}

/* ---- turning ---- */

static bool should_face_inwards(laves_overlap overlap, uint32_t depth, bool faces_inwards) {
  switch (overlap) {
    case LAVES_OVERLAP_UNION:
      return false;
    case LAVES_OVERLAP_NESTED:
      return depth % 2 == 1;
    default:
      return faces_inwards;
  }
}

static void turn_part(nesting *n, uint32_t number) {
  for (uint32_t i = n->faces.starts[number]; i < n->faces.starts[number + 1]; i++)
    laves__surface_turn_face(n->s, n->faces.slots[i]);
}

static void mark_crossed(nesting *n) {
  for (size_t i = 0; i < n->crossing.count; i++) {
    n->crossed[n->crossing.pair[i].low] = true;
    n->crossed[n->crossing.pair[i].high] = true;
  }
}

/* False when cancelled. */
static bool direct(nesting *n, laves_domain_info *info, bool *turned) {
  mark_crossed(n);
  const size_t count = laves__parts_count(n->parts);
  for (size_t part = 0; part < count; part++) {
    if (laves__cancelled(n->s->context, "surface", (double)part / (double)count)) return false; /* parts may be large */
    const uint32_t number = laves__parts_number(n->parts, part), depth = depth_of(n, part);
    const bool inwards = laves__parts_volume(n->parts, part) < 0;
    const bool wanted = should_face_inwards(info->overlap, depth, inwards);
    info->nested_parts += depth > 0;
    info->hollow_parts += depth > 0 && wanted;
    info->crossing_parts += n->crossed[number];
    if (wanted == inwards) continue;
    turn_part(n, number);
    *turned = true;
  }
  return true;
}

bool laves__surface_direct_parts(laves__surface *s, const laves__crossings *c, laves_domain_info *info, bool *turned) {
  nesting n = {.s = s};
  *turned = false;
  if (s->part_count < 2) return true;
  n.parts = laves__parts_create(s, true);
  n.crossed = laves__alloc_zeroed(s->context, s->part_count, sizeof *n.crossed);
  n.votes = laves__alloc_zeroed(s->context, s->part_count, sizeof *n.votes);
  n.asked = laves__alloc(s->context, s->part_count, sizeof *n.asked);
  const bool done = laves__part_faces_list(s, &n.faces) && n.parts && n.crossed && n.votes && n.asked &&
                    find_crossing_parts(s, c, &n.crossing) && direct(&n, info, turned);
  laves__parts_free(n.parts);
  laves__part_faces_free(s->context, &n.faces);
  laves__free(s->context, n.crossed, s->part_count, sizeof *n.crossed);
  laves__free(s->context, n.votes, s->part_count, sizeof *n.votes);
  laves__free(s->context, n.asked, s->part_count, sizeof *n.asked);
  laves__free(s->context, n.crossing.pair, n.crossing.capacity, sizeof *n.crossing.pair);
  return done;
}
