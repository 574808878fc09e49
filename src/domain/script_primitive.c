/* The primitives of the script's vocabulary: one row each in a table of names and parameters. */
#include <lauxlib.h>
#include <lua.h>
#include <math.h>
#include <string.h>

#include "domain/elementary.h"
#include "domain/script.h"

typedef laves__shape primitive_fn(lua_State *L, laves__expression *e, const double *v);

enum { PARAMETER_CAPACITY = 5 };

typedef struct primitive {
  const char *name;
  primitive_fn *make;
  laves__parameter parameters[PARAMETER_CAPACITY]; /* up to the first without name */
} primitive;

static laves__shape sphere(lua_State *L, laves__expression *e, const double *v) {
  (void)L;
  return laves__shape_sphere(e, v[0]);
}

static laves__shape ellipsoid(lua_State *L, laves__expression *e, const double *v) {
  (void)L;
  return laves__shape_ellipsoid(e, v);
}

/* Missing widths equal the first. */
static laves__shape box(lua_State *L, laves__expression *e, const double *v) {
  (void)L;
  return laves__shape_box(e, (double[]){v[0], v[1] > 0 ? v[1] : v[0], v[2] > 0 ? v[2] : v[0]}, 0);
}

static laves__shape rounded_box(lua_State *L, laves__expression *e, const double *v) {
  if (2 * v[3] > min_of(v[0], min_of(v[1], v[2])))
    luaL_error(L, "rounded_box: r must be at most half of the smallest width, not %f", v[3]);
  return laves__shape_box(e, v, v[3]);
}

static laves__shape cylinder(lua_State *L, laves__expression *e, const double *v) {
  (void)L;
  return laves__shape_cylinder(e, v[0], v[1]);
}

static laves__shape capsule(lua_State *L, laves__expression *e, const double *v) {
  (void)L;
  return laves__shape_capsule(e, v[0], v[1]);
}

static laves__shape cone(lua_State *L, laves__expression *e, const double *v) {
  if (v[0] == 0 && v[2] == 0) luaL_error(L, "cone: r and r2 must not both be zero");
  return laves__shape_cone(e, v[0], v[2], v[1]);
}

static laves__shape torus(lua_State *L, laves__expression *e, const double *v) {
  (void)L;
  return laves__shape_torus(e, v[0], v[1]);
}

static laves__shape halfspace(lua_State *L, laves__expression *e, const double *v) {
  const laves__vec3 normal = v3(v[0], v[1], v[2]);
  const double length = v3_norm(normal);
  if (!(length > 1e-150 && length < 1e150)) luaL_error(L, "halfspace: normal must not be zero");
  return laves__shape_halfspace(e, normal, v[3]);
}

static const primitive primitives[] = {
    {"sphere", sphere, {{"r", LAVES__POSITIVE, NAN}}},
    {"ellipsoid", ellipsoid, {{"a", LAVES__POSITIVE, NAN}, {"b", LAVES__POSITIVE, NAN}, {"c", LAVES__POSITIVE, NAN}}},
    {"box", box, {{"x", LAVES__POSITIVE, NAN}, {"y", LAVES__POSITIVE, -1}, {"z", LAVES__POSITIVE, -1}}},
    {"rounded_box",
     rounded_box,
     {{"x", LAVES__POSITIVE, NAN}, {"y", LAVES__POSITIVE, NAN}, {"z", LAVES__POSITIVE, NAN}, {"r", LAVES__NONNEGATIVE, NAN}}},
    {"cylinder", cylinder, {{"r", LAVES__POSITIVE, NAN}, {"h", LAVES__POSITIVE, INFINITY}}},
    {"capsule", capsule, {{"r", LAVES__POSITIVE, NAN}, {"h", LAVES__NONNEGATIVE, NAN}}},
    {"cone", cone, {{"r", LAVES__NONNEGATIVE, NAN}, {"h", LAVES__POSITIVE, NAN}, {"r2", LAVES__NONNEGATIVE, 0}}},
    {"torus", torus, {{"R", LAVES__POSITIVE, NAN}, {"r", LAVES__POSITIVE, NAN}}},
    {"halfspace", halfspace, {{"normal", LAVES__VECTOR, 1}, {"offset", LAVES__ANY, 0}}},
    {"plane", halfspace, {{"normal", LAVES__VECTOR, 1}, {"offset", LAVES__ANY, 0}}},
};

static int make_primitive(lua_State *L) {
  const primitive *p = &primitives[lua_tointeger(L, lua_upvalueindex(1))];
  int count = 0;
  while (count < PARAMETER_CAPACITY && p->parameters[count].name) count++;
  double values[3 * PARAMETER_CAPACITY];
  laves__script_arguments(L, p->name, 1, p->parameters, count, values);
  return laves__script_push(L, LAVES__SOLID, p->make(L, &laves__script_of(L)->model->expression, values));
}

static const char *const tpms_name[] = {
#define TPMS_NAME(name) #name,
    LAVES__TPMS_LIST(TPMS_NAME)
#undef TPMS_NAME
};

static int make_tpms(lua_State *L) {
  static const laves__parameter parameters[] = {
      {"period", LAVES__POSITIVE, 1}, {"thickness", LAVES__NONNEGATIVE, 0}, {"level", LAVES__ANY, 0}};
  const laves__tpms kind = (laves__tpms)lua_tointeger(L, lua_upvalueindex(1));
  double v[3];
  laves__script_arguments(L, tpms_name[kind], 1, parameters, 3, v);
  return laves__script_push(L, LAVES__SOLID, laves__shape_tpms(&laves__script_of(L)->model->expression, kind, v[0], v[1], v[2]));
}

/* metaballs{{x, y, z, r}, ..., sharpness = 1} */
static int make_metaballs(lua_State *L) {
  static const laves__parameter entry = {"each ball", LAVES__ANY, NAN}, radius = {"the radius of a ball", LAVES__POSITIVE, NAN};
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  const lua_Integer count = luaL_len(L, 1);
  if (count < 1 || count > 10000) return luaL_error(L, "metaballs: expected 1 to 10000 balls, as in metaballs{{0, 0, 0, 1}}");
  for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1)) {
    if (lua_type(L, -2) == LUA_TNUMBER) continue;
    lua_pushvalue(L, -2);
    const char *key = lua_tostring(L, -1);
    if (!key || strcmp(key, "sharpness") != 0)
      return luaL_error(L, "metaballs has no option '%s'; it knows balls {x, y, z, r} and sharpness", key ? key : "(not a name)");
    lua_pop(L, 1);
  }
  double k = 1;
  if (lua_getfield(L, 1, "sharpness") != LUA_TNIL) k = luaL_checknumber(L, -1);
  if (!(k > 0 && k <= 100)) return luaL_error(L, "metaballs: sharpness must be a number above 0, up to 100, not %f", k);
  laves__ball *balls = lua_newuserdatauv(L, (size_t)count * sizeof *balls, 0);
  for (lua_Integer i = 1; i <= count; i++) {
    if (lua_geti(L, 1, i) != LUA_TTABLE) return luaL_error(L, "metaballs: each ball must be {x, y, z, r}");
    double v[4];
    for (int j = 0; j < 4; j++) {
      lua_geti(L, -1, j + 1);
      v[j] = laves__script_number(L, "metaballs", j == 3 ? &radius : &entry, -1);
      lua_pop(L, 1);
    }
    lua_pop(L, 1);
    balls[i - 1] = (laves__ball){v3(v[0], v[1], v[2]), v[3]};
  }
  return laves__script_push(L, LAVES__SOLID,
                            laves__shape_metaballs(&laves__script_of(L)->model->expression, balls, (size_t)count, k));
}

void laves__script_add_primitives(lua_State *L) {
  for (size_t i = 0; i < LAVES__COUNT_OF(primitives); i++) {
    lua_pushinteger(L, (lua_Integer)i);
    lua_pushcclosure(L, make_primitive, 1);
    lua_setfield(L, -2, primitives[i].name);
  }
  for (size_t i = 0; i < LAVES__COUNT_OF(tpms_name); i++) {
    lua_pushinteger(L, (lua_Integer)i);
    lua_pushcclosure(L, make_tpms, 1);
    lua_setfield(L, -2, tpms_name[i]);
  }
  lua_pushcfunction(L, make_metaballs);
  lua_setfield(L, -2, "metaballs");
}
