/* From the leaves of an octree to tetrahedra.
 *
 *     decorate.c   which sites of the body-centred cubic lattice give way to C15
 *     tiles.c      vertices and tetrahedra of both lattices, of the walls between them and of the changes of size
 *
 * Vertices of the body-centred cubic lattice (BCC) are the corners and the centres of all leaves. Where eight leaves of a
 * size meet and their surroundings are as large, the lattice can be turned into C15: sites have four colours (the sum of
 * the coordinates, in half sides, modulo 4); every BCC tetrahedron has one site of each; sites of colour 2 and 3 go, and
 * the middle of each bond between two of them comes. All that this changes lies in the stars of the sites that go, and
 * those stars fill space without overlap around the bonds, so each site is decided by itself:
 *
 *           v            a site s and its four bonds b1..b4, each ending in a midpoint m (when the other end goes, too) or
 *         / | \          in the other end. Around s, in the place of 24 tets:
 *       b1--+--b2          1  (b1 b2 b3 b4)
 *       |\  s  /|          4  (three of them, the site of colour 0 or 1 opposite the fourth)
 *       | \ | / |         12  (two of them, the site straight between, one of the two opposite the others)
 *        \ b3-b4
 *
 * which is C15 when all four are midpoints (8 x 17 = 136 tets to a period), and sound whatever they are.
 * Source: [isotropic-tcp], section 3.2, for the decoration; [labelle2007], section 4, for changes of size in BCC. */
#ifndef LAVES_GRADED_TILES_H
#define LAVES_GRADED_TILES_H

#include "background/graph.h"
#include "graded/keys.h"
#include "graded/octree.h"

/* The sites of both lattices. Site s < corner.count is a corner, the others are the centres of leaves. */
typedef struct laves__sites {
  laves_context *context;
  const laves__octree *tree;
  laves__key_table corner;
  bool *gone; /* [corner.count + leaf_count] the site gives way to midpoints */
  size_t site_count;
} laves__sites;

laves_result laves__sites_make(const laves__octree *tree, laves__sites *sites, laves_error *error);
void laves__sites_free(laves__sites *sites);

/* A site that may go, seen from within: where it is, its colour (2 or 3), and the side of the leaves around. */
typedef struct laves__site_view {
  int32_t at[3];
  int32_t side;
  int colour;
} laves__site_view;
laves__site_view laves__site_look(const laves__sites *sites, size_t site);

/* Towards the four bonds of a site of colour 2; a site of colour 3 has them reversed. In half sides. */
extern const int8_t laves__bond[4][3];

/* The site one bond away. */
size_t laves__bond_end(const laves__sites *sites, const laves__site_view *view, size_t site, int bond);

/* The graph without its lists, scale and hull; all tets positive. */
laves_result laves__tiles_make(const laves__octree *tree, const laves__sites *sites, laves__graph *graph, laves_error *error);

#endif
