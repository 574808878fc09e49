/* What of a mesh is drawn: the triangles that can be seen from outside, each with its colour. */
#ifndef LAVES_CLI_SCENE_H
#define LAVES_CLI_SCENE_H

#include <laves/laves.h>

typedef enum scene_colour { SCENE_CLASS, SCENE_DIHEDRAL, SCENE_QUALITY, SCENE_SIZE, SCENE_DISTANCE } scene_colour;

typedef struct scene_options {
  bool cut;
  double plane[4];  ///< with `cut`: tetrahedra with every corner at a x + b y + c z <= d are kept
  scene_colour colour;
  double crease_angle;  ///< degrees: edges of the boundary where its normal turns by more are creases; 0: none are looked for
} scene_options;

/// One triangle, seen from the side that `normal` points to.
typedef struct scene_face {
  double points[3][3];
  double normal[3];   ///< unit length, out of the solid
  float colour[3];    ///< linear light, 0..1
  int32_t vertex[3];  ///< of the mesh
  bool boundary;      ///< of the mesh, not of the cut
  uint8_t creases;    ///< bit i: the edge opposite corner i is a crease
} scene_face;

typedef struct scene {
  scene_face *faces;
  size_t face_count;
  size_t kept_tets;
  double sizes[2];  ///< of SCENE_SIZE: the edge lengths that have the first and the last colour
} scene;

/// Returns false when memory is short. `out` is freed with scene_free() in any case.
bool scene_build(const laves_mesh *mesh, const scene_options *options, scene *out);

/// Finds the worst tetrahedra, worst first: by the volume-length ratio for SCENE_QUALITY, else by the dihedral angle furthest
/// from the tiling's.
/// @param tets    out: int64_t[capacity]    @param scores  out: double[capacity], 0 flat to 1 as the tiling's
/// @return how many there are, `capacity` at most
size_t scene_worst_tets(const laves_mesh *mesh, scene_colour colour, int64_t *tets, double *scores, size_t capacity);

/// A scene of all faces of some tetrahedra, in the colours by which they are the worst. Returns false when memory is short; free
/// `out` with scene_free() in any case.
bool scene_build_tets(const laves_mesh *mesh, const int64_t *tets, size_t count, scene_colour colour, scene *out);

/// Colours the boundary faces of a scene of SCENE_DISTANCE: blue on the surface, red at `furthest`.
/// @param distances  double[face_count]; those of faces within the cut are not looked at
void scene_colour_distances(scene *subject, const double *distances, double furthest);

void scene_free(scene *subject);

#endif
