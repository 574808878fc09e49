/* Reading a triangle surface of any format: finds which one it is, from the content where that tells.
 *
 * Order matters. Gmsh and PLY have a signature. A binary STL is known by its length, which its own count must explain to the
 * byte: this comes before "solid", with which binary files begin as well, and no text can pass it by chance since four printable
 * bytes at 80 would mean a length of gigabytes. OFF and ASCII STL have a word to begin with, OBJ only its vocabulary.
 * When nothing fits, the extension says which reader shall explain what is wrong. */
#include <string.h>

#include "io/surface_build.h"

typedef struct surface_format {
  const char *extension;
  bool (*is_it)(laves__scan scan);
  laves_result (*read)(laves__surface_build *build);
} surface_format;

static const surface_format FORMATS[] = {
    {"msh", laves__is_gmsh, laves__read_gmsh_surface},     {"ply", laves__is_ply, laves__read_ply},
    {"stl", laves__is_stl_binary, laves__read_stl_binary}, {"off", laves__is_off, laves__read_off},
    {"stl", laves__is_stl_ascii, laves__read_stl_ascii},   {"obj", laves__is_obj, laves__read_obj},
};

static bool has_extension(const char *name, const char *extension) {
  const char *dot = name ? strrchr(name, '.') : NULL;
  return dot != NULL && laves__word_is((laves__word){dot + 1, strlen(dot + 1)}, extension);
}

static const surface_format *find_format(const laves__scan *scan) {
  for (size_t i = 0; i < LAVES__COUNT_OF(FORMATS); ++i) {
    if (FORMATS[i].is_it(*scan)) return &FORMATS[i];
  }
  for (size_t i = 0; i < LAVES__COUNT_OF(FORMATS); ++i) {
    if (has_extension(scan->name, FORMATS[i].extension)) return &FORMATS[i];
  }
  return NULL;
}

laves_result laves__surface_parse(laves_context *context, const void *bytes, size_t length, const char *name,
                                  laves__surface_input *input, laves_error *error) {
  *input = (laves__surface_input){0};
  laves__surface_build build = {
      .context = context, .input = input, .error = error, .scan = laves__scan_begin(name, bytes, length)};
  if (build.scan.at == build.scan.end) {
    return laves__fail(error, LAVES_ERROR_INPUT, "%s%sthe file is empty", name ? name : "", name ? ": " : "");
  }
  const surface_format *format = find_format(&build.scan);
  if (format == NULL) {
    return laves__fail(error, LAVES_ERROR_INPUT,
                       "%s%sthe content is no triangle surface that is known here; give STL, OBJ, PLY, OFF or Gmsh",
                       name ? name : "", name ? ": " : "");
  }
  return laves__build_finish(&build, format->read(&build));
}

void laves__surface_input_free_arrays(laves_context *context, laves__surface_input *input) {
  laves__free(context, input->tags, input->triangle_capacity, sizeof *input->tags);
  laves__free(context, input->sources, input->triangle_capacity, sizeof *input->sources);
  laves__free(context, input->points, input->point_capacity, sizeof *input->points);
  laves__free(context, input->triangles, input->triangle_capacity, sizeof *input->triangles);
  input->tags = NULL;
  input->sources = NULL;
  input->points = NULL;
  input->triangles = NULL;
  input->point_capacity = input->triangle_capacity = 0;
}

void laves__surface_input_free(laves_context *context, laves__surface_input *input) {
  if (input == NULL) return;
  for (int i = 0; i < input->tag_count; ++i) {
    laves__free(context, input->tag_names[i], strlen(input->tag_names[i]) + 1, 1);
  }
  laves__free(context, input->tag_names, (size_t)input->tag_count, sizeof *input->tag_names);
  laves__surface_input_free_arrays(context, input);
  *input = (laves__surface_input){0};
}
