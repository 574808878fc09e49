/* Depths of sites: how many edges each is from the boundary, as far as the layer reaches.
 *
 * Level by level, each by all threads over the records: those of one level give the next to their neighbours inside, by a store
 * that others may make at the same time with the same value. */
#include "snap/snap.h"

/* What all threads share. */
typedef struct search {
  laves__lattice *lattice;
  uint8_t depth; /* of the level */
} search;

/* Depth 0: ON sites that bound kept tets or pieces. Depth 1: ON sites whose star is whole. */
static void begin_at_surface(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const search *s = user;
  for (size_t i = begin; i < end; i++) {
    laves__record *r = &s->lattice->record[i];
    for (int site = 0; site < LAVES__C15_SITES; site++) {
      if (r->label[site] != LAVES__LABEL_ON) continue;
      const uint64_t kept = laves__star_kept(s->lattice, (int32_t)i, site);
      if (kept) r->depth[site] = kept == laves__whole_star(s->lattice, (laves__site){(int32_t)i, (uint8_t)site});
    }
  }
}

/* The corners of pieces: 0 where they are ON, 1 inside. */
static void begin_at_cuts(const laves__lattice *lattice, const laves__cuts *cuts) {
  for (size_t t = 0; t < cuts->tet_count; t++)
    for (int k = 0; k < 4; k++) {
      const uint32_t id = cuts->tet[t][k];
      if (id & LAVES__CUT_VERTEX) continue;
      laves__record *r = &lattice->record[id / LAVES__C15_SITES];
      const int site = (int)(id % LAVES__C15_SITES);
      const uint8_t depth = r->label[site] != LAVES__LABEL_ON;
      if (r->depth[site] > depth) r->depth[site] = depth;
    }
}

static void deepen(const search *s, laves__site at) {
  const laves__ring ring = laves__ring_of(s->lattice, at);
  const uint8_t next = s->depth + 1;
  for (int k = 0; k < ring.count; k++) {
    const laves__site other = laves__ring_at(&ring, k);
    if (other.cell < 0) continue;
    laves__record *r = &s->lattice->record[other.cell];
    if (r->label[other.site] != LAVES__LABEL_IN || __atomic_load_n(&r->depth[other.site], __ATOMIC_RELAXED) <= next) continue;
    __atomic_store_n(&r->depth[other.site], next, __ATOMIC_RELAXED);
  }
}

static void deepen_records(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const search *s = user;
  for (size_t i = begin; i < end; i++)
    for (int site = 0; site < LAVES__C15_SITES; site++)
      if (__atomic_load_n(&s->lattice->record[i].depth[site], __ATOMIC_RELAXED) == s->depth)
        deepen(s, (laves__site){(int32_t)i, (uint8_t)site});
}

bool laves__measure_depths(laves__lattice *lattice, const laves__cuts *cuts) {
  enum { BLOCK = 16 };
  search s = {lattice, 0};
  bool done = laves__parallel_for(lattice->context, "snap", lattice->record_count, BLOCK, begin_at_surface, &s);
  if (done && cuts) begin_at_cuts(lattice, cuts);
  for (; done && s.depth < LAVES__DEPTH_MAX; s.depth++)
    done = laves__parallel_for(lattice->context, "snap", lattice->record_count, BLOCK, deepen_records, &s);
  return done;
}
