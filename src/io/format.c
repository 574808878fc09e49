/* Formats by name and extension. */
#include <string.h>
#include <strings.h>

#include "base/base.h"

static const char *const names[LAVES_FORMAT_COUNT] = {
    [LAVES_FORMAT_AUTO] = "auto",     [LAVES_FORMAT_VTU] = "vtu",       [LAVES_FORMAT_GMSH22] = "gmsh22",
    [LAVES_FORMAT_GMSH41] = "gmsh41", [LAVES_FORMAT_MEDIT] = "medit",   [LAVES_FORMAT_TETGEN] = "tetgen",
    [LAVES_FORMAT_VTKHDF] = "vtkhdf", [LAVES_FORMAT_VTK] = "vtk",       [LAVES_FORMAT_XDMF] = "xdmf",
    [LAVES_FORMAT_EXODUS] = "exodus", [LAVES_FORMAT_ABAQUS] = "abaqus", [LAVES_FORMAT_NASTRAN] = "nastran",
    [LAVES_FORMAT_NPZ] = "npz",       [LAVES_FORMAT_DMTET] = "dmtet",   [LAVES_FORMAT_STL] = "stl",
    [LAVES_FORMAT_OBJ] = "obj",       [LAVES_FORMAT_PLY] = "ply",       [LAVES_FORMAT_OFF] = "off",
};

static const struct {
  const char *extension;
  laves_format format;
} extensions[] = {
    {"vtu", LAVES_FORMAT_VTU},       {"msh", LAVES_FORMAT_GMSH41},  {"mesh", LAVES_FORMAT_MEDIT},  {"meshb", LAVES_FORMAT_MEDIT},
    {"vtkhdf", LAVES_FORMAT_VTKHDF}, {"hdf", LAVES_FORMAT_VTKHDF},  {"vtk", LAVES_FORMAT_VTK},     {"xdmf", LAVES_FORMAT_XDMF},
    {"xmf", LAVES_FORMAT_XDMF},      {"exo", LAVES_FORMAT_EXODUS},  {"ex2", LAVES_FORMAT_EXODUS},  {"e", LAVES_FORMAT_EXODUS},
    {"inp", LAVES_FORMAT_ABAQUS},    {"bdf", LAVES_FORMAT_NASTRAN}, {"nas", LAVES_FORMAT_NASTRAN}, {"npz", LAVES_FORMAT_NPZ},
    {"node", LAVES_FORMAT_TETGEN},   {"ele", LAVES_FORMAT_TETGEN},  {"face", LAVES_FORMAT_TETGEN}, {"stl", LAVES_FORMAT_STL},
    {"obj", LAVES_FORMAT_OBJ},       {"ply", LAVES_FORMAT_PLY},     {"off", LAVES_FORMAT_OFF},
};

const char *laves_format_name(laves_format format) { return (unsigned)format < LAVES_FORMAT_COUNT ? names[format] : NULL; }

laves_format laves_format_from_name(const char *name) {
  for (int i = 0; name && i < LAVES_FORMAT_COUNT; i++)
    if (strcasecmp(name, names[i]) == 0) return (laves_format)i;
  return LAVES_FORMAT_COUNT;
}

bool laves_format_streams(laves_format format) {
  switch (format) {
    case LAVES_FORMAT_VTU:
    case LAVES_FORMAT_GMSH22:
    case LAVES_FORMAT_GMSH41:
    case LAVES_FORMAT_VTKHDF:
    case LAVES_FORMAT_VTK:
    case LAVES_FORMAT_XDMF:
    case LAVES_FORMAT_NPZ:
      return true;
    default:
      return false;
  }
}

bool laves_format_is_quadratic(laves_format format) {
  return laves_format_streams(format) || format == LAVES_FORMAT_EXODUS || format == LAVES_FORMAT_ABAQUS ||
         format == LAVES_FORMAT_NASTRAN || format == LAVES_FORMAT_MEDIT;
}

laves_format laves_format_from_path(const char *path) {
  const char *dot = path ? strrchr(path, '.') : NULL;
  for (size_t i = 0; dot && i < LAVES__COUNT_OF(extensions); i++)
    if (strcasecmp(dot + 1, extensions[i].extension) == 0) return extensions[i].format;
  return LAVES_FORMAT_COUNT;
}
