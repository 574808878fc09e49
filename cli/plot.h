/* Histograms of a mesh's quality, as the field prints them: dihedral angles, radius ratio, radius-edge ratio. */
#ifndef LAVES_CLI_PLOT_H
#define LAVES_CLI_PLOT_H

#include <laves/laves.h>

typedef enum plot_measure { PLOT_DIHEDRAL, PLOT_RADIUS_RATIO, PLOT_RADIUS_EDGE, PLOT_MEASURES } plot_measure;

enum { PLOT_BINS = 60 };

/* Counts of one measure. What lies beyond the range is in the last bin. */
typedef struct histogram {
  plot_measure measure;
  double low, high;      /* of the axis */
  double min, max, mean; /* of the values */
  size_t count, tets, bins[PLOT_BINS];
} histogram;

typedef struct plot_style {
  int width, height; /* pixels, of the whole drawing */
  bool dark, transparent;
} plot_style;

/* Counts all tetrahedra: each has one value, or of dihedral angles six. Stops early when it is asked to. */
histogram histogram_count(const laves_mesh *mesh, plot_measure measure);

/* Draws histograms side by side into an SVG file, which appears whole or not at all. False when it cannot be written; errno tells
 * why. */
bool plot_write(const char *path, const histogram *shown, int count, const plot_style *style);

#endif
