// laves.h is C++ as well: structs start from their defaults, functions link with C names.
#include <laves/laves.h>

#include <cstring>

int main() {
  laves_options options = laves_options_default();
  options.align = LAVES_ALIGN_PCA;
  laves_context *context = laves_context_create(nullptr);
  if (!context) return 1;
  laves_domain *domain = nullptr;
  laves_error error;
  const laves_result result = laves_domain_from_expression(context, "sphere(", &domain, &error);
  const bool refused = result == LAVES_ERROR_INPUT && domain == nullptr && std::strlen(error.text) > 0;
  laves_context_free(context);
  return refused && options.tet_target == 0 ? 0 : 1;
}
