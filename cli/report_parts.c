/* What of a mesh a report embeds: all of it, or the boundary, the worst tetrahedra, and sections.
 *
 * A large mesh is mostly inside and out of sight. Of it the page gets the tetrahedra at the boundary, the worst of each
 * measure, and, at places along each axis, the faces that lie open there; so many places as SECTION_FACES allow. */
#include "report_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "interrupt.h"

enum {
  WORST_MOST = 20000,
  WORST_LEAST = 100,
  WORST_SHARE = 50 /* one in so many, within those */,
  SECTION_FACES = 500000 /* for each axis, as the middle section has them */,
  CUTS_LEAST = 5,
  BATCH = 1024
};

static float centroid_along(const laves_mesh *mesh, const report_parts *parts, size_t tet, int axis) {
  double p[4][3];
  if (!report_tet_corners(mesh, tet, p)) return NAN;
  return (float)((p[0][axis] + p[1][axis] + p[2][axis] + p[3][axis]) / 4 - parts->origin[axis]);
}

static void find_box(const laves_mesh *mesh, report_parts *parts) {
  const double *points = laves_mesh_points(mesh);
  for (int k = 0; k < 3; ++k) {
    parts->lower[k] = INFINITY;
    parts->upper[k] = -INFINITY;
  }
  for (size_t i = 0; i < 3 * laves_mesh_vertex_count(mesh); ++i) {
    parts->lower[i % 3] = fmin(parts->lower[i % 3], points[i]);
    parts->upper[i % 3] = fmax(parts->upper[i % 3], points[i]);
  }
  for (int k = 0; k < 3; ++k) parts->origin[k] = (parts->lower[k] + parts->upper[k]) / 2;
}

/* ---- distance ---- */

static void face_centroid(const laves_mesh *mesh, size_t face, double out[3]) {
  const int32_t *corners = laves_mesh_faces(mesh) + 3 * face;
  const double *points = laves_mesh_points(mesh);
  for (int k = 0; k < 3; ++k) out[k] = (points[3 * corners[0] + k] + points[3 * corners[1] + k] + points[3 * corners[2] + k]) / 3;
}

/* What an implicit solid yields is no distance; near its surface, its value over its slope is nearly one. */
static void divide_by_slopes(const laves_domain *domain, const double *points, size_t count, double step, double *values) {
  double shifted[3 * BATCH], low[BATCH], high[BATCH], squares[BATCH] = {0};
  for (int k = 0; k < 3; ++k) {
    memcpy(shifted, points, 3 * count * sizeof *shifted);
    for (size_t i = 0; i < count; ++i) shifted[3 * i + (size_t)k] -= step;
    laves_domain_evaluate(domain, shifted, count, low);
    for (size_t i = 0; i < count; ++i) shifted[3 * i + (size_t)k] = points[3 * i + (size_t)k] + step;
    laves_domain_evaluate(domain, shifted, count, high);
    for (size_t i = 0; i < count; ++i) squares[i] += (high[i] - low[i]) * (high[i] - low[i]) / (4 * step * step);
  }
  for (size_t i = 0; i < count; ++i) values[i] = squares[i] > 0 ? values[i] / sqrt(squares[i]) : NAN;
}

static laves_result measure_distances(session *run, const report_subject *subject, report_parts *parts) {
  const laves_mesh *mesh = subject->mesh;
  const size_t count = laves_mesh_face_count(mesh);
  double points[3 * BATCH], values[BATCH];
  parts->distance_rough = subject->surface->info.kind != LAVES_DOMAIN_SURFACE;
  parts->distances = malloc((count + 1) * sizeof *parts->distances);
  if (!parts->distances) return session_fail(run, LAVES_ERROR_MEMORY, "no memory for the distances of a report");
  for (size_t first = 0; first < count && !interrupt_asked(); first += BATCH) {
    const size_t here = count - first < BATCH ? count - first : BATCH;
    for (size_t i = 0; i < here; ++i) face_centroid(mesh, first + i, points + 3 * i);
    laves_domain_evaluate(subject->surface->domain, points, here, values);
    if (parts->distance_rough)
      divide_by_slopes(subject->surface->domain, points, here, 1e-3 * subject->certificate->check.edge_min, values);
    for (size_t i = 0; i < here; ++i) {
      parts->distances[first + i] = (float)values[i];
      parts->distance_range[0] = fmin(parts->distance_range[0], values[i]);
      parts->distance_range[1] = fmax(parts->distance_range[1], values[i]);
    }
  }
  return session_settle(run, LAVES_OK);
}

/* ---- large meshes ---- */

static bool find_centroids(const laves_mesh *mesh, report_parts *parts) {
  const size_t count = laves_mesh_tet_count(mesh);
  for (int axis = 0; axis < 3; ++axis) {
    parts->centroids[axis] = malloc((count + 1) * sizeof(float));
    if (!parts->centroids[axis]) return false;
    for (size_t t = 0; t < count && !interrupt_asked(); ++t) parts->centroids[axis][t] = centroid_along(mesh, parts, t, axis);
  }
  return true;
}

/* Numbers what is chosen, in the order of the mesh. */
static bool number_tets(const laves_mesh *mesh, const uint8_t *chosen, report_parts *parts) {
  const size_t tet_count = laves_mesh_tet_count(mesh), vertex_count = laves_mesh_vertex_count(mesh);
  parts->tets = malloc((tet_count + 1) * sizeof *parts->tets);
  parts->places = malloc((tet_count + 1) * sizeof *parts->places);
  parts->vertices = calloc(vertex_count + 1, sizeof *parts->vertices);
  if (!parts->tets || !parts->places || !parts->vertices) return false;
  for (size_t t = 0; t < tet_count; ++t) {
    double p[4][3];
    parts->places[t] = UINT32_MAX;
    if (!chosen[t] || !report_tet_corners(mesh, t, p)) continue;
    parts->places[t] = (uint32_t)parts->tet_count;
    parts->tets[parts->tet_count++] = (uint32_t)t;
    for (int k = 0; k < 4; ++k) parts->vertices[laves_mesh_tets(mesh)[4 * t + (size_t)k]] = 1;
  }
  parts->vertex_count = 0;
  for (size_t v = 0; v < vertex_count; ++v)
    parts->vertices[v] = parts->vertices[v] ? (uint32_t)parts->vertex_count++ : UINT32_MAX;
  return true;
}

static size_t worst_of(size_t tet_count) {
  const size_t share = tet_count / WORST_SHARE;
  return share > WORST_MOST ? WORST_MOST : share < WORST_LEAST ? WORST_LEAST : share;
}

static bool choose_tets(const laves_mesh *mesh, const report_shapes *shapes, report_parts *parts) {
  uint8_t *chosen = calloc(laves_mesh_tet_count(mesh) + 1, 1);
  parts->worst = worst_of(shapes->count);
  bool done = chosen && report_shapes_worst(shapes, parts->worst, chosen);
  for (size_t i = 0; done && i < laves_mesh_face_count(mesh); ++i)
    if (parts->owners[i] != UINT32_MAX) chosen[parts->owners[i] / 4] = 1;
  done = done && number_tets(mesh, chosen, parts);
  free(chosen);
  return done;
}

static float reach_of(double longest_edge) {
  return (float)(0.51 * longest_edge); /* two apices differ by two edges, centroids by a quarter */
}

static bool place_cuts(const laves_mesh *mesh, double longest_edge, report_parts *parts) {
  uint8_t *marks = calloc(laves_mesh_vertex_count(mesh) + 1, 1);
  bool done = marks != NULL;
  for (int axis = 0; done && axis < 3; ++axis) {
    report_section middle;
    report_cuts *cuts = &parts->cuts[axis];
    const double width = parts->upper[axis] - parts->lower[axis];
    done = report_section_make(mesh, parts->centroids[axis], 0, reach_of(longest_edge), marks, &middle);
    const size_t most = SECTION_FACES / (middle.count + 1);
    cuts->count = (int)(most > REPORT_CUTS_MOST ? REPORT_CUTS_MOST
                        : most < CUTS_LEAST     ? CUTS_LEAST
                                                : (most - 1) | 1); /* odd: one is in the middle */
    for (int k = 0; k < cuts->count; ++k)
      cuts->positions[k] = (float)(parts->lower[axis] - parts->origin[axis] + width * (k + 1) / (cuts->count + 1));
    free(middle.faces);
  }
  free(marks);
  return done;
}

laves_result report_parts_make(session *run, const report_subject *subject, const report_shapes *shapes, size_t whole_up_to,
                               report_parts *parts) {
  const laves_mesh *mesh = subject->mesh;
  const size_t face_count = laves_mesh_face_count(mesh);
  *parts = (report_parts){.whole = laves_mesh_tet_count(mesh) <= whole_up_to,
                          .tet_count = laves_mesh_tet_count(mesh),
                          .vertex_count = laves_mesh_vertex_count(mesh)};
  find_box(mesh, parts);
  parts->owners = malloc((face_count + 1) * sizeof *parts->owners);
  bool done = parts->owners && report_face_owners(mesh, parts->owners) &&
              report_groups_find(laves_mesh_regions(mesh), laves_mesh_tet_count(mesh), &parts->regions) &&
              report_groups_find(laves_mesh_face_tags(mesh), face_count, &parts->tags);
  for (size_t i = 0; done && i < face_count; ++i) parts->face_count += parts->owners[i] != UINT32_MAX;
  if (done && !parts->whole) {
    parts->tet_count = 0;
    done = find_centroids(mesh, parts) && choose_tets(mesh, shapes, parts) &&
           place_cuts(mesh, subject->certificate->check.edge_max, parts);
  }
  laves_result result = session_settle(run, LAVES_OK);
  if (result == LAVES_OK && !done) result = session_fail(run, LAVES_ERROR_MEMORY, "no memory for a report of this mesh");
  if (result == LAVES_OK && subject->surface) result = measure_distances(run, subject, parts);
  return result;
}

void report_parts_free(report_parts *parts) {
  free(parts->tets);
  free(parts->places);
  free(parts->vertices);
  for (int axis = 0; axis < 3; ++axis) free(parts->centroids[axis]);
  free(parts->owners);
  free(parts->distances);
  report_groups_free(&parts->regions);
  report_groups_free(&parts->tags);
  *parts = (report_parts){0};
}

/* ---- blocks ---- */

/* What blocks are written from, and room for the values of one: a call of page_reserve() and page_free() for each. */
typedef struct page {
  FILE *file;
  const laves_mesh *mesh;
  const report_shapes *shapes;
  const report_parts *parts;
  report_block block;
  float *floats;
  uint32_t *indices;
  uint16_t *shorts;
  uint8_t *bytes;
} page;

static bool page_reserve(page *out, size_t most) {
  out->floats = malloc((most + 1) * sizeof *out->floats);
  out->indices = malloc((most + 1) * sizeof *out->indices);
  out->shorts = malloc((most + 1) * sizeof *out->shorts);
  out->bytes = malloc(most + 1);
  return out->floats && out->indices && out->shorts && out->bytes;
}

static void page_free(page *out) {
  free(out->floats);
  free(out->indices);
  free(out->shorts);
  free(out->bytes);
  out->floats = NULL;
  out->indices = NULL;
  out->shorts = NULL;
  out->bytes = NULL;
  report_block_free(&out->block);
}

static size_t mesh_tet(const report_parts *parts, size_t tet) { return parts->whole ? tet : parts->tets[tet]; }

static bool write_points(page *out) {
  const report_parts *parts = out->parts;
  /* NOLINTNEXTLINE(clang-analyzer-unix.Malloc): page_free() frees what page_reserve() took. */
  for (int axis = 0; axis < 3; ++axis) {
    size_t at = 0;
    for (size_t v = 0; v < laves_mesh_vertex_count(out->mesh); ++v) {
      if (!parts->whole && parts->vertices[v] == UINT32_MAX) continue;
      out->floats[at++] = (float)(laves_mesh_points(out->mesh)[3 * v + (size_t)axis] - parts->origin[axis]);
    }
    report_block_floats(&out->block, out->floats, at);
  }
  return report_block_write(out->file, "points", &out->block);
}

static bool write_tets(page *out) {
  const report_parts *parts = out->parts;
  for (size_t k = 0; k < 4; ++k) {
    for (size_t t = 0; t < parts->tet_count; ++t) {
      const uint32_t v = (uint32_t)laves_mesh_tets(out->mesh)[4 * mesh_tet(parts, t) + k];
      out->indices[t] = parts->whole ? v : parts->vertices[v];
    }
    report_block_indices(&out->block, out->indices, parts->tet_count);
  }
  if (!report_block_write(out->file, "tets", &out->block)) return false;
  if (parts->whole) return true;
  report_block_indices(&out->block, parts->tets, parts->tet_count);
  return report_block_write(out->file, "tet_numbers", &out->block);
}

/* Class, and region where there are several. */
static bool write_labels(page *out) {
  const report_parts *parts = out->parts;
  for (size_t t = 0; t < parts->tet_count; ++t) out->bytes[t] = out->shapes->classes[mesh_tet(parts, t)];
  report_block_bytes(&out->block, out->bytes, parts->tet_count);
  if (!report_block_write(out->file, "classes", &out->block)) return false;
  if (parts->regions.count < 2) return true;
  for (size_t t = 0; t < parts->tet_count; ++t)
    out->shorts[t] = report_groups_index(&parts->regions, laves_mesh_regions(out->mesh)[mesh_tet(parts, t)]);
  report_block_shorts(&out->block, out->shorts, parts->tet_count);
  return report_block_write(out->file, "regions", &out->block);
}

/* How many cuts of each axis lie below each tetrahedron: it is kept by cut k when that is at most k. */
static bool write_bins(page *out) {
  const report_parts *parts = out->parts;
  if (parts->whole) return true;
  for (int axis = 0; axis < 3; ++axis) {
    const report_cuts *cuts = &parts->cuts[axis];
    for (size_t t = 0; t < parts->tet_count; ++t) {
      uint8_t below = 0;
      while (below < cuts->count && parts->centroids[axis][parts->tets[t]] > cuts->positions[below]) ++below;
      out->bytes[t] = below;
    }
    report_block_bytes(&out->block, out->bytes, parts->tet_count);
  }
  return report_block_write(out->file, "bins", &out->block);
}

/* Boundary faces as 4 * tet + corner, and what they have of their own. */
static bool write_faces(page *out) {
  const report_parts *parts = out->parts;
  const size_t count = laves_mesh_face_count(out->mesh);
  size_t at = 0;
  for (size_t i = 0; i < count; ++i) {
    const uint32_t owner = parts->owners[i];
    if (owner == UINT32_MAX) continue;
    out->indices[at++] = parts->whole ? owner : 4 * parts->places[owner / 4] + owner % 4;
  }
  report_block_indices(&out->block, out->indices, at);
  if (!report_block_write(out->file, "faces", &out->block)) return false;
  if (parts->tags.count > 1) {
    at = 0;
    for (size_t i = 0; i < count; ++i)
      if (parts->owners[i] != UINT32_MAX)
        out->shorts[at++] = report_groups_index(&parts->tags, laves_mesh_face_tags(out->mesh)[i]);
    report_block_shorts(&out->block, out->shorts, at);
    if (!report_block_write(out->file, "tags", &out->block)) return false;
  }
  if (!parts->distances) return true;
  at = 0;
  for (size_t i = 0; i < count; ++i)
    if (parts->owners[i] != UINT32_MAX) out->floats[at++] = parts->distances[i];
  report_block_floats(&out->block, out->floats, at);
  return report_block_write(out->file, "distances", &out->block);
}

static size_t larger(size_t a, size_t b) { return a > b ? a : b; }

bool report_parts_write(FILE *file, const laves_mesh *mesh, const report_shapes *shapes, const report_parts *parts) {
  page out = {.file = file, .mesh = mesh, .shapes = shapes, .parts = parts};
  const size_t most = larger(larger(parts->tet_count, laves_mesh_vertex_count(mesh)), laves_mesh_face_count(mesh));
  const bool done = page_reserve(&out, most) && write_points(&out) && write_tets(&out) && write_labels(&out) &&
                    write_bins(&out) && write_faces(&out) && !interrupt_asked();
  page_free(&out);
  return done;
}

/* ---- sections ---- */

static uint16_t short_of(double value, double low, double high) {
  const double place = (value - low) / (high - low) * UINT16_MAX + 0.5;
  return place > 0 ? (place < UINT16_MAX ? (uint16_t)place : UINT16_MAX) : 0;
}

/* Vertices in use, numbered in their order: places[vertex]; returns their number. */
static uint32_t number_vertices(const report_section *section, size_t vertex_count, uint32_t *places) {
  uint32_t count = 0;
  memset(places, 0, vertex_count * sizeof *places);
  for (size_t i = 0; i < section->count; ++i)
    for (int k = 0; k < 3; ++k) places[section->faces[i].corners[k]] = 1;
  for (size_t v = 0; v < vertex_count; ++v) places[v] = places[v] ? ++count : 0; /* from 1 */
  return count;
}

static void put_vertices(page *out, const uint32_t *places, uint32_t count) {
  for (int axis = 0; axis < 3; ++axis) {
    size_t at = 0;
    for (size_t v = 0; at < count; ++v) {
      if (places[v] == 0) continue;
      out->shorts[at++] =
          short_of(laves_mesh_points(out->mesh)[3 * v + (size_t)axis], out->parts->lower[axis], out->parts->upper[axis]);
    }
    report_block_shorts(&out->block, out->shorts, count);
  }
}

static size_t tet_of(const report_open_face *face, int side) { return side == 0 ? face->low : face->high; }

/* What is known of the tetrahedra on one side: number, angles, ratios, class, and region where there are several. */
static void put_side(page *out, const report_section *section, int side) {
  const report_shapes *shapes = out->shapes;
  const struct {
    const float *values;
    double low, high;
  } measures[] = {
      {shapes->min_dihedral, 0, 180}, {shapes->max_dihedral, 0, 180}, {shapes->radius_ratio, 0, 1}, {shapes->radius_edge, 1, 5}};
  for (size_t i = 0; i < section->count; ++i) out->indices[i] = (uint32_t)tet_of(&section->faces[i], side);
  report_block_indices(&out->block, out->indices, section->count);
  for (size_t m = 0; m < sizeof measures / sizeof *measures; ++m) {
    for (size_t i = 0; i < section->count; ++i)
      out->shorts[i] = short_of(measures[m].values[tet_of(&section->faces[i], side)], measures[m].low, measures[m].high);
    report_block_shorts(&out->block, out->shorts, section->count);
  }
  for (size_t i = 0; i < section->count; ++i) out->bytes[i] = shapes->classes[tet_of(&section->faces[i], side)];
  report_block_bytes(&out->block, out->bytes, section->count);
  if (out->parts->regions.count < 2) return;
  for (size_t i = 0; i < section->count; ++i)
    out->shorts[i] = report_groups_index(&out->parts->regions, laves_mesh_regions(out->mesh)[tet_of(&section->faces[i], side)]);
  report_block_shorts(&out->block, out->shorts, section->count);
}

static bool write_section(page *out, const report_section *section, uint32_t *places, int axis, int cut) {
  char id[40];
  const uint32_t vertices = number_vertices(section, laves_mesh_vertex_count(out->mesh), places);
  if (!page_reserve(out, larger(section->count, vertices))) return false;
  report_block_indices(&out->block, (const uint32_t[2]){(uint32_t)section->count, vertices}, 2);
  put_vertices(out, places, vertices);
  for (int k = 0; k < 3; ++k) {
    for (size_t i = 0; i < section->count; ++i) out->indices[i] = places[section->faces[i].corners[k]] - 1;
    report_block_indices(&out->block, out->indices, section->count);
  }
  for (int side = 0; side < 2; ++side) put_side(out, section, side);
  snprintf(id, sizeof id, "section-%d-%d", axis, cut);
  return report_block_write(out->file, id, &out->block);
}

bool report_sections_write(FILE *file, const laves_mesh *mesh, const report_shapes *shapes, const report_parts *parts,
                           double longest_edge) {
  page out = {.file = file, .mesh = mesh, .shapes = shapes, .parts = parts};
  uint8_t *marks = calloc(laves_mesh_vertex_count(mesh) + 1, 1);
  uint32_t *places = malloc((laves_mesh_vertex_count(mesh) + 1) * sizeof *places);
  bool done = marks && places;
  for (int axis = 0; axis < 3; ++axis) {
    for (int cut = 0; done && cut < parts->cuts[axis].count; ++cut) {
      report_section section;
      done = report_section_make(mesh, parts->centroids[axis], parts->cuts[axis].positions[cut], reach_of(longest_edge), marks,
                                 &section) &&
             write_section(&out, &section, places, axis, cut) && !interrupt_asked();
      free(section.faces);
      page_free(&out);
    }
  }
  free(places);
  free(marks);
  return done;
}
