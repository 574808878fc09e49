// A program outside the tree, valid as C11 and as C++11: uses the installed library.
#include <laves/laves.h>
#include <stdio.h>
#include <string.h>

int main(void) {
  laves_context *context = laves_context_create(NULL);
  if (!context || strcmp(laves_version(), LAVES_VERSION) != 0) {
    fprintf(stderr, "library %s, header %s\n", laves_version(), LAVES_VERSION);
    return 1;
  }
  laves_context_free(context);
  return 0;
}
