/* laves: near-regular tetrahedral meshes of any solid.  The public interface, in order of use:
 *
 *   version -> results and errors -> context -> domain -> sizing -> features -> options -> generate -> mesh -> check ->
 *   improve -> certificate -> files
 *
 * Conventions, everywhere: signed distance negative inside; tetrahedra positive, det[b-a, c-a, d-a] > 0; boundary
 * triangles face outwards; indices from 0; coordinates in the units of the input; angles in degrees.
 *
 * No function prints, exits, or touches signals, and there is no global state. Functions that can fail return a
 * laves_result and, where they take a laves_error, leave one sentence in it that says what is wrong, where, and what
 * to do. Free functions accept NULL. Two contexts may be used from two threads at once; objects of one context may be
 * read from many threads, but changed by one only. */
#ifndef LAVES_LAVES_H
#define LAVES_LAVES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "laves/version.h"

#if defined(LAVES_STATIC) && !defined(LAVES_BUILD)
#define LAVES_API
#elif defined(_WIN32) && defined(LAVES_BUILD)
#define LAVES_API __declspec(dllexport)
#elif defined(_WIN32)
#define LAVES_API __declspec(dllimport)
#else
#define LAVES_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- version ---------------------------------------------------------------------------------------------------- */

/// The version of the library in use, such as "0.1.0"; compare with LAVES_VERSION, the version of this header.
LAVES_API const char *laves_version(void);

/* ---- results and errors ----------------------------------------------------------------------------------------- */

/// One list makes the enum, the names and the messages: X(name, exit code of the program, meaning). ERROR_TIMEOUT is the
/// program's alone: who calls the library ends a call that takes too long by its progress callback.
#define LAVES_RESULT_LIST(X)                                               \
  X(OK, 0, "done")                                                         \
  X(TARGET_MISSED, 3, "the mesh is valid, but a wished target was missed") \
  X(ERROR_OPTION, 1, "an option or argument is out of its range")          \
  X(ERROR_INPUT, 2, "the input cannot be read, or describes no solid")     \
  X(ERROR_MEMORY, 4, "out of memory, or over the memory limit")            \
  X(ERROR_WRITE, 5, "the output cannot be written")                        \
  X(ERROR_CANCELLED, 130, "cancelled by the progress callback")            \
  X(ERROR_TIMEOUT, 124, "the time that the program was given is over")     \
  X(ERROR_INTERNAL, 70, "a promise of the library was broken; please report it")

typedef enum laves_result {
#define LAVES_RESULT_ENUM(name, code, text) LAVES_##name,
  LAVES_RESULT_LIST(LAVES_RESULT_ENUM)
#undef LAVES_RESULT_ENUM
} laves_result;

/// A sentence for people. Zero it before the call, or not: a call that fails overwrites it, one that succeeds leaves it.
typedef struct laves_error {
  laves_result result;
  char text[500];  ///< UTF-8, ends with NUL, no line break
} laves_error;

/// "LAVES_ERROR_INPUT" and the like; never NULL.
LAVES_API const char *laves_result_name(laves_result result);
/// The meaning in the list above; never NULL.
LAVES_API const char *laves_result_text(laves_result result);
/// The exit code that the program uses for this result.
LAVES_API int laves_result_exit_code(laves_result result);

/* ---- context ---------------------------------------------------------------------------------------------------- */

/// Everything that calls share: memory, threads, progress. All other objects come from one and must be freed before it.
typedef struct laves_context laves_context;

/// Resizes a block as realloc does: pointer NULL allocates, new_bytes 0 frees (and returns NULL).
/// Must be callable from several threads at once. Blocks are aligned for any basic type.
typedef void *laves_reallocate_fn(void *user, void *pointer, size_t old_bytes, size_t new_bytes);

/// Called with a phase name ("classify", "improve", ...) and the fraction of that phase done, 0..1, now and then, always
/// from the thread that called the library. Return false to cancel: the call then ends with LAVES_ERROR_CANCELLED
/// within about 0.2 seconds.
typedef bool laves_progress_fn(void *user, const char *phase, double fraction);

typedef struct laves_context_options {
  int thread_count;     ///< threads to use; 0: one per core. The result never depends on it.
  size_t memory_limit;  ///< bytes that the context may hold at once, all but some MiB of what a process takes; 0: none
  laves_reallocate_fn *reallocate;  ///< NULL: the C library's
  void *reallocate_user;
  laves_progress_fn *progress;  ///< NULL: none
  void *progress_user;
  double progress_interval;  ///< seconds that lie between two calls of `progress` within a phase, at least, as where each is dear
                             ///< because it enters an interpreter; a cancel is answered so much later; default 0: none
  uint32_t cookie;           ///< set by laves_context_options_default(), checked by laves_context_create()
} laves_context_options;

LAVES_API laves_context_options laves_context_options_default(void);

/// @param options  copied; NULL means the defaults
/// @return NULL when memory is short or the options did not come from laves_context_options_default()
LAVES_API laves_context *laves_context_create(const laves_context_options *options);
LAVES_API void laves_context_free(laves_context *context);
/// Bytes held now by all objects of the context, and the most that were held at once since it was made.
LAVES_API size_t laves_context_bytes(const laves_context *context);
LAVES_API size_t laves_context_peak_bytes(const laves_context *context);

/* ---- domain ----------------------------------------------------------------------------------------------------- */

/// A solid: anything with an inside. Read only once made; safe to read from many threads.
typedef struct laves_domain laves_domain;

/// Reads a triangle surface (STL, OBJ, PLY, OFF, Gmsh; the format is found from the content) or a Lua script (.lua).
/// @param path    file name; or a pipe, which is read to its end (1 GiB at most); its silence can be cancelled
/// @param domain  out: owned by the caller, free with laves_domain_free(); NULL on failure
/// @param error   out, optional
/// @return LAVES_OK, LAVES_ERROR_INPUT, LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
LAVES_API laves_result laves_domain_from_file(laves_context *context, const char *path, laves_domain **domain,
                                              laves_error *error);

/// Places of the defects of a surface; filled by laves_domain_from_file_with() and laves_domain_from_triangles_with(), whether
/// they succeed or refuse the surface. Belongs to a context.
typedef struct laves_defects laves_defects;

/// What the parts of a surface mean that lie within one another or cross. A part is what hangs together over edges, or what has a
/// tag of its own and is closed by itself; only closed parts count. DIRECTION: as faces are directed: a part that faces inwards
/// within another is a hollow of it, one that faces outwards adds nothing; a part that faces inwards by itself is turned.
/// UNION: all that any part encloses is solid. NESTED: parts within an odd number of others are hollows, the rest is solid,
/// whatever their faces' directions. Parts that cross are united by all three.
typedef enum laves_overlap { LAVES_OVERLAP_DIRECTION, LAVES_OVERLAP_UNION, LAVES_OVERLAP_NESTED } laves_overlap;

/// How a triangle surface is read as a solid. From laves_surface_options_default(), then changed.
typedef struct laves_surface_options {
  double winding;          ///< the solid is where the surface winds round a point more often than this; default 0.5, range
                           ///< 0.05..100, at least 0.05 off whole numbers, which are what closed surfaces yield. 1.5: where two
                           ///< closed parts overlap; below 0.5, the caps of open surfaces stand further out, above it further in.
  bool close_holes;        ///< false: refuse surfaces that stay open once cracks are mended; default true: {winding number =
                           ///< `winding`} closes the holes
  laves_overlap overlap;   ///< default LAVES_OVERLAP_DIRECTION
  laves_defects *defects;  ///< out: emptied, then filled with the place of each defect; NULL, the default: not asked for
  uint32_t cookie;         ///< set by laves_surface_options_default(), checked by laves_domain_from_..._with()
} laves_surface_options;

LAVES_API laves_surface_options laves_surface_options_default(void);

/// As laves_domain_from_file(), with a say in how a surface is read as a solid.
/// @param options  copied; NULL: the defaults. With a Lua script they must be NULL or the defaults (LAVES_ERROR_OPTION).
LAVES_API laves_result laves_domain_from_file_with(laves_context *context, const char *path, const laves_surface_options *options,
                                                   laves_domain **domain, laves_error *error);

/// Builds an implicit solid from a Lua 5.4 expression such as "sphere(1) - cylinder{r=0.4}"; docs/implicit.md lists
/// the vocabulary. Runs in a sandbox: no files but surface leaves, no processes, bounded steps and memory.
LAVES_API laves_result laves_domain_from_expression(laves_context *context, const char *text, laves_domain **domain,
                                                    laves_error *error);

/// Builds a domain from triangles in memory; they are copied.
/// @param points           double[point_count][3], finite
/// @param triangles        uint32_t[triangle_count][3], indices into points
/// @param tags             int32_t[triangle_count], carried to the nearest boundary triangles of the mesh; NULL: none
LAVES_API laves_result laves_domain_from_triangles(laves_context *context, const double *points, size_t point_count,
                                                   const uint32_t *triangles, size_t triangle_count, const int32_t *tags,
                                                   laves_domain **domain, laves_error *error);

/// As laves_domain_from_triangles(), with a say in how the surface is read as a solid.
/// @param options  copied; NULL: the defaults
LAVES_API laves_result laves_domain_from_triangles_with(laves_context *context, const double *points, size_t point_count,
                                                        const uint32_t *triangles, size_t triangle_count, const int32_t *tags,
                                                        const laves_surface_options *options, laves_domain **domain,
                                                        laves_error *error);

/// A solid given by a function of the caller's.
typedef struct laves_function {
  /// values[i] = phi(points[3i..3i+2]) for i < count: negative inside, zero on the surface, positive outside. What is no number
  /// counts as outside; laves_report.warnings then has how many and where.
  /// Called from several threads at once, with counts of one to some hundred: as many as can be asked for at a time.
  void (*evaluate)(void *user, const double *points, size_t count, double *values);
  void *user;
  double lower[3], upper[3];  ///< a box that contains the solid with a little room; where it does not, and the solid is followed
                              ///< beyond it, laves_report.warnings says so, or laves_generate() refuses it
  /// |phi(a) - phi(b)| <= lipschitz * |a - b|, which lets far regions be skipped; 0: unknown, everything is evaluated
  double lipschitz;
} laves_function;

/// Builds a domain from such a function.
/// @param function  copied; what `user` points to must outlive the domain
/// @return LAVES_OK, LAVES_ERROR_OPTION (no callback, a box without room, a negative Lipschitz constant), LAVES_ERROR_MEMORY
LAVES_API laves_result laves_domain_from_function(laves_context *context, const laves_function *function, laves_domain **domain,
                                                  laves_error *error);

LAVES_API void laves_domain_free(laves_domain *domain);

/// Signed value of the domain at points: negative inside. A true distance for surfaces; for implicit solids whatever
/// the expression yields.
/// @param points  double[count][3]    @param values  out: double[count]
LAVES_API void laves_domain_evaluate(const laves_domain *domain, const double *points, size_t count, double *values);

typedef enum laves_domain_kind { LAVES_DOMAIN_SURFACE, LAVES_DOMAIN_IMPLICIT, LAVES_DOMAIN_FUNCTION } laves_domain_kind;

/// Defects that a surface can have, with a phrase for people: X(name, phrase).
#define LAVES_DEFECT_LIST(X)                                  \
  X(OPEN_EDGE, "open edges")                                  \
  X(NONMANIFOLD_EDGE, "edges with more than two faces")       \
  X(DIRECTION, "edges whose two faces disagree in direction") \
  X(NONMANIFOLD_VERTEX, "points where several fans meet")     \
  X(DUPLICATE_FACE, "faces that repeat another")              \
  X(DEGENERATE_FACE, "faces without area")                    \
  X(CROSSING, "pairs of faces that cross")                    \
  X(REPEATED_POINT, "points that repeat another")             \
  X(UNUSED_POINT, "points that no face uses")

typedef enum laves_defect {
#define LAVES_DEFECT_ENUM(name, text) LAVES_DEFECT_##name,
  LAVES_DEFECT_LIST(LAVES_DEFECT_ENUM)
#undef LAVES_DEFECT_ENUM
      LAVES_DEFECT_COUNT
} laves_defect;

/// A phrase such as "open edges".
LAVES_API const char *laves_defect_text(laves_defect defect);

/// What a domain is.
typedef struct laves_domain_info {
  laves_domain_kind kind;
  const char *format;         ///< "STL (binary)", "OBJ", "Lua expression", ...; owned by the domain
  double lower[3], upper[3];  ///< box around the surface, without room
  double volume;              ///< of the solid; NAN when only sampling can tell
  double area;                ///< of the surface; NAN when unknown
  // Surfaces only, zero otherwise:
  size_t point_count;      ///< different points that faces use
  size_t triangle_count;   ///< faces in use
  size_t component_count;  ///< parts joined by edges
  bool topology_known;     ///< closed, manifold, without crossings: the solid's boundary has component_count pieces, and
  int64_t genus;           ///< this genus, summed over them; 0 where it is not known
  bool closed;             ///< every edge is used as often forwards as backwards
  bool turned;             ///< the input was inside out and was turned
  bool winding;            ///< inside is decided by the generalised winding number
  double winding_level;    ///< which it exceeds there (laves_surface_options.winding)
  laves_overlap overlap;   ///< laves_surface_options.overlap
  size_t open_edges_left;  ///< edges that stay open once cracks are mended, each for every use too many: holes are closed there
  size_t crossing_parts;   ///< closed parts that cross another
  size_t nested_parts;     ///< closed parts that lie within others
  size_t hollow_parts;     ///< of these: hollows
  size_t defects[LAVES_DEFECT_COUNT];
  double defect_place[LAVES_DEFECT_COUNT][3];  ///< a place where the first of each kind stands
  int tag_count;                               ///< named parts, of implicit solids too; see laves_domain_tag_name()
} laves_domain_info;

/// @param info  out: what was found when the domain was made; its texts belong to the domain
LAVES_API void laves_domain_get_info(const laves_domain *domain, laves_domain_info *info);
/// Name of a tag (STL solid, OBJ group, part of a script, ...), or NULL when index is not in [0, tag_count). Owned by the domain.
LAVES_API const char *laves_domain_tag_name(const laves_domain *domain, int index);

/// Where a defect is: a point, an edge or a face, in input coordinates.
typedef struct laves_defect_place {
  laves_defect kind;
  int corner_count;      ///< 1: a point, 2: an edge or segment, 3: a face
  double corners[3][3];  ///< [corner_count]
} laves_defect_place;

/// @param defects  out: without places; owned by the caller, free with laves_defects_free(); NULL on failure
LAVES_API laves_result laves_defects_create(laves_context *context, laves_defects **defects, laves_error *error);
LAVES_API void laves_defects_free(laves_defects *defects);
/// How many places there are, at least one for each defect that laves_domain_info counts: for a crossing the segment and its two
/// faces (one face only once, of however many crossings it is a part).
LAVES_API size_t laves_defects_count(const laves_defects *defects);
/// @param index  in [0, count)    @param place  out
LAVES_API void laves_defects_get(const laves_defects *defects, size_t index, laves_defect_place *place);
/// Writes them as points, lines and faces with a colour for each kind: .ply (text; vertex, edge and face elements), .obj (a group
/// for each kind; colours behind coordinates), or .vtp (VTK; cell arrays "defect", a laves_defect, and "color").
/// @return LAVES_OK, LAVES_ERROR_OPTION (the extension), LAVES_ERROR_WRITE, LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
LAVES_API laves_result laves_defects_write(laves_context *context, const laves_defects *defects, const char *path,
                                           laves_error *error);

typedef enum laves_thin_kind { LAVES_THIN_WALL, LAVES_THIN_GAP } laves_thin_kind;

/// One place where a solid is thin, or where two parts of its surface are close across a gap.
typedef struct laves_thin_place {
  double place[3];       ///< the middle of the chord
  double thickness;      ///< length of the chord: through the solid, against the surface normal; of a gap, along it
  laves_thin_kind kind;  ///< what the chord passes through
} laves_thin_place;

/// Finds the thinnest parts of a surface by chords shot inwards from the surface at a fixed set of samples.
/// @param places    out: laves_thin_place[capacity], thinnest first, places at least twice their thickness apart
/// @param capacity  how many places at most
/// @return how many were found. 0: none, or the domain is no surface, and places[0].thickness is INFINITY; or memory was short,
/// and
///         it is NAN. (With a capacity of 0 nothing is told.)
LAVES_API size_t laves_domain_thin_places(const laves_domain *domain, laves_thin_place *places, size_t capacity);
/// The same for the narrowest gaps, by chords shot outwards.
LAVES_API size_t laves_domain_gap_places(const laves_domain *domain, laves_thin_place *places, size_t capacity);

/* ---- sizing ----------------------------------------------------------------------------------------------------- */

/// Where elements shall be small: a list of sources, each of which asks for sizes (edge lengths, in the units of the input) in
/// some part of space. The least one counts everywhere, and what laves_options asks for besides; see laves_options.sizing
/// and docs/sizing.md. Belongs to a context; may be used for many domains, and by several threads once all is added.
typedef struct laves_sizing laves_sizing;

/// @param sizing  out: without sources; owned by the caller, free with laves_sizing_free(); NULL on failure
LAVES_API laves_result laves_sizing_create(laves_context *context, laves_sizing **sizing, laves_error *error);
LAVES_API void laves_sizing_free(laves_sizing *sizing);

/// Adds a size as a Lua expression such as "0.02 + 0.1*abs(x)", of x, y, z (coordinates of the input) and d, the depth below
/// the domain's surface: its distance inside, zero on it and outside. Functions are those of docs/implicit.md; the value of a
/// solid is field(solid). Outside the domain's box the size is that of the nearest place of the box. Values inside the
/// domain must be positive and finite: one that is not is an error when the mesh is made, with its place.
/// @return LAVES_OK, LAVES_ERROR_INPUT (it cannot be understood), LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
LAVES_API laves_result laves_sizing_add_expression(laves_sizing *sizing, const char *text, laves_error *error);

/// The same from a file with a Lua script that returns such an expression. Surfaces that it names are looked for beside it.
LAVES_API laves_result laves_sizing_add_script(laves_sizing *sizing, const char *path, laves_error *error);

/// Adds sizes from a background file (NRRD, VTU, Gmsh .msh or .pos): a mesh or image with values, which are sizes in the units of
/// the input and are interpolated; outside, the nearest place of the background counts (docs/sizing.md).
/// @param array_name  of the array or view with the sizes; NULL: the only one in the file, or else the one named "size"
LAVES_API laves_result laves_sizing_add_background(laves_sizing *sizing, const char *path, const char *array_name,
                                                   laves_error *error);

/// Adds points about which elements have a size: that within `radius`, growing beyond by laves_options.grading per unit of
/// distance, as for the next two.
/// @param points  double[count][3], finite; copied
/// @param size    positive    @param radius  0 or more
/// @return LAVES_OK, LAVES_ERROR_OPTION, LAVES_ERROR_MEMORY
LAVES_API laves_result laves_sizing_add_points(laves_sizing *sizing, const double *points, size_t count, double size,
                                               double radius, laves_error *error);

/// The same about a polyline: each point is joined to the next. Close it by repeating the first point.
LAVES_API laves_result laves_sizing_add_curve(laves_sizing *sizing, const double *points, size_t count, double size,
                                              double radius, laves_error *error);

/// The same about all points and polylines of a file, of the forms in docs/feature-files.md.
/// @return also LAVES_ERROR_INPUT, LAVES_ERROR_CANCELLED
LAVES_API laves_result laves_sizing_add_curve_file(laves_sizing *sizing, const char *path, double size, double radius,
                                                   laves_error *error);

/// The same about the triangles of the domain's surface that have a tag.
/// @param name  as of laves_domain_tag_name(); or a tag's number in decimal. That there is none such in a domain is an error
///              (LAVES_ERROR_INPUT) when the mesh is made.
LAVES_API laves_result laves_sizing_add_tag(laves_sizing *sizing, const char *name, double size, double radius,
                                            laves_error *error);

/* ---- features --------------------------------------------------------------------------------------------------- */

/// Points and lines of the surface that the mesh shall contain, beside the sharp edges that are found by themselves: each point
/// becomes a vertex at exactly that place, each line a chain of edges whose vertices lie on it. Belongs to a context; may be used
/// for many domains, and by several threads once all is added. See laves_options.features and docs/features.md.
typedef struct laves_features laves_features;

/// @param features  out: empty; owned by the caller, free with laves_features_free(); NULL on failure
LAVES_API laves_result laves_features_create(laves_context *context, laves_features **features, laves_error *error);
LAVES_API void laves_features_free(laves_features *features);

/// Adds points, in the units of the input, each of which becomes a vertex of the mesh at exactly that place.
/// @param points  double[count][3], finite; copied. That one is off the surface by more than 1e-3 of the diagonal of the domain's
///                box is an error (LAVES_ERROR_INPUT) when the mesh is made.
/// @return LAVES_OK, LAVES_ERROR_OPTION, LAVES_ERROR_MEMORY; so the next
LAVES_API laves_result laves_features_add_points(laves_features *features, const double *points, size_t count,
                                                 laves_error *error);

/// Adds a polyline: each point is joined to the next. Close it by repeating the first point. Its ends become vertices of the mesh
/// at exactly their place (projected to the surface where they are off it by rounding); between them the mesh has vertices on it.
/// @param points  double[count][3], finite, 2 or more; copied. As above where it is off the surface.
LAVES_API laves_result laves_features_add_line(laves_features *features, const double *points, size_t count, laves_error *error);

/// Adds the points and lines of a file: laves' own text, OBJ (p and l elements), Gmsh .msh 2.2 and 4.1 (point and line elements),
/// legacy VTK, VTU and VTP (vertices and lines). Elements of two points are joined to lines where two of them meet.
/// docs/feature-files.md tells the forms.
/// @return LAVES_OK, LAVES_ERROR_INPUT (with the line, byte or element; nothing of the file is added then), LAVES_ERROR_MEMORY,
///         LAVES_ERROR_CANCELLED
LAVES_API laves_result laves_features_add_file(laves_features *features, const char *path, laves_error *error);

/* ---- options ---------------------------------------------------------------------------------------------------- */

/// How the boundary is made. AUTO: by snapping (no tetrahedron is cut), and by stuffing (tetrahedra are warped and cut, with
/// proved angles) where snapping leaves the promised window. SNAP: by snapping alone, nothing is promised. STUFF: by stuffing
/// alone. docs/proof.md tells what is proved.
typedef enum laves_method { LAVES_METHOD_AUTO, LAVES_METHOD_SNAP, LAVES_METHOD_STUFF } laves_method;

typedef enum laves_align { LAVES_ALIGN_NONE, LAVES_ALIGN_PCA, LAVES_ALIGN_ROTATION } laves_align;

/// What becomes a region of the mesh. NONE: all is one. PARTS: each closed part of the input surface, connected by edges or
/// tagged as one, is the region of the tetrahedra whose centroid it contains, of several parts the one of least volume. Regions
/// meet along faces of tetrahedra, not along the parts' surfaces, where these lie inside the solid.
typedef enum laves_regions { LAVES_REGIONS_NONE, LAVES_REGIONS_PARTS } laves_regions;

/// What a mesh shall be. From laves_options_default(), then changed. At most one of size, relative_size, tet_target
/// and vertex_target may be given; none: a size that suits the domain, about 50 thousand tetrahedra.
typedef struct laves_options {
  double size;            ///< target edge length (mean edge of the tiling), units of the input; 0: not given
  double relative_size;   ///< the same as a fraction of the diagonal of the bounding box, (0, 0.5]; 0: not given
  int64_t tet_target;     ///< wished number of tetrahedra; met within 3 %; 0: not given
  int64_t vertex_target;  ///< wished number of vertices; met within 3 %; 0: not given
  laves_align align;      ///< how the lattice lies: along the axes, along the principal axes, or turned by `rotation`
  double rotation[9];     ///< row-major rotation matrix, lattice to input; used with LAVES_ALIGN_ROTATION
  laves_method method;    ///< how the boundary is made; default LAVES_METHOD_AUTO
  double guarantee;       ///< smallest dihedral angle that is promised whatever the solid's shape, degrees, [0, 28]; default
                          ///< 14.4. The nearest proved window at or above it holds: 14.4..149.65, 20..144, 22.5..140,
                          ///< 24..138, 28..135. Above 14.4 some boundary vertices may be moved off the surface. 0: none.
  bool improve;           ///< false: leave the boundary layer as it was made
  double min_dihedral;    ///< asked window for every dihedral angle, degrees; default 40, range 0..60
  double max_dihedral;    ///< default 125, range 80..180
  double volume_length;   ///< asked volume-length ratio sqrt(2) 6V / rms(edge)^3, 0..0.8; default 0.6
  // Sizes that vary (docs/sizing.md). `size` above, however it was given, is then the largest; the least of what the rest asks
  // for counts at each place, never less than min_size, and is limited in its slope. All zero and NULL: uniform.
  const laves_sizing *sizing;  ///< sources with a place of their own; NULL: none. Must outlive the call.
  double grading;              ///< how much the size may grow per unit of distance, 0.05..1; default 0.3
  double min_size;             ///< units of the input, at most size; 0: size / 64
  double curvature_elements;   ///< elements round a full circle of the surface's smaller radius of curvature, 0 or 3..1000
  double thickness_elements;   ///< elements across any wall or gap, 0 or 0.5..100
  double feature_elements;     ///< elements between creases that come close to one another (surfaces only), 0 or 0.5..100
  double max_distance;         ///< wished distance between boundary and surface where it is smooth, units of the input; 0: none
  double interior_growth;      ///< growth of the size per unit of depth below the surface, 0..1, beyond `size`, which is then
                               ///< the size at the surface; where it exceeds grading, grading holds. 0: none
  double max_size;             ///< where that growth ends, at least size; 0: 16 sizes. Without growth it has no effect.
  // Features that are kept (docs/features.md).
  double feature_angle;  ///< edges of the surface where its normal turns by more, degrees, [1, 179], are kept as chains of
                         ///< edges, and their ends as vertices; default 40; 0: none is looked for
  bool feature_tags;     ///< edges between parts of the surface with different tags as well; default false
  const laves_features *features;  ///< more points and lines; NULL: none. Must outlive the call.
  bool keep_thin;                  ///< walls and gaps down to half the size keep their topology, or are named; default true
  // What the mesh tells of its parts (docs/formats.md).
  bool face_sources;      ///< boundary faces know the nearest face of the input: laves_mesh_face_sources(); default false
  laves_regions regions;  ///< what tetrahedra are told apart by; default LAVES_REGIONS_NONE
  // Meshes larger than memory (docs/streaming.md).
  bool streamed;    ///< the mesh does not hold its points and tetrahedra, but makes them when they are read:
                    ///< laves_mesh_read_points(), laves_mesh_read_tets(), laves_mesh_write(). Memory then grows with the surface.
                    ///< Not with sizes that vary, nor with regions; default false
  uint32_t cookie;  ///< set by laves_options_default(), checked by laves_generate()
} laves_options;

LAVES_API laves_options laves_options_default(void);

/* ---- generate --------------------------------------------------------------------------------------------------- */

typedef struct laves_mesh laves_mesh;

enum { LAVES_STAGE_CAPACITY = 16, LAVES_WARNING_CAPACITY = 16, LAVES_LOST_CAPACITY = 16 };

/// What was done: filled by laves_generate().
typedef struct laves_report {
  double size;    ///< the size used
  double volume;  ///< of the domain: exact for closed surfaces, else by sampling
  int stage_count;
  struct {
    const char *name;  ///< "background", "classify", "snap", "improve", ...; static
    double wall_seconds;
    double cpu_seconds;  ///< of the whole process during the stage
  } stages[LAVES_STAGE_CAPACITY];
  size_t peak_bytes;             ///< most memory that the context held at once
  size_t lattice_tets;           ///< tetrahedra that are exact tiles
  size_t snapped_vertices;       ///< lattice vertices that were moved on to the surface
  size_t pinches;                ///< places where the sampled solid touched itself and was parted or trimmed
  size_t off_surface;            ///< boundary vertices that had to stay off the surface to keep tetrahedra positive
  size_t outside_window;         ///< tetrahedra outside the asked window
  double promised_min_dihedral;  ///< the window that is promised for every dihedral angle, degrees; 0 and 180: none
  double promised_max_dihedral;
  size_t stuffed_vertices;  ///< boundary vertices of the places that were made by stuffing, before improvement
  size_t relaxed_vertices;  ///< those of them that a guarantee above 14.4 degrees moved off the surface
  double relaxed_max;       ///< the furthest such move, units of the input
  size_t forced_tets;       ///< tets outside the promised window because a crease of the solid is sharper than it is
  // Features that were to be kept (docs/features.md); all zero where there are none.
  double feature_size;       ///< the smallest size at the boundary: shorter creases are roughness
  size_t creases, corners;   ///< of the solid, at this size
  size_t corners_kept;       ///< that are vertices of the mesh at exactly their place
  double crease_length;      ///< of all creases, units of the input
  double crease_kept;        ///< of the boundary edges that lie along them; chords of curved creases are a little shorter
  size_t features_released;  ///< vertices that were let go of where features come closer to one another than the size
  size_t creases_dropped;    ///< that were too short for the size, or roughness of the surface
  size_t creases_joined;     ///< gaps between creases that were closed
  // What became of thin parts. Places: where walls were trimmed and parts set apart; where topology differs, also those where
  // mesh and surface are far apart and the solid is thin or has a gap. At most so many, not two within a size.
  bool topology_known;                         ///< that of the domain's boundary is (laves_domain_info)
  size_t domain_pieces, pieces;                ///< of the boundary: of the domain (0: unknown), of the mesh
  int64_t domain_genus, genus;                 ///< of the boundary, summed over pieces
  size_t lost_count;                           ///< of those listed
  laves_thin_place lost[LAVES_LOST_CAPACITY];  ///< `thickness` is INFINITY where neither a wall nor a gap near by is the cause
  int warning_count;
  char warnings[LAVES_WARNING_CAPACITY][240];
} laves_report;

/// Builds the tetrahedral mesh of a domain from the C15 tiling.
/// @param domain   read only; may be evaluated from many threads at once
/// @param options  copied
/// @param mesh     out: owned by the caller, free with laves_mesh_free(); NULL on failure
/// @param report   out, optional
/// @param error    out, optional
/// @return LAVES_OK; LAVES_TARGET_MISSED when the mesh is valid but a wished target was not reached (see report);
///         LAVES_ERROR_OPTION, LAVES_ERROR_INPUT (nothing inside at this size), LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
/// Cost: about O(volume / size^3) time and memory for the interior, O(area / size^2) oracle calls.
/// Where the context has a memory limit, a mesh that is expected not to fit is refused before it is begun (LAVES_ERROR_MEMORY),
/// with a size that fits in the sentence; one that needs more than was expected ends when it reaches the limit. The result is the
/// same for any number of threads.
LAVES_API laves_result laves_generate(laves_context *context, const laves_domain *domain, const laves_options *options,
                                      laves_mesh **mesh, laves_report *report, laves_error *error);

/// What a mesh is likely to hold, before it is made.
typedef struct laves_expectation {
  double size;        ///< as laves_report.size
  double tets;        ///< within some per cent where sizes are well below the solid's own
  double vertices;    ///< the same; up to a quarter too few where most of the mesh is near the surface
  double peak_bytes;  ///< most memory that laves_generate() will make the context hold, with what it holds now; within a quarter
  double certify_bytes;  ///< the same of laves_certify() and laves_mesh_write(), rough: up to twice as much where implicit solids
                         ///< have creases, three times where their walls are a few sizes thin
  size_t creases;        ///< of a surface, that are to be kept, about as laves_report.creases; 0 for other solids, whose creases
                         ///< take long to find
} laves_expectation;

/// Estimates the counts and the memory of a mesh, with all that makes sizes vary. What is over the context's memory limit is told
/// like anything else here; laves_generate() refuses it.
/// @param options      as for laves_generate(); with tet_target or vertex_target, all sizes are scaled until they are met
/// @param expectation  out
/// @return LAVES_OK, LAVES_ERROR_OPTION, LAVES_ERROR_INPUT, LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
/// Cost: that of finding the sizes; a small part of making the mesh.
LAVES_API laves_result laves_estimate(laves_context *context, const laves_domain *domain, const laves_options *options,
                                      laves_expectation *expectation, laves_error *error);

/// The plain tiling of a box: all tiles whose cell lies within `cells` periods along each axis, cell side 2.5118 * size.
LAVES_API laves_result laves_generate_tiling(laves_context *context, const int cells[3], double size, laves_mesh **mesh,
                                             laves_error *error);

/* ---- mesh ------------------------------------------------------------------------------------------------------- */

/// A tetrahedral mesh; the arrays belong to it and stay where they are until it is freed.
LAVES_API void laves_mesh_free(laves_mesh *mesh);

/// Builds a mesh from arrays, which are copied; boundary faces are found. Tetrahedra may be of either orientation here:
/// laves_check_mesh() tells.
/// @param points  double[vertex_count][3]   @param tets  int32_t[tet_count][4]
/// @param regions int32_t[tet_count] or NULL
LAVES_API laves_result laves_mesh_from_arrays(laves_context *context, const double *points, size_t vertex_count,
                                              const int32_t *tets, size_t tet_count, const int32_t *regions, laves_mesh **mesh,
                                              laves_error *error);

LAVES_API size_t laves_mesh_vertex_count(const laves_mesh *mesh);
LAVES_API size_t laves_mesh_tet_count(const laves_mesh *mesh);
LAVES_API size_t laves_mesh_face_count(const laves_mesh *mesh);         ///< boundary triangles
LAVES_API const double *laves_mesh_points(const laves_mesh *mesh);      ///< double[vertex_count][3]; NULL: streamed
LAVES_API const int32_t *laves_mesh_tets(const laves_mesh *mesh);       ///< int32_t[tet_count][4]; NULL: streamed
LAVES_API const int32_t *laves_mesh_faces(const laves_mesh *mesh);      ///< int32_t[face_count][3], outwards
LAVES_API const int32_t *laves_mesh_regions(const laves_mesh *mesh);    ///< int32_t[tet_count], or NULL: all 1
LAVES_API const int32_t *laves_mesh_face_tags(const laves_mesh *mesh);  ///< int32_t[face_count], or NULL: all 1
/// Copies points [first, first + count) of a mesh, and of a streamed one makes them; the same bytes whoever asks, in whatever
/// order.
/// @param points  out: double[count][3]
/// @return LAVES_OK; LAVES_ERROR_OPTION when the range goes beyond the mesh
/// Thread safety: may be called from many threads at once. Cost: that of a copy; of a streamed mesh about 2 ns for each point.
LAVES_API laves_result laves_mesh_read_points(const laves_mesh *mesh, size_t first, size_t count, double *points,
                                              laves_error *error);
/// The same for tetrahedra: int32_t[count][4]. Ranges of some ten thousand cost least.
LAVES_API laves_result laves_mesh_read_tets(const laves_mesh *mesh, size_t first, size_t count, int32_t *tets,
                                            laves_error *error);
/// Whether the mesh makes its points and tetrahedra when they are read (laves_options.streamed). What needs them all at once,
/// such as laves_check_mesh(), refuses it with LAVES_ERROR_OPTION.
LAVES_API bool laves_mesh_is_streamed(const laves_mesh *mesh);
/// For every boundary triangle the nearest face of the input surface, at the triangle's centroid: faces are counted from 0 as the
/// input gave them, polygons once; -1: none is near (the triangle closes a hole). int32_t[face_count]; NULL: not asked for
/// (laves_options.face_sources), or the domain is no surface of triangles. The order in which formats count is in
/// docs/formats.md.
LAVES_API const int32_t *laves_mesh_face_sources(const laves_mesh *mesh);
/// Tets [0, lattice_tet_count) are exact tiles of the tiling; the rest is the boundary layer.
LAVES_API size_t laves_mesh_lattice_tet_count(const laves_mesh *mesh);
/// Named groups of regions (dimension 3) and face tags (dimension 2); NULL when the tag has no name.
LAVES_API const char *laves_mesh_group_name(const laves_mesh *mesh, int dimension, int32_t tag);
/// A 128-bit hash of points, tets, faces, regions and tags, as 32 hexadecimal digits and NUL.
LAVES_API void laves_mesh_hash(const laves_mesh *mesh, char hash[33]);

/* ---- second order ------------------------------------------------------------------------------------------------- */

/// How a mesh gets nodes of second order. From laves_curve_options_default(), then changed.
typedef struct laves_curve_options {
  double min_jacobian;  ///< least share of the straight tetrahedron's Jacobian determinant that any point of a curved one may
                        ///< keep, 0.01..0.9; default 0.2
  bool distances;       ///< measure the boundary against the domain, before and after; default true
  // The creases on which nodes of edges along them shall stand.
  double feature_angle;            ///< as laves_options.feature_angle; default 40; 0: none are looked for
  bool feature_tags;               ///< as laves_options.feature_tags; default false
  const laves_features *features;  ///< more points and lines; NULL: none
  double feature_size;             ///< as laves_feature_options.size; default 0: the mean edge of the mesh's boundary
  uint32_t cookie;                 ///< set by laves_curve_options_default(), checked by laves_mesh_curve()
} laves_curve_options;

LAVES_API laves_curve_options laves_curve_options_default(void);

/// What was done: filled by laves_mesh_curve().
typedef struct laves_curve_report {
  size_t nodes;           ///< of the mesh: its vertices, and one on each edge
  size_t edges;           ///< nodes on edges
  size_t boundary_edges;  ///< of these: on edges of the boundary
  size_t on_surface;      ///< of the boundary's: on the surface, or a crease,
  size_t moved_back;      ///< part of the way from the middle of the edge to it, for the sake of the Jacobian,
  size_t straightened;    ///< at the middle of the edge for its sake,
  size_t unreached;       ///< at the middle since no surface, or no crease, is within half of the edge's length. Sum: the above
  size_t on_crease;       ///< of those on the surface: on a crease
  double least_jacobian;  ///< least share of the straight tetrahedron's Jacobian determinant, over all tetrahedra: a lower bound,
                          ///< never above 1
  int64_t least_tet;      ///< the first tetrahedron with it; -1: none is curved
  // Distance from samples of the boundary to the domain's surface, units of the mesh, with straight and with curved faces.
  bool has_distance;
  double straight_max, straight_mean;
  double curved_max, curved_mean;
} laves_curve_report;

/// Makes a mesh one of second order: each edge gets a node, each tetrahedron has ten, each boundary face six. Nodes of inner
/// edges stand at the middle of the edge, those of the boundary on the surface of the domain, or on the crease that the edge lies
/// along, while the Jacobian of all tetrahedra around stays positive everywhere (a sufficient test); where it would not, nodes go
/// back towards the middle of their edge, half of the way at a time. Vertices, tetrahedra and faces stay as they are, and all
/// functions that check, certify or hash a mesh speak of these; laves_mesh_write() writes the nodes. On failure the mesh is as it
/// was.
/// @param mesh     of `context`, in memory; a mesh of second order is done anew. Pointers to nodes are no longer valid.
/// @param domain   NULL: all nodes stand at the middle of their edge
/// @param options  copied; NULL: the defaults
/// @param report   out, optional
/// @param error    out, optional
/// @return LAVES_OK; LAVES_ERROR_OPTION (also: the mesh is streamed, or has more nodes than 2147483647), LAVES_ERROR_INPUT
/// (corners
///         out of range, or a drawn line is off the surface), LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
/// Cost: about 0.3 microseconds a tetrahedron, a search for each edge of the boundary, and, with distances, eight for each of its
/// faces; memory about 75 bytes a tetrahedron, and 40 more meanwhile. The result is the same for any number of threads.
LAVES_API laves_result laves_mesh_curve(laves_context *context, laves_mesh *mesh, const laves_domain *domain,
                                        const laves_curve_options *options, laves_curve_report *report, laves_error *error);

/// 1, or 2 after laves_mesh_curve().
LAVES_API int laves_mesh_order(const laves_mesh *mesh);
/// Vertices, and behind them the nodes on edges, by the lower and then the higher vertex of their edge. Of a mesh of first order
/// the next four are what the mesh has without nodes.
LAVES_API size_t laves_mesh_node_count(const laves_mesh *mesh);
LAVES_API const double *laves_mesh_node_points(const laves_mesh *mesh);  ///< double[node_count][3]
/// int32_t[tet_count][10]: four corners, then the nodes on edges 01, 12, 02, 03, 13, 23, as VTK has them.
LAVES_API const int32_t *laves_mesh_tet_nodes(const laves_mesh *mesh);
/// int32_t[face_count][6]: three corners, then the nodes on edges 01, 12, 02.
LAVES_API const int32_t *laves_mesh_face_nodes(const laves_mesh *mesh);

/* ---- check ------------------------------------------------------------------------------------------------------ */

enum { LAVES_HISTOGRAM_BINS = 36, LAVES_PLACE_CAPACITY = 16 };

/// Minimum, maximum, mean and standard deviation over all tetrahedra.
typedef struct laves_statistic {
  double min, max, mean, deviation;
} laves_statistic;

/// What laves_check_mesh() finds, from the arrays alone.
typedef struct laves_check {
  size_t vertices, tets, faces;
  // Validity; a mesh is valid when `valid` is set, that is when all of these are zero.
  bool valid;
  size_t bad_indices;           ///< corners that are out of range or repeated within a tetrahedron
  size_t inverted_tets;         ///< det <= 0 by an exact test
  size_t nonconforming_faces;   ///< faces with more than two tetrahedra, or two on the same side
  size_t nonmanifold_edges;     ///< boundary edges without exactly two boundary faces
  size_t nonmanifold_vertices;  ///< boundary vertices whose boundary faces form more than one fan
  size_t unused_vertices;       ///< vertices in no tetrahedron (allowed, but told)
  // Topology of the boundary.
  size_t components;  ///< of the solid, joined through faces
  size_t boundary_components;
  int64_t genus;  ///< summed over boundary components; meaningful when manifold
  // Quality.
  double volume, area;
  double edge_min, edge_max, edge_mean;
  laves_statistic min_dihedral, max_dihedral;  ///< over tets, degrees: smallest and largest angle of each
  laves_statistic radius_ratio;                ///< 3 r / R, 1 for the regular tetrahedron
  laves_statistic radius_edge;                 ///< R / shortest edge, over the regular one's: 1 and up
  laves_statistic volume_length;               ///< sqrt(2) 6V / rms(edge)^3
  size_t histogram[LAVES_HISTOGRAM_BINS];      ///< of all dihedral angles, bins of 5 degrees from 0 to 180
  double min_dihedral_place[3], max_dihedral_place[3], radius_ratio_place[3];  ///< centroids of the worst tets
  double radius_edge_place[3], volume_length_place[3];
  int64_t min_dihedral_tet, max_dihedral_tet, radius_ratio_tet;  ///< their indices; -1 when no tet can be measured
  int64_t radius_edge_tet, volume_length_tet;
  // Distance to a domain, in the units of the mesh; set when has_distance.
  bool has_distance;
  double to_surface_max, to_surface_mean;      ///< from samples of the boundary to the surface
  double from_surface_max, from_surface_mean;  ///< from samples of the surface to the boundary
  double to_surface_place[3], from_surface_place[3];
  double to_surface_cover, from_surface_cover;      ///< how far a point of the sampled side can be from a sample; NAN: unknown
  double to_surface_at_most, from_surface_at_most;  ///< no point of that side is further than this; NAN: unknown
  double domain_volume;                             ///< NAN when unknown
} laves_check;

/// Checks a mesh by code that shares nothing with the stages that make meshes.
/// @param domain  the solid to measure distances against; NULL: none
/// @return LAVES_OK when the check ran (see check->valid), LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
/// Cost: linear in the tets, about 0.2 microseconds each; distances about one closest-point query per sample.
LAVES_API laves_result laves_check_mesh(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                        laves_check *check, laves_error *error);

/// A place where a tetrahedron is outside a window, or where mesh and surface are further apart than asked.
typedef struct laves_place {
  double place[3];
  double value;             ///< the worst angle in degrees (or the volume-length ratio, below 1); or the distance
  int64_t tet;              ///< index of the tet; -1 for distances
  double curvature_radius;  ///< smallest radius of curvature of the domain's surface near by, as seen at the scale of the
                            ///< mesh's edges there; INFINITY where flat; NAN without a domain
} laves_place;

/// Finds the tetrahedra whose dihedral angles leave [min_dihedral, max_dihedral] or whose volume-length ratio is below
/// volume_length, worst first.
/// @param domain    for the curvature; NULL: none
/// @param places    out: laves_place[capacity]    @param count  out: how many there are in all, may exceed capacity
LAVES_API laves_result laves_check_window(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                          double min_dihedral, double max_dihedral, double volume_length, laves_place *places,
                                          size_t capacity, size_t *count, laves_error *error);

/// Finds samples of mesh boundary and surface that are further than `distance` from the other, furthest first, one for
/// each neighbourhood of radius 2 * `distance`.
LAVES_API laves_result laves_check_distance(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                            double distance, laves_place *places, size_t capacity, size_t *count,
                                            laves_error *error);

/// How to check a mesh that stays in its file. From laves_file_check_options_default(), then changed.
typedef struct laves_file_check_options {
  const laves_domain *domain;  ///< to measure distances against, from the boundary, which is held in memory; NULL: none
  double min_dihedral, max_dihedral, volume_length;  ///< the window of laves_file_check.outside_window; default as laves_options
  laves_place *places;    ///< out: the worst tets outside that window, as laves_check_window() tells them; NULL: none
  size_t place_capacity;  ///< of `places`; default 0
  size_t cache_bytes;     ///< for points, of which those last used are held; default 256 MiB, at least 192 KiB; no more is taken
                          ///< than a quarter of what the context's limit leaves, and than the points need
  uint32_t cookie;        ///< set by laves_file_check_options_default(), checked by laves_check_file()
} laves_file_check_options;

LAVES_API laves_file_check_options laves_file_check_options_default(void);

/// What laves_check_file() finds.
typedef struct laves_file_check {
  laves_check check;  ///< as of laves_check_mesh() on the mesh as laves_mesh_read() makes it, to the last digit; but edge_mean
                      ///< is NAN, since edges are not told apart
  size_t outside_window;  ///< tets that leave the window; the first `place_capacity` of them are in `places`, worst first
  // Triangles that the file holds beside its tets, compared with the boundary; all 0 where it holds none. They don't decide
  // `check.valid`: some programs' files have triangles between regions as well.
  size_t file_faces;            ///< triangles of the file
  size_t file_faces_elsewhere;  ///< of these: not on the boundary, or there a second time
  size_t file_faces_turned;     ///< of these: on the boundary, but they face inwards
  size_t file_faces_missing;    ///< faces of the boundary that are no triangle of the file
} laves_file_check;

/// Checks a mesh that may be larger than memory, by ranges of its file, which must be a VTU with appended raw data in one piece,
/// plain or compressed by zlib, as laves_mesh_write() makes it. The tets are read once, in their order; a face is held until its
/// second tet has come and a vertex of it has no other face that waits, so tets should stand near their neighbours.
/// @param path     file name; it may not be a pipe
/// @param options  copied; NULL: the defaults
/// @param check    out
/// @return LAVES_OK when the check ran (see check->check.valid), LAVES_ERROR_OPTION, LAVES_ERROR_INPUT (what laves_mesh_read()
///         refuses, such as corners out of range, or a file that can't be read by ranges), LAVES_ERROR_MEMORY,
///         LAVES_ERROR_CANCELLED
/// Cost: about 0.7 microseconds a tet, of which a tenth is not shared by the threads; once more where every tet is negative, and
/// once or twice more where tets meet at a vertex inside the mesh without sharing faces around it. Memory: cache_bytes;
/// 3 bits a vertex; 4 MB for tets in work, 2 MB for each thread beyond two; 50 to 100 bytes a face of the front, that is of the
/// surface between tets already read and those still to come, and of the boundary; and at the end 150 bytes a face of
/// the boundary alone. Same result for any number of threads, and any cache.
LAVES_API laves_result laves_check_file(laves_context *context, const char *path, const laves_file_check_options *options,
                                        laves_file_check *check, laves_error *error);

/// What can be out of order about features, and what the input's own angles force: X(name, key in JSON, phrase).
#define LAVES_FEATURE_FAULT_LIST(X)                                                \
  X(CREASE, "crease", "creases that are not kept")                                 \
  X(CORNER, "corner", "corners that are no vertex of the mesh")                    \
  X(SPURIOUS, "spurious", "sharp edges of the mesh where the solid has no crease") \
  X(STRADDLING, "straddling", "boundary faces that lie across a crease")           \
  X(SHARP, "sharp", "creases of the solid that are sharper than 80 degrees")

typedef enum laves_feature_fault {
#define LAVES_FEATURE_FAULT_ENUM(name, key, text) LAVES_FEATURE_FAULT_##name,
  LAVES_FEATURE_FAULT_LIST(LAVES_FEATURE_FAULT_ENUM)
#undef LAVES_FEATURE_FAULT_ENUM
      LAVES_FEATURE_FAULT_COUNT
} laves_feature_fault;

/// "crease" and the like, and the phrase; never NULL.
LAVES_API const char *laves_feature_fault_key(laves_feature_fault fault);
LAVES_API const char *laves_feature_fault_text(laves_feature_fault fault);

/// A place that laves_check_features() tells of. What does not apply is NAN, or -1.
typedef struct laves_feature_place {
  laves_feature_fault fault;
  double place[3];
  double distance;  ///< CREASE, CORNER: to the nearest boundary edge of the mesh; SPURIOUS: to the nearest crease
  double length;    ///< CREASE, SHARP: of the crease
  double angle;  ///< CREASE, SHARP: the least along the crease, inside the solid, degrees; SPURIOUS: by which the mesh's normal
                 ///< turns
  double dihedral;  ///< SHARP: the least dihedral angle of the tetrahedra at edges that lie on the crease, degrees
  int64_t index;  ///< SPURIOUS: of one vertex of the edge; STRADDLING: of one vertex of the face; SHARP: of the tetrahedron that
                  ///< has that dihedral angle
} laves_feature_place;

/// Which features are looked for, and how closely they must be met. From laves_feature_options_default(), then changed.
typedef struct laves_feature_options {
  double angle;                    ///< as laves_options.feature_angle; default 40; 0: none is looked for
  bool tags;                       ///< as laves_options.feature_tags
  const laves_features *features;  ///< more points and lines; NULL: none
  double size;                     ///< creases that are shorter are noise of the surface; 0: the mean edge of the mesh's boundary
  double tolerance;                ///< distance up to which a crease counts as kept; 0: 1e-3 of the diagonal of the domain's box
  uint32_t cookie;
} laves_feature_options;

LAVES_API laves_feature_options laves_feature_options_default(void);

/// How well a mesh keeps the creases and corners of a domain: filled by laves_check_features(). Lengths in the units of the mesh.
/// A crease is short when it is shorter than the boundary edges near by; short ones are counted apart and in nothing else, and so
/// are corners at which only short ones end. Tips and what was drawn are never short.
typedef struct laves_feature_check {
  double angle, size, tolerance;  ///< as asked, with what 0 stands for
  double diagonal;                ///< of the domain's box
  double edge_mean;               ///< mean edge of the mesh's boundary
  // The solid's creases, as the mesh has them.
  size_t creases, short_creases;  ///< all; those of them that are short
  double length, short_length;    ///< of all; of those that are short
  size_t creases_kept;  ///< not short, and wherever they were sampled within the tolerance of edges that run along creases
  double kept_share;    ///< of the length of those not short, so kept; 1 where there are none
  double to_mesh_max, to_mesh_mean;  ///< from samples of them to the nearest boundary edge; 0 where there are none
  double to_mesh_place[3];
  size_t corners, short_corners;  ///< all; those at which only short creases end, which are in none of what follows
  size_t corners_kept;            ///< a vertex of the mesh stands at exactly that place (1e-9 of the diagonal)
  size_t corners_near;            ///< not that, but an edge passes within 1e-4 of the diagonal; all others are lost
  // The mesh's creases: boundary edges at which its normal turns by more than `angle`.
  size_t mesh_creases;   ///< how many
  size_t mesh_bent;      ///< those of them that are the doing of a bend: below the two faces the solid's own normal turns by more
                         ///< than half of that, on one patch; they are in none of what follows
  double from_mesh_max;  ///< largest distance of an end or middle of one from the solid's nearest crease; INFINITY: it has none
  double from_mesh_place[3];
  size_t spurious;    ///< further away than the tolerance
  size_t straddling;  ///< boundary faces below which lie different patches, further from creases than the tolerance
  // Angles.
  size_t sharp;                                 ///< creases less than 80 degrees wide inside
  double sharpest;                              ///< least angle of all creases, degrees; NAN: there is none
  double away_min_dihedral, away_max_dihedral;  ///< over tetrahedra without a vertex on a crease or corner; NAN: there is none
  double free_min_dihedral, free_max_dihedral;  ///< over those without a vertex on a crease sharper than 70 degrees
} laves_feature_check;

/// Measures features by code that shares nothing with the stages that make meshes but the finding of the domain's creases. Works
/// for meshes of any program.
/// @param options  NULL: the defaults
/// @param places   out: laves_feature_place[LAVES_FEATURE_FAULT_COUNT * capacity]: by fault, the worst first; may be NULL with
///                 capacity 0
/// @param capacity  how many at most of each fault
/// @param count    out: how many places were filled
/// @return LAVES_OK when the check ran, LAVES_ERROR_OPTION, LAVES_ERROR_INPUT (a drawn point or line is off the surface, or the
/// mesh
///         has no boundary), LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
/// Cost: finding the domain's creases, a search for each eighth of an edge along them, and a pass over the boundary.
LAVES_API laves_result laves_check_features(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                            const laves_feature_options *options, laves_feature_check *check,
                                            laves_feature_place *places, size_t capacity, size_t *count, laves_error *error);

/* ---- improve ---------------------------------------------------------------------------------------------------- */

/// How a mesh of any program is improved. From laves_improve_options_default(), then changed.
typedef struct laves_improve_options {
  double min_dihedral;   ///< asked window for every dihedral angle, degrees; default 30, range 0..60
  double max_dihedral;   ///< default 140, range 80..180. Tetrahedra inside the window are only changed for the sake of others.
  double volume_length;  ///< asked volume-length ratio sqrt(2) 6V / rms(edge)^3 as well, 0..0.8; default 0: not asked
  double tolerance;      ///< how far the boundary, and borders between regions, may come to be from where they were, units of the
                         ///< mesh; default 0: vertices move in flat parts and along straight edges only, so the shape is the
                         ///< same but for rounding (1e-10 of the diagonal). Borders of flat parts stay in any case.
  bool fixed_boundary;   ///< true: vertices and triangles of the boundary stay as they are; default false
  size_t passes;    ///< most passes over the bad tetrahedra; the same number yields the same mesh; 0, the default: as many as
                    ///< help, about 25
  double seconds;   ///< when to stop and return what there is, wall seconds from the call; the one option with which the result
                    ///< depends on the machine; 0, the default: never
  uint32_t cookie;  ///< set by laves_improve_options_default(), checked by laves_improve()
} laves_improve_options;

LAVES_API laves_improve_options laves_improve_options_default(void);

/// What was done: filled by laves_improve().
typedef struct laves_improve_report {
  laves_check before, after;  ///< as laves_check_mesh() finds the two meshes
  size_t outside_before,
      outside_after;      ///< tetrahedra outside the asked window. Angles at edges between two flat parts of the
                          ///< boundary that one tetrahedron fills alone count, too, though nothing can change them.
  size_t patches;         ///< flat parts of the boundary and of borders between regions; of a curved surface
                          ///< every triangle is one
  size_t fixed_vertices;  ///< vertices of the boundary and the borders that could not move,
  size_t crease_vertices, flat_vertices;  ///< that could along a straight edge, and in a flat part
  double sharpest;   ///< least angle inside the mesh between two flat parts of its boundary that meet, degrees: no mesh with this
                     ///< boundary has a larger smallest angle; 180: there are none
  bool out_of_time;  ///< it ended because of laves_improve_options.seconds
  bool kept_as_it_was;               ///< the result was no better and was given up: the mesh returned is a copy
  double wall_seconds, cpu_seconds;  ///< of the call, with both checks
  size_t peak_bytes;                 ///< most memory that the context held at once
} laves_improve_report;

/// Improves a tetrahedral mesh of any program: moves vertices, removes and splits edges, flips faces and contracts edges until
/// all dihedral angles are inside a window, or nothing helps. Regions, the tags of boundary triangles and their names are kept:
/// borders between regions and between tags are kept as the boundary is. The worst dihedral angles, smallest and largest, are
/// never worse than before. Vertices that do not move keep their coordinates to the last bit; vertices that no tetrahedron uses
/// are dropped.
/// @param mesh      valid but for its boundary, which may touch itself (laves_check.inverted_tets, bad_indices and
///                  nonconforming_faces are 0); read only; of `context`; not streamed
/// @param options   copied; NULL: the defaults
/// @param improved  out: owned by the caller, free with laves_mesh_free(); NULL on failure
/// @param report    out, optional
/// @param error     out, optional
/// @return LAVES_OK; LAVES_TARGET_MISSED when the mesh is valid but tetrahedra are outside the window (see report);
///         LAVES_ERROR_OPTION, LAVES_ERROR_INPUT (the mesh is not valid), LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
/// Cost: some 20 to 500 microseconds of one processor for each tetrahedron outside the window at the start; memory about 300
/// bytes a tetrahedron. The result is the same for any number of threads, but with options->seconds.
LAVES_API laves_result laves_improve(laves_context *context, const laves_mesh *mesh, const laves_improve_options *options,
                                     laves_mesh **improved, laves_improve_report *report, laves_error *error);

/* ---- certificate -------------------------------------------------------------------------------------------------- */

enum { LAVES_HASH_CAPACITY = 65, LAVES_NAME_CAPACITY = 256, LAVES_EXCEPTION_CAPACITY = 192 };
enum { LAVES_COMMAND_CAPACITY = 8192, LAVES_COMMAND_WORDS = 500 };

/// What can be out of order: X(name, key in JSON, phrase). The value of an exception is the angle in degrees (or the
/// volume-length ratio, below 1), the distance, or the thickness that its kind speaks of, else NAN.
#define LAVES_EXCEPTION_LIST(X)                                                       \
  X(INVERTED_TET, "inverted_tet", "tetrahedra that are flat or turned over")          \
  X(NONMANIFOLD_EDGE, "nonmanifold_edge", "boundary edges without exactly two faces") \
  X(NONMANIFOLD_VERTEX, "nonmanifold_vertex", "boundary vertices with several fans")  \
  X(OUTSIDE_PROMISED, "outside_promised", "tetrahedra outside the promised window")   \
  X(OUTSIDE_ASKED, "outside_asked", "tetrahedra outside the asked window")            \
  X(DISTANT, "distant", "places where mesh and surface are over 0.3 edges apart")     \
  X(OFF_SURFACE, "off_surface", "boundary vertices off the surface")                  \
  X(THIN, "thin", "places where the solid is thinner than the size")                  \
  X(CREASE_LOST, "crease_lost", "creases that are not kept")                          \
  X(CORNER_LOST, "corner_lost", "corners that are no vertex")                         \
  X(SHARP_INPUT, "sharp_input", "creases sharper than the window")

typedef enum laves_exception_kind {
#define LAVES_EXCEPTION_ENUM(name, key, text) LAVES_EXCEPTION_##name,
  LAVES_EXCEPTION_LIST(LAVES_EXCEPTION_ENUM)
#undef LAVES_EXCEPTION_ENUM
      LAVES_EXCEPTION_COUNT
} laves_exception_kind;

/// Why, as far as the domain's surface near by tells: X(name, key in JSON, phrase).
#define LAVES_CAUSE_LIST(X)                                             \
  X(UNKNOWN, "unknown", "no cause is known")                            \
  X(THIN, "thin", "the solid is thinner than the size near by")         \
  X(CREASE, "crease", "the surface has a sharp edge or corner near by") \
  X(CURVED, "curved", "the surface bends with a radius below two sizes")

typedef enum laves_cause {
#define LAVES_CAUSE_ENUM(name, key, text) LAVES_CAUSE_##name,
  LAVES_CAUSE_LIST(LAVES_CAUSE_ENUM)
#undef LAVES_CAUSE_ENUM
      LAVES_CAUSE_COUNT
} laves_cause;

/// "outside_promised" and the like, and the phrase; never NULL.
LAVES_API const char *laves_exception_key(laves_exception_kind kind);
LAVES_API const char *laves_exception_text(laves_exception_kind kind);
LAVES_API const char *laves_cause_key(laves_cause cause);
LAVES_API const char *laves_cause_text(laves_cause cause);

typedef struct laves_exception {
  laves_exception_kind kind;
  laves_cause cause;
  double place[3];
  double value;             ///< as told at LAVES_EXCEPTION_LIST
  double limit;             ///< that it passes; NAN: none
  int64_t index;            ///< of the tetrahedron or vertex; -1: neither
  double curvature_radius;  ///< of the surface near by, as in laves_place; NAN: not known
  double crease_angle;  ///< least angle inside the solid, degrees, of the creases on which an edge of that tetrahedron lies, or
                        ///< of the crease that is meant; NAN: none, or features were not looked for
} laves_exception;

/// What a mesh is, recomputed from its arrays: filled by laves_certify(), or read from a file.
typedef struct laves_certificate {
  char version[32];                     ///< of the library that made the statement
  char mesh_hash[LAVES_HASH_CAPACITY];  ///< SHA-256 of points and tets, as docs/certificate.md tells; 64 digits
  laves_check check;                    ///< counts, validity, topology, quality, distances

  bool has_input;                        ///< the next four are known
  char input_name[LAVES_NAME_CAPACITY];  ///< base name of the file; or the expression, cut where it is long
  char input_kind[16];                   ///< "surface", "implicit" or "function"
  char input_format[48];                 ///< as in laves_domain_info
  char input_hash[LAVES_HASH_CAPACITY];  ///< SHA-256 of the file's bytes, or of the expression's text; empty: not known

  int command_count;                     ///< words of the command that makes the mesh again; 0: not known
  char command[LAVES_COMMAND_CAPACITY];  ///< these words, UTF-8, each ended by a NUL

  bool has_options;  ///< the mesh was made by laves with these options, and the report's figures below are known
  laves_options options;
  double size;                                         ///< that was used
  size_t stuffed_vertices, relaxed_vertices, pinches;  ///< as in laves_report
  double relaxed_max;

  size_t lattice_tets;       ///< tets congruent to one of the three tiles of C15, of one common size or of that times a power
                             ///< of two (graded meshes), found by their shape
  size_t bcc_tets;           ///< the same of the one tile of BCC, whose cubes are cut from C15's; SIZE_MAX: not known (read
                             ///< from an older certificate)
  double lattice_size;       ///< that size (mean edge of the tiling), as the most tiles have it; 0: none
  double lattice_tolerance;  ///< relative, of the squares of edges

  double angle_margin;                                  ///< degrees; no angle is computed worse than this
  double attained_min_dihedral, attained_max_dihedral;  ///< contain every angle: the extremes widened by the margin
  bool has_promise;
  double promised_min_dihedral, promised_max_dihedral;
  bool promise_holds;  ///< every tet is inside the promised window by more than the margin; true without a promise
  double asked_min_dihedral, asked_max_dihedral, asked_volume_length;

  double distance_asked;     ///< the distance from which on places count as DISTANT; 0: not looked for. Where the boundary's
                             ///< edges are nearest to twice, half, ... the mean edge, it is so many times as much
  double off_surface_asked;  ///< the distance from which on boundary vertices count as OFF_SURFACE, likewise; 0: not looked for
  bool has_features;         ///< features were looked for, and the solid has some; of `features`, a file keeps what
                             ///< docs/certificate.md lists
  bool features_tags;        ///< edges between tags were looked for too
  bool features_drawn;       ///< points and lines of the caller's as well, so that nobody else can look for the same
  laves_feature_check features;

  char to_surface_reason[96];  ///< why an upper bound of the distance is not known; empty where it is
  char from_surface_reason[96];

  size_t exception_counts[LAVES_EXCEPTION_COUNT];  ///< exact; THIN: as many as were looked for
  size_t exception_count;                          ///< of those listed: at most LAVES_PLACE_CAPACITY of a kind, the worst first
  laves_exception exceptions[LAVES_EXCEPTION_CAPACITY];
} laves_certificate;

/// What to measure against. From laves_certify_options_default(), then changed.
typedef struct laves_certify_options {
  const laves_domain *domain;    ///< to measure distances against and to find causes; NULL: none
  bool distances;                ///< false: leave distances out even where there is a domain; default true
  const char *input;             ///< the file or the expression of the domain, to be named and hashed; NULL: none
  const laves_options *options;  ///< with which the mesh was made; NULL: it was not made by laves_generate()
  const laves_report *report;    ///< the report of that call, for its promise; given with options
  double promised_min_dihedral, promised_max_dihedral;  ///< where there is no report; default 0, 180: nothing promised
  double min_dihedral, max_dihedral, volume_length;     ///< asked window where there are no options; default as there
  // Features to be measured where there are no options (with them: those that they ask for). They need the domain and
  // `distances`.
  double feature_angle;        ///< as laves_options.feature_angle; default 0: none are looked for
  bool feature_tags;           ///< as laves_options.feature_tags
  double feature_size;         ///< as laves_feature_options.size; default 0: that of the mesh's exact tiles, where it has many
  const char *const *command;  ///< [command_count] words of the command that makes the mesh again, to be stated as they are;
                               ///< NULL: none. Left out, too, where they are no UTF-8 or more than a certificate holds
  int command_count;           ///< at most LAVES_COMMAND_WORDS, whose bytes with a NUL each are LAVES_COMMAND_CAPACITY at most
  uint32_t cookie;
} laves_certify_options;

LAVES_API laves_certify_options laves_certify_options_default(void);

/// States what a mesh is, by code that shares nothing with the stages that make meshes.
/// @param options  NULL: the defaults
/// @return LAVES_OK when the statement is complete (see certificate->check.valid and promise_holds), LAVES_ERROR_OPTION,
///         LAVES_ERROR_INPUT (the input's file cannot be read), LAVES_ERROR_MEMORY, LAVES_ERROR_CANCELLED
/// Cost: as laves_check_mesh(), and about 0.05 microseconds a tet for the hash and the shapes.
LAVES_API laves_result laves_certify(laves_context *context, const laves_mesh *mesh, const laves_certify_options *options,
                                     laves_certificate *certificate, laves_error *error);

/// Writes a certificate as JSON (docs/certificate.schema.json), whole or not at all.
LAVES_API laves_result laves_certificate_write(laves_context *context, const laves_certificate *certificate, const char *path,
                                               laves_error *error);

/// Reads a certificate. What is missing, of the wrong type or out of range is an error that names the member; members that
/// are not known are passed over.
/// @return LAVES_OK, LAVES_ERROR_INPUT, LAVES_ERROR_MEMORY
LAVES_API laves_result laves_certificate_read(laves_context *context, const char *path, laves_certificate *certificate,
                                              laves_error *error);

/// A sentence on one figure that a certificate states and that is not so.
typedef struct laves_difference {
  char text[240];
} laves_difference;

/// Whether a certificate tells the truth of a mesh: recomputes all that can be and compares it.
/// @param domain       the surface; NULL: then distances, causes and the input's hash are not compared
/// @param input        its file or expression, or NULL
/// @param certificate  as read
/// @param differences  out: laves_difference[capacity]    @param count  out: how many there are in all, may exceed capacity
/// @return LAVES_OK when it could be compared, or as laves_certify()
LAVES_API laves_result laves_certificate_verify(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                                const char *input, const laves_certificate *certificate,
                                                laves_difference *differences, size_t capacity, size_t *count,
                                                laves_error *error);

/* ---- files ------------------------------------------------------------------------------------------------------ */

typedef enum laves_format {
  LAVES_FORMAT_AUTO,  ///< from the extension when writing, from the content when reading
  LAVES_FORMAT_VTU,
  LAVES_FORMAT_GMSH22,
  LAVES_FORMAT_GMSH41,
  LAVES_FORMAT_MEDIT,
  LAVES_FORMAT_TETGEN,  ///< .node, .ele and .face beside one another
  LAVES_FORMAT_VTKHDF,
  LAVES_FORMAT_VTK,   ///< VTK's older form, "legacy"
  LAVES_FORMAT_XDMF,  ///< .xdmf and .h5 beside one another
  LAVES_FORMAT_EXODUS,
  LAVES_FORMAT_ABAQUS,
  LAVES_FORMAT_NASTRAN,
  LAVES_FORMAT_NPZ,    ///< NumPy's arrays
  LAVES_FORMAT_DMTET,  ///< NumPy's arrays as deep marching tetrahedra take them: points in the unit cube, and tets
  LAVES_FORMAT_STL,    ///< the boundary only, as are the rest
  LAVES_FORMAT_OBJ,
  LAVES_FORMAT_PLY,
  LAVES_FORMAT_OFF,
  LAVES_FORMAT_COUNT
} laves_format;

typedef struct laves_write_options {
  laves_format format;
  bool ascii;       ///< text instead of binary, where the format has both
  int compression;  ///< of VTU: 0 none .. 9 smallest; default 1
  uint32_t cookie;
} laves_write_options;

LAVES_API laves_write_options laves_write_options_default(void);
/// The name used on the command line ("vtu", "gmsh41", ...), or NULL; and its inverse, LAVES_FORMAT_COUNT if unknown.
LAVES_API const char *laves_format_name(laves_format format);
LAVES_API laves_format laves_format_from_name(const char *name);
/// The format that a file name's extension means, or LAVES_FORMAT_COUNT.
LAVES_API laves_format laves_format_from_path(const char *path);
/// Whether a streamed mesh (laves_options.streamed) can be written in it: VTU, Gmsh's, VTKHDF, legacy VTK, XDMF and NPZ.
LAVES_API bool laves_format_streams(laves_format format);
/// Whether a mesh of second order (laves_mesh_curve()) can be written in it: VTU, Gmsh's, Medit, VTKHDF, legacy VTK, XDMF,
/// Exodus, Abaqus, Nastran and NPZ.
LAVES_API bool laves_format_is_quadratic(laves_format format);

/// Writes a mesh, whole or not at all: a temporary file beside the target is renamed when complete.
LAVES_API laves_result laves_mesh_write(laves_context *context, const laves_mesh *mesh, const char *path,
                                        const laves_write_options *options, laves_error *error);

/// Reads a tetrahedral mesh (VTU, Gmsh 2.2 and 4.1, Medit, TetGen; ASCII and binary) of any program.
LAVES_API laves_result laves_mesh_read(laves_context *context, const char *path, laves_mesh **mesh, laves_error *error);

#ifdef __cplusplus
}
#endif

#endif
