/* How well a mesh keeps the creases and corners of its domain: the story.
 *
 *   edges of the boundary -> vertices and edges that lie on creases -> creases, corners -> sharp edges, faces across creases ->
 *   angles -> places, the worst first
 *
 * In: a mesh of any program, and the features of the domain.  Out: the figures of laves_feature_check, lists of places.
 *
 * Two things are asked of a crease. Its samples must be near boundary edges; and these edges must run along creases, which is
 * to say that both their ends are within the tolerance of one: in a fine mesh some edge passes near any place. */
#include "certify/check_features.h"

#include <string.h>

static const uint32_t feature_cookie = 0x66656174;

/* Of the diagonal of the domain's box: how far a crease may be from the mesh's edges to count as kept. */
static const double tolerance_share = 1e-3;
/* Degrees inside the solid: a crease that is sharper forces angles below the window that meshes are commonly asked for. */
static const double forcing_angle = 70;

/* ---- names ---- */

static const char *const fault_names[][2] = {
#define FAULT_NAME(name, key, text) {key, text},
    LAVES_FEATURE_FAULT_LIST(FAULT_NAME)
#undef FAULT_NAME
};

static const char *name_of(laves_feature_fault fault, int column) {
  return (size_t)fault < LAVES__COUNT_OF(fault_names) ? fault_names[fault][column] : "unknown";
}

const char *laves_feature_fault_key(laves_feature_fault fault) { return name_of(fault, 0); }
const char *laves_feature_fault_text(laves_feature_fault fault) { return name_of(fault, 1); }

laves_feature_options laves_feature_options_default(void) {
  return (laves_feature_options){.angle = laves_options_default().feature_angle, .cookie = feature_cookie};
}

/* ---- places ---- */

laves_feature_place *laves__feature_place_add(laves__feature_findings *f, laves_feature_fault fault, laves__vec3 local) {
  laves__feature_places *list = &f->places[fault];
  const laves__vec3 place = v3_add(local, f->oracle->origin);
  if (!laves__grow(f->context, &list->items, &list->capacity, list->count + 1, sizeof *list->items)) return NULL;
  laves_feature_place *p = &list->items[list->count++];
  *p = (laves_feature_place){.fault = fault, .distance = NAN, .length = NAN, .angle = NAN, .dihedral = NAN, .index = -1};
  memcpy(p->place, &place, sizeof p->place);
  return p;
}

/* Creases by their length, the sharpest by their angle, all else by the distance. Not negative. */
static double badness(const laves_feature_place *p) {
  if (p->fault == LAVES_FEATURE_FAULT_CREASE) return p->length;
  if (p->fault == LAVES_FEATURE_FAULT_SHARP) return 360 - p->angle;
  return p->distance >= 0 ? p->distance : 0;
}

/* Sorts the worst to the front, keeping the order of equals. The bits of positive doubles are in the order of their values. */
static bool sort_places(laves_context *context, laves__feature_places *list) {
  const size_t count = list->count;
  if (count < 2) return true;
  laves__keyed *order = laves__alloc(context, count, sizeof *order), *scratch = laves__alloc(context, count, sizeof *scratch);
  laves_feature_place *copy = laves__alloc(context, count, sizeof *copy);
  const bool done = order && scratch && copy;
  for (size_t i = 0; done && i < count; i++) {
    const double bad = badness(&list->items[i]);
    order[i].value = i;
    memcpy(&order[i].key, &bad, sizeof bad);
    order[i].key = ~order[i].key;
  }
  if (done) {
    laves__sort_keyed(NULL, order, scratch, count);
    memcpy(copy, list->items, count * sizeof *copy);
    for (size_t i = 0; i < count; i++) list->items[i] = copy[order[i].value];
  }
  laves__free(context, copy, count, sizeof *copy);
  laves__free(context, scratch, count, sizeof *scratch);
  laves__free(context, order, count, sizeof *order);
  return done;
}

/* ---- what lies on creases ---- */

typedef struct sharp_question {
  const laves__features *features;
} sharp_question;

static double measure_sharp(void *user, uint32_t slot, double distance2, laves__vec3 p) {
  const laves__features *features = ((const sharp_question *)user)->features;
  (void)p;
  return features->crease[features->slot_crease[slot]].least_angle < forcing_angle ? distance2 : INFINITY;
}

static bool has_sharp_near(const laves__features *features, laves__vec3 p, double reach) {
  sharp_question question = {features};
  laves__nearest nearest = {reach * reach, LAVES__NONE};
  laves__bvh_nearest_part(&features->tree, p, measure_sharp, &question, &nearest);
  return nearest.slot != LAVES__NONE;
}

/* Vertices, each by its own thread: nothing else is written. */
static void touch_block(void *user, size_t begin, size_t end, int worker) {
  laves__feature_findings *f = user;
  (void)worker;
  for (size_t v = begin; v < end; v++) {
    laves__vec3 foot, tangent;
    const laves__vec3 p = f->edges.point[v];
    if (!f->touch[v]) continue;
    f->touch[v] = 0;
    if (!v3_finite(p) || laves__crease_near(f->features, p, f->check->tolerance, &foot, &tangent) == LAVES__NO_FEATURE) continue;
    f->touch[v] = LAVES__TOUCHES;
    if (has_sharp_near(f->features, p, f->check->tolerance)) f->touch[v] |= LAVES__TOUCHES_SHARP;
  }
}

/* Only those of the boundary are looked at, which are marked before. */
static bool touch_vertices(laves__feature_findings *f) {
  if (f->features->crease_count == 0) return true;
  for (size_t i = 0; i < f->edges.count; i++)
    for (int k = 0; k < 2; k++) f->touch[f->edges.ends[i][k]] = 1;
  return laves__parallel_for(f->context, "check", f->mesh->vertex_count, 4096, touch_block, f);
}

static void edge_block(void *user, size_t begin, size_t end, int worker) {
  laves__feature_findings *f = user;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    const int32_t *ends = f->edges.ends[i];
    laves__vec3 foot, tangent;
    f->edge_crease[i] = LAVES__NO_FEATURE;
    f->runs_along[i] = f->touch[ends[0]] && f->touch[ends[1]];
    if (!f->runs_along[i]) continue;
    const laves__vec3 middle = v3_lerp(f->edges.point[ends[0]], f->edges.point[ends[1]], 0.5);
    f->edge_crease[i] = laves__crease_near(f->features, middle, f->check->tolerance, &foot, &tangent);
  }
}

/* ---- the story ---- */

static bool allocate(laves__feature_findings *f) {
  f->touch = laves__alloc_zeroed(f->context, f->mesh->vertex_count, sizeof *f->touch);
  f->runs_along = laves__alloc_zeroed(f->context, f->edges.count, sizeof *f->runs_along);
  f->edge_crease = laves__alloc(f->context, f->edges.count, sizeof *f->edge_crease);
  f->crease = laves__alloc_zeroed(f->context, f->features->crease_count, sizeof *f->crease);
  return f->touch && f->runs_along && f->edge_crease && f->crease;
}

static void begin_check(laves__feature_findings *f, const laves_feature_options *options) {
  laves_feature_check *c = f->check;
  const double edge = f->edges.mean, diagonal = box3_diagonal(f->oracle->bounds);
  *c = (laves_feature_check){.angle = options->angle,
                             .size = options->size > 0 ? options->size : edge,
                             .tolerance = options->tolerance > 0 ? options->tolerance : tolerance_share * diagonal,
                             .diagonal = diagonal,
                             .edge_mean = edge,
                             .kept_share = 1,
                             .sharpest = NAN};
}

static laves_result measure(laves__feature_findings *f, laves_error *error) {
  if (!touch_vertices(f)) return laves__fail_cancelled(error);
  if (!laves__parallel_for(f->context, "check", f->edges.count, 4096, edge_block, f)) return laves__fail_cancelled(error);
  laves_result result = laves__check_creases(f, error);
  if (result == LAVES_OK) result = laves__check_corners(f, error);
  if (result == LAVES_OK) result = laves__check_sharp_edges(f, error);
  if (result == LAVES_OK) result = laves__check_straddling(f, error);
  if (result == LAVES_OK) result = laves__check_edge_angles(f, error);
  if (result == LAVES_OK) result = laves__check_sharp_creases(f, error);
  for (int fault = 0; fault < LAVES_FEATURE_FAULT_COUNT && result == LAVES_OK; fault++)
    if (!sort_places(f->context, &f->places[fault])) result = laves__fail_memory(f->context, error);
  return result;
}

laves_result laves__check_features_of(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                      const laves__features *features, const laves_feature_options *options,
                                      laves_feature_check *check, laves__feature_findings *findings, laves_error *error) {
  *findings = (laves__feature_findings){
      .context = context, .mesh = mesh, .boundary = boundary, .oracle = features->oracle, .features = features, .check = check};
  const laves_result result =
      laves__boundary_edges_find(context, mesh, boundary, features->oracle->origin, &findings->edges, error);
  if (result != LAVES_OK) return result;
  if (!allocate(findings)) return laves__fail_memory(context, error);
  begin_check(findings, options);
  return measure(findings, error);
}

void laves__feature_findings_free(laves__feature_findings *f) {
  laves_context *context = f->context;
  if (!context) return;
  laves__free(context, f->touch, f->mesh->vertex_count, sizeof *f->touch);
  laves__free(context, f->runs_along, f->edges.count, sizeof *f->runs_along);
  laves__free(context, f->edge_crease, f->edges.count, sizeof *f->edge_crease);
  laves__free(context, f->crease, f->features->crease_count, sizeof *f->crease);
  for (int i = 0; i < LAVES_FEATURE_FAULT_COUNT; i++)
    laves__free(context, f->places[i].items, f->places[i].capacity, sizeof *f->places[i].items);
  laves__boundary_edges_free(&f->edges);
  memset(f, 0, sizeof *f);
}

/* ---- the public call ---- */

laves_result laves__check_feature_options(const laves_feature_options *o, laves_error *error) {
  if (o->cookie != feature_cookie)
    return laves__fail(error, LAVES_ERROR_OPTION, "the options do not come from laves_feature_options_default()");
  if (o->angle != 0 && !(o->angle >= 1 && o->angle <= 179))
    return laves__fail(error, LAVES_ERROR_OPTION, "the feature angle is %g; it must be 0 or within 1..179 degrees", o->angle);
  if (!(o->size >= 0 && isfinite(o->size) && o->tolerance >= 0 && isfinite(o->tolerance)))
    return laves__fail(error, LAVES_ERROR_OPTION, "size %g and tolerance %g of features must be finite and not negative", o->size,
                       o->tolerance);
  return LAVES_OK;
}

/* The mean length of a boundary's edges, as it serves where no size was asked for. */
static double mean_edge(const laves_mesh *mesh, const laves__boundary *boundary) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < 3 * boundary->count; i++) {
    const int32_t *face = boundary->faces[i / 3];
    const double length = v3_distance(mesh->points[face[i % 3]], mesh->points[face[(i % 3 + 1) % 3]]);
    if (!isfinite(length)) continue;
    sum += length;
    count++;
  }
  return count ? sum / (double)count : 0;
}

static size_t copy_places(const laves__feature_findings *f, laves_feature_place *places, size_t capacity) {
  size_t count = 0;
  for (int fault = 0; fault < LAVES_FEATURE_FAULT_COUNT; fault++)
    for (size_t i = 0; i < f->places[fault].count && i < capacity; i++) places[count++] = f->places[fault].items[i];
  return count;
}

laves_result laves__find_features_for(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                      const laves__oracle *oracle, const laves_feature_options *options,
                                      laves__features *features, laves_error *error) {
  const laves__feature_wish wish = {.angle = options->angle,
                                    .tags = options->tags,
                                    .drawn = options->features,
                                    .size = options->size > 0 ? options->size : mean_edge(mesh, boundary)};
  return laves__features_find(context, oracle, &wish, features, error);
}

laves_result laves_check_features(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                  const laves_feature_options *options, laves_feature_check *check, laves_feature_place *places,
                                  size_t capacity, size_t *count, laves_error *error) {
  const laves_result held = laves__mesh_require_arrays(mesh, "a check", error);
  if (held != LAVES_OK) return held;
  const laves_feature_options defaults = laves_feature_options_default();
  laves__boundary boundary = {0};
  laves__features features = {0};
  laves__feature_findings findings = {0};
  if (!options) options = &defaults;
  *count = 0;
  memset(check, 0, sizeof *check);
  laves__progress_reset(context);
  laves_result result = laves__check_feature_options(options, error);
  if (result == LAVES_OK) result = laves__find_boundary(context, mesh, &boundary, error);
  if (result == LAVES_OK && boundary.count == 0)
    result = laves__fail(error, LAVES_ERROR_INPUT, "the mesh has no boundary, so there is nothing to hold features against");
  if (result == LAVES_OK) result = laves__find_features_for(context, mesh, &boundary, &domain->oracle, options, &features, error);
  if (result == LAVES_OK)
    result = laves__check_features_of(context, mesh, &boundary, &features, options, check, &findings, error);
  if (result == LAVES_OK) *count = copy_places(&findings, places, capacity);
  laves__feature_findings_free(&findings);
  laves__features_free(&features);
  laves__boundary_free(&boundary);
  return result;
}
