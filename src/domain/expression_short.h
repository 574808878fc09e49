/* Short names for building formulas; for the .c files that are made of formulas. */
#ifndef LAVES_DOMAIN_EXPRESSION_SHORT_H
#define LAVES_DOMAIN_EXPRESSION_SHORT_H

#include "domain/expression.h"

typedef laves__expression E;
typedef laves__node N;

static inline N k_(E *e, double value) { return laves__node_constant(e, value); }
static inline N x_(E *e) { return laves__node_make(e, LAVES__OP_X, 0, 0, 0); }
static inline N y_(E *e) { return laves__node_make(e, LAVES__OP_Y, 0, 0, 0); }
static inline N z_(E *e) { return laves__node_make(e, LAVES__OP_Z, 0, 0, 0); }
static inline N neg_(E *e, N a) { return laves__node_make(e, LAVES__OP_NEGATE, a, 0, 0); }
static inline N abs_(E *e, N a) { return laves__node_make(e, LAVES__OP_ABS, a, 0, 0); }
static inline N square_(E *e, N a) { return laves__node_make(e, LAVES__OP_SQUARE, a, 0, 0); }
static inline N sin_(E *e, N a) { return laves__node_make(e, LAVES__OP_SIN, a, 0, 0); }
static inline N cos_(E *e, N a) { return laves__node_make(e, LAVES__OP_COS, a, 0, 0); }
static inline N exp_(E *e, N a) { return laves__node_make(e, LAVES__OP_EXP, a, 0, 0); }
static inline N log_(E *e, N a) { return laves__node_make(e, LAVES__OP_LOG, a, 0, 0); }
static inline N add_(E *e, N a, N b) { return laves__node_make(e, LAVES__OP_ADD, a, b, 0); }
static inline N sub_(E *e, N a, N b) { return laves__node_make(e, LAVES__OP_SUB, a, b, 0); }
static inline N mul_(E *e, N a, N b) { return laves__node_make(e, LAVES__OP_MUL, a, b, 0); }
static inline N div_(E *e, N a, N b) { return laves__node_make(e, LAVES__OP_DIV, a, b, 0); }
static inline N min_(E *e, N a, N b) { return laves__node_make(e, LAVES__OP_MIN, a, b, 0); }
static inline N max_(E *e, N a, N b) { return laves__node_make(e, LAVES__OP_MAX, a, b, 0); }
static inline N norm2_(E *e, N a, N b) { return laves__node_make(e, LAVES__OP_NORM2, a, b, 0); }
static inline N norm3_(E *e, N a, N b, N c) { return laves__node_make(e, LAVES__OP_NORM3, a, b, c); }
/* a + number, a * number */
static inline N plus_(E *e, N a, double value) { return add_(e, a, k_(e, value)); }
static inline N times_(E *e, N a, double value) { return mul_(e, a, k_(e, value)); }

#endif
