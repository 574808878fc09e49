/* Space is cut in blocks, coloured by the parity of their coordinates; see improve.c for why. All threads look for bad tets,
 * chunk by chunk of the layer, first to count, then to list them, and sort the list. */
#include "improve/patients.h"

#include <stdatomic.h>

#include "base/sort.h"

enum { CHUNK = 4096 };
static const double block_side = 15;  /* local sizes; see improve.c */
static const double wall_admit = 0.8; /* quality: about 37 to 128 degrees; enough for tets that span a wall */

bool laves__spans_wall(const laves__layer *layer, int32_t tet) {
  for (int k = 0; k < 4; k++) {
    const int32_t v = layer->tet[tet][k];
    if (layer->depth[v] != 0 || laves__layer_hold(layer, v).kind >= LAVES__HOLD_CREASE) return false;
  }
  return true;
}

bool laves__is_bad(const laves__layer *layer, const laves__admission *admission, int32_t tet) {
  if (layer->tet[tet][0] < 0 || !(layer->quality[tet] < admission->below)) return false;
  if (admission->near && !admission->near[tet]) return false;
  return !admission->thin || layer->quality[tet] < wall_admit || !laves__spans_wall(layer, tet);
}

/* The least power of two that no size at the corners of a tet exceeds. */
static int level_of(const laves__layer *layer, int32_t tet) {
  double largest = laves__layer_scale(layer, layer->tet[tet][0]);
  for (int k = 1; k < 4; k++) largest = fmax(largest, laves__layer_scale(layer, layer->tet[tet][k]));
  int level;
  return frexp(largest, &level) == 0.5 ? level - 1 : level;
}

static laves__patient admit(const laves__layer *layer, int32_t tet) {
  laves__vec3 p[4];
  laves__layer_points(layer, tet, p);
  const int level = level_of(layer, tet);
  const laves__vec3 c = v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25 / ldexp(block_side, level));
  laves__patient item = {.level = level,
                         .block = {(int32_t)floor(c.x), (int32_t)floor(c.y), (int32_t)floor(c.z)},
                         .tet = tet,
                         .quality = layer->quality[tet]};
  item.colour = (item.block[0] & 1) + 2 * (item.block[1] & 1) + 4 * (item.block[2] & 1);
  return item;
}

/* In a given mesh blocks are independent: all are of one colour. */
static laves__patient admit_given(const laves__blocks *given, const laves__layer *layer, int32_t tet) {
  return (laves__patient){.block = {laves__blocks_of(given, layer, tet)}, .tet = tet, .quality = layer->quality[tet]};
}

static bool same_block(const laves__patient *a, const laves__patient *b) {
  return a->level == b->level && a->block[0] == b->block[0] && a->block[1] == b->block[1] && a->block[2] == b->block[2];
}

static int by_level_colour_block_quality(const void *left, const void *right) {
  const laves__patient *a = left, *b = right;
  if (a->level != b->level) return a->level > b->level ? -1 : 1;
  if (a->colour != b->colour) return a->colour < b->colour ? -1 : 1;
  for (int axis = 2; axis >= 0; axis--)
    if (a->block[axis] != b->block[axis]) return a->block[axis] < b->block[axis] ? -1 : 1;
  if (a->quality != b->quality) return a->quality < b->quality ? -1 : 1;
  return a->tet < b->tet ? -1 : a->tet > b->tet;
}

/* The tets that are looked at: how many, and number i. */
static size_t count_tets(const laves__layer *layer, const laves__admission *admission) {
  return admission->list ? admission->list_count : layer->tet_count;
}
static int32_t tet_at(const laves__admission *admission, size_t i) { return admission->list ? admission->list[i] : (int32_t)i; }

/* What all threads share while they look. */
typedef struct search {
  const laves__layer *layer;
  const laves__admission *admission;
  const laves__blocks *given;
  size_t *found;        /* [chunks] how many each has; then where its items begin */
  laves__patient *item; /* NULL while they are counted */
  atomic_size_t bad;    /* counted, too, but not listed, are those that stand still */
} search;

static void look(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  search *s = user;
  for (size_t chunk = begin; chunk < end; chunk++) {
    const size_t first = chunk * CHUNK, rest = count_tets(s->layer, s->admission) - first;
    size_t count = 0, bad = 0;
    for (size_t i = first; i < first + (rest < CHUNK ? rest : CHUNK); i++) {
      const int32_t t = tet_at(s->admission, i);
      if (!laves__is_bad(s->layer, s->admission, t)) continue;
      bad++;
      if (s->given && laves__blocks_of(s->given, s->layer, t) < 0) continue;
      if (s->item) s->item[s->found[chunk] + count] = s->given ? admit_given(s->given, s->layer, t) : admit(s->layer, t);
      count++;
    }
    if (s->item) continue;
    s->found[chunk] = count;
    atomic_fetch_add(&s->bad, bad);
  }
}

static size_t chunks_of(const laves__layer *layer, const laves__admission *admission) {
  return (count_tets(layer, admission) + CHUNK - 1) / CHUNK;
}

/* Counts, and makes room: item[] for twice as many, as sorting needs. False when memory is short. */
static bool find_room(search *s, laves__patients *p) {
  laves_context *context = s->layer->context;
  for (size_t chunk = 0; chunk < chunks_of(s->layer, s->admission); chunk++) {
    const size_t count = s->found[chunk];
    s->found[chunk] = p->count;
    p->count += count;
  }
  return p->count == 0 || laves__grow(context, &p->item, &p->capacity, 2 * p->count, sizeof *p->item);
}

static bool find_blocks(laves_context *context, laves__patients *p) {
  for (size_t i = 0; i <= p->count; i++) {
    if (i > 0 && i < p->count && same_block(&p->item[i - 1], &p->item[i])) continue;
    if (!laves__grow(context, &p->block, &p->block_capacity, p->block_count + 1, sizeof *p->block)) return false;
    p->block[p->block_count++] = i;
  }
  p->block_count--;
  return true;
}

bool laves__patients_list(const laves__layer *layer, const laves__admission *admission, const laves__blocks *given,
                          laves__patients *p) {
  laves_context *context = layer->context;
  const size_t chunks = chunks_of(layer, admission);
  search s = {.layer = layer, .admission = admission, .given = given};
  atomic_init(&s.bad, 0);
  p->count = p->block_count = p->bad = 0;
  s.found = laves__alloc(context, chunks + 1, sizeof *s.found);
  if (!s.found) return false;
  bool memory = true, there = laves__parallel_for(context, NULL, chunks, 1, look, &s);
  p->bad = atomic_load(&s.bad);
  if (there) memory = find_room(&s, p);
  if (there && memory && p->count > 0) {
    s.item = p->item;
    there = laves__parallel_for(context, NULL, chunks, 1, look, &s) &&
            laves__sort(context, p->item, p->item + p->count, p->count, sizeof *p->item, by_level_colour_block_quality);
  }
  laves__free(context, s.found, chunks + 1, sizeof *s.found);
  if (!there) p->count = p->bad = 0;
  return memory && find_blocks(context, p);
}

void laves__patients_free(laves_context *context, laves__patients *p) {
  laves__free(context, p->item, p->capacity, sizeof *p->item);
  laves__free(context, p->block, p->block_capacity, sizeof *p->block);
}

typedef struct tally {
  const laves__layer *layer;
  const laves__admission *admission;
} tally;

static double count_some(const void *user, size_t begin, size_t end) {
  const tally *of = user;
  double count = 0;
  for (size_t i = begin; i < end; i++) count += laves__is_bad(of->layer, of->admission, tet_at(of->admission, i));
  return count;
}

size_t laves__count_bad(const laves__layer *layer, const laves__admission *admission) {
  const tally of = {layer, admission};
  return (size_t)laves__parallel_sum(layer->context, NULL, count_tets(layer, admission), count_some, &of);
}
