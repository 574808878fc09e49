/* From the domain to the mesh: how far creases are from the boundary's edges, and corners from its vertices.
 *
 * Creases are sampled at the points of their polylines and evenly between them; a sample stands for half the way to either
 * neighbour. Each sample is written by one thread; sums are taken in the order of the samples. */
#include <string.h>

#include "certify/check_features.h"

/* Samples an edge of the mesh, and how many at most beyond one for each segment; more lie further apart. */
enum { SAMPLES_PER_EDGE = 8, SAMPLES_MAX = 1 << 20 };

/* Of the diagonal: a vertex that near to a corner is at its place, rounding of coordinates apart; an edge that near misses it by
 * less than can be seen. */
static const double exact_share = 1e-9, near_share = 1e-4;

typedef struct sample {
  laves__vec3 point;
  double weight, distance;
  uint32_t crease;
  float edge; /* local */
  bool kept;
} sample;

typedef struct sampling {
  laves__feature_findings *f;
  sample *samples;
  size_t count;
  float *local; /* laves__local_edges() */
} sampling;

static size_t steps_of(laves__vec3 a, laves__vec3 b, double spacing) {
  const double steps = ceil(v3_distance(a, b) / spacing);
  return steps >= 1 ? (size_t)steps : 1;
}

/* Walks along all creases; writes the samples unless there is no array yet. Returns how many there are. */
static size_t walk(const laves__features *features, double spacing, sample *samples) {
  size_t count = 0;
  for (size_t i = 0; i < features->crease_count; i++) {
    const laves__crease *crease = &features->crease[i];
    for (uint32_t k = crease->first; k + 1 < crease->first + crease->count; k++) {
      const laves__vec3 a = features->line[k], b = features->line[k + 1];
      const size_t steps = steps_of(a, b, spacing);
      const double weight = v3_distance(a, b) / (double)steps;
      for (size_t n = 0; n <= steps; n++, count++)
        if (samples)
          samples[count] = (sample){.point = v3_lerp(a, b, (double)n / (double)steps),
                                    .weight = n == 0 || n == steps ? weight / 2 : weight,
                                    .crease = (uint32_t)i};
    }
  }
  return count;
}

static double spacing_of(const laves__feature_findings *f) {
  double length = 0;
  for (size_t i = 0; i < f->features->crease_count; i++) length += f->features->crease[i].length;
  return fmax(f->edges.mean / SAMPLES_PER_EDGE, length / SAMPLES_MAX);
}

static void measure_block(void *user, size_t begin, size_t end, int worker) {
  sampling *all = user;
  const laves__feature_findings *f = all->f;
  const laves__features *features = f->features;
  (void)worker;
  for (size_t i = begin; i < end; i++) {
    sample *s = &all->samples[i];
    laves__vec3 tangent = {0, 0, 1}; /* any: only the point is wanted */
    double along;
    if (features->refine) features->refine(features->self, (int32_t)s->crease, &s->point, &tangent);
    s->distance = INFINITY;
    const uint32_t edge = laves__boundary_edges_nearest(&f->edges, s->point, INFINITY, NULL, &s->distance);
    if (edge == LAVES__NONE) continue;
    s->edge = 0.5f * (all->local[f->edges.ends[edge][0]] + all->local[f->edges.ends[edge][1]]);
    if (s->distance > f->check->tolerance) continue;
    s->kept = f->runs_along[edge] ||
              laves__boundary_edges_nearest(&f->edges, s->point, f->check->tolerance, f->runs_along, &along) != LAVES__NONE;
  }
}

/* The samples [first, end) of one crease. */
static void sum_crease(const sampling *all, size_t first, size_t end, laves__crease_finding *found) {
  double weight = 0, edge = 0;
  *found = (laves__crease_finding){.distance = -1, .is_kept = true, .least_dihedral = INFINITY, .tet = -1};
  for (size_t i = first; i < end; i++) {
    const sample *s = &all->samples[i];
    weight += s->weight;
    edge += s->weight * (double)s->edge;
    found->sum += s->weight * s->distance;
    if (s->kept) found->kept += s->weight;
    found->is_kept = found->is_kept && s->kept;
    if (!(s->distance > found->distance)) continue;
    found->distance = s->distance;
    found->place = s->point;
  }
  found->sampled = weight;
  found->local_edge = weight > 0 ? edge / weight : 0;
  const laves__crease *crease = &all->f->features->crease[all->samples[first].crease];
  found->is_short = !crease->drawn && crease->length < found->local_edge;
}

static bool report_lost(laves__feature_findings *f, size_t crease) {
  const laves__crease_finding *found = &f->crease[crease];
  if (found->is_short || found->is_kept) return true;
  laves_feature_place *place = laves__feature_place_add(f, LAVES_FEATURE_FAULT_CREASE, found->place);
  if (!place) return false;
  place->distance = found->distance;
  place->length = f->features->crease[crease].length;
  place->angle = f->features->crease[crease].least_angle;
  return true;
}

/* Adds one that is not short to the sums; *total gathers lengths and distances. */
static void add_crease(laves_feature_check *c, const laves__crease_finding *found, laves__crease_finding *total) {
  total->sampled += found->sampled;
  total->kept += found->kept;
  total->sum += found->sum;
  c->creases_kept += found->is_kept;
  if (!(found->distance > total->distance)) return;
  total->distance = found->distance;
  total->place = found->place;
}

/* All creases, in their order. */
static bool sum_up(const sampling *all) {
  laves__feature_findings *f = all->f;
  laves_feature_check *c = f->check;
  laves__crease_finding total = {0};
  size_t first = 0, end = 0;
  c->creases = f->features->crease_count;
  for (size_t i = 0; i < c->creases; i++, first = end) {
    const double length = f->features->crease[i].length;
    while (end < all->count && all->samples[end].crease == i) end++;
    sum_crease(all, first, end, &f->crease[i]);
    c->length += length;
    if (f->crease[i].is_short) {
      c->short_creases++;
      c->short_length += length;
      continue;
    }
    add_crease(c, &f->crease[i], &total);
    if (!report_lost(f, i)) return false;
  }
  c->to_mesh_max = total.distance;
  c->to_mesh_mean = total.sampled > 0 ? total.sum / total.sampled : 0;
  c->kept_share = total.sampled > 0 ? total.kept / total.sampled : 1;
  const laves__vec3 worst = v3_add(total.place, f->oracle->origin);
  memcpy(c->to_mesh_place, &worst, sizeof c->to_mesh_place);
  return true;
}

laves_result laves__check_creases(laves__feature_findings *f, laves_error *error) {
  laves_context *context = f->context;
  sampling all = {.f = f};
  if (f->features->crease_count == 0) return LAVES_OK;
  const double spacing = spacing_of(f);
  if (!(spacing > 0)) return laves__fail(error, LAVES_ERROR_INPUT, "the boundary of the mesh has no edge of finite length");
  laves_result result = LAVES_OK;
  all.count = walk(f->features, spacing, NULL);
  all.samples = laves__alloc(context, all.count, sizeof *all.samples);
  all.local = laves__local_edges(context, f->mesh, f->boundary);
  if (!all.samples || !all.local) {
    result = laves__fail_memory(context, error);
    goto clean_up;
  }
  walk(f->features, spacing, all.samples);
  if (!laves__parallel_for(context, "check", all.count, 256, measure_block, &all))
    result = laves__fail_cancelled(error);
  else if (!sum_up(&all))
    result = laves__fail_memory(context, error);
clean_up:
  laves__free(context, all.samples, all.count, sizeof *all.samples);
  laves__free(context, all.local, f->mesh->vertex_count, sizeof *all.local);
  return result;
}

/* ---- corners ---- */

/* The vertex of an edge that is the nearer one to a point. */
static int32_t nearer_end(const laves__boundary_edges *e, uint32_t edge, laves__vec3 p, double *distance) {
  const int32_t a = e->ends[edge][0], b = e->ends[edge][1];
  const double to_a = v3_distance(e->point[a], p), to_b = v3_distance(e->point[b], p);
  *distance = fmin(to_a, to_b);
  return to_a <= to_b ? a : b;
}

/* Whether only short creases end at a corner. Tips and what the user drew count in any case. */
static bool is_short_corner(const laves__feature_findings *f, const laves__corner *corner) {
  if (corner->fixed || corner->crease_count == 0) return false;
  for (uint32_t k = 0; k < corner->crease_count; k++)
    if (!f->crease[f->features->corner_crease[corner->first_crease + k]].is_short) return false;
  return true;
}

laves_result laves__check_corners(laves__feature_findings *f, laves_error *error) {
  laves_feature_check *c = f->check;
  c->corners = f->features->corner_count;
  for (size_t i = 0; i < f->features->corner_count; i++) {
    const laves__vec3 p = f->features->corner[i].position;
    double distance = INFINITY, to_end = INFINITY;
    const uint32_t edge = laves__boundary_edges_nearest(&f->edges, p, INFINITY, NULL, &distance);
    const int32_t vertex = edge == LAVES__NONE ? -1 : nearer_end(&f->edges, edge, p, &to_end);
    if (vertex >= 0 && to_end <= c->tolerance) f->touch[vertex] |= LAVES__TOUCHES;
    if (is_short_corner(f, &f->features->corner[i])) {
      c->short_corners++;
      continue;
    }
    if (to_end <= exact_share * c->diagonal) {
      c->corners_kept++;
      continue;
    }
    c->corners_near += distance <= near_share * c->diagonal;
    laves_feature_place *place = laves__feature_place_add(f, LAVES_FEATURE_FAULT_CORNER, p);
    if (!place) return laves__fail_memory(f->context, error);
    place->distance = distance;
  }
  return LAVES_OK;
}
