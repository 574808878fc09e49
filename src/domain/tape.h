/* Tapes: a lowered expression as a flat list of instructions on numbered registers.
 *
 * Registers 0, 1, 2 hold x, y, z; each instruction reads up to three and writes one; the last one's result is the
 * value. The same tape is run in three ways: over batches of points (plain loops that vectorise), on boxes with interval
 * arithmetic, and at a point with its gradient. All are read only, allocate nothing, and are safe from many threads. */
#ifndef LAVES_DOMAIN_TAPE_H
#define LAVES_DOMAIN_TAPE_H

#include "domain/expression.h"
#include "domain/oracle.h"

/* The most registers a tape may use; one run keeps them on its stack (128 KiB in all). */
#define LAVES__REGISTER_LIMIT 4096
/* Runs of tapes with up to this many registers touch little of the stack. */
#define LAVES__REGISTERS_FEW 64

/* An operand is a register, or the constant of the instruction. */
enum { LAVES__OPERAND_CONSTANT = 0xffff };

typedef struct laves__instruction {
  double constant;
  uint16_t op, out, operand[3];
  uint16_t leaf;
} laves__instruction;

/* The value that tells whether a point is in a region: negative inside. */
typedef struct laves__tape_region {
  uint32_t after; /* so many instructions */
  uint16_t operand;
  int32_t region;
} laves__tape_region;

typedef struct laves__tape {
  laves__instruction *instructions;
  size_t count;
  uint32_t register_count;     /* at least 3 */
  const laves__oracle *leaves; /* not owned; LEAF instructions index it */
  int32_t *tags;    /* [3 count] the name on the way from each operand to its instruction, or LAVES__NO_TAG; NULL: none */
  int32_t root_tag; /* the same behind the last instruction */
  laves__tape_region *regions; /* [region_count] by ascending `after`, then region */
  size_t region_count;
} laves__tape;

#define LAVES__NO_TAG (-1)

typedef struct laves__interval {
  double lower, upper;
} laves__interval;

typedef struct laves__dual {
  double value;
  laves__vec3 gradient;
} laves__dual;

/* Compiles a node without AFFINE and WARP below it. */
laves_result laves__tape_build(const laves__expression *e, laves__node root, const laves__oracle *leaves, laves__tape *tape,
                               laves_error *error);
void laves__tape_free(laves_context *context, laves__tape *tape);

/* values[i] at points[i]; NaN becomes LAVES__TAPE_NOWHERE, and larger numbers are cut down to it. */
#define LAVES__TAPE_NOWHERE 1e300
void laves__tape_evaluate(const laves__tape *tape, size_t count, const laves__vec3 *points, double *values);

/* Bounds of what laves__tape_evaluate() yields anywhere in the box, rounding included. The box may be unbounded.
 * *may_be_nan: some operation may have no value somewhere in the box; then only undecided is safe. */
laves__interval laves__tape_interval(const laves__tape *tape, laves__box3 box, bool *may_be_nan);

/* The same, and each[i] bounds what instruction i yields; NULL: not wanted. */
laves__interval laves__tape_intervals(const laves__tape *tape, laves__box3 box, bool *may_be_nan, laves__interval *each);

/* Value and gradient; where the function has a kink, those of one of its sides. */
laves__dual laves__tape_gradient(const laves__tape *tape, laves__vec3 point);
/* The same at many points, with the same bits, several times as fast. */
void laves__tape_gradients(const laves__tape *tape, size_t count, const laves__vec3 *points, laves__dual *duals);

/* How the tags of leaves are called in the whole: tag t of leaf l is number[first[l] + t]; leaf l has first[l + 1] - first[l]. */
typedef struct laves__leaf_tags {
  const uint32_t *first;
  const int32_t *number;
} laves__leaf_tags;

/* The name of the surface at one of its points, or LAVES__NO_TAG (tape_tag.c). Values that differ by less than `tolerance`
 * count as equal. */
int32_t laves__tape_tag(const laves__tape *tape, const laves__leaf_tags *leaf_tags, laves__vec3 point, double tolerance);

/* The least of the regions that a point is in, or LAVES__NO_TAG (tape_region.c). */
int32_t laves__tape_region_at(const laves__tape *tape, laves__vec3 point);

#endif
