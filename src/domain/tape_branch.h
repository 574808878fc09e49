/* Branches of a tape: the smooth functions that a solid is made of.
 *
 * Minima, maxima and absolute values make the kinks of an expression. At a point each of them takes one side; what the value
 * depends on there, found by walking from the result down, is the point's SIGNATURE: instructions reached, and their choices.
 * Floors count as choices of an integer, and the norm of a vector with one component other than zero as the choice of
 * that component and its sign: outside a box, near a face, |(q, 0, 0)| is q, and so is smooth across the face.
 *
 *      max(a, min(b, c)) where a < b < c:     max takes its second operand, min its first; the branch is b
 *
 * With all choices held fast the expression is smooth all over: the BRANCH, compiled to a tape of its own. Signatures that
 * give the same expression (max(a, max(b, c)) has two ways to yield a) are the same branch.
 *
 * On boxes, intervals decide many choices at once. A CODE is the tape with what is decided cut away, down to the
 * few instructions that matter in the box: after Matthew Keeter, "Massively parallel rendering of complex closed-form
 * implicit surfaces", ACM Trans. Graph. 39(4), 2020, section 3 (there: tape pruning). */
#ifndef LAVES_DOMAIN_TAPE_BRANCH_H
#define LAVES_DOMAIN_TAPE_BRANCH_H

#include "domain/tape.h"

/* No branch known. */
#define LAVES__NO_BRANCH (-1)

/* What a store holds at most: branches, signatures, choices of all signatures, instructions of all branches (24 MB). A solid
 * that has more keeps those met first. */
enum {
  LAVES__BRANCH_LIMIT = 16384,
  LAVES__SIGNATURE_LIMIT = 131072,
  LAVES__CHOICE_LIMIT = 1 << 23,
  LAVES__BRANCH_CODE_LIMIT = 1 << 20
};

/* ---- codes ---- */

/* What an operand has gone through on its way: a decided choice (side 0: none), and the trails that lead there (number + 1;
 * 0: none). Who reaches the operand has made these choices. */
typedef struct laves__trail {
  uint32_t instruction; /* of the whole tape */
  int32_t side;
  uint32_t before[2];
} laves__trail;

/* Operands of an instruction by who makes them. */
enum { LAVES__FROM_X = -3, LAVES__FROM_Y, LAVES__FROM_Z, LAVES__FROM_CONSTANT = -4 };
typedef struct laves__code_item {
  uint32_t origin;   /* instruction of the whole tape that it stands for */
  int32_t source[3]; /* an item, or one of LAVES__FROM_ */
  uint32_t trail[3]; /* of each operand, + 1 */
  bool may_vanish;   /* a norm or a root that may be zero */
} laves__code_item;

typedef struct laves__code {
  laves__tape tape;       /* the same with registers, for running; instructions: [capacity] */
  laves__code_item *item; /* [capacity] */
  size_t capacity;
  laves__trail *trail;
  size_t trail_count, trail_capacity;
  uint32_t root_trail;
  size_t open_count; /* choices that are not decided, and norms that may vanish */
  size_t norm_count; /* of these the norms and roots */
} laves__code;

/* Room for cutting codes and for telling signatures of one tape; one for each thread. */
typedef struct laves__branch_room {
  size_t count;             /* of the whole tape's instructions: all arrays have this and some more */
  laves__interval *results; /* these three for cutting only */
  struct laves__cut_value *value;
  int32_t *number;
  bool *live;
  int32_t *side;
  struct laves__choice *choices;
  bool *visited; /* trails */
  uint32_t *stack;
  size_t trail_capacity;
} laves__branch_room;

bool laves__branch_room_make(laves_context *context, const laves__tape *whole, laves__branch_room *room);
void laves__branch_room_free(laves_context *context, laves__branch_room *room);

/* The whole tape as a code. False when memory is short. */
bool laves__code_whole(laves_context *context, const laves__tape *tape, laves__code *code);
/* Cuts `code` down to what matters in the box; `cut` is overwritten and grows as needed. False when memory is short. */
bool laves__code_cut(laves_context *context, const laves__code *code, laves__box3 box, laves__branch_room *room,
                     laves__code *cut);
void laves__code_free(laves_context *context, laves__code *code);

/* ---- signatures ---- */

typedef struct laves__choice {
  uint32_t instruction; /* of the whole tape */
  int32_t side;         /* never 0. MIN, MAX: 1 or 2, the operand; ABS: 1 positive, 2 negative; floors: n + 1, or n < 0 */
} laves__choice;

typedef struct laves__signature {
  laves__choice *choices; /* instructions descending; in the room that it was made in */
  size_t count;
} laves__signature;

/* The signature at a point where `code` is valid. False when memory is short. */
bool laves__signature_at(laves_context *context, const laves__tape *whole, const laves__code *code, laves__vec3 point,
                         laves__branch_room *room, laves__signature *signature);

/* ---- the store ---- */

typedef struct laves__branches {
  laves_context *context;
  const laves__tape *whole; /* not owned */
  laves__expression expression;
  laves__tape *tape; /* of each branch */
  laves__node *root; /* and its node in `expression` */
  size_t count, tape_capacity, root_capacity, code_total;
  struct laves__known_signature *known;
  size_t known_count, known_capacity;
  laves__choice *pool;
  size_t pool_count, pool_capacity;
  uint32_t *table; /* open addressing: signature + 1 */
  size_t table_size;
  bool out_of_memory;
} laves__branches;

void laves__branches_init(laves__branches *b, laves_context *context, const laves__tape *whole);
void laves__branches_free(laves__branches *b);

/* The branch of a signature, or LAVES__NO_BRANCH when it has not been met. Read only. */
int32_t laves__branches_find(const laves__branches *b, const laves__signature *signature);
/* The same; one not met yet is added. LAVES__NO_BRANCH when the store is full, or memory short (then out_of_memory). */
int32_t laves__branches_add(laves__branches *b, const laves__signature *signature);

#endif
