/* Values of the script's vocabulary and the reading of arguments, with messages that name the function and the parameter. */
#include <lauxlib.h>
#include <lua.h>
#include <math.h>
#include <string.h>

#include "domain/script.h"

static const char *const metatable_name[] = {[LAVES__FIELD] = "field", [LAVES__SOLID] = "solid"};

int laves__script_push(lua_State *L, laves__value_kind kind, laves__shape shape) {
  if (shape.node == LAVES__NO_NODE) {
    if (laves__script_of(L)->model->expression.too_large)
      return luaL_error(L, "the solid needs more than %d operations; make it of fewer parts", (int)LAVES__NODE_LIMIT);
    return luaL_error(L, "out of memory");
  }
  laves__value *value = lua_newuserdatauv(L, sizeof *value, 0);
  *value = (laves__value){shape, kind};
  luaL_setmetatable(L, metatable_name[kind]);
  return 1;
}

laves__value *laves__script_value(lua_State *L, int index) {
  laves__value *value = luaL_testudata(L, index, metatable_name[LAVES__SOLID]);
  return value ? value : luaL_testudata(L, index, metatable_name[LAVES__FIELD]);
}

const char *laves__script_type(lua_State *L, int index) {
  const laves__value *value = laves__script_value(L, index);
  if (value) return value->kind == LAVES__SOLID ? "a solid" : "a field";
  switch (lua_type(L, index)) {
    case LUA_TNONE:
    case LUA_TNIL:
      return "nothing";
    case LUA_TNUMBER:
      return "a number";
    case LUA_TSTRING:
      return "a text";
    case LUA_TTABLE:
      return "a table";
    case LUA_TFUNCTION:
      return "a function";
    default:
      return "a truth value";
  }
}

laves__shape laves__script_solid(lua_State *L, int index, const char *function) {
  const laves__value *value = laves__script_value(L, index);
  if (!value) luaL_error(L, "%s: expected a solid, not %s", function, laves__script_type(L, index));
  LAVES_ASSERT(value); /* luaL_error does not return */
  return value->kind == LAVES__SOLID ? value->shape : laves__shape_of_node(value->shape.node);
}

/* ---- arguments ---- */

static bool is_vector(laves__parameter_kind kind) { return kind == LAVES__VECTOR || kind == LAVES__COUNTS; }

static void check_number(lua_State *L, const char *function, const laves__parameter *p, double value) {
  const char *wanted = NULL;
  if (p->kind == LAVES__POSITIVE && !(value > 0)) wanted = "a positive number";
  if (p->kind == LAVES__NONNEGATIVE && !(value >= 0)) wanted = "zero or a positive number";
  if ((p->kind == LAVES__COUNT || p->kind == LAVES__COUNTS) && !(value >= 1 && value <= 1e6 && value == floor(value)))
    wanted = "a whole number from 1 to 1000000";
  if (!isfinite(value)) wanted = "a finite number";
  if (wanted) luaL_error(L, "%s: %s must be %s, not %f", function, p->name, wanted, value);
}

double laves__script_number(lua_State *L, const char *function, const laves__parameter *p, int index) {
  if (lua_type(L, index) != LUA_TNUMBER)
    luaL_error(L, "%s: %s must be a number, not %s", function, p->name, laves__script_type(L, index));
  const double value = lua_tonumber(L, index);
  check_number(L, function, p, value);
  return value;
}

/* {x, y, z} or {x=, y=, z=}, or the name of an axis. */
static void vector_at(lua_State *L, const char *function, const laves__parameter *p, int index, double *out) {
  static const char *const axes[] = {"x", "y", "z"};
  index = lua_absindex(L, index);
  if (lua_type(L, index) == LUA_TSTRING) {
    const char *text = lua_tostring(L, index);
    for (int i = 0; i < 3; i++) out[i] = strcmp(text, axes[i]) == 0;
    if (out[0] + out[1] + out[2] == 1) return;
    luaL_error(L, "%s: %s must be {x, y, z} or one of \"x\", \"y\", \"z\", not \"%s\"", function, p->name, text);
  }
  if (lua_type(L, index) != LUA_TTABLE)
    luaL_error(L, "%s: %s must be {x, y, z}, not %s", function, p->name, laves__script_type(L, index));
  for (int i = 0; i < 3; i++) {
    if (lua_geti(L, index, i + 1) == LUA_TNIL) {
      lua_pop(L, 1);
      lua_getfield(L, index, axes[i]);
    }
    if (lua_isnil(L, -1)) luaL_error(L, "%s: %s must have three numbers, as in {x, y, z}", function, p->name);
    out[i] = laves__script_number(L, function, p, -1);
    lua_pop(L, 1);
  }
}

static int places(const laves__parameter *p) { return is_vector(p->kind) ? 3 : 1; }

static void fall_back(lua_State *L, const char *function, const laves__parameter *p, double *out) {
  if (isnan(p->fallback)) luaL_error(L, "%s: %s is missing", function, p->name);
  if (is_vector(p->kind)) out[0] = out[1] = 0;
  out[places(p) - 1] = p->fallback;
}

static void refuse_key(lua_State *L, const char *function, const laves__parameter *parameters, int count) {
  luaL_Buffer known;
  const char *key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "(not a name)";
  lua_pushvalue(L, -2);
  luaL_buffinit(L, &known);
  for (int i = 0; i < count; i++) {
    if (i) luaL_addstring(&known, i + 1 < count ? ", " : " and ");
    luaL_addstring(&known, parameters[i].name);
  }
  luaL_pushresult(&known);
  luaL_error(L, "%s has no option '%s'; it knows %s", function, key, lua_tostring(L, -1));
}

/* Every key of the table must be known: a name, or a position where values stand without names. */
static void check_keys(lua_State *L, const char *function, int table, const laves__parameter *parameters, int count) {
  for (lua_pushnil(L); lua_next(L, table); lua_pop(L, 1)) {
    bool known = lua_isinteger(L, -2) && lua_tointeger(L, -2) >= 1 && lua_tointeger(L, -2) <= count;
    for (int i = 0; i < count && !known; i++)
      known = lua_type(L, -2) == LUA_TSTRING && strcmp(lua_tostring(L, -2), parameters[i].name) == 0;
    if (!known) refuse_key(L, function, parameters, count);
  }
}

static bool has_names(lua_State *L, int table, const laves__parameter *parameters, int count) {
  for (int i = 0; i < count; i++) {
    const bool found = lua_getfield(L, table, parameters[i].name) != LUA_TNIL;
    lua_pop(L, 1);
    if (found) return true;
  }
  return false;
}

static void from_table(lua_State *L, const char *function, int table, const laves__parameter *parameters, int count,
                       double *values) {
  check_keys(L, function, table, parameters, count);
  for (int i = 0; i < count; i++) {
    const laves__parameter *p = &parameters[i];
    if (lua_getfield(L, table, p->name) == LUA_TNIL) {
      lua_pop(L, 1);
      lua_geti(L, table, i + 1);
    }
    if (lua_isnil(L, -1))
      fall_back(L, function, p, values);
    else if (is_vector(p->kind))
      vector_at(L, function, p, -1, values);
    else
      *values = laves__script_number(L, function, p, -1);
    lua_pop(L, 1);
    values += places(p);
  }
}

void laves__script_arguments(lua_State *L, const char *function, int first, const laves__parameter *parameters, int count,
                             double *values) {
  const int last = lua_gettop(L);
  if (first == last && lua_istable(L, first) && (!is_vector(parameters[0].kind) || has_names(L, first, parameters, count))) {
    from_table(L, function, first, parameters, count, values);
    return;
  }
  int index = first;
  for (int i = 0; i < count; i++) {
    const laves__parameter *p = &parameters[i];
    if (lua_isnoneornil(L, index)) {
      fall_back(L, function, p, values);
      index++;
    } else if (is_vector(p->kind) && lua_type(L, index) == LUA_TNUMBER) {
      for (int k = 0; k < 3; k++) values[k] = laves__script_number(L, function, p, index++);
    } else if (is_vector(p->kind)) {
      vector_at(L, function, p, index++, values);
    } else {
      *values = laves__script_number(L, function, p, index++);
    }
    values += places(p);
  }
  if (last >= index) luaL_error(L, "%s takes no more than %d arguments", function, index - first);
}
