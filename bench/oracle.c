/* Times the surface oracle on a model: building, evaluation in small cells near the surface, projection with a hint.
 *
 *   oracle MODEL...      one line each: model, triangles, build ms, evaluate ns cold and in cells, project ns cold and hinted */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "domain/oracle.h"

enum { CELLS = 6000, CELL_POINTS = 24 };

static double uniform(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-53;
}

static laves__vec3 in_cube(uint64_t *state, laves__vec3 centre, double half) {
  const double x = uniform(state), y = uniform(state), z = uniform(state);
  return v3_add(centre, v3(half * (2 * x - 1), half * (2 * y - 1), half * (2 * z - 1)));
}

/* Centres of cells that the surface passes, found among random points of the box. */
static size_t find_cells(const laves__oracle *o, double width, laves__vec3 *cells) {
  uint64_t state = 1;
  size_t count = 0;
  const laves__vec3 c = box3_centre(o->bounds), h = v3_scale(v3_sub(o->bounds.upper, o->bounds.lower), 0.5);
  for (int tries = 0; tries < 4000000 && count < CELLS; tries++) {
    const laves__vec3 u = in_cube(&state, v3(0, 0, 0), 1);
    const laves__vec3 p = v3_add(c, v3(u.x * h.x, u.y * h.y, u.z * h.z));
    double phi;
    o->evaluate(o->self, 1, &p, &phi, NULL);
    if (fabs(phi) < width / 2) cells[count++] = p;
  }
  return count;
}

static void measure(const char *name, const laves_domain *domain, double build_seconds) {
  const laves__oracle *o = &domain->oracle;
  const double width = box3_diagonal(o->bounds) / 40;
  laves__vec3 *cells = calloc(CELLS, sizeof *cells), *points = calloc(CELLS * CELL_POINTS, sizeof *points);
  double *phi = calloc(CELLS * CELL_POINTS, sizeof *phi), cold, batch, project_cold, project_hint;
  uint32_t *hints = calloc(CELLS * CELL_POINTS, sizeof *hints);
  if (!cells || !points || !phi || !hints) exit(1);
  const size_t cell_count = find_cells(o, width, cells), count = cell_count * CELL_POINTS;
  uint64_t state = 2;
  for (size_t i = 0; i < count; i++) points[i] = in_cube(&state, cells[i / CELL_POINTS], width / 2);
  double t = laves__cpu_seconds();
  for (size_t i = 0; i < count; i++) o->evaluate(o->self, 1, &points[i], &phi[i], NULL);
  cold = laves__cpu_seconds() - t;
  t = laves__cpu_seconds();
  for (size_t i = 0; i < cell_count; i++)
    o->evaluate(o->self, CELL_POINTS, points + i * CELL_POINTS, phi + i * CELL_POINTS, hints + i * CELL_POINTS);
  batch = laves__cpu_seconds() - t;
  laves__vec3 foot, normal;
  t = laves__cpu_seconds();
  for (size_t i = 0; i < count; i++) {
    uint32_t hint = LAVES__NO_HINT;
    o->project(o->self, points[i], INFINITY, &hint, &foot, &normal);
  }
  project_cold = laves__cpu_seconds() - t;
  /* Smoothing: a point near the surface, moved by a little since its hint was found. */
  for (size_t i = 0; i < count; i++) {
    if (!o->project(o->self, points[i], INFINITY, &hints[i], &foot, &normal)) continue;
    points[i] = in_cube(&state, foot, width / 20);
  }
  t = laves__cpu_seconds();
  for (size_t i = 0; i < count; i++) o->project(o->self, points[i], INFINITY, &hints[i], &foot, &normal);
  project_hint = laves__cpu_seconds() - t;
  const double ns = 1e9 / (double)(count ? count : 1);
  printf("%-28s %8zu faces  build %7.1f ms  evaluate %6.0f cold %6.0f cells  project %6.0f cold %6.0f hinted (ns)\n", name,
         domain->info.triangle_count, 1e3 * build_seconds, ns * cold, ns * batch, ns * project_cold, ns * project_hint);
  free(cells);
  free(points);
  free(phi);
  free(hints);
}

int main(int argc, char **argv) {
  laves_context *context = laves_context_create(NULL);
  if (!context) return 4;
  for (int i = 1; i < argc; i++) {
    laves_domain *domain;
    laves_error error;
    const double start = laves__cpu_seconds();
    if (laves_domain_from_file(context, argv[i], &domain, &error) != LAVES_OK) {
      printf("%-28s %s\n", argv[i], error.text);
      continue;
    }
    const double seconds = laves__cpu_seconds() - start;
    const char *name = argv[i];
    for (const char *c = name; *c; c++)
      if (*c == '/') name = c + 1;
    measure(name, domain, seconds);
    laves_domain_free(domain);
  }
  laves_context_free(context);
  return 0;
}
