/* What of a mesh a report embeds: all of it, or the boundary, the worst tetrahedra, and sections. */
#ifndef LAVES_CLI_REPORT_PARTS_H
#define LAVES_CLI_REPORT_PARTS_H

#include "report.h"
#include "report_blocks.h"
#include "report_faces.h"
#include "report_groups.h"
#include "report_shapes.h"

enum { REPORT_CUTS_MOST = 39 };

/* Where the page may cut the mesh across one axis, when only sections are embedded. */
typedef struct report_cuts {
  float positions[REPORT_CUTS_MOST]; /* relative to the origin, ascending */
  int count;
} report_cuts;

typedef struct report_parts {
  bool whole;                                 /* every tetrahedron is embedded, with the mesh's own numbers */
  double origin[3], lower[3], upper[3];       /* coordinates are relative to the origin, the middle of the box */
  size_t tet_count, vertex_count, face_count; /* embedded */
  uint32_t *tets;                             /* [tet_count] of the mesh; NULL where whole, as the next three */
  uint32_t *places;                           /* [mesh tets] among the embedded; UINT32_MAX: not embedded */
  uint32_t *vertices;                         /* [mesh vertices] likewise */
  float *centroids[3];                        /* [mesh tets] along each axis, relative to the origin */
  uint32_t *owners;                           /* [mesh faces], as of report_face_owners() */
  float *distances;    /* [mesh faces] of their centroids from the surface, negative inside; NULL: no surface */
  size_t worst;        /* of each measure so many are among the embedded; 0 where whole */
  bool distance_rough; /* from values and slopes of an implicit solid */
  double distance_range[2];
  report_groups regions, tags;
  report_cuts cuts[3];
} report_parts;

/* @param whole_up_to  meshes of up to so many tetrahedra are embedded whole
 * @return LAVES_OK, LAVES_ERROR_MEMORY or what stopped the work; free with report_parts_free() in any case */
laves_result report_parts_make(session *run, const report_subject *subject, const report_shapes *shapes, size_t whole_up_to,
                               report_parts *parts);
void report_parts_free(report_parts *parts);

/* Each writes blocks of the page; false when memory is short or the work is to stop. */
bool report_parts_write(FILE *file, const laves_mesh *mesh, const report_shapes *shapes, const report_parts *parts);
bool report_sections_write(FILE *file, const laves_mesh *mesh, const report_shapes *shapes, const report_parts *parts,
                           double longest_edge);

#endif
