/* Which named region of an expression a point is in.
 *
 * The tape is run at the point, and where the value of a named solid has been computed its sign is looked at. Of several regions
 * the one that was named first counts: what is inside another name was named before it. */
#include "domain/tape.h"

static double operand(const laves__instruction *p, const double *value, int k) {
  return p->operand[k] == LAVES__OPERAND_CONSTANT ? p->constant : value[p->operand[k]];
}

static double result_of(const laves__tape *tape, const laves__instruction *p, const double *value) {
  const laves__op op = (laves__op)p->op;
  double o[3] = {0, 0, 0};
  for (int k = 0; k < laves__op_operands[op]; k++) o[k] = operand(p, value, k);
  if (op != LAVES__OP_LEAF) return laves__op_value(op, o[0], o[1], o[2]);
  const laves__oracle *leaf = &tape->leaves[p->leaf];
  const laves__vec3 at = v3_sub(v3(o[0], o[1], o[2]), leaf->origin);
  double phi;
  leaf->evaluate(leaf->self, 1, &at, &phi, NULL);
  return phi;
}

int32_t laves__tape_region_at(const laves__tape *tape, laves__vec3 point) {
  double value[LAVES__REGISTER_LIMIT];
  int32_t least = LAVES__NO_TAG;
  value[0] = point.x;
  value[1] = point.y;
  value[2] = point.z;
  size_t done = 0;
  for (size_t i = 0; i < tape->region_count; i++) {
    const laves__tape_region *r = &tape->regions[i];
    for (; done < r->after; done++) value[tape->instructions[done].out] = result_of(tape, &tape->instructions[done], value);
    if (value[r->operand] < 0 && (least == LAVES__NO_TAG || r->region < least)) least = r->region;
  }
  return least;
}
