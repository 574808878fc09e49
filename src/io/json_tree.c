/* JSON as a tree in one array.
 *
 * Its memory is the context's, which is why it is read by ourselves: a library whose allocator can only be told for the whole
 * process can neither be counted nor, as it turned out, be trusted to tell short memory from bad text.
 *
 * Texts are decoded where they stand: no escape is shorter than what it means, and the closing quote becomes the NUL.
 *
 * Source: [rfc8259]. */
#include "io/json_tree.h"

#include <string.h>

#include "io/scan.h"

typedef struct parser {
  laves__json_tree *tree;
  char *at, *end;
  const char *name;
  laves_error *error;
  int depth;
} parser;

static laves_result fail(const parser *p, const char *what) {
  int line = 1;
  for (const char *c = p->tree->bytes; c < p->at; c++) line += *c == '\n';
  return laves__fail(p->error, LAVES_ERROR_INPUT, "%s:%d: it is no JSON: %s", p->name, line, what);
}

static void skip_space(parser *p) {
  while (p->at < p->end && (*p->at == ' ' || *p->at == '\t' || *p->at == '\n' || *p->at == '\r')) p->at++;
}

/* Takes the character if it comes next, behind spaces. */
static bool take(parser *p, char c) {
  skip_space(p);
  if (p->at == p->end || *p->at != c) return false;
  p->at++;
  return true;
}

/* ---- texts ---- */

/* Length of the UTF-8 sequence, 0 when it is none (no overlong forms, no surrogates). */
static size_t sequence_length(const unsigned char *at, const unsigned char *end) {
  const unsigned char lead = at[0];
  if (lead < 0x80) return 1;
  const size_t length = lead >= 0xc2 && lead <= 0xdf ? 2 : (lead & 0xf0) == 0xe0 ? 3 : lead >= 0xf0 && lead <= 0xf4 ? 4 : 0;
  if (length > (size_t)(end - at)) return 0;
  for (size_t i = 1; i < length; i++)
    if ((at[i] & 0xc0) != 0x80) return 0;
  if ((lead == 0xe0 && at[1] < 0xa0) || (lead == 0xed && at[1] > 0x9f)) return 0;
  if ((lead == 0xf0 && at[1] < 0x90) || (lead == 0xf4 && at[1] > 0x8f)) return 0;
  return length;
}

static int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* The four digits behind \u; false when they are none. */
static bool take_unit(parser *p, uint32_t *unit) {
  *unit = 0;
  if (p->end - p->at < 4) return false;
  for (int i = 0; i < 4; i++) {
    const int digit = hex_digit(*p->at++);
    if (digit < 0) return false;
    *unit = *unit * 16 + (uint32_t)digit;
  }
  return true;
}

/* A character by one or, beyond the first 65536, two such units. NUL is refused. */
static bool take_code(parser *p, uint32_t *code) {
  uint32_t low;
  if (!take_unit(p, code) || *code == 0 || (*code >= 0xdc00 && *code <= 0xdfff)) return false;
  if (*code < 0xd800 || *code > 0xdbff) return true;
  if (p->end - p->at < 2 || p->at[0] != '\\' || p->at[1] != 'u') return false;
  p->at += 2;
  if (!take_unit(p, &low) || low < 0xdc00 || low > 0xdfff) return false;
  *code = 0x10000 + ((*code - 0xd800) << 10) + (low - 0xdc00);
  return true;
}

static char *put_code(char *out, uint32_t code) {
  if (code < 0x80) {
    *out++ = (char)code;
    return out;
  }
  const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
  static const unsigned char leads[] = {0, 0xc0, 0xe0, 0xf0};
  *out++ = (char)(leads[more] | code >> 6 * more);
  for (int i = more - 1; i >= 0; i--) *out++ = (char)(0x80 | (code >> 6 * i & 0x3f));
  return out;
}

/* What stands behind a backslash. */
static bool take_escape(parser *p, char **out) {
  static const char letters[] = "\"\\/bfnrt", meanings[] = "\"\\/\b\f\n\r\t";
  uint32_t code;
  if (p->at == p->end) return false;
  const char letter = *p->at++;
  if (letter == 'u') {
    if (!take_code(p, &code)) return false;
    *out = put_code(*out, code);
    return true;
  }
  const char *found = letter ? strchr(letters, letter) : NULL;
  if (found) *(*out)++ = meanings[found - letters];
  return found != NULL;
}

/* A text from its opening quote on. */
static laves_result take_text(parser *p, const char **text) {
  if (!take(p, '"')) return fail(p, "a text in quotes is expected");
  char *out = p->at;
  *text = out;
  while (p->at < p->end && *p->at != '"') {
    const size_t length = sequence_length((const unsigned char *)p->at, (const unsigned char *)p->end);
    if (length == 0) return fail(p, "a text is not UTF-8");
    if ((unsigned char)*p->at < 0x20) return fail(p, "a text is not closed, or holds a control character");
    if (*p->at == '\\') {
      p->at++;
      if (!take_escape(p, &out)) return fail(p, "a text holds an escape that means nothing");
      continue;
    }
    memmove(out, p->at, length);
    out += length;
    p->at += length;
  }
  if (p->at == p->end) return fail(p, "it ends within a text");
  *out = 0;
  p->at++;
  return LAVES_OK;
}

/* ---- numbers ---- */

static bool take_digits(parser *p) {
  const char *first = p->at;
  while (p->at < p->end && *p->at >= '0' && *p->at <= '9') p->at++;
  return p->at > first;
}

static bool take_sign(parser *p, const char *signs) {
  const bool found = p->at < p->end && *p->at && strchr(signs, *p->at);
  p->at += found;
  return found;
}

static laves_result take_number(parser *p, laves__json *value) {
  const char *first = p->at;
  value->kind = LAVES__JSON_INTEGER;
  take_sign(p, "-");
  const char *lead = p->at;
  if (!take_digits(p) || (*lead == '0' && p->at - lead > 1)) return fail(p, "a value is expected");
  if (take_sign(p, ".")) {
    value->kind = LAVES__JSON_REAL;
    if (!take_digits(p)) return fail(p, "a number ends with its point");
  }
  if (take_sign(p, "eE")) {
    value->kind = LAVES__JSON_REAL;
    take_sign(p, "+-");
    if (!take_digits(p)) return fail(p, "a number lacks its exponent");
  }
  const bool whole = value->kind == LAVES__JSON_INTEGER;
  const char *end = whole ? laves__parse_int(first, p->at, &value->integer) : laves__parse_double(first, p->at, &value->number);
  if (whole) value->number = (double)value->integer;
  return end == p->at ? LAVES_OK : fail(p, "a number is too large");
}

/* ---- values ---- */

static laves_result take_value(parser *p, const char *key);

static bool take_word(parser *p, const char *word) {
  const size_t length = strlen(word);
  if ((size_t)(p->end - p->at) < length || memcmp(p->at, word, length) != 0) return false;
  p->at += length;
  return true;
}

/* The key of a member and its colon; it must differ from those of the object so far. */
static laves_result take_key(parser *p, size_t object, const char **key) {
  laves_result result = take_text(p, key);
  if (result != LAVES_OK) return result;
  if (p->tree->item[object].count == LAVES__JSON_MEMBERS) return fail(p, "an object has too many members");
  p->tree->item[object].span = (uint32_t)(p->tree->count - object);
  if (laves__json_member(&p->tree->item[object], *key)) return fail(p, "a key is repeated");
  return take(p, ':') ? LAVES_OK : fail(p, "a colon is expected");
}

/* The values of the array or object at `place`, whose bracket is taken. */
static laves_result take_values(parser *p, size_t place) {
  const bool is_object = p->tree->item[place].kind == LAVES__JSON_OBJECT;
  const char close = is_object ? '}' : ']';
  if (++p->depth > LAVES__JSON_DEPTH) return fail(p, "it is nested too deep");
  if (!take(p, close)) {
    do {
      const char *key = NULL;
      laves_result result = is_object ? take_key(p, place, &key) : LAVES_OK;
      if (result == LAVES_OK) result = take_value(p, key);
      if (result != LAVES_OK) return result;
      p->tree->item[place].count++;
    } while (take(p, ','));
    if (!take(p, close)) return fail(p, is_object ? "a comma or '}' is expected" : "a comma or ']' is expected");
  }
  p->depth--;
  return LAVES_OK;
}

static laves_result take_simple(parser *p, laves__json *value) {
  if (p->at == p->end) return fail(p, "it ends where a value is expected");
  if (*p->at == '"') {
    value->kind = LAVES__JSON_TEXT;
    return take_text(p, &value->text);
  }
  if (take_word(p, "null")) return LAVES_OK;
  if (take_word(p, "true")) {
    value->kind = LAVES__JSON_TRUE;
    return LAVES_OK;
  }
  if (take_word(p, "false")) {
    value->kind = LAVES__JSON_FALSE;
    return LAVES_OK;
  }
  return take_number(p, value);
}

static laves_result take_value(parser *p, const char *key) {
  laves__json_tree *tree = p->tree;
  const size_t place = tree->count;
  laves__json value = {.kind = LAVES__JSON_NULL, .span = 1, .key = key};
  laves_result result = LAVES_OK;
  if (!laves__grow(tree->context, &tree->item, &tree->capacity, place + 1, sizeof *tree->item))
    return laves__fail_memory(tree->context, p->error);
  tree->count++;
  const bool is_object = take(p, '{'), is_array = !is_object && take(p, '[');
  if (is_object || is_array)
    value.kind = is_object ? LAVES__JSON_OBJECT : LAVES__JSON_ARRAY;
  else
    result = take_simple(p, &value);
  tree->item[place] = value;
  if (is_object || is_array) result = take_values(p, place);
  tree->item[place].span = (uint32_t)(tree->count - place);
  return result;
}

laves_result laves__json_parse(laves_context *context, const char *bytes, size_t length, const char *name, laves__json_tree *tree,
                               laves_error *error) {
  *tree = (laves__json_tree){.context = context, .byte_count = length + 1};
  tree->bytes = laves__alloc(context, tree->byte_count, 1);
  if (!tree->bytes) return laves__fail_memory(context, error);
  if (length) memcpy(tree->bytes, bytes, length);
  tree->bytes[length] = 0;
  parser p = {.tree = tree, .at = tree->bytes, .end = tree->bytes + length, .name = name, .error = error};
  if (length >= UINT32_MAX) return fail(&p, "it is too large");
  const laves_result result = take_value(&p, NULL);
  skip_space(&p);
  return result == LAVES_OK && p.at < p.end ? fail(&p, "something follows its end") : result;
}

void laves__json_free(laves__json_tree *tree) {
  if (!tree->context) return;
  laves__free(tree->context, tree->bytes, tree->byte_count, 1);
  laves__free(tree->context, tree->item, tree->capacity, sizeof *tree->item);
  *tree = (laves__json_tree){0};
}

/* ---- asking ---- */

const laves__json *laves__json_member(const laves__json *object, const char *key) {
  if (!laves__json_is(object, LAVES__JSON_OBJECT)) return NULL;
  const laves__json *value = object + 1;
  for (uint32_t i = 0; i < object->count; i++, value += value->span)
    if (strcmp(value->key, key) == 0) return value;
  return NULL;
}

const laves__json *laves__json_at(const laves__json *array, size_t index) {
  if (!laves__json_is(array, LAVES__JSON_ARRAY) || index >= array->count) return NULL;
  const laves__json *value = array + 1;
  for (size_t i = 0; i < index; i++) value += value->span;
  return value;
}
