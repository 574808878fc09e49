/* Tapes on boxes: interval arithmetic that bounds what the batch evaluation yields, rounding included.
 *
 * Each operation takes the range of its operands to a range that holds every result, and is then widened by a few units
 * in the last place. 0 * infinity counts as 0, since points are finite even where the box is not. */
#include "domain/elementary.h"
#include "domain/tape.h"

/* Relative and absolute widening of each result: above the errors of elementary.h and of the C library. */
static const double widen_relative = 1e-15, widen_absolute = 1e-300;

static const double pi = 3.14159265358979323846;

static laves__interval entire(void) { return (laves__interval){-INFINITY, INFINITY}; }

/* `absolute` covers functions whose error is not relative to their value, such as sine near its zeros. A lower end of +infinity,
 * or an upper one of -infinity, is NaN when it is widened, and so leaves nothing known. */
static laves__interval widened(double lower, double upper, double absolute) {
  const double l = lower - (fabs(lower) * widen_relative + absolute), u = upper + (fabs(upper) * widen_relative + absolute);
  return isnan(l) || isnan(u) ? entire() : (laves__interval){l, u};
}

static laves__interval rounded(double lower, double upper) { return widened(lower, upper, widen_absolute); }

static double times(double a, double b) { return a == 0 || b == 0 ? 0 : a * b; }

static laves__interval multiply(laves__interval a, laves__interval b) {
  const double p = times(a.lower, b.lower), q = times(a.lower, b.upper), r = times(a.upper, b.lower), s = times(a.upper, b.upper);
  return rounded(min_of(min_of(p, q), min_of(r, s)), max_of(max_of(p, q), max_of(r, s)));
}

static laves__interval divide(laves__interval a, laves__interval b, bool *may_be_nan) {
  if (b.lower <= 0 && b.upper >= 0) {
    *may_be_nan = true;
    return entire();
  }
  return multiply(a, rounded(1 / b.upper, 1 / b.lower));
}

static laves__interval square(laves__interval a) {
  const double l = fabs(a.lower), u = fabs(a.upper), large = max_of(l, u);
  const double small = a.lower <= 0 && a.upper >= 0 ? 0 : min_of(l, u);
  const laves__interval r = rounded(small * small, large * large);
  return (laves__interval){max_of(r.lower, 0), r.upper};
}

static laves__interval absolute(laves__interval a) {
  if (a.lower >= 0) return a;
  if (a.upper <= 0) return (laves__interval){-a.upper, -a.lower};
  return (laves__interval){0, max_of(-a.lower, a.upper)};
}

static laves__interval square_root(laves__interval a) {
  const laves__interval r = rounded(sqrt_of(a.lower), sqrt_of(a.upper));
  return (laves__interval){max_of(r.lower, 0), r.upper};
}

static laves__interval add(laves__interval a, laves__interval b) { return rounded(a.lower + b.lower, a.upper + b.upper); }
static laves__interval subtract(laves__interval a, laves__interval b) { return rounded(a.lower - b.upper, a.upper - b.lower); }

/* Sine of a + quarter * pi / 2: extreme values lie where the shifted turn count passes 1 (top) or 3 (bottom) modulo 4. */
static laves__interval sine(laves__interval a, double quarter) {
  const double large = max_of(fabs(a.lower), fabs(a.upper));
  if (!(large < 1e6) || a.upper - a.lower >= 2 * pi) return (laves__interval){-1.0000000001, 1.0000000001};
  const double slack = 1e-12; /* of a quarter turn: calls a doubtful extreme value one that is passed */
  const double first = a.lower * (2 / pi) + quarter - slack, last = a.upper * (2 / pi) + quarter + slack;
  const double p = sine_shifted(a.lower, quarter), q = sine_shifted(a.upper, quarter);
  const bool top = floor((last - 1) / 4) >= ceil((first - 1) / 4), bottom = floor((last - 3) / 4) >= ceil((first - 3) / 4);
  const double error = 1e-15 * (1 + large * 1e-3);
  return widened(bottom ? -1 : min_of(p, q), top ? 1 : max_of(p, q), error);
}

static laves__interval tangent(laves__interval a) {
  const double first = a.lower / pi - 0.5, last = a.upper / pi - 0.5; /* poles are the integers */
  if (!(max_of(fabs(a.lower), fabs(a.upper)) < 1e6) || last - first >= 1 || floor(first - 1e-9) != floor(last + 1e-9))
    return entire();
  const double l = tan_of(a.lower), u = tan_of(a.upper);
  return widened(l - fabs(l) * 1e-9, u + fabs(u) * 1e-9, 1e-12);
}

static laves__interval power(laves__interval a, laves__interval b) {
  const double p = pow_of(a.lower, b.lower), q = pow_of(a.lower, b.upper), r = pow_of(a.upper, b.lower),
               s = pow_of(a.upper, b.upper);
  const double lower = min_of(min_of(p, q), min_of(r, s)), upper = max_of(max_of(p, q), max_of(r, s));
  if (!isfinite(a.lower + a.upper + b.lower + b.upper)) return (laves__interval){0, INFINITY};
  return widened(lower * (1 - 1e-12), upper * (1 + 1e-12), widen_absolute); /* the error of the logarithm is magnified */
}

static laves__interval angle(laves__interval y, laves__interval x) {
  if (x.lower <= 0 && y.lower <= 0 && y.upper >= 0)
    return (laves__interval){-3.1415926536, 3.1415926536}; /* the cut or the centre */
  const double p = atan2(y.lower, x.lower), q = atan2(y.lower, x.upper), r = atan2(y.upper, x.lower), s = atan2(y.upper, x.upper);
  return rounded(min_of(min_of(p, q), min_of(r, s)), max_of(max_of(p, q), max_of(r, s)));
}

static laves__interval modulo(laves__interval a, laves__interval b) {
  const double size = max_of(fabs(b.lower), fabs(b.upper));
  if (b.lower == b.upper && b.lower != 0 && isfinite(a.lower) && isfinite(a.upper)) {
    const double slack = 1e-12 * (1 + max_of(fabs(a.lower), fabs(a.upper)) / size);
    const double first = floor(min_of(a.lower / b.lower, a.upper / b.lower) - slack);
    const double last = floor(max_of(a.lower / b.lower, a.upper / b.lower) + slack);
    if (first == last) return subtract(a, multiply(b, (laves__interval){first, first}));
  }
  /* Rounding may carry the quotient over an integer, and the result past the ends by the error of a. */
  const double error = 1e-15 * (size + max_of(fabs(a.lower), fabs(a.upper)));
  return (laves__interval){b.lower < 0 ? -size - error : -error, b.upper > 0 ? size + error : error};
}

/* A distance changes by no more than the way to the centre; any oracle knows its side. */
static laves__interval leaf_range(const laves__oracle *leaf, const laves__interval c[3]) {
  const laves__vec3 lower = v3_sub(v3(c[0].lower, c[1].lower, c[2].lower), leaf->origin);
  const laves__vec3 upper = v3_sub(v3(c[0].upper, c[1].upper, c[2].upper), leaf->origin);
  if (!v3_finite(lower) || !v3_finite(upper)) return entire();
  const laves__vec3 centre = v3_scale(v3_add(lower, upper), 0.5);
  const laves__vec3 half = v3_scale(v3_sub(upper, lower), 0.5 + 1e-15);
  const double radius = v3_norm(half) * (1 + 1e-12);
  laves__interval r = entire();
  if (leaf->is_distance) {
    double phi;
    leaf->evaluate(leaf->self, 1, &centre, &phi, NULL);
    const double error = 1e-6 * fabs(phi);
    r = (laves__interval){phi - radius - error, phi + radius + error};
  }
  const laves__side side = leaf->side(leaf->self, centre, radius, half);
  if (side == LAVES__OUTSIDE) r.lower = max_of(r.lower, 1e-300);
  if (side == LAVES__INSIDE) r.upper = min_of(r.upper, -1e-300);
  return r;
}

static laves__interval apply(const laves__tape *tape, const laves__instruction *p, const laves__interval operand[3],
                             bool *may_be_nan) {
  const laves__interval a = operand[0], b = operand[1], c = operand[2];
  switch ((laves__op)p->op) {
    case LAVES__OP_NEGATE:
      return (laves__interval){-a.upper, -a.lower};
    case LAVES__OP_ABS:
      return absolute(a);
    case LAVES__OP_SQUARE:
      return square(a);
    case LAVES__OP_SQRT:
      return square_root(a);
    case LAVES__OP_SIN:
      return sine(a, 0);
    case LAVES__OP_COS:
      return sine(a, 1);
    case LAVES__OP_TAN:
      return tangent(a);
    case LAVES__OP_ASIN:
      return rounded(asin_of(a.lower), asin_of(a.upper));
    case LAVES__OP_ACOS:
      return rounded(acos_of(a.upper), acos_of(a.lower));
    case LAVES__OP_EXP:
      return rounded(exp_of(a.lower), exp_of(a.upper));
    case LAVES__OP_LOG:
      return widened(log_of(a.lower), log_of(a.upper), 1e-15);
    case LAVES__OP_FLOOR:
      return (laves__interval){floor(a.lower), floor(a.upper)};
    case LAVES__OP_ADD:
      return add(a, b);
    case LAVES__OP_SUB:
      return subtract(a, b);
    case LAVES__OP_MUL:
      return multiply(a, b);
    case LAVES__OP_DIV:
      return divide(a, b, may_be_nan);
    case LAVES__OP_MIN:
      return (laves__interval){min_of(a.lower, b.lower), min_of(a.upper, b.upper)};
    case LAVES__OP_MAX:
      return (laves__interval){max_of(a.lower, b.lower), max_of(a.upper, b.upper)};
    case LAVES__OP_POW:
      return power(a, b);
    case LAVES__OP_ATAN2:
      return angle(a, b);
    case LAVES__OP_MOD:
      return modulo(a, b);
    case LAVES__OP_NORM2:
      return square_root(add(square(a), square(b)));
    case LAVES__OP_NORM3:
      return square_root(add(add(square(a), square(b)), square(c)));
    case LAVES__OP_LEAF:
      return leaf_range(&tape->leaves[p->leaf], operand);
    default:
      return entire();
  }
}

static bool is_finite(laves__interval a) { return isfinite(a.lower) && isfinite(a.upper); }

/* each: [tape->count] receives what every instruction yields; NULL: not wanted. */
static laves__interval run(const laves__tape *tape, laves__box3 box, bool *may_be_nan, laves__interval *registers,
                           laves__interval *each) {
  registers[0] = (laves__interval){box.lower.x, box.upper.x};
  registers[1] = (laves__interval){box.lower.y, box.upper.y};
  registers[2] = (laves__interval){box.lower.z, box.upper.z};
  *may_be_nan = false;
  const laves__instruction *end = tape->instructions + tape->count;
  laves__interval result = entire();
  for (const laves__instruction *p = tape->instructions; p < end; p++) {
    laves__interval operand[3] = {entire(), entire(), entire()};
    bool finite = true;
    for (int i = 0; i < laves__op_operands[p->op]; i++) {
      const bool is_constant = p->operand[i] == LAVES__OPERAND_CONSTANT;
      operand[i] = is_constant ? (laves__interval){p->constant, p->constant} : registers[p->operand[i]];
      finite = finite && is_finite(operand[i]);
    }
    result = apply(tape, p, operand, may_be_nan);
    /* An overflow, of a folded constant too, may become NaN further on. */
    if ((finite && !is_finite(result)) || !isfinite(p->constant)) *may_be_nan = true;
    registers[p->out] = result;
    if (each) *each++ = result;
  }
  return result;
}

static laves__interval run_large(const laves__tape *tape, laves__box3 box, bool *may_be_nan, laves__interval *each) {
  laves__interval registers[LAVES__REGISTER_LIMIT];
  return run(tape, box, may_be_nan, registers, each);
}

static laves__interval run_small(const laves__tape *tape, laves__box3 box, bool *may_be_nan, laves__interval *each) {
  laves__interval registers[LAVES__REGISTERS_FEW];
  return run(tape, box, may_be_nan, registers, each);
}

laves__interval laves__tape_intervals(const laves__tape *tape, laves__box3 box, bool *may_be_nan, laves__interval *each) {
  return tape->register_count <= LAVES__REGISTERS_FEW ? run_small(tape, box, may_be_nan, each)
                                                      : run_large(tape, box, may_be_nan, each);
}

laves__interval laves__tape_interval(const laves__tape *tape, laves__box3 box, bool *may_be_nan) {
  return laves__tape_intervals(tape, box, may_be_nan, NULL);
}
