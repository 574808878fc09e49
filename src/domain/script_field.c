/* Fields in scripts: the coordinates x, y, z, arithmetic, functions; and the operators of solids.
 *
 * Arithmetic is for fields and numbers, + - * | & between solids are Booleans; a mix of both is refused, since
 * `sphere(1) + 0.1` could mean either. & and | have no meaning for numbers, so there fields count as solids. */
#include <lauxlib.h>
#include <lua.h>
#include <math.h>

#include "domain/elementary.h"
#include "domain/script.h"

static laves__expression *store(lua_State *L) { return &laves__script_of(L)->model->expression; }

static int push_field(lua_State *L, laves__node node) { return laves__script_push(L, LAVES__FIELD, laves__shape_of_node(node)); }

laves__node laves__script_field(lua_State *L, int index, const char *function) {
  const laves__value *value = laves__script_value(L, index);
  if (value && value->kind == LAVES__FIELD) return value->shape.node;
  if (value)
    luaL_error(L, "%s: expected a field or a number, not a solid; field(solid) is the field of a solid's values", function);
  if (lua_type(L, index) != LUA_TNUMBER)
    luaL_error(L, "%s: expected a field or a number, not %s", function, laves__script_type(L, index));
  const double number = lua_tonumber(L, index);
  if (!isfinite(number)) luaL_error(L, "%s: expected a finite number, not %f", function, number);
  return laves__node_constant(store(L), number);
}

/* ---- operators ---- */

enum { NOT_BOOLEAN = -1, NOT_ARITHMETIC = -1 };

typedef struct operation {
  const char *event, *sign;
  int arithmetic; /* of fields and numbers: laves__op */
  int boolean;    /* of solids: laves__boolean */
} operation;

static const operation operations[] = {
    {"__add", "+", LAVES__OP_ADD, LAVES__UNION},        {"__sub", "-", LAVES__OP_SUB, LAVES__DIFFERENCE},
    {"__mul", "*", LAVES__OP_MUL, LAVES__INTERSECTION}, {"__div", "/", LAVES__OP_DIV, NOT_BOOLEAN},
    {"__mod", "%", LAVES__OP_MOD, NOT_BOOLEAN},         {"__pow", "^", LAVES__OP_POW, NOT_BOOLEAN},
    {"__bor", "|", NOT_ARITHMETIC, LAVES__UNION},       {"__band", "&", NOT_ARITHMETIC, LAVES__INTERSECTION},
};

static bool is_solid(lua_State *L, int index) {
  const laves__value *value = laves__script_value(L, index);
  return value && value->kind == LAVES__SOLID;
}

static int operate(lua_State *L) {
  const operation *o = &operations[lua_tointeger(L, lua_upvalueindex(1))];
  const bool solids = o->arithmetic == NOT_ARITHMETIC || (is_solid(L, 1) && is_solid(L, 2));
  if (solids && o->boolean == NOT_BOOLEAN) return luaL_error(L, "'%s' has no meaning for solids", o->sign);
  if (solids) {
    const laves__shape a = laves__script_solid(L, 1, o->sign), b = laves__script_solid(L, 2, o->sign);
    return laves__script_push(L, LAVES__SOLID, laves__shape_boolean(store(L), (laves__boolean)o->boolean, &a, &b));
  }
  if (is_solid(L, 1) || is_solid(L, 2))
    return luaL_error(L,
                      "'%s' between %s and %s: use offset() or scale() to change a solid by a number, solid(f) to make a field a "
                      "solid, field(s) to compute with a solid's values",
                      o->sign, laves__script_type(L, 1), laves__script_type(L, 2));
  const laves__node a = laves__script_field(L, 1, o->sign), b = laves__script_field(L, 2, o->sign);
  return push_field(L, laves__node_make(store(L), (laves__op)o->arithmetic, a, b, 0));
}

static int negate(lua_State *L) {
  if (is_solid(L, 1)) return luaL_error(L, "'-' before a solid: write ~solid for its outside, or a - b for a difference");
  return push_field(L, laves__node_make(store(L), LAVES__OP_NEGATE, laves__script_field(L, 1, "-"), 0, 0));
}

static int complement(lua_State *L) {
  const laves__shape a = laves__script_solid(L, 1, "~");
  return laves__script_push(L, LAVES__SOLID, laves__shape_complement(store(L), &a));
}

static int describe(lua_State *L) {
  lua_pushstring(L, is_solid(L, 1) ? "solid" : "field");
  return 1;
}

static void make_metatable(lua_State *L, const char *name) {
  luaL_newmetatable(L, name);
  for (size_t i = 0; i < LAVES__COUNT_OF(operations); i++) {
    lua_pushinteger(L, (lua_Integer)i);
    lua_pushcclosure(L, operate, 1);
    lua_setfield(L, -2, operations[i].event);
  }
  static const luaL_Reg unary[] = {{"__unm", negate}, {"__bnot", complement}, {"__tostring", describe}, {NULL, NULL}};
  luaL_setfuncs(L, unary, 0);
  lua_pop(L, 1);
}

/* ---- functions ---- */

typedef struct function {
  const char *name;
  laves__op op;
} function;

static const function functions[] = {
    {"abs", LAVES__OP_ABS}, {"sqrt", LAVES__OP_SQRT},   {"sin", LAVES__OP_SIN},     {"cos", LAVES__OP_COS},
    {"tan", LAVES__OP_TAN}, {"asin", LAVES__OP_ASIN},   {"acos", LAVES__OP_ACOS},   {"exp", LAVES__OP_EXP},
    {"log", LAVES__OP_LOG}, {"floor", LAVES__OP_FLOOR}, {"atan2", LAVES__OP_ATAN2}, {"mod", LAVES__OP_MOD},
    {"pow", LAVES__OP_POW}, {"min", LAVES__OP_MIN},     {"max", LAVES__OP_MAX},     {"length", LAVES__OP_NORM3},
};

static bool any_value(lua_State *L) {
  for (int i = lua_gettop(L); i > 0; i--)
    if (laves__script_value(L, i)) return true;
  return false;
}

/* Numbers give a number, anything with a field a field. */
static int finish(lua_State *L, laves__node node, bool field) {
  double value;
  if (field || !laves__node_is_constant(store(L), node, &value)) return push_field(L, node);
  lua_pushnumber(L, value);
  return 1;
}

static int call(lua_State *L) {
  const function *f = &functions[lua_tointeger(L, lua_upvalueindex(1))];
  const int given = lua_gettop(L), operands = laves__op_operands[f->op];
  const bool any_number_of = f->op == LAVES__OP_MIN || f->op == LAVES__OP_MAX, up_to = f->op == LAVES__OP_NORM3;
  if (any_number_of ? given < 1 : up_to ? given < 1 || given > 3 : given != operands)
    return luaL_error(L, "%s: expected %s%d argument%s, not %d", f->name,
                      any_number_of ? "at least "
                      : up_to       ? "up to "
                                    : "",
                      any_number_of ? 1 : operands, operands == 1 || any_number_of ? "" : "s", given);
  if ((any_number_of) && is_solid(L, 1)) return luaL_error(L, "%s: for solids write a | b or a & b", f->name);
  const bool field = any_value(L);
  laves__node node[3] = {0, 0, 0};
  if (any_number_of) {
    node[0] = laves__script_field(L, 1, f->name);
    for (int i = 2; i <= given; i++) {
      laves__script_ask(L, (size_t)i);
      node[0] = laves__node_make(store(L), f->op, node[0], laves__script_field(L, i, f->name), 0);
    }
    return finish(L, node[0], field);
  }
  for (int i = 0; i < operands; i++)
    node[i] = i < given ? laves__script_field(L, i + 1, f->name) : laves__node_constant(store(L), 0);
  return finish(L, laves__node_make(store(L), f->op, node[0], node[1], node[2]), field);
}

static int ceil_of(lua_State *L) {
  laves__expression *e = store(L);
  const laves__node down = laves__node_make(e, LAVES__OP_NEGATE, laves__script_field(L, 1, "ceil"), 0, 0);
  return finish(L, laves__node_make(e, LAVES__OP_NEGATE, laves__node_make(e, LAVES__OP_FLOOR, down, 0, 0), 0, 0), any_value(L));
}

/* field(solid) */
static int field_of(lua_State *L) { return push_field(L, laves__script_solid(L, 1, "field").node); }

/* solid(field) */
static int solid_of(lua_State *L) {
  if (lua_type(L, 1) == LUA_TNUMBER) return luaL_error(L, "solid: expected a field, not a number");
  return laves__script_push(L, LAVES__SOLID, laves__script_solid(L, 1, "solid"));
}

static void add_number_functions(lua_State *L, int table) {
  for (size_t i = 0; i < LAVES__COUNT_OF(functions); i++) {
    lua_pushinteger(L, (lua_Integer)i);
    lua_pushcclosure(L, call, 1);
    lua_setfield(L, table, functions[i].name);
  }
  lua_pushcfunction(L, ceil_of);
  lua_setfield(L, table, "ceil");
  lua_pushnumber(L, 3.14159265358979323846);
  lua_setfield(L, table, "pi");
}

void laves__script_add_fields(lua_State *L) {
  make_metatable(L, "field");
  make_metatable(L, "solid");
  static const char *const axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; i++) {
    push_field(L, laves__node_make(store(L), (laves__op)(LAVES__OP_X + i), 0, 0, 0));
    lua_setfield(L, -2, axes[i]);
  }
  const int globals = lua_gettop(L);
  add_number_functions(L, globals);
  lua_getfield(L, globals, "math"); /* the same for math.sin and its like */
  add_number_functions(L, globals + 1);
  lua_pop(L, 1);
  static const luaL_Reg conversions[] = {{"field", field_of}, {"solid", solid_of}, {NULL, NULL}};
  luaL_setfuncs(L, conversions, 0);
}

void laves__script_add_depth(lua_State *L, uint32_t leaf) {
  push_field(L, laves__node_leaf(store(L), leaf));
  lua_setfield(L, -2, "d");
}
