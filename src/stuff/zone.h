/* Where the boundary must be made by stuffing. */
#ifndef LAVES_STUFF_ZONE_H
#define LAVES_STUFF_ZONE_H

#include "background/lattice.h"
#include "mesh/components.h"
#include "mesh/layer.h"
#include "stuff/graft.h"
#include "stuff/rule.h"

/* How many tets of the layer are outside the promised window; too few when cancelled meanwhile. `forced`: a flag for each tet
 * whose angles the input fixes, which do not count; NULL: none. */
size_t laves__count_broken(const laves__guarantee *guarantee, const laves__layer *layer, const bool *forced);

/* Whether a fresh tet is, forced or not. */
bool laves__is_broken(const laves__guarantee *guarantee, const laves__layer *layer);

/* Puts in the zone all sites of the cells within `reach` cells of each tet outside the promised window; `known` forgets them, for
 * what is there must be made anew though it was in the zone before. */
void laves__zone_around(const laves__guarantee *guarantee, const laves__layer *layer, const bool *forced, int reach,
                        laves__lattice *lattice, laves__known_lattice *known);

/* Puts in the zone all cells of those components of the layer in which a tet is outside the promised window, and the cells around
 * them: none of their tets then has a site that another wall snapped. */
void laves__zone_walls(const laves__layer *layer, const laves__components *walls, const bool *broken, laves__lattice *lattice);

/* In which of the walls a tet is outside the promised window: broken[walls->count]. */
void laves__find_broken_walls(const laves__guarantee *guarantee, const laves__layer *layer, const bool *forced,
                              const laves__components *walls, bool *broken);

/* Which boundary vertices of the layer stand where tets are cut, or in cells that are at most `rings` from one with such a place:
 * in_zone[layer->vertex_count]. False when memory is short. */
bool laves__zone_vertices(const laves__lattice *lattice, const laves__layer *layer, int rings, bool *in_zone);

/* Puts in the zone whole components: every site of the records that are joined to a zone by neighbouring cells. No tet then
 * has corners both in the zone and beyond it. False when memory is short. */
bool laves__zone_components(laves__lattice *lattice);

/* Puts all sites of all records in the zone. */
void laves__zone_everything(laves__lattice *lattice);

#endif
