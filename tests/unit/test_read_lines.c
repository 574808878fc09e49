/* Points and lines from files: one drawing in every format, what is joined, and what is refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/features.h"
#include "fixtures/folders.h"
#include "fixtures/line_files.h"
#include "io/read_lines.h"

static laves_context *context;
static laves_error error;

static laves_result parse(const char *bytes, size_t length, laves__lines *lines) {
  memset(&error, 0, sizeof error);
  return laves__lines_parse(context, "file", bytes, length, lines, &error);
}

static void parse_text(const char *text, laves__lines *lines) {
  if (parse(text, strlen(text), lines) != LAVES_OK) fail_msg("%s", error.text);
}

/* A line as digits, of points whose x is a digit. */
static const char *line_text(const laves__lines *l, size_t line, char text[64]) {
  size_t length = 0;
  for (size_t i = laves__line_list_first(&l->list, line); i < l->list.line_end[line] && length < 60; i++)
    length += (size_t)sprintf(text + length, "%d", (int)l->points[l->list.node[i]].x);
  return text;
}

static void assert_line(const laves__lines *l, size_t line, const char *expected) {
  char text[64];
  assert_true(line < l->list.line_count);
  assert_string_equal(line_text(l, line, text), expected);
}

/* Whether one of the lines is this, forwards or backwards: both depend on how the file numbers its points. */
static bool has_line(const laves__lines *l, const char *expected) {
  char text[64], backwards[64] = "";
  const size_t length = strlen(expected);
  for (size_t i = 0; i < length; i++) backwards[i] = expected[length - 1 - i];
  for (size_t i = 0; i < l->list.line_count; i++) {
    line_text(l, i, text);
    if (strcmp(text, expected) == 0 || strcmp(text, backwards) == 0) return true;
  }
  return false;
}

static void every_format(void **state) {
  static const char *const expected[] = {"012", "234", "4564"};
  (void)state;
  for (int kind = 0; kind < LINE_FILE_KINDS; kind++) {
    line_file f = fixture_line_file(kind);
    laves__lines lines;
    assert_non_null(f.bytes);
    if (parse(f.bytes, f.length, &lines) != LAVES_OK) fail_msg("kind %d, %s: %s", kind, f.name, error.text);
    assert_int_equal(lines.list.single_count, 1);
    assert_int_equal(lines.points[lines.list.single[0]].x, 2);
    assert_int_equal(lines.list.line_count, LINE_FILE_LINES);
    for (size_t i = 0; i < LINE_FILE_LINES; i++) assert_true(has_line(&lines, expected[i]));
    for (size_t i = 0; i < lines.list.node_count; i++) {
      const laves__vec3 p = lines.points[lines.list.node[i]], q = line_file_point((int)p.x);
      if (!(p.x == q.x && p.y == q.y && p.z == q.z)) fail_msg("kind %d, %s: point %g %g %g", kind, f.name, p.x, p.y, p.z);
    }
    laves__lines_free(&lines);
    free(f.bytes);
    assert_int_equal(laves_context_bytes(context), 0);
  }
}

/* Any file that is cut off is refused or read, and nothing is left. */
static void cut_off(void **state) {
  (void)state;
  for (int kind = 0; kind < LINE_FILE_KINDS; kind++) {
    line_file f = fixture_line_file(kind);
    size_t refused = 0;
    assert_non_null(f.bytes);
    for (size_t length = 0; length < f.length; length++) {
      laves__lines lines;
      const laves_result result = parse(f.bytes, length, &lines);
      assert_true(result == LAVES_OK || result == LAVES_ERROR_INPUT);
      refused += result != LAVES_OK;
      laves__lines_free(&lines);
      assert_int_equal(laves_context_bytes(context), 0);
    }
    assert_true(refused > f.length / 20);
    free(f.bytes);
  }
}

static void pieces_are_joined(void **state) {
  static const char vertices[] = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 4 0 0\nv 5 0 0\n";
  static const struct {
    const char *elements;
    size_t singles, count;
    const char *lines[4];
  } cases[] = {
      {"l 1 2\nl 3 2\nl 3 4\n", 0, 1, {"0123"}},
      {"l 2 3\nl 1 2\nl 2 1\nl 2 2\n", 0, 1, {"012"}},     /* repeats, and a piece without length */
      {"l 1 2\nl 2 3\nl 3 1\n", 0, 1, {"0120"}},           /* a ring */
      {"l 1 2\nl 2 3\nl 2 4\n", 0, 3, {"01", "12", "13"}}, /* three meet */
      {"l 1 2\nl 2 3\np 2\n", 1, 2, {"01", "12"}},         /* a point stands there */
      {"l 1 2 3\nl 3 4\nl 4 5\n", 0, 2, {"012", "234"}},   /* a longer line keeps its ends */
      {"l 1 2 3\nl 2 4\nl 4 5\n", 0, 2, {"012", "134"}},   /* and is not passed */
      {"l 1 2 3 4\nl 4 5 6\n", 0, 2, {"0123", "345"}},     /* longer ones are not joined */
      {"p 1 2 -1\n", 3, 0, {NULL}},
      {"l 5\n", 1, 0, {NULL}},
  };
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(cases); i++) {
    char text[300];
    laves__lines lines;
    snprintf(text, sizeof text, "%s%s", vertices, cases[i].elements);
    parse_text(text, &lines);
    assert_int_equal(lines.list.single_count, cases[i].singles);
    assert_int_equal(lines.list.line_count, cases[i].count);
    for (size_t k = 0; k < cases[i].count; k++) assert_line(&lines, k, cases[i].lines[k]);
    laves__lines_free(&lines);
  }
}

static void text_forms(void **state) {
  laves__lines lines;
  (void)state;
  parse_text("\xEF\xBB\xBF# a mark before\n0 0 0\n+1e0,-.5,2.\n\n\n3 0 0 # alone\n# ends it\n4 0 0\r\n5,0,0,\r\n", &lines);
  assert_int_equal(lines.list.single_count, 1);
  assert_int_equal(lines.list.line_count, 2);
  assert_line(&lines, 0, "01");
  assert_line(&lines, 1, "45");
  assert_true(lines.points[1].y == -0.5 && lines.points[1].z == 2);
  laves__lines_free(&lines);
}

static void refused(void **state) {
  static const char obj[] = "v 0 0 0\nv 1 0 0\n", vtk[] = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n";
  static const struct {
    const char *head, *text, *sentence;
  } cases[] = {
      {"", "", "file: it holds no points or lines in a form that is known"},
      {"", "# nothing but a comment\n", "it holds no points or lines in a form that is known"},
      {"", "solid cube\n", "it holds no points or lines in a form that is known"},
      {"", "0 0 0\n0 zero 1\n", "file, line 2: expected three coordinates (finite numbers), found 'zero'"},
      {"", "0 0\n1 1 1\n", "file, line 1: expected three coordinates (finite numbers), but the line ends"},
      {"", "0 0 0 0\n", "line 1: expected the end of the line behind three coordinates, found '0'"},
      {"", "0 0 0x\n", "line 1: expected three coordinates"},
      {"", "0 0 1e999\n", "line 1: expected three coordinates"},
      {obj, "l 1 3\n", "a point or line uses point 2 (counted from 0), but there are 2"},
      {obj, "l 1 -3\n", "file, line 3: vertex -3 is used, but only 2 stand before it"},
      {obj, "l 1 0\n", "line 3: expected the index of a vertex"},
      {obj, "l\n", "line 3: expected the index of a vertex"},
      {obj, "l 1 2x\n", "line 3: expected the index of a vertex"},
      {obj, "f 1 2 1\n", "it has no points or lines; faces and solid elements are passed over"},
      {"", "v 0 0 nan\np 1\n", "line 1: expected a coordinate"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 15 2 0 1 7\n$EndElements\n",
       "an element uses node 7, which the file does not have"},
      {"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "$Nodes\n1\n1 0 0 0\n$EndNodes\n", "it has no points or lines"},
      {"", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\n", "a data set of the kind STRUCTURED_GRID has no"},
      {"", "# vtk DataFile Version 3.0\nt\nTEXT\n", "line 3: expected ASCII or BINARY"},
      {vtk, "POINTS 2 float\n0 0 0 1 0\n", "expected a coordinate"},
      {vtk, "POINTS 2 colour\n", "the type of numbers colour is not known"},
      {vtk, "POINTS 1 float\n0 0 0\nLINES 1 3\n2 0 1\n", "a point or line uses point 1 (counted from 0), but there are 1"},
      {vtk, "POINTS 1 float\n0 0 0\nLINES 1 3\n2 0 -1\n", "a line uses point -1"},
      {vtk, "POINTS 1 float\n0 0 0\nLINES 9 9999999999\n2 0 0\n", "expected a point of a cell"},
      {vtk, "POINTS 1 float\n0 0 0\nLINES 3 2\nOFFSETS vtktypeint64\n0 2 1\nCONNECTIVITY vtktypeint64\n0 0\n", "out of order"},
      {vtk, "CELL_TYPES 2\n3 3\n", "there are 2 types, but 0 cells"},
      {vtk, "ODD 2\n", "line 5: the section ODD is not known"},
      {"", "<VTKFile type=\"ImageData\"></VTKFile>", "it is a VTK file, but not of an unstructured grid"},
      {"<VTKFile type=\"PolyData\"><PolyData>", "<Piece NumberOfPoints=\"99999999999\" NumberOfLines=\"1\">", "a piece lacks"},
  };
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(cases); i++) {
    char text[500];
    laves__lines lines;
    snprintf(text, sizeof text, "%s%s", cases[i].head, cases[i].text);
    assert_int_equal(parse(text, strlen(text), &lines), LAVES_ERROR_INPUT);
    laves__lines_free(&lines);
    if (!strstr(error.text, cases[i].sentence)) fail_msg("case %zu: '%s' where '%s' is due", i, error.text, cases[i].sentence);
  }
  assert_int_equal(laves_context_bytes(context), 0);
}

/* Through the public function: lists grow by whole files, or not at all. */
static void added_to_lists(void **state) {
  char folder[FIXTURE_FOLDER_MAX], path[300];
  laves_features *f;
  (void)state;
  assert_true(fixture_folder_make(folder));
  assert_int_equal(laves_features_create(context, &f, &error), LAVES_OK);
  for (int kind = 0; kind < 2; kind++) {
    line_file file = fixture_line_file(kind);
    snprintf(path, sizeof path, "%s/%s", folder, file.name);
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(file.bytes, 1, file.length, out), file.length);
    fclose(out);
    free(file.bytes);
    assert_int_equal(laves_features_add_file(f, path, &error), LAVES_OK);
  }
  assert_int_equal(f->point_count, 2);
  assert_int_equal(f->line_count, 2 * LINE_FILE_LINES);
  assert_int_equal(f->line_end[LINE_FILE_LINES], f->line_end[LINE_FILE_LINES - 1] + 3);
  assert_true(f->vertex[f->line_end[LINE_FILE_LINES] - 1].x == 2);
  snprintf(path, sizeof path, "%s/missing.txt", folder);
  assert_int_equal(laves_features_add_file(f, path, &error), LAVES_ERROR_INPUT);
  assert_non_null(strstr(error.text, "missing.txt"));
  assert_int_equal(f->point_count, 2);
  laves_features_free(f);
  fixture_folder_remove(folder);
  assert_int_equal(laves_context_bytes(context), 0);
}

static int open_context(void **state) {
  (void)state;
  context = laves_context_create(NULL);
  return context ? 0 : 1;
}

static int close_context(void **state) {
  (void)state;
  laves_context_free(context);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_format), cmocka_unit_test(cut_off), cmocka_unit_test(pieces_are_joined),
      cmocka_unit_test(text_forms),   cmocka_unit_test(refused), cmocka_unit_test(added_to_lists),
  };
  return cmocka_run_group_tests(tests, open_context, close_context);
}
