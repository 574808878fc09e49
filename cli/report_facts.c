/* The facts of a report: what its page shows in words and numbers, as JSON. docs/report.md lists the members. */
#include "report_facts.h"

#include <math.h>
#include <string.h>

#include "feature_report.h"
#include "statement.h"
#include "summary.h"
#include "text.h"

enum { THIN_CAPACITY = 64, DEFECTS_SHOWN = 2000 /* of each kind */ };

/* Walls and gaps below so many sizes are shown, as `laves info` tells them. */
static const double thin_sizes = 2;

static void write_histogram(json *out, const char *key, const size_t *counts, int bin_count, double low, double width) {
  double values[DIHEDRAL_BINS];
  for (int i = 0; i < bin_count; ++i) values[i] = (double)counts[i];
  json_open_object(out, key);
  json_number(out, "low", low);
  json_number(out, "width", width);
  json_numbers(out, "counts", values, (size_t)bin_count);
  json_close(out);
}

static void write_histograms(json *out, const report_shapes *shapes) {
  json_open_object(out, "histograms");
  write_histogram(out, "dihedral", shapes->dihedrals, DIHEDRAL_BINS, 0, 1);
  write_histogram(out, "radius_ratio", shapes->ratios, RATIO_BINS, 0, 0.01);
  write_histogram(out, "radius_edge", shapes->edges, EDGE_BINS, 1, 0.02);
  json_close(out);
}

static void write_groups(json *out, const char *key, const laves_mesh *mesh, int dimension, const report_groups *groups) {
  json_open_array(out, key);
  for (size_t i = 0; i < groups->count && i <= UINT16_MAX; ++i) {
    json_open_object(out, NULL);
    json_integer(out, "number", groups->numbers[i]);
    json_text(out, "name", laves_mesh_group_name(mesh, dimension, groups->numbers[i]));
    json_integer(out, "count", (int64_t)groups->counts[i]);
    json_close(out);
  }
  json_close(out);
}

static void write_extent(json *out, const laves_mesh *mesh, const report_parts *parts) {
  json_open_object(out, "embedded");
  json_boolean(out, "whole", parts->whole);
  json_integer(out, "worst", (int64_t)parts->worst);
  json_numbers(out, "origin", parts->origin, 3);
  json_numbers(out, "lower", parts->lower, 3);
  json_numbers(out, "upper", parts->upper, 3);
  json_integer(out, "vertices", (int64_t)parts->vertex_count);
  json_integer(out, "tets", (int64_t)parts->tet_count);
  json_integer(out, "faces", (int64_t)parts->face_count);
  json_open_array(out, "cuts");
  for (int axis = 0; axis < 3; ++axis) {
    double positions[REPORT_CUTS_MOST];
    for (int k = 0; k < parts->cuts[axis].count; ++k) positions[k] = (double)parts->cuts[axis].positions[k];
    json_numbers(out, NULL, positions, (size_t)parts->cuts[axis].count);
  }
  json_close(out);
  json_boolean(out, "distances", parts->distances != NULL);
  json_boolean(out, "distance_rough", parts->distance_rough);
  json_numbers(out, "distance_range", parts->distance_range, 2);
  json_close(out);
  write_groups(out, "regions", mesh, 3, &parts->regions);
  write_groups(out, "tags", mesh, 2, &parts->tags);
}

static void write_exceptions(json *out, const laves_certificate *c) {
  json_open_array(out, "places");
  for (size_t i = 0; i < c->exception_count; ++i) {
    const laves_exception *e = &c->exceptions[i];
    json_open_object(out, NULL);
    json_text(out, "kind", laves_exception_key(e->kind));
    json_text(out, "text", laves_exception_text(e->kind));
    json_text(out, "cause", e->cause == LAVES_CAUSE_UNKNOWN ? NULL : laves_cause_text(e->cause));
    json_numbers(out, "place", e->place, 3);
    json_number(out, "value", e->value);
    json_number(out, "limit", e->limit);
    json_integer(out, "index", e->index);
    json_close(out);
  }
  json_close(out);
}

static void write_certificate(json *out, const laves_certificate *c) {
  json_open_object(out, "certificate");
  summary_check_json(out, &c->check);
  statement_write_json(out, c);
  json_integer(out, "min_dihedral_tet", c->check.min_dihedral_tet);
  json_integer(out, "max_dihedral_tet", c->check.max_dihedral_tet);
  json_integer(out, "radius_ratio_tet", c->check.radius_ratio_tet);
  json_integer(out, "radius_edge_tet", c->check.radius_edge_tet);
  json_number(out, "to_surface_at_most", c->check.to_surface_at_most);
  json_number(out, "from_surface_at_most", c->check.from_surface_at_most);
  json_number(out, "domain_volume", c->check.has_distance ? c->check.domain_volume : NAN);
  json_number(out, "size", c->has_options ? c->size : NAN);
  json_number(out, "lattice_size", c->lattice_size);
  json_boolean(out, "has_promise", c->has_promise);
  json_numbers(out, "promised", (const double[2]){c->promised_min_dihedral, c->promised_max_dihedral}, 2);
  json_numbers(out, "asked", (const double[2]){c->asked_min_dihedral, c->asked_max_dihedral}, 2);
  json_number(out, "asked_volume_length", c->asked_volume_length);
  if (c->has_features) feature_check_write_json(out, &c->features, NULL, 0);
  write_exceptions(out, c);
  json_close(out);
}

/* ---- where the input is wrong or thin ---- */

static void write_defects(json *out, const laves_domain_info *info, const laves_defects *defects) {
  size_t shown[LAVES_DEFECT_COUNT] = {0}, found[LAVES_DEFECT_COUNT] = {0};
  json_open_object(out, "defects");
  json_open_array(out, "places");
  for (size_t i = 0; i < laves_defects_count(defects); ++i) {
    laves_defect_place at;
    laves_defects_get(defects, i, &at);
    ++found[at.kind];
    if (shown[at.kind] == DEFECTS_SHOWN) continue;
    ++shown[at.kind];
    json_open_object(out, NULL);
    json_integer(out, "kind", at.kind);
    json_numbers(out, "corners", at.corners[0], 3 * (size_t)at.corner_count);
    json_close(out);
  }
  json_close(out);
  json_open_array(out, "kinds");
  for (int kind = 0; kind < LAVES_DEFECT_COUNT; ++kind) {
    json_open_object(out, NULL);
    json_text(out, "text", laves_defect_text((laves_defect)kind));
    json_integer(out, "count", (int64_t)info->defects[kind]);
    json_integer(out, "places", (int64_t)found[kind]);
    json_integer(out, "shown", (int64_t)shown[kind]);
    json_close(out);
  }
  json_close(out);
  json_close(out);
}

static void write_thin_places(json *out, const laves_thin_place *places, size_t count, double limit, bool lost) {
  for (size_t i = 0; i < count; ++i) {
    if (!lost && !(places[i].thickness < limit)) continue;
    json_open_object(out, NULL);
    json_text(out, "kind", places[i].kind == LAVES_THIN_GAP ? "gap" : "wall");
    json_numbers(out, "place", places[i].place, 3);
    json_number(out, "thickness", places[i].thickness);
    json_boolean(out, "lost", lost);
    json_close(out);
  }
}

/* Walls, or gaps, of the input; false when memory is short. */
static bool find_thin(json *out, const laves_domain *domain,
                      size_t (*find)(const laves_domain *domain, laves_thin_place *places, size_t capacity), double limit) {
  laves_thin_place places[THIN_CAPACITY];
  const size_t count = find(domain, places, THIN_CAPACITY);
  write_thin_places(out, places, count, limit, false);
  return count > 0 || !isnan(places[0].thickness);
}

static bool write_thin(json *out, const report_subject *subject) {
  const laves_certificate *c = subject->certificate;
  const double size = c->has_options ? c->size : c->lattice_size > 0 ? c->lattice_size : c->check.edge_mean;
  bool known = true;
  json_number(out, "thin_below", thin_sizes * size);
  json_open_array(out, "thin");
  if (subject->making) write_thin_places(out, subject->making->lost, subject->making->lost_count, 0, true);
  if (subject->surface) {
    const laves_domain *domain = subject->surface->domain;
    known = find_thin(out, domain, laves_domain_thin_places, thin_sizes * size) &&
            find_thin(out, domain, laves_domain_gap_places, thin_sizes * size);
  }
  json_close(out);
  return known;
}

bool report_facts_write(json *out, const report_subject *subject, const report_shapes *shapes, const report_parts *parts) {
  const laves_mesh *mesh = subject->mesh;
  json_text(out, "program", "laves");
  json_text(out, "version", laves_version());
  json_text(out, "name", text_base_name(subject->name));
  json_integer(out, "tets", (int64_t)laves_mesh_tet_count(mesh));
  json_integer(out, "vertices", (int64_t)laves_mesh_vertex_count(mesh));
  json_integer(out, "faces", (int64_t)laves_mesh_face_count(mesh));
  json_open_object(out, "classes");
  json_integer(out, "layer", (int64_t)shapes->class_counts[REPORT_LAYER]);
  json_integer(out, "tile", (int64_t)shapes->class_counts[REPORT_TILE]);
  json_integer(out, "bcc_tile", (int64_t)shapes->class_counts[REPORT_BCC_TILE]);
  json_close(out);
  if (subject->surface) input_write_json(out, "input", subject->surface);
  write_extent(out, mesh, parts);
  write_histograms(out, shapes);
  write_certificate(out, subject->certificate);
  if (subject->surface && subject->defects && laves_defects_count(subject->defects) > 0)
    write_defects(out, &subject->surface->info, subject->defects);
  const bool known = write_thin(out, subject);
  json_open_array(out, "warnings");
  for (int i = 0; subject->making && i < subject->making->warning_count; ++i) json_text(out, NULL, subject->making->warnings[i]);
  json_close(out);
  return known;
}
