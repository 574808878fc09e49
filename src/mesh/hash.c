/* The hash of a mesh: the same digits mean the same points, tets, faces, regions and tags, bit for bit.
 *
 * Arrays are cut into fixed blocks, whose hashes are taken in parallel and folded in order, each being the seed of the
 * next; so the result does not depend on the threads. Every array begins with a header of its kind and size, so that one
 * array cannot pass for the end of another.
 *
 * Source: MurmurHash3 in its variant x64 with 128 bits [appleby2011], written anew, with a seed of 128 bits. */
#include "mesh/hash128.h"

#include <stdio.h>
#include <string.h>

#include "mesh/mesh.h"

enum {
  BLOCK_BYTES = 1 << 18, /* large against the cost of handing out a block, small enough to share a mesh of a few MB */
  BATCH_BLOCKS = 256,    /* blocks whose hashes wait on the stack before they are folded */
};

static const uint64_t multiplier_low = 0x87c37b91114253d5, multiplier_high = 0x4cf5ad432745937f;

static uint64_t rotate(uint64_t x, int bits) { return x << bits | x >> (64 - bits); }

/* Eight bytes as in little-endian memory. A big-endian machine reads doubles right already, but two integers swapped. */
static uint64_t word(const unsigned char *bytes, size_t element) {
  uint64_t w;
  memcpy(&w, bytes, sizeof w);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
  if (element == 4) w = rotate(w, 32);
  if (element == 1) w = __builtin_bswap64(w);
#else
  (void)element;
#endif
  return w;
}

static uint64_t mix_low(uint64_t k) { return rotate(k * multiplier_low, 31) * multiplier_high; }
static uint64_t mix_high(uint64_t k) { return rotate(k * multiplier_high, 33) * multiplier_low; }

static uint64_t finish(uint64_t h) {
  h = (h ^ h >> 33) * 0xff51afd7ed558ccd;
  h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53;
  return h ^ h >> 33;
}

laves__hash128 laves__hash_bytes(const void *data, size_t bytes, size_t element, laves__hash128 seed) {
  const unsigned char *next = data;
  laves__hash128 h = seed;
  for (size_t i = 0; i < bytes / 16; i++, next += 16) {
    h.low = (rotate(h.low ^ mix_low(word(next, element)), 27) + h.high) * 5 + 0x52dce729;
    h.high = (rotate(h.high ^ mix_high(word(next + 8, element)), 31) + h.low) * 5 + 0x38495ab5;
  }
  unsigned char tail[16] = {0}; /* mixing a zero changes nothing, so a short tail may be filled up */
  if (bytes % 16) memcpy(tail, next, bytes % 16);
  h.low ^= mix_low(word(tail, element)) ^ bytes;
  h.high ^= mix_high(word(tail + 8, element)) ^ bytes;
  h.low += h.high;
  h.high += h.low;
  h.low = finish(h.low);
  h.high = finish(h.high);
  h.low += h.high;
  h.high += h.low;
  return h;
}

void laves__hash_text(laves__hash128 hash, char text[33]) {
  snprintf(text, 33, "%016llx%016llx", (unsigned long long)hash.low, (unsigned long long)hash.high);
}

/* ---- a whole mesh ---- */

/* Kinds of arrays, as they stand in the headers. */
enum { POINTS = 1, TETS, FACES, REGIONS, FACE_TAGS };

/* An array in memory, or the points or tets of a mesh that makes them. */
typedef struct array {
  const unsigned char *bytes; /* NULL: made */
  const laves_mesh *mesh;
  uint64_t kind;
  size_t count, element; /* how many, and bytes of each */
} array;

typedef struct batch {
  const array *array;
  size_t first, end; /* bytes */
  laves__hash128 hashes[BATCH_BLOCKS];
} batch;

static laves__hash128 hash_made(const array *a, size_t from, size_t size) {
  double room[BLOCK_BYTES / sizeof(double)];
  const size_t begin = from / a->element, end = begin + size / a->element;
  const bool made = a->kind == POINTS ? laves__mesh_coordinates(a->mesh, begin, end, room)
                                      : laves__mesh_corners(a->mesh, begin, end, (int32_t *)(void *)room);
  return laves__hash_bytes(room, made ? size : 0, a->element, (laves__hash128){0, 0});
}

static void hash_blocks(void *user, size_t begin, size_t end, int worker) {
  batch *b = user;
  const array *a = b->array;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    const size_t from = b->first + i * BLOCK_BYTES;
    const size_t size = b->end - from < BLOCK_BYTES ? b->end - from : BLOCK_BYTES;
    b->hashes[i] =
        a->bytes ? laves__hash_bytes(a->bytes + from, size, a->element, (laves__hash128){0, 0}) : hash_made(a, from, size);
  }
}

/* An array that is absent differs from an empty one. */
static laves__hash128 fold_array(laves_context *context, const array *a, laves__hash128 hash) {
  const bool made = !a->bytes && a->mesh && a->mesh->maker.self;
  const uint64_t header[2] = {a->kind, a->bytes || made ? a->count : UINT64_MAX};
  hash = laves__hash_bytes(header, sizeof header, sizeof header[0], hash);
  const size_t bytes = a->bytes || made ? a->count * a->element : 0, batch_bytes = (size_t)BATCH_BLOCKS * BLOCK_BYTES;
  batch b = {.array = a};
  for (; b.first < bytes; b.first = b.end) {
    b.end = bytes - b.first < batch_bytes ? bytes : b.first + batch_bytes;
    const size_t blocks = (b.end - b.first + BLOCK_BYTES - 1) / BLOCK_BYTES;
    laves__parallel_for(context, NULL, blocks, 1, hash_blocks, &b);
    for (size_t i = 0; i < blocks; i++) hash = laves__hash_bytes(&b.hashes[i], sizeof b.hashes[i], sizeof(uint64_t), hash);
  }
  return hash;
}

void laves_mesh_hash(const laves_mesh *mesh, char hash[33]) {
  laves_context *context = mesh->context;
  laves__progress_reset(context); /* an old cancel must not leave blocks out */
  const array arrays[] = {{(void *)mesh->points, mesh, POINTS, 3 * mesh->vertex_count, sizeof(double)},
                          {(void *)mesh->tets, mesh, TETS, 4 * mesh->tet_count, sizeof(int32_t)},
                          {(void *)mesh->faces, NULL, FACES, 3 * mesh->face_count, sizeof(int32_t)},
                          {(void *)mesh->regions, NULL, REGIONS, mesh->tet_count, sizeof(int32_t)},
                          {(void *)mesh->face_tags, NULL, FACE_TAGS, mesh->face_count, sizeof(int32_t)}};
  laves__hash128 h = {0, 0};
  for (size_t i = 0; i < LAVES__COUNT_OF(arrays); i++) h = fold_array(context, &arrays[i], h);
  laves__hash_text(h, hash);
}
