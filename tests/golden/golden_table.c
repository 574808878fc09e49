/* Prints the golden table: what a few inputs and options give. A change of a line is a change of what users get, so it is
 * part of the review; tests.cmake tells how to renew the table. Counts are exact, figures are rounded to what is told. */
#include <stdio.h>
#include <string.h>

#include "laves/laves.h"

typedef struct row {
  const char *input;
  long long tets; /* wished; 0: size */
  double size;
  laves_align align;
  bool improve;
  const char *size_field; /* NULL: none */
  double interior_growth;
} row;

static const row rows[] = {
    {"sphere(1)", 0, 0.15, LAVES_ALIGN_NONE, true, NULL, 0},
    {"sphere(1)", 0, 0.15, LAVES_ALIGN_NONE, false, NULL, 0},
    {"sphere(1)", 50000, 0, LAVES_ALIGN_NONE, true, NULL, 0},
    {"torus(1, 0.4)", 20000, 0, LAVES_ALIGN_NONE, true, NULL, 0},
    {"torus(1, 0.4):rotate(30, 'x')", 20000, 0, LAVES_ALIGN_PCA, true, NULL, 0},
    {"ellipsoid(3, 1, 1)", 20000, 0, LAVES_ALIGN_NONE, true, NULL, 0},
    {"metaballs{{0, 0, 0, 1}, {1, 0, 0, 0.6}, {0, 0.9, 0.4, 0.7}}", 20000, 0, LAVES_ALIGN_NONE, true, NULL, 0},
    {"gyroid{period=1, thickness=0.35} & sphere(1)", 30000, 0, LAVES_ALIGN_NONE, true, NULL, 0},
    {"sphere(1) - cylinder{r=0.4, h=3}", 20000, 0, LAVES_ALIGN_NONE, true, NULL, 0},
    {"box(2, 1.5, 1)", 20000, 0, LAVES_ALIGN_NONE, true, NULL, 0},
    {"sphere(1) - sphere(0.93)", 0, 0.07, LAVES_ALIGN_NONE, true, NULL, 0},
    {"x^4 + y^4 + z^4 - x*x - y*y - z*z + 0.4", 20000, 0, LAVES_ALIGN_NONE, true, NULL, 0},
    {"torus(1, 0.4)", 0, 0.08, LAVES_ALIGN_NONE, true, NULL, 0.3},
    {"sphere(1)", 0, 0.2, LAVES_ALIGN_NONE, true, "0.08 + 0.2*abs(x)", 0},
};

static int print_row(laves_context *context, const row *r) {
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_sizing *sizing = NULL;
  laves_error error = {.text = ""};
  laves_check c;
  laves_options options = laves_options_default();
  options.tet_target = r->tets;
  options.size = r->size;
  options.align = r->align;
  options.improve = r->improve;
  options.interior_growth = r->interior_growth;
  laves_result result = laves_domain_from_expression(context, r->input, &domain, &error);
  if (result == LAVES_OK) result = laves_sizing_create(context, &sizing, &error);
  if (result == LAVES_OK && r->size_field) result = laves_sizing_add_expression(sizing, r->size_field, &error);
  options.sizing = sizing;
  if (result == LAVES_OK) result = laves_generate(context, domain, &options, &mesh, NULL, &error);
  if (mesh && laves_check_mesh(context, mesh, NULL, &c, &error) == LAVES_OK)
    printf("%s; %lld; %g; %s; %s; %s; %g; %zu; %zu; %.2f; %.2f; %.3f; %.3f\n", r->input, r->tets, r->size,
           r->align == LAVES_ALIGN_PCA ? "pca" : "none", r->improve ? "yes" : "no", r->size_field ? r->size_field : "none",
           r->interior_growth, c.tets, c.vertices, c.min_dihedral.min, c.max_dihedral.max, c.volume_length.min,
           c.radius_ratio.mean);
  else
    printf("%s: %s\n", r->input, error.text);
  laves_mesh_free(mesh);
  laves_sizing_free(sizing);
  laves_domain_free(domain);
  return mesh == NULL;
}

int main(void) {
  laves_context *context = laves_context_create(NULL);
  int failures = 0;
  printf(
      "input; tets asked; size asked; align; improve; size field; interior growth; tets; vertices; min dihedral; max dihedral; "
      "min volume-length; mean radius ratio\n");
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) failures += print_row(context, &rows[i]);
  laves_context_free(context);
  return failures;
}
