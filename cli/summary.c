/* What people read when a command has run, and the same facts as JSON. */
#include "summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "text.h"

/* ---- input ---- */

static void say_defects(const laves_domain_info *info, bool all) {
  char line[400] = "";
  text_buffer place;
  for (int i = 0; i < LAVES_DEFECT_COUNT; ++i) {
    if (info->defects[i] == 0) continue;
    const char *what = laves_defect_text((laves_defect)i);
    if (all) {
      text_say("  %s: %zu, the first at %s", what, info->defects[i], text_place(&place, info->defect_place[i]));
      continue;
    }
    const size_t used = strlen(line);
    snprintf(line + used, sizeof line - used, "%s%s: %zu", used ? ", " : "", what, info->defects[i]);
  }
  if (line[0]) text_say("  defects (places: laves info): %s", line);
}

/* What was made of parts that cross or lie within others, and what else could be. */
static void say_parts(const laves_domain_info *info) {
  text_buffer crossing, nested;
  if (info->crossing_parts > 0)
    text_say("  %s cross: %s", text_plural(&crossing, info->crossing_parts, "part"),
             info->winding_level > 1 ? "solid is where enough of them overlap (--winding)"
                                     : "their union is the solid (--winding 1.5: where two overlap)");
  if (info->nested_parts == 0) return;
  static const char *const ways[] = {"as their faces are directed (--union fills all, --nested goes by depth)",
                                     "since all is filled (--union)", "by depth (--nested)"};
  text_say("  %s within others, %zu of them hollow: %s", text_plural(&nested, info->nested_parts, "part"), info->hollow_parts,
           ways[info->overlap]);
}

static void say_surface(const input *in) {
  const laves_domain_info *info = &in->info;
  text_buffer points, triangles, parts;
  text_say("%s: %s, %s, %s, %s, %s", text_base_name(in->text), info->format,
           text_plural(&triangles, info->triangle_count, "triangle"), text_plural(&points, info->point_count, "point"),
           text_plural(&parts, info->component_count, "part"), info->closed ? "closed" : "open");
  if (info->turned) text_say("  it was inside out and has been turned");
  if (info->winding) text_say("  inside is decided by the winding number, since the surface is not clean");
  say_parts(info);
}

void summary_input(const input *in, bool all) {
  if (in->info.kind == LAVES_DOMAIN_SURFACE) {
    say_surface(in);
    say_defects(&in->info, all);
  } else {
    text_say("%s: %s", text_base_name(in->text), in->info.format);
  }
}

/* ---- quality ---- */

/* The colour of a bin of 5 degrees: cyan where the tiling's angles are, yellow outside the window that is asked for by default,
 * red where angles are as bad as the worst windows allow. */
static const char *bin_colour(int bin) {
  if (bin < 20 / 5 || bin >= 150 / 5) return "\033[31m";
  if (bin < 40 / 5 || bin >= 125 / 5) return "\033[33m";
  return bin >= 60 / 5 && bin < 75 / 5 ? "\033[36m" : "";
}

void summary_histogram(const size_t bins[LAVES_HISTOGRAM_BINS]) {
  static const char *const blocks[] = {" ", "\u2581", "\u2582", "\u2583", "\u2584", "\u2585", "\u2586", "\u2587", "\u2588"};
  static const char *const marks[] = {" ", ".", ":", "-", "=", "+", "*", "#", "@"};
  const char *const *shades = text_is_utf8() ? blocks : marks;
  size_t most = 2;
  for (int i = 0; i < LAVES_HISTOGRAM_BINS; ++i) most = bins[i] > most ? bins[i] : most;
  fputs("  dihedral angles, log scale\n  ", stderr);
  for (int i = 0; i < LAVES_HISTOGRAM_BINS; ++i) {
    const int height = bins[i] == 0 ? 0 : 1 + (int)(7 * log((double)bins[i]) / log((double)most) + 0.5);
    const char *colour = text_has_colour() && height > 0 ? bin_colour(i) : "";
    fprintf(stderr, "%s%s%s", colour, shades[height], colour[0] ? "\033[0m" : "");
  }
  fputs("\n  0     30    60    90    120   150  180\n", stderr);
}

static void say_topology(const laves_check *check) {
  text_buffer parts, surfaces, faces;
  text_say("  %s, boundary of %s in %s, genus %lld", text_plural(&parts, check->components, "part"),
           text_plural(&faces, check->faces, "triangle"), text_plural(&surfaces, check->boundary_components, "piece"),
           (long long)check->genus);
}

void summary_check(const laves_check *check) {
  const char *degree = text_degree();
  text_buffer at_least, at_most;
  say_topology(check);
  if (isnan(check->edge_mean))
    text_say("  volume %.9g, edges %.4g .. %.4g", check->volume, check->edge_min, check->edge_max);
  else
    text_say("  volume %.9g, edges %.4g .. %.4g (mean %.4g)", check->volume, check->edge_min, check->edge_max, check->edge_mean);
  text_say("  smallest dihedral angle %.2f%s at %s", check->min_dihedral.min, degree,
           text_place(&at_least, check->min_dihedral_place));
  text_say("  largest dihedral angle %.2f%s at %s", check->max_dihedral.max, degree,
           text_place(&at_most, check->max_dihedral_place));
  text_say("  radius ratio min %.3f mean %.3f, volume-length min %.3f mean %.3f", check->radius_ratio.min,
           check->radius_ratio.mean, check->volume_length.min, check->volume_length.mean);
  summary_histogram(check->histogram);
}

void summary_faults(const laves_check *check) {
  const struct {
    size_t count;
    const char *what;
  } faults[] = {
      {check->bad_indices, "tetrahedra with corners that are out of range or repeated"},
      {check->inverted_tets, "tetrahedra that are flat or inside out"},
      {check->nonconforming_faces, "faces with more than two tetrahedra or two on one side"},
      {check->nonmanifold_edges, "boundary edges without exactly two boundary faces"},
      {check->nonmanifold_vertices, "boundary vertices where several sheets meet"},
  };
  for (size_t i = 0; i < sizeof faults / sizeof faults[0]; ++i) {
    if (faults[i].count) text_say("  %zu %s", faults[i].count, faults[i].what);
  }
}

/* ---- JSON ---- */

static void statistic_json(json *out, const char *name, const laves_statistic *values) {
  json_open_object(out, name);
  json_number(out, "min", values->min);
  json_number(out, "max", values->max);
  json_number(out, "mean", values->mean);
  json_number(out, "deviation", values->deviation);
  json_close(out);
}

static void validity_json(json *out, const laves_check *check) {
  json_boolean(out, "valid", check->valid);
  json_integer(out, "bad_indices", (int64_t)check->bad_indices);
  json_integer(out, "inverted_tets", (int64_t)check->inverted_tets);
  json_integer(out, "nonconforming_faces", (int64_t)check->nonconforming_faces);
  json_integer(out, "nonmanifold_edges", (int64_t)check->nonmanifold_edges);
  json_integer(out, "nonmanifold_vertices", (int64_t)check->nonmanifold_vertices);
  json_integer(out, "unused_vertices", (int64_t)check->unused_vertices);
  json_integer(out, "components", (int64_t)check->components);
  json_integer(out, "boundary_components", (int64_t)check->boundary_components);
  json_integer(out, "genus", check->genus);
}

static void distance_json(json *out, const laves_check *check) {
  json_open_object(out, "distance");
  json_number(out, "to_surface_max", check->to_surface_max);
  json_number(out, "to_surface_mean", check->to_surface_mean);
  json_numbers(out, "to_surface_place", check->to_surface_place, 3);
  json_number(out, "from_surface_max", check->from_surface_max);
  json_number(out, "from_surface_mean", check->from_surface_mean);
  json_numbers(out, "from_surface_place", check->from_surface_place, 3);
  json_close(out);
}

void summary_verdict(const char *path, const laves_check *check) {
  text_buffer tets, vertices, unused;
  const char *colour = !text_has_colour() ? "" : check->valid ? "\033[32m" : "\033[1;31m";
  text_say("%s: %s, %s, %s%s%s", text_base_name(path), text_plural(&tets, check->tets, "tet"),
           text_plural(&vertices, check->vertices, "vertex"), colour, check->valid ? "valid" : "NOT VALID",
           colour[0] ? "\033[0m" : "");
  summary_faults(check);
  if (check->unused_vertices) text_say("  %s in no tet (harmless)", text_plural(&unused, check->unused_vertices, "vertex"));
  summary_check(check);
}

void summary_check_json(json *out, const laves_check *check) {
  json_integer(out, "tets", (int64_t)check->tets);
  json_integer(out, "vertices", (int64_t)check->vertices);
  json_integer(out, "faces", (int64_t)check->faces);
  json_number(out, "min_dihedral", check->min_dihedral.min);
  json_number(out, "max_dihedral", check->max_dihedral.max);
  json_number(out, "radius_ratio_min", check->radius_ratio.min);
  json_number(out, "radius_ratio_mean", check->radius_ratio.mean);
  json_number(out, "volume_length_min", check->volume_length.min);
  json_number(out, "volume_length_mean", check->volume_length.mean);
  json_number(out, "volume", check->volume);
  json_number(out, "area", check->area);
  json_number(out, "edge_min", check->edge_min);
  json_number(out, "edge_max", check->edge_max);
  json_number(out, "edge_mean", check->edge_mean);
  validity_json(out, check);
  json_open_object(out, "statistics");
  statistic_json(out, "min_dihedral", &check->min_dihedral);
  statistic_json(out, "max_dihedral", &check->max_dihedral);
  statistic_json(out, "radius_ratio", &check->radius_ratio);
  statistic_json(out, "radius_edge", &check->radius_edge);
  statistic_json(out, "volume_length", &check->volume_length);
  json_close(out);
  json_numbers(out, "min_dihedral_place", check->min_dihedral_place, 3);
  json_numbers(out, "max_dihedral_place", check->max_dihedral_place, 3);
  json_numbers(out, "radius_ratio_place", check->radius_ratio_place, 3);
  double counts[LAVES_HISTOGRAM_BINS];
  for (int i = 0; i < LAVES_HISTOGRAM_BINS; ++i) counts[i] = (double)check->histogram[i];
  json_numbers(out, "dihedral_histogram", counts, LAVES_HISTOGRAM_BINS);
  if (check->has_distance) distance_json(out, check);
}
