/* The hash of a mesh that certificates carry: SHA-256 of its points and tets, whatever file they come from.
 *
 * The arrays are cut into blocks of 65536 items, the last one shorter, whose digests are taken in parallel:
 *
 *   SHA-256( "laves mesh 1\n", vertex count, tet count, digests of the blocks of points, digests of the blocks of tets )
 *
 * Counts are 8 bytes, coordinates doubles, corners 4 bytes, all little-endian; -0 counts as 0, since text may not keep it.
 * Regions, tags and stored faces are not part of it: not every format keeps them, and the certificate does not speak of
 * them. Source of the hash: [fips180-4]. */
#include <string.h>

#include "base/sha256.h"
#include "certify/certify.h"

enum { BLOCK_ITEMS = 1 << 16, PIECE = 1536 };

typedef struct digesting {
  const laves_mesh *mesh;
  size_t point_blocks;
  unsigned char (*digests)[LAVES__SHA256_BYTES]; /* [blocks] points first */
} digesting;

static size_t blocks_of(size_t count) { return (count + BLOCK_ITEMS - 1) / BLOCK_ITEMS; }

static void put_little(unsigned char *bytes, uint64_t value, int count) {
  for (int i = 0; i < count; i++) bytes[i] = (unsigned char)(value >> 8 * i);
}

/* Coordinates [first, first + count) of the mesh. */
static void add_doubles(laves__sha256 *hash, const laves_mesh *mesh, size_t first, size_t count) {
  double values[PIECE];
  unsigned char bytes[8 * PIECE];
  for (size_t done = 0; done < count;) {
    const size_t part = count - done < PIECE ? count - done : PIECE;
    if (!laves__mesh_coordinates(mesh, first + done, first + done + part, values)) return;
    for (size_t i = 0; i < part; i++) {
      const double value = values[i] + 0.0; /* one zero */
      uint64_t bits;
      memcpy(&bits, &value, sizeof bits);
      put_little(bytes + 8 * i, bits, 8);
    }
    laves__sha256_add(hash, bytes, 8 * part);
    done += part;
  }
}

static void add_integers(laves__sha256 *hash, const laves_mesh *mesh, size_t first, size_t count) {
  int32_t values[PIECE];
  unsigned char bytes[4 * PIECE];
  for (size_t done = 0; done < count;) {
    const size_t part = count - done < PIECE ? count - done : PIECE;
    if (!laves__mesh_corners(mesh, first + done, first + done + part, values)) return;
    for (size_t i = 0; i < part; i++) put_little(bytes + 4 * i, (uint32_t)values[i], 4);
    laves__sha256_add(hash, bytes, 4 * part);
    done += part;
  }
}

static size_t items_from(size_t first, size_t count) { return count - first < BLOCK_ITEMS ? count - first : BLOCK_ITEMS; }

static void digest_blocks(void *user, size_t begin, size_t end, int worker) {
  const digesting *d = user;
  (void)worker;
  for (size_t b = begin; b < end; b++) {
    laves__sha256 hash;
    laves__sha256_start(&hash);
    if (b < d->point_blocks) {
      const size_t first = b * BLOCK_ITEMS;
      add_doubles(&hash, d->mesh, 3 * first, 3 * items_from(first, d->mesh->vertex_count));
    } else {
      const size_t first = (b - d->point_blocks) * BLOCK_ITEMS;
      add_integers(&hash, d->mesh, 4 * first, 4 * items_from(first, d->mesh->tet_count));
    }
    laves__sha256_finish(&hash, d->digests[b]);
  }
}

static void join_digests(const digesting *d, size_t blocks, char text[LAVES_HASH_CAPACITY]) {
  static const char kind[] = "laves mesh 1\n";
  unsigned char counts[16], digest[LAVES__SHA256_BYTES];
  laves__sha256 hash;
  put_little(counts, d->mesh->vertex_count, 8);
  put_little(counts + 8, d->mesh->tet_count, 8);
  laves__sha256_start(&hash);
  laves__sha256_add(&hash, kind, strlen(kind));
  laves__sha256_add(&hash, counts, sizeof counts);
  if (blocks > 0) laves__sha256_add(&hash, d->digests, blocks * sizeof *d->digests);
  laves__sha256_finish(&hash, digest);
  laves__sha256_text(digest, text);
}

laves_result laves__mesh_digest(laves_context *context, const laves_mesh *mesh, char text[LAVES_HASH_CAPACITY],
                                laves_error *error) {
  digesting d = {.mesh = mesh, .point_blocks = blocks_of(mesh->vertex_count)};
  const size_t blocks = d.point_blocks + blocks_of(mesh->tet_count);
  d.digests = laves__alloc(context, blocks, sizeof *d.digests);
  if (!d.digests) return laves__fail_memory(context, error);
  const bool complete = laves__parallel_for(context, "certify", blocks, 1, digest_blocks, &d);
  if (complete) join_digests(&d, blocks, text);
  laves__free(context, d.digests, blocks, sizeof *d.digests);
  return complete ? LAVES_OK : laves__fail_cancelled(error);
}
