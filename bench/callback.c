/* The unit sphere as a callback in C, loaded by python_calls.py: what a callable of Python is compared with. */
#include <math.h>
#include <stddef.h>

void ball(void *user, const double *points, size_t count, double *values);

void ball(void *user, const double *points, size_t count, double *values) {
  (void)user;
  for (size_t i = 0; i < count; i++) {
    const double *p = points + 3 * i;
    values[i] = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1;
  }
}
