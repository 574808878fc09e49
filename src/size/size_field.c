/* Sizes as expressions and scripts.
 *
 * In: a Lua chunk.  Out: a tape over x, y, z in local coordinates, as for implicit solids. `d` is leaf 0 of the tape, an oracle
 * whose values are depths below the domain's surface; surfaces that the script names follow. */
#include "size/size_parts.h"

static bool names_depth(const laves__tape *tape) {
  for (size_t i = 0; i < tape->count; i++)
    if (tape->instructions[i].op == LAVES__OP_LEAF && tape->instructions[i].leaf == 0) return true;
  return false;
}

laves_result laves__size_field_make(laves_context *context, const laves__source *source, laves__vec3 origin,
                                    laves__size_field *field, laves_error *error) {
  *field = (laves__size_field){.source = source};
  laves__model *model = &field->model;
  laves_result result = laves__script_run_size(context, source->text, source->text_length, source->is_expression, source->name,
                                               source->folder, model, error);
  if (result != LAVES_OK) return result;
  field->leaves = laves__alloc_zeroed(context, model->leaf_count, sizeof *field->leaves);
  if (!field->leaves) return laves__fail_memory(context, error);
  for (size_t i = 1; i < model->leaf_count; i++) field->leaves[i] = model->leaves[i]->oracle;
  laves__affine shift = laves__affine_identity();
  shift.t = origin;
  const laves__node root = laves__expression_lower(&model->expression, model->shape.node, &shift);
  if (root == LAVES__NO_NODE) {
    if (!model->expression.too_large) return laves__fail_memory(context, error);
    return laves__fail(error, LAVES_ERROR_INPUT, "%s: the size needs more than %d operations", source->name,
                       (int)LAVES__NODE_LIMIT);
  }
  result = laves__tape_build(&model->expression, root, field->leaves, &field->tape, error);
  field->uses_depth = result == LAVES_OK && names_depth(&field->tape);
  return result;
}

static void evaluate_depth(const void *self, size_t count, const laves__vec3 *points, double *values, uint32_t *hints) {
  laves__depth_evaluate(self, count, points, values);
  for (size_t i = 0; hints && i < count; i++) hints[i] = LAVES__NO_HINT;
}

/* The tape hands over input coordinates less this oracle's origin, and so local ones. */
void laves__size_field_bind(laves__size_field *field, const laves__depth *depth) {
  field->leaves[0] = (laves__oracle){
      .self = (void *)depth, .origin = depth->oracle->origin, .bounds = depth->oracle->bounds, .evaluate = evaluate_depth};
}

void laves__size_field_free(laves_context *context, laves__size_field *field) {
  laves__tape_free(context, &field->tape);
  laves__free(context, field->leaves, field->model.leaf_count, sizeof *field->leaves);
  laves__model_free(context, &field->model);
}

bool laves__size_field_is_constant(const laves__size_field *field, double *value) {
  return laves__node_is_constant(&field->model.expression, field->model.shape.node, value);
}
