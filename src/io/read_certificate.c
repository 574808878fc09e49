/* Reads a certificate: JSON, then member by member by the table, each checked for its type and range.
 *
 * Files come from anywhere: their size is limited before they are read, depth and width by json_tree.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "io/certificate_table.h"
#include "io/file.h"
#include "io/json_tree.h"

enum { FILE_BYTES_MAX = 1 << 20 };
/* JSON numbers beyond this are not exact in every reader. */
#define INTEGER_MAX 9007199254740992.0

typedef struct reader {
  const char *path;
  laves_certificate *certificate;
  laves_error *error;
} reader;

static laves_result fail_member(const reader *r, const char *group, const char *name, const char *need) {
  return laves__fail(r->error, LAVES_ERROR_INPUT, "%s: the member '%s%s%s' %s", r->path, group, group[0] ? "." : "", name, need);
}

/* ---- values ---- */

static bool is_null(const laves__json *value) { return laves__json_is(value, LAVES__JSON_NULL); }

static bool is_text(const laves__json *value) { return laves__json_is(value, LAVES__JSON_TEXT); }

static bool is_number(const laves__json *value) {
  return laves__json_is(value, LAVES__JSON_INTEGER) || laves__json_is(value, LAVES__JSON_REAL);
}

static bool is_true(const laves__json *value) { return laves__json_is(value, LAVES__JSON_TRUE); }

static bool is_flag(const laves__json *value) { return is_true(value) || laves__json_is(value, LAVES__JSON_FALSE); }

static bool get_text(const laves__json *value, char *to, size_t capacity) {
  to[0] = 0;
  if (is_null(value)) return true;
  if (!is_text(value) || strlen(value->text) >= capacity) return false;
  memcpy(to, value->text, strlen(value->text) + 1);
  return true;
}

static bool get_integer(const laves__json *value, int64_t least, int64_t *to) {
  if (!value || value->kind != LAVES__JSON_INTEGER) return false;
  *to = value->integer;
  return *to >= least && (double)*to <= INTEGER_MAX;
}

static bool get_count(const laves__json *value, size_t *to) {
  int64_t count = 0;
  const bool right = get_integer(value, 0, &count);
  *to = (size_t)count;
  return right;
}

static bool get_later(const laves__json *value, size_t *to) {
  *to = SIZE_MAX;
  return is_null(value) || get_count(value, to);
}

static bool get_number(const laves__json *value, double *to) {
  *to = is_number(value) ? value->number : NAN;
  return is_number(value) || is_null(value);
}

/* Item i of an array, or the value itself where only one is wanted; NULL when there is none. */
static const laves__json *item_of(const laves__json *value, size_t i, size_t count) {
  if (count == 1) return value;
  return laves__json_is(value, LAVES__JSON_ARRAY) && value->count == count ? laves__json_at(value, i) : NULL;
}

static bool get_choice(const laves__json *value, const char *const *names, int *to) {
  if (!is_text(value)) return false;
  for (int i = 0; names[i]; i++)
    if (strcmp(value->text, names[i]) == 0) {
      *to = i;
      return true;
    }
  return false;
}

static bool get_value(const laves__json *value, const laves__member *member, void *to) {
  int choice = 0;
  bool right = true;
  switch (member->kind) {
    case LAVES__MEMBER_TEXT:
      return get_text(value, to, member->count);
    case LAVES__MEMBER_COUNT:
      for (size_t i = 0; i < member->count && right; i++) right = get_count(item_of(value, i, member->count), (size_t *)to + i);
      return right;
    case LAVES__MEMBER_LATER:
      return get_later(value, to);
    case LAVES__MEMBER_INTEGER:
      return get_integer(value, INT64_MIN, to);
    case LAVES__MEMBER_NUMBER:
      for (size_t i = 0; i < member->count && right; i++) right = get_number(item_of(value, i, member->count), (double *)to + i);
      return right;
    case LAVES__MEMBER_LATER_NUMBER:
      *(double *)to = is_number(value) ? value->number : 0;
      return is_number(value) || is_null(value);
    case LAVES__MEMBER_LATER_FLAG:
      *(bool *)to = is_true(value);
      return is_flag(value) || is_null(value);
    case LAVES__MEMBER_FLAG:
      *(bool *)to = is_true(value);
      return is_flag(value);
    case LAVES__MEMBER_ALIGN:
      right = get_choice(value, laves__align_names, &choice);
      *(laves_align *)to = (laves_align)choice;
      return right;
    case LAVES__MEMBER_METHOD:
      right = get_choice(value, laves__method_names, &choice);
      *(laves_method *)to = (laves_method)choice;
      return right;
  }
  return false;
}

static const char *need_of(const laves__member *member) {
  switch (member->kind) {
    case LAVES__MEMBER_TEXT:
      return "must be a text that is not too long, or null";
    case LAVES__MEMBER_COUNT:
      return member->count == 1 ? "must be a count" : "must be an array of counts, of the right length";
    case LAVES__MEMBER_LATER:
      return "must be a count or null";
    case LAVES__MEMBER_INTEGER:
      return "must be a whole number";
    case LAVES__MEMBER_NUMBER:
      return member->count == 1 ? "must be a number or null" : "must be an array of numbers, of the right length";
    case LAVES__MEMBER_LATER_NUMBER:
      return "must be a number or null";
    case LAVES__MEMBER_FLAG:
      return "must be true or false";
    case LAVES__MEMBER_LATER_FLAG:
      return "must be true, false or null";
    default:
      return "must be one of the names in docs/certificate.md";
  }
}

/* ---- groups ---- */

/* Members that were added after the first certificates. */
static bool may_be_missing(const laves__member *member) {
  return member->kind == LAVES__MEMBER_LATER || member->kind == LAVES__MEMBER_LATER_NUMBER ||
         member->kind == LAVES__MEMBER_LATER_FLAG;
}

static laves_result read_members(const reader *r, const char *group, const laves__json *object) {
  static const laves__json missing = {.kind = LAVES__JSON_NULL};
  for (size_t i = 0; i < laves__certificate_member_count; i++) {
    const laves__member *member = &laves__certificate_members[i];
    if (strcmp(member->group, group) != 0) continue;
    const laves__json *value = laves__json_member(object, member->name);
    if (!value && may_be_missing(member)) value = &missing;
    if (!value) return fail_member(r, group, member->name, "is missing");
    if (!get_value(value, member, (char *)r->certificate + member->offset))
      return fail_member(r, group, member->name, need_of(member));
  }
  return LAVES_OK;
}

static laves_result read_group(const reader *r, const laves__member_group *group, const laves__json *root) {
  const laves__json *object = laves__json_member(root, group->name);
  if (group->flag && (is_null(object) || (!object && group->is_later))) return LAVES_OK;
  if (!laves__json_is(object, LAVES__JSON_OBJECT)) return fail_member(r, "", group->name, "is missing, or is no object");
  if (group->flag) *((bool *)((char *)r->certificate + group->flag)) = true;
  return read_members(r, group->name, object);
}

/* ---- command ---- */

/* Older certificates have none. */
static laves_result read_command(const reader *r, const laves__json *root) {
  const laves__json *words = laves__json_member(root, "command");
  laves_certificate *c = r->certificate;
  if (!words || is_null(words)) return LAVES_OK;
  static const char need[] = "must be an array of words that is not too long, or null";
  if (!laves__json_is(words, LAVES__JSON_ARRAY) || words->count > LAVES_COMMAND_WORDS) return fail_member(r, "", "command", need);
  size_t used = 0;
  for (size_t i = 0; i < words->count; i++) {
    const laves__json *word = laves__json_at(words, i);
    const size_t bytes = is_text(word) ? strlen(word->text) + 1 : 0;
    if (bytes == 0 || bytes > sizeof c->command - used) return fail_member(r, "", "command", need);
    memcpy(c->command + used, word->text, bytes);
    used += bytes;
  }
  c->command_count = (int)words->count;
  return LAVES_OK;
}

/* ---- exceptions ---- */

static int find_key(const laves__json *value, const char *(*key)(int), int count) {
  for (int i = 0; is_text(value) && i < count; i++)
    if (strcmp(value->text, key(i)) == 0) return i;
  return -1;
}

static const char *exception_key(int i) { return laves_exception_key((laves_exception_kind)i); }
static const char *cause_key(int i) { return laves_cause_key((laves_cause)i); }

/* What older certificates do not tell. */
static bool get_later_number(const laves__json *value, double *to) {
  *to = NAN;
  return !value || get_number(value, to);
}

static bool read_exception(const laves__json *object, laves_exception *e) {
  const laves__json *place = laves__json_member(object, "place");
  const int kind = find_key(laves__json_member(object, "kind"), exception_key, LAVES_EXCEPTION_COUNT);
  const int cause = find_key(laves__json_member(object, "cause"), cause_key, LAVES_CAUSE_COUNT);
  if (kind < 0 || cause < 0) return false;
  e->kind = (laves_exception_kind)kind;
  e->cause = (laves_cause)cause;
  for (size_t i = 0; i < 3; i++)
    if (!get_number(item_of(place, i, 3), &e->place[i])) return false;
  return get_number(laves__json_member(object, "value"), &e->value) &&
         get_number(laves__json_member(object, "limit"), &e->limit) &&
         get_integer(laves__json_member(object, "index"), -1, &e->index) &&
         get_number(laves__json_member(object, "curvature_radius"), &e->curvature_radius) &&
         get_later_number(laves__json_member(object, "crease_angle"), &e->crease_angle);
}

static laves_result read_exceptions(const reader *r, const laves__json *root) {
  const laves__json *object = laves__json_member(root, "exceptions");
  const laves__json *counts = laves__json_member(object, "counts"), *listed = laves__json_member(object, "listed");
  laves_certificate *c = r->certificate;
  for (int i = 0; i < LAVES_EXCEPTION_COUNT; i++) {
    const laves__json *count = laves__json_member(counts, exception_key(i));
    if (!count && i >= LAVES__LATER_EXCEPTION) continue;
    if (!get_count(count, &c->exception_counts[i]))
      return fail_member(r, "exceptions.counts", exception_key(i), "must be a count");
  }
  if (!laves__json_is(listed, LAVES__JSON_ARRAY) || listed->count > LAVES_EXCEPTION_CAPACITY)
    return fail_member(r, "exceptions", "listed", "must be an array that is not too long");
  for (size_t i = 0; i < listed->count; i++) {
    if (!read_exception(laves__json_at(listed, i), &c->exceptions[i])) {
      char name[32];
      snprintf(name, sizeof name, "listed[%zu]", i);
      return fail_member(r, "exceptions", name, "is no exception as docs/certificate.md tells");
    }
    c->exception_count++;
  }
  return LAVES_OK;
}

/* ---- all ---- */

static laves_result read_root(const reader *r, const laves__json *root) {
  const laves__json *kind = laves__json_member(root, "certificate");
  if (!is_text(kind) || strcmp(kind->text, "laves") != 0)
    return laves__fail(r->error, LAVES_ERROR_INPUT,
                       "%s: it is no certificate of a mesh: its member 'certificate' is not \"laves\"", r->path);
  int64_t schema = 0;
  if (!get_integer(laves__json_member(root, "schema"), 1, &schema)) return fail_member(r, "", "schema", "must be a whole number");
  if (schema != LAVES__CERTIFICATE_SCHEMA)
    return laves__fail(r->error, LAVES_ERROR_INPUT,
                       "%s: the certificate has schema %lld, and only %d is known here; use a newer laves", r->path,
                       (long long)schema, LAVES__CERTIFICATE_SCHEMA);
  if (!get_text(laves__json_member(root, "version"), r->certificate->version, sizeof r->certificate->version))
    return fail_member(r, "", "version", "must be a text that is not too long");
  laves_result result = LAVES_OK;
  for (size_t i = 0; i < laves__certificate_group_count && result == LAVES_OK; i++)
    result = read_group(r, &laves__certificate_groups[i], root);
  if (result == LAVES_OK) result = read_command(r, root);
  return result == LAVES_OK ? read_exceptions(r, root) : result;
}

/* Values of an earlier group may not be there: what they would say where nothing is known. */
static void set_unknown(laves_certificate *certificate) {
  memset(certificate, 0, sizeof *certificate);
  certificate->check.domain_volume = NAN;
  certificate->promised_max_dihedral = 180;
  certificate->promise_holds = true;
}

static laves_result refuse_large(const char *path, laves_error *error) {
  struct stat status;
  if (stat(path, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > FILE_BYTES_MAX)
    return laves__fail(error, LAVES_ERROR_INPUT, "%s: it is no certificate: it has more than %d bytes", path, FILE_BYTES_MAX);
  return LAVES_OK;
}

laves_result laves__certificate_parse(laves_context *context, const char *bytes, size_t length, const char *name,
                                      laves_certificate *certificate, laves_error *error) {
  const reader r = {name, certificate, error};
  laves__json_tree tree;
  set_unknown(certificate);
  laves_result result = laves__json_parse(context, bytes, length, name, &tree, error);
  if (result == LAVES_OK) result = read_root(&r, tree.item);
  laves__json_free(&tree);
  return result;
}

laves_result laves_certificate_read(laves_context *context, const char *path, laves_certificate *certificate,
                                    laves_error *error) {
  char *bytes;
  size_t length;
  laves_result result = refuse_large(path, error);
  laves__progress_reset(context);
  if (result == LAVES_OK) result = laves__file_read(context, path, &bytes, &length, error);
  if (result != LAVES_OK) return result;
  result = laves__certificate_parse(context, bytes, length, path, certificate, error);
  laves__free(context, bytes, length + 1, 1);
  return result;
}
