/* Lua scripts that describe solids: run once in a sandbox, they leave an expression.  docs/implicit.md is the manual. */
#ifndef LAVES_DOMAIN_SCRIPT_H
#define LAVES_DOMAIN_SCRIPT_H

#include "domain/oracle.h"
#include "domain/shape.h"
#include "io/tag_list.h"

struct lua_State;

/* What a script leaves. */
typedef struct laves__model {
  laves__expression expression;
  laves__shape shape;    /* the solid; its node is in `expression` */
  laves_domain **leaves; /* surfaces that LEAF nodes number */
  laves_features *kept;  /* by keep(); NULL: nothing */
  size_t leaf_count, leaf_capacity;
  laves__tag_list names;    /* of parts of the surface; the first is that of all that has no other. Empty: nothing is named */
  laves__tag_list regions;  /* the same for the inside */
  uint32_t *leaf_tag_first; /* [leaf_count + 1] or NULL: where the names of each leaf's own parts begin in ... */
  size_t leaf_first_capacity;
  int32_t *leaf_tags; /* ... this list */
  size_t leaf_tag_count, leaf_tag_capacity;
} laves__model;

/* Arguments as of laves__implicit_build(). The model is set up here; free it in any case. */
laves_result laves__script_run(laves_context *context, const char *text, size_t length, bool is_expression, const char *name,
                               const char *folder, laves__model *model, laves_error *error);
/* The number of a name in one of the model's lists, whether new or known; negative: memory is short. The list's first name is
 * `rest`. */
int32_t laves__model_name(laves_context *context, laves__tag_list *list, const char *rest, const char *name, size_t length);
void laves__model_free(laves_context *context, laves__model *model);

/* The same for a size of elements: the chunk returns a number or a field of x, y, z and `d`, the depth below the surface.
 * model->shape.node is that field; leaf 0 (model->leaves[0] is NULL) stands for d and is the caller's to provide. */
laves_result laves__script_run_size(laves_context *context, const char *text, size_t length, bool is_expression, const char *name,
                                    const char *folder, laves__model *model, laves_error *error);

/* ---- between script.c, which runs, and script_*.c, which define the vocabulary ---- */

typedef struct laves__script {
  laves_context *context;
  struct lua_State *lua;
  laves__model *model;
  const char *name, *folder;
  size_t lua_bytes;
  size_t steps;
  double started;    /* laves__wall_seconds(), moved on by the time that files take */
  double asked;      /* when progress was reported last */
  size_t file_bytes; /* of the surface files read so far */
  bool over_limit;   /* Lua's memory passed its cap */
  bool over_text;    /* a text passed its own */
  bool over_memory;  /* the context refused memory */
  bool cancelled;
  int line; /* where memory ran short, or an error was raised; 0: unknown */
} laves__script;

laves__script *laves__script_of(struct lua_State *L);
/* Raises an error when the script's time is over or a cancel is asked for. To be called in loops whose length the script chooses,
 * as the limits are looked at between calls and steps of the script otherwise; turn `index` of such a loop. */
void laves__script_ask(struct lua_State *L, size_t index);

/* A value of the vocabulary: a solid, or a field of numbers over space. */
typedef enum laves__value_kind { LAVES__FIELD, LAVES__SOLID } laves__value_kind;
typedef struct laves__value {
  laves__shape shape; /* of a field only the node counts */
  laves__value_kind kind;
} laves__value;

/* Pushes a value; raises a Lua error if its making failed. */
int laves__script_push(struct lua_State *L, laves__value_kind kind, laves__shape shape);
/* NULL when the stack item is not a value. */
laves__value *laves__script_value(struct lua_State *L, int index);
/* The item as a solid: a field counts as the solid where it is negative. Raises an error for anything else. */
laves__shape laves__script_solid(struct lua_State *L, int index, const char *function);
/* A phrase for messages: "a solid", "a field", "a number", ... */
const char *laves__script_type(struct lua_State *L, int index);

/* Parameters of a function, given by position or in one table by name. */
typedef enum laves__parameter_kind {
  LAVES__ANY,         /* a finite number */
  LAVES__POSITIVE,    /* > 0 */
  LAVES__NONNEGATIVE, /* >= 0 */
  LAVES__COUNT,       /* an integer of 1 to a million */
  LAVES__VECTOR,      /* {x, y, z}, or "x", "y", "z", or three numbers by position; takes three places of the result */
  LAVES__COUNTS       /* the same, of counts */
} laves__parameter_kind;

typedef struct laves__parameter {
  const char *name;
  laves__parameter_kind kind;
  double fallback; /* NAN: must be given. For a vector: its z, with x and y zero. */
} laves__parameter;

/* Reads the arguments from stack item `first` on; raises an error that names function and parameter. */
void laves__script_arguments(struct lua_State *L, const char *function, int first, const laves__parameter *parameters, int count,
                             double *values);

/* The number at a stack item, checked as this parameter. */
double laves__script_number(struct lua_State *L, const char *function, const laves__parameter *parameter, int index);

/* Adds the vocabulary to the table on top of the stack. */
void laves__script_add_fields(struct lua_State *L);     /* script_field.c: x, y, z, arithmetic, functions */
void laves__script_add_primitives(struct lua_State *L); /* script_primitive.c */
void laves__script_add_solids(struct lua_State *L);     /* script_solid.c: combining and changing; methods of solids */
/* Adds d, the value of leaf `leaf` (script_field.c). */
void laves__script_add_depth(struct lua_State *L, uint32_t leaf);

/* keep(), a Lua function (script_keep.c). */
int laves__script_keep(struct lua_State *L);
/* Raises an error where a solid has points and lines to keep that a function would move off the surface. */
void laves__script_refuse_kept(struct lua_State *L, const laves__shape *solid, const char *function);

/* The item as a number or a field; raises an error for anything else. */
laves__node laves__script_field(struct lua_State *L, int index, const char *function);

#endif
