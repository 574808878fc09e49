// Progress and cancelling: prints each phase once, and stops a large mesh as soon as improvement begins.
// A cancelled call returns LAVES_ERROR_CANCELLED, and the context can be used again.
#include <laves/laves.h>
#include <stdio.h>
#include <string.h>

typedef struct watch {
  const char *phase;  // of the latest report
  bool impatient;
} watch;

static bool report_progress(void *user, const char *phase, double fraction) {
  watch *seen = user;
  if (!seen->phase || strcmp(seen->phase, phase) != 0) printf("  %s\n", phase);
  seen->phase = phase;
  (void)fraction;
  return !(seen->impatient && strcmp(phase, "improve") == 0);
}

int main(void) {
  watch seen = {.impatient = true};
  laves_context_options settings = laves_context_options_default();
  settings.progress = report_progress;
  settings.progress_user = &seen;
  laves_context *context = laves_context_create(&settings);
  if (!context) return 4;

  laves_error error;
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_options options = laves_options_default();
  options.tet_target = 300000;
  laves_result result = laves_domain_from_expression(context, "torus(1, 0.4)", &domain, &error);
  if (result == LAVES_OK) result = laves_generate(context, domain, &options, &mesh, NULL, &error);
  printf("first try: %s\n", laves_result_name(result));

  if (result == LAVES_ERROR_CANCELLED) {
    seen = (watch){0};
    options.tet_target = 10000;
    result = laves_generate(context, domain, &options, &mesh, NULL, &error);
    printf("second try: %s\n", laves_result_name(result));
  }
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  return laves_result_exit_code(result);
}
