/* What a report shows of each tetrahedron: its angles and ratios, which tile it is, and how often each value occurs. */
#ifndef LAVES_CLI_REPORT_SHAPES_H
#define LAVES_CLI_REPORT_SHAPES_H

#include <stdbool.h>
#include <stdint.h>

#include "laves/laves.h"

/* Bins: a degree of the dihedral angles, a hundredth of the radius ratio, and 0.02 of the radius-edge ratio from 1 on, of which
 * the last holds all that is larger. */
enum { DIHEDRAL_BINS = 180, RATIO_BINS = 100, EDGE_BINS = 100 };

typedef enum report_class { REPORT_LAYER, REPORT_TILE, REPORT_BCC_TILE, REPORT_CLASSES } report_class;

/* NAN where a tetrahedron is flat or has corners out of range. */
typedef struct report_shapes {
  size_t count;
  float *min_dihedral, *max_dihedral; /* degrees */
  float *radius_ratio, *radius_edge;  /* as in laves_check */
  uint8_t *classes;                   /* report_class */
  size_t class_counts[REPORT_CLASSES];
  size_t dihedrals[DIHEDRAL_BINS]; /* of all six of each */
  size_t ratios[RATIO_BINS], edges[EDGE_BINS];
} report_shapes;

/* @param certificate  of the mesh: tells the size of the tiles
 * @return false when memory is short or the work is to stop. Free with report_shapes_free() in any case. */
bool report_shapes_make(const laves_mesh *mesh, const laves_certificate *certificate, report_shapes *out);
void report_shapes_free(report_shapes *shapes);

/* Marks in chosen[tet] the `most` tetrahedra with the worst of each value; of equal ones those of lower index. */
bool report_shapes_worst(const report_shapes *shapes, size_t most, uint8_t *chosen);

/* Whether the corners of a tetrahedron are vertices of the mesh; p: their places. */
bool report_tet_corners(const laves_mesh *mesh, size_t tet, double p[4][3]);

#endif
