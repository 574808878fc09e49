/* The check of a mesh that stays in its file: one pass over its tets, in batches.
 *
 * The calling thread takes the next tets and fetches their corners from the cache of points; all threads then measure blocks of
 * them, with the very tallies of the check in memory, and list their faces by the shards of the face table; all threads put these
 * into the table. Blocks of tets are those of the check in memory and merged in their order, so every digit is the same.
 *
 * The pass is repeated where a vertex was used after it had been closed (see face_table.c), with faces there kept, or where every
 * tet turned out to be negative, with all of them turned, as they are when a file is read into memory.
 *
 * Nothing here grows with the number of tets but their count. */
#include "certify/check_stream.h"

#include <string.h>

#include "base/predicates.h"
#include "certify/shape_tally.h"
#include "certify/window.h"
#include "mesh/face_match.h"

enum {
  BLOCKS_MIN = 4,        /* of LAVES__TALLY_TETS tets in a batch */
  BLOCKS_PER_WORKER = 2, /* at least */
  BLOCK_FACES = 4 * LAVES__TALLY_TETS,
  UNUSABLE = 2,
};

/* What is counted and measured of a block of tets. */
typedef struct block {
  laves__shape_tally tally;
  size_t bad_indices, inverted;
  bool any_positive, any_negative;         /* by rounded volumes, as those ask who turn meshes */
  double shortest, longest;                /* edges, squared */
  uint32_t starts[LAVES__FACE_SHARDS + 1]; /* of each shard's records among the block's */
} block;

/* A tet outside the window. */
typedef struct found {
  uint64_t key; /* laves__badness_key() */
  uint64_t tet;
  laves__vec3 corners[4];
  bool usable;
} found;

typedef struct sweep {
  laves_context *context;
  laves__mesh_stream *stream;
  const laves_file_check_options *options;
  laves__window window;
  laves__point_cache cache;
  laves__face_table table;
  bool turned;   /* exchange two corners of every tet */
  bool measured; /* in an earlier pass */
  /* The batch. */
  size_t block_count, count; /* blocks at most, and tets */
  uint64_t first;            /* tets before it */
  uint32_t label;            /* of its first tet */
  int32_t (*tets)[4];
  laves__vec3 (*corners)[4];
  int8_t *orientation;
  double *badness;
  laves__face_entry *records; /* [block_count][BLOCK_FACES] */
  block *blocks;
  /* All of them. */
  block all;
  found *worst; /* [place_capacity] a heap: the best of the worst on top */
  size_t worst_count, outside;
} sweep;

/* ---- memory ---- */

static laves_result make_batch(sweep *s, laves_error *error) {
  laves_context *context = s->context;
  const size_t per_worker = (size_t)laves__workers(context) * BLOCKS_PER_WORKER;
  s->block_count = per_worker > BLOCKS_MIN ? per_worker : BLOCKS_MIN;
  const size_t tets = s->block_count * LAVES__TALLY_TETS, places = s->options->place_capacity;
  s->tets = laves__alloc(context, tets, sizeof *s->tets);
  s->corners = laves__alloc(context, tets, sizeof *s->corners);
  s->orientation = laves__alloc(context, tets, 1);
  s->badness = laves__alloc(context, tets, sizeof *s->badness);
  s->records = laves__alloc(context, s->block_count * BLOCK_FACES, sizeof *s->records);
  s->blocks = laves__alloc(context, s->block_count, sizeof *s->blocks);
  s->worst = laves__alloc(context, places, sizeof *s->worst);
  if (s->tets && s->corners && s->orientation && s->badness && s->records && s->blocks && s->worst) return LAVES_OK;
  return laves__fail_memory(context, error);
}

static void free_batch(sweep *s) {
  laves_context *context = s->context;
  const size_t tets = s->block_count * LAVES__TALLY_TETS;
  laves__free(context, s->tets, tets, sizeof *s->tets);
  laves__free(context, s->corners, tets, sizeof *s->corners);
  laves__free(context, s->orientation, tets, 1);
  laves__free(context, s->badness, tets, sizeof *s->badness);
  laves__free(context, s->records, s->block_count * BLOCK_FACES, sizeof *s->records);
  laves__free(context, s->blocks, s->block_count, sizeof *s->blocks);
  s->tets = NULL;
  s->corners = NULL;
  s->orientation = NULL;
  s->badness = NULL;
  s->records = NULL;
  s->blocks = NULL;
}

/* ---- one block, any thread ---- */

static size_t block_end(const sweep *s, size_t b) {
  const size_t end = (b + 1) * LAVES__TALLY_TETS;
  return end < s->count ? end : s->count;
}

static size_t bad_corners(const int32_t tet[4]) {
  size_t bad = 0;
  for (int i = 1; i < 4; i++) {
    bool repeated = false;
    for (int j = 0; j < i; j++) repeated |= tet[j] == tet[i];
    bad += repeated;
  }
  return bad;
}

static void measure_edges(block *b, const laves__vec3 p[4]) {
  for (int i = 0; i < 6; i++) {
    const double square = v3_norm2(v3_sub(p[laves__tet_edge[i][1]], p[laves__tet_edge[i][0]]));
    if (!isfinite(square)) continue;
    b->shortest = fmin(b->shortest, square);
    b->longest = fmax(b->longest, square);
  }
}

static void clear_block(block *b) {
  *b = (block){.shortest = INFINITY};
  laves__shape_tally_clear(&b->tally);
}

static void measure_tet(const sweep *s, block *b, laves__shape_queue *queue, size_t t) {
  const laves__vec3 *p = s->corners[t];
  double value;
  const double det = v3_det(p[0], p[1], p[2], p[3]);
  b->any_positive |= det > 0;
  b->any_negative |= det < 0;
  s->orientation[t] = UNUSABLE;
  s->badness[t] = LAVES__UNMEASURABLE;
  if (!laves__tet_usable(s->tets[t], s->stream->point_count)) {
    b->bad_indices += bad_corners(s->tets[t]);
    return;
  }
  s->orientation[t] = (int8_t)laves__orient3d(p[0], p[1], p[2], p[3]);
  b->inverted += s->orientation[t] <= 0;
  if (s->measured) return;
  s->badness[t] = laves__window_badness(&s->window, p, &value);
  laves__shape_tally_add(&b->tally, queue, p, (size_t)s->first + t);
  measure_edges(b, p);
}

static size_t make_record(const sweep *s, size_t t, int face, laves__face_entry *record) {
  int32_t outwards[3];
  laves__face_outwards(s->tets[t], face, s->orientation[t], outwards);
  return laves__face_record(outwards, 4 * (s->first + t) + (uint64_t)face, (uint32_t)t, record);
}

/* Lists the faces of a block shard by shard, each in the order of the tets: they are counted, then placed. */
static void list_faces(const sweep *s, block *b, size_t begin, size_t end, laves__face_entry *records) {
  uint32_t counts[LAVES__FACE_SHARDS] = {0};
  uint8_t shards[BLOCK_FACES];
  laves__face_entry record;
  for (size_t t = begin, i = 0; t < end; t++)
    for (int face = 0; face < 4 && s->orientation[t] != UNUSABLE; face++) {
      const size_t shard = make_record(s, t, face, &record);
      shards[i++] = (uint8_t)shard;
      counts[shard]++;
    }
  b->starts[0] = 0;
  for (size_t k = 0; k < LAVES__FACE_SHARDS; k++) {
    b->starts[k + 1] = b->starts[k] + counts[k];
    counts[k] = b->starts[k];
  }
  for (size_t t = begin, i = 0; t < end; t++)
    for (int face = 0; face < 4 && s->orientation[t] != UNUSABLE; face++)
      make_record(s, t, face, &records[counts[shards[i++]]++]);
}

static void measure_blocks(void *user, size_t begin, size_t end, int worker) {
  const sweep *s = user;
  laves__shape_queue queue;
  laves__shape_queue_clear(&queue);
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    const size_t first = b * LAVES__TALLY_TETS, last = block_end(s, b);
    clear_block(&s->blocks[b]);
    for (size_t t = first; t < last; t++) measure_tet(s, &s->blocks[b], &queue, t);
    laves__shape_tally_flush(&s->blocks[b].tally, &queue);
    list_faces(s, &s->blocks[b], first, last, s->records + b * BLOCK_FACES);
  }
}

static void use_blocks(void *user, size_t begin, size_t end, int worker) {
  sweep *s = user;
  (void)worker;
  for (size_t b = begin; b < end; b++)
    for (size_t t = b * LAVES__TALLY_TETS; t < block_end(s, b); t++) {
      if (s->orientation[t] == UNUSABLE) laves__face_table_drop_label(&s->table, s->label + (uint32_t)t);
      for (int i = 0; i < 4 && s->orientation[t] != UNUSABLE; i++) laves__face_table_use(&s->table, s->tets[t][i]);
    }
}

/* ---- one shard, any thread ---- */

static size_t blocks_in_use(const sweep *s) { return (s->count + LAVES__TALLY_TETS - 1) / LAVES__TALLY_TETS; }

static void insert_shards(void *user, size_t begin, size_t end, int worker) {
  sweep *s = user;
  (void)worker;
  for (size_t shard = begin; shard < end; shard++)
    for (size_t b = 0; b < blocks_in_use(s); b++) {
      const uint32_t first = s->blocks[b].starts[shard], last = s->blocks[b].starts[shard + 1];
      laves__face_table_insert(&s->table, shard, s->records + b * BLOCK_FACES + first, last - first, s->label);
    }
}

/* ---- one batch ---- */

/* How much of the whole check is done; the rest is the boundary's. */
static double fraction_of(const sweep *s) { return 0.8 * s->stream->fraction; }

/* The next tets and their corners. */
static laves_result fetch_batch(sweep *s, laves_error *error) {
  laves__mesh_stream *stream = s->stream;
  laves_result result = stream->next(stream->user, s->tets, s->block_count * LAVES__TALLY_TETS, &s->count, error);
  for (size_t t = 0; t < s->count && result == LAVES_OK; t++) {
    int32_t *tet = s->tets[t];
    if (s->turned) {
      const int32_t swapped = tet[2];
      tet[2] = tet[3];
      tet[3] = swapped;
    }
    for (int i = 0; i < 4 && result == LAVES_OK; i++)
      result = laves__point_cache_get(&s->cache, tet[i], &s->corners[t][i], error);
    if (t % LAVES__TALLY_TETS == 0 && laves__cancelled(s->context, "check", fraction_of(s))) return laves__fail_cancelled(error);
  }
  return result;
}

/* True when a is better than b, or as bad and later. */
static bool better(const found *a, const found *b) { return a->key != b->key ? a->key > b->key : a->tet > b->tet; }

static void sift_down(found *heap, size_t count) {
  const found item = heap[0];
  size_t at = 0;
  for (size_t child; (child = 2 * at + 1) < count; at = child) {
    if (child + 1 < count && better(&heap[child + 1], &heap[child])) child++;
    if (!better(&heap[child], &item)) break;
    heap[at] = heap[child];
  }
  heap[at] = item;
}

static void sift_up(found *heap, size_t at) {
  const found item = heap[at];
  for (; at > 0 && better(&item, &heap[(at - 1) / 2]); at = (at - 1) / 2) heap[at] = heap[(at - 1) / 2];
  heap[at] = item;
}

static void note_outside(sweep *s, size_t t) {
  found item = {laves__badness_key(s->badness[t]), s->first + t, {{0, 0, 0}}, s->orientation[t] != UNUSABLE};
  memcpy(item.corners, s->corners[t], sizeof item.corners);
  s->outside++;
  if (s->worst_count < s->options->place_capacity) {
    s->worst[s->worst_count] = item;
    sift_up(s->worst, s->worst_count++);
  } else if (s->worst_count > 0 && better(&s->worst[0], &item)) {
    s->worst[0] = item;
    sift_down(s->worst, s->worst_count);
  }
}

/* Names the worst tets by each measure while their corners are at hand. */
static void name_worst(const sweep *s, laves_check *check) {
  int64_t worst[LAVES__MEASURES];
  laves__shape_tally_worst(&s->all.tally, worst);
  for (int m = 0; m < LAVES__MEASURES; m++)
    if (worst[m] >= 0 && (uint64_t)worst[m] >= s->first)
      laves__shape_tally_place(m, worst[m], s->corners[(uint64_t)worst[m] - s->first], check);
}

/* Adds the batch to what was before it, in the order of its tets. */
static void merge_batch(sweep *s, laves_check *check) {
  for (size_t b = 0; b < blocks_in_use(s); b++) {
    const block *more = &s->blocks[b];
    s->all.bad_indices += more->bad_indices;
    s->all.inverted += more->inverted;
    s->all.any_positive |= more->any_positive;
    s->all.any_negative |= more->any_negative;
    if (s->measured) continue;
    laves__shape_tally_merge(&s->all.tally, &more->tally);
    s->all.shortest = fmin(s->all.shortest, more->shortest);
    s->all.longest = fmax(s->all.longest, more->longest);
  }
  if (s->measured) return;
  name_worst(s, check);
  for (size_t t = 0; t < s->count; t++)
    if (s->badness[t] > 0) note_outside(s, t);
}

/* Measures a batch and puts its faces into the table. */
static laves_result take_batch(sweep *s, laves_check *check, laves_error *error) {
  laves_context *context = s->context;
  const size_t blocks = blocks_in_use(s);
  size_t counts[LAVES__FACE_SHARDS] = {0};
  s->table.fraction = fraction_of(s);
  if (!laves__parallel_for(context, NULL, blocks, 1, measure_blocks, s)) return laves__fail_cancelled(error);
  for (size_t b = 0; b < blocks; b++)
    for (size_t k = 0; k < LAVES__FACE_SHARDS; k++) counts[k] += s->blocks[b].starts[k + 1] - s->blocks[b].starts[k];
  if (!laves__face_table_reserve(&s->table, counts, s->count, &s->label)) return laves__fail_memory(context, error);
  if (!laves__parallel_for(context, NULL, blocks, 1, use_blocks, s) ||
      !laves__parallel_for(context, NULL, LAVES__FACE_SHARDS, 1, insert_shards, s))
    return laves__fail_cancelled(error);
  merge_batch(s, check);
  s->first += s->count;
  return LAVES_OK;
}

/* ---- passes ---- */

static laves_result run_pass(sweep *s, laves_check *check, laves_error *error) {
  laves_result result = LAVES_OK;
  s->first = 0;
  s->all.bad_indices = s->all.inverted = 0;
  s->stream->rewind(s->stream->user, 4);
  do {
    result = fetch_batch(s, error);
    if (result == LAVES_OK) result = take_batch(s, check, error);
  } while (result == LAVES_OK && s->count > 0);
  if (result == LAVES_OK && s->first == 0)
    return laves__fail(error, LAVES_ERROR_INPUT, "%s: there are no tetrahedra in it", s->stream->name);
  return result;
}

static void forget_measures(sweep *s, laves_check *check) {
  memset(check, 0, sizeof *check);
  for (int m = 0; m < LAVES__MEASURES; m++) laves__shape_tally_place(m, -1, NULL, check);
  clear_block(&s->all);
  s->worst_count = s->outside = 0;
  s->measured = false;
}

/* Passes until one has seen everything: the first, one with all tets turned where they were all negative, one that keeps faces at
 * the vertices that were reopened, and, where that reopened others, one that keeps all faces. */
static laves_result run_passes(sweep *s, laves_check *check, laves_error *error) {
  forget_measures(s, check);
  for (int repeated = 0;;) {
    const laves_result result = run_pass(s, check, error);
    if (result != LAVES_OK) return result;
    if (!s->turned && !s->all.any_positive && s->all.any_negative) {
      s->turned = true;
      forget_measures(s, check);
    } else if (atomic_load(&s->table.was_reopened) && !s->table.keep_all) {
      s->measured = true;
      s->table.keep_all = repeated++ > 0;
    } else {
      return LAVES_OK;
    }
    laves__face_table_restart(&s->table);
  }
}

/* ---- results ---- */

static void report(sweep *s, laves_check *check) {
  const size_t used = laves__face_table_used(&s->table);
  check->tets = (size_t)s->first;
  check->vertices = s->stream->higher_order ? used : s->stream->point_count; /* nodes that are no corners are dropped */
  check->unused_vertices = check->vertices - used;
  check->bad_indices = s->all.bad_indices;
  check->inverted_tets = s->all.inverted;
  check->nonconforming_faces = laves__face_table_count(&s->table, LAVES__FACE_BAD);
  check->components = laves__face_table_components(&s->table);
  laves__shape_tally_report(&s->all.tally, check);
  check->edge_min = s->all.longest > 0 || isfinite(s->all.shortest) ? sqrt(s->all.shortest) : 0;
  check->edge_max = sqrt(s->all.longest);
  check->edge_mean = NAN;
  check->domain_volume = NAN;
}

/* Takes the worst tets from the heap, the last of them first, and describes them. */
static laves_result list_outside(sweep *s, laves_file_check *check, laves_error *error) {
  check->outside_window = s->outside;
  for (size_t left = s->worst_count; left > 0; left--) {
    if (laves__cancelled_at(s->context, "check", 0, 1)) return laves__fail_cancelled(error);
    const found item = s->worst[0];
    const laves__vec3 *p = item.corners;
    laves_place *place = &s->options->places[left - 1];
    s->worst[0] = s->worst[left - 1];
    sift_down(s->worst, left - 1);
    *place = (laves_place){.tet = (int64_t)item.tet, .curvature_radius = NAN};
    if (!item.usable) continue;
    laves__window_badness(&s->window, p, &place->value);
    laves__place_of_tet(p, s->options->domain, place);
  }
  return LAVES_OK;
}

/* Bytes for points: no more than a quarter of what the limit leaves. */
static size_t cache_bytes(const laves_context *context, size_t wished) {
  const double room = laves__room(context) / 4;
  return (double)wished < room ? wished : (size_t)room;
}

laves_result laves__check_stream(laves_context *context, laves__mesh_stream *stream, const laves_file_check_options *options,
                                 laves_file_check *check, laves_error *error) {
  sweep s = {.context = context,
             .stream = stream,
             .options = options,
             .window = laves__window_make(options->min_dihedral, options->max_dihedral, options->volume_length)};
  laves_check *facts = &check->check;
  memset(check, 0, sizeof *check);
  laves_result result = laves__point_cache_make(&s.cache, context, stream, cache_bytes(context, options->cache_bytes), error);
  if (result == LAVES_OK) result = laves__face_table_make(&s.table, context, stream->point_count, error);
  if (result == LAVES_OK) result = make_batch(&s, error);
  if (result == LAVES_OK) result = run_passes(&s, facts, error);
  if (result == LAVES_OK) result = laves__point_cache_see_all(&s.cache, error);
  if (result == LAVES_OK) report(&s, facts);
  if (result == LAVES_OK) result = list_outside(&s, check, error);
  free_batch(&s);
  if (result == LAVES_OK) result = laves__check_stream_boundary(context, &s.table, &s.cache, options->domain, check, error);
  facts->valid = result == LAVES_OK && laves__check_is_valid(facts);
  laves__free(context, s.worst, options->place_capacity, sizeof *s.worst);
  laves__face_table_free(&s.table);
  laves__point_cache_free(&s.cache);
  return result;
}
