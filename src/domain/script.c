/* The sandbox: runs a Lua chunk with a vocabulary of solids and with bounds on all that it may use.
 *
 * The chunk sees a table of its own: the vocabulary, and of Lua what computes without reaching outside or hiding an error
 * (no pcall, so that no limit can be swallowed; no load, require, io, os, debug, coroutines, metatables; of strings
 * no patterns and no rep, whose cost no limit would see). Text only, no byte code. Memory is counted by the allocator,
 * steps by a hook, and a clock catches what is slow in few steps: it is read at every call and every hundred steps. What is left
 * is how long one step or call can take, so texts have a length limit of their own, sorting calls a function for each comparison,
 * and lists have no more items than fit into memory. pairs() goes in sorted order and math.random() starts from a fixed seed, so
 * a script means the same solid on every run. */
#include "domain/script.h"

#include "domain/kept.h"

#include <lauxlib.h>
#include <lua.h>
#include <lualib.h>
#include <stdlib.h>
#include <string.h>

/* Lua's own memory; the solid is counted apart, by LAVES__NODE_LIMIT. */
static const size_t lua_byte_limit = (size_t)64 << 20;
/* Of one text: comparing or joining two of them is one step. */
static const size_t text_byte_limit = (size_t)1 << 20;
/* Of a list that a function goes through. More do not fit into memory, but a list with holes may claim any length. */
static const lua_Integer item_limit = 1 << 22;
/* Virtual machine instructions: about 0.2 seconds of plain arithmetic. */
static const size_t step_limit = 20000000;
/* Few steps can be slow (inserting at the front of a huge table); far above what honest scripts take. */
static const double second_limit = 10;
/* Steps between two looks at the clock. */
enum { STEPS_PER_LOOK = 100 };
/* Turns of a loop within a function between two of them: a power of two. */
enum { TURNS_PER_LOOK = 256 };
/* Between two reports of progress. */
static const double seconds_per_report = 0.02;

laves__script *laves__script_of(lua_State *L) { return *(laves__script **)lua_getextraspace(L); }

/* ---- limits ---- */

/* The line that the script has come to, or 0. Walks call records only, so it is safe inside the allocator. */
static int current_line(lua_State *L) {
  lua_Debug record;
  for (int level = 0; lua_getstack(L, level, &record); level++)
    if (lua_getinfo(L, "l", &record) && record.currentline > 0) return record.currentline;
  return 0;
}

static void *allocate(void *user, void *block, size_t old_bytes, size_t new_bytes) {
  laves__script *script = user;
  const bool is_text = !block && old_bytes == LUA_TSTRING; /* Lua passes the kind of a new object there */
  if (!block) old_bytes = 0;
  if (new_bytes == 0) {
    laves__free(script->context, block, old_bytes, 1);
    script->lua_bytes -= old_bytes;
    return NULL;
  }
  if (is_text && new_bytes > text_byte_limit) {
    script->over_text = true;
  } else if (new_bytes > old_bytes && script->lua_bytes - old_bytes + new_bytes > lua_byte_limit) {
    script->over_limit = true;
  } else {
    void *result = laves__realloc(script->context, block, old_bytes, new_bytes, 1);
    if (result) {
      script->lua_bytes += new_bytes - old_bytes;
      return result;
    }
    script->over_memory = true;
  }
  if (script->lua) script->line = current_line(script->lua);
  return NULL;
}

/* Raises the end of the script. */
static void stop(lua_State *L, const char *what) {
  lua_pushfstring(L, "%s:%d: %s", laves__script_of(L)->name, current_line(L), what);
  lua_error(L);
}

static void look_at_clock(lua_State *L) {
  laves__script *script = laves__script_of(L);
  const double now = laves__wall_seconds();
  if (now - script->started > second_limit) stop(L, "the script runs for more than 10 seconds; is there an endless loop?");
  if (now - script->asked < seconds_per_report) return;
  script->asked = now;
  script->cancelled = laves__cancelled(script->context, "script", 0);
  if (script->cancelled) stop(L, "cancelled");
}

void laves__script_ask(lua_State *L, size_t index) {
  if (index % TURNS_PER_LOOK == 0) look_at_clock(L);
}

/* The hook: after some steps, and at each call of a function. */
static void look(lua_State *L, lua_Debug *record) {
  laves__script *script = laves__script_of(L);
  if (record->event == LUA_HOOKCOUNT) script->steps += STEPS_PER_LOOK;
  if (script->steps > step_limit) stop(L, "the script takes more than 20 million steps; is there an endless loop?");
  look_at_clock(L);
}

/* ---- what of Lua the script sees ---- */

static int compare_keys(lua_State *L, int a, int b) {
  const bool number_a = lua_type(L, a) == LUA_TNUMBER, number_b = lua_type(L, b) == LUA_TNUMBER;
  if (number_a != number_b) return number_a;
  return lua_compare(L, a, b, LUA_OPLT);
}

/* Lua function for table.sort: numbers before strings, each ascending. */
static int key_is_less(lua_State *L) {
  lua_pushboolean(L, compare_keys(L, 1, 2));
  return 1;
}

/* Iterator over upvalues: table, sorted keys, position. */
static int next_sorted(lua_State *L) {
  const lua_Integer position = lua_tointeger(L, lua_upvalueindex(3)) + 1;
  lua_pushinteger(L, position);
  lua_replace(L, lua_upvalueindex(3));
  if (lua_geti(L, lua_upvalueindex(2), position) == LUA_TNIL) return 1;
  lua_pushvalue(L, -1);
  lua_gettable(L, lua_upvalueindex(1));
  return 2;
}

/* pairs() in the order of the keys: Lua's own order changes from run to run. Upvalue: table.sort. */
static int sorted_pairs(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  lua_pushvalue(L, 1);
  lua_newtable(L);
  lua_Integer count = 0;
  for (lua_pushnil(L); lua_next(L, 2); lua_pop(L, 1)) {
    const int type = lua_type(L, -2);
    if (type != LUA_TNUMBER && type != LUA_TSTRING) return luaL_error(L, "pairs needs keys that are numbers or strings");
    lua_pushvalue(L, -2);
    lua_seti(L, 3, ++count);
  }
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_pushvalue(L, 3);
  lua_pushcfunction(L, key_is_less);
  lua_call(L, 2, 0);
  lua_pushinteger(L, 0);
  lua_pushcclosure(L, next_sorted, 3);
  return 1;
}

/* Lua function for table.sort, whose every call is a look at the clock. */
static int is_less(lua_State *L) {
  lua_pushboolean(L, lua_compare(L, 1, 2, LUA_OPLT));
  return 1;
}

/* table.sort with a function in any case. Upvalue: Lua's own. */
static int sort(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 2);
  if (lua_isnil(L, 2)) {
    lua_pushcfunction(L, is_less);
    lua_replace(L, 2);
  }
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, 2, 0);
  return 0;
}

/* table.insert and table.remove, which move as many items as the list claims to have. Upvalues: Lua's own function, its name. */
static int of_list(lua_State *L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  if (luaL_len(L, 1) > item_limit)
    return luaL_error(L, "table.%s: the table must be a list of at most %d items without holes",
                      lua_tostring(L, lua_upvalueindex(2)), (int)item_limit);
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
  return lua_gettop(L);
}

/* Puts bounds on what the table library on top of the stack does in one call. */
static void bound_lists(lua_State *L) {
  static const char *const functions[] = {"insert", "remove", NULL};
  lua_getfield(L, -1, "sort");
  lua_pushcclosure(L, sort, 1);
  lua_setfield(L, -2, "sort");
  for (const char *const *name = functions; *name; name++) {
    lua_getfield(L, -1, *name);
    lua_pushstring(L, *name);
    lua_pushcclosure(L, of_list, 2);
    lua_setfield(L, -2, *name);
  }
}

static void copy_fields(lua_State *L, int from, int to, const char *const *names) {
  for (; *names; names++) {
    lua_getfield(L, from, *names);
    lua_setfield(L, to, *names);
  }
}

/* Loads a library and leaves a table of the chosen ones of its functions. */
static void push_library(lua_State *L, const char *name, lua_CFunction open, const char *const *names) {
  luaL_requiref(L, name, open, 0);
  lua_newtable(L);
  copy_fields(L, lua_gettop(L) - 1, lua_gettop(L), names);
  lua_remove(L, -2);
}

/* Leaves the script's globals on the stack. */
static void push_globals(lua_State *L) {
  static const char *const base[] = {"assert", "error", "ipairs", "select", "tonumber", "tostring", "type", NULL};
  static const char *const table[] = {"concat", "insert", "remove", "sort", "unpack", "pack", NULL};
  static const char *const string[] = {"byte", "char", "format", "len", "lower", "reverse", "sub", "upper", NULL};
  static const char *const math[] = {"huge", "pi",     "maxinteger", "mininteger", "tointeger", "type",
                                     "ult",  "random", "randomseed", "fmod",       "modf",      NULL};
  push_library(L, "_G", luaopen_base, base);
  const int globals = lua_gettop(L);

  push_library(L, LUA_TABLIBNAME, luaopen_table, table);
  lua_getfield(L, -1, "sort");
  lua_pushcclosure(L, sorted_pairs, 1);
  lua_setfield(L, globals, "pairs");
  bound_lists(L);
  lua_setfield(L, globals, "table");

  push_library(L, LUA_STRLIBNAME, luaopen_string, string);
  lua_pushliteral(L, "");
  lua_getmetatable(L, -1); /* so that ("text"):upper() finds the chosen functions only */
  lua_pushvalue(L, -3);
  lua_setfield(L, -2, "__index");
  lua_pop(L, 2);
  lua_setfield(L, globals, "string");

  push_library(L, LUA_MATHLIBNAME, luaopen_math, math);
  lua_getfield(L, -1, "randomseed");
  lua_pushinteger(L, 1);
  lua_call(L, 1, 0);
  lua_setfield(L, globals, "math");

  laves__script_add_fields(L);
  laves__script_add_primitives(L);
  laves__script_add_solids(L);
}

/* ---- running ---- */

typedef struct job {
  const char *text;
  size_t length;
  bool is_expression;
  bool is_size; /* the chunk leaves a size of elements, not a solid */
} job;

/* Gives out a text line by line, so that it is known how far Lua has read. */
typedef struct text_reader {
  const char *before; /* the text, or NULL */
  const char *text;
  size_t length;
} text_reader;

static const char *read_part(lua_State *L, void *user, size_t *length) {
  text_reader *reader = user;
  const char *part = reader->before;
  if (part) {
    reader->before = NULL;
    *length = strlen(part);
    return part;
  }
  if (reader->length == 0) {
    *length = 0;
    return NULL;
  }
  part = reader->text;
  const char *end = memchr(part, '\n', reader->length);
  *length = end ? (size_t)(end - part) + 1 : reader->length;
  reader->text += *length;
  reader->length -= *length;
  laves__script_of(L)->line++;
  return part;
}

/* What the chunk returned goes into the model. */
static void take_solid(lua_State *L, laves__script *script) {
  if (!laves__script_value(L, -1))
    luaL_error(L, "%s: the script yields %s; it must return a solid, or a field that is negative inside", script->name,
               laves__script_type(L, -1));
  script->model->shape = laves__script_solid(L, -1, "return");
  if (script->model->expression.out_of_memory) luaL_error(L, "out of memory");
  if (laves__kept_is_too_large(&script->model->expression))
    luaL_error(L, "%s: keep: at most %d points and vertices, copies counted", script->name, (int)LAVES__KEPT_LIMIT);
}

static void take_size(lua_State *L, laves__script *script) {
  const laves__value *value = laves__script_value(L, -1);
  if (value ? value->kind == LAVES__SOLID : lua_type(L, -1) != LUA_TNUMBER)
    luaL_error(L, "%s: the script yields %s; a size must be a number or a field of x, y, z and d", script->name,
               laves__script_type(L, -1));
  const laves__node size = laves__script_field(L, -1, "return");
  if (size == LAVES__NO_NODE) luaL_error(L, "out of memory");
  script->model->shape = laves__shape_of_node(size);
}

/* Runs within lua_pcall; upvalue-free, the job is a light userdata. Leaves the solid in the model. */
static int run(lua_State *L) {
  const job *work = lua_touserdata(L, 1);
  laves__script *script = laves__script_of(L);
  push_globals(L);
  if (work->is_size) laves__script_add_depth(L, 0);
  text_reader reader = {work->is_expression ? "return " : NULL, work->text, work->length};
  lua_pushfstring(L, "=%s", script->name);
  if (lua_load(L, read_part, &reader, lua_tostring(L, -1), "t") != LUA_OK) return lua_error(L);
  script->line = 0;
  lua_pushvalue(L, 2);
  lua_setupvalue(L, -2, 1);
  lua_sethook(L, look, LUA_MASKCALL | LUA_MASKCOUNT, STEPS_PER_LOOK);
  lua_call(L, 0, 1);
  lua_sethook(L, NULL, 0, 0);
  if (work->is_size)
    take_size(L, script);
  else
    take_solid(L, script);
  return 0;
}

/* Whether a message begins with where it arose, as "name:12: ". */
static bool tells_where(const laves__script *script, const char *text) {
  const size_t length = strlen(script->name);
  return strncmp(text, script->name, length) == 0 && text[length] == ':';
}

/* Message handler: an error that does not tell where it arose is on the line that the script had come to. */
static int note_line(lua_State *L) {
  laves__script *script = laves__script_of(L);
  const int line = current_line(L);
  if (line > 0) script->line = line;
  return 1;
}

static laves_result fail_at(const laves__script *script, laves_error *error, const char *text) {
  if (script->line > 0) return laves__fail(error, LAVES_ERROR_INPUT, "%s:%d: %s", script->name, script->line, text);
  return laves__fail(error, LAVES_ERROR_INPUT, "%s: %s", script->name, text);
}

static laves_result explain(laves__script *script, lua_State *L, int status, laves_error *error) {
  if (script->cancelled) return laves__fail_cancelled(error);
  if (script->over_memory || script->model->expression.out_of_memory) return laves__fail_memory(script->context, error);
  if (script->over_text) return fail_at(script, error, "the script makes a text of more than 1 MiB; does it grow without end?");
  if (status == LUA_ERRMEM || script->over_limit)
    return fail_at(script, error,
                   "the script needs more than 64 MiB of memory; does it recurse, or grow a table or text, without end?");
  const char *text = lua_tostring(L, -1);
  if (!text) text = "the script raised an error that is not a text";
  if (status == LUA_ERRERR || strstr(text, "C stack overflow"))
    return fail_at(script, error, "brackets or calls are nested too deeply");
  if (tells_where(script, text)) return laves__fail(error, LAVES_ERROR_INPUT, "%s", text);
  return fail_at(script, error, text);
}

/* The model is set up, and holds the leaf of d where there is one. */
static laves_result run_job(laves_context *context, job *work, const char *name, const char *folder, laves__model *model,
                            laves_error *error) {
  laves__script script = {.context = context, .model = model, .name = name, .folder = folder, .started = laves__wall_seconds()};
  script.asked = script.started;
  lua_State *L = lua_newstate(allocate, &script);
  if (!L) return laves__fail_memory(context, error);
  script.lua = L;
  *(laves__script **)lua_getextraspace(L) = &script;
  lua_pushcfunction(L, note_line);
  lua_pushcfunction(L, run);
  lua_pushlightuserdata(L, work);
  const int status = lua_pcall(L, 1, 0, -3);
  const laves_result result = status == LUA_OK ? LAVES_OK : explain(&script, L, status, error);
  script.lua = NULL;
  lua_close(L);
  return result;
}

laves_result laves__script_run(laves_context *context, const char *text, size_t length, bool is_expression, const char *name,
                               const char *folder, laves__model *model, laves_error *error) {
  *model = (laves__model){0};
  laves__expression_init(&model->expression, context);
  job work = {text, length, is_expression, false};
  const laves_result result = run_job(context, &work, name, folder, model, error);
  return result == LAVES_OK ? laves__kept_list(&model->expression, model->shape.kept, &model->kept, error) : result;
}

laves_result laves__script_run_size(laves_context *context, const char *text, size_t length, bool is_expression, const char *name,
                                    const char *folder, laves__model *model, laves_error *error) {
  *model = (laves__model){0};
  laves__expression_init(&model->expression, context);
  if (!laves__grow(context, &model->leaves, &model->leaf_capacity, 1, sizeof *model->leaves))
    return laves__fail_memory(context, error);
  model->leaves[model->leaf_count++] = NULL;
  job work = {text, length, is_expression, true};
  return run_job(context, &work, name, folder, model, error);
}

int32_t laves__model_name(laves_context *context, laves__tag_list *list, const char *rest, const char *name, size_t length) {
  if (list->count == 0 && !laves__tag_list_start(context, list, rest, strlen(rest), 0, "")) return -1;
  return laves__tag_list_start(context, list, name, length, 0, "") ? list->current : -1;
}

void laves__model_free(laves_context *context, laves__model *model) {
  for (size_t i = 0; i < model->leaf_count; i++) laves_domain_free(model->leaves[i]);
  laves__free(context, model->leaves, model->leaf_capacity, sizeof *model->leaves);
  laves__tag_list_free(context, &model->names);
  laves__tag_list_free(context, &model->regions);
  laves__free(context, model->leaf_tag_first, model->leaf_first_capacity, sizeof *model->leaf_tag_first);
  laves__free(context, model->leaf_tags, model->leaf_tag_capacity, sizeof *model->leaf_tags);
  laves_features_free(model->kept);
  laves__expression_free(&model->expression);
  *model = (laves__model){0};
}
