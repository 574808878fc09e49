// A solid given by a function: four metaballs. The library asks for values in batches, from several threads at once, so
// the function only reads what `user` points to.
#include <laves/laves.h>
#include <math.h>
#include <stdio.h>

typedef struct balls {
  int count;
  double centres[4][3], radius;
} balls;

// Each ball adds exp(1 - d^2/r^2) to a field, and the solid is where the field is above 1. The gradient of one bump is
// at most sqrt(2) exp(1/2) / r, which bounds how fast the sum can change.
static void evaluate(void *user, const double *points, size_t count, double *values) {
  const balls *all = user;
  for (size_t i = 0; i < count; ++i) {
    double field = 0;
    for (int k = 0; k < all->count; ++k) {
      double square = 0;
      for (int j = 0; j < 3; ++j) {
        const double d = points[3 * i + (size_t)j] - all->centres[k][j];
        square += d * d;
      }
      field += exp(1 - square / (all->radius * all->radius));
    }
    values[i] = 1 - field;  // negative inside
  }
}

int main(void) {
  const balls all = {4, {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}}, 0.9};
  const laves_function function = {
      .evaluate = evaluate,
      .user = (void *)&all,
      .lower = {-3, -3, -3},
      .upper = {3, 3, 3},
      .lipschitz = 4 * sqrt(2) * exp(0.5) / 0.9,
  };
  laves_error error;
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_report report;
  laves_context *context = laves_context_create(NULL);
  if (!context) return 4;

  laves_options options = laves_options_default();
  options.tet_target = 20000;
  laves_result result = laves_domain_from_function(context, &function, &domain, &error);
  if (result == LAVES_OK) result = laves_generate(context, domain, &options, &mesh, &report, &error);
  if (result == LAVES_OK || result == LAVES_TARGET_MISSED) {
    printf("%zu tets, %zu of them exact tiles; volume %.4f\n", laves_mesh_tet_count(mesh), laves_mesh_lattice_tet_count(mesh),
           report.volume);
    result = laves_mesh_write(context, mesh, "balls.vtu", NULL, &error);
  }
  if (result != LAVES_OK) fprintf(stderr, "callback: %s\n", error.text);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  return laves_result_exit_code(result);
}
