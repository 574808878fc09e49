/* What of a mesh is drawn: the triangles that can be seen from outside, each with its colour. */
#ifndef LAVES_CLI_SCENE_H
#define LAVES_CLI_SCENE_H

#include <laves/laves.h>

typedef enum scene_colour { SCENE_CLASS, SCENE_DIHEDRAL, SCENE_QUALITY, SCENE_SIZE } scene_colour;

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
void scene_free(scene *subject);

#endif
