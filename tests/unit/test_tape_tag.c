/* Names of parts of implicit solids: which one the surface has at its points. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/oracle.h"
#include "fixtures/folders.h"

static laves_domain *make(laves_context *context, const char *text) {
  laves_domain *domain;
  laves_error error = {0};
  if (laves_domain_from_expression(context, text, &domain, &error) != LAVES_OK) fail_msg("%s: %s", text, error.text);
  return domain;
}

/* The name at the foot of a point. */
static const char *name_near(const laves_domain *domain, double x, double y, double z) {
  const laves__oracle *o = &domain->oracle;
  uint32_t hint = LAVES__NO_HINT;
  laves__vec3 foot, normal;
  assert_non_null(o->tag);
  assert_true(o->project(o->self, v3_sub(v3(x, y, z), o->origin), 10, &hint, &foot, &normal));
  return laves_domain_tag_name(domain, o->tag(o->self, foot, hint));
}

typedef struct place {
  double x, y, z;
  const char *name;
} place;

static void assert_names(const char *text, const place *places, size_t count) {
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = make(context, text);
  for (size_t i = 0; i < count; i++) {
    const char *name = name_near(domain, places[i].x, places[i].y, places[i].z);
    if (strcmp(name, places[i].name) != 0)
      fail_msg("%s at %g %g %g: %s, not %s", text, places[i].x, places[i].y, places[i].z, name, places[i].name);
  }
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

#define ASSERT_NAMES(text, ...) \
  assert_names(text, (const place[]){__VA_ARGS__}, sizeof((const place[]){__VA_ARGS__}) / sizeof(place))

static void without_names_there_are_no_tags(void **state) {
  (void)state;
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = make(context, "sphere(1) - box{1, 1, 3}");
  assert_null(domain->oracle.tag);
  assert_int_equal(domain->info.tag_count, 0);
  laves_domain_free(domain);
  laves_context_free(context);
}

static void booleans_keep_the_names_of_their_parts(void **state) {
  (void)state;
  ASSERT_NAMES("tag('ball', sphere(1)) - tag('bore', cylinder{r=0.4, h=4})", {1, 0, 0.1, "ball"}, {0.41, 0, 0.1, "bore"},
               {0, -0.39, -0.2, "bore"}, {0.6, 0.6, 0.6, "ball"});
  ASSERT_NAMES("tag('ball', sphere(1)) - cylinder{r=0.4, h=4}", {1, 0, 0.1, "ball"}, {0.41, 0, 0.1, "boundary"});
  ASSERT_NAMES("sphere(1):tag('a') & sphere(1):move(1, 0, 0):tag('b')", {1, 0.1, 0, "a"}, {0, 0.1, 0, "b"});
  ASSERT_NAMES("tag('in', sphere(1)):shell(0.2) + box{0.1, 0.1, 4}", {1, 0.3, 0.1, "in"}, {0.8, 0.1, 0, "in"},
               {0, 0, 2, "boundary"});
}

static void names_move_with_their_solid(void **state) {
  (void)state;
  ASSERT_NAMES("union(tag('a', box{1, 1, 1}:rotate(30, 'z')):scale(3):move(100, 0, 0), tag('b', sphere(1)):move(105, 0, 0))",
               {98, 0, 0, "a"}, {106.1, 0, 0, "b"});
  ASSERT_NAMES("tag('a', sphere(1)):repeat_linear({3, 0, 0}, 3)", {6, 1, 0, "a"}, {0, 1, 0, "a"});
  ASSERT_NAMES("tag('a', x^2 + y^2 + z^2 - 1) + tag('b', sphere(1):move(3, 0, 0))", {0, 1, 0, "a"}, {3, 1, 0, "b"});
}

static void the_innermost_name_counts(void **state) {
  (void)state;
  ASSERT_NAMES("tag('all', union(tag('a', sphere(1)), sphere(1):move(3, 0, 0)))", {0, 1, 0, "a"}, {3, 1, 0, "all"});
  ASSERT_NAMES("tag('x', tag('y', tag('z', sphere(1))))", {0, 1, 0, "z"});
  ASSERT_NAMES("tag('x', tag('y', sphere(1)):move(1, 0, 0))", {1, 1, 0, "y"});
}

/* The same solid with two names is the same formula, and still has both. */
static void equal_solids_have_names_of_their_own(void **state) {
  (void)state;
  ASSERT_NAMES("tag('a', sphere(1)) + tag('b', sphere(1)):move(3, 0, 0) + sphere(1):move(6, 0, 0)", {0, 1, 0, "a"},
               {3, 1, 0, "b"}, {6, 1, 0, "boundary"});
}

/* Where two parts have the same face, the one that was named first has it, in either order of the operands. */
static void common_faces_go_to_the_first_name(void **state) {
  (void)state;
  const char *const texts[] = {"tag('a', box{1, 1, 1}) + tag('b', box{2, 2, 1})",
                               "tag('b', box{2, 2, 1}) + tag('a', box{1, 1, 1})", "box{2, 2, 1} + tag('a', box{1, 1, 1})"};
  const char *const expected[] = {"a", "b", "a"};
  for (int i = 0; i < 3; i++) {
    laves_context *context = laves_context_create(NULL);
    laves_domain *domain = make(context, texts[i]);
    for (int k = 0; k < 50; k++) assert_string_equal(name_near(domain, 0.009 * k, 0.3 - 0.013 * k, 0.52), expected[i]);
    laves_domain_free(domain);
    laves_context_free(context);
  }
}

static void blends_are_parted_where_their_parts_are_equal(void **state) {
  (void)state;
  ASSERT_NAMES("smooth_union(tag('a', sphere(1)), tag('b', sphere(1):move(1.5, 0, 0)), 0.3)", {0.7, 0.7, 0, "a"},
               {0.8, 0.7, 0, "b"}, {-1, 0, 0, "a"});
  ASSERT_NAMES("smooth_difference(tag('a', box{2, 2, 2}), tag('b', sphere(0.7):move(0, 0, 1)), 0.2)", {0.9, 0, 1, "a"},
               {0, 0, 0.3, "b"}, {1, 0, 0, "a"});
}

/* Two tetrahedra, each a solid of an STL file. */
static const char two_solids[] =
    "solid one\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
    "facet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
    "facet\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\n"
    "facet\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid\n"
    "solid two\nfacet\nouter loop\nvertex 5 0 0\nvertex 5 1 0\nvertex 6 0 0\nendloop\nendfacet\n"
    "facet\nouter loop\nvertex 5 0 0\nvertex 6 0 0\nvertex 5 0 1\nendloop\nendfacet\n"
    "facet\nouter loop\nvertex 5 0 0\nvertex 5 0 1\nvertex 5 1 0\nendloop\nendfacet\n"
    "facet\nouter loop\nvertex 6 0 0\nvertex 5 1 0\nvertex 5 0 1\nendloop\nendfacet\nendsolid\n";

static void parts_of_files_keep_their_names(void **state) {
  (void)state;
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20], text[2 * FIXTURE_FOLDER_MAX + 200];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/pair.x.stl", folder);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fputs(two_solids, file);
  fclose(file);
  snprintf(text, sizeof text,
           "tag('ball', sphere(1):move(0, 9, 0)) + tag('file', surface('%s'):scale(2) + surface('%s'):move(0, 0, 20))", path,
           path);
  ASSERT_NAMES(text, {0, 10, 0, "ball"}, {0.2, 0.2, 0, "pair.x/one"}, {10.2, 0.2, 0, "pair.x/two"}, {5.2, 0.2, 20, "pair.x/two"});
  fixture_folder_remove(folder);
}

#define FIFTY "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"

static void wrong_uses_are_told(void **state) {
  (void)state;
  static const char *const texts[][2] = {
      {"tag(sphere(1), 3)", "tag: expected a name in quotes and a solid, not a number"},
      {"tag('a')", "tag: expected a solid"},
      {"tag('', sphere(1))", "tag: a name has 1 to 99 bytes"},
      {"tag('" FIFTY FIFTY "', sphere(1))", "tag: a name has 1 to 99 bytes"},
  };
  for (size_t i = 0; i < LAVES__COUNT_OF(texts); i++) {
    laves_context *context = laves_context_create(NULL);
    laves_domain *domain;
    laves_error error = {0};
    assert_int_equal(laves_domain_from_expression(context, texts[i][0], &domain, &error), LAVES_ERROR_INPUT);
    if (!strstr(error.text, texts[i][1])) fail_msg("%s: %s", texts[i][0], error.text);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
}

/* Every single allocation refused in turn. */
typedef struct refuser {
  size_t asked, refused;
} refuser;

static void *refuse(void *user, void *pointer, size_t old_bytes, size_t new_bytes) {
  refuser *r = user;
  (void)old_bytes;
  if (new_bytes == 0) {
    free(pointer);
    return NULL;
  }
  if (++r->asked == r->refused) return NULL;
  return realloc(pointer, new_bytes);
}

static void each_refused_allocation_is_survived(void **state) {
  (void)state;
  bool more = true;
  for (size_t n = 3; more; n++) { /* the first two make the context */
    refuser r = {0, n};
    laves_context_options options = laves_context_options_default();
    options.reallocate = refuse;
    options.reallocate_user = &r;
    options.thread_count = 1;
    laves_context *context = laves_context_create(&options);
    if (!context) continue;
    laves_domain *domain;
    const laves_result result = laves_domain_from_expression(
        context, "region('r', tag('a', sphere(1)):move(1, 0, 0)) - tag('b', cylinder{r=0.3, h=4})", &domain, NULL);
    more = r.asked >= n;
    assert_true(result == LAVES_OK ? domain->info.tag_count == 3 && domain->region_count == 2 : result == LAVES_ERROR_MEMORY);
    if (!more) assert_int_equal(result, LAVES_OK);
    laves_domain_free(domain);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
    assert_true(n < 10000);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(without_names_there_are_no_tags),
      cmocka_unit_test(booleans_keep_the_names_of_their_parts),
      cmocka_unit_test(names_move_with_their_solid),
      cmocka_unit_test(the_innermost_name_counts),
      cmocka_unit_test(equal_solids_have_names_of_their_own),
      cmocka_unit_test(common_faces_go_to_the_first_name),
      cmocka_unit_test(blends_are_parted_where_their_parts_are_equal),
      cmocka_unit_test(parts_of_files_keep_their_names),
      cmocka_unit_test(wrong_uses_are_told),
      cmocka_unit_test(each_refused_allocation_is_survived),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
