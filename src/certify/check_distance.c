/* Distances between the boundary of a mesh and the surface of a domain, both ways.
 *
 * From the mesh: its boundary vertices, the midpoints of its boundary edges, and four points inside each triangle are
 * projected on to the surface. The inner points (the centroid and the three points that halve the way from it to the
 * corners) carry the mean, each a quarter of the triangle's area; vertices and midpoints only look for the maximum.
 * From the surface: where it is made of flat faces, these are halved across their longest edge until every point of a
 * piece is within a third of the mean boundary edge of the piece's centroid; the centroids look for the nearest boundary
 * triangle, each with the weight of its piece. Other domains offer samples of their own. Where the boundary's edges near by
 * are shorter or longer than their mean, by a power of two, so are the ways between samples. Projection starts with a short
 * reach, which is fast, and widens it while nothing is found.
 *
 * Distance to a set changes by no more than the way one goes. So where it is known how far a point can be from the nearest
 * sample (the cover), the largest distance is known from both sides: sampled <= true <= sampled + cover. The samples of a
 * boundary triangle are the corners and centroids of the four triangles that its midpoints make, so its cover is half that
 * of a triangle by its corners and centroid.
 *
 * A foot that was found by iteration counts for the upper bound when the solid has both inside and outside within a little ball
 * round it: then its boundary passes through that ball, whatever the iteration did.
 *
 * All work is in the domain's local frame, where no digits are lost far from the origin. */
#include <string.h>

#include "certify/boundary_tree.h"

enum { CHUNK = 256, SAMPLES_PER_FACE = 4 + 3 + 3, INNER = 4 };
enum { SEARCHES_BETWEEN_ASKING = 32 }; /* of the nearest triangle: each looks at many where all are as far */

/* Distance of surface samples in mean boundary edges, and the cover of flat ones: about six on the area of a triangle. */
#define SURFACE_SPACING 0.3
/* The first reach of a projection in mean boundary edges; it grows by REACH_GROWTH up to the size of everything. */
#define FIRST_REACH 2.0
#define REACH_GROWTH 8.0
/* What oracle.h promises of distances, relative. */
#define DISTANCE_SLACK 1e-6
/* The first and the longest step to both sides of a foot, in mean boundary edges. */
#define FOOT_STEP 1e-6
#define FOOT_STEP_MAX 1.1e-2
/* More samples would say nothing more; the spacing is widened instead. */
#define SURFACE_SAMPLES_MAX 8e6

void laves__samples_free(laves__samples *samples) {
  if (samples->context) {
    laves__free(samples->context, samples->items, samples->capacity, sizeof *samples->items);
    laves__free(samples->context, samples->edges, samples->vertex_count, sizeof *samples->edges);
  }
  *samples = (laves__samples){0};
}

/* ---- samples on the mesh ---- */

typedef struct measuring {
  const laves_mesh *mesh;
  const laves__boundary *boundary;
  const laves__oracle *oracle;
  laves__samples *samples;
  laves__boundary_tree *tree;
  double reach, reach_max;
  bool is_surface; /* of triangles, clean or not */
} measuring;

/* Mean edge of the boundary and the box of its finite points. */
static double mean_edge(const laves_mesh *mesh, const laves__boundary *boundary, laves__box3 *box) {
  double sum = 0;
  size_t count = 0;
  *box = box3_empty();
  for (size_t i = 0; i < 3 * boundary->count; i++) {
    const laves__vec3 a = mesh->points[boundary->faces[i / 3][i % 3]], b = mesh->points[boundary->faces[i / 3][(i + 1) % 3]];
    const double length = v3_distance(a, b);
    if (!isfinite(length)) continue;
    *box = box3_add(*box, a);
    sum += length;
    count++;
  }
  return count ? sum / (double)count : 0;
}

static laves__sample sample_at(laves__vec3 point, double weight, double edge) {
  return (laves__sample){.point = point, .distance = NAN, .weight = weight, .vertex = -1, .edge = (float)edge};
}

/* In an acute triangle the circumcentre is furthest; else the points of the longest edge that are as far from one of its ends
 * as from the corner opposite. */
double laves__corner_cover(laves__vec3 a, laves__vec3 b, laves__vec3 c) {
  double x2 = v3_norm2(v3_sub(c, b)), y2 = v3_norm2(v3_sub(a, c)), z2 = v3_norm2(v3_sub(b, a)), swap;
  if (x2 > z2) swap = x2, x2 = z2, z2 = swap;
  if (y2 > z2) swap = y2, y2 = z2, z2 = swap;
  if (x2 + y2 > z2) {
    const double area4 = 2 * v3_norm(v3_cross(v3_sub(b, a), v3_sub(c, a)));
    return area4 > 0 ? sqrt(x2 * y2) * sqrt(z2) / area4 : sqrt(z2) / 2;
  }
  const double z = sqrt(z2);
  const double near_x = x2 > 0 ? x2 * z / (x2 + (z2 - y2)) : 0, near_y = y2 > 0 ? y2 * z / (y2 + (z2 - x2)) : 0;
  return fmax(near_x, near_y);
}

/* Room for the rounding of covers. */
#define COVER_SLACK (1 + 1e-9)

/* By the samples of add_face_samples(). */
static double face_cover(const laves__vec3 p[3]) {
  const laves__vec3 centroid = v3_scale(v3_add(p[0], v3_add(p[1], p[2])), 1.0 / 3);
  double cover = 0;
  for (int i = 0; i < 3; i++) cover = fmax(cover, laves__corner_cover(centroid, p[i], p[(i + 1) % 3]));
  return cover / 2 * COVER_SLACK;
}

/* Each vertex once (where `seen` does not have it yet), each edge where it ascends, and the inner points. */
static void add_face_samples(const laves_mesh *mesh, const int32_t face[3], uint8_t *seen, laves__samples *samples) {
  laves__sample *next = samples->items + samples->count;
  laves__vec3 p[3];
  for (int i = 0; i < 3; i++) p[i] = mesh->points[face[i]];
  if (!v3_finite(p[0]) || !v3_finite(p[1]) || !v3_finite(p[2])) return;
  const double edge = laves__local_edge(samples->edges, face);
  for (int i = 0; i < 3; i++) {
    if (!seen[face[i]]) *next++ = (laves__sample){p[i], NAN, 0, face[i], 0, samples->edges[face[i]]};
    seen[face[i]] = 1;
    if (face[i] < face[(i + 1) % 3]) *next++ = sample_at(v3_lerp(p[i], p[(i + 1) % 3], 0.5), 0, edge);
  }
  const double weight = v3_norm(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0]))) / (2 * INNER);
  const laves__vec3 centroid = v3_scale(v3_add(p[0], v3_add(p[1], p[2])), 1.0 / 3);
  *next++ = sample_at(centroid, weight, edge);
  for (int i = 0; i < 3; i++) *next++ = sample_at(v3_lerp(centroid, p[i], 0.5), weight, edge);
  samples->count = (size_t)(next - samples->items);
  samples->boundary_cover = fmax(samples->boundary_cover, face_cover(p));
}

static laves_result list_boundary_samples(laves_context *context, measuring *m, laves_error *error) {
  const size_t most = SAMPLES_PER_FACE * m->boundary->count;
  uint8_t *seen = laves__alloc_zeroed(context, m->mesh->vertex_count, 1);
  if (!seen || !laves__grow(context, &m->samples->items, &m->samples->capacity, most, sizeof *m->samples->items)) {
    laves__free(context, seen, m->mesh->vertex_count, 1);
    return laves__fail_memory(context, error);
  }
  const size_t faces = m->boundary->count;
  for (size_t i = 0; i < faces && !laves__cancelled_at(context, "distance", i, faces); i++)
    add_face_samples(m->mesh, m->boundary->faces[i], seen, m->samples);
  m->samples->boundary_count = m->samples->count;
  laves__free(context, seen, m->mesh->vertex_count, 1);
  return laves__is_cancelled(context) ? laves__fail_cancelled(error) : LAVES_OK;
}

/* Whether both signs occur among the points a step from the foot: against and along the normal, else all around. */
static bool has_both_signs(const measuring *m, laves__vec3 foot, laves__vec3 normal, double step) {
  enum { AROUND = 14 };
  laves__vec3 points[AROUND] = {v3_mad(foot, normal, -step), v3_mad(foot, normal, step)};
  double phi[AROUND];
  m->oracle->evaluate(m->oracle->self, 2, points, phi, NULL);
  if ((phi[0] < 0) != (phi[1] < 0)) return true;
  const double diagonal = step / sqrt(3);
  for (int i = 0; i < 6; i++) points[i] = v3_mad(foot, v3(i / 2 == 0, i / 2 == 1, i / 2 == 2), i % 2 ? step : -step);
  for (int i = 0; i < 8; i++) points[6 + i] = v3_mad(foot, v3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1), diagonal);
  m->oracle->evaluate(m->oracle->self, AROUND, points, phi, NULL);
  int inside = 0;
  for (int i = 0; i < AROUND; i++) inside += phi[i] < 0;
  return inside > 0 && inside < AROUND;
}

/* The mean edge near a sample, as a power of two of that of the boundary. */
static double edge_at(const measuring *m, const laves__sample *sample) {
  return ldexp(m->samples->spacing, laves__edge_level((double)sample->edge, m->samples->spacing));
}

/* How far from a foot the solid's boundary passes at most; NAN when that is not seen within a hundredth of an edge. */
static double foot_slack(const measuring *m, laves__vec3 foot, laves__vec3 normal, double edge) {
  if (m->oracle->flat_face) return 0;
  for (double step = FOOT_STEP * edge; step <= FOOT_STEP_MAX * edge; step *= 10)
    if (has_both_signs(m, foot, normal, step)) return step * COVER_SLACK;
  return NAN;
}

/* Without a foot a point may itself stand on the surface, where a gradient may vanish; else the value of a true distance serves.
 */
static double distance_without_foot(const measuring *m, laves__vec3 local, double edge, double *slack) {
  double phi;
  *slack = m->oracle->flat_face ? NAN : foot_slack(m, local, v3(0, 0, 1), edge);
  if (!isnan(*slack)) return 0;
  if (!m->oracle->is_distance) return NAN;
  m->oracle->evaluate(m->oracle->self, 1, &local, &phi, NULL);
  *slack = DISTANCE_SLACK * fabs(phi);
  return fabs(phi);
}

/* `first` is what was found within the first reach. */
static double distance_to_surface(const measuring *m, laves__vec3 local, const laves__projection *first, double edge,
                                  double *slack) {
  laves__projection answer = *first;
  for (double reach = m->reach; !answer.found; reach *= REACH_GROWTH) {
    if (reach >= m->reach_max) return distance_without_foot(m, local, edge, slack);
    answer.hint = LAVES__NO_HINT;
    const double next = fmin(reach * REACH_GROWTH, m->reach_max);
    answer.found = m->oracle->project(m->oracle->self, local, next, &answer.hint, &answer.foot, &answer.normal);
  }
  *slack = foot_slack(m, answer.foot, answer.normal, edge);
  return v3_distance(local, answer.foot);
}

/* Within the first reach: all at once where the domain can, else each from the foot of the one before. */
static void find_first(const measuring *m, size_t count, const laves__vec3 *local, laves__projection *first) {
  const laves__oracle *oracle = m->oracle;
  const double reach = fmin(m->reach, m->reach_max);
  uint32_t hint = LAVES__NO_HINT;
  if (oracle->project_many) {
    oracle->project_many(oracle->self, count, local, reach, first);
    return;
  }
  for (size_t i = 0; i < count; i++) {
    first[i].hint = hint;
    first[i].found = oracle->project(oracle->self, local[i], reach, &first[i].hint, &first[i].foot, &first[i].normal);
    hint = first[i].found ? first[i].hint : LAVES__NO_HINT;
  }
}

/* Samples are measured in chunks of a fixed size, within which each one starts from what the one before it found: that
 * is fast, as neighbours in the list are neighbours in space, and does not depend on the threads. */
static void project_chunks(void *user, size_t begin, size_t end, int worker) {
  const measuring *m = user;
  (void)worker;
  for (size_t chunk = begin; chunk < end; chunk++) {
    laves__sample *samples = &m->samples->items[chunk * CHUNK];
    const size_t left = m->samples->boundary_count - chunk * CHUNK, count = left < CHUNK ? left : CHUNK;
    laves__vec3 local[CHUNK];
    laves__projection first[CHUNK];
    for (size_t i = 0; i < count; i++) local[i] = v3_sub(samples[i].point, m->oracle->origin);
    find_first(m, count, local, first);
    for (size_t i = 0; i < count; i++)
      samples[i].distance = distance_to_surface(m, local[i], &first[i], edge_at(m, &samples[i]), &samples[i].slack);
  }
}

/* ---- samples on the surface ---- */

/* Whether all is to end: asked now and then, and only by the calling thread; the others hear of it. */
static bool stopped(const measuring *m, size_t i, size_t count, int worker) {
  laves_context *context = m->samples->context;
  if (i % SEARCHES_BETWEEN_ASKING != 0) return false;
  return worker == 0 ? laves__cancelled(context, "distance", (double)i / (double)count) : laves__is_cancelled(context);
}

/* The nearest triangle of the sample before is no further from this one than its distance and the way between them. */
static void nearest_chunks(void *user, size_t begin, size_t end, int worker) {
  const measuring *m = user;
  laves__sample *samples = m->samples->items + m->samples->boundary_count;
  const size_t count = m->samples->count - m->samples->boundary_count;
  for (size_t chunk = begin; chunk < end; chunk++) {
    size_t near = LAVES__NO_TRIANGLE;
    for (size_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < count && !stopped(m, i, count, worker); i++) {
      const laves__vec3 local = v3_sub(samples[i].point, m->oracle->origin);
      double bound = INFINITY;
      if (i > chunk * CHUNK) {
        bound = samples[i - 1].distance + v3_distance(samples[i - 1].point, samples[i].point);
        samples[i].edge = samples[i - 1].edge;
      }
      samples[i].distance = laves__boundary_tree_distance(m->tree, local, bound, &samples[i].edge, &near);
    }
  }
}

/* The area of the boundary, and what it would be if it were stretched until all local edges were as long as the mean. */
static double boundary_area(const laves__samples *samples, double *stretched) {
  double area = 0;
  *stretched = 0;
  for (size_t i = 0;
       i < samples->boundary_count && !laves__cancelled_at(samples->context, "distance", i, samples->boundary_count); i++) {
    const laves__sample *s = &samples->items[i];
    area += s->weight;
    *stretched += ldexp(s->weight, -2 * laves__edge_level((double)s->edge, samples->spacing));
  }
  return area;
}

/* A list of samples in the making: without items only counted. */
typedef struct flat_samples {
  laves__sample *items;
  size_t count, most;
  double reach, cover; /* reach: where edges are as long as the mean */
  laves__vec3 origin;
  const laves__boundary_tree *tree;
  int least, greatest; /* levels of edges */
} flat_samples;

/* Whether a piece is too wide for the edges near by. */
static bool is_wide(const flat_samples *list, laves__vec3 centroid, double radius) {
  if (radius > ldexp(list->reach, list->greatest)) return true;
  if (radius <= ldexp(list->reach, list->least)) return false;
  return radius > ldexp(list->reach, laves__boundary_tree_level(list->tree, centroid, radius));
}

/* Halves a triangle until its centroid is near to all of it. */
static void sample_piece(flat_samples *list, laves__vec3 a, laves__vec3 b, laves__vec3 c) {
  const laves__vec3 centroid = v3_scale(v3_add(a, v3_add(b, c)), 1.0 / 3);
  const double radius = fmax(v3_distance(centroid, a), fmax(v3_distance(centroid, b), v3_distance(centroid, c)));
  if (list->count < list->most && is_wide(list, centroid, radius)) {
    const double x = v3_norm2(v3_sub(c, b)), y = v3_norm2(v3_sub(a, c)), z = v3_norm2(v3_sub(b, a));
    const laves__vec3 p = z >= x && z >= y ? c : x >= y ? a : b; /* opposite the longest edge, then the others in turn */
    const laves__vec3 q = z >= x && z >= y ? a : x >= y ? b : c, r = z >= x && z >= y ? b : x >= y ? c : a;
    const laves__vec3 middle = v3_lerp(q, r, 0.5);
    sample_piece(list, p, q, middle);
    sample_piece(list, p, middle, r);
    return;
  }
  if (list->items) {
    const double area = v3_norm(v3_cross(v3_sub(b, a), v3_sub(c, a))) / 2;
    list->items[list->count] = sample_at(v3_add(centroid, list->origin), area, 0);
    list->cover = fmax(list->cover, radius * COVER_SLACK);
  }
  list->count++;
}

static void sample_flat_faces(flat_samples *list, const laves__oracle *oracle) {
  list->count = 0;
  for (size_t f = 0; f < oracle->flat_face_count && list->count <= list->most; f++) {
    laves__vec3 p[3];
    oracle->flat_face(oracle->self, f, p);
    sample_piece(list, p[0], p[1], p[2]);
  }
}

/* Counts, with wider samples when there are too many, then fills. */
static laves_result list_flat_samples(laves_context *context, const measuring *m, double spacing, laves_error *error) {
  laves__samples *samples = m->samples;
  flat_samples list = {.most = (size_t)SURFACE_SAMPLES_MAX, .reach = spacing, .origin = m->oracle->origin, .tree = m->tree};
  laves__boundary_tree_levels(m->tree, &list.least, &list.greatest);
  for (sample_flat_faces(&list, m->oracle); list.count > list.most; sample_flat_faces(&list, m->oracle)) list.reach *= 1.5;
  if (!laves__grow(context, &samples->items, &samples->capacity, samples->count + list.count, sizeof *samples->items))
    return laves__fail_memory(context, error);
  list.items = samples->items + samples->count;
  list.most = list.count;
  sample_flat_faces(&list, m->oracle);
  samples->count += list.count;
  samples->surface_cover = list.cover;
  return LAVES_OK;
}

/* Asks the domain for samples of its faces and appends them. */
static laves_result list_face_samples(laves_context *context, const measuring *m, double spacing, size_t room,
                                      laves_error *error) {
  const laves__oracle *oracle = m->oracle;
  laves__samples *samples = m->samples;
  laves__vec3 *points = laves__alloc(context, room, sizeof *points);
  if (!points) return laves__fail_memory(context, error);
  size_t count = oracle->sample(oracle->self, spacing, points, room);
  if (count > room) count = room;
  laves_result result = LAVES_OK;
  if (laves__is_cancelled(context)) {
    result = laves__fail_cancelled(error);
  } else if (laves__grow(context, &samples->items, &samples->capacity, samples->count + count, sizeof *samples->items)) {
    for (size_t i = 0; i < count && !laves__cancelled_at(context, "distance", i, count); i++)
      samples->items[samples->count++] = sample_at(v3_add(points[i], oracle->origin), 1, 0);
  } else {
    result = laves__fail_memory(context, error);
  }
  laves__free(context, points, room, sizeof *points);
  return result;
}

/* The same for surfaces that have no faces. */
static laves_result list_found_samples(laves_context *context, const measuring *m, double spacing, size_t room,
                                       laves_error *error) {
  const laves__oracle *oracle = m->oracle;
  laves__samples *samples = m->samples;
  laves__domain_sample *found = laves__alloc(context, room, sizeof *found);
  if (!found) return laves__fail_memory(context, error);
  size_t count = 0;
  for (double wider = spacing; count == 0 && wider < m->reach_max && !laves__is_cancelled(context); wider *= 2)
    count = laves__sample_surface(context, oracle, m->tree, wider, found, room);
  laves_result result = LAVES_OK;
  if (laves__is_cancelled(context)) {
    result = laves__fail_cancelled(error);
  } else if (laves__grow(context, &samples->items, &samples->capacity, samples->count + count, sizeof *samples->items)) {
    for (size_t i = 0; i < count && !laves__cancelled_at(context, "distance", i, count); i++)
      samples->items[samples->count++] = sample_at(v3_add(found[i].point, oracle->origin), found[i].weight, 0);
  } else {
    result = laves__fail_memory(context, error);
  }
  laves__free(context, found, room, sizeof *found);
  return result;
}

/* Domains that sample their faces themselves do so evenly, as closely as makes as many samples. */
static laves_result list_surface_samples(laves_context *context, measuring *m, laves_error *error) {
  const laves__oracle *oracle = m->oracle;
  double spacing = SURFACE_SPACING * m->samples->spacing, stretched;
  const double boundary = boundary_area(m->samples, &stretched);
  const double stretch = boundary > 0 && isfinite(stretched / boundary) ? stretched / boundary : 1;
  const double area = stretch * (oracle->area > 0 ? oracle->area : 2 * boundary);
  if (laves__is_cancelled(context)) return laves__fail_cancelled(error);
  if (!(spacing > 0) || !isfinite(area)) return LAVES_OK;
  if (area / (spacing * spacing) > SURFACE_SAMPLES_MAX) spacing = sqrt(area / SURFACE_SAMPLES_MAX);
  if (oracle->flat_face && (double)oracle->flat_face_count < SURFACE_SAMPLES_MAX / 2)
    return list_flat_samples(context, m, spacing, error);
  const size_t room = (size_t)(4 * area / (spacing * spacing)) + 4096;
  if (m->is_surface && oracle->sample) return list_face_samples(context, m, spacing / sqrt(fmax(1, stretch)), room, error);
  return list_found_samples(context, m, spacing, room, error);
}

/* ---- both ---- */

/* The largest of the true distances of samples [begin, end), as far as it can be; NAN when one is not known. */
static double largest_of(const laves__samples *samples, size_t begin, size_t end) {
  double largest = 0;
  for (size_t i = begin; i < end && !laves__cancelled_at(samples->context, "distance", i, end); i++) {
    const double distance = samples->items[i].distance + samples->items[i].slack;
    if (isnan(distance)) return NAN;
    largest = fmax(largest, distance);
  }
  return end > begin ? largest : NAN;
}

static size_t chunks(size_t count) { return (count + CHUNK - 1) / CHUNK; }

laves_result laves__measure_distances(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                      const laves_domain *domain, laves__samples *samples, laves_error *error) {
  laves__box3 box;
  measuring m = {.mesh = mesh,
                 .boundary = boundary,
                 .oracle = &domain->oracle,
                 .samples = samples,
                 .is_surface = domain->info.kind == LAVES_DOMAIN_SURFACE};
  *samples = (laves__samples){.context = context, .spacing = mean_edge(mesh, boundary, &box), .surface_cover = NAN};
  const laves__box3 bounds = domain->oracle.bounds;
  m.reach = FIRST_REACH * samples->spacing;
  box = box3_add(box3_add(box, v3_add(bounds.lower, m.oracle->origin)), v3_add(bounds.upper, m.oracle->origin));
  m.reach_max = box3_diagonal(box);

  samples->vertex_count = mesh->vertex_count;
  samples->edges = laves__local_edges(context, mesh, boundary);
  laves_result result = samples->edges ? list_boundary_samples(context, &m, error) : laves__fail_memory(context, error);
  if (result != LAVES_OK) goto clean_up;
  if (!laves__parallel_for(context, "distance", chunks(samples->boundary_count), 1, project_chunks, &m)) {
    result = laves__fail_cancelled(error);
    goto clean_up;
  }
  result =
      laves__boundary_tree_build(context, mesh, boundary, m.oracle->origin, samples->edges, samples->spacing, &m.tree, error);
  if (result != LAVES_OK) goto clean_up;
  result = list_surface_samples(context, &m, error);
  if (result != LAVES_OK) goto clean_up;
  laves__parallel_for(context, "distance", chunks(samples->count - samples->boundary_count), 1, nearest_chunks, &m);
  samples->boundary_at_most = largest_of(samples, 0, samples->boundary_count) + samples->boundary_cover;
  samples->surface_at_most = largest_of(samples, samples->boundary_count, samples->count) + samples->surface_cover;
  if (laves__is_cancelled(context)) result = laves__fail_cancelled(error);
clean_up:
  laves__boundary_tree_free(m.tree);
  if (result != LAVES_OK) laves__samples_free(samples);
  return result;
}

/* Largest and mean distance of samples [begin, end); NAN when there is none to measure. */
static void summarise(const laves__samples *samples, size_t begin, size_t end, double *max, double *mean, double place[3]) {
  double sum = 0, weights = 0;
  *max = NAN;
  for (size_t i = begin; i < end && !laves__cancelled_at(samples->context, "distance", i, end); i++) {
    const laves__sample *s = &samples->items[i];
    if (!isfinite(s->distance)) continue;
    sum += s->weight * s->distance;
    weights += s->weight;
    if (s->distance <= *max) continue;
    *max = s->distance;
    memcpy(place, &s->point, sizeof s->point);
  }
  *mean = weights > 0 ? sum / weights : NAN;
}

laves_result laves__check_distances(laves_context *context, const laves_mesh *mesh, const laves__boundary *boundary,
                                    const laves_domain *domain, laves_check *check, laves__samples *samples, laves_error *error) {
  const laves_result result = laves__measure_distances(context, mesh, boundary, domain, samples, error);
  if (result != LAVES_OK) return result;
  summarise(samples, 0, samples->boundary_count, &check->to_surface_max, &check->to_surface_mean, check->to_surface_place);
  summarise(samples, samples->boundary_count, samples->count, &check->from_surface_max, &check->from_surface_mean,
            check->from_surface_place);
  if (laves__is_cancelled(context)) {
    laves__samples_free(samples);
    return laves__fail_cancelled(error);
  }
  check->to_surface_cover = samples->boundary_cover;
  check->from_surface_cover = samples->surface_cover;
  check->to_surface_at_most = samples->boundary_at_most;
  check->from_surface_at_most = samples->surface_at_most;
  check->has_distance = true;
  check->domain_volume = domain->oracle.volume;
  return LAVES_OK;
}
