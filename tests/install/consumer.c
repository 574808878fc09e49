// A program outside the tree, valid as C11 and as C++11: meshes a ball with the installed library.
#include <laves/laves.h>
#include <stdio.h>
#include <string.h>

static int fail(const laves_error *error) {
  fprintf(stderr, "%s\n", error->text);
  return 1;
}

int main(void) {
  laves_context *context = laves_context_create(NULL);
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_error error;
  if (!context || strcmp(laves_version(), LAVES_VERSION) != 0) {
    fprintf(stderr, "library %s, header %s\n", laves_version(), LAVES_VERSION);
    return 1;
  }
  laves_options options = laves_options_default();
  options.size = 0.4;
  if (laves_domain_from_expression(context, "sphere(1)", &domain, &error) != LAVES_OK) return fail(&error);
  if (laves_generate(context, domain, &options, &mesh, NULL, &error) != LAVES_OK) return fail(&error);
  const bool right = laves_mesh_tet_count(mesh) > 100;
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  return right ? 0 : 1;
}
