/* What laves_sizing holds: sources as the caller gave them, not yet bound to a domain. */
#ifndef LAVES_SIZE_SIZING_H
#define LAVES_SIZE_SIZING_H

#include "base/base.h"
#include "base/vec3.h"
#include "size/background.h"

typedef enum laves__source_kind {
  LAVES__SOURCE_SCRIPT,     /* text is a Lua chunk, or an expression */
  LAVES__SOURCE_BACKGROUND, /* background */
  LAVES__SOURCE_POINTS,     /* points, size, radius */
  LAVES__SOURCE_CURVE,      /* the same, each joined to the next */
  LAVES__SOURCE_TAG,        /* text is a name; size, radius */
} laves__source_kind;

typedef struct laves__source {
  laves__source_kind kind;
  char *text, *name, *folder; /* blocks of length + 1, NUL behind; NULL: none. name: for messages */
  size_t text_length, name_length, folder_length;
  bool is_expression;
  laves__background_sizes *background;
  laves__vec3 *points; /* input coordinates */
  size_t point_count;
  double size, radius;
} laves__source;

struct laves_sizing {
  laves_context *context;
  laves__source *sources;
  size_t count, capacity;
};

#endif
