/* Places of the defects of a surface. */
#include "domain/defects.h"

laves_result laves_defects_create(laves_context *context, laves_defects **defects, laves_error *error) {
  *defects = laves__alloc_zeroed(context, 1, sizeof **defects);
  if (!*defects) return laves__fail_memory(context, error);
  (*defects)->context = context;
  return LAVES_OK;
}

void laves__defects_clear(laves_defects *defects) {
  laves__free(defects->context, defects->items, defects->capacity, sizeof *defects->items);
  *defects = (laves_defects){.context = defects->context};
}

void laves_defects_free(laves_defects *defects) {
  if (!defects) return;
  laves__defects_clear(defects);
  laves__free(defects->context, defects, 1, sizeof *defects);
}

void laves__defects_move(laves_defects *defects, laves__vec3 by) {
  for (size_t i = 0; i < defects->count; i++)
    for (int k = 0; k < 3; k++) defects->items[i].corners[k] = v3_add(defects->items[i].corners[k], by);
}

void laves__defects_add(laves_defects *defects, laves_defect kind, int corner_count, const laves__vec3 *corners) {
  if (!defects) return;
  if (!laves__grow(defects->context, &defects->items, &defects->capacity, defects->count + 1, sizeof *defects->items)) {
    defects->short_of_memory = true;
    return;
  }
  laves__defect_item *item = &defects->items[defects->count++];
  *item = (laves__defect_item){.kind = (int32_t)kind, .corner_count = corner_count};
  for (int k = 0; k < corner_count; k++) item->corners[k] = corners[k];
}

void laves__note_defect(laves_domain_info *info, laves_defects *defects, laves_defect kind, int corner_count,
                        const laves__vec3 *corners) {
  laves__defects_add(defects, kind, corner_count, corners);
  if (info->defects[kind]++ > 0) return;
  const laves__vec3 place = corner_count == 2 ? v3_lerp(corners[0], corners[1], 0.5) : corners[0];
  info->defect_place[kind][0] = place.x;
  info->defect_place[kind][1] = place.y;
  info->defect_place[kind][2] = place.z;
}

size_t laves_defects_count(const laves_defects *defects) { return defects->count; }

void laves_defects_get(const laves_defects *defects, size_t index, laves_defect_place *place) {
  const laves__defect_item *item = &defects->items[index];
  *place = (laves_defect_place){.kind = (laves_defect)item->kind, .corner_count = item->corner_count};
  for (int k = 0; k < item->corner_count; k++) {
    place->corners[k][0] = item->corners[k].x;
    place->corners[k][1] = item->corners[k].y;
    place->corners[k][2] = item->corners[k].z;
  }
}
