/* Combining and changing solids in scripts.  Each function is also a method: sphere(1):move(0, 0, 1). */
#include <lauxlib.h>
#include <lua.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "domain/elementary.h"
#include "domain/script.h"
#include "domain/surface_input.h"
#include "io/file.h"

/* Surface files that one script may read, and their bytes in all. */
enum { LEAF_LIMIT = 1000 };
static const size_t file_byte_limit = (size_t)2 << 30;

static const double degree = 3.14159265358979323846 / 180;

static laves__expression *store(lua_State *L) { return &laves__script_of(L)->model->expression; }
static int push(lua_State *L, laves__shape shape) { return laves__script_push(L, LAVES__SOLID, shape); }

/* ---- Booleans and blends ---- */

typedef struct combination {
  const char *name;
  laves__boolean kind;
  bool smooth; /* the last argument is the width */
} combination;

static const combination combinations[] = {
    {"union", LAVES__UNION, false},
    {"intersection", LAVES__INTERSECTION, false},
    {"difference", LAVES__DIFFERENCE, false},
    {"smooth_union", LAVES__UNION, true},
    {"smooth_intersection", LAVES__INTERSECTION, true},
    {"smooth_difference", LAVES__DIFFERENCE, true},
};

/* Lists of solids, as in union({a, b, c}), are spread over the stack. */
static int spread(lua_State *L, const char *function) {
  if (!lua_istable(L, 1)) return lua_gettop(L);
  const lua_Integer count = luaL_len(L, 1);
  if (count > 100000 || count < 0) luaL_error(L, "%s: at most 100000 solids at once", function);
  luaL_checkstack(L, (int)count + 10, "too many solids");
  for (lua_Integer i = 1; i <= count; i++) {
    lua_geti(L, 1, i);
    lua_insert(L, (int)i + 1);
  }
  lua_remove(L, 1);
  return lua_gettop(L);
}

static int combine(lua_State *L) {
  const combination *c = &combinations[lua_tointeger(L, lua_upvalueindex(1))];
  int count = spread(L, c->name);
  double width = 0;
  if (c->smooth) {
    const laves__parameter p = {"the width of the blend (the last argument)", LAVES__NONNEGATIVE, NAN};
    width = laves__script_number(L, c->name, &p, count--);
  }
  if (count < 1) return luaL_error(L, "%s: expected solids", c->name);
  laves__shape result = laves__script_solid(L, 1, c->name);
  for (int i = 2; i <= count; i++) {
    laves__script_ask(L, (size_t)i);
    const laves__shape next = laves__script_solid(L, i, c->name);
    result = laves__shape_blend(store(L), c->kind, &result, &next, width);
  }
  return push(L, result);
}

static int complement(lua_State *L) {
  const laves__shape a = laves__script_solid(L, 1, "complement");
  return push(L, laves__shape_complement(store(L), &a));
}

static int offset(lua_State *L) {
  static const laves__parameter p = {"distance", LAVES__ANY, NAN};
  double distance;
  const laves__shape a = laves__script_solid(L, 1, "offset");
  laves__script_refuse_kept(L, &a, "offset");
  laves__script_arguments(L, "offset", 2, &p, 1, &distance);
  return push(L, laves__shape_offset(store(L), &a, distance));
}

static int shell(lua_State *L) {
  static const laves__parameter p = {"thickness", LAVES__POSITIVE, NAN};
  double thickness;
  const laves__shape a = laves__script_solid(L, 1, "shell");
  laves__script_arguments(L, "shell", 2, &p, 1, &thickness);
  return push(L, laves__shape_shell(store(L), &a, thickness));
}

static int morph(lua_State *L) {
  static const laves__parameter p = {"t", LAVES__NONNEGATIVE, NAN};
  const laves__shape a = laves__script_solid(L, 1, "morph"), b = laves__script_solid(L, 2, "morph");
  double t;
  laves__script_refuse_kept(L, &a, "morph");
  laves__script_refuse_kept(L, &b, "morph");
  laves__script_arguments(L, "morph", 3, &p, 1, &t);
  if (t > 1) return luaL_error(L, "morph: t must be a number from 0 to 1, not %f", t);
  return push(L, laves__shape_morph(store(L), &a, &b, t));
}

static int bounds(lua_State *L) {
  static const laves__parameter p[] = {{"lower", LAVES__VECTOR, NAN}, {"upper", LAVES__VECTOR, NAN}};
  const laves__shape a = laves__script_solid(L, 1, "bounds");
  double v[6];
  laves__script_arguments(L, "bounds", 2, p, 2, v);
  for (int i = 0; i < 3; i++)
    if (!(v[i] < v[3 + i])) return luaL_error(L, "bounds: lower must be below upper in x, y and z");
  return push(L, laves__shape_bounded(store(L), &a, (laves__box3){v3(v[0], v[1], v[2]), v3(v[3], v[4], v[5])}));
}

/* ---- transforms ---- */

static int move(lua_State *L) {
  static const laves__parameter p = {"by", LAVES__VECTOR, NAN};
  const laves__shape a = laves__script_solid(L, 1, "move");
  double v[3];
  laves__script_arguments(L, "move", 2, &p, 1, v);
  return push(L, laves__shape_move(store(L), &a, v3(v[0], v[1], v[2])));
}

static laves__vec3 direction(lua_State *L, const char *function, const char *name, const double *v) {
  const laves__vec3 d = v3(v[0], v[1], v[2]);
  const double length = v3_norm(d);
  if (!(length > 1e-150 && length < 1e150)) luaL_error(L, "%s: %s must not be zero", function, name);
  return d;
}

/* rotate(solid, angle, axis), or by name. */
static int rotate(lua_State *L) {
  static const laves__parameter p[] = {{"angle", LAVES__ANY, NAN}, {"axis", LAVES__VECTOR, 1}};
  const laves__shape a = laves__script_solid(L, 1, "rotate");
  double v[4];
  laves__script_arguments(L, "rotate", 2, p, 2, v);
  return push(L, laves__shape_rotate(store(L), &a, direction(L, "rotate", "axis", v + 1), v[0] * degree));
}

/* One factor, or one for each axis. */
static int scale(lua_State *L) {
  static const laves__parameter one = {"by", LAVES__ANY, NAN}, three = {"by", LAVES__VECTOR, NAN};
  const laves__shape a = laves__script_solid(L, 1, "scale");
  double v[3];
  if (lua_gettop(L) == 2 && lua_type(L, 2) == LUA_TNUMBER) {
    laves__script_arguments(L, "scale", 2, &one, 1, v);
    v[1] = v[2] = v[0];
  } else {
    laves__script_arguments(L, "scale", 2, &three, 1, v);
  }
  for (int i = 0; i < 3; i++)
    if (!isnormal(1 / v[i]) || v[i] == 0) return luaL_error(L, "scale: a factor must not be zero");
  return push(L, laves__shape_scale(store(L), &a, v3(v[0], v[1], v[2])));
}

static int mirror(lua_State *L) {
  static const laves__parameter p = {"normal", LAVES__VECTOR, NAN};
  const laves__shape a = laves__script_solid(L, 1, "mirror");
  double v[3];
  laves__script_arguments(L, "mirror", 2, &p, 1, v);
  return push(L, laves__shape_mirror(store(L), &a, direction(L, "mirror", "normal", v)));
}

/* ---- repetition: unions of copies ---- */

static int repeat_linear(lua_State *L) {
  static const laves__parameter p[] = {{"step", LAVES__VECTOR, NAN}, {"count", LAVES__COUNT, NAN}};
  const laves__shape a = laves__script_solid(L, 1, "repeat_linear");
  double v[4];
  laves__script_arguments(L, "repeat_linear", 2, p, 2, v);
  laves__shape all = a;
  for (int i = 1; i < (int)v[3] && all.node != LAVES__NO_NODE; i++) {
    laves__script_ask(L, (size_t)i);
    const laves__shape copy = laves__shape_move(store(L), &a, v3_scale(v3(v[0], v[1], v[2]), i));
    all = laves__shape_boolean(store(L), LAVES__UNION, &all, &copy);
  }
  return push(L, all);
}

static int repeat_grid(lua_State *L) {
  static const laves__parameter p[] = {{"step", LAVES__VECTOR, NAN}, {"count", LAVES__COUNTS, NAN}};
  const laves__shape a = laves__script_solid(L, 1, "repeat_grid");
  double v[6];
  laves__script_arguments(L, "repeat_grid", 2, p, 2, v);
  if (v[3] * v[4] * v[5] > 1e6) return luaL_error(L, "repeat_grid: at most a million copies");
  /* Rows of rows: the copies of a row are shared by all rows, so nodes before lowering stay few. */
  laves__shape all = a;
  for (int axis = 0; axis < 3; axis++) {
    const laves__shape row = all;
    for (int i = 1; i < (int)v[3 + axis] && all.node != LAVES__NO_NODE; i++) {
      laves__script_ask(L, (size_t)i);
      laves__vec3 by = v3(0, 0, 0);
      *v3_slot(&by, axis) = v[axis] * i;
      const laves__shape copy = laves__shape_move(store(L), &row, by);
      all = laves__shape_boolean(store(L), LAVES__UNION, &all, &copy);
    }
  }
  return push(L, all);
}

static int repeat_polar(lua_State *L) {
  static const laves__parameter p[] = {{"count", LAVES__COUNT, NAN}, {"axis", LAVES__VECTOR, 1}, {"angle", LAVES__ANY, 360}};
  const laves__shape a = laves__script_solid(L, 1, "repeat_polar");
  double v[5];
  laves__script_arguments(L, "repeat_polar", 2, p, 3, v);
  const laves__vec3 axis = direction(L, "repeat_polar", "axis", v + 1);
  laves__shape all = a;
  for (int i = 1; i < (int)v[0] && all.node != LAVES__NO_NODE; i++) {
    laves__script_ask(L, (size_t)i);
    const laves__shape copy = laves__shape_rotate(store(L), &a, axis, v[4] * degree * i / v[0]);
    all = laves__shape_boolean(store(L), LAVES__UNION, &all, &copy);
  }
  return push(L, all);
}

/* ---- bending space ---- */

static laves__node coordinate(lua_State *L, int index) {
  const laves__value *value = laves__script_value(L, index);
  if (value && value->kind == LAVES__FIELD) return value->shape.node;
  static const laves__parameter p = {"a coordinate", LAVES__ANY, NAN};
  return laves__node_constant(store(L), laves__script_number(L, "warp", &p, index));
}

/* warp(solid, X, Y, Z): the solid's value at (X, Y, Z). */
static int warp(lua_State *L) {
  const laves__shape a = laves__script_solid(L, 1, "warp");
  laves__script_refuse_kept(L, &a, "warp");
  lua_settop(L, 4);
  const laves__node to[3] = {coordinate(L, 2), coordinate(L, 3), coordinate(L, 4)};
  return push(L, laves__shape_of_node(laves__node_warp(store(L), a.node, to)));
}

/* ---- names ---- */

/* What no part of the surface is named. */
static const char rest_of_surface[] = "boundary";

/* The most bytes of a name: what meshes hold. */
enum { NAME_MAX_BYTES = 99 };

static int out_of_memory(lua_State *L) {
  laves__script_of(L)->over_memory = true;
  return luaL_error(L, "out of memory");
}

typedef struct naming {
  const char *name, *rest; /* of the function; of what gets no name */
  bool inside;             /* else the surface */
} naming;

static const naming namings[] = {{"tag", rest_of_surface, false}, {"region", "solid", true}};

/* tag("name", solid), or solid:tag("name"); the same for region. */
static int name_solid(lua_State *L) {
  const naming *n = &namings[lua_tointeger(L, lua_upvalueindex(1))];
  laves__script *script = laves__script_of(L);
  laves__model *model = script->model;
  const int name_at = lua_type(L, 1) == LUA_TSTRING ? 1 : 2;
  size_t length = 0;
  if (lua_type(L, name_at) != LUA_TSTRING)
    return luaL_error(L, "%s: expected a name in quotes and a solid, not %s", n->name, laves__script_type(L, name_at));
  const char *name = lua_tolstring(L, name_at, &length);
  const laves__shape a = laves__script_solid(L, 3 - name_at, n->name);
  if (length == 0 || length > NAME_MAX_BYTES || strlen(name) != length)
    return luaL_error(L, "%s: a name has 1 to %d bytes, none of them zero", n->name, (int)NAME_MAX_BYTES);
  laves__tag_list *list = n->inside ? &model->regions : &model->names;
  const int32_t number = laves__model_name(script->context, list, n->rest, name, length);
  if (number < 0) return out_of_memory(L);
  laves__shape named = a;
  named.node = (n->inside ? laves__node_region : laves__node_tag)(store(L), a.node, (uint32_t)number);
  return push(L, named);
}

/* ---- surface files ---- */

/* The path as it stands, or within the script's folder when that is known; pushed on the stack. */
static const char *push_path(lua_State *L, const char *path) {
  const char *folder = laves__script_of(L)->folder;
  if (!folder || path[0] == '/') return lua_pushstring(L, path);
  return lua_pushfstring(L, "%s/%s", folder, path);
}

static laves_result read_surface(laves__script *script, const char *path, laves_domain *domain, laves_error *error) {
  laves_context *context = script->context;
  char *bytes = NULL;
  size_t length = 0;
  laves_result result = laves__file_read(context, path, &bytes, &length, error);
  if (result != LAVES_OK) return result;
  laves__surface_input input = {0};
  script->file_bytes += length;
  if (script->file_bytes <= file_byte_limit)
    result = laves__surface_parse(context, bytes, length, path, &input, error);
  else
    result = laves__fail(error, LAVES_ERROR_INPUT, "%s: the files of the script have more than 2 GiB together", path);
  laves__free(context, bytes, length + 1, 1);
  return result == LAVES_OK ? laves__surface_build(context, &input, NULL, domain, error) : result;
}

/* The path's last part without its extension. */
static const char *stem_of(const char *path, int *length) {
  const char *slash = strrchr(path, '/'), *stem = slash ? slash + 1 : path, *dot = strrchr(stem, '.');
  *length = dot && dot > stem ? (int)(dot - stem) : (int)strlen(stem);
  return stem;
}

/* A file of several named parts gives their names to the whole: "file/part". */
static bool name_parts(laves_context *context, laves__model *model, const laves_domain *leaf, const char *path) {
  const size_t count = model->leaf_count;
  const bool first = model->leaf_tag_first == NULL;
  if (!laves__grow(context, &model->leaf_tag_first, &model->leaf_first_capacity, count + 1, sizeof *model->leaf_tag_first))
    return false;
  for (size_t i = 0; first && i < count; i++) model->leaf_tag_first[i] = 0; /* of a leaf that is no file */
  model->leaf_tag_first[count] = (uint32_t)model->leaf_tag_count;
  if (leaf->info.tag_count < 2) return true;
  const size_t needed = model->leaf_tag_count + (size_t)leaf->info.tag_count;
  if (!laves__grow(context, &model->leaf_tags, &model->leaf_tag_capacity, needed, sizeof *model->leaf_tags)) return false;
  int stem_length;
  const char *stem = stem_of(path, &stem_length);
  for (int i = 0; i < leaf->info.tag_count; i++) {
    char name[NAME_MAX_BYTES + 1];
    snprintf(name, sizeof name, "%.*s/%s", stem_length, stem, leaf->tag_names[i]);
    const int32_t number = laves__model_name(context, &model->names, rest_of_surface, name, strlen(name));
    if (number < 0) return false;
    model->leaf_tags[model->leaf_tag_count++] = number;
  }
  model->leaf_tag_first[count] = (uint32_t)model->leaf_tag_count;
  return true;
}

/* Leaves on the stack what surface() yielded for this file before, or nil. A file is read once, however often it is named. */
static bool push_known_surface(lua_State *L, const char *path) {
  luaL_getsubtable(L, LUA_REGISTRYINDEX, "surfaces");
  lua_getfield(L, -1, path);
  return !lua_isnil(L, -1);
}

/* The value on top of the stack is what surface() yields for this file. */
static void remember_surface(lua_State *L, const char *path) {
  luaL_getsubtable(L, LUA_REGISTRYINDEX, "surfaces");
  lua_pushvalue(L, -2);
  lua_setfield(L, -2, path);
  lua_pop(L, 1);
}

/* surface("part.stl"). The model owns the domain from the start, so an error raised later loses nothing. */
static int surface(lua_State *L) {
  laves__script *script = laves__script_of(L);
  laves__model *model = script->model;
  if (lua_type(L, 1) != LUA_TSTRING)
    return luaL_error(L, "surface: expected the name of a file, not %s", laves__script_type(L, 1));
  const char *path = push_path(L, lua_tostring(L, 1));
  if (push_known_surface(L, path)) return 1;
  if (model->leaf_count == LEAF_LIMIT) return luaL_error(L, "surface: at most %d files", (int)LEAF_LIMIT);
  const double started = laves__wall_seconds();
  laves_domain *domain = NULL;
  if (laves__grow(script->context, &model->leaves, &model->leaf_capacity, model->leaf_count + 1, sizeof *model->leaves))
    domain = laves__alloc_zeroed(script->context, 1, sizeof *domain);
  if (!domain) return out_of_memory(L);
  domain->context = script->context;
  model->leaves[model->leaf_count++] = domain;
  laves_error error;
  const laves_result result = read_surface(script, path, domain, &error);
  script->started += laves__wall_seconds() - started;
  script->over_memory |= result == LAVES_ERROR_MEMORY;
  script->cancelled |= result == LAVES_ERROR_CANCELLED;
  if (result != LAVES_OK) return luaL_error(L, "surface: %s", error.text);
  if (!name_parts(script->context, model, domain, path)) return out_of_memory(L);
  const laves__oracle *o = &domain->oracle;
  laves__shape s = laves__shape_of_node(laves__node_leaf(store(L), (uint32_t)model->leaf_count - 1));
  s.box = (laves__box3){v3_add(o->bounds.lower, o->origin), v3_add(o->bounds.upper, o->origin)};
  s.slope = 1;
  s.exact = o->is_distance;
  s.volume = o->volume;
  s.area = o->area;
  push(L, s);
  remember_surface(L, path);
  return 1;
}

static const luaL_Reg solid_functions[] = {
    {"complement", complement},
    {"offset", offset},
    {"shell", shell},
    {"morph", morph},
    {"bounds", bounds},
    {"move", move},
    {"translate", move},
    {"rotate", rotate},
    {"scale", scale},
    {"mirror", mirror},
    {"warp", warp},
    {"repeat_linear", repeat_linear},
    {"repeat_grid", repeat_grid},
    {"repeat_polar", repeat_polar},
    {"surface", surface},
    {"keep", laves__script_keep},
    {NULL, NULL},
};

/* The table on top gets everything under its name; solids and fields find the same as methods. */
void laves__script_add_solids(lua_State *L) {
  lua_newtable(L);
  luaL_setfuncs(L, solid_functions, 0);
  for (size_t i = 0; i < LAVES__COUNT_OF(combinations); i++) {
    lua_pushinteger(L, (lua_Integer)i);
    lua_pushcclosure(L, combine, 1);
    lua_setfield(L, -2, combinations[i].name);
  }
  for (size_t i = 0; i < LAVES__COUNT_OF(namings); i++) {
    lua_pushinteger(L, (lua_Integer)i);
    lua_pushcclosure(L, name_solid, 1);
    lua_setfield(L, -2, namings[i].name);
  }
  for (lua_pushnil(L); lua_next(L, -2);) {
    lua_pushvalue(L, -2);
    lua_insert(L, -2);
    lua_settable(L, -5);
  }
  static const char *const kinds[] = {"solid", "field"};
  for (int i = 0; i < 2; i++) {
    luaL_getmetatable(L, kinds[i]);
    lua_pushvalue(L, -2);
    lua_setfield(L, -2, "__index");
    lua_pop(L, 1);
  }
  lua_pop(L, 1);
}
