/* A picture of a scene: camera, light and background. */
#ifndef LAVES_CLI_PICTURE_H
#define LAVES_CLI_PICTURE_H

#include "scene.h"

typedef enum picture_background { PICTURE_WHITE, PICTURE_TRANSPARENT, PICTURE_DARK } picture_background;

typedef struct picture_options {
  int width, height;    ///< pixels
  double azimuth;       ///< degrees, where the viewer stands, counterclockwise around the upward axis
  double elevation;     ///< degrees above the horizon
  int up;               ///< upward axis: 0 x, 1 y, 2 z; azimuth 0 is the axis after it (x for z, z for y)
  double line_width;    ///< of the edges, pixels; 0: none
  double crease_width;  ///< of those marked in the scene, pixels
  picture_background background;
} picture_options;

/// Unit vector from the scene to the viewer.
void picture_direction(const picture_options *options, double direction[3]);

/// Draws the scene to fill the picture but for a margin.
/// @param over  drawn over it, whatever hides it, each four faces (a tetrahedron) with a ring around; the scene is paled then.
/// NULL:
///              nothing
/// @param rgba  out: uint8_t[height][width][4], sRGB, not premultiplied
/// @return false when memory is short
bool picture_draw(const scene *subject, const scene *over, const picture_options *options, uint8_t *rgba);

#endif
