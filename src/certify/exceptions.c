/* What is out of order in a mesh, where, and why.
 *
 * Counts are exact; of each kind the first LAVES_PLACE_CAPACITY are listed, the worst first where there is a measure. Windows are
 * looked into tet by tet only when the extremes leave them.
 *
 * The cause is read from the domain's surface near the place: thin, when walking a size inwards from the nearest point of the
 * surface comes out of the solid; a crease, when the surface's radius of curvature there is below half an edge; curved,
 * below two. Where features were looked for, a tet with an edge on a crease that cannot be divided into angles of the window has
 * that crease for its cause, and its angle is told. Sizes are those of the edges near the place: the mean edge of the mesh times
 * the power of two nearest to the mean edge of the boundary there. */
#include <string.h>

#include "base/predicates.h"
#include "certify/check_features.h"

/* Radii of curvature in sizes. A crease shows as about a quarter of the scale at which it is looked at; see curvature.c. */
#define CREASE_RADIUS 0.5
#define CURVED_RADIUS 2.0
/* Steps of the walk through the solid, each this share of a size. */
enum { WALK_STEPS = 8 };

_Static_assert(LAVES_EXCEPTION_CAPACITY >= LAVES_EXCEPTION_COUNT * LAVES_PLACE_CAPACITY, "every kind has its share");

typedef struct listing {
  laves_context *context;
  const laves_mesh *mesh;
  const laves_domain *domain; /* or NULL */
  const laves__survey *survey;
  const laves__feature_findings *features; /* or NULL */
  laves_certificate *c;
  double size;    /* of the mesh's edges */
  bool is_graded; /* somewhere the size is another */
} listing;

/* ---- names ---- */

static const char *const exception_names[][2] = {
#define EXCEPTION_NAME(name, key, text) {key, text},
    LAVES_EXCEPTION_LIST(EXCEPTION_NAME)
#undef EXCEPTION_NAME
};
static const char *const cause_names[][2] = {
#define CAUSE_NAME(name, key, text) {key, text},
    LAVES_CAUSE_LIST(CAUSE_NAME)
#undef CAUSE_NAME
};

static const char *name_of(const char *const (*names)[2], size_t count, int index, int column) {
  return index >= 0 && (size_t)index < count ? names[index][column] : "unknown";
}

const char *laves_exception_key(laves_exception_kind kind) {
  return name_of(exception_names, LAVES__COUNT_OF(exception_names), (int)kind, 0);
}
const char *laves_exception_text(laves_exception_kind kind) {
  return name_of(exception_names, LAVES__COUNT_OF(exception_names), (int)kind, 1);
}
const char *laves_cause_key(laves_cause cause) { return name_of(cause_names, LAVES__COUNT_OF(cause_names), (int)cause, 0); }
const char *laves_cause_text(laves_cause cause) { return name_of(cause_names, LAVES__COUNT_OF(cause_names), (int)cause, 1); }

/* ---- local sizes ---- */

static bool is_graded(const listing *l) {
  const laves__samples *samples = &l->survey->samples;
  for (size_t v = 0; samples->edges && v < samples->vertex_count; v++)
    if (laves__edge_level((double)samples->edges[v], l->size) != 0) return true;
  return false;
}

/* By the boundary's nearest vertex. */
static double size_at(const listing *l, laves__vec3 place) {
  const laves__boundary *boundary = &l->survey->boundary;
  const float *edges = l->survey->samples.edges;
  double nearest = INFINITY, edge = 0;
  if (!l->is_graded) return l->size;
  for (size_t i = 0; i < 3 * boundary->count; i++) {
    const int32_t v = boundary->faces[i / 3][i % 3];
    const double distance = v3_norm2(v3_sub(l->mesh->points[v], place));
    if (!(distance < nearest)) continue;
    nearest = distance;
    edge = (double)edges[v];
  }
  return ldexp(l->size, laves__edge_level(edge, l->size));
}

/* ---- causes ---- */

/* Whether the walk from the nearest point of the surface, against its normal, leaves the solid within a size. */
static bool is_thin(const listing *l, laves__vec3 local, double size) {
  const laves__oracle *oracle = &l->domain->oracle;
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal, steps[WALK_STEPS];
  double phi[WALK_STEPS];
  if (!oracle->project(oracle->self, local, 2 * size, &hint, &foot, &normal)) return false;
  for (int i = 0; i < WALK_STEPS; i++) steps[i] = v3_mad(foot, normal, -size * (i + 1) / WALK_STEPS);
  oracle->evaluate(oracle->self, WALK_STEPS, steps, phi, NULL);
  for (int i = 0; i < WALK_STEPS; i++)
    if (phi[i] > 0) return true;
  return false;
}

/* Whether tets at a crease of this angle may have to leave a window: where two share it, each has half. */
static bool forces(double crease_angle, double min_dihedral) { return crease_angle < 2 * min_dihedral; }

static laves_cause cause_of(const listing *l, laves__vec3 place, double curvature_radius) {
  if (!l->domain || !v3_finite(place)) return LAVES_CAUSE_UNKNOWN;
  const double size = size_at(l, place);
  if (is_thin(l, v3_sub(place, l->domain->oracle.origin), size)) return LAVES_CAUSE_THIN;
  if (curvature_radius < CREASE_RADIUS * size) return LAVES_CAUSE_CREASE;
  return curvature_radius < CURVED_RADIUS * size ? LAVES_CAUSE_CURVED : LAVES_CAUSE_UNKNOWN;
}

/* ---- the list ---- */

static void add(const listing *l, laves_exception_kind kind, laves__vec3 place, double value, double limit, int64_t index,
                double curvature_radius) {
  laves_certificate *c = l->c;
  laves_exception *e = &c->exceptions[c->exception_count++];
  *e = (laves_exception){
      .kind = kind, .value = value, .limit = limit, .index = index, .curvature_radius = curvature_radius, .crease_angle = NAN};
  memcpy(e->place, &place, sizeof place);
  e->cause = kind == LAVES_EXCEPTION_THIN ? LAVES_CAUSE_THIN : cause_of(l, place, curvature_radius);
}

/* The same for a tet outside a window that begins at min_dihedral. */
static void add_tet(const listing *l, laves_exception_kind kind, const laves_place *p, double limit, double min_dihedral) {
  add(l, kind, v3(p->place[0], p->place[1], p->place[2]), p->value, limit, p->tet, p->curvature_radius);
  laves_exception *e = &l->c->exceptions[l->c->exception_count - 1];
  if (l->features) e->crease_angle = laves__feature_angle_at(l->features, p->tet);
  if (forces(e->crease_angle, min_dihedral)) e->cause = LAVES_CAUSE_CREASE;
}

static double curvature_at(const listing *l, laves__vec3 place) {
  return l->domain ? laves__curvature_radius(l->domain, place, size_at(l, place)) : NAN;
}

static laves__vec3 centroid_of(const laves_mesh *mesh, size_t tet) {
  laves__vec3 p[4];
  if (!laves__tet_corners(mesh, tet, p)) return v3(NAN, NAN, NAN);
  return v3_scale(v3_add(v3_add(p[0], p[1]), v3_add(p[2], p[3])), 0.25);
}

/* The first of them; the check has counted them, so that most meshes need no look. */
static void list_inverted(const listing *l) {
  const size_t count = l->c->check.inverted_tets;
  size_t listed = 0;
  l->c->exception_counts[LAVES_EXCEPTION_INVERTED_TET] = count;
  for (size_t t = 0; t < l->mesh->tet_count && listed < count && listed < LAVES_PLACE_CAPACITY; t++) {
    laves__vec3 p[4];
    if (laves__tet_corners(l->mesh, t, p) && laves__orient3d(p[0], p[1], p[2], p[3]) > 0) continue;
    const laves__vec3 place = centroid_of(l->mesh, t);
    add(l, LAVES_EXCEPTION_INVERTED_TET, place, NAN, NAN, (int64_t)t, curvature_at(l, place));
    listed++;
  }
}

static size_t at_most_listed(size_t count) { return count < LAVES_PLACE_CAPACITY ? count : LAVES_PLACE_CAPACITY; }

static void list_nonmanifold(const listing *l) {
  const laves_check *check = &l->c->check;
  const laves__vec3 *points = l->mesh->points;
  l->c->exception_counts[LAVES_EXCEPTION_NONMANIFOLD_EDGE] = check->nonmanifold_edges;
  l->c->exception_counts[LAVES_EXCEPTION_NONMANIFOLD_VERTEX] = check->nonmanifold_vertices;
  for (size_t i = 0; i < at_most_listed(check->nonmanifold_edges); i++) {
    const int32_t *edge = l->survey->faults.edges[i];
    const laves__vec3 place = v3_lerp(points[edge[0]], points[edge[1]], 0.5);
    add(l, LAVES_EXCEPTION_NONMANIFOLD_EDGE, place, NAN, NAN, edge[0], curvature_at(l, place));
  }
  for (size_t i = 0; i < at_most_listed(check->nonmanifold_vertices); i++) {
    const int32_t vertex = l->survey->faults.vertices[i];
    add(l, LAVES_EXCEPTION_NONMANIFOLD_VERTEX, points[vertex], NAN, NAN, vertex, curvature_at(l, points[vertex]));
  }
}

typedef struct limits {
  double min_dihedral, max_dihedral, volume_length;
} limits;

static double limit_of(const limits *w, double value) {
  if (value < 1 && value < w->min_dihedral && w->volume_length > 0) return w->volume_length;
  return value < w->min_dihedral ? w->min_dihedral : w->max_dihedral;
}

/* Tets that leave a window, worst first. */
static laves_result list_window(const listing *l, laves_exception_kind kind, const limits *w, laves_error *error) {
  const laves_check *check = &l->c->check;
  const bool measured = check->min_dihedral_tet >= 0 && check->bad_indices == 0 && isfinite(check->radius_edge.max);
  if (measured && check->min_dihedral.min >= w->min_dihedral && check->max_dihedral.max <= w->max_dihedral &&
      check->volume_length.min >= w->volume_length)
    return LAVES_OK;
  laves_place places[LAVES_PLACE_CAPACITY];
  size_t count;
  const laves_result result = laves_check_window(l->context, l->mesh, l->domain, w->min_dihedral, w->max_dihedral,
                                                 w->volume_length, places, LAVES_PLACE_CAPACITY, &count, error);
  if (result != LAVES_OK) return result;
  l->c->exception_counts[kind] = count;
  for (size_t i = 0; i < at_most_listed(count); i++) add_tet(l, kind, &places[i], limit_of(w, places[i].value), w->min_dihedral);
  return LAVES_OK;
}

/* Inside by more than the margin, so that no rounding can have hidden an exception. */
static laves_result judge_promise(const listing *l, laves_error *error) {
  laves_certificate *c = l->c;
  c->promise_holds = !c->has_promise;
  if (!c->has_promise) return LAVES_OK;
  const limits promised = {c->promised_min_dihedral > 0 ? c->promised_min_dihedral + c->angle_margin : 0,
                           c->promised_max_dihedral < 180 ? c->promised_max_dihedral - c->angle_margin : 180, 0};
  const laves_result result = list_window(l, LAVES_EXCEPTION_OUTSIDE_PROMISED, &promised, error);
  c->promise_holds = c->check.valid && c->exception_counts[LAVES_EXCEPTION_OUTSIDE_PROMISED] == 0;
  return result;
}

static laves_result list_distant(const listing *l, laves_error *error) {
  laves_place places[LAVES_PLACE_CAPACITY];
  double allowed[LAVES_PLACE_CAPACITY];
  size_t count;
  if (!(l->c->distance_asked > 0)) return LAVES_OK;
  const laves_result result = laves__distant_places(l->context, &l->survey->samples, l->domain, l->c->distance_asked, l->size,
                                                    places, allowed, LAVES_PLACE_CAPACITY, &count, error);
  if (result != LAVES_OK) return result;
  l->c->exception_counts[LAVES_EXCEPTION_DISTANT] = count;
  for (size_t i = 0; i < at_most_listed(count); i++) {
    const laves__vec3 place = v3(places[i].place[0], places[i].place[1], places[i].place[2]);
    add(l, LAVES_EXCEPTION_DISTANT, place, places[i].value, allowed[i], -1, curvature_at(l, place));
  }
  return LAVES_OK;
}

/* The distance of a sample in units in which the edges near by are as long as the mean. */
static double even_distance(const listing *l, const laves__sample *s) {
  return ldexp(s->distance, -laves__edge_level((double)s->edge, l->size));
}

/* Counts vertices off the surface and keeps the furthest, by insertion. */
static void list_off_surface(const listing *l) {
  const laves__samples *samples = &l->survey->samples;
  const laves__sample *worst[LAVES_PLACE_CAPACITY];
  size_t count = 0, kept = 0;
  const double limit = l->c->off_surface_asked;
  if (!(limit > 0)) return;
  for (size_t i = 0; i < samples->boundary_count; i++) {
    const laves__sample *s = &samples->items[i];
    if (s->vertex < 0 || !(even_distance(l, s) > limit)) continue;
    count++;
    size_t at = kept;
    while (at > 0 && even_distance(l, worst[at - 1]) < even_distance(l, s)) at--;
    if (at == LAVES_PLACE_CAPACITY) continue;
    if (kept < LAVES_PLACE_CAPACITY) kept++;
    for (size_t j = kept - 1; j > at; j--) worst[j] = worst[j - 1];
    worst[at] = s;
  }
  l->c->exception_counts[LAVES_EXCEPTION_OFF_SURFACE] = count;
  for (size_t i = 0; i < kept; i++) {
    const laves__sample *s = worst[i];
    add(l, LAVES_EXCEPTION_OFF_SURFACE, s->point, s->distance, ldexp(limit, laves__edge_level((double)s->edge, l->size)),
        s->vertex, curvature_at(l, s->point));
  }
}

static laves_result list_thin(const listing *l, laves_error *error) {
  laves_thin_place places[LAVES_PLACE_CAPACITY];
  if (!l->domain || !(l->c->distance_asked > 0)) return LAVES_OK;
  const size_t found = laves_domain_thin_places(l->domain, places, LAVES_PLACE_CAPACITY);
  if (found == 0 && isnan(places[0].thickness)) return laves__fail_memory(l->context, error);
  for (size_t i = 0; i < found && i < LAVES_PLACE_CAPACITY; i++) {
    const laves__vec3 place = v3(places[i].place[0], places[i].place[1], places[i].place[2]);
    const double size = size_at(l, place);
    if (!(places[i].thickness < size)) continue;
    add(l, LAVES_EXCEPTION_THIN, place, places[i].thickness, size, -1, curvature_at(l, place));
    l->c->exception_counts[LAVES_EXCEPTION_THIN]++;
  }
  return LAVES_OK;
}

/* ---- features ---- */

/* That a feature is lost needs another cause than that it is one. */
static void add_feature(const listing *l, laves_exception_kind kind, const laves_feature_place *p, double limit) {
  const laves__vec3 place = v3(p->place[0], p->place[1], p->place[2]);
  add(l, kind, place, p->distance, limit, -1, curvature_at(l, place));
  laves_exception *e = &l->c->exceptions[l->c->exception_count - 1];
  e->crease_angle = p->angle;
  if (e->cause != LAVES_CAUSE_THIN) e->cause = LAVES_CAUSE_UNKNOWN;
}

static void list_lost(const listing *l, laves_exception_kind kind, laves_feature_fault fault, double limit) {
  const laves__feature_places *lost = &l->features->places[fault];
  l->c->exception_counts[kind] = lost->count;
  for (size_t i = 0; i < at_most_listed(lost->count); i++) add_feature(l, kind, &lost->items[i], limit);
}

/* Creases that are sharper than either window allows. The sharpest come first. */
static void list_sharp(const listing *l) {
  const laves_certificate *c = l->c;
  const laves__feature_places *sharp = &l->features->places[LAVES_FEATURE_FAULT_SHARP];
  const double limit = fmax(c->asked_min_dihedral, c->promised_min_dihedral);
  for (size_t i = 0; i < sharp->count && sharp->items[i].angle < limit; i++) {
    const laves_feature_place *p = &sharp->items[i];
    const laves__vec3 place = v3(p->place[0], p->place[1], p->place[2]);
    if (l->c->exception_counts[LAVES_EXCEPTION_SHARP_INPUT]++ >= LAVES_PLACE_CAPACITY) continue;
    add(l, LAVES_EXCEPTION_SHARP_INPUT, place, p->angle, limit, p->index, curvature_at(l, place));
    laves_exception *e = &l->c->exceptions[l->c->exception_count - 1];
    e->crease_angle = p->angle;
    e->cause = LAVES_CAUSE_CREASE;
  }
}

static void list_features(const listing *l) {
  if (!l->features) return;
  const laves_feature_check *check = &l->c->features;
  list_lost(l, LAVES_EXCEPTION_CREASE_LOST, LAVES_FEATURE_FAULT_CREASE, check->tolerance);
  list_lost(l, LAVES_EXCEPTION_CORNER_LOST, LAVES_FEATURE_FAULT_CORNER, 0);
  list_sharp(l);
}

laves_result laves__list_exceptions(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                    const laves__survey *survey, const laves__feature_findings *features,
                                    laves_certificate *certificate, laves_error *error) {
  listing l = {.context = context,
               .mesh = mesh,
               .domain = domain,
               .survey = survey,
               .features = features,
               .c = certificate,
               .size = certificate->check.edge_mean};
  const limits asked = {certificate->asked_min_dihedral, certificate->asked_max_dihedral, certificate->asked_volume_length};
  l.is_graded = is_graded(&l);
  list_inverted(&l);
  list_nonmanifold(&l);
  laves_result result = judge_promise(&l, error);
  if (result == LAVES_OK) result = list_window(&l, LAVES_EXCEPTION_OUTSIDE_ASKED, &asked, error);
  if (result == LAVES_OK) result = list_distant(&l, error);
  if (result != LAVES_OK) return result;
  list_off_surface(&l);
  result = list_thin(&l, error);
  if (result == LAVES_OK) list_features(&l);
  return result;
}
