/* What the files that add the user's points and lines share: the drawing on the surface, and where it meets what is there.
 *
 *   feature_lines.c   the story: trace -> meet -> drop what runs along others -> give points and segments
 *   feature_drawing.c points on to the surface, lines cut to pieces that follow it
 *   feature_meet.c    where points and pieces meet creases and one another
 *
 * Coordinates are local. */
#ifndef LAVES_DOMAIN_FEATURE_LINES_H
#define LAVES_DOMAIN_FEATURE_LINES_H

#include "domain/features.h"

/* All as fractions of the diagonal of the domain's bounds. */

/* How far off the surface a drawn point may be. As laves.h promises. */
#define LAVES__DRAWN_OFF 1e-3
/* Up to this a drawn point is on the surface but for rounding, and stays where it is. */
#define LAVES__DRAWN_EXACT 1e-9
/* Up to this two points are one: what is written with seven digits. */
#define LAVES__DRAWN_SAME 1e-6
/* Pieces of a line follow the surface within this. Finer costs more pieces, by its square root. */
#define LAVES__DRAWN_FOLLOW 2e-5
/* What comes nearer than this meets: more than twice the above, as two lines on a curved surface may each be off by that;
 * far less than any size at which a mesh can be made. */
#define LAVES__DRAWN_MEET 5e-5

/* ---- the drawing on the surface ---- */

typedef struct laves__drawn_line {
  size_t first, count; /* nodes */
  bool closed;         /* the last node is joined to the first */
} laves__drawn_line;

/* The nodes of all lines, one line after the other, then the single points. */
typedef struct laves__drawing {
  laves_context *context;
  const laves__oracle *oracle;
  double diagonal;
  laves__vec3 *node;
  size_t node_count, node_capacity;
  laves__drawn_line *line;
  size_t line_count;
  size_t single_first; /* node */
} laves__drawing;

/* Fills a drawing whose context and oracle are set. LAVES_ERROR_INPUT where something is off the surface. */
laves_result laves__drawing_trace(laves__drawing *drawing, const laves_features *drawn, laves_error *error);
void laves__drawing_free(laves__drawing *drawing);

/* ---- where it meets ---- */

/* Something that can be met: a segment, or a point with two equal ends. In this order: the segments that were there, the fixed
 * points that were there, the pieces of all drawn lines, the single points. Each meets only what comes before it. */
typedef struct laves__meet_item {
  uint32_t ends[2]; /* points of the meeting */
  uint32_t line;    /* 0: it was there; else the drawn line + 1, and single points behind them */
} laves__meet_item;

/* A point that lies on an item between its ends. */
typedef struct laves__meet_cut {
  uint32_t item, point;
  bool own;     /* the item's line goes through the point of another, else the point's line comes to the item */
  double share; /* of the way from the first end to the second */
} laves__meet_cut;

typedef struct laves__meet_point {
  laves__vec3 place;
  uint32_t same;  /* the point of which this is another name, or itself */
  bool fixed;     /* drawn as a point, or the end of a line, or a crossing */
  bool exact;     /* fixed, and its place is the user's */
  bool touched;   /* something else goes through it */
  uint8_t degree; /* segments at it that were there, at most 3, and 3 where it is a corner whatever meets there */
} laves__meet_point;

/* Points: those that were there, then the nodes of the drawing, then crossings. */
typedef struct laves__meeting {
  const laves__drawing *drawing;
  const laves__feature_lines *lines; /* not changed before all is found */
  size_t old_count;                  /* of their points, then */
  laves__meet_point *point;
  size_t point_count, point_capacity;
  laves__meet_item *item;
  size_t item_count, item_capacity, piece_first; /* the first piece's index */
  double *way;                                   /* [nodes] along the line from its start */
  double *line_length;                           /* [lines] */
  laves__meet_cut *cut;                          /* in the end sorted by item and share */
  size_t cut_count, cut_capacity;
  laves__bvh tree;
  uint32_t *order; /* the item at each slot */
} laves__meeting;

laves_result laves__meeting_find(laves__meeting *meeting, const laves__drawing *drawing, const laves__feature_lines *lines,
                                 laves_error *error);
void laves__meeting_free(laves__meeting *meeting);
/* The point that a point is another name of. */
uint32_t laves__meeting_root(const laves__meeting *meeting, uint32_t point);
/* Whether a place on a piece lies on what comes before it, to LAVES__DRAWN_MEET. */
bool laves__meeting_is_taken(const laves__meeting *meeting, uint32_t item, laves__vec3 place);

#endif
