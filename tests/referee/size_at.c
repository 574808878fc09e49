/* Reads a size file that another program wrote and prints the size at a place: size_at FILE x y z. */
#include <stdio.h>
#include <stdlib.h>

#include "size/background.h"

int main(int argc, char **argv) {
  if (argc != 5) return EXIT_FAILURE;
  laves_context *context = laves_context_create(NULL);
  laves__background_sizes *sizes;
  laves_error error;
  if (laves__background_load(context, argv[1], NULL, &sizes, &error) == LAVES_OK) {
    const laves__vec3 place = v3(strtod(argv[2], NULL), strtod(argv[3], NULL), strtod(argv[4], NULL));
    double size = 0;
    laves__background_evaluate(sizes, 1, &place, &size);
    printf("%.17g\n", size);
  } else {
    printf("%s\n", error.text);
  }
  laves__background_free(sizes);
  laves_context_free(context);
  return EXIT_SUCCESS;
}
