/* A software rasteriser.
 *
 * Input: triangles in picture coordinates. Output: pixels in linear light with their coverage.
 * The picture is drawn in bands of rows so that the samples of one band, not of all, are in memory. Each pixel has a
 * grid of samples, and each sample keeps the nearest triangle's colour. A line along an edge is not drawn by itself but as
 * a darker seam within both triangles that share it, by the distance of the sample from the edge's line in pixels: so
 * lines can never fight with faces over depth. Bold lines, for creases, are drawn the same way and never fade. */
#include "raster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "interrupt.h"

/* Samples along each side of a pixel: 9 in all leave no visible steps in lines a pixel wide. */
enum { samples = 3, band_height = 64 };

/* How far outside, in pixels, a sample still counts as covered: rounding must not open holes between neighbours. */
static const double edge_slack = 1e-9;

typedef struct raster_sample {
  float colour[3];
  float nearness;
  int32_t triangle;
} raster_sample;

/* A linear function over the picture: a x + b y + c. */
typedef struct slope {
  double a, b, c;
} slope;

static double slope_at(slope s, double x, double y) { return s.a * x + s.b * y + s.c; }

/* Distances in pixels from the lines through the edges, positive inside; edge i is opposite corner i. */
static bool edge_slopes(const raster_triangle *t, slope edges[3]) {
  double area = (t->x[1] - t->x[0]) * (t->y[2] - t->y[0]) - (t->x[2] - t->x[0]) * (t->y[1] - t->y[0]);
  if (!(fabs(area) > 1e-12)) {
    return false;
  }
  double turn = area > 0 ? 1 : -1;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    double dx = t->x[k] - t->x[j], dy = t->y[k] - t->y[j];
    double scale = turn / sqrt(dx * dx + dy * dy);
    edges[i] = (slope){-dy * scale, dx * scale, (dy * t->x[j] - dx * t->y[j]) * scale};
  }
  return true;
}

/* The linear function with the given values at the corners. */
static slope value_slope(const raster_triangle *t, const slope edges[3], const double values[3]) {
  slope out = {0, 0, 0};
  for (int i = 0; i < 3; i++) {
    double share = values[i] / slope_at(edges[i], t->x[i], t->y[i]);
    out.a += share * edges[i].a;
    out.b += share * edges[i].b;
    out.c += share * edges[i].c;
  }
  return out;
}

/* How dark the lines of a triangle are, 0..1: they fade where it is seen edge on or is hardly wider than its lines, so that
 * fine meshes and silhouettes don't turn black. */
static double line_strength(const raster_triangle *t, const slope edges[3]) {
  if (!(t->edge_width > 0)) return 0;
  double altitude = INFINITY;
  for (int i = 0; i < 3; i++) {
    altitude = fmin(altitude, slope_at(edges[i], t->x[i], t->y[i]));
  }
  return fmax(0, fmin(1, altitude / (5 * t->edge_width) - 0.15));
}

/* How much of a sample a bold line covers, 0..1; `inside`: its distances from the edges. */
static double bold_cover(const raster_triangle *t, const double inside[3]) {
  double cover = 0;
  for (int i = 0; i < 3; i++) {
    if (t->bold >> i & 1) cover = fmax(cover, fmin(1, 0.5 + (0.5 * t->bold_width - inside[i]) * samples));
  }
  return cover;
}

static int clamp_int(double value, int low, int high) { return value < low ? low : value > high ? high : (int)value; }

/* Draws one triangle into the band of sample rows [first_row, first_row + row_count). */
static void draw_triangle(const raster_triangle *t, int32_t index, raster_sample *band, int columns, int first_row,
                          int row_count) {
  slope edges[3];
  double top = fmin(t->y[0], fmin(t->y[1], t->y[2])) * samples, bottom = fmax(t->y[0], fmax(t->y[1], t->y[2])) * samples;
  if (bottom < first_row || top > first_row + row_count || !edge_slopes(t, edges)) {
    return;
  }
  slope nearness = value_slope(t, edges, t->nearness);
  double strength = line_strength(t, edges);
  double left = fmin(t->x[0], fmin(t->x[1], t->x[2])) * samples, right = fmax(t->x[0], fmax(t->x[1], t->x[2])) * samples;
  int y_end = clamp_int(ceil(bottom + 0.5), first_row, first_row + row_count);
  int x_begin = clamp_int(floor(left - 0.5), 0, columns), x_end = clamp_int(ceil(right + 0.5), 0, columns);
  for (int row = clamp_int(floor(top - 0.5), first_row, first_row + row_count); row < y_end; row++) {
    double y = (row + 0.5) / samples;
    for (int column = x_begin; column < x_end; column++) {
      double x = (column + 0.5) / samples;
      double e0 = slope_at(edges[0], x, y), e1 = slope_at(edges[1], x, y), e2 = slope_at(edges[2], x, y);
      double inside = fmin(e0, fmin(e1, e2));
      float near = (float)slope_at(nearness, x, y);
      raster_sample *sample = &band[(size_t)(row - first_row) * (size_t)columns + (size_t)column];
      if (inside < -edge_slack || near <= sample->nearness) {
        continue;
      }
      // Half of the line lies on this side of the edge; it fades over the size of a sample.
      double line = strength * fmax(0, fmin(1, 0.5 + (0.5 * t->edge_width - inside) * samples));
      double bold = t->bold ? bold_cover(t, (const double[3]){e0, e1, e2}) : 0;
      for (int i = 0; i < 3; i++) {
        double plain = t->colour[i] + line * (t->edge_colour[i] - t->colour[i]);
        sample->colour[i] = (float)(plain + bold * (t->bold_colour[i] - plain));
      }
      sample->nearness = near;
      sample->triangle = index;
    }
  }
}

/* Averages the samples of each pixel of a row. */
static void resolve_row(const raster_sample *band, int columns, raster_pixel *row, int width) {
  for (int x = 0; x < width; x++) {
    raster_pixel pixel = {.nearest = -1};
    for (int i = 0; i < samples * samples; i++) {
      const raster_sample *sample = &band[(size_t)(i / samples) * (size_t)columns + (size_t)(x * samples + i % samples)];
      if (sample->nearness <= 0) {
        continue;
      }
      for (int k = 0; k < 3; k++) {
        pixel.colour[k] += sample->colour[k] / (samples * samples);
      }
      pixel.coverage += 1.0f / (samples * samples);
      if (sample->nearness > pixel.nearness) {
        pixel.nearness = sample->nearness;
        pixel.nearest = sample->triangle;
      }
    }
    row[x] = pixel;
  }
}

bool raster_draw(const raster_triangle *triangles, size_t count, raster_pixel *pixels, int width, int height) {
  int columns = width * samples;
  size_t band_size = (size_t)columns * band_height * samples;
  raster_sample *band = malloc(band_size * sizeof *band);
  if (!band) {
    return false;
  }
  for (int first = 0; first < height; first += band_height) {
    int rows = height - first < band_height ? height - first : band_height;
    memset(band, 0, band_size * sizeof *band);
    for (size_t i = 0; i < count && !interrupt_asked(); i++) {
      draw_triangle(&triangles[i], (int32_t)i, band, columns, first * samples, rows * samples);
    }
    for (int y = 0; y < rows; y++) {
      resolve_row(band + (size_t)y * samples * (size_t)columns, columns, pixels + (size_t)(first + y) * (size_t)width, width);
    }
  }
  free(band);
  return true;
}
