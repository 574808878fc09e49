/* What `laves check --features` finds, in words and as JSON. */
#include "feature_report.h"

#include <math.h>
#include <stdlib.h>

#include "text.h"

laves_result feature_report_make(session *run, const laves_mesh *mesh, const laves_domain *surface, double size,
                                 feature_report *report) {
  const size_t capacity = (size_t)run->given->list;
  laves_feature_options options = laves_feature_options_default();
  options.angle = run->given->feature_angle;
  options.size = size;
  report->places = calloc(LAVES_FEATURE_FAULT_COUNT * capacity + 1, sizeof *report->places);
  if (!report->places) {
    return session_fail(run, LAVES_ERROR_MEMORY, "no memory for a list of %zu places of features", capacity);
  }
  laves_result result = laves_check_features(run->context, mesh, surface, &options, &report->check, report->places, capacity,
                                             &report->place_count, &run->error);
  result = session_settle(run, result);
  report->made = result == LAVES_OK;
  return result;
}

bool feature_report_misses(const feature_report *report) {
  const laves_feature_check *c = &report->check;
  return report->made && (c->creases_kept + c->short_creases < c->creases || c->corners_kept + c->short_corners < c->corners);
}

/* ---- words ---- */

static void say_way(const char *way, double max, double diagonal, const double place[3], double mean) {
  text_buffer where;
  char tail[40] = "";
  if (isfinite(mean)) snprintf(tail, sizeof tail, ", mean %.4g", mean);
  text_say("    %s: max %.4g (%.3f %% of the diagonal) at %s%s", way, max, 100 * max / diagonal, text_place(&where, place), tail);
}

static void say_creases(const laves_feature_check *c) {
  text_buffer kept, corners, shorts;
  char apart[120] = "";
  if (c->short_creases) {
    snprintf(apart, sizeof apart, " (%s shorter than the edges near by left out, and %zu corners between such)",
             text_plural(&shorts, c->short_creases, "crease"), c->short_corners);
  }
  text_say("    kept within %.4g: %.2f %% of the length, %s of %zu, %s of %zu%s", c->tolerance, 100 * c->kept_share,
           text_plural(&kept, c->creases_kept, "crease"), c->creases - c->short_creases,
           text_plural(&corners, c->corners_kept, "corner"), c->corners - c->short_corners, apart);
  if (c->creases > c->short_creases) {
    say_way("creases to edges of the mesh", c->to_mesh_max, c->diagonal, c->to_mesh_place, c->to_mesh_mean);
  }
}

static void say_mesh_creases(const laves_feature_check *c) {
  text_buffer edges, faces;
  if (c->mesh_creases > c->mesh_bent && isfinite(c->from_mesh_max)) {
    say_way("sharp edges of the mesh to creases", c->from_mesh_max, c->diagonal, c->from_mesh_place, NAN);
  }
  text_say("    %s that are sharp where the solid is not, and %zu where it bends", text_plural(&edges, c->spurious, "edge"),
           c->mesh_bent);
  text_say("    %s across creases", text_plural(&faces, c->straddling, "boundary face"));
}

static void say_angles(const laves_feature_check *c) {
  const char *degree = text_degree();
  if (isfinite(c->away_min_dihedral)) {
    text_say("    dihedral angles away from features %.2f .. %.2f%s", c->away_min_dihedral, c->away_max_dihedral, degree);
  }
  if (isfinite(c->sharpest)) {
    text_say("    sharpest crease %.2f%s inside, %zu below 80%s", c->sharpest, degree, c->sharp, degree);
  }
}

static void say_sharp(const laves_feature_place *p, const char *at) {
  const char *degree = text_degree();
  char least[60] = "no tet has an edge on it";
  if (isfinite(p->dihedral)) snprintf(least, sizeof least, "least dihedral angle on it %.2f%s", p->dihedral, degree);
  text_say("    crease of %.2f%s inside at %s: %s", p->angle, degree, at, least);
}

static void say_feature_place(const laves_feature_place *p) {
  const char *degree = text_degree();
  text_buffer at;
  text_place(&at, p->place);
  switch (p->fault) {
    case LAVES_FEATURE_FAULT_CREASE:
      text_say("    crease %.4g long, %.2f%s inside: %.4g from the nearest edge at %s", p->length, p->angle, degree, p->distance,
               at.text);
      break;
    case LAVES_FEATURE_FAULT_CORNER:
      text_say("    corner at %s: %.4g from the nearest edge, no vertex there", at.text, p->distance);
      break;
    case LAVES_FEATURE_FAULT_SPURIOUS:
      text_say("    sharp edge, %.2f%s, %.4g from the nearest crease at %s", p->angle, degree, p->distance, at.text);
      break;
    case LAVES_FEATURE_FAULT_STRADDLING:
      text_say("    face across a crease at %s", at.text);
      break;
    default:
      say_sharp(p, at.text);
  }
}

void feature_report_say(const feature_report *report) {
  const laves_feature_check *c = &report->check;
  text_buffer creases, corners;
  text_say("  features of %g%s: %s, %.6g long, %s", c->angle, text_degree(), text_plural(&creases, c->creases, "crease"),
           c->length, text_plural(&corners, c->corners, "corner"));
  say_creases(c);
  say_mesh_creases(c);
  say_angles(c);
  for (size_t i = 0; i < report->place_count; ++i) say_feature_place(&report->places[i]);
}

/* ---- JSON ---- */

static void write_counts(json *out, const laves_feature_check *c) {
  const struct {
    const char *key;
    size_t count;
  } counts[] = {
      {"creases", c->creases},           {"short_creases", c->short_creases}, {"creases_kept", c->creases_kept},
      {"corners", c->corners},           {"short_corners", c->short_corners}, {"corners_kept", c->corners_kept},
      {"corners_near", c->corners_near}, {"mesh_creases", c->mesh_creases},   {"mesh_bent", c->mesh_bent},
      {"spurious", c->spurious},         {"straddling", c->straddling},       {"sharp", c->sharp},
  };
  for (size_t i = 0; i < sizeof counts / sizeof counts[0]; ++i) json_integer(out, counts[i].key, (int64_t)counts[i].count);
}

static void write_figures(json *out, const laves_feature_check *c) {
  const struct {
    const char *key;
    double value;
  } figures[] = {
      {"angle", c->angle},
      {"size", c->size},
      {"tolerance", c->tolerance},
      {"diagonal", c->diagonal},
      {"length", c->length},
      {"short_length", c->short_length},
      {"kept_share", c->kept_share},
      {"to_mesh_max", c->to_mesh_max},
      {"to_mesh_mean", c->to_mesh_mean},
      {"from_mesh_max", c->from_mesh_max},
      {"sharpest", c->sharpest},
  };
  for (size_t i = 0; i < sizeof figures / sizeof figures[0]; ++i) json_number(out, figures[i].key, figures[i].value);
  json_numbers(out, "to_mesh_place", c->to_mesh_place, 3);
  json_numbers(out, "from_mesh_place", c->from_mesh_place, 3);
  json_numbers(out, "away_dihedral", (const double[2]){c->away_min_dihedral, c->away_max_dihedral}, 2);
  json_numbers(out, "free_dihedral", (const double[2]){c->free_min_dihedral, c->free_max_dihedral}, 2);
}

static void write_feature_place(json *out, const laves_feature_place *p) {
  json_open_object(out, NULL);
  json_text(out, "fault", laves_feature_fault_key(p->fault));
  json_numbers(out, "place", p->place, 3);
  json_number(out, "distance", p->distance);
  json_number(out, "length", p->length);
  json_number(out, "angle", p->angle);
  json_number(out, "dihedral", p->dihedral);
  json_integer(out, "index", p->index);
  json_close(out);
}

void feature_check_write_json(json *out, const laves_feature_check *check, const laves_feature_place *places,
                              size_t place_count) {
  json_open_object(out, "features");
  write_counts(out, check);
  write_figures(out, check);
  if (places) {
    json_open_array(out, "places");
    for (size_t i = 0; i < place_count; ++i) write_feature_place(out, &places[i]);
    json_close(out);
  }
  json_close(out);
}

void feature_report_write_json(json *out, const feature_report *report) {
  if (report->made) feature_check_write_json(out, &report->check, report->places, report->place_count);
}
