/* The area of the surface of a solid that can only be asked where its inside is.
 *
 * By Crofton's formula: a surface of area A in a box of volume B is crossed by a random segment of length s with the chance
 * A s / 2B. Starts and directions are those of a Kronecker sequence in five dimensions [roberts2018]. Segments are short against
 * the solid, lest they cross a thin part twice unseen, and long enough for some hundred of them to cross. */
#include "domain/frame.h"

enum { SEGMENTS = 1 << 14, SEGMENTS_PER_BLOCK = 64, DIMENSIONS = 5 };

static const double segment_share = 0.01; /* of the diagonal of the box */

typedef struct crossing {
  const laves__oracle *oracle;
  laves__vec3 lower, extent; /* the box with room for segments */
  double length;
  bool *crosses; /* [SEGMENTS] */
} crossing;

/* x_k = frac(1/2 + k a), a_j = g^-j with g^6 = g + 1. */
static void sequence_at(size_t k, double x[DIMENSIONS]) {
  static const double g = 1.1673039782614187;
  double step = 1;
  for (int j = 0; j < DIMENSIONS; j++) {
    step /= g;
    x[j] = 0.5 + step * (double)(k + 1);
    x[j] -= floor(x[j]);
  }
}

static void make_segment(const crossing *c, size_t k, laves__vec3 ends[2]) {
  double x[DIMENSIONS];
  sequence_at(k, x);
  const double z = 2 * x[3] - 1, angle = 6.283185307179586 * x[4], ring = sqrt(1 - z * z);
  ends[0] = v3(c->lower.x + x[0] * c->extent.x, c->lower.y + x[1] * c->extent.y, c->lower.z + x[2] * c->extent.z);
  ends[1] = v3_mad(ends[0], v3(ring * cos(angle), ring * sin(angle), z), c->length);
}

static void cross_block(void *user, size_t begin, size_t end, int worker) {
  (void)worker;
  const crossing *c = user;
  for (size_t first = begin; first < end; first += SEGMENTS_PER_BLOCK) {
    const size_t count = end - first < SEGMENTS_PER_BLOCK ? end - first : SEGMENTS_PER_BLOCK;
    laves__vec3 points[2 * SEGMENTS_PER_BLOCK];
    double phi[2 * SEGMENTS_PER_BLOCK];
    for (size_t i = 0; i < count; i++) make_segment(c, first + i, points + 2 * i);
    c->oracle->evaluate(c->oracle->self, 2 * count, points, phi, NULL);
    for (size_t i = 0; i < count; i++) c->crosses[first + i] = (phi[2 * i] < 0) != (phi[2 * i + 1] < 0);
  }
}

double laves__domain_area(laves_context *context, const laves__oracle *oracle) {
  if (isfinite(oracle->area)) return oracle->area;
  const double length = segment_share * box3_diagonal(oracle->bounds);
  const laves__vec3 room = v3(length, length, length), lower = v3_sub(oracle->bounds.lower, room);
  crossing c = {oracle, lower, v3_sub(v3_add(oracle->bounds.upper, room), lower), length,
                laves__alloc_zeroed(context, SEGMENTS, sizeof *c.crosses)};
  if (!c.crosses) return 0;
  laves__parallel_for(context, "background", SEGMENTS, SEGMENTS_PER_BLOCK, cross_block, &c);
  size_t crossings = 0;
  for (size_t i = 0; i < SEGMENTS; i++) crossings += c.crosses[i];
  laves__free(context, c.crosses, SEGMENTS, sizeof *c.crosses);
  return 2 * c.extent.x * c.extent.y * c.extent.z * (double)crossings / (SEGMENTS * length);
}
