/* laves view MESH -o PICTURE.png: a picture of a mesh, whole or cut open. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"
#include "output.h"
#include "picture.h"
#include "png.h"
#include "session.h"
#include "text.h"

enum { WIDEST = 16384, CHANNELS = 4 };

/* The index of a word in a list, or -1. */
static int word_index(const char *word, const char *const *words, int count) {
  for (int i = 0; i < count; ++i) {
    if (strcmp(word, words[i]) == 0) return i;
  }
  return -1;
}

/* Degrees, as features are looked for by default. */
static const double crease_angle = 40;

static laves_result read_words(session *run, scene_options *what, picture_options *how) {
  static const char *const axes[] = {"x", "y", "z"};
  static const char *const colours[] = {"class", "dihedral", "quality", "size"};
  static const char *const backgrounds[] = {"white", "transparent", "dark"};
  const settings *given = run->given;
  const int up = word_index(given->up, axes, 3), colour = word_index(given->color, colours, 4);
  const int background = word_index(given->background, backgrounds, 3);
  if (up < 0) return session_fail(run, LAVES_ERROR_OPTION, "option '--up' must be x, y or z, not '%.30s'", given->up);
  if (colour < 0) {
    return session_fail(run, LAVES_ERROR_OPTION, "option '--color' must be class, dihedral, quality or size, not '%.30s'",
                        given->color);
  }
  if (background < 0) {
    return session_fail(run, LAVES_ERROR_OPTION, "option '--background' must be white, transparent or dark, not '%.30s'",
                        given->background);
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
  char rest;
  if (sscanf(given->view, "%lf,%lf%c", &how->azimuth, &how->elevation, &rest) != 2 || !isfinite(how->azimuth) ||
      !(fabs(how->elevation) <= 90)) {
    return session_fail(run, LAVES_ERROR_OPTION,
                        "option '--view' needs an azimuth and an elevation of -90 to 90 degrees such as 30,25, not '%.30s'",
                        given->view);
  }
  if (sscanf(given->pixels, "%5dx%5d%c", &how->width, &how->height, &rest) != 2 || how->width < 16 || how->height < 16 ||
      how->width > WIDEST || how->height > WIDEST) {
    return session_fail(run, LAVES_ERROR_OPTION, "option '--size' needs pixels such as 1200x900, 16 to %d each, not '%.30s'",
                        WIDEST, given->pixels);
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

static laves_result write_picture(session *run, const scene *shown, const picture_options *how, const char *path) {
  const bool clear = how->background == PICTURE_TRANSPARENT;
  const size_t count = (size_t)how->width * (size_t)how->height;
  uint8_t *pixels = malloc(CHANNELS * (count ? count : 1));
  if (!pixels || !picture_draw(shown, how, pixels)) {
    free(pixels);
    return session_fail(run, LAVES_ERROR_MEMORY, "no memory for a picture of %d by %d pixels", how->width, how->height);
  }
  for (size_t i = 0; !clear && i < count; ++i) memmove(pixels + 3 * i, pixels + CHANNELS * i, 3);
  const bool written = png_write(path, pixels, how->width, how->height, clear ? CHANNELS : 3);
  const int reason = errno;
  free(pixels);
  errno = reason;
  if (written) return LAVES_OK;
  if (errno == ENOMEM) return session_fail(run, LAVES_ERROR_MEMORY, "no memory to write the picture '%.200s'", path);
  return session_fail(run, LAVES_ERROR_WRITE, "cannot write '%.200s': %s", path, strerror(errno));
}

static laves_result draw(session *run, const laves_mesh *mesh, const scene_options *what, const picture_options *how) {
  const char *path = run->given->outputs.items[0];
  scene shown;
  laves_result result = LAVES_OK;
  if (!scene_build(mesh, what, &shown)) {
    result = session_fail(run, LAVES_ERROR_MEMORY, "no memory for the faces of the mesh");
  } else if (shown.face_count == 0) {
    result = session_fail(run, LAVES_ERROR_INPUT, "there is nothing to draw: %s",
                          what->cut ? "no tetrahedron lies wholly on the kept side of the plane" : "the mesh has no tetrahedra");
  } else {
    result = write_picture(run, &shown, how, path);
  }
  if (result == LAVES_OK && session_speaks(run)) {
    text_buffer faces, tets;
    char scale[80] = "";
    if (what->colour == SCENE_SIZE) {
      snprintf(scale, sizeof scale, ", edges %.3g (purple) .. %.3g (yellow)", shown.sizes[0], shown.sizes[1]);
    }
    text_say("%s: %s of %s, %d x %d pixels%s", path, text_plural(&faces, shown.face_count, "face"),
             text_plural(&tets, shown.kept_tets, "tet"), how->width, how->height, scale);
  }
  scene_free(&shown);
  return result == LAVES_OK ? result : session_settle(run, result);
}

static laves_result view_steps(session *run, laves_mesh **mesh) {
  scene_options what = {0};
  picture_options how = {0};
  if (run->given->outputs.count != 1) {
    return session_fail(run, LAVES_ERROR_OPTION, "'laves view' needs one picture to write: --output FILE.png");
  }
  laves_result result = outputs_check_text(run, run->given->outputs.items[0], run->given->input);
  if (result == LAVES_OK) result = read_words(run, &what, &how);
  if (result == LAVES_OK) result = read_numbers(run, &how);
  if (result == LAVES_OK) result = laves_mesh_read(run->context, run->given->input, mesh, &run->error);
  result = session_settle(run, result);
  if (result == LAVES_OK) result = read_cut(run, *mesh, &how, &what);
  return result == LAVES_OK ? draw(run, *mesh, &what, &how) : result;
}

int command_view(const settings *given) {
  session run;
  laves_mesh *mesh = NULL;
  if (!session_open(&run, given)) return laves_result_exit_code(LAVES_ERROR_MEMORY);
  const laves_result result = view_steps(&run, &mesh);
  laves_mesh_free(mesh);
  return session_close(&run, result);
}
