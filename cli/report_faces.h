/* Which tetrahedron has a boundary face, and which faces lie open when whole tetrahedra on one side of a plane are taken away. */
#ifndef LAVES_CLI_REPORT_FACES_H
#define LAVES_CLI_REPORT_FACES_H

#include <stdbool.h>
#include <stdint.h>

#include "laves/laves.h"

/* Faces of a positive tetrahedron, outwards; face i is opposite corner i. */
extern const int report_tet_face[4][3];

/* Finds for every boundary face 4 * tet + corner of the tetrahedron that has it, UINT32_MAX where none does.
 * @param owners  out: uint32_t[face_count]
 * @return false when memory is short or the work is to stop */
bool report_face_owners(const laves_mesh *mesh, uint32_t *owners);

/* A face between two tetrahedra, one on each side of a plane. */
typedef struct report_open_face {
  int32_t corners[3];
  uint32_t low, high; /* the tetrahedra below the plane and above it */
} report_open_face;

typedef struct report_section {
  report_open_face *faces;
  size_t count;
} report_section;

/* @param centroids  float[tet_count]: coordinates of the tetrahedra's centroids across the plane; those up to `position` are
 * below
 * @param reach      the faces' neighbours have centroids that are at most so far apart
 * @param marks      uint8_t[vertex_count], zero before and after
 * @return false when memory is short or the work is to stop; free section->faces in any case */
bool report_section_make(const laves_mesh *mesh, const float *centroids, float position, float reach, uint8_t *marks,
                         report_section *section);

#endif
