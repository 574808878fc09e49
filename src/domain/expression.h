/* Expressions: scalar functions of x, y and z as a graph of nodes in one store.
 *
 * Nodes are hash-consed (equal nodes are one node), constants are folded, and a node's operands always have smaller
 * numbers than itself, so passes over the graph are loops and never recursions. Changes of coordinates are nodes as
 * well; laves__expression_lower() works them out, each distinct pair of node and frame once, so a moved copy costs
 * its own nodes only and long chains of transforms collapse into one matrix.
 *
 * A failed call returns LAVES__NO_NODE and leaves its reason in the store; LAVES__NO_NODE as an operand gives
 * LAVES__NO_NODE, so a whole formula is checked once, at its end. Not thread-safe. */
#ifndef LAVES_DOMAIN_EXPRESSION_H
#define LAVES_DOMAIN_EXPRESSION_H

#include "base/base.h"
#include "base/vec3.h"

/* OP(name, operands). What they mean for arguments outside their range is told in elementary.h. */
#define LAVES__OP_LIST(OP)                                                                                    \
  OP(CONSTANT, 0)                                                                                             \
  OP(X, 0)                                                                                                    \
  OP(Y, 0)                                                                                                    \
  OP(Z, 0)                                                                                                    \
  OP(NEGATE, 1)                                                                                               \
  OP(ABS, 1)                                                                                                  \
  OP(SQUARE, 1)                                                                                               \
  OP(SQRT, 1)                                                                                                 \
  OP(SIN, 1)                                                                                                  \
  OP(COS, 1)                                                                                                  \
  OP(TAN, 1)                                                                                                  \
  OP(ASIN, 1)                                                                                                 \
  OP(ACOS, 1)                                                                                                 \
  OP(EXP, 1)                                                                                                  \
  OP(LOG, 1)                                                                                                  \
  OP(FLOOR, 1)                                                                                                \
  OP(ADD, 2)                                                                                                  \
  OP(SUB, 2)                                                                                                  \
  OP(MUL, 2)                                                                                                  \
  OP(DIV, 2)                                                                                                  \
  OP(MIN, 2)                                                                                                  \
  OP(MAX, 2)                                                                                                  \
  OP(POW, 2)                                                                                                  \
  OP(ATAN2, 2)                                                                                                \
  OP(MOD, 2)                                                                                                  \
  OP(NORM2, 2)  /* sqrt(a^2 + b^2) */                                                                         \
  OP(NORM3, 3)  /* sqrt(a^2 + b^2 + c^2) */                                                                   \
  OP(LEAF, 3)   /* the oracle number `value`, evaluated at input coordinates (a, b, c) */                     \
  OP(AFFINE, 1) /* a, with x, y, z replaced by those of matrix number `value`; gone after lowering */         \
  OP(WARP, 1)   /* a, with x, y, z replaced by the expressions of warp number `value`; gone after lowering */ \
  OP(TAG, 1)    /* a, the surface of which is named `value`; tapes keep it beside their instructions */       \
  OP(REGION, 1) /* a, the inside of which is named `value`; the same */

typedef enum laves__op {
#define LAVES__OP_ENUM(name, operands) LAVES__OP_##name,
  LAVES__OP_LIST(LAVES__OP_ENUM)
#undef LAVES__OP_ENUM
      LAVES__OP_COUNT
} laves__op;

extern const uint8_t laves__op_operands[LAVES__OP_COUNT];

typedef uint32_t laves__node;
#define LAVES__NO_NODE UINT32_MAX

/* The most nodes that one store holds, lowered ones included: about 60 MiB with the tables. */
#define LAVES__NODE_LIMIT 1000000u

typedef struct laves__node_data {
  double value; /* of CONSTANT; number of LEAF, AFFINE, WARP */
  laves__node operand[3];
  uint32_t op;
} laves__node_data;

/* x' = m v + t */
typedef struct laves__affine {
  laves__mat3 m;
  laves__vec3 t;
} laves__affine;

typedef struct laves__warp {
  laves__node coordinate[3];
} laves__warp;

struct laves__keeps;

typedef struct laves__expression {
  laves_context *context;
  laves__node_data *nodes;
  size_t node_count, node_capacity;
  uint32_t *table; /* open addressing: node + 1, 0 is free */
  size_t table_size;
  laves__affine *affines;
  size_t affine_count, affine_capacity;
  laves__warp *warps;
  size_t warp_count, warp_capacity;
  struct laves__keeps *keeps;    /* see kept.h; NULL: nothing is kept */
  bool out_of_memory, too_large; /* why a call returned LAVES__NO_NODE */
} laves__expression;

/* Zeroes and sets up; nothing is allocated yet. */
void laves__expression_init(laves__expression *e, laves_context *context);
void laves__expression_free(laves__expression *e);

laves__node laves__node_constant(laves__expression *e, double value);
/* Any operation with operands; those that it does not have are ignored. */
laves__node laves__node_make(laves__expression *e, laves__op op, laves__node a, laves__node b, laves__node c);
/* Value of oracle number `index` (kept by the caller) at coordinates (x, y, z). */
laves__node laves__node_leaf(laves__expression *e, uint32_t index);
/* The same at other coordinates, which must hold no AFFINE and WARP when the leaf is put below none. */
laves__node laves__node_leaf_at(laves__expression *e, uint32_t index, const laves__node coordinate[3]);
/* body(A p): coordinates are mapped by A before body sees them. To move a solid by T, map by the inverse of T. */
laves__node laves__node_affine(laves__expression *e, laves__node body, const laves__affine *map);
/* a, named. What has a name keeps it, and constants have no surface: these come back as they are. */
laves__node laves__node_tag(laves__expression *e, laves__node a, uint32_t tag);
/* The same for its inside; it may have several names. */
laves__node laves__node_region(laves__expression *e, laves__node a, uint32_t region);
laves__node laves__node_warp(laves__expression *e, laves__node body, const laves__node coordinate[3]);

bool laves__node_is_constant(const laves__expression *e, laves__node a, double *value);

/* The same function without AFFINE, WARP nodes, as seen from coordinates that are mapped by `outer` first. */
laves__node laves__expression_lower(laves__expression *e, laves__node root, const laves__affine *outer);

/* The value of one operation (not of LEAF, AFFINE or WARP). */
double laves__op_value(laves__op op, double a, double b, double c);

laves__affine laves__affine_identity(void);
/* p -> a (b p) */
laves__affine laves__affine_compose(const laves__affine *a, const laves__affine *b);

#endif
