/* What the files of the surface oracle share: the welded surface, its tree, its topology.
 *
 *   surface.c           the story: weld -> tree -> topology -> direction -> crossings -> oracle
 *   surface_weld.c      equal points become one, degenerate and repeated faces go
 *   surface_topology.c  faces across edges, fans, components, normals
 *   surface_bvh.c       the tree and the nearest triangle
 *   surface_crossing.c  pairs of triangles that meet where they should not
 *   surface_winding.c   how often the surface winds round a point
 *   surface_patch.c     which triangles bound the union of what is enclosed
 *   surface_mend.c      cracks, repeats and directions of surfaces that are not closed
 *   surface_cut.c       what of triangles that meet others bounds the solid
 *   surface_direct.c    which way parts within parts face
 *   surface_stitch.c    T-junctions
 *   surface_open.c      what stays open: {winding number = 1/2}
 *   surface_part.c      closed parts, which can be regions of the mesh
 *   surface_sample.c    samples, thin places
 *   surface_oracle.c    sign, distance, projection
 *
 * Coordinates are local everywhere: input minus origin. */
#ifndef LAVES_DOMAIN_SURFACE_H
#define LAVES_DOMAIN_SURFACE_H

#include "base/base.h"
#include "base/vec3.h"
#include "domain/oracle.h"
#include "domain/surface_input.h"

#define LAVES__NONE UINT32_MAX

/* Faces are counted in 28 bits inside the tree. */
enum { LAVES__FACES_MAX = 1 << 28, LAVES__LEAF_MAX = 2, LAVES__BVH_STACK = 256 };

/* ---- tree ---- */

/* A triangle as queries like it: corners and the dual basis, so that the barycentric coordinates of a point's foot in the
 * plane are dot(p - a, dual_b) and dot(p - a, dual_c). The dual of a triangle without area is NAN. */
typedef struct laves__triangle {
  laves__vec3 a, b, c, dual_b, dual_c;
} laves__triangle;

/* Four boxes, rounded outwards, in the units of the tree (lengths times `scale`, so about 1 wide). A child is the index of
 * a node, or LAVES__LEAF_BIT | (count - 1) << 28 | first slot. Unused boxes are far away and their child is a leaf. */
#define LAVES__LEAF_BIT 0x80000000u
typedef struct laves__bvh_node {
  float centre[3][4], half[3][4];
  uint32_t child[4];
} laves__bvh_node;

/* The slots of a leaf, first and last, and whether place i of a node holds anything. */
static inline uint32_t laves__leaf_first(uint32_t child) { return child & 0x0fffffffu; }
static inline uint32_t laves__leaf_last(uint32_t child) { return (child & 0x0fffffffu) + (child >> 28 & 7); }
static inline bool laves__bvh_is_used(const laves__bvh_node *n, int i) { return n->centre[0][i] < 1e16f; }

typedef struct laves__bvh {
  laves__bvh_node *nodes;
  size_t node_count, node_capacity;
  laves__triangle *triangles; /* in the order of the leaves */
  size_t count;
  double scale; /* a power of two */
} laves__bvh;

/* Builds the tree over faces; order[slot] receives the face that stands at each slot. False when memory is short. */
bool laves__bvh_build(laves_context *context, const laves__vec3 *points, const uint32_t (*faces)[3], size_t face_count,
                      uint32_t *order, laves__bvh *bvh);
void laves__bvh_free(laves_context *context, laves__bvh *bvh);

/* Where on a triangle the closest point lies: 0 its inside, 1 2 3 the edges ab bc ca, 4 5 6 the corners a b c. */
enum { LAVES__ON_FACE = 0, LAVES__ON_EDGE = 1, LAVES__ON_CORNER = 4 };

typedef struct laves__nearest {
  double distance2; /* squared */
  uint32_t slot;    /* LAVES__NONE: nothing nearer than the start value of distance2 */
} laves__nearest;

laves__triangle laves__triangle_of(laves__vec3 a, laves__vec3 b, laves__vec3 c);
double laves__triangle_distance2(const laves__triangle *t, laves__vec3 p);
/* The closest point of the triangle; on receives which part of it that is. */
laves__vec3 laves__triangle_closest(const laves__triangle *t, laves__vec3 p, int *on);

/* Improves `best`: the triangle of least squared distance, of several the one of least slot. Triangles are looked for that
 * are as near as best->distance2 or nearer. What best held before never changes the answer when it was a true
 * distance to its slot. */
void laves__bvh_nearest(const laves__bvh *bvh, laves__vec3 p, laves__nearest *best);

/* Distance by parts: a triangle whose whole is nearer than distance2 is handed to `measure`, which returns the squared
 * distance to what counts of it (INFINITY: nothing). */
typedef double laves__measure_fn(void *user, uint32_t slot, double distance2, laves__vec3 p);
void laves__bvh_nearest_part(const laves__bvh *bvh, laves__vec3 p, laves__measure_fn *measure, void *user, laves__nearest *best);

/* Calls fn for every slot from `least` on whose triangle's leaf overlaps the box (units of the surface). */
typedef void laves__slot_fn(void *user, uint32_t slot);
void laves__bvh_overlaps(const laves__bvh *bvh, laves__box3 box, laves__slot_fn *fn, void *user);

typedef struct laves__hit {
  double distance;
  uint32_t slot; /* LAVES__NONE: no triangle nearer than the start value of distance */
} laves__hit;

/* The first triangle on the ray from `origin` along the unit vector `direction`, other than `skip`. */
void laves__bvh_shoot(const laves__bvh *bvh, laves__vec3 origin, laves__vec3 direction, uint32_t skip, laves__hit *hit);

/* ---- winding number ---- */

/* What the far field of a node or leaf needs: the vector area and its first moment about the centre. */
typedef struct laves__moment {
  laves__vec3 centre, area_vector;
  double first[6]; /* xx yy zz, and the sums xy yz zx of both orders */
  double area, radius;
} laves__moment;

/* Those of the four children of a node, side by side. */
typedef struct laves__moments {
  double centre[3][4], area_vector[3][4], first[6][4];
  double radius2[4]; /* squared; of leaves somewhat enlarged; -1: no child */
} laves__moments;

typedef struct laves__winding {
  laves__bvh *bvh;
  laves__moments *moments; /* [node_count] of the children of each node */
  size_t node_count;
  double far_factor; /* radii of a node beyond which its expansion serves; may be changed */
} laves__winding;

/* bvh stays the caller's and must outlive the result. */
bool laves__winding_build(laves_context *context, laves__bvh *bvh, laves__winding *w);
void laves__winding_free(laves_context *context, laves__winding *w);
/* How often the surface winds round p, leaving out the triangles in slots skip_a and skip_b (LAVES__NONE: none). An
 * integer for closed surfaces, but for the error of the expansions. */
double laves__winding_number(const laves__winding *w, laves__vec3 p, uint32_t skip_a, uint32_t skip_b);
/* How the number changes with p. An estimate, by the same expansions. */
laves__vec3 laves__winding_gradient(const laves__winding *w, laves__vec3 p);
/* The part of one directed edge in 4 pi times the gradient; edges used both ways cancel, and the rim is left. */
laves__vec3 laves__edge_winding_gradient(laves__vec3 a, laves__vec3 b, laves__vec3 p);

/* ---- surface ---- */

/* Of a face: it meets others, so that a part of it may lie inside the solid; of one of an open surface: it bounds the solid
 * all over and by a wide margin, so that near it the normal tells the sign. */
enum { LAVES__PARTIAL = 1, LAVES__PLAIN = 2 };

typedef struct laves__surface {
  laves_context *context;
  double level;                  /* the solid is where the winding number exceeds it */
  struct laves_defects *defects; /* while the input is judged, and places are asked for; else NULL */
  laves__vec3 *points;
  size_t point_count, point_capacity;
  uint32_t (*faces)[3]; /* in the order of the tree's slots */
  int32_t *tags;        /* [face_capacity], NULL: none */
  uint32_t *sources;    /* [face_capacity] the face of the file that each is a part of, from 0 */
  size_t face_count, face_capacity;
  uint32_t *across;           /* [3 face_capacity] half-edge (3 face + corner where it starts) on the other side, or NONE */
  laves__vec3 *point_normals; /* [point_capacity] weighted by angle */
  laves__bvh bvh;
  double diagonal;
  bool crowded;       /* more pairs of faces lie close together than can be compared */
  laves__vec3 origin; /* input coordinates of the local zero point */
  /* Where normals do not tell the sign, the winding number does: at partial faces and at doubtful points and edges. */
  bool needs_winding;
  uint8_t *face_flags;   /* [face_capacity] */
  bool *doubtful_points; /* [point_capacity] points of partial faces, of edges without one other face, of several fans */
  laves__winding winding;
  laves__bvh all;          /* the tree behind `winding` when walls were left out of `bvh`; else empty */
  uint32_t *winding_slot;  /* [face_capacity] slot in `all` of each face; NULL: the same */
  laves__triangle *pieces; /* what of partial faces bounds the solid */
  uint32_t *piece_starts;  /* [face_capacity + 2] those of face f stand in pieces[piece_starts[f] .. piece_starts[f + 1]) */
  size_t piece_count;
  /* Parts, as laves__surface_find_parts() tells; NULL: it is all one. */
  uint32_t *part; /* [part_capacity] of each face, in the order of the tree behind `winding` */
  size_t part_capacity, part_count;
  int32_t *part_tag; /* [part_count] the tag that all of its faces and no others have, or -1 */
  bool *part_closed; /* [part_count] */
  /* Half-edges of edges not used as often forwards as backwards, each once for every use too many. */
  uint32_t *rim;
  size_t rim_count, rim_capacity;
  /* Open surfaces: */
  bool open;
  size_t all_face_count; /* with those left out */
  double *rim_lengths;   /* of the rim below each node of rim_tree */
  laves__bvh rim_tree;   /* over the rim of the whole, before walls were left out */
} laves__surface;

/* The normal of a face, of length one; zero for faces without area. Made anew each time, for a large surface has no memory to
 * spare for all. */
static inline laves__vec3 laves__face_normal(const laves__surface *s, uint32_t face) {
  const laves__triangle *t = &s->bvh.triangles[face];
  return v3_unit(v3_cross(v3_sub(t->b, t->a), v3_sub(t->c, t->a)));
}

/* ---- weld ---- */

/* Fills points, faces, tags and sources from input (local coordinates); counts repeated and unused points, degenerate and
 * repeated faces. False when memory is short. */
bool laves__surface_weld(laves__surface *s, const laves__surface_input *input, laves__vec3 origin, laves_domain_info *info);

/* Drops faces that repeat another; any_direction: also in the opposite direction. */
bool laves__surface_drop_repeats(laves__surface *s, bool any_direction, laves_domain_info *info);

/* ---- topology ---- */

/* Fills `across`, `rim` and doubtful_points (whose faces form no single closed fan), and counts what info holds about edges, fans
 * and components (info may be a scratch copy). False when memory is short. */
bool laves__surface_topology(laves__surface *s, laves_domain_info *info);
/* Fills info->topology_known and genus when all else is known of the surface, whose faces are those that were judged; false when
 * memory is short. */
bool laves__surface_genus(const laves__surface *s, laves_domain_info *info);
bool laves__surface_normals(laves__surface *s);

/* Calls fn once for every edge with all its half-edges, ascending; fn may change the list. False when memory is short. */
typedef struct laves__edge_use {
  uint32_t other; /* the greater point */
  uint32_t half;  /* 3 face + corner where it starts */
} laves__edge_use;
typedef void laves__edge_fn(void *user, laves__edge_use *uses, size_t count);
bool laves__surface_each_edge(const laves__surface *s, laves__edge_fn *fn, void *user);
/* Signed volume (meaningful for closed surfaces) and area. */
void laves__surface_measure(const laves__surface *s, double *volume, double *area);

/* atan2(y, x) for any x, y to 2e-8, from arithmetic and square roots alone, so that it is the same on every platform. */
static inline double laves__angle(double y, double x) {
  const double ax = fabs(x), ay = fabs(y);
  const double large = ax > ay ? ax : ay, small = ax > ay ? ay : ax;
  if (!(large > 0)) return 0;
  /* Abramowitz and Stegun, "Handbook of mathematical functions", 1964, eq. 4.4.49. */
  const double t = small / large, u = t * t;
  const double p0 = 1 + u * (-0.3333314528 + u * (0.1999355085 + u * (-0.1420889944 + u * 0.1065626393)));
  const double p1 = u * u * u * u * u * (-0.0752896400 + u * (0.0429096138 + u * (-0.0161657367 + u * 0.0028662257)));
  double angle = t * (p0 + p1);
  if (ay > ax) angle = 1.5707963267948966 - angle;
  if (x < 0) angle = 3.141592653589793 - angle;
  return y < 0 ? -angle : angle;
}

/* ---- crossings ---- */

typedef struct laves__crossings {
  uint32_t (*pairs)[2]; /* slots, the lesser first, sorted */
  size_t count, capacity;
} laves__crossings;

/* All pairs of triangles that cross, overlap, or touch other than in common points and edges. False when memory is short, on a
 * cancel, or when they are too many, which sets s->crowded. */
bool laves__surface_crossings(laves__surface *s, laves__crossings *all);
/* Counts them in info, and notes them in s->defects. False when memory is short. */
bool laves__surface_note_crossings(const laves__surface *s, const laves__crossings *c, laves_domain_info *info);
void laves__crossings_free(laves_context *context, laves__crossings *c);
/* The segment in which two triangles of different planes meet, to rounding. */
bool laves__triangles_meet(const laves__triangle *t, const laves__triangle *u, laves__vec3 ends[2]);

/* ---- walls ---- */

/* Winding number at the middle of a face, the mean of both sides. */
double laves__surface_mean_winding(const laves__surface *s, uint32_t slot);
/* keep[f]: face f bounds the solid {winding number >= 1}, or is partial; inverted[f]: it bounds {<= -1} instead. Both
 * bool[face_count]. False when memory is short. */
bool laves__surface_find_walls(const laves__surface *s, bool *keep, bool *inverted);

/* ---- pieces ---- */

/* Cuts partial faces where they meet others and keeps the pieces that bound the solid. False when memory is short or on a
 * cancel. */
bool laves__surface_cut(laves__surface *s, const laves__crossings *crossings);

/* ---- parts ---- */

/* Finds which part each face belongs to: the faces of one tag, where several tags are given and these are closed by themselves;
 * else what hangs together over edges. Where more than two faces meet in an edge, those go together that have the inside of one
 * solid between them, so that solids which touch stay apart. Parts are numbered as the file gives them. False when memory is
 * short. */
bool laves__surface_find_parts(laves__surface *s);

/* Faces by part: those of part p stand in slots starts[p] .. starts[p + 1] - 1. */
typedef struct laves__part_faces {
  uint32_t *starts; /* [part_count + 2] */
  uint32_t *slots;  /* [face_count] */
  size_t part_count, face_count;
} laves__part_faces;
/* False when memory is short; free it either way. */
bool laves__part_faces_list(const laves__surface *s, laves__part_faces *of);
void laves__part_faces_free(laves_context *context, laves__part_faces *of);

/* Closed parts with an inside, to be asked which of them a point is in; hollows: and those that face inwards. */
typedef struct laves__parts laves__parts;
/* NULL when memory is short. s must outlive the result. */
laves__parts *laves__parts_create(const laves__surface *s, bool hollows);
void laves__parts_free(laves__parts *parts);
size_t laves__parts_count(const laves__parts *parts);
/* Which part of the surface it is, and its volume, negative for hollows. */
uint32_t laves__parts_number(const laves__parts *parts, size_t part);
double laves__parts_volume(const laves__parts *parts, size_t part);
/* The tag that stands for the part alone, or -1. */
int32_t laves__parts_tag(const laves__parts *parts, size_t part);
/* The part that holds p, of several the one of least volume; -1: none. */
int32_t laves__parts_at(const laves__parts *parts, laves__vec3 p);
/* Calls fn for every part that holds p. */
typedef void laves__part_fn(void *user, size_t part);
void laves__parts_around(const laves__parts *parts, laves__vec3 p, laves__part_fn *fn, void *user);
/* Whether any triangle of the surface, of walls inside the solid as well, is within the distance of p. */
bool laves__parts_touch(const laves__parts *parts, laves__vec3 p, double distance);

/* ---- directions ---- */

/* Turns a face over, and the triangle of the tree with it. */
void laves__surface_turn_face(laves__surface *s, uint32_t f);
/* Turns closed parts as info->overlap says, and counts those that cross, that are nested, and that are hollows. turned: whether
 * any was turned, so that topology must be found anew. False when memory is short. */
bool laves__surface_direct_parts(laves__surface *s, const laves__crossings *c, laves_domain_info *info, bool *turned);

/* ---- open surfaces ---- */

/* Makes a surface with open or contradicting edges as closed and as consistent as it can be. Its tree must be built anew. */
bool laves__surface_mend(laves__surface *s, size_t open_edges);
/* Parts faces at open edges on which points of other open edges stand (T-junctions); parted: whether there were any. `across` is
 * to be made anew. False when memory is short. */
bool laves__surface_stitch(laves__surface *s, bool *parted);
/* Which faces bound {winding number > level} somewhere (keep); marks those that do so in part. */
bool laves__surface_judge_open(laves__surface *s, bool *keep);
bool laves__surface_build_rim(laves__surface *s);
/* Whether this share of a grid of points of the box lies inside, or more; false after a cancel. */
bool laves__surface_encloses(const laves__surface *s, laves__box3 box, double share);
/* Winding number less one half. */
double laves__open_excess(const laves__surface *s, laves__vec3 p);
/* Whether the rim is so far from p that a plain face at `distance` is all that matters. */
bool laves__open_rim_is_far(const laves__surface *s, laves__vec3 p, double distance);
/* Rough distance to the caps of holes where that is less than `distance`, that to the triangles; else INFINITY. */
double laves__open_cap_distance(const laves__surface *s, laves__vec3 p, double e, double distance);
/* The same, better; uphill receives the direction in which the excess e at p grows. */
double laves__open_cap_guess(const laves__surface *s, laves__vec3 p, double e, double distance, laves__vec3 *uphill);
/* The cap's point along the steepest direction, within reach; guess: its estimated distance. */
bool laves__open_project(const laves__surface *s, laves__vec3 p, double e, double guess, laves__vec3 uphill, double reach,
                         laves__vec3 *foot, laves__vec3 *normal);
/* The side of a ball, where it is certain that neither triangles nor caps pass through it. */
laves__side laves__open_side(const laves__surface *s, laves__vec3 p, double radius);

/* ---- samples ---- */

/* Functions of the oracle. */
size_t laves__surface_sample(const void *self, double spacing, laves__vec3 *points, size_t capacity);
size_t laves__surface_thin_places(const void *self, laves_thin_kind kind, laves_thin_place *places, size_t capacity);
/* Volume of a closed surface that meets itself: partial faces count by the parts of them that bound the solid. */
double laves__surface_union_volume(const laves__surface *s);

/* ---- oracle ---- */

/* Whether face `slot` bounds the solid at its point q. */
bool laves__surface_bounds_at(const laves__surface *s, uint32_t slot, laves__vec3 q);

/* Some of the faces. */
typedef struct laves__part {
  const int32_t *label; /* [faces] patches */
  int32_t wanted;       /* those that join this one are meant */
  const struct laves__features *features;
  const bool *on_border; /* [points] where a crease is */
} laves__part;

/* As laves__oracle.project, on the part alone; the normal is that of its own faces. Caps of holes belong to no part. */
bool laves__surface_project_part(const laves__surface *s, const laves__part *part, laves__vec3 point, double reach,
                                 uint32_t *hint, laves__vec3 *foot, laves__vec3 *normal);

/* The last step: s is ready, its functions go into the oracle. */
void laves__surface_oracle(laves__surface *s, laves__oracle *oracle);
void laves__surface_free(laves_context *context, void *self);

#endif
