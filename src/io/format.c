/* Formats by name and extension. */
#include <string.h>
#include <strings.h>

#include "base/base.h"

static const char *const names[LAVES_FORMAT_COUNT] = {
    [LAVES_FORMAT_AUTO] = "auto",     [LAVES_FORMAT_VTU] = "vtu",     [LAVES_FORMAT_GMSH22] = "gmsh22",
    [LAVES_FORMAT_GMSH41] = "gmsh41", [LAVES_FORMAT_MEDIT] = "medit", [LAVES_FORMAT_TETGEN] = "tetgen",
    [LAVES_FORMAT_STL] = "stl",       [LAVES_FORMAT_OBJ] = "obj",     [LAVES_FORMAT_PLY] = "ply",
    [LAVES_FORMAT_OFF] = "off",
};

static const struct {
  const char *extension;
  laves_format format;
} extensions[] = {
    {"vtu", LAVES_FORMAT_VTU},     {"msh", LAVES_FORMAT_GMSH41}, {"mesh", LAVES_FORMAT_MEDIT},  {"meshb", LAVES_FORMAT_MEDIT},
    {"node", LAVES_FORMAT_TETGEN}, {"ele", LAVES_FORMAT_TETGEN}, {"face", LAVES_FORMAT_TETGEN}, {"stl", LAVES_FORMAT_STL},
    {"obj", LAVES_FORMAT_OBJ},     {"ply", LAVES_FORMAT_PLY},    {"off", LAVES_FORMAT_OFF},
};

const char *laves_format_name(laves_format format) { return (unsigned)format < LAVES_FORMAT_COUNT ? names[format] : NULL; }

laves_format laves_format_from_name(const char *name) {
  for (int i = 0; name && i < LAVES_FORMAT_COUNT; i++)
    if (strcasecmp(name, names[i]) == 0) return (laves_format)i;
  return LAVES_FORMAT_COUNT;
}

bool laves_format_streams(laves_format format) {
  return format == LAVES_FORMAT_VTU || format == LAVES_FORMAT_GMSH22 || format == LAVES_FORMAT_GMSH41;
}

laves_format laves_format_from_path(const char *path) {
  const char *dot = path ? strrchr(path, '.') : NULL;
  for (size_t i = 0; dot && i < LAVES__COUNT_OF(extensions); i++)
    if (strcasecmp(dot + 1, extensions[i].extension) == 0) return extensions[i].format;
  return LAVES_FORMAT_COUNT;
}
