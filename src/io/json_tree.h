/* JSON as a tree in one array, each value before what is in it:
 *
 *   {"a": [1, 2], "b": true}      object   array a   1   2   true b
 *                         span    5        3         1   1   1
 *
 * so that the first value within is the next item, and the one beside it is `span` items on. */
#ifndef LAVES_IO_JSON_TREE_H
#define LAVES_IO_JSON_TREE_H

#include "base/base.h"

typedef enum laves__json_kind {
  LAVES__JSON_NULL,
  LAVES__JSON_FALSE,
  LAVES__JSON_TRUE,
  LAVES__JSON_INTEGER,
  LAVES__JSON_REAL,
  LAVES__JSON_TEXT,
  LAVES__JSON_ARRAY,
  LAVES__JSON_OBJECT,
} laves__json_kind;

typedef struct laves__json {
  laves__json_kind kind;
  uint32_t span, count; /* items of the tree that it takes; values of an array or object */
  const char *key;      /* in an object; else NULL */
  const char *text;     /* TEXT: UTF-8, ends with the only NUL */
  int64_t integer;      /* INTEGER */
  double number;        /* INTEGER, REAL */
} laves__json;

typedef struct laves__json_tree {
  laves_context *context;
  char *bytes; /* a copy of the file's, in which texts are decoded */
  size_t byte_count;
  laves__json *item; /* the root first */
  size_t count, capacity;
} laves__json_tree;

/* Reads one value, by RFC 8259; repeated keys, NUL in texts, numbers that no double or int64_t holds, and more than
 * LAVES__JSON_DEPTH levels or LAVES__JSON_MEMBERS members are refused. `name` for messages. Free the tree in any case.
 * LAVES_ERROR_INPUT, LAVES_ERROR_MEMORY. */
enum { LAVES__JSON_DEPTH = 64, LAVES__JSON_MEMBERS = 1000 };
laves_result laves__json_parse(laves_context *context, const char *bytes, size_t length, const char *name, laves__json_tree *tree,
                               laves_error *error);
void laves__json_free(laves__json_tree *tree);

/* False for NULL. */
static inline bool laves__json_is(const laves__json *value, laves__json_kind kind) { return value && value->kind == kind; }
/* Of any kind but these NULL is returned, as for what is not there. */
const laves__json *laves__json_member(const laves__json *object, const char *key);
const laves__json *laves__json_at(const laves__json *array, size_t index);

#endif
