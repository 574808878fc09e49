/* JSON: what is read, and what is refused with its line. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "io/json_tree.h"

static int set_up(void **state) {
  *state = laves_context_create(NULL);
  return *state ? 0 : -1;
}

static int tear_down(void **state) {
  const bool leak = laves_context_bytes(*state) != 0;
  laves_context_free(*state);
  return leak ? -1 : 0;
}

static const laves__json *parse(laves_context *context, const char *text, laves__json_tree *tree) {
  laves_error error = {0};
  const laves_result result = laves__json_parse(context, text, strlen(text), "a.json", tree, &error);
  if (result != LAVES_OK) fail_msg("%s: %s", text, error.text);
  return tree->item;
}

static void values_have_their_kind(void **state) {
  laves__json_tree tree;
  const laves__json *root = parse(*state,
                                  " { \"a\" : [ 1 , -2.5e1, [], {} ],\r\n\t\"b\": {\"c\": \"x\", \"d\": [[3]]},\n"
                                  "\"e\": true, \"f\": false, \"g\": null, \"\": 0 } \n",
                                  &tree);
  assert_int_equal(root->count, 6);
  assert_int_equal(root->span, tree.count);
  const laves__json *a = laves__json_member(root, "a");
  assert_int_equal(a->count, 4);
  assert_int_equal(laves__json_at(a, 0)->integer, 1);
  assert_true(laves__json_at(a, 0)->number == 1);
  assert_true(laves__json_is(laves__json_at(a, 1), LAVES__JSON_REAL) && laves__json_at(a, 1)->number == -25);
  assert_true(laves__json_is(laves__json_at(a, 2), LAVES__JSON_ARRAY) && laves__json_at(a, 2)->count == 0);
  assert_true(laves__json_is(laves__json_at(a, 3), LAVES__JSON_OBJECT));
  assert_null(laves__json_at(a, 4));
  const laves__json *b = laves__json_member(root, "b");
  assert_string_equal(laves__json_member(b, "c")->text, "x");
  assert_int_equal(laves__json_at(laves__json_at(laves__json_member(b, "d"), 0), 0)->integer, 3);
  assert_true(laves__json_is(laves__json_member(root, "e"), LAVES__JSON_TRUE));
  assert_true(laves__json_is(laves__json_member(root, "f"), LAVES__JSON_FALSE));
  assert_true(laves__json_is(laves__json_member(root, "g"), LAVES__JSON_NULL));
  assert_non_null(laves__json_member(root, ""));
  assert_null(laves__json_member(root, "c"));
  assert_null(laves__json_member(a, "c"));
  assert_null(laves__json_member(NULL, "c"));
  assert_null(laves__json_at(root, 0));
  assert_false(laves__json_is(NULL, LAVES__JSON_NULL));
  laves__json_free(&tree);
}

static void texts_are_decoded(void **state) {
  static const char *const pairs[][2] = {
      {"\"\"", ""},
      {"\"a\\\"\\\\\\/\\b\\f\\n\\r\\tz\"", "a\"\\/\b\f\n\r\tz"},
      {"\"\\u0041\\u00e4\\u20AC\\ud83d\\ude00\"", "A\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80"},
      {"\"\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80\"", "\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80"},
  };
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
    laves__json_tree tree;
    assert_string_equal(parse(*state, pairs[i][0], &tree)->text, pairs[i][1]);
    laves__json_free(&tree);
  }
}

static void numbers_keep_their_ends(void **state) {
  laves__json_tree tree;
  const laves__json *root = parse(*state, "[9223372036854775807, -9223372036854775807, -0, 0.1, 1E+2, 1e-400]", &tree);
  assert_true(laves__json_at(root, 0)->integer == INT64_MAX);
  assert_true(laves__json_at(root, 1)->integer == -INT64_MAX);
  assert_int_equal(laves__json_at(root, 2)->integer, 0);
  assert_true(laves__json_at(root, 3)->number == 0.1);
  assert_true(laves__json_at(root, 4)->number == 100);
  assert_true(laves__json_at(root, 5)->number == 0);
  laves__json_free(&tree);
}

static void assert_refused(laves_context *context, const char *text, size_t length, const char *sentence) {
  laves__json_tree tree;
  laves_error error = {0};
  const laves_result result = laves__json_parse(context, text, length, "a.json", &tree, &error);
  laves__json_free(&tree);
  if (result != LAVES_ERROR_INPUT || !strstr(error.text, sentence)) fail_msg("%s: %d, '%s'", text, (int)result, error.text);
}

static void what_is_no_json_is_refused(void **state) {
  static const char *const cases[][2] = {
      {"", "a.json:1: it is no JSON: it ends where a value is expected"},
      {"\n\n[1,]", "a.json:3: it is no JSON: a value is expected"},
      {"[1 2]", "a comma or ']' is expected"},
      {"[1", "a comma or ']' is expected"},
      {"{\"a\": 1", "a comma or '}' is expected"},
      {"{a: 1}", "a text in quotes is expected"},
      {"{\"a\" 1}", "a colon is expected"},
      {"{\"a\": 1,\n\"a\": 2}", "a.json:2: it is no JSON: a key is repeated"},
      {"{\"a\": {\"a\": 1}, \"\\u0061\": 2}", "a key is repeated"},
      {"1 2", "something follows its end"},
      {"01", "a value is expected"},
      {"-", "a value is expected"},
      {"+1", "a value is expected"},
      {".5", "a value is expected"},
      {"1.", "a number ends with its point"},
      {"1e", "a number lacks its exponent"},
      {"1e999", "a number is too large"},
      {"9223372036854775808", "a number is too large"},
      {"nul", "a value is expected"},
      {"NaN", "a value is expected"},
      {"\"abc", "it ends within a text"},
      {"\"a\nb\"", "not closed, or holds a control character"},
      {"\"\\x\"", "an escape that means nothing"},
      {"\"\\u12", "an escape that means nothing"},
      {"\"\\u0000\"", "an escape that means nothing"},
      {"\"\\ud800\"", "an escape that means nothing"},
      {"\"\\ud800\\u0041\"", "an escape that means nothing"},
      {"\"\\udc00\"", "an escape that means nothing"},
      {"\"\xc3\"", "a text is not UTF-8"},
      {"\"\xc0\xaf\"", "a text is not UTF-8"},
      {"\"\xed\xa0\x80\"", "a text is not UTF-8"},
      {"\"\xff\"", "a text is not UTF-8"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) assert_refused(*state, cases[i][0], strlen(cases[i][0]), cases[i][1]);
  assert_refused(*state, "1\0", 2, "something follows its end");
  assert_refused(*state, "\"a\0b\"", 5, "control character");
}

static void depth_and_width_are_limited(void **state) {
  static char text[16 * (LAVES__JSON_MEMBERS + 2)];
  laves__json_tree tree;
  memset(text, '[', LAVES__JSON_DEPTH);
  memset(text + LAVES__JSON_DEPTH, ']', LAVES__JSON_DEPTH);
  assert_non_null(parse(*state, text, &tree));
  laves__json_free(&tree);
  memset(text, '[', sizeof text - 1);
  assert_refused(*state, text, sizeof text - 1, "it is nested too deep");
  size_t length = 0;
  for (int i = 0; i <= LAVES__JSON_MEMBERS; i++) length += (size_t)sprintf(text + length, "%s\"%d\":0", i ? "," : "{", i);
  assert_refused(*state, text, length, "an object has too many members");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(values_have_their_kind, set_up, tear_down),
      cmocka_unit_test_setup_teardown(texts_are_decoded, set_up, tear_down),
      cmocka_unit_test_setup_teardown(numbers_keep_their_ends, set_up, tear_down),
      cmocka_unit_test_setup_teardown(what_is_no_json_is_refused, set_up, tear_down),
      cmocka_unit_test_setup_teardown(depth_and_width_are_limited, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
