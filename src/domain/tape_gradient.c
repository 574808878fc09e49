/* Tapes with gradient, at one point or over batches: forward differentiation, each register a value and three derivatives.
 *
 * Values are those of the batch evaluation, bit for bit. Where a derivative does not exist (the tip of a norm, the root of
 * zero) it is zero, so a kink never spoils the gradient of what is joined to it. */
#include <string.h>

#include "base/wide.h"
#include "domain/elementary.h"
#include "domain/tape.h"

typedef laves__dual dual;

static inline dual with(double value, laves__vec3 gradient) { return (dual){value, gradient}; }
static inline dual chain(double value, double slope, dual a) { return (dual){value, v3_scale(a.gradient, slope)}; }
static inline dual chain2(double value, double slope_a, dual a, double slope_b, dual b) {
  return (dual){value, v3_mad(v3_scale(a.gradient, slope_a), b.gradient, slope_b)};
}

static double inverse(double x) { return x != 0 ? 1 / x : 0; }

static dual power(dual a, dual b) {
  const double value = pow_of(a.value, b.value);
  if (!(a.value > 0)) return with(value, v3(0, 0, 0));
  return chain2(value, b.value * value / a.value, a, value * log_of(a.value), b);
}

static dual quotient(dual a, dual b) {
  const double value = a.value / b.value;
  return b.value != 0 ? chain2(value, 1 / b.value, a, -value / b.value, b) : with(value, v3(0, 0, 0));
}

static dual norm3(dual a, dual b, dual c) {
  const double value = norm3_of(a.value, b.value, c.value), s = inverse(value);
  return with(value, v3_mad(v3_mad(v3_scale(a.gradient, a.value * s), b.gradient, b.value * s), c.gradient, c.value * s));
}

static dual angle(dual y, dual x) {
  const double s = inverse(x.value * x.value + y.value * y.value);
  return chain2(atan2(y.value, x.value), x.value * s, y, -y.value * s, x);
}

/* The gradient of a distance is the direction from the foot, or the normal where that is too short to tell. */
static dual leaf_value(const laves__oracle *leaf, dual a, dual b, dual c) {
  const laves__vec3 p = v3_sub(v3(a.value, b.value, c.value), leaf->origin);
  double phi;
  uint32_t hint = LAVES__NO_HINT;
  leaf->evaluate(leaf->self, 1, &p, &phi, &hint);
  laves__vec3 foot, normal, slope = v3(0, 0, 0);
  if (leaf->project(leaf->self, p, fabs(phi) * 2 + 1e-12 * box3_diagonal(leaf->bounds), &hint, &foot, &normal)) {
    const laves__vec3 way = v3_sub(p, foot);
    slope = v3_norm(way) > 1e-9 * box3_diagonal(leaf->bounds) ? v3_unit(v3_scale(way, phi < 0 ? -1 : 1)) : normal;
  }
  return with(phi, v3_mad(v3_mad(v3_scale(a.gradient, slope.x), b.gradient, slope.y), c.gradient, slope.z));
}

/* Which of two equal operands has a slope: min(f, 0), as in the distance of a box, keeps that of f where f is zero, so that
 * Newton's method can end exactly on the surface. The value is that of plain evaluation all the same: zeros have signs, which
 * show in atan2. */
static inline bool prefer_first(dual a, dual b) { return a.value == b.value && v3_norm2(b.gradient) == 0; }

/* What one operation does, but LEAF. Inlined with a constant operation it is what the operation needs and no more. */
static inline __attribute__((always_inline)) dual apply(laves__op op, dual a, dual b, dual c) {
  switch (op) {
    case LAVES__OP_NEGATE:
      return chain(-a.value, -1, a);
    case LAVES__OP_ABS:
      return a.value < 0 ? chain(-a.value, -1, a) : with(fabs(a.value), a.gradient);
    case LAVES__OP_SQUARE:
      return chain(a.value * a.value, 2 * a.value, a);
    case LAVES__OP_SQRT: {
      const double root = sqrt_of(a.value);
      return chain(root, 0.5 * inverse(root), a);
    }
    case LAVES__OP_SIN:
      return chain(sin_of(a.value), cos_of(a.value), a);
    case LAVES__OP_COS:
      return chain(cos_of(a.value), -sin_of(a.value), a);
    case LAVES__OP_TAN: {
      const double t = tan_of(a.value);
      return chain(t, 1 + t * t, a);
    }
    case LAVES__OP_ASIN:
      return chain(asin_of(a.value), inverse(sqrt_of(1 - a.value * a.value)), a);
    case LAVES__OP_ACOS:
      return chain(acos_of(a.value), -inverse(sqrt_of(1 - a.value * a.value)), a);
    case LAVES__OP_EXP: {
      const double e = exp_of(a.value);
      return chain(e, e, a);
    }
    case LAVES__OP_LOG:
      return chain(log_of(a.value), a.value > 0 ? 1 / a.value : 0, a);
    case LAVES__OP_FLOOR:
      return with(floor_of(a.value), v3(0, 0, 0));
    case LAVES__OP_ADD:
      return with(a.value + b.value, v3_add(a.gradient, b.gradient));
    case LAVES__OP_SUB:
      return with(a.value - b.value, v3_sub(a.gradient, b.gradient));
    case LAVES__OP_MUL:
      return chain2(a.value * b.value, b.value, a, a.value, b);
    case LAVES__OP_DIV:
      return quotient(a, b);
    case LAVES__OP_MIN:
      return with(min_of(a.value, b.value), a.value < b.value || prefer_first(a, b) ? a.gradient : b.gradient);
    case LAVES__OP_MAX:
      return with(max_of(a.value, b.value), a.value > b.value || prefer_first(a, b) ? a.gradient : b.gradient);
    case LAVES__OP_POW:
      return power(a, b);
    case LAVES__OP_ATAN2:
      return angle(a, b);
    case LAVES__OP_MOD:
      return chain2(mod_of(a.value, b.value), 1, a, b.value != 0 ? -floor_of(a.value / b.value) : 0, b);
    case LAVES__OP_NORM2: {
      const double n = norm2_of(a.value, b.value), s = inverse(n);
      return chain2(n, a.value * s, a, b.value * s, b);
    }
    case LAVES__OP_NORM3:
      return norm3(a, b, c);
    default:
      return with(NAN, v3(0, 0, 0));
  }
}

static dual run(const laves__tape *tape, laves__vec3 point, dual *registers) {
  registers[0] = with(point.x, v3(1, 0, 0));
  registers[1] = with(point.y, v3(0, 1, 0));
  registers[2] = with(point.z, v3(0, 0, 1));
  const laves__instruction *end = tape->instructions + tape->count;
  dual result = registers[0];
  for (const laves__instruction *p = tape->instructions; p < end; p++) {
    const dual constant = with(p->constant, v3(0, 0, 0));
    const dual a = p->operand[0] == LAVES__OPERAND_CONSTANT ? constant : registers[p->operand[0]];
    const dual b = p->operand[1] == LAVES__OPERAND_CONSTANT ? constant : registers[p->operand[1]];
    const dual c = registers[p->operand[2]];
    result = p->op == LAVES__OP_LEAF ? leaf_value(&tape->leaves[p->leaf], a, b, c) : apply((laves__op)p->op, a, b, c);
    registers[p->out] = result;
  }
  if (!v3_finite(result.gradient)) result.gradient = v3(0, 0, 0); /* an overflow on the way */
  return result;
}

static dual run_large(const laves__tape *tape, laves__vec3 point) {
  dual registers[LAVES__REGISTER_LIMIT];
  return run(tape, point, registers);
}

static dual run_small(const laves__tape *tape, laves__vec3 point) {
  dual registers[LAVES__REGISTERS_FEW];
  return run(tape, point, registers);
}

laves__dual laves__tape_gradient(const laves__tape *tape, laves__vec3 point) {
  return tape->register_count <= LAVES__REGISTERS_FEW ? run_small(tape, point) : run_large(tape, point);
}

/* ---- batches ---- */

/* Doubles in the register block of a run, and the most points at a time. */
enum { SCRATCH = 4 * LAVES__REGISTER_LIMIT, BATCH = 64 };

/* A register over a batch of n points: n values, then n derivatives by x, by y, by z. */
static inline dual load(const double *reg, size_t n, size_t i) {
  return (dual){reg[i], {reg[n + i], reg[2 * n + i], reg[3 * n + i]}};
}

static inline void store(dual d, double *reg, size_t n, size_t i) {
  reg[i] = d.value;
  reg[n + i] = d.gradient.x;
  reg[2 * n + i] = d.gradient.y;
  reg[3 * n + i] = d.gradient.z;
}

#define EACH(name)                                                                                                         \
  case LAVES__OP_##name:                                                                                                   \
    LAVES__EACH_ALONE                                                                                                      \
    for (size_t i = 0; i < n; i++) store(apply(LAVES__OP_##name, load(a, n, i), load(b, n, i), load(c, n, i)), out, n, i); \
    break

/* The block holds register r at block + 4 r n; `constants` are two registers for constant operands. */
LAVES__WIDE static void run_batch(const laves__tape *tape, size_t n, double *block, double *constants) {
  const laves__instruction *end = tape->instructions + tape->count;
  for (const laves__instruction *p = tape->instructions; p < end; p++) {
    const double *operand[2];
    for (int k = 0; k < 2; k++) {
      double *constant = constants + 4 * n * (size_t)k;
      const bool is_constant = p->operand[k] == LAVES__OPERAND_CONSTANT;
      for (size_t i = 0; is_constant && i < n; i++) constant[i] = p->constant;
      operand[k] = is_constant ? constant : block + 4 * n * p->operand[k];
    }
    const double *a = operand[0], *b = operand[1];
    const double *c = p->operand[2] == LAVES__OPERAND_CONSTANT ? block : block + 4 * n * p->operand[2];
    double *out = block + 4 * n * p->out;
    switch ((laves__op)p->op) {
      EACH(NEGATE);
      EACH(ABS);
      EACH(SQUARE);
      EACH(SQRT);
      EACH(SIN);
      EACH(COS);
      EACH(TAN);
      EACH(ASIN);
      EACH(ACOS);
      EACH(EXP);
      EACH(LOG);
      EACH(FLOOR);
      EACH(ADD);
      EACH(SUB);
      EACH(MUL);
      EACH(DIV);
      EACH(MIN);
      EACH(MAX);
      EACH(POW);
      EACH(ATAN2);
      EACH(MOD);
      EACH(NORM2);
      EACH(NORM3);
      case LAVES__OP_LEAF:
        for (size_t i = 0; i < n; i++)
          store(leaf_value(&tape->leaves[p->leaf], load(a, n, i), load(b, n, i), load(c, n, i)), out, n, i);
        break;
      default:
        break;
    }
  }
}

void laves__tape_gradients(const laves__tape *tape, size_t count, const laves__vec3 *points, laves__dual *duals) {
  _Alignas(64) double block[SCRATCH];
  _Alignas(64) double constants[2 * 4 * BATCH] = {0};
  const size_t fits = SCRATCH / (4 * (size_t)tape->register_count), batch = fits < BATCH ? fits : BATCH;
  const size_t last = tape->instructions[tape->count - 1].out;
  for (size_t begin = 0; begin < count; begin += batch) {
    const size_t n = count - begin < batch ? count - begin : batch;
    if (n < batch) memset(constants, 0, sizeof constants); /* rows of derivatives lie elsewhere now */
    for (size_t i = 0; i < n; i++) {
      store(with(points[begin + i].x, v3(1, 0, 0)), block, n, i);
      store(with(points[begin + i].y, v3(0, 1, 0)), block + 4 * n, n, i);
      store(with(points[begin + i].z, v3(0, 0, 1)), block + 8 * n, n, i);
    }
    run_batch(tape, n, block, constants);
    for (size_t i = 0; i < n; i++) {
      duals[begin + i] = load(block + 4 * n * last, n, i);
      if (!v3_finite(duals[begin + i].gradient)) duals[begin + i].gradient = v3(0, 0, 0);
    }
  }
}
