/* Scripts that mean harm: whatever they do ends soon, in little memory, with a sentence that names the line, and leaves nothing
 * behind; and a cancel is heard while they do it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "domain/oracle.h"
#include "domain/shape.h"
#include "fixtures/stride.h"

/* What the limits allow: Lua's 10 seconds, and as much for what the script left. Times are of this process, as others may have
 * the machine. */
static const double second_limit = 20;
static const double silence_limit = 1; /* 0.2 is promised; some room, since a test must not fail on a slow machine */
static const size_t byte_limit = (size_t)1 << 30;

typedef struct watch {
  double latest, longest; /* when the callback was called, and the longest time between two calls */
  double cancel_at;       /* INFINITY: never */
} watch;

static void note(watch *w) {
  const double now = laves__cpu_seconds();
  if (now - w->latest > w->longest) w->longest = now - w->latest;
  w->latest = now;
}

static bool on_progress(void *user, const char *phase, double fraction) {
  watch *w = user;
  (void)phase;
  (void)fraction;
  note(w);
  return w->latest < w->cancel_at;
}

typedef struct outcome {
  laves_result result;
  char text[sizeof((laves_error *)0)->text];
  double seconds, silence;
} outcome;

/* Builds the solid, asks a few points of it, and throws all away. */
static outcome run(const char *text, bool is_expression, const char *folder, double cancel_after) {
  const double start = laves__cpu_seconds();
  watch w = {.latest = start, .cancel_at = start + cancel_after};
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  options.memory_limit = byte_limit;
  options.progress = on_progress;
  options.progress_user = &w;
  laves_context *context = laves_context_create(&options);
  laves_domain *domain = laves__alloc_zeroed(context, 1, sizeof *domain);
  domain->context = context;
  laves_error error = {0};
  outcome o = {.result = laves__implicit_build(context, text, strlen(text), is_expression, "name", folder, domain, &error)};
  if (o.result == LAVES_OK) {
    double values[2];
    laves_domain_evaluate(domain, (double[]){0, 0, 0, 0.25, 0.5, 1}, 2, values);
    assert_true(isfinite(values[0]) && isfinite(values[1]));
    assert_true(laves__box3_is_finite(domain->oracle.bounds));
  }
  laves_domain_free(domain);
  note(&w);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
  snprintf(o.text, sizeof o.text, "%s", error.text);
  o.seconds = w.latest - start;
  o.silence = w.longest;
  return o;
}

typedef struct attack {
  const char *text, *message; /* how the sentence begins; NULL: no harm is done, and there is a solid */
} attack;

static void assert_ends(const attack *a, const char *folder) {
  const outcome o = run(a->text, false, folder, INFINITY);
  const bool as_told =
      a->message ? o.result == LAVES_ERROR_INPUT && strncmp(o.text, a->message, strlen(a->message)) == 0 : o.result == LAVES_OK;
  const bool out_of_time = test_stride() > 1 && strstr(o.text, "the script runs for more than 10 seconds");
  if (!as_told && !out_of_time) fail_msg("%.90s...: \"%s\", not \"%s\"", a->text, o.text, a->message ? a->message : "a solid");
  if (test_stride() == 1 && (o.seconds > second_limit || o.silence > silence_limit))
    fail_msg("%.90s...: %.2f s, %.2f s of them silent", a->text, o.seconds, o.silence);
}

/* ---- time ---- */

/* Each of these would go on for ever, or for years. */
static const attack endless[] = {
    {"while true do end", "name:1: the script takes more than 20 million steps"},
    {"local i = 1\nrepeat i = i + 1 until false", "name:2: the script takes more than"},
    {"::again::\ngoto again", "name:2: the script takes more than"},
    {"for i = 1, math.huge do end", "name:1: the script takes more than"},
    {"for i = 1, math.maxinteger do end", "name:1: the script takes more than"},
    {"\nlocal function f() return f() end\nf()", "name:2: the script takes more than"},
    {"local f\nlocal function g() return f() end\nf = function() return g() end\nf()", "name:"},
    {"table.sort({1, 2, 3}, function()\nwhile true do end end)", "name:2: the script takes more than"},
    {"local s = sphere(1)\nwhile true do local t = s | s end", "name:2: the script takes more than"},
    {"local p = {} for i = 1, 100 do p[i] = {1, 0, 0} end\nwhile true do keep(sphere(1), {points=p}) end",
     "name:2: keep: at most 1000000"},
    {"while true do keep(sphere(1), {points={{1, 0, 0}}}) end", "name:1: keep: at most 1000000"},
};

/* Slow in few steps, so that the clock must end them. */
static const attack slow[] = {
    {"local t = {}\nfor i = 1, 2e6 do t[i] = i end\nwhile true do table.insert(t, 1, 1) table.remove(t, 1) end",
     "name:3: the script runs for more than 10 seconds"},
    {"local t = {}\nfor i = 1, 1.5e6 do t[i] = i * 7919 % 1500007 end\nwhile true do table.sort(t) end",
     "name:3: the script runs for more than 10 seconds"},
    {"local s = 'x' for i = 1, 19 do s = s .. s end\nlocal a, b, t = s .. 'a', s .. 'b', {}\n"
     "for i = 1, 1e6 do t[i] = i % 2 == 0 and a or b end\ntable.sort(t)",
     "name:4: the script runs for more than 10 seconds"},
    {"local s = 'x' for i = 1, 19 do s = s .. s end\nlocal a, b = s .. 'a', s .. 'b'\nwhile true do local c = a < b end",
     "name:3: the script runs for more than 10 seconds"},
    {"local s = 'x' for i = 1, 19 do s = s .. s end\nwhile true do local c = s:reverse():upper():lower() end",
     "name:2: the script runs for more than 10 seconds"},
    {"local t = {} for i = 1, 5e5 do t[i] = 'x' end\nwhile true do local s = table.concat(t) end",
     "name:2: the script runs for more than 10 seconds"},
    {"local t = {} for i = 1, 5e5 do t[i] = 1 end\nwhile true do local a = table.pack(table.unpack(t)) end",
     "name:2: the script runs for more than 10 seconds"},
    {"local t = {} for i = 1, 2e5 do t[i] = 1 end\nwhile true do for k in pairs(t) do break end end", "name:2: the script runs"},
    {"while true do local s = string.format('%099.99f', 1e308) end", "name:1: the script runs for more than 10 seconds"},
};

static void endless_scripts_end(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(endless); i += (size_t)test_stride()) assert_ends(&endless[i], NULL);
  if (test_stride() == 1) assert_ends(&slow[0], NULL); /* takes its ten seconds; all of them are cancelled, below */
}

/* The border of such a table, found by doubling, is far out: its numbers are in the hash part from the start. */
#define DOUBLES(from) \
  "[1 << " #from "] = 1, [2 << " #from "] = 1, [4 << " #from "] = 1, [8 << " #from "] = 1, [16 << " #from "] = 1, "
#define HOLES                                                                                                          \
  "local t = {1, 2, 3, 4, [5] = 1, " DOUBLES(3) DOUBLES(8) DOUBLES(13) DOUBLES(18) DOUBLES(23) DOUBLES(28) DOUBLES(33) \
      DOUBLES(38) DOUBLES(43) DOUBLES(48) DOUBLES(53) "}\n"

/* A list with holes may claim to have 2^60 items, which insert and remove would move one by one. */
static void lists_with_holes_are_refused(void **state) {
  static const attack cases[] = {
      {HOLES "assert(#t > 1 << 40)\ntable.insert(t, 1, 0)",
       "name:3: table.insert: the table must be a list of at most 4194304 items without holes"},
      {HOLES "table.remove(t, 1)", "name:2: table.remove: the table must be a list"},
      {HOLES "return union(t)", "name:2: union: at most 100000 solids"},
      {HOLES "table.concat(t)", "name:2: invalid value"},
      {HOLES "table.sort(t)", "name:2: "},
      {HOLES "table.unpack(t)", "name:2: too many results"},
      {"local t = {1, 2, 3}\ntable.insert(t, 1, 0) table.insert(t, 5) assert(table.remove(t) == 5)\n"
       "assert(table.concat(t, ',') == '0,1,2,3' and table.remove(t, 1) == 0) return sphere(1)",
       NULL},
  };
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(cases); i++) assert_ends(&cases[i], NULL);
}

/* ---- memory ---- */

static const attack bombs[] = {
    {"local function f() return 1 + f() end\nf()", "name:1: "},
    {"local function f(...) return f(1, ...) end\nf()", "name:1: "},
    {"local function f(n) table.sort({1, 2}, function()\nf(n + 1) end) end\nf(0)", "name:"},
    {"local s = 'x'\nwhile true do s = s .. s end", "name:2: the script makes a text of more than 1 MiB"},
    {"local t = {} for i = 1, 1e6 do t[i] = 'xxxxxxxx' end\nlocal s = table.concat(t)",
     "name:2: the script makes a text of more than 1 MiB"},
    {"local t = {}\nwhile true do t = {t, {}} end", "name:2: the script needs more than 64 MiB"},
    {"local t = {}\nfor i = 1, 1e9 do t[i] = {} end", "name:2: the script needs more than 64 MiB"},
    {"local t = {}\nfor i = 1, 1e9 do t['k' .. i] = i end", "name:2: the script needs more than 64 MiB"},
    {"local t = table.pack(table.unpack({}, 1, 1e9))", "name:1: too many results to unpack"},
    {"return string.byte(('x'):upper(), 1, 1e9) and sphere(1)", NULL},
    {"local c = {}\nwhile true do c[#c + 1] = function() return c end end", "name:2: the script needs more than 64 MiB"},
    {"local s = sphere(1)\nfor i = 1, 1e7 do s = s | sphere(i):tag('t' .. i) end return s", "name:2: the "},
    {"for i = 1, 1e9 do local s = sphere(i) end", "name:1: the "},
    {"for i = 1, 1e9 do local s = sphere(1):move(i, 0, 0) end", "name:1: the "},
};

static void bombs_are_caught(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(bombs); i += (size_t)test_stride()) assert_ends(&bombs[i], NULL);
}

/* ---- what Lua has to hide in ---- */

static const attack tricks[] = {
    {"local m <close> = setmetatable({}, {__close = function() while true do end end})", "name:1: attempt to call a nil value"},
    {"local m <close> = sphere(1)\nreturn sphere(1)", "name:1: variable 'm' got a non-closable value"},
    {"local m <close> = nil\nlocal n <close> = false return sphere(1)", NULL},
    {"getmetatable(sphere(1)).__gc = function() end", "name:1: attempt to call a nil value"},
    {"sphere(1).__gc = function() end", "name:1: attempt to index a "},
    {"sphere(1).x = 1", "name:1: attempt to index a "},
    {"x.move = 1", "name:1: attempt to index a "},
    {"string.__add = function() while true do end end\nlocal s = '1' + 1 return sphere(s)", NULL},
    {"string.len = function() error('mine') end\nlocal s = ('x'):len()", "name:1: mine"},
    {"sphere = nil\nreturn sphere(1)", "name:2: attempt to call a nil value"},
    {"_ENV = {}\nreturn sphere(1)", "name:2: attempt to call a nil value"},
    {"local _ENV <const> = {sphere = sphere}\nreturn sphere(1)", NULL},
    {"coroutine.wrap(function() while true do end end)()", "name:1: attempt to index a nil value (global 'coroutine')"},
    {"load('while true do end')()", "name:1: attempt to call a nil value (global 'load')"},
    {"require('os').exit()", "name:1: attempt to call a nil value (global 'require')"},
    {"os.exit(0)", "name:1: attempt to index a nil value (global 'os')"},
    {"io.open('/etc/passwd')", "name:1: attempt to index a nil value (global 'io')"},
    {"debug.sethook()", "name:1: attempt to index a nil value (global 'debug')"},
    {"dofile('/dev/zero')", "name:1: attempt to call a nil value (global 'dofile')"},
    {"pcall(error)", "name:1: attempt to call a nil value (global 'pcall')"},
    {"local s = ('a?'):rep(30)", "name:1: attempt to call a nil value (method 'rep')"},
    {"local s = ('aaaa'):find('a?a?a?a?aaaa')", "name:1: attempt to call a nil value (method 'find')"},
    {"local s = ('aaaa'):gsub('.', '%0%0')", "name:1: attempt to call a nil value (method 'gsub')"},
    {"error()", "name:1: the script raised an error that is not a text"},
    {"\nerror(nil)", "name:2: the script raised an error that is not a text"},
    {"\nerror({})", "name:2: the script raised an error that is not a text"},
    {"error(sphere(1))", "name:1: the script raised an error that is not a text"},
    {"error(error)", "name:1: the script raised an error that is not a text"},
    {"error(12)", "name:1: 12"},
    {"error('mine', 0)", "name:1: mine"},
    {"error('name of nobody', 0)", "name:1: name of nobody"},
    {"error('%s%n%s%d')", "name:1: %s%n%s%d"},
    {"table.sort({1, 2, 3}, function() error(nil) end)", "name:1: the script raised an error that is not a text"},
    {"table.sort({1, 2, 3}, function(a, b) return true end) return sphere(1)", NULL},
    {"table.sort({1, 2, 3, 4, 5}, function(a, b) return a end)", "name:1: invalid order function"},
    {"\ntable.sort({1, 2, 3}, sphere)", "name:2: sphere"},
    {"\ntable.sort({1, 'a', {}, sphere(1)})", "name:2: attempt to compare"},
    {"\ntable.sort({sphere(1), sphere(2)})", "name:2: attempt to compare two "},
    {"table.sort(7)", "name:1: bad argument #1"},
    {"table.insert({}, 5, 5)", "name:1: bad argument #2"},
    {"table.insert()", "name:1: bad argument #1"},
    {"for k in pairs{[{}] = 1} do end", "name:1: pairs needs keys"},
    {"for k in pairs{[sphere(1)] = 1} do end", "name:1: pairs needs keys"},
    {"local t = {[0/1] = 1, [2^53] = 2, [-1e308] = 3, ['x'] = 4}\nfor k in pairs(t) do end return sphere(1)", NULL},
    {"string.format('%d', 0.5)", "name:1: bad argument #2"},
    {"string.format('%9999d', 1)", "name:1: invalid conversion"},
    {"string.char(-1)", "name:1: bad argument #1"},
    {"math.random(0) math.random(math.mininteger, math.maxinteger) return sphere(1)", NULL},
    {"math.random(2, 1)", "name:1: bad argument #"},
    {"return sphere(1 // 0)", "name:1: attempt to "},
    {"return sphere(1 % 0)", "name:1: "},
    {"return sphere(math.mininteger // -1)", "name:1: sphere: r must be a positive number"},
    {"return sphere, 1", "name: the script yields a function"},
    {"return", "name: the script yields nothing"},
    {"", "name: the script yields nothing"},
    {"\0", "name: the script yields nothing"},
    {"return {}", "name: the script yields a table"},
    {"return ...", "name: the script yields nothing"},
    {"return sphere", "name: the script yields a function"},
    {"\n\nreturn sphere(1", "name:3: "},
    {"\n\n\"unfinished", "name:3: "},
    {"--[[", "name:1: unfinished long comment"},
    {"goto nowhere", "name:1: no visible label"},
    {"local a <const> = 1\na = 2", "name:2: attempt to assign to const variable"},
};

static void tricks_end_with_their_line(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(tricks); i++) assert_ends(&tricks[i], NULL);
}

/* Brackets, blocks and operators as deep as a text can be. */
static void deep_texts_are_refused(void **state) {
  static const char *const parts[] = {"(", "{", "f(", "a.b[", "- ", "not ", "1 ..", "1 ^", "do ", "function() return "};
  (void)state;
  enum { DEPTH = 200000 };
  for (size_t i = 0; i < LAVES__COUNT_OF(parts); i++) {
    const size_t length = strlen(parts[i]);
    char *text = malloc(16 + DEPTH * length);
    assert_non_null(text);
    strcpy(text, parts[i][0] == 'd' ? "\n" : "\nreturn ");
    char *end = text + strlen(text);
    for (int k = 0; k < DEPTH; k++, end += length) memcpy(end, parts[i], length);
    *end = 0;
    assert_ends(&(attack){text, "name:2: "}, NULL);
    free(text);
  }
}

/* ---- expressions ---- */

static const attack giants[] = {
    {"local s = sphere(1) for i = 1, 60 do s = s + s end return s", NULL},
    {"local f = x*x + y*y + z*z - 1 for i = 1, 60 do f = f + f end return solid(f)", NULL},
    {"local f = x*x + y*y + z*z - 1 for i = 1, 2000 do f = f + f end return solid(f)", "name: the solid "},
    {"local f = x for i = 1, 60 do f = f * f + y end return bounds(solid(f), {-1, -1, -1}, {1, 1, 1})", NULL},
    {"local f = x for i = 1, 1e5 do f = sin(f) end return bounds(solid(f), {-1, -1, -1}, {1, 1, 1})", NULL},
    {"local f = x for i = 1, 999000 do f = sin(f) end return bounds(solid(f), {-1, -1, -1}, {1, 1, 1})", NULL},
    {"local f = x\nfor i = 1, 1.1e6 do f = sin(f) end", "name:2: the solid needs more than 1000000 operations"},
    {"local s = sphere(1) for i = 1, 1e5 do s = s:move(1e-9, 0, 0) end return s", NULL},
    {"local s = sphere(1) for i = 1, 5000 do s = warp(s, x + 1e-9 * sin(y), y, z) end return bounds(s, {-2,-2,-2}, {2,2,2})",
     NULL},
    {"local s = sphere(1) for i = 1, 40 do s = warp(s, x + s, y, z) end return s", "name:1: "},
    {"local s = sphere(1) for i = 1, 40 do s = s | s:move(2^i, 0, 0) end return s", "name: the solid needs more than 1000000"},
    {"local s = sphere(1) for i = 1, 8e5 do s = s:region(i % 2 == 0 and 'a' or 'b') end return s", NULL},
    {"local s = sphere(1) for i = 1, 4e5 do s = s:tag('t' .. i):region('r' .. i) end return s", NULL},
    {"local t = {} for i = 1, 1e5 do t[i] = sphere(1 + i * 1e-6):move(i * 1e-6, 0, 0) end return union(t)", NULL},
    {"return repeat_grid(sphere(0.3), {step={1, 1, 1}, count={400, 400, 1}})", NULL},
    {"return repeat_grid(sphere(0.3), {step={1, 1, 1}, count={1000, 1000, 1000}})",
     "name:1: repeat_grid: at most a million copies"},
    {"return repeat_linear(sphere(1), {step={1, 0, 0}, count=1e9})", "name:1: repeat_linear: count must be a whole number"},
    {"return repeat_linear(sphere(1), {step={1, 0, 0}, count=1e6})", "name:1: the solid needs more than 1000000"},
    {"return repeat_polar(sphere(1), {count=1e6})", "name:1: the solid needs more than 1000000"},
    {"local s = keep(sphere(1), {points={{1, 0, 0}}}) for i = 1, 16 do s = s | s:move(3, 0, 0) end return s", NULL},
    {"local s = keep(sphere(1), {points={{1, 0, 0}}})\nfor i = 1, 60 do s = s | s:move(3, 0, 0) end return s", "name:"},
    {"local b = {} for i = 1, 1e4 do b[i] = {i * 1e-4, 0, 0, 1} end return metaballs(b)", NULL},
    {"local t = {} for i = 1, 3000 do t[i] = sin(x * i) end local s = 0\nfor i = 1, 3000 do for j = 1, 20 do\n"
     "s = s + t[i] * t[(i * 7 + j * 131) % 3000 + 1] end end return solid(s) & box(1)",
     NULL},
};

static void giants_are_bounded(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(giants); i += (size_t)test_stride()) assert_ends(&giants[i], NULL);
}

/* What takes a while can be cancelled while it does. */
static void hostile_scripts_can_be_cancelled(void **state) {
  static const struct {
    const attack *list;
    size_t count;
  } lists[] = {{endless, LAVES__COUNT_OF(endless)},
               {slow, LAVES__COUNT_OF(slow)},
               {bombs, LAVES__COUNT_OF(bombs)},
               {giants, LAVES__COUNT_OF(giants)}};
  static const double cancel_after = 0.15;
  (void)state;
  int heard = 0;
  for (size_t l = 0; l < LAVES__COUNT_OF(lists); l++) {
    for (size_t i = 0; i < lists[l].count; i += (size_t)test_stride()) {
      const outcome o = run(lists[l].list[i].text, false, NULL, cancel_after);
      heard += o.result == LAVES_ERROR_CANCELLED;
      if (test_stride() == 1 && o.seconds > cancel_after + silence_limit)
        fail_msg("%.90s...: ended %.2f s after the cancel", lists[l].list[i].text, o.seconds - cancel_after);
    }
  }
  assert_true(heard > 0);
}

/* ---- numbers ---- */

static const char *const numbers[] = {"0/0",    "1/0",  "-1/0",   "1e308",   "-1e308",          "1e200",
                                      "-1e200", "1e99", "4e-324", "-4e-324", "1e-308",          "1e-200",
                                      "-1e-9",  "0",    "-0.0",   "1e-30",   "math.maxinteger", "math.mininteger",
                                      "'7'",    "nil",  "{}",     "x",       "sphere(1)"};

/* Calls in which each % is a number; the others are 1 meanwhile. */
static const char *const calls[] = {
    "sphere(%)",
    "ellipsoid(%, %, %)",
    "box(%, %, %)",
    "rounded_box(%, %, %, %)",
    "cylinder(%, %)",
    "cylinder(%) & box(1)",
    "capsule(%, %)",
    "cone(%, %, %)",
    "torus(%, %)",
    "halfspace{normal={%, %, %}, offset=%} & box(3)",
    "plane{normal={%, %, %}, offset=%} & box(3)",
    "gyroid(%, %, %) & box(1)",
    "schwarz_p(%, %, %) & box(1)",
    "schwarz_d(%, %, %) & box(1)",
    "metaballs{{%, %, %, %}, {0, 0, 0, 1}, sharpness=%}",
    "smooth_union(sphere(1), box(1), %)",
    "smooth_intersection(sphere(1), box(1), %)",
    "smooth_difference(sphere(1), box(1), %)",
    "offset(sphere(1), %)",
    "shell(sphere(1), %)",
    "morph(sphere(1), box(1), %)",
    "bounds(sphere(1), {%, %, %}, {%, %, %})",
    "move(sphere(1), %, %, %)",
    "rotate(box(1, 2, 3), %, {%, %, %})",
    "scale(sphere(1), %)",
    "scale(sphere(1), {%, %, %})",
    "mirror(box(1, 2, 3), {%, %, %})",
    "repeat_linear(sphere(1), {step={%, %, %}, count=3})",
    "repeat_linear(sphere(1), {step={1, 0, 0}, count=%})",
    "repeat_grid(sphere(1), {step={%, %, %}, count={2, 2, 2}})",
    "repeat_grid(sphere(1), {step={1, 1, 1}, count={%, %, %}})",
    "repeat_polar(box(1, 2, 3), {count=3, axis={%, %, %}, angle=%})",
    "repeat_polar(box(1, 2, 3), {count=%})",
    "warp(sphere(1), x * %, y + %, z - %) & box(1)",
    "keep(sphere(1), {points={{%, %, %}}, lines={{{%, %, %}, {0, 0, 1}}}})",
    "tag(%, sphere(1))",
    "region(sphere(1), %)",
    "union(sphere(1), %)",
    "solid(x * % + y / % - z + %) & box(1)",
    "solid(x ^ % + %) & box(1)",
    "solid(x % %) & box(1)", /* the first is the operator, as it stands for itself below */
    "solid(mod(x, %) + atan2(y, %) + pow(abs(z), %)) & box(1)",
    "solid(min(x, %) + max(y, %) + length(x, %, %)) & box(1)",
    "solid(sin(% * x) + cos(% * y) + tan(% * z)) & box(1)",
    "solid(asin(x + %) + acos(y * %) + exp(% * z)) & box(1)",
    "solid(log(x * %) + floor(% * y) + ceil(% * z) + sqrt(x + %)) & box(1)",
    "sphere(math.sqrt(%) + math.exp(%) + math.fmod(%, 2) + math.abs(%))",
    "x*x + y*y + z*z - %",
};

/* The call with its hole number `hole` filled; all the others are 1. False: it has no such hole. A % between blanks that follows
 * x is Lua's own. */
static bool fill(const char *call, int hole, const char *number, char *text) {
  int seen = 0;
  for (const char *c = call; *c; c++) {
    const bool is_operator = *c == '%' && strncmp(c, "% %", 3) == 0;
    if (*c != '%' || is_operator) {
      *text++ = *c;
      continue;
    }
    text += sprintf(text, "(%s)", seen++ == hole ? number : "1");
  }
  *text = 0;
  return hole < seen;
}

static void wild_numbers_are_refused_or_harmless(void **state) {
  (void)state;
  for (size_t i = 0; i < LAVES__COUNT_OF(calls); i++) {
    for (int hole = 0; hole < 10; hole++) {
      for (size_t k = 0; k < LAVES__COUNT_OF(numbers); k += (size_t)test_stride()) {
        char text[500];
        if (!fill(calls[i], hole, numbers[k], text)) break;
        const outcome o = run(text, true, NULL, INFINITY);
        const bool has_sentence = strncmp(o.text, "name:", 5) == 0 || strncmp(o.text, "keep: a point has", 17) == 0;
        if (o.result != LAVES_OK && (o.result != LAVES_ERROR_INPUT || !has_sentence))
          fail_msg("%s: %d \"%s\"", text, o.result, o.text);
        if (test_stride() == 1 && o.seconds > 5) fail_msg("%s: %.2f s", text, o.seconds);
      }
    }
  }
}

/* ---- files ---- */

static const char tetrahedron[] = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

static void write_file(const char *folder, const char *name, const char *text) {
  char path[300];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

static const attack file_attacks[] = {
    {"return surface('tet.off')", NULL},
    {"return surface('./tet.off') - surface('tet.off'):move(0.1, 0, 0)", NULL},
    {"local s = surface('tet.off')\nfor i = 1, 1e5 do s = s | surface('tet.off') end return s", NULL},
    {"while true do surface('tet.off') end", "name:1: the script "},
    {"local p = 'tet.off'\nfor i = 1, 2000 do p = './' .. p surface(p) end", "name:2: surface: at most 1000 files"},
    {"\nreturn surface('pipe')", "name:2: surface: "},
    {"\nreturn surface('/dev/zero')", "name:2: surface: /dev/zero is a device"},
    {"\nreturn surface('/dev/stdin')", "name:2: surface: "},
    {"\nreturn surface('.')", "name:2: surface: "},
    {"\nreturn surface('/')", "name:2: surface: / is a directory"},
    {"\nreturn surface('')", "name:2: surface: "},
    {"\nreturn surface('loop')", "name:2: surface: "},
    {"\nreturn surface('self.lua')", "name:2: surface: "},
    {"\nreturn surface('empty.stl')", "name:2: surface: "},
    {"\nreturn surface('no\\0thing')", "name:2: surface: "},
    {"\nlocal p = 'x' for i = 1, 16 do p = p .. p end return surface(p)", "name:2: surface: "},
    {"\nreturn surface()", "name:2: surface: expected the name of a file"},
    {"\nreturn surface{}", "name:2: surface: expected the name of a file"},
};

static void files_of_scripts_are_bounded(void **state) {
  (void)state;
  char folder[] = "/tmp/laves-hostile-XXXXXX", path[300];
  static const char *const names[] = {"tet.off", "self.lua", "empty.stl", "pipe", "loop"};
  assert_non_null(mkdtemp(folder));
  write_file(folder, "tet.off", tetrahedron);
  write_file(folder, "self.lua", "return surface('self.lua')\n");
  write_file(folder, "empty.stl", "");
  snprintf(path, sizeof path, "%s/pipe", folder);
  assert_int_equal(mkfifo(path, 0600), 0);
  snprintf(path, sizeof path, "%s/loop", folder);
  assert_int_equal(symlink("loop", path), 0);
  for (size_t i = 0; i < LAVES__COUNT_OF(file_attacks); i++) assert_ends(&file_attacks[i], folder);
  for (size_t i = 0; i < LAVES__COUNT_OF(names); i++) {
    snprintf(path, sizeof path, "%s/%s", folder, names[i]);
    unlink(path);
  }
  assert_int_equal(rmdir(folder), 0);
}

/* test_script_hostile [NAME]: the tests of that name, which may have * and ?. */
int main(int count, char **words) {
  if (count > 1) cmocka_set_test_filter(words[1]);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(endless_scripts_end),
      cmocka_unit_test(lists_with_holes_are_refused),
      cmocka_unit_test(bombs_are_caught),
      cmocka_unit_test(tricks_end_with_their_line),
      cmocka_unit_test(deep_texts_are_refused),
      cmocka_unit_test(giants_are_bounded),
      cmocka_unit_test(hostile_scripts_can_be_cancelled),
      cmocka_unit_test(wild_numbers_are_refused_or_harmless),
      cmocka_unit_test(files_of_scripts_are_bounded),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
