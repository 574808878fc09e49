/* Triangles to pixels: a z-buffer with supersampling, on which thin lines lie along the edges of the triangles. */
#ifndef LAVES_CLI_RASTER_H
#define LAVES_CLI_RASTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// One triangle in the picture's plane.
typedef struct raster_triangle {
  double x[3], y[3];     ///< pixels, y downwards
  double nearness[3];    ///< 1 / distance along the view, which is linear over the picture; larger is nearer
  float colour[3];       ///< linear light
  float edge_colour[3];  ///< linear light
  float edge_width;      ///< pixels
  uint8_t bold;          ///< bit i: the edge opposite corner i has a bold line
  float bold_colour[3];  ///< linear light
  float bold_width;      ///< pixels
} raster_triangle;

/// What covers one pixel, averaged over its samples, with the nearest of the triangles that cover it.
typedef struct raster_pixel {
  float colour[3];  ///< linear light, premultiplied by coverage
  float coverage;   ///< 0..1
  float nearness;   ///< of the triangle `nearest`; 0 where there is none
  int32_t nearest;  ///< index of a triangle, or -1
} raster_pixel;

/// Draws triangles into raster_pixel[height][width]. Returns false when memory is short.
bool raster_draw(const raster_triangle *triangles, size_t count, raster_pixel *pixels, int width, int height);

#endif
