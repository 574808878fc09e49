/* Volume and principal axes of a solid that can only be asked where its inside is.
 *
 * An octree is cut down while the oracle can't decide; decided boxes count exactly, and the boxes that remain are sampled
 * with the R3 sequence of [roberts2018], a Kronecker sequence of low discrepancy, so the error falls nearly as 1/n and is
 * confined to a thin layer around the surface. Where phi is a distance, one value stands for a whole box. (Paper, section 4.2,
 * which samples the whole bounding box.) */
#include "base/jacobi.h"
#include "domain/frame.h"

enum {
  LEVELS = 5,          /* of the octree: 32 boxes along each axis at the end */
  DISTANCE_LEVELS = 6, /* where one value stands for a box */
  LEAF_SAMPLES = 6,    /* in each undecided box; the sequence goes on from box to box */
  AXES_SAMPLES = 4096,
  CHUNK = 64,
};

/* 1/g, 1/g^2, 1/g^3 for the root g of x^4 = x + 1. */
static const laves__vec3 r3_step = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};

static laves__vec3 r3_point(const laves__box3 *box, size_t i) {
  const double n = (double)(i + 1);
  const double x = n * r3_step.x, y = n * r3_step.y, z = n * r3_step.z;
  const laves__vec3 u = v3(x - floor(x), y - floor(y), z - floor(z)), e = v3_sub(box->upper, box->lower);
  return v3(box->lower.x + u.x * e.x, box->lower.y + u.y * e.y, box->lower.z + u.z * e.z);
}

typedef struct sampling {
  laves_context *context;
  const laves__oracle *oracle;
  size_t next; /* of the sequence */
} sampling;

/* The shares of up to eight boxes that are inside, by samples. */
static void sampled_shares(sampling *s, int count, const laves__box3 *boxes, double *shares) {
  const laves__oracle *oracle = s->oracle;
  laves__vec3 points[8 * LEAF_SAMPLES];
  double phi[8 * LEAF_SAMPLES];
  for (int i = 0; i < count * LEAF_SAMPLES; i++) points[i] = r3_point(&boxes[i / LEAF_SAMPLES], s->next++);
  oracle->evaluate(oracle->self, (size_t)count * LEAF_SAMPLES, points, phi, NULL);
  for (int k = 0; k < count; k++) {
    int inside = 0;
    for (int i = 0; i < LEAF_SAMPLES; i++) inside += phi[k * LEAF_SAMPLES + i] < 0;
    shares[k] = (double)inside / LEAF_SAMPLES;
  }
}

/* The share of a box that is inside, from the distance of its centre: as if the box were the ball of its volume and the
 * surface a plane. Right on average over directions, and one question instead of many. */
static double balanced_share(const laves__oracle *oracle, laves__vec3 centre, double volume) {
  static const double ball_per_radius = 4.18879020478639; /* 4 pi / 3 */
  double phi;
  oracle->evaluate(oracle->self, 1, &centre, &phi, NULL);
  const double t = fmax(-1, fmin(1, -phi / cbrt(volume / ball_per_radius)));
  return (2 + 3 * t - t * t * t) / 4;
}

static laves__vec3 half_of(const laves__box3 *box) { return v3_scale(v3_sub(box->upper, box->lower), 0.5); }

static double volume_of(const laves__box3 *box) {
  const laves__vec3 half = half_of(box);
  return 8 * half.x * half.y * half.z;
}

static laves__side side_of(const laves__oracle *oracle, const laves__box3 *box) {
  const laves__vec3 half = half_of(box);
  return oracle->side(oracle->self, box3_centre(*box), v3_norm(half), half);
}

static void split(const laves__box3 *box, laves__box3 children[8]) {
  const laves__vec3 half = half_of(box), centre = box3_centre(*box);
  for (int child = 0; child < 8; child++) {
    const laves__vec3 lower =
        v3(child & 1 ? centre.x : box->lower.x, child & 2 ? centre.y : box->lower.y, child & 4 ? centre.z : box->lower.z);
    children[child] = (laves__box3){lower, v3_add(lower, half)};
  }
}

/* The volume within the smallest boxes; those that are sampled are asked for together. */
static double leaves_volume(sampling *s, const laves__box3 children[8]) {
  laves__box3 open[8];
  laves__side side[8];
  double shares[8], sum = 0;
  int count = 0;
  for (int child = 0; child < 8; child++) {
    side[child] = side_of(s->oracle, &children[child]);
    if (side[child] == LAVES__UNDECIDED) open[count++] = children[child];
  }
  if (count > 0 && !s->oracle->is_distance) sampled_shares(s, count, open, shares);
  count = 0;
  for (int child = 0; child < 8; child++) {
    if (side[child] == LAVES__OUTSIDE) continue;
    const double volume = volume_of(&children[child]);
    double share = 1;
    if (side[child] == LAVES__UNDECIDED)
      share = s->oracle->is_distance ? balanced_share(s->oracle, box3_centre(children[child]), volume) : shares[count++];
    sum += volume * share;
  }
  return sum;
}

/* After a cancel what is left counts as nothing; the caller asks whether there was one. */
static double box_volume(sampling *s, laves__box3 box, int level) {
  if (laves__cancelled(s->context, "background", 0)) return 0;
  const laves__side side = side_of(s->oracle, &box);
  if (side != LAVES__UNDECIDED) return side == LAVES__INSIDE ? volume_of(&box) : 0;
  laves__box3 children[8];
  split(&box, children);
  if (level + 1 == (s->oracle->is_distance ? DISTANCE_LEVELS : LEVELS)) return leaves_volume(s, children);
  double sum = 0;
  for (int child = 0; child < 8; child++) sum += box_volume(s, children[child], level + 1);
  return sum;
}

double laves__domain_volume(laves_context *context, const laves__oracle *oracle) {
  sampling s = {context, oracle, 0};
  return isfinite(oracle->volume) ? oracle->volume : box_volume(&s, oracle->bounds, 0);
}

/* Eigenvectors of a symmetric matrix by cyclic Jacobi rotations; columns of `axes`, largest eigenvalue first. */
static void eigenvectors(double m[3][3], double axes[3][3]) {
  enum { SWEEPS = 32 };
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) axes[i][j] = i == j;
  for (int sweep = 0; sweep < SWEEPS; sweep++)
    for (int p = 0; p < 2; p++)
      for (int q = p + 1; q < 3; q++) {
        double c, sine;
        laves__jacobi_rotate(m, p, q, &c, &sine);
        for (int k = 0; k < 3; k++) {
          const double u = axes[k][p], v = axes[k][q];
          axes[k][p] = c * u - sine * v;
          axes[k][q] = sine * u + c * v;
        }
      }
}

laves__mat3 laves__principal_axes(const laves__oracle *oracle) {
  laves__mat3 rotation = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  double sum[3] = {0, 0, 0}, square[3][3] = {{0}};
  size_t inside = 0;
  for (size_t begin = 0; begin < AXES_SAMPLES; begin += CHUNK) {
    laves__vec3 points[CHUNK];
    double phi[CHUNK];
    for (size_t i = 0; i < CHUNK; i++) points[i] = r3_point(&oracle->bounds, begin + i);
    oracle->evaluate(oracle->self, CHUNK, points, phi, NULL);
    for (size_t i = 0; i < CHUNK; i++) {
      if (!(phi[i] < 0)) continue;
      const double p[3] = {points[i].x, points[i].y, points[i].z};
      for (int a = 0; a < 3; a++) {
        sum[a] += p[a];
        for (int b = 0; b < 3; b++) square[a][b] += p[a] * p[b];
      }
      inside++;
    }
  }
  if (inside < 4) return rotation;
  double axes[3][3];
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      square[a][b] = square[a][b] / (double)inside - sum[a] * sum[b] / ((double)inside * (double)inside);
  double diagonal[3][3];
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) diagonal[a][b] = square[a][b];
  eigenvectors(diagonal, axes);
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 2; i++)
    for (int j = i + 1; j < 3; j++)
      if (diagonal[order[j]][order[j]] > diagonal[order[i]][order[i]]) {
        const int k = order[i];
        order[i] = order[j];
        order[j] = k;
      }
  laves__vec3 column[3];
  for (int i = 0; i < 2; i++) column[i] = v3(axes[0][order[i]], axes[1][order[i]], axes[2][order[i]]);
  column[2] = v3_cross(column[0], column[1]);
  rotation.row[0] = v3(column[0].x, column[1].x, column[2].x);
  rotation.row[1] = v3(column[0].y, column[1].y, column[2].y);
  rotation.row[2] = v3(column[0].z, column[1].z, column[2].z);
  return rotation;
}
