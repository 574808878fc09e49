/* Scripts: the vocabulary by its values at points, messages by their text, the sandbox by attempts to leave it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/features.h"
#include "fixtures/assert_close.h"
#include "fixtures/stride.h"

typedef struct made {
  laves_context *context;
  laves_domain *domain;
} made;

static laves_result build(laves_context *context, const char *text, bool is_expression, laves_domain **domain,
                          laves_error *error) {
  laves_domain *d = laves__alloc_zeroed(context, 1, sizeof *d);
  d->context = context;
  const laves_result result = laves__implicit_build(context, text, strlen(text), is_expression, "name", NULL, d, error);
  if (result != LAVES_OK) {
    laves_domain_free(d);
    d = NULL;
  }
  *domain = d;
  return result;
}

static made make(const char *text, bool is_expression) {
  made m = {.context = laves_context_create(NULL)};
  laves_error error = {0};
  if (build(m.context, text, is_expression, &m.domain, &error) != LAVES_OK) fail_msg("%s: %s", text, error.text);
  return m;
}

static void drop(made *m) {
  laves_domain_free(m->domain);
  assert_int_equal(laves_context_bytes(m->context), 0);
  laves_context_free(m->context);
}

static double value_at(const made *m, double x, double y, double z) {
  double value;
  laves_domain_evaluate(m->domain, (double[]){x, y, z}, 1, &value);
  return value;
}

/* ---- what the words mean ---- */

typedef struct sample {
  const char *text;
  double x, y, z, value;
} sample;

static const sample samples[] = {
    {"sphere(2)", 3, 0, 0, 1},
    {"sphere{r=2}", 0, 0, 0, -2},
    {"box(2, 4, 6)", 0, 0, 4, 1},
    {"box(2, 4, 6)", 0, 0, 0, -1},
    {"box(2)", 1, 4, 1, 3},
    {"box{x=2, y=4, z=6}", 4, 6, 3, 5},
    {"rounded_box(2, 2, 2, 0.5)", 1, 1, 0, 0.20710678118654752},
    {"sphere(9) & cylinder{r=1}", 4, 0, 3, 3},
    {"cylinder{r=1, h=2}", 4, 0, 5, 5},
    {"cylinder(1, 2)", 0, 0, 0, -1},
    {"capsule{r=1, h=2}", 0, 0, 3, 1},
    {"capsule(1, 2)", 3, 0, 1, 2},
    {"cone{r=1, h=2}", 0, 0, -2, 1},
    {"cone{r=1, h=2, r2=1}", 2, 0, 0, 1},
    {"torus(3, 1)", 3, 0, 0, -1},
    {"torus{R=3, r=1}", 0, 0, 0, 2},
    {"ellipsoid(1, 2, 3)", 0, 2, 0, 0},
    {"ellipsoid(1, 2, 3)", 0, 0, 0, -1},
    {"box(4) & halfspace{normal={0, 0, 2}, offset=1}", 0, 0, 2, 1},
    {"box(4) & plane{normal=\"x\"}", 1.5, 0, 0, 1.5},
    {"metaballs{{1, 0, 0, 0.5}}", 1.5, 0, 0, 0},
    {"metaballs{{0, 0, 0, 1}, {1, 0, 0, 1}, sharpness=2}", 0.5, 0, 0, -0.54828679513998629},
    {"gyroid() & sphere(1)", 0, 0, 0, 0},
    {"gyroid{period=2, thickness=0.1} & sphere(1)", 0, 0, 0, -0.05},
    {"schwarz_p{level=3} & sphere(0.1)", 0, 0, 0, 0},
    {"x*x + y*y + z*z - 1", 2, 0, 0, 3},
    {"(x^2 + y^2)^0.5 - 1 & box(4)", 2, 0, 0, 1},
    {"max(abs(x), abs(y), abs(z)) - 1", 0, -3, 0, 2},
    {"length(x, y, z) - 1", 2, 0, 0, 1},
    {"sphere(1) - sphere(0.5)", 0, 0, 0, 0.5},
    {"sphere(1) + sphere(2)", 0, 0, 0, -2},
    {"sphere(1) | sphere(2)", 0, 0, 0, -2},
    {"sphere(1) & sphere(2)", 0, 0, 0, -1},
    {"sphere(1) * sphere(2)", 0, 0, 0, -1},
    {"sphere(3) & ~sphere(1)", 0, 0, 0, 1},
    {"union(sphere(1), sphere(2), sphere(3))", 0, 0, 0, -3},
    {"union{sphere(1), sphere(2)}", 0, 0, 0, -2},
    {"intersection(sphere(1), sphere(2))", 0, 0, 0, -1},
    {"difference(sphere(3), sphere(1), sphere(2))", 0, 0, 0, 2},
    {"sphere(3) & complement(sphere(1))", 0, 0, 0, 1},
    {"smooth_union(sphere(1), sphere(1), 0.6)", 1, 0, 0, -0.1},
    {"smooth_intersection(sphere(1), sphere(1), 0.6)", 1, 0, 0, 0.1},
    {"smooth_difference(sphere(1), sphere(0.1), 0.6)", 1, 0, 0, 0},
    {"offset(sphere(1), 0.5)", 2, 0, 0, 0.5},
    {"shell(sphere(1), 0.2)", 0.9, 0, 0, -0.1},
    {"shell(sphere(1), 0.2)", 0, 0, 0, 0.8},
    {"morph(sphere(1), sphere(2), 0.25)", 0, 0, 0, -1.25},
    {"bounds(sphere(1), {-2, -2, -2}, {0, 2, 2})", 0.5, 0, 0, 0.5},
    {"move(sphere(1), 1, 2, 3)", 1, 2, 3, -1},
    {"move(sphere(1), {1, 2, 3})", 1, 2, 3, -1},
    {"translate(sphere(1), {x=1, y=2, z=3})", 1, 2, 3, -1},
    {"sphere(1):move(1, 0, 0):move(0, 1, 0)", 1, 1, 0, -1},
    {"box(4, 1, 1):rotate(90)", 0, 2, 0, 0},
    {"box(4, 1, 1):rotate{angle=90, axis=\"y\"}", 0, 0, 2, 0},
    {"box(4, 1, 1):rotate(90, {0, 1, 0})", 0, 0, 2, 0},
    {"sphere(1):move(1, 0, 0):rotate(90)", 0, 1, 0, -1},
    {"scale(sphere(1), 2)", 4, 0, 0, 2},
    {"scale(sphere(1), {1, 2, 3})", 0, 0, 3, 0},
    {"sphere(1):scale{1, 2, 3}", 0, 2, 0, 0},
    {"mirror(sphere(1):move(2, 0, 0), {1, 0, 0})", -2, 0, 0, -1},
    {"mirror(sphere(1):move(2, 0, 0), \"x\")", -2, 0, 0, -1},
    {"repeat_linear(sphere(0.1), {step={1, 0, 0}, count=4})", 3, 0, 0, -0.1},
    {"repeat_grid(sphere(0.1), {step={1, 2, 3}, count={2, 3, 4}})", 1, 4, 9, -0.1},
    {"repeat_polar(sphere(0.1):move(1, 0, 0), {count=4})", 0, -1, 0, -0.1},
    {"repeat_polar(sphere(0.1):move(0, 1, 0), {count=2, axis=\"x\", angle=180})", 0, 0, 1, -0.1},
    {"warp(sphere(1), x, y, z / 2) & box(6)", 0, 0, 2, 0},
    {"field(sphere(1)) + 0.5", 0, 0, 0, -0.5},
    {"solid(x*x + y*y + z*z - 1) - sphere(0.5)", 0, 0, 0, 0.5},
    {"solid(floor(x) + mod(y, 2) + atan2(z, 1)) & box(9)", 2.5, 3, 0, 3},
    {"solid(sin(x) + cos(y) + tan(z) + asin(x) + acos(x) - 2) & box(1)", 0, 0, 0, M_PI_2 - 1},
    {"solid(exp(x) + log(y) + min(x, y, z) + pow(y, 3) + ceil(x) + y % 2) & box(3)", 0, 1, -1, 1 - 1 + 1 + 1},
    {"solid(-x / 2 + sqrt(4)) & box(9)", 1, 0, 0, 1.5},
    {"sphere(math.sqrt(4) + math.abs(-1) + pi - math.pi)", 3, 0, 0, 0},
};

static void words_mean_what_the_manual_says(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(samples); i++) {
    const sample *s = &samples[i];
    made m = make(s->text, true);
    const double value = value_at(&m, s->x, s->y, s->z);
    if (!(fabs(value - s->value) <= 1e-12)) fail_msg("%s: %.17g, not %.17g", s->text, value, s->value);
    drop(&m);
  }
}

static void scripts_are_programs(void **state) {
  (void)state;
  made m = make("local s = box(1)\nfor i = 1, 3 do s = s | sphere(0.5):move(i, 0, 0) end\nreturn s", false);
  assert_close(value_at(&m, 3, 0, 0), -0.5, 1e-15);
  assert_string_equal(m.domain->format, "Lua script");
  assert_close(m.domain->info.upper[0], 3.5, 0.1);
  drop(&m);
}

/* Lua's own pairs() goes in an order that changes from run to run. */
static void scripts_mean_the_same_on_every_run(void **state) {
  (void)state;
  made m = make(
      "local keys = ''\nfor k in pairs{b = 1, a = 2, [2] = 1, [10] = 1, c = 3} do keys = keys .. k end\n"
      "assert(keys == '210abc', keys)\nassert(math.random(1, 1000000) == math.random(1, 1000000) or true)\n"
      "return sphere(1 + math.random())",
      false);
  made n =
      make("math.randomseed(7) local a = math.random() math.randomseed(7) assert(a == math.random()) return sphere(1)", false);
  made o = make("local r = math.random(1, 1000000) r = math.random(1, 1000000) return sphere(1 + math.random())", false);
  assert_true(value_at(&m, 0, 0, 0) == value_at(&o, 0, 0, 0));
  drop(&m);
  drop(&n);
  drop(&o);
}

/* Each block of Lua in the manual makes a solid. */
static void examples_of_the_manual_run(void **state) {
  (void)state;
  FILE *file = fopen("docs/implicit.md", "rb");
  assert_non_null(file);
  static char manual[100000];
  const size_t length = fread(manual, 1, sizeof manual - 1, file);
  fclose(file);
  manual[length] = 0;
  int count = 0;
  for (char *begin = strstr(manual, "```lua\n"); begin; begin = strstr(begin, "```lua\n"), count++) {
    begin += strlen("```lua\n");
    char *end = strstr(begin, "```");
    assert_non_null(end);
    *end = 0;
    made m = make(begin, false);
    drop(&m);
    begin = end + 1;
  }
  assert_in_range(count, 5, 100);
}

/* ---- messages ---- */

/* ---- what is kept ---- */

/* Points and lines go as their solids do, in the order in which they were drawn. */
static void kept_goes_with_the_solid(void **state) {
  static const struct {
    const char *text;
    size_t point_count, line_count;
    laves__vec3 first, last; /* the first point, and the last vertex or else point */
  } cases[] = {
      {"sphere(1)", 0, 0, {0, 0, 0}, {0, 0, 0}},
      {"keep(sphere(1), {})", 0, 0, {0, 0, 0}, {0, 0, 0}},
      {"keep(sphere(1), {points={{1, 0, 0}, {x=0, y=1, z=0}}})", 2, 0, {1, 0, 0}, {0, 1, 0}},
      {"sphere(1):keep{points={{1, 0, 0}, 'z'}}", 2, 0, {1, 0, 0}, {0, 0, 1}},
      {"keep(x*x + y*y + z*z - 1, {points={{1, 0, 0}}})", 1, 0, {1, 0, 0}, {1, 0, 0}},
      {"keep(sphere(1), {points={{1, 0, 0}}, lines={{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}})", 1, 1, {1, 0, 0}, {0, 0, 1}},
      {"keep(keep(sphere(1), {points={{1, 0, 0}}}), {points={{0, 1, 0}}})", 2, 0, {1, 0, 0}, {0, 1, 0}},
      {"keep(sphere(1), {points={{1, 0, 0}}}):move(1, 2, 3)", 1, 0, {2, 2, 3}, {2, 2, 3}},
      {"keep(sphere(1), {points={{1, 0, 0}}}):move(1, 2, 3):rotate(90):scale(2, 1, 1)", 1, 0, {-4, 2, 3}, {-4, 2, 3}},
      {"mirror(keep(sphere(1), {points={{1, 0, 0}}}), 'x')", 1, 0, {-1, 0, 0}, {-1, 0, 0}},
      {"keep(sphere(1), {points={{1, 0, 0}}}) + keep(sphere(1), {points={{0, 1, 0}}}):move(5, 0, 0)", 2, 0, {1, 0, 0}, {5, 1, 0}},
      {"box(3) - keep(sphere(1.6), {points={{0, 0, 1.6}}})", 1, 0, {0, 0, 1.6}, {0, 0, 1.6}},
      {"keep(sphere(1), {points={{1, 0, 0}}}) & box(4)", 1, 0, {1, 0, 0}, {1, 0, 0}},
      {"smooth_union(keep(sphere(1), {points={{-1, 0, 0}}}), sphere(1):move(2, 0, 0), 0.1)", 1, 0, {-1, 0, 0}, {-1, 0, 0}},
      {"bounds(shell(keep(sphere(1), {points={{-1, 0, 0}}}), 0.2), {-2, -2, -2}, {2, 2, 2})", 1, 0, {-1, 0, 0}, {-1, 0, 0}},
      {"repeat_linear(keep(sphere(1), {points={{-1, 0, 0}}}), {step={3, 0, 0}, count=3})", 3, 0, {-1, 0, 0}, {5, 0, 0}},
      {"repeat_polar(keep(sphere(1), {points={{-1, 0, 0}}}):move(5, 0, 0), {count=4})", 4, 0, {4, 0, 0}, {0, -4, 0}},
  };
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(cases); i++) {
    made m = make(cases[i].text, true);
    const laves_features *f = m.domain->oracle.drawn;
    assert_int_equal(f ? f->point_count : 0, cases[i].point_count);
    assert_int_equal(f ? f->line_count : 0, cases[i].line_count);
    if (f) {
      const laves__vec3 last = f->line_count ? f->vertex[f->vertex_count - 1] : f->point[f->point_count - 1];
      assert_close(v3_distance(f->point[0], cases[i].first), 0, 1e-12);
      assert_close(v3_distance(last, cases[i].last), 0, 1e-12);
    }
    drop(&m);
  }
}

/* What a script keeps is found as what the caller draws is; a point that another solid swallows is off the surface. */
static void kept_is_found(void **state) {
  static const laves__feature_wish wish = {.size = 0.1};
  (void)state;
  for (int i = 0; i < 2; i++) {
    made m = make(i ? "keep(sphere(1), {points={{1, 0, 0}}}) + sphere(1):move(1.2, 0, 0)"
                    : "keep(sphere(1), {points={{1, 0, 0}}}) + sphere(1):move(3, 0, 0)",
                  true);
    laves__features features;
    laves_error error = {0};
    assert_int_equal(laves__features_find(m.context, &m.domain->oracle, &wish, &features, &error),
                     i ? LAVES_ERROR_INPUT : LAVES_OK);
    if (i) assert_non_null(strstr(error.text, "point 1 (counted from 1), at (1, 0, 0), is "));
    laves__features_free(&features);
    drop(&m);
  }
}

typedef struct mistake {
  const char *text, *message;
} mistake;

static const mistake mistakes[] = {
    {"sphere(-1)", "name:1: sphere: r must be a positive number, not -1"},
    {"sphere()", "name:1: sphere: r is missing"},
    {"sphere(0/0)", "name:1: sphere: r must be a finite number"},
    {"sphere(1, 2)", "name:1: sphere takes no more than 1 arguments"},
    {"sphere{radius=1}", "name:1: sphere has no option 'radius'; it knows r"},
    {"torus{R=1, q=2}", "name:1: torus has no option 'q'; it knows R and r"},
    {"sphere('big')", "name:1: sphere: r must be a number, not a text"},
    {"sphere(1) + 1", "name:1: '+' between a solid and a number"},
    {"sphere(1) - x", "name:1: '-' between a solid and a field"},
    {"sphere(1) / sphere(1)", "name:1: '/' has no meaning for solids"},
    {"-sphere(1)", "name:1: '-' before a solid"},
    {"min(sphere(1), 2)", "name:1: min: for solids write a | b"},
    {"sin(sphere(1))", "name:1: sin: expected a field or a number, not a solid"},
    {"sin()", "name:1: sin: expected 1 argument, not 0"},
    {"union(1, 2)", "name:1: union: expected a solid, not a number"},
    {"move(sphere(1), {1, 2})", "name:1: move: by must have three numbers"},
    {"move(sphere(1), 1, 2)", "name:1: move: by must be a number, not nothing"},
    {"mirror(sphere(1), 'w')", "name:1: mirror: normal must be {x, y, z} or one of"},
    {"mirror(sphere(1), {0, 0, 0})", "name:1: mirror: normal must not be zero"},
    {"scale(sphere(1), 0)", "name:1: scale: a factor must not be zero"},
    {"rounded_box(1, 1, 1, 2)", "name:1: rounded_box: r must be at most half"},
    {"repeat_linear(sphere(1), {step={1, 0, 0}, count=0.5})", "name:1: repeat_linear: count must be a whole number"},
    {"metaballs{}", "name:1: metaballs: expected 1 to 10000 balls"},
    {"metaballs{{0, 0, 0, 1}, blur=2}", "name:1: metaballs has no option 'blur'"},
    {"keep(sphere(1))", "name:1: keep: expected a solid and a table"},
    {"keep(1, {})", "name:1: keep: expected a solid, not a number"},
    {"keep(sphere(1), {spots={}})", "name:1: keep has no option 'spots'; it knows points and lines"},
    {"keep(sphere(1), {points=3})", "name:1: keep: points must be a list, as in points={{0, 0, 1}}, not a number"},
    {"keep(sphere(1), {points={1, 0, 0}})", "name:1: keep: each point must be a number"},
    {"keep(sphere(1), {points={{1, 0}}})", "name:1: keep: each point must have three numbers"},
    {"keep(sphere(1), {points={{1, 0, 1/0}}})", "name:1: keep: each point must be a finite number"},
    {"keep(sphere(1), {lines={{1, 0, 0}}})", "name:1: keep: "},
    {"keep(sphere(1), {lines={{{1, 0, 0}}}})", "name:1: keep: a line must have two points or more"},
    {"keep(sphere(1), {points={{1, 0, 0}}}):offset(1)", "name:1: offset: it moves the surface away from the points"},
    {"warp(keep(sphere(1), {points={{1, 0, 0}}}), x, y, z)", "name:1: warp: it moves the surface away"},
    {"morph(sphere(2), keep(sphere(1), {points={{1, 0, 0}}}), 0.5)", "name:1: morph: it moves the surface away"},
    {"scale(keep(sphere(1), {points={{1, 0, 0}}}), 1e200):scale(1e200)", "keep: a point has coordinates beyond all numbers"},
    {"repeat_grid(keep(sphere(1), {points={{1, 0, 0}, {0, 1, 0}}}), {step={3, 3, 3}, count={100, 100, 100}})",
     "name: keep: at most 1000000 points and vertices, copies counted"},
    {"surface(1)", "name:1: surface: expected the name of a file"},
    {"surface('no/such/file.stl')", "name:1: surface: no/such/file.stl"},
    {"3", "name: the script yields a number; it must return a solid"},
    {"nil", "name: the script yields nothing"},
    {"sphere(1", "name:1: ')' expected"},
    {"gyroid()", "name: the solid has no bounds that can be found"},
    {"x + y", "name: the solid has no bounds that can be found"},
    {"sphere(1) & sphere(1):move(9, 0, 0)", "name: the solid is empty"},
    {"x*x + 1", "name: the solid is empty"},
    {"qwerty", "name: the script yields nothing"},
    {"qwerty(1)", "name:1: attempt to call a nil value (global 'qwerty')"},
};

static void assert_refused(const char *text, bool is_expression, const char *message) {
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain;
  laves_error error = {0};
  const laves_result result = build(context, text, is_expression, &domain, &error);
  /* Under tools that slow everything down the limit of time may come first. */
  const bool out_of_time = test_stride() > 1 && strstr(error.text, "the script runs for more than 10 seconds");
  if (result != LAVES_ERROR_INPUT || (strncmp(error.text, message, strlen(message)) != 0 && !out_of_time))
    fail_msg("%.60s: \"%s\", not \"%s\"", text, error.text, message);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void mistakes_are_explained(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(mistakes); i++) assert_refused(mistakes[i].text, true, mistakes[i].message);
  assert_refused("local a = 1\nlocal b = 2\nreturn sphere(a - b)", false, "name:3: sphere: r must be");
  assert_refused("return error('my own')", false, "name:1: my own");
  assert_refused("error({})", false, "name:1: the script raised an error that is not a text");
}

/* ---- the sandbox ---- */

static void dangerous_words_are_absent(void **state) {
  (void)state;
  static const char *const words[] = {
      "io",          "os",          "require",      "load",       "loadstring",   "dofile",   "loadfile",
      "debug",       "coroutine",   "package",      "pcall",      "xpcall",       "print",    "collectgarbage",
      "next",        "rawset",      "getmetatable", "rawget",     "setmetatable", "_G",       "string.rep",
      "string.gsub", "string.dump", "string.find",  "table.move", "('').rep",     "('').dump"};
  for (size_t i = 0; i < LAVES__COUNT_OF(words); i++) {
    char text[200];
    snprintf(text, sizeof text, "assert(%s == nil)\nreturn sphere(1)", words[i]);
    made m = make(text, false);
    drop(&m);
  }
  assert_refused("\x1bLua", false, "name:1: attempt to load a binary chunk");
}

static void limits_end_runaway_scripts(void **state) {
  (void)state;
  assert_refused("while true do end", false, "name:1: the script takes more than 20 million steps");
  assert_refused("\n\nlocal function f() return f() end\nf()", false, "name:3: the script takes more than 20 million steps");
  assert_refused("local function f() return 1 + f() end\nf()", false, "name:1: the script needs more than 64 MiB");
  assert_refused("local s = 'x'\nwhile true do\ns = s .. s end", false, "name:3: the script makes a text of more than 1 MiB");
  assert_refused("local t = {}\nfor i = 1, 1e9 do t[i] = i end", false, "name:2: the script needs more than 64 MiB");
  assert_refused("local s = sphere(1)\nfor i = 1, 1e7 do\ns = s | sphere(i) end\nreturn s", false,
                 "name:3: the solid needs more than 1000000 operations");
  assert_refused("local s = sphere(1)\nfor i = 1, 40 do s = s | move(s, 2^i, 0, 0) end\nreturn s", false,
                 "name: the solid needs more than 1000000 operations");
  assert_refused("repeat_grid(sphere(1), {step={1, 1, 1}, count={1000, 1000, 1000}})", true,
                 "name:1: repeat_grid: at most a million");
  assert_refused("table.sort({3, 1, 2, 5, 4}, function() while true do end end)", false, "name:1: the script takes more than");
  char deep[3000] = "";
  memset(deep, '(', sizeof deep - 1);
  assert_refused(deep, true, "name:1: brackets or calls are nested too deeply");
}

static void memory_limit_is_the_contexts(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  for (options.memory_limit = 2000; options.memory_limit < 300000; options.memory_limit = options.memory_limit * 5 / 4) {
    laves_context *context = laves_context_create(&options);
    laves_domain *domain = NULL;
    laves_error error;
    const laves_result result = laves_domain_from_expression(context, "sphere(1) - box(1) | gyroid() & box(1)", &domain, &error);
    assert_true(result == LAVES_OK || result == LAVES_ERROR_MEMORY);
    laves_domain_free(domain);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
}

static bool never(void *user, const char *phase, double fraction) {
  (void)user;
  (void)phase;
  (void)fraction;
  return false;
}

static void progress_can_cancel_a_script(void **state) {
  (void)state;
  laves_context_options options = laves_context_options_default();
  options.progress = never;
  laves_context *context = laves_context_create(&options);
  laves_domain *domain;
  laves_error error;
  assert_int_equal(build(context, "while true do end", false, &domain, &error), LAVES_ERROR_CANCELLED);
  laves_context_free(context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(words_mean_what_the_manual_says), cmocka_unit_test(scripts_are_programs),
      cmocka_unit_test(examples_of_the_manual_run),      cmocka_unit_test(scripts_mean_the_same_on_every_run),
      cmocka_unit_test(kept_goes_with_the_solid),        cmocka_unit_test(kept_is_found),
      cmocka_unit_test(mistakes_are_explained),          cmocka_unit_test(dangerous_words_are_absent),
      cmocka_unit_test(limits_end_runaway_scripts),      cmocka_unit_test(memory_limit_is_the_contexts),
      cmocka_unit_test(progress_can_cancel_a_script),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
