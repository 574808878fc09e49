/* Reads a tetrahedral mesh of any program: finds the format from the content (TetGen's from the name, since its files are
 * bare numbers), calls the format's reader and makes the mesh. */
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "io/file.h"
#include "io/mesh_input.h"
#include "io/scan.h"
#include "io/vtu.h"

typedef laves_result read_fn(laves__mesh_input *input, laves_error *error);

/* The length of the path without TetGen's ending, or 0 when it has none. */
static size_t tetgen_stem(const char *path) {
  static const char *const endings[] = {".node", ".ele", ".face"};
  const size_t length = strlen(path);
  for (size_t i = 0; i < LAVES__COUNT_OF(endings); i++) {
    const size_t ending = strlen(endings[i]);
    if (length > ending && strcasecmp(path + length - ending, endings[i]) == 0) return length - ending;
  }
  return 0;
}

static bool is_medit_binary(const laves__mesh_input *input) {
  static const char little[] = {1, 0, 0, 0}, big[] = {0, 0, 0, 1};
  if (input->end - input->begin < 8) return false;
  return memcmp(input->begin, little, 4) == 0 || memcmp(input->begin, big, 4) == 0;
}

/* A line near the begin is one of the cards that come first in Abaqus's files; a file of one that begins with much else has its
 * name. */
static bool is_abaqus(const laves__mesh_input *input) {
  static const char *const cards[] = {"*NODE", "*Node", "*node", "*HEADING", "*Heading", "*heading", "*PART", "*Part", "*part"};
  for (size_t i = 0; i < LAVES__COUNT_OF(cards); i++)
    if (laves__mesh_input_mentions(input, cards[i])) return true;
  const char *dot = strrchr(input->name, '.');
  return dot && strcasecmp(dot, ".inp") == 0;
}

static read_fn *find_reader(const laves__mesh_input *input) {
  if (is_medit_binary(input)) return laves__read_medit_binary;
  if (laves__is_vtu(input)) return laves__read_vtu;
  if (laves__mesh_input_mentions(input, "$MeshFormat")) return laves__read_gmsh;
  if (laves__mesh_input_mentions(input, "MeshVersionFormatted")) return laves__read_medit_text;
  if (laves__mesh_input_mentions(input, "# vtk DataFile")) return laves__read_vtk;
  if (is_abaqus(input)) return laves__read_abaqus;
  return NULL;
}

/* What a file is that no reader takes, by its first bytes or its name. */
static laves_result fail_unknown(const laves__mesh_input *input, laves_error *error) {
  static const struct {
    const char *begin;
    size_t length;
    const char *what;
  } kinds[] = {{"\211HDF", 4, "HDF5, as VTKHDF and XDMF are"},
               {"CDF", 3, "NetCDF, as Exodus is"},
               {"PK\003\004", 4, "a zip archive, as NPZ is"}};
  static const char *const surfaces[] = {".stl", ".obj", ".ply", ".off"};
  const size_t length = (size_t)(input->end - input->begin);
  const char *dot = strrchr(input->name, '.');
  for (size_t i = 0; i < LAVES__COUNT_OF(kinds); i++)
    if (length >= kinds[i].length && memcmp(input->begin, kinds[i].begin, kinds[i].length) == 0)
      return laves__mesh_input_fail(input, error, "it is %s, which is only written; keep a VTU beside it to read", kinds[i].what);
  for (size_t i = 0; dot && i < LAVES__COUNT_OF(surfaces); i++)
    if (strcasecmp(dot, surfaces[i]) == 0)
      return laves__mesh_input_fail(input, error, "it is a surface by its name, not a tetrahedral mesh: `laves mesh` fills it");
  return laves__mesh_input_fail(
      input, error,
      "it is not a tetrahedral mesh of a format that is known (VTU, legacy VTK, Gmsh, Medit, Abaqus; TetGen by .node or .ele)");
}

typedef laves_result load_fn(laves_context *context, const char *path, char **bytes, size_t *length, laves_error *error);

/* Loads a file into the input's begin and end; free with close_file(). */
static laves_result open_file(laves__mesh_input *input, const char *path, load_fn *load, laves_error *error) {
  char *bytes;
  size_t length;
  const laves_result result = load(input->context, path, &bytes, &length, error);
  if (result != LAVES_OK) return result;
  input->name = path;
  input->begin = bytes;
  input->end = bytes + length;
  return LAVES_OK;
}

static void close_file(laves__mesh_input *input) {
  laves__free(input->context, (char *)input->begin, (size_t)(input->end - input->begin) + 1, 1);
  input->begin = input->end = NULL;
}

/* One file of the three; a missing .face is no fault. */
static laves_result read_part(laves__mesh_input *input, const char *path, int part, int64_t *base, laves_error *error) {
  static const char *const endings[] = {"node", "ele", "face"};
  char name[PATH_MAX];
  const int length = snprintf(name, sizeof name, "%.*s.%s", (int)tetgen_stem(path), path, endings[part]);
  if (length >= (int)sizeof name) return laves__fail(error, LAVES_ERROR_INPUT, "the file name is too long");
  laves_error ignored;
  laves_result result = open_file(input, name, laves__file_read, part == 2 ? &ignored : error);
  if (result == LAVES_ERROR_INPUT && part == 2) return LAVES_OK;
  if (result == LAVES_ERROR_MEMORY) return laves__fail_memory(input->context, error);
  if (result != LAVES_OK) return result;
  if (part == 0)
    result = laves__read_tetgen_node(input, base, error);
  else
    result = (part == 1 ? laves__read_tetgen_ele : laves__read_tetgen_face)(input, *base, error);
  close_file(input);
  input->name = path;
  return result;
}

static laves_result read_tetgen(laves__mesh_input *input, const char *path, laves_error *error) {
  int64_t base = 0;
  laves_result result = LAVES_OK;
  for (int part = 0; part < 3 && result == LAVES_OK; part++) result = read_part(input, path, part, &base, error);
  return result;
}

static laves_result read_one(laves__mesh_input *input, const char *path, laves_error *error) {
  laves_result result = open_file(input, path, laves__input_read, error);
  if (result != LAVES_OK) return result;
  read_fn *read = find_reader(input);
  result = read ? read(input, error) : fail_unknown(input, error);
  close_file(input);
  return result;
}

laves_result laves_mesh_read(laves_context *context, const char *path, laves_mesh **mesh, laves_error *error) {
  *mesh = NULL;
  laves__progress_reset(context);
  laves__mesh_input input = {.context = context, .name = path};
  laves_result result = tetgen_stem(path) ? read_tetgen(&input, path, error) : read_one(&input, path, error);
  if (result == LAVES_OK) result = laves__mesh_input_finish(&input, mesh, error);
  laves__mesh_input_free(&input);
  return result;
}
