/* What was reached, and what was not. */
#include <stdio.h>
#include <string.h>

#include "features/tally.h"
#include "losses.h"
#include "run.h"
#include "stuff/zone.h"

size_t laves__count_outside(const laves__run *r) {
  const laves_options *o = r->options;
  const laves__window asked = {
      .min_dihedral = o->min_dihedral, .max_dihedral = o->max_dihedral, .volume_length = o->volume_length};
  return laves__improve_outside(&asked, &r->layer);
}

/* What was asked about parts of the input, and is not there or not as it may seem. */
static void judge_parts(laves__run *r, const laves_mesh *mesh) {
  const laves_options *o = r->options;
  if (o->face_sources && !mesh->face_sources)
    laves__warn(r, "the nearest faces of the input were asked for, but the input is not made of faces");
  if (o->regions == LAVES_REGIONS_PARTS && r->regions.parts < 2)
    laves__warn(r, "regions were asked for, but the input does not have two closed parts; the mesh is one region");
  if (r->regions.empty)
    laves__warn(r, "%zu of the %zu parts of the input hold no tetrahedron at this size", r->regions.empty, r->regions.parts);
  if (r->regions.interfaces)
    laves__warn(r, "interfaces between regions follow the tetrahedra, not the surfaces of the parts: %zu faces",
                r->regions.interfaces);
}

/* On surfaces that stay open creases are not looked for. */
static void warn_of_open(laves__run *r) {
  const laves_domain_info *info = &r->domain->info;
  const double *place = info->defect_place[LAVES_DEFECT_OPEN_EDGE];
  if (info->kind != LAVES_DOMAIN_SURFACE || r->domain->oracle.find_features || !(r->options->feature_angle > 0)) return;
  laves__warn(
      r,
      "the surface is open, so its sharp edges were not looked for, and are rounded to the size; close it, as near (%g, %g, %g)",
      place[0], place[1], place[2]);
}

/* What of the features is kept. */
static laves_result judge_features(laves__run *r) {
  laves_report *report = r->report;
  laves__feature_tally tally;
  report->feature_size = laves__least_size(r);
  report->creases_dropped = r->features.dropped_count;
  report->creases_joined = r->features.joined_count;
  warn_of_open(r);
  if (!r->frame.features) return LAVES_OK;
  const laves_result result = laves__tally_features(&r->frame, &r->layer, &tally, r->error);
  if (result != LAVES_OK) return result;
  report->creases = r->features.crease_count;
  report->corners = tally.corners;
  report->corners_kept = tally.kept_corners;
  report->crease_length = tally.length * r->frame.size;
  report->crease_kept = tally.kept_length * r->frame.size;
  report->features_released = r->released;
  if (!tally.has_lost) return LAVES_OK;
  const laves__vec3 place = laves__frame_to_input(&r->frame, tally.lost);
  char corners[64] = "";
  if (tally.corners > 0) snprintf(corners, sizeof corners, "; %zu of %zu corners are kept", tally.kept_corners, tally.corners);
  laves__warn(r, "creases that are closer to one another than the size of %g allows are not kept, as near (%g, %g, %g)%s",
              r->frame.size, place.x, place.y, place.z, corners);
  return LAVES_OK;
}

/* What became of thin parts. Where a place is known the sentence about pinches names the first. */
static laves_result judge_thin(laves__run *r, const laves_mesh *mesh) {
  laves_report *report = r->report;
  char text[sizeof report->warnings[0]];
  report->lost_count = r->counts.lost_count;
  memcpy(report->lost, r->counts.lost, sizeof report->lost);
  if (report->pinches) {
    const laves_thin_place *p = &report->lost[0];
    char place[80] = "";
    if (report->lost_count) snprintf(place, sizeof place, ", as at (%.6g, %.6g, %.6g)", p->place[0], p->place[1], p->place[2]);
    laves__warn(
        r, "at %zu places the solid is thinner than the size, or its parts closer; walls were trimmed or parts set apart there%s",
        report->pinches, place);
  }
  if (r->counts.specks)
    laves__warn(r, "%zu parts of a few tetrahedra, beyond places thinner than the size, were dropped", r->counts.specks);
  laves__stage_begin(r);
  const laves_result result = laves__find_losses(&r->frame, r->domain, mesh, report, text, sizeof text, r->error);
  if (text[0]) { /* else it took no time */
    laves__stage_end(r, "topology");
    laves__warn(r, "%s", text);
  }
  return result;
}

/* By how much a point lies beyond the box of the domain, along one axis. */
static double beyond_bounds(const laves_domain_info *info, laves__vec3 point) {
  const double at[3] = {point.x, point.y, point.z};
  double most = 0;
  for (int k = 0; k < 3; k++) most = fmax(most, fmax(info->lower[k] - at[k], at[k] - info->upper[k]));
  return most;
}

/* A function's solid is followed beyond its box as far as the background goes, and what does not hang together with the rest is
 * not found there. */
static void warn_of_bounds(laves__run *r) {
  static const double slack = 1e-6; /* in diagonals: bounds that are typed with seven digits */
  const double least = slack * box3_diagonal(r->domain->oracle.bounds);
  double most = least;
  laves__vec3 place = {0};
  for (size_t v = 0; v < r->layer.vertex_count; v++) {
    if (r->layer.depth[v] != 0 || r->layer.off_surface[v] || r->layer.star[v].count == 0) continue;
    const laves__vec3 point = laves__frame_to_input(&r->frame, r->layer.position[v]);
    const double beyond = beyond_bounds(&r->domain->info, point);
    if (beyond <= most) continue;
    most = beyond;
    place = point;
  }
  if (most > least)
    laves__warn(r,
                "the solid reaches beyond its bounds, by %g near (%g, %g, %g), and parts of it may be missing; give bounds that "
                "contain it",
                most, place.x, place.y, place.z);
}

static void warn_of_gaps(laves__run *r) {
  char gaps[160];
  if (laves__tell_gaps(r, gaps, sizeof gaps)) laves__warn(r, "%s, which counts as outside", gaps);
}

/* The last word on targets: what was asked and is not there. */
laves_result laves__judge(laves__run *r, const laves_mesh *mesh) {
  const laves_options *o = r->options;
  laves_report *report = r->report;
  report->size = r->frame.size;
  report->lattice_tets = mesh->lattice_tet_count;
  report->snapped_vertices = r->counts.snapped;
  report->pinches = r->counts.pinches + r->stuffed.unsnapped;
  const bool promised = r->guarantee && o->guarantee > 0; /* stuffing needs thresholds, promised or not */
  report->promised_min_dihedral = promised ? r->guarantee->min_dihedral : 0;
  report->promised_max_dihedral = promised ? r->guarantee->max_dihedral : 180;
  report->stuffed_vertices = r->stuffed.vertices;
  report->relaxed_vertices = r->stuffed.relaxed;
  report->relaxed_max = r->stuffed.relaxed_max * r->frame.size;
  report->off_surface = 0;
  for (size_t v = 0; v < r->layer.vertex_count; v++) report->off_surface += r->layer.off_surface[v] && r->layer.star[v].count > 0;
  report->outside_window = laves__count_outside(r);
  const size_t broken = r->guarantee ? laves__count_broken(r->guarantee, &r->layer, r->forced) : 0;
  report->peak_bytes = laves_context_peak_bytes(r->context);
  laves_result known = laves__is_cancelled(r->context) ? laves__fail_cancelled(r->error) : judge_thin(r, mesh);
  if (known == LAVES_OK) known = judge_features(r);
  if (known != LAVES_OK) return known;
  if (report->off_surface)
    laves__warn(r, "%zu boundary vertices stand off the surface, where it is too sharp or thin for the size%s",
                report->off_surface, report->relaxed_vertices ? ", or where the guarantee moved them" : "");
  if (report->outside_window)
    laves__warn(r, "%zu tetrahedra are outside the asked window of %g to %g degrees and volume-length %g", report->outside_window,
                o->min_dihedral, o->max_dihedral, o->volume_length);
  if (broken)
    laves__warn(r,
                "%zu tetrahedra are outside the promised window of %g to %g degrees, which should not happen; please report it",
                broken, report->promised_min_dihedral, report->promised_max_dihedral);
  if (r->distant)
    laves__warn(r,
                "at %zu places mesh and surface are further apart than the %g asked for, the furthest at (%g, %g, %g); a smaller "
                "min_size may help",
                r->distant, o->max_distance, r->distant_place.x, r->distant_place.y, r->distant_place.z);
  judge_parts(r, mesh);
  if (r->domain->info.kind == LAVES_DOMAIN_FUNCTION) {
    warn_of_bounds(r);
    warn_of_gaps(r);
  }
  const double wished = o->tet_target ? (double)o->tet_target : (double)o->vertex_target;
  const double got = o->tet_target ? (double)mesh->tet_count : (double)mesh->vertex_count;
  if (wished > 0 && fabs(got / wished - 1) > 0.03) {
    laves__warn(r, "%.0f %s were asked for and %.0f made: the count can't be met within 3 %%", wished,
                o->tet_target ? "tetrahedra" : "vertices", got);
    return LAVES_TARGET_MISSED;
  }
  return r->distant ? LAVES_TARGET_MISSED : LAVES_OK;
}
