/* Points and polylines as a file has them, and loose pieces joined.
 *
 * Formats of meshes have lines as elements of two nodes, in any order and direction. Where exactly two such pieces meet, the line
 * goes on; everywhere else it ends. A piece is walked from each end that is an end of a line, then what is left are rings.
 * The order depends on the nodes' indices alone. */
#include "io/line_list.h"

#include <stdlib.h>
#include <string.h>

bool laves__line_list_add_single(laves__line_list *l, int32_t point) {
  if (!laves__grow(l->context, &l->single, &l->single_capacity, l->single_count + 1, sizeof *l->single)) return false;
  l->single[l->single_count++] = point;
  return true;
}

bool laves__line_list_add_node(laves__line_list *l, int32_t point) {
  if (!laves__grow(l->context, &l->node, &l->node_capacity, l->node_count + 1, sizeof *l->node)) return false;
  l->node[l->node_count++] = point;
  return true;
}

bool laves__line_list_end(laves__line_list *l) {
  const size_t first = laves__line_list_first(l, l->line_count), count = l->node_count - first;
  if (count == 0) return true;
  if (count == 1) return laves__line_list_add_single(l, l->node[--l->node_count]);
  if (!laves__grow(l->context, &l->line_end, &l->line_capacity, l->line_count + 1, sizeof *l->line_end)) return false;
  l->line_end[l->line_count++] = l->node_count;
  return true;
}

void laves__line_list_free(laves__line_list *l) {
  if (!l->context) return;
  laves__free(l->context, l->single, l->single_capacity, sizeof *l->single);
  laves__free(l->context, l->node, l->node_capacity, sizeof *l->node);
  laves__free(l->context, l->line_end, l->line_capacity, sizeof *l->line_end);
  memset(l, 0, sizeof *l);
}

/* ---- joining ---- */

typedef struct piece {
  int32_t ends[2]; /* ascending */
  bool used;
} piece;

enum { STOP = 3 }; /* a degree at which lines end, as all but 2 */

typedef struct joiner {
  const laves__line_list *old;
  laves__line_list *joined;
  size_t point_count;
  piece *piece;
  size_t piece_count, piece_capacity;
  uint8_t *degree;   /* [point_count] loose pieces at each point, STOP where it must not be passed */
  uint32_t (*at)[2]; /* [point_count] the pieces of a point of degree 2 */
} joiner;

static int compare_pieces(const void *a, const void *b) {
  const piece *x = a, *y = b;
  if (x->ends[0] != y->ends[0]) return x->ends[0] < y->ends[0] ? -1 : 1;
  return (x->ends[1] > y->ends[1]) - (x->ends[1] < y->ends[1]);
}

/* Loose pieces go to a list of their own; longer lines are kept as they are, and stop the joining where they pass. */
static bool part_lines(joiner *j) {
  const laves__line_list *l = j->old;
  for (size_t line = 0; line < l->line_count; line++) {
    const size_t first = laves__line_list_first(l, line), end = l->line_end[line];
    if (end - first == 2) {
      const int32_t a = l->node[first], b = l->node[first + 1];
      if (a == b) continue;
      if (!laves__grow(j->joined->context, &j->piece, &j->piece_capacity, j->piece_count + 1, sizeof *j->piece)) return false;
      j->piece[j->piece_count++] = (piece){{a < b ? a : b, a < b ? b : a}, false};
      continue;
    }
    for (size_t i = first; i < end; i++) {
      j->degree[l->node[i]] = STOP;
      if (!laves__line_list_add_node(j->joined, l->node[i])) return false;
    }
    if (!laves__line_list_end(j->joined)) return false;
  }
  return true;
}

static void drop_repeats(joiner *j) {
  size_t kept = 0;
  if (j->piece_count == 0) return;
  qsort(j->piece, j->piece_count, sizeof *j->piece, compare_pieces);
  for (size_t i = 0; i < j->piece_count; i++)
    if (i == 0 || compare_pieces(&j->piece[kept - 1], &j->piece[i]) != 0) j->piece[kept++] = j->piece[i];
  j->piece_count = kept;
}

static void find_degrees(joiner *j) {
  for (size_t i = 0; i < j->old->single_count; i++) j->degree[j->old->single[i]] = STOP;
  for (uint32_t i = 0; i < j->piece_count; i++)
    for (int k = 0; k < 2; k++) {
      const int32_t p = j->piece[i].ends[k];
      if (j->degree[p] < 2) j->at[p][j->degree[p]] = i;
      if (j->degree[p] < STOP) j->degree[p]++;
    }
}

/* The line that starts at a point with a piece, until it ends or comes round. */
static bool walk(joiner *j, int32_t from, uint32_t index) {
  if (!laves__line_list_add_node(j->joined, from)) return false;
  for (;;) {
    piece *p = &j->piece[index];
    p->used = true;
    from = p->ends[p->ends[0] == from];
    if (!laves__line_list_add_node(j->joined, from)) return false;
    if (j->degree[from] != 2) break;
    const uint32_t next = j->at[from][j->at[from][0] == index];
    if (j->piece[next].used) break;
    index = next;
  }
  return laves__line_list_end(j->joined);
}

static bool walk_all(joiner *j) {
  for (uint32_t i = 0; i < j->piece_count; i++)
    for (int k = 0; k < 2 && !j->piece[i].used; k++)
      if (j->degree[j->piece[i].ends[k]] != 2 && !walk(j, j->piece[i].ends[k], i)) return false;
  for (uint32_t i = 0; i < j->piece_count; i++)
    if (!j->piece[i].used && !walk(j, j->piece[i].ends[0], i)) return false;
  return true;
}

bool laves__line_list_join(laves__line_list *list, size_t point_count) {
  laves_context *context = list->context;
  laves__line_list joined = {.context = context};
  joiner j = {.old = list, .joined = &joined, .point_count = point_count};
  j.degree = laves__alloc_zeroed(context, point_count, sizeof *j.degree);
  j.at = laves__alloc(context, point_count, sizeof *j.at);
  bool done = j.degree && j.at && part_lines(&j);
  if (done) {
    drop_repeats(&j);
    find_degrees(&j);
    done = walk_all(&j);
  }
  laves__free(context, j.degree, point_count, sizeof *j.degree);
  laves__free(context, j.at, point_count, sizeof *j.at);
  laves__free(context, j.piece, j.piece_capacity, sizeof *j.piece);
  if (done) { /* the single points stay */
    joined.single = list->single;
    joined.single_count = list->single_count;
    joined.single_capacity = list->single_capacity;
    list->single = NULL;
    list->single_capacity = 0;
    laves__line_list_free(list);
    *list = joined;
  } else {
    laves__line_list_free(&joined);
  }
  return done;
}
