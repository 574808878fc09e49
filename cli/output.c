/* Where a mesh goes.  A missing folder or an unknown extension is found before meshing, not after an hour of it. */
#include "output.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "text.h"

static laves_result check_folder(session *run, const char *path) {
  char folder[PATH_CAPACITY] = ".";
  const char *slash = strrchr(path, '/');
  if (slash) snprintf(folder, sizeof folder, "%.*s", slash == path ? 1 : (int)(slash - path), path);
  struct stat status;
  if (stat(folder, &status) != 0) {
    return session_fail(run, LAVES_ERROR_WRITE, "cannot write '%.200s': there is no folder '%.200s'", path, folder);
  }
  if (!S_ISDIR(status.st_mode)) {
    return session_fail(run, LAVES_ERROR_WRITE, "cannot write '%.200s': '%.200s' is not a folder", path, folder);
  }
  if (access(folder, W_OK | X_OK) != 0) {
    return session_fail(run, LAVES_ERROR_WRITE, "cannot write '%.200s': no permission to write in '%.200s'", path, folder);
  }
  return LAVES_OK;
}

static bool is_same_file(const char *path, const struct stat *target) {
  struct stat status;
  return path && stat(path, &status) == 0 && status.st_dev == target->st_dev && status.st_ino == target->st_ino;
}

static bool is_among(const option_texts *list, const struct stat *target) {
  for (int i = 0; i < list->count; ++i) {
    if (is_same_file(list->items[i], target)) return true;
  }
  return false;
}

/* Whether an output, under whatever name, is a file that the command reads. */
static bool is_input(const session *run, const char *source, const struct stat *target) {
  const settings *given = run->given;
  return is_same_file(source, target) || is_same_file(given->job_path, target) || is_same_file(given->surface, target) ||
         is_among(&given->size_fields, target) || is_among(&given->features, target);
}

static bool stat_folder(const char *path, struct stat *status) {
  char folder[PATH_CAPACITY] = ".";
  const int length = (int)(text_base_name(path) - path);
  if (length >= PATH_CAPACITY) return false;
  if (length > 0) snprintf(folder, sizeof folder, "%.*s", length, path);
  return stat(folder, status) == 0;
}

/* Whether two outputs would be one file: one that is there, or the same name in the same folder. */
static bool is_same_place(const char *a, const char *b) {
  struct stat first, second;
  if (strcmp(a, b) == 0) return true;
  if (stat(a, &first) == 0) return S_ISREG(first.st_mode) && is_same_file(b, &first);
  if (stat(b, &second) == 0 || strcmp(text_base_name(a), text_base_name(b)) != 0) return false;
  return stat_folder(a, &first) && stat_folder(b, &second) && first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

/* Meshes are renamed into place, which must not replace a device; JSON may go to one. */
static laves_result check_target(session *run, const char *path, const char *source, bool may_be_device) {
  if (strlen(path) + 16 > PATH_CAPACITY) return session_fail(run, LAVES_ERROR_WRITE, "the name of an output file is too long");
  struct stat target;
  if (stat(path, &target) != 0) return check_folder(run, path);
  if (S_ISDIR(target.st_mode)) return session_fail(run, LAVES_ERROR_WRITE, "cannot write '%.200s': it is a folder", path);
  if (!S_ISREG(target.st_mode)) {
    if (may_be_device) return LAVES_OK;
    return session_fail(run, LAVES_ERROR_WRITE, "cannot write '%.200s': it is not an ordinary file", path);
  }
  if (is_input(run, source, &target)) {
    return session_fail(run, LAVES_ERROR_OPTION, "'%.200s' is the input and would be overwritten; name another file", path);
  }
  return check_folder(run, path);
}

static laves_result add(session *run, const char *path, bool surface_only, outputs *plan) {
  const laves_format asked = surface_only ? LAVES_FORMAT_AUTO : run->given->format;
  const laves_format format = asked != LAVES_FORMAT_AUTO ? asked : laves_format_from_path(path);
  if (strcmp(path, "-") == 0) {
    return session_fail(run, LAVES_ERROR_OPTION, "a mesh cannot go to the standard output; name a file");
  }
  if (format == LAVES_FORMAT_COUNT) {
    return session_fail(
        run, LAVES_ERROR_OPTION, "the extension of '%.200s' is no format known; use %s", path,
        surface_only ? ".stl, .obj, .ply or .off" : ".vtu, .msh, .mesh or another of docs/formats.md, or --format");
  }
  if (surface_only && format < LAVES_FORMAT_STL) {
    return session_fail(run, LAVES_ERROR_OPTION, "'--boundary' writes a surface: .stl, .obj, .ply or .off, not '%.200s'", path);
  }
  if (run->given->stream && !laves_format_streams(format)) {
    return session_fail(run, LAVES_ERROR_OPTION,
                        "'%.200s' cannot be streamed: %s files need the mesh in memory; use .vtu or .msh, or leave --stream away",
                        path, laves_format_name(format));
  }
  if (run->given->order == 2 && !laves_format_is_quadratic(format)) {
    return session_fail(
        run, LAVES_ERROR_OPTION,
        "'%.200s' cannot be of order 2: %s files of ours have no elements of second order; docs/quadratic.md lists "
        "those that have",
        path, laves_format_name(format));
  }
  for (int i = 0; i < plan->count; ++i) {
    if (is_same_place(plan->items[i].path, path)) return session_fail(run, LAVES_ERROR_OPTION, "'%.200s' is named twice", path);
  }
  if (run->given->json && is_same_place(run->given->json, path)) {
    run->json_refused = true; /* it must not take the place of what is there */
    return session_fail(run, LAVES_ERROR_OPTION, "'%.200s' is named twice", path);
  }
  plan->items[plan->count++] = (output){.path = path, .format = format};
  return LAVES_OK;
}

laves_result outputs_check_text(session *run, const char *path, const char *source) {
  return check_target(run, path, source, true);
}

/* The mesh's name with another extension, such as ".certificate.json". */
static bool name_beside(const char *mesh, const char *extension, char *path, size_t size) {
  const char *base = text_base_name(mesh), *dot = strrchr(base, '.');
  const size_t stem = dot && dot != base ? (size_t)(dot - mesh) : strlen(mesh);
  const int length = snprintf(path, size, "%.*s%s", (int)stem, mesh, extension);
  return length > 0 && (size_t)length < size;
}

laves_result outputs_plan_certificate(session *run, const char *source, outputs *plan) {
  const char *asked = run->given->certificate;
  if (plan->count == 0 || (asked && strcmp(asked, "none") == 0)) return LAVES_OK;
  if (run->given->stream) {
    if (!asked) return LAVES_OK;
    return session_fail(run, LAVES_ERROR_OPTION,
                        "a certificate needs the mesh in memory; leave --certificate away, and say 'laves check --stream' of the "
                        "file, or leave --stream away");
  }
  const size_t size = sizeof plan->certificate;
  if (asked ? (size_t)snprintf(plan->certificate, size, "%s", asked) >= size
            : !name_beside(plan->items[0].path, ".certificate.json", plan->certificate, size)) {
    return session_fail(run, LAVES_ERROR_WRITE, "the name of the certificate is too long");
  }
  for (int i = 0; i < plan->count; ++i) {
    if (is_same_place(plan->items[i].path, plan->certificate)) {
      return session_fail(run, LAVES_ERROR_OPTION, "'%.200s' is named twice", plan->certificate);
    }
  }
  if (run->given->json && is_same_place(run->given->json, plan->certificate)) {
    return session_fail(run, LAVES_ERROR_OPTION, "'%.200s' is named twice", plan->certificate);
  }
  return check_target(run, plan->certificate, source, true);
}

laves_result outputs_plan_report(session *run, const char *source, outputs *plan) {
  const char *asked = run->given->report, *path = plan->report;
  if (!asked) return LAVES_OK;
  if (run->given->stream)
    return session_fail(run, LAVES_ERROR_OPTION, "a report needs the mesh in memory; leave --report away, or --stream");
  const size_t size = sizeof plan->report;
  if (strcmp(asked, "auto") != 0 ? (size_t)snprintf(plan->report, size, "%s", asked) >= size
                                 : !name_beside(plan->items[0].path, ".html", plan->report, size)) {
    return session_fail(run, LAVES_ERROR_WRITE, "the name of the report is too long");
  }
  const laves_result page = outputs_check_page(run, path);
  if (page != LAVES_OK) return page;
  run->json_refused = run->given->json && is_same_place(run->given->json, path); /* it must not take the place of what is there */
  bool twice = run->json_refused || is_same_place(plan->certificate, path) ||
               (run->given->defects && is_same_place(run->given->defects, path));
  for (int i = 0; i < plan->count; ++i) twice = twice || is_same_place(plan->items[i].path, path);
  if (twice) return session_fail(run, LAVES_ERROR_OPTION, "'%.200s' is named twice", path);
  return check_target(run, path, source, true);
}

laves_result outputs_check_page(session *run, const char *path) {
  const char *extension = strrchr(path, '.');
  if (extension && (strcasecmp(extension, ".html") == 0 || strcasecmp(extension, ".htm") == 0)) return LAVES_OK;
  return session_fail(run, LAVES_ERROR_OPTION, "a report is an HTML page (.html), '%.200s' is none", path);
}

/* Of what goes beside the mesh: --defects, which may not be the input or a device, and --json. */
laves_result outputs_check_json(session *run, const char *source) {
  const char *path = run->given->json;
  if (run->given->defects) {
    const laves_result result = check_target(run, run->given->defects, source, false);
    if (result != LAVES_OK) return result;
  }
  if (!path || strcmp(path, "-") == 0) return LAVES_OK;
  const laves_result result = check_target(run, path, source, true);
  run->json_refused = result != LAVES_OK;
  return result;
}

laves_result outputs_plan(session *run, const char *fallback, const char *source, outputs *plan) {
  *plan = (outputs){0};
  const option_texts *named = &run->given->outputs;
  laves_result result = outputs_check_json(run, source);
  for (int i = 0; result == LAVES_OK && i < named->count; ++i) result = add(run, named->items[i], false, plan);
  if (named->count == 0 && fallback) result = add(run, fallback, false, plan);
  if (result == LAVES_OK && run->given->boundary) result = add(run, run->given->boundary, true, plan);
  for (int i = 0; result == LAVES_OK && i < plan->count; ++i) result = check_target(run, plan->items[i].path, source, false);
  return result;
}

static double file_bytes(const char *path) {
  struct stat status;
  return stat(path, &status) == 0 ? (double)status.st_size : 0;
}

/* XDMF's arrays are beside it. */
static double written_bytes_xdmf(const char *path) {
  const char *dot = strrchr(path, '.');
  const bool known = dot && (strcasecmp(dot, ".xdmf") == 0 || strcasecmp(dot, ".xmf") == 0);
  char data[PATH_CAPACITY + 8];
  snprintf(data, sizeof data, "%.*s.h5", known ? (int)(dot - path) : (int)strlen(path), path);
  return file_bytes(path) + file_bytes(data);
}

/* TetGen's three files share a base name. */
static double written_bytes(const output *item) {
  if (item->format == LAVES_FORMAT_XDMF) return written_bytes_xdmf(item->path);
  if (item->format != LAVES_FORMAT_TETGEN) return file_bytes(item->path);
  static const char *const extensions[] = {".node", ".ele", ".face"};
  const char *dot = strrchr(item->path, '.');
  int base = (int)strlen(item->path);
  for (int i = 0; dot && i < 3; ++i) {
    if (strcmp(dot, extensions[i]) == 0) base = (int)(dot - item->path);
  }
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    char path[PATH_CAPACITY + 8];
    snprintf(path, sizeof path, "%.*s%s", base, item->path, extensions[i]);
    sum += file_bytes(path);
  }
  return sum;
}

laves_result outputs_write(session *run, const laves_mesh *mesh, const laves_certificate *certificate, outputs *plan) {
  const double start = progress_now();
  laves_result result = LAVES_OK;
  for (int i = 0; result == LAVES_OK && i < plan->count; ++i) {
    output *item = &plan->items[i];
    laves_write_options options = laves_write_options_default();
    options.format = item->format;
    options.ascii = run->given->ascii;
    options.compression = (int)run->given->compress;
    result = session_settle(run, LAVES_OK);
    if (result == LAVES_OK) result = laves_mesh_write(run->context, mesh, item->path, &options, &run->error);
    progress_clear(&run->bar);
    if (result == LAVES_OK) item->bytes = written_bytes(item);
  }
  if (result == LAVES_OK && certificate && plan->certificate[0]) {
    result = laves_certificate_write(run->context, certificate, plan->certificate, &run->error);
    progress_clear(&run->bar);
    if (result == LAVES_OK) plan->certificate_bytes = file_bytes(plan->certificate);
  }
  plan->seconds = progress_now() - start;
  return result;
}

void outputs_say(const outputs *plan) {
  for (int i = 0; i < plan->count; ++i) {
    text_buffer bytes;
    text_say("wrote %s (%s, %s)", plan->items[i].path, laves_format_name(plan->items[i].format),
             text_bytes(&bytes, plan->items[i].bytes));
  }
  if (plan->certificate_bytes > 0) text_say("wrote %s", plan->certificate);
}

void outputs_write_json(json *out, const outputs *plan) {
  json_open_array(out, "outputs");
  for (int i = 0; i < plan->count; ++i) {
    if (plan->items[i].bytes == 0) continue;
    json_open_object(out, NULL);
    json_text(out, "path", plan->items[i].path);
    json_text(out, "format", laves_format_name(plan->items[i].format));
    json_number(out, "bytes", plan->items[i].bytes);
    json_close(out);
  }
  json_close(out);
}
