/* laves view MESH -o PICTURE.png: a picture of a mesh, whole, cut open, or with its worst tetrahedra.
 * laves view MESH --plot WHAT -o PLOT.svg: histograms of its quality. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "command.h"
#include "input.h"
#include "output.h"
#include "picture.h"
#include "plot.h"
#include "png.h"
#include "scene_distance.h"
#include "session.h"
#include "tet_shape.h"
#include "text.h"

enum { WIDEST = 16384, CHANNELS = 4 };

/* Sets *index to where an option's value stands in the list of those that there are. */
static laves_result choose(session *run, const char *name, const char *value, const char *const *names, int count, int *index) {
  char wrong[OPTION_SENTENCE_CAPACITY];
  *index = option_choose(value, names, count, wrong);
  return *index >= 0 ? LAVES_OK : session_fail(run, LAVES_ERROR_OPTION, "option '--%s' %s", name, wrong);
}

/* Degrees, as features are looked for by default. */
static const double crease_angle = 40;

/* What the pictures of one run are made of; freed by command_view(). */
typedef struct view_job {
  scene_options what;
  picture_options how;
  int plots[PLOT_MEASURES], plot_count; /* measures; none: a picture */
  laves_mesh *mesh;
  input surface;
  scene shown, worst;
  int64_t *worst_tets;
  double *worst_scores;
  double furthest; /* of SCENE_DISTANCE */
} view_job;

static laves_result read_words(session *run, scene_options *what, picture_options *how) {
  static const char *const axes[] = {"x", "y", "z"};
  static const char *const colours[] = {"class", "dihedral", "quality", "size", "distance"};
  static const char *const backgrounds[] = {"white", "transparent", "dark"};
  const settings *given = run->given;
  int up = 0, colour = 0, background = 0;
  laves_result result = choose(run, "up", given->up, axes, 3, &up);
  if (result == LAVES_OK) result = choose(run, "color", given->color, colours, 5, &colour);
  if (result == LAVES_OK) result = choose(run, "background", given->background, backgrounds, 3, &background);
  if (result != LAVES_OK) return result;
  if ((colour == SCENE_DISTANCE) != (given->surface != NULL)) {
    return session_fail(run, LAVES_ERROR_OPTION, "'--color distance' and '--surface INPUT' go together: give both or none");
  }
  what->colour = (scene_colour)colour;
  how->up = up;
  how->background = (picture_background)background;
  how->line_width = given->lines;
  how->crease_width = given->creases;
  what->crease_angle = given->creases > 0 ? crease_angle : 0;
  return LAVES_OK;
}

static laves_result read_numbers(session *run, picture_options *how) {
  const settings *given = run->given;
  const char *pixels = given->pixels ? given->pixels : "1200x900";
  char rest;
  if (sscanf(given->view, "%lf,%lf%c", &how->azimuth, &how->elevation, &rest) != 2 || !isfinite(how->azimuth) ||
      !(fabs(how->elevation) <= 90)) {
    return session_fail(run, LAVES_ERROR_OPTION,
                        "option '--view' needs an azimuth and an elevation of -90 to 90 degrees such as 30,25, not '%.30s'",
                        given->view);
  }
  if (sscanf(pixels, "%5dx%5d%c", &how->width, &how->height, &rest) != 2 || how->width < 16 || how->height < 16 ||
      how->width > WIDEST || how->height > WIDEST) {
    return session_fail(run, LAVES_ERROR_OPTION, "option '--size' needs pixels such as 1200x900, 16 to %d each, not '%.30s'",
                        WIDEST, pixels);
  }
  return LAVES_OK;
}

/* The plane through the middle of the mesh across an axis, with the viewer's side to be dropped. */
static void cut_through_middle(const laves_mesh *mesh, int axis, const picture_options *how, scene_options *what) {
  const double *points = laves_mesh_points(mesh);
  double low = INFINITY, high = -INFINITY, direction[3];
  for (size_t i = 0; i < laves_mesh_vertex_count(mesh); ++i) {
    low = fmin(low, points[3 * i + (size_t)axis]);
    high = fmax(high, points[3 * i + (size_t)axis]);
  }
  picture_direction(how, direction);
  const double side = direction[axis] < 0 ? -1 : 1;
  what->plane[axis] = side;
  what->plane[3] = side * 0.5 * (low + high);
}

static laves_result read_cut(session *run, const laves_mesh *mesh, const picture_options *how, scene_options *what) {
  const char *cut = run->given->cut;
  double *plane = what->plane;
  char rest;
  if (!cut) return LAVES_OK;
  what->cut = true;
  if (strlen(cut) == 1 && strchr("xyz", *cut)) {
    cut_through_middle(mesh, *cut - 'x', how, what);
  } else if (sscanf(cut, "%lf,%lf,%lf,%lf%c", &plane[0], &plane[1], &plane[2], &plane[3], &rest) != 4 || !isfinite(plane[0]) ||
             !isfinite(plane[1]) || !isfinite(plane[2]) || !isfinite(plane[3])) {
    return session_fail(run, LAVES_ERROR_OPTION,
                        "option '--cut' needs x, y, z or the four numbers of a plane such as 1,0,0,0.5, not '%.60s'", cut);
  }
  return LAVES_OK;
}

static laves_result write_failed(session *run, const char *path) {
  if (errno == ENOMEM) return session_fail(run, LAVES_ERROR_MEMORY, "no memory to write '%.200s'", path);
  return session_fail(run, LAVES_ERROR_WRITE, "cannot write '%.200s': %s", path, strerror(errno));
}

static laves_result write_picture(session *run, const view_job *job, const char *path) {
  const picture_options *how = &job->how;
  const bool clear = how->background == PICTURE_TRANSPARENT;
  const size_t count = (size_t)how->width * (size_t)how->height;
  uint8_t *pixels = malloc(CHANNELS * (count ? count : 1));
  if (!pixels || !picture_draw(&job->shown, job->worst.face_count ? &job->worst : NULL, how, pixels)) {
    free(pixels);
    return session_fail(run, LAVES_ERROR_MEMORY, "no memory for a picture of %d by %d pixels", how->width, how->height);
  }
  for (size_t i = 0; !clear && i < count; ++i) memmove(pixels + 3 * i, pixels + CHANNELS * i, 3);
  const bool written = png_write(path, pixels, how->width, how->height, clear ? CHANNELS : 3);
  const int reason = errno;
  free(pixels);
  errno = reason;
  return written ? LAVES_OK : write_failed(run, path);
}

/* ---- the picture ---- */

static laves_result build_worst(session *run, view_job *job) {
  const size_t capacity = (size_t)run->given->worst;
  if (capacity == 0) return LAVES_OK;
  job->worst_tets = malloc(capacity * sizeof *job->worst_tets);
  job->worst_scores = malloc(capacity * sizeof *job->worst_scores);
  if (job->worst_tets && job->worst_scores) {
    const size_t count = scene_worst_tets(job->mesh, job->what.colour, job->worst_tets, job->worst_scores, capacity);
    if (scene_build_tets(job->mesh, job->worst_tets, count, job->what.colour, &job->worst)) return LAVES_OK;
  }
  return session_fail(run, LAVES_ERROR_MEMORY, "no memory for the worst %lld tetrahedra", (long long)run->given->worst);
}

static laves_result build(session *run, view_job *job) {
  if (!scene_build(job->mesh, &job->what, &job->shown)) {
    return session_fail(run, LAVES_ERROR_MEMORY, "no memory for the faces of the mesh");
  }
  if (job->shown.face_count == 0) {
    return session_fail(
        run, LAVES_ERROR_INPUT, "there is nothing to draw: %s",
        job->what.cut ? "no tetrahedron lies wholly on the kept side of the plane" : "the mesh has no tetrahedra");
  }
  if (job->what.colour == SCENE_DISTANCE &&
      !scene_measure_distances(job->surface.domain, &job->surface.info, &job->shown, &job->furthest)) {
    return session_fail(run, LAVES_ERROR_MEMORY, "no memory for the distances");
  }
  return build_worst(run, job);
}

/* Each of the worst tetrahedra on a line, by what makes it one of them. */
static void say_worst(const view_job *job) {
  for (size_t i = 0; i < job->worst.kept_tets; ++i) {
    double p[4][3], angles[6], middle[3], least = 180, most = 0;
    text_buffer place;
    tet_corners(job->mesh, job->worst_tets[i], p);
    tet_dihedral_angles(p, angles);
    for (int k = 0; k < 6; ++k) {
      least = fmin(least, angles[k]);
      most = fmax(most, angles[k]);
    }
    for (int k = 0; k < 3; ++k) middle[k] = 0.25 * (p[0][k] + p[1][k] + p[2][k] + p[3][k]);
    text_say("  tet %lld at %s: %.2f .. %.2f%s, volume-length %.3f", (long long)job->worst_tets[i], text_place(&place, middle),
             least, most, text_degree(), tet_volume_length(p));
  }
}

static void say_picture(const view_job *job, const char *path) {
  const scene *shown = &job->shown;
  text_buffer faces, tets;
  char scale[80] = "";
  if (job->what.colour == SCENE_SIZE) {
    snprintf(scale, sizeof scale, ", edges %.3g (purple) .. %.3g (yellow)", shown->sizes[0], shown->sizes[1]);
  } else if (job->what.colour == SCENE_DISTANCE) {
    snprintf(scale, sizeof scale, ", distances 0 (blue) .. %.3g (red)", job->furthest);
  }
  text_say("%s: %s of %s, %d x %d pixels%s", path, text_plural(&faces, shown->face_count, "face"),
           text_plural(&tets, shown->kept_tets, "tet"), job->how.width, job->how.height, scale);
  say_worst(job);
}

static laves_result draw(session *run, view_job *job) {
  const settings *given = run->given;
  laves_result result = LAVES_OK;
  if (given->surface) result = input_open(run, given->surface, &job->surface);
  if (result == LAVES_OK) result = read_cut(run, job->mesh, &job->how, &job->what);
  if (result == LAVES_OK) result = build(run, job);
  if (result == LAVES_OK) result = write_picture(run, job, given->outputs.items[0]);
  if (result == LAVES_OK && session_speaks(run)) say_picture(job, given->outputs.items[0]);
  return result == LAVES_OK ? result : session_settle(run, result);
}

/* ---- plots ---- */

enum { PLOT_WIDTH = 480, PLOT_HEIGHT = 320 };

static laves_result read_plot(session *run, view_job *job) {
  static const char *const names[] = {"dihedral", "radius-ratio", "radius-edge", "all"};
  const settings *given = run->given;
  const char *path = given->outputs.items[0];
  const char *extension = strrchr(path, '.');
  const bool is_svg = extension && strcmp(extension, ".svg") == 0;
  if (!given->plot) {
    if (extension && strcasecmp(extension, ".png") == 0) return LAVES_OK;
    return session_fail(run, LAVES_ERROR_OPTION, "pictures are PNG files (.png), '%.200s' is none; SVG is for plots: --plot all",
                        path);
  }
  int which = 0;
  const laves_result chosen = choose(run, "plot", given->plot, names, 4, &which);
  if (chosen != LAVES_OK) return chosen;
  if (given->cut || given->worst > 0 || given->surface) {
    return session_fail(run, LAVES_ERROR_OPTION, "'--plot' counts the whole mesh: leave --cut, --worst and --surface out");
  }
  if (!is_svg) {
    return session_fail(run, LAVES_ERROR_OPTION, "plots are SVG files: --output FILE.svg, not '%.200s'", path);
  }
  job->plot_count = which < PLOT_MEASURES ? 1 : PLOT_MEASURES;
  for (int i = 0; i < job->plot_count; ++i) job->plots[i] = which < PLOT_MEASURES ? which : i;
  if (!given->pixels) {
    job->how.width = job->plot_count * PLOT_WIDTH;
    job->how.height = PLOT_HEIGHT;
  }
  return LAVES_OK;
}

static laves_result plot(session *run, const view_job *job) {
  const char *path = run->given->outputs.items[0];
  histogram shown[PLOT_MEASURES];
  const plot_style style = {.width = job->how.width,
                            .height = job->how.height,
                            .dark = job->how.background == PICTURE_DARK,
                            .transparent = job->how.background == PICTURE_TRANSPARENT};
  if (laves_mesh_tet_count(job->mesh) == 0) {
    return session_fail(run, LAVES_ERROR_INPUT, "there is nothing to draw: the mesh has no tetrahedra");
  }
  for (int i = 0; i < job->plot_count; ++i) shown[i] = histogram_count(job->mesh, (plot_measure)job->plots[i]);
  const bool written = plot_write(path, shown, job->plot_count, &style);
  laves_result result = written ? LAVES_OK : write_failed(run, path);
  result = session_settle(run, result);
  if (result == LAVES_OK && session_speaks(run)) {
    text_buffer tets;
    text_say("%s: %s of %s", path, job->plot_count > 1 ? "histograms" : "a histogram", text_plural(&tets, shown[0].tets, "tet"));
  }
  return result;
}

/* ---- the command ---- */

static laves_result view_steps(session *run, view_job *job) {
  const settings *given = run->given;
  if (given->outputs.count != 1) {
    return session_fail(run, LAVES_ERROR_OPTION,
                        "'laves view' needs one file to write: --output FILE.png, or FILE.svg with --plot");
  }
  laves_result result = outputs_check_text(run, given->outputs.items[0], given->input);
  if (result == LAVES_OK) result = read_words(run, &job->what, &job->how);
  if (result == LAVES_OK) result = read_numbers(run, &job->how);
  if (result == LAVES_OK) result = read_plot(run, job);
  if (result == LAVES_OK) result = laves_mesh_read(run->context, given->input, &job->mesh, &run->error);
  result = session_settle(run, result);
  if (result != LAVES_OK) return result;
  return job->plot_count > 0 ? plot(run, job) : draw(run, job);
}

int command_view(const settings *given) {
  session run;
  view_job job = {0};
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  const laves_result result = view_steps(&run, &job);
  scene_free(&job.shown);
  scene_free(&job.worst);
  free(job.worst_tets);
  free(job.worst_scores);
  laves_domain_free(job.surface.domain);
  laves_mesh_free(job.mesh);
  return session_close(&run, result);
}
