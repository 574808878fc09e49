/* Lets go of features where they cost too much. */
#ifndef LAVES_IMPROVE_RELEASE_H
#define LAVES_IMPROVE_RELEASE_H

#include "improve/improve.h"

/* How much is let go of, in growing order: vertices that never reached their place; those on creases; corners, too; all that
 * shares a tet with one of those. */
typedef enum laves__release {
  LAVES__RELEASE_OFF,
  LAVES__RELEASE_CREASES,
  LAVES__RELEASE_CORNERS,
  LAVES__RELEASE_AROUND,
  LAVES__RELEASES
} laves__release;

/* Frees boundary vertices of tets outside a window from their creases and corners: they then move anywhere on the surface. Angles
 * that the input fixes do not count. Returns how many were freed. Like the next it ends early when cancelled. */
size_t laves__release_features(const laves__frame *frame, const laves__window *window, laves__release what, laves__layer *layer);

/* Tets at creases sharper than an angle, which fixes theirs: forced[layer->tet_count]. Returns how many there are. */
size_t laves__mark_forced(const laves__frame *frame, double sharper_than, const laves__layer *layer, bool *forced);

#endif
