// A first mesh: docs/hello.md grows this program step by step.
#include <laves/laves.h>
#include <stdio.h>

// Says what went wrong and returns the exit code that the program `laves` would give.
static int fail(const laves_error *error) {
  fprintf(stderr, "hello: %s\n", error->text);
  return laves_result_exit_code(error->result);
}

int main(void) {
  int code = 0;
  laves_error error;
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_report report;
  laves_check check;
  laves_context *context = laves_context_create(NULL);
  if (!context) return 4;

  laves_options options = laves_options_default();
  options.tet_target = 20000;

  laves_result result = laves_domain_from_expression(context, "sphere(1) - cylinder{r=0.4}", &domain, &error);
  if (result == LAVES_OK) result = laves_generate(context, domain, &options, &mesh, &report, &error);
  // A mesh outside the wished window is a mesh all the same.
  if (result == LAVES_TARGET_MISSED) result = LAVES_OK;
  if (result == LAVES_OK) result = laves_check_mesh(context, mesh, domain, &check, &error);
  if (result == LAVES_OK) result = laves_mesh_write(context, mesh, "bead.vtu", NULL, &error);

  if (result == LAVES_OK) {
    printf("%zu tets of size %.3g, angles %.1f to %.1f degrees\n", check.tets, report.size, check.min_dihedral.min,
           check.max_dihedral.max);
    printf("%s, at most %.2g from the surface\n", check.valid ? "valid" : "not valid", check.to_surface_max);
  } else {
    code = fail(&error);
  }
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  return code;
}
