/* The check of a mesh that stays in its file. */
#ifndef LAVES_CERTIFY_CHECK_STREAM_H
#define LAVES_CERTIFY_CHECK_STREAM_H

#include "certify/certify.h"
#include "certify/face_table.h"
#include "certify/point_cache.h"

/* laves_check_file(), whatever the file is. The options are checked. */
laves_result laves__check_stream(laves_context *context, laves__mesh_stream *stream, const laves_file_check_options *options,
                                 laves_file_check *check, laves_error *error);

/* The boundary that is left in the table once all tets have gone through it: topology, area, distances, and the triangles of the
 * stream. Frees the table and takes the used vertices of it first. */
laves_result laves__check_stream_boundary(laves_context *context, laves__face_table *table, laves__point_cache *cache,
                                          const laves_domain *domain, laves_file_check *check, laves_error *error);

#endif
