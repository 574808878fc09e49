/* Names for runs of triangles. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "io/tag_list.h"

static bool start(laves_context *context, laves__tag_list *list, const char *name, size_t triangle_count) {
  return laves__tag_list_start(context, list, name, strlen(name), triangle_count, "before");
}

static void many_names_are_told_apart(void **state) {
  (void)state;
  enum { COUNT = 3000 };
  laves_context *context = laves_context_create(NULL);
  laves__tag_list list = {0};
  for (int i = 0; i < 2 * COUNT; ++i) {
    char name[20];
    snprintf(name, sizeof name, "%d", i % COUNT);
    assert_true(start(context, &list, name, (size_t)i));
  }
  assert_true(laves__tag_list_end(context, &list, 2 * COUNT));
  assert_int_equal(list.count, COUNT);
  for (int i = 0; i < 2 * COUNT; ++i) {
    assert_int_equal(atoi(list.names[list.tags[i]]), i % COUNT);
  }
  laves__tag_list_free(context, &list);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void runs_and_variety(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves__tag_list list = {0};
  assert_int_equal(laves__tag_list_variety(&list), 0);
  assert_true(start(context, &list, "ab", 0));  // no triangles stand before it, so there is no run "before"
  assert_true(start(context, &list, "a", 0));
  assert_true(laves__tag_list_end(context, &list, 4));
  assert_int_equal(laves__tag_list_variety(&list), 1);
  assert_true(laves__tag_list_start(context, &list, "ab\0c", 4, 4, "before"));  // cut at the NUL
  assert_true(laves__tag_list_end(context, &list, 5));
  assert_int_equal(laves__tag_list_variety(&list), 2);
  assert_int_equal(list.count, 2);
  assert_int_equal(list.tags[4], 0);
  laves__tag_list_free(context, &list);
  assert_true(start(context, &list, "late", 2));
  assert_true(laves__tag_list_end(context, &list, 3));
  assert_string_equal(list.names[list.tags[1]], "before");
  assert_string_equal(list.names[list.tags[2]], "late");
  laves__tag_list_free(context, &list);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(many_names_are_told_apart), cmocka_unit_test(runs_and_variety)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
