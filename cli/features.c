/* Features that are kept, from the command line.
 *
 * In: --features auto|none|FILE, and what says how to look for more.  Out: the library's list, and its options.
 *
 * What a FILE holds is added to what is found by itself; `none` turns that off. A file of such a name is ./auto or ./none. */
#include "features.h"

#include <string.h>

static bool is_word(const char *text) { return strcmp(text, "auto") == 0 || strcmp(text, "none") == 0; }

static bool is_among(const option_texts *list, const char *word) {
  for (int i = 0; i < list->count; ++i) {
    if (strcmp(list->items[i], word) == 0) return true;
  }
  return false;
}

laves_result features_open(session *run, laves_features **features) {
  const option_texts *list = &run->given->features;
  *features = NULL;
  if (is_among(list, "auto") && is_among(list, "none"))
    return session_fail(run, LAVES_ERROR_OPTION, "'--features auto' and '--features none' cannot both be given");
  laves_result result = LAVES_OK;
  for (int i = 0; result == LAVES_OK && i < list->count; ++i) {
    if (is_word(list->items[i])) continue;
    if (!*features) result = laves_features_create(run->context, features, &run->error);
    if (result == LAVES_OK) result = laves_features_add_file(*features, list->items[i], &run->error);
  }
  return session_settle(run, result);
}

static double wished_angle(const settings *given) { return is_among(&given->features, "none") ? 0 : given->feature_angle; }

void features_options(const settings *given, const laves_features *features, laves_options *options) {
  options->features = features;
  options->feature_angle = wished_angle(given);
  options->feature_tags = given->feature_tags;
  options->keep_thin = !given->no_keep_thin;
}

void features_write_json(json *out, const settings *given) {
  json_open_object(out, "features");
  json_number(out, "angle", wished_angle(given));
  json_boolean(out, "tags", given->feature_tags);
  json_boolean(out, "keep_thin", !given->no_keep_thin);
  json_open_array(out, "files");
  for (int i = 0; i < given->features.count; ++i) {
    if (!is_word(given->features.items[i])) json_text(out, NULL, given->features.items[i]);
  }
  json_close(out);
  json_close(out);
}
