/* Fuzzes the reader of job files: any bytes are read or refused with a sentence, and what is read is what it promises. */
#include "../../cli/job_file.c"

#include "fuzz/fuzz_target.h"

static void require_text(const char *text) {
  for (const unsigned char *c = (const unsigned char *)text; *c; ++c) FUZZ_REQUIRE(*c >= 0x20 && *c != 0x7f);
}

static bool take(void *user, const job_entry *entry, job_error *error) {
  int *last = user;
  FUZZ_REQUIRE(entry->line >= *last && entry->count >= 0 && entry->count <= JOB_ITEMS_MAX);
  FUZZ_REQUIRE(entry->kind == JOB_ARRAY || entry->count == (entry->kind == JOB_TEXT || entry->kind == JOB_NUMBER));
  *last = entry->line;
  require_text(entry->table);
  require_text(entry->key);
  for (int i = 0; i < entry->count; ++i) require_text(entry->items[i]);
  for (int i = 0; i < entry->count; ++i) {
    char *end;
    if (entry->is_text[i]) continue;
    strtod(entry->items[i], &end);
    FUZZ_REQUIRE(end != entry->items[i] && *end == '\0');
  }
  if (strcmp(entry->key, "stop") != 0) return true;
  snprintf(error->text, sizeof error->text, "stopped");
  return false;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
  job_error error;
  int line = 1;
  char *exact = malloc(length > 0 ? length : 1); /* of just that length, so that sanitizers see reads beyond it */
  FUZZ_REQUIRE(exact != NULL);
  if (length > 0) memcpy(exact, bytes, length);
  const bool right = job_file_parse(exact, length, take, &line, &error);
  FUZZ_REQUIRE(right || (strlen(error.text) > 5 && error.line >= 0));
  free(exact);
  return 0;
}
