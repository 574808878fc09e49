/* The members of a certificate as data: one table writes, reads and compares them. */
#ifndef LAVES_IO_CERTIFICATE_TABLE_H
#define LAVES_IO_CERTIFICATE_TABLE_H

#include "base/base.h"

/* Raised when a member changes its meaning or goes; new members do not raise it. */
enum { LAVES__CERTIFICATE_SCHEMA = 1 };

typedef enum laves__member_kind {
  LAVES__MEMBER_TEXT,         /* char[count], with its NUL */
  LAVES__MEMBER_COUNT,        /* size_t[count] */
  LAVES__MEMBER_LATER,        /* size_t; null or, in certificates older than it, missing: SIZE_MAX, not known */
  LAVES__MEMBER_INTEGER,      /* int64_t */
  LAVES__MEMBER_NUMBER,       /* double[count]; null: NAN */
  LAVES__MEMBER_FLAG,         /* bool */
  LAVES__MEMBER_LATER_NUMBER, /* double; in certificates older than it missing: 0 */
  LAVES__MEMBER_LATER_FLAG,   /* bool; the same: false */
  LAVES__MEMBER_ALIGN,        /* laves_align, by name */
  LAVES__MEMBER_METHOD,       /* laves_method, by name */
} laves__member_kind;

/* How a stated member is held against a recomputed one. */
typedef enum laves__member_proof {
  LAVES__PROOF_NONE,    /* it cannot be recomputed from the mesh */
  LAVES__PROOF_EXACT,   /* equal */
  LAVES__PROOF_CLOSE,   /* equal to a relative 1e-9: the order of sums may differ */
  LAVES__PROOF_LENGTH,  /* lengths and places: to 1e-9 of the mean edge and of the coordinate */
  LAVES__PROOF_SURFACE, /* the same with the surface at hand, to 1e-6 */
  LAVES__PROOF_INPUT,   /* equal, with the input at hand */
  LAVES__PROOF_FEATURE, /* as with the surface, unless the caller drew features: then they are not at hand */
} laves__member_proof;

typedef struct laves__member {
  const char *group, *name;
  laves__member_kind kind;
  laves__member_proof proof;
  size_t offset, count;
} laves__member;

/* A group is null in the file when the flag at `flag` is not set; 0: it is always there. is_later: in certificates older than it,
 * it is missing, which means the same. */
typedef struct laves__member_group {
  const char *name;
  size_t flag;
  bool is_later;
} laves__member_group;

/* The first kind of exception that older certificates do not count. */
enum { LAVES__LATER_EXCEPTION = LAVES_EXCEPTION_CREASE_LOST };

extern const laves__member_group laves__certificate_groups[];
extern const size_t laves__certificate_group_count;
/* In the order of their groups. */
extern const laves__member laves__certificate_members[];
extern const size_t laves__certificate_member_count;

/* Reads a certificate from bytes; `name` for messages. */
laves_result laves__certificate_parse(laves_context *context, const char *bytes, size_t length, const char *name,
                                      laves_certificate *certificate, laves_error *error);

/* Names of the enums' values, NULL behind the last. */
extern const char *const laves__align_names[];
extern const char *const laves__method_names[];

#endif
