/* The two parts stand side by side, in the same orientation. */
#include "draw.h"

#include <stdio.h>

#include "laves/laves.h"

/* From the background tet to its pieces, in quarter units. */
static const laves__vec3 beside = {4, -4, 0};

typedef struct drawing {
  double point[4 * (LAVES__PIECES_MAX + 1)][3];
  int32_t tet[LAVES__PIECES_MAX + 1][4];
  int tets;
} drawing;

/* Each tet gets points of its own, but for those that earlier ones have. */
static void add_tet(drawing *d, const laves__vec3 corner[4], laves__vec3 shift, int *points) {
  for (int k = 0; k < 4; k++) {
    const laves__vec3 x = v3_add(corner[k], shift);
    int n = 0;
    while (n < *points && v3_distance(x, v3(d->point[n][0], d->point[n][1], d->point[n][2])) > 0) n++;
    d->point[n][0] = x.x;
    d->point[n][1] = x.y;
    d->point[n][2] = x.z;
    d->tet[d->tets][k] = n;
    if (n == *points) ++*points;
  }
  d->tets++;
}

static bool write_drawing(const drawing *d, int points, const char *path) {
  laves_error error;
  laves_mesh *mesh = NULL;
  const laves_context_options context_options = laves_context_options_default();
  laves_context *context = laves_context_create(&context_options);
  if (context == NULL) return false;
  const laves_write_options options = laves_write_options_default();
  laves_result result =
      laves_mesh_from_arrays(context, d->point[0], (size_t)points, d->tet[0], (size_t)d->tets, NULL, &mesh, &error);
  if (result == LAVES_OK) result = laves_mesh_write(context, mesh, path, &options, &error);
  laves_mesh_free(mesh);
  laves_context_free(context);
  return result == LAVES_OK;
}

bool draw_extreme(const extreme *e, const char *folder, const char *name) {
  char path[4096];
  drawing d = {.tets = 0};
  int points = 0;
  add_tet(&d, e->configuration.site, v3(0, 0, 0), &points);
  for (int p = 0; p < e->pieces.count; p++) {
    laves__vec3 corner[4];
    for (int k = 0; k < 4; k++) corner[k] = laves__code_position(&e->tet, e->pieces.piece[p][k]);
    add_tet(&d, corner, beside, &points);
  }
  printf("%s: %.4f, tet %d\n", name, e->value, e->configuration.tet);
  for (int k = 0; k < 4; k++) {
    const configuration *c = &e->configuration;
    printf("  %s (%g, %g, %g)", c->label[k] < 0 ? "IN" : c->label[k] ? "OUT" : "ON", c->site[k].x, c->site[k].y, c->site[k].z);
    if (c->label[k] == 0)
      printf(" by %.4f of (%g, %g, %g)",
             c->share[k].high > 0 ? v3_distance(e->tet.position[k], c->site[k]) / v3_norm(c->along[k]) : 0, c->along[k].x,
             c->along[k].y, c->along[k].z);
    for (int o = 0; o < 4; o++)
      if (c->label[k] < 0 && c->label[o] > 0) printf(", cut towards corner %d at %.4f", o, e->tet.fraction[k][o]);
    printf("\n");
  }
  return snprintf(path, sizeof path, "%s/%s.vtu", folder, name) < (int)sizeof path && write_drawing(&d, points, path);
}
