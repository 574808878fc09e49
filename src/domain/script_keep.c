/* keep() in scripts: points and lines that a solid carries along, to be vertices and edges of the mesh. */
#include <lauxlib.h>
#include <lua.h>
#include <math.h>
#include <string.h>

#include "domain/kept.h"
#include "domain/script.h"

static laves__expression *store(lua_State *L) { return &laves__script_of(L)->model->expression; }

/* Raises what a failed call left in the store. */
static int fail_kept(lua_State *L) {
  if (laves__kept_is_too_large(store(L)))
    return luaL_error(L, "keep: at most %d points and vertices, copies counted", (int)LAVES__KEPT_LIMIT);
  return luaL_error(L, "out of memory");
}

/* The length of the list on top of the stack. */
static lua_Integer list_length(lua_State *L, const char *what) {
  if (!lua_istable(L, -1)) luaL_error(L, "keep: %s, not %s", what, laves__script_type(L, -1));
  const lua_Integer count = luaL_len(L, -1);
  if (count < 0 || count > LAVES__KEPT_LIMIT) luaL_error(L, "keep: at most %d points", (int)LAVES__KEPT_LIMIT);
  return count;
}

/* Item `index` of the list on top of the stack, as a point. */
static laves__vec3 point_of(lua_State *L, lua_Integer index) {
  static const laves__parameter p = {"each point", LAVES__VECTOR, NAN};
  double v[3];
  lua_geti(L, -1, index);
  laves__script_arguments(L, "keep", lua_gettop(L), &p, 1, v);
  lua_pop(L, 1);
  return v3(v[0], v[1], v[2]);
}

static void take_points(lua_State *L) {
  const lua_Integer count = list_length(L, "points must be a list, as in points={{0, 0, 1}}");
  for (lua_Integer i = 1; i <= count; i++) {
    laves__script_ask(L, (size_t)i);
    if (!laves__kept_add_point(store(L), point_of(L, i))) fail_kept(L);
  }
}

static void take_lines(lua_State *L) {
  const lua_Integer count = list_length(L, "lines must be a list of lists of points, as in lines={{{0, 0, 1}, {1, 0, 1}}}");
  for (lua_Integer i = 1; i <= count; i++) {
    lua_geti(L, -1, i);
    const lua_Integer vertices = list_length(L, "each line must be a list of points, as in {{0, 0, 1}, {1, 0, 1}}");
    if (vertices < 2) luaL_error(L, "keep: a line must have two points or more");
    for (lua_Integer k = 1; k <= vertices; k++) {
      laves__script_ask(L, (size_t)(i + k));
      if (!laves__kept_add_vertex(store(L), point_of(L, k))) fail_kept(L);
    }
    if (!laves__kept_end_line(store(L))) fail_kept(L);
    lua_pop(L, 1);
  }
}

static void check_keys(lua_State *L) {
  for (lua_pushnil(L); lua_next(L, 2); lua_pop(L, 1)) {
    const char *key = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "(not a name)";
    if (strcmp(key, "points") != 0 && strcmp(key, "lines") != 0)
      luaL_error(L, "keep has no option '%s'; it knows points and lines", key);
  }
}

/* keep(solid, {points = {{x, y, z}, ...}, lines = {{{x, y, z}, ...}, ...}}) */
int laves__script_keep(lua_State *L) {
  laves__shape solid = laves__script_solid(L, 1, "keep");
  if (!lua_istable(L, 2) || lua_gettop(L) > 2)
    return luaL_error(L, "keep: expected a solid and a table, as in keep(solid, {points={{0, 0, 1}}})");
  check_keys(L);
  if (lua_getfield(L, 2, "points") != LUA_TNIL) take_points(L);
  lua_pop(L, 1);
  if (lua_getfield(L, 2, "lines") != LUA_TNIL) take_lines(L);
  lua_pop(L, 1);
  const uint32_t drawn = laves__kept_take(store(L));
  solid.kept = laves__kept_both(store(L), solid.kept, drawn);
  return laves__script_push(L, LAVES__SOLID, solid);
}

void laves__script_refuse_kept(lua_State *L, const laves__shape *solid, const char *function) {
  if (!solid->kept) return;
  luaL_error(L, "%s: it moves the surface away from the points and lines of keep(); call keep() on what %s() returns", function,
             function);
}
