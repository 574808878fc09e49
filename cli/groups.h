/* The regions of a mesh and the named parts of its boundary, counted and measured for JSON. */
#ifndef LAVES_CLI_GROUPS_H
#define LAVES_CLI_GROUPS_H

#include "json.h"
#include "laves/laves.h"

/* The members "regions" and "boundaries", each where the mesh has any. */
void groups_write_json(json *out, const laves_mesh *mesh);

#endif
