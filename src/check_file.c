/* The check of a mesh that stays in its file: where its reader and its check meet. */
#include "certify/check_stream.h"
#include "io/vtu_ranges.h"

static const uint32_t file_check_cookie = 0x66696c65;

static const size_t usual_cache_bytes = (size_t)256 << 20;

laves_file_check_options laves_file_check_options_default(void) {
  const laves_options usual = laves_options_default();
  return (laves_file_check_options){.min_dihedral = usual.min_dihedral,
                                    .max_dihedral = usual.max_dihedral,
                                    .volume_length = usual.volume_length,
                                    .cache_bytes = usual_cache_bytes,
                                    .cookie = file_check_cookie};
}

static laves_result refuse(const laves_file_check_options *o, laves_error *error) {
  if (o->cookie != file_check_cookie)
    return laves__fail(error, LAVES_ERROR_OPTION, "options must come from laves_file_check_options_default()");
  if (!(o->min_dihedral >= 0 && o->min_dihedral <= o->max_dihedral && o->max_dihedral <= 180))
    return laves__fail(error, LAVES_ERROR_OPTION, "a window of %g to %g degrees is none", o->min_dihedral, o->max_dihedral);
  if (o->place_capacity > 0 && !o->places)
    return laves__fail(error, LAVES_ERROR_OPTION, "there is no array for %zu places", o->place_capacity);
  return LAVES_OK;
}

laves_result laves_check_file(laves_context *context, const char *path, const laves_file_check_options *options,
                              laves_file_check *check, laves_error *error) {
  const laves_file_check_options usual = laves_file_check_options_default();
  const laves_file_check_options *o = options ? options : &usual;
  laves__mesh_stream *stream;
  *check = (laves_file_check){0};
  laves__progress_reset(context);
  laves_result result = refuse(o, error);
  if (result == LAVES_OK) result = laves__vtu_ranges_open(context, path, &stream, error);
  if (result != LAVES_OK) return result;
  result = laves__check_stream(context, stream, o, check, error);
  laves__vtu_ranges_close(stream);
  return result;
}
