/* Writes a mesh in any format: chooses the format, opens the file or files, calls the format's writer, and publishes. */
#include "io/write_mesh.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static const uint32_t write_cookie = 0x77726974;

laves_write_options laves_write_options_default(void) { return (laves_write_options){.compression = 1, .cookie = write_cookie}; }

static bool has_extension(const char *path, const char *extension) {
  const size_t length = strlen(path), tail = strlen(extension);
  return length >= tail && strcasecmp(path + length - tail, extension) == 0;
}

static void write_content(laves__output *out, const laves_mesh *mesh, const char *path, laves_format format,
                          const laves_write_options *options) {
  const bool ascii = options->ascii;
  switch (format) {
    case LAVES_FORMAT_VTU:
      laves__write_vtu(out, mesh, ascii, options->compression);
      break;
    case LAVES_FORMAT_GMSH22:
      laves__write_gmsh22(out, mesh, ascii);
      break;
    case LAVES_FORMAT_GMSH41:
      laves__write_gmsh41(out, mesh, ascii);
      break;
    case LAVES_FORMAT_MEDIT: /* programs tell the two apart by the extension */
      (has_extension(path, ".meshb") ? laves__write_medit_binary : laves__write_medit_text)(out, mesh);
      break;
    case LAVES_FORMAT_VTKHDF:
      laves__write_vtkhdf(out, mesh);
      break;
    case LAVES_FORMAT_VTK:
      laves__write_vtk(out, mesh, ascii);
      break;
    case LAVES_FORMAT_EXODUS:
      laves__write_exodus(out, mesh);
      break;
    case LAVES_FORMAT_ABAQUS:
      laves__write_abaqus(out, mesh);
      break;
    case LAVES_FORMAT_NASTRAN:
      laves__write_nastran(out, mesh);
      break;
    case LAVES_FORMAT_NPZ:
      laves__write_npz(out, mesh);
      break;
    case LAVES_FORMAT_DMTET:
      laves__write_dmtet(out, mesh);
      break;
    case LAVES_FORMAT_STL:
      (ascii ? laves__write_stl_text : laves__write_stl_binary)(out, mesh);
      break;
    case LAVES_FORMAT_OBJ:
      laves__write_obj(out, mesh);
      break;
    case LAVES_FORMAT_PLY:
      laves__write_ply(out, mesh, ascii);
      break;
    case LAVES_FORMAT_OFF:
      laves__write_off(out, mesh);
      break;
    default:
      laves__output_fail(out, LAVES_ERROR_OPTION, "there is no format number %d", (int)format);
  }
}

static laves_result finish(laves__output *out, laves_error *error) {
  const laves_result result = out->error.result;
  laves__output_discard(out);
  return result == LAVES_OK ? LAVES_OK : laves__fail(error, result, "%s", out->error.text);
}

static laves_result write_one(laves_context *context, const laves_mesh *mesh, const char *path, laves_format format,
                              const laves_write_options *options, laves_error *error) {
  laves__output out;
  if (laves__output_open(&out, context, path) == LAVES_OK) {
    write_content(&out, mesh, path, format, options);
    if (laves__output_complete(&out) == LAVES_OK) laves__output_publish(&out);
  }
  return finish(&out, error);
}

/* All three files are complete before the first is renamed, and all are renamed or none. */
static laves_result write_tetgen(laves_context *context, const laves_mesh *mesh, const char *path, laves_error *error) {
  static const char *const endings[] = {".node", ".ele", ".face"};
  static void (*const writers[])(laves__output *, const laves_mesh *) = {laves__write_tetgen_node, laves__write_tetgen_ele,
                                                                         laves__write_tetgen_face};
  enum { FILES = LAVES__COUNT_OF(endings) };
  laves__output outs[FILES];
  int stem = (int)strlen(path);
  for (int i = 0; i < FILES; i++)
    if (has_extension(path, endings[i])) stem = (int)(strlen(path) - strlen(endings[i]));
  laves_result result = LAVES_OK;
  int opened = 0;
  for (; opened < FILES && result == LAVES_OK; opened++) {
    laves__output *out = &outs[opened];
    char name[PATH_MAX];
    snprintf(name, sizeof name, "%.*s%s", stem, path, endings[opened]);
    if (laves__output_open(out, context, name) == LAVES_OK) writers[opened](out, mesh);
    result = laves__output_complete(out);
  }
  if (result == LAVES_OK) result = laves__output_publish_all(outs, FILES);
  for (int i = 0; i < opened; i++) finish(&outs[i], error);
  return result;
}

/* The XML, and the arrays beside it: both are complete before the first is renamed, and both are renamed or none. */
static laves_result write_xdmf(laves_context *context, const laves_mesh *mesh, const char *path, laves_error *error) {
  const char *dot = has_extension(path, ".xdmf") || has_extension(path, ".xmf") ? strrchr(path, '.') : path + strlen(path);
  char data[PATH_MAX];
  if (snprintf(data, sizeof data, "%.*s.h5", (int)(dot - path), path) >= (int)sizeof data)
    return laves__fail(error, LAVES_ERROR_WRITE, "cannot write: the file name is longer than %d bytes", PATH_MAX - 1);
  const char *slash = strrchr(data, '/');
  laves__output outs[2];
  laves_result result = laves__output_open(&outs[0], context, data);
  if (result == LAVES_OK) laves__write_xdmf_data(&outs[0], mesh);
  result = laves__output_complete(&outs[0]);
  const int opened = result == LAVES_OK ? 2 : 1;
  if (opened == 2) {
    if (laves__output_open(&outs[1], context, path) == LAVES_OK) laves__write_xdmf(&outs[1], mesh, slash ? slash + 1 : data);
    result = laves__output_complete(&outs[1]);
  }
  if (result == LAVES_OK) result = laves__output_publish_all(outs, 2);
  for (int i = 0; i < opened; i++) finish(&outs[i], error);
  return result;
}

static laves_result check_options(const laves_write_options *options, laves_error *error) {
  if (options->cookie != write_cookie)
    return laves__fail(error, LAVES_ERROR_OPTION, "the write options do not come from laves_write_options_default()");
  if (options->compression < 0 || options->compression > 9)
    return laves__fail(error, LAVES_ERROR_OPTION, "the compression is %d; it must be from 0 (none) to 9 (smallest)",
                       options->compression);
  return LAVES_OK;
}

/* A mesh of second order with all its nodes as vertices, for the writers. */
static laves_mesh with_nodes(const laves_mesh *mesh) {
  laves_mesh view = *mesh;
  if (!mesh->quadratic) return view;
  view.vertex_count = mesh->quadratic->node_count;
  view.points = mesh->quadratic->points;
  return view;
}

laves_result laves_mesh_write(laves_context *context, const laves_mesh *mesh, const char *path,
                              const laves_write_options *options, laves_error *error) {
  const laves_write_options defaults = laves_write_options_default();
  if (!options) options = &defaults;
  const laves_result checked = check_options(options, error);
  if (checked != LAVES_OK) return checked;
  const laves_format format = options->format == LAVES_FORMAT_AUTO ? laves_format_from_path(path) : options->format;
  if (format == LAVES_FORMAT_COUNT)
    return laves__fail(
        error, LAVES_ERROR_OPTION,
        "the name '%s' does not say in which format to write; end it in .vtu, .msh, .mesh, .meshb, .node, .vtkhdf, .vtk, "
        ".xdmf, .exo, .inp, .bdf, .npz, .stl, .obj, .ply or .off, or name a format",
        path);
  const laves_result held = laves_format_streams(format) ? LAVES_OK : laves__mesh_require_arrays(mesh, "this format", error);
  if (held != LAVES_OK) return held;
  if (mesh->quadratic && !laves_format_is_quadratic(format))
    return laves__fail(error, LAVES_ERROR_OPTION,
                       "cannot write '%s': %s files of ours have no elements of second order; choose VTU, Gmsh, Medit, Abaqus, "
                       "Exodus, Nastran, VTKHDF, VTK, XDMF or NPZ",
                       path, laves_format_name(format));
  laves__progress_reset(context);
  const laves_mesh nodes = with_nodes(mesh);
  if (format == LAVES_FORMAT_TETGEN) return write_tetgen(context, &nodes, path, error);
  if (format == LAVES_FORMAT_XDMF) return write_xdmf(context, &nodes, path, error);
  return write_one(context, &nodes, path, format, options, error);
}
