/* Fuzzes scripts: any text must give a solid whose sides and feet are true, or a sentence, with nothing left behind. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "domain/oracle.h"
#include "fuzz/fuzz_target.h"

/* Two hundred thousand steps of Lua are enough for the fuzzer. */
static bool stop_soon(void *user, const char *phase, double fraction) {
  int *left = user;
  (void)phase;
  (void)fraction;
  return --*left > 0;
}

static void check_region(const laves_domain *domain, laves__vec3 point) {
  const laves__oracle *o = &domain->oracle;
  if (!o->region) return;
  const int32_t region = o->region(o->self, point);
  FUZZ_REQUIRE(region >= 0 && region < domain->region_count);
}

static void check_box(const laves_domain *domain, laves__box3 box) {
  const laves__oracle *o = &domain->oracle;
  const laves__vec3 centre = box3_centre(box), half = v3_sub(box.upper, centre);
  const laves__side side = o->side(o->self, centre, v3_norm(half), half);
  const laves__vec3 points[3] = {centre, v3_lerp(centre, box.lower, 0.99), v3_lerp(centre, box.upper, 0.7)};
  double phi[3];
  o->evaluate(o->self, 3, points, phi, NULL);
  check_region(domain, centre);
  for (int i = 0; i < 3; i++) {
    FUZZ_REQUIRE(isfinite(phi[i]));
    if (side != LAVES__UNDECIDED) FUZZ_REQUIRE(side == LAVES__OUTSIDE ? phi[i] > 0 : phi[i] < 0);
  }
  laves__vec3 foot, normal;
  uint32_t hint = LAVES__NO_HINT;
  const double reach = v3_norm(half);
  if (!o->project(o->self, centre, reach, &hint, &foot, &normal)) return;
  FUZZ_REQUIRE(v3_finite(foot) && v3_distance(foot, centre) <= reach && fabs(v3_norm(normal) - 1) < 1e-9);
  if (o->tag) FUZZ_REQUIRE(laves_domain_tag_name(domain, o->tag(o->self, foot, hint)) != NULL);
}

static void check_solid(const laves_domain *domain) {
  const laves__oracle *o = &domain->oracle;
  FUZZ_REQUIRE(v3_finite(o->bounds.lower) && v3_finite(o->bounds.upper) && v3_finite(o->origin));
  const laves__vec3 widths = v3_sub(o->bounds.upper, o->bounds.lower);
  for (int i = 0; i < 27; i++) {
    const laves__vec3 step = v3(i % 3, i / 3 % 3, i / 9);
    laves__box3 cell;
    for (int k = 0; k < 3; k++) {
      *v3_slot(&cell.lower, k) = v3_at(o->bounds.lower, k) + v3_at(step, k) / 3 * v3_at(widths, k);
      *v3_slot(&cell.upper, k) = v3_at(cell.lower, k) + v3_at(widths, k) / 3;
    }
    check_box(domain, cell);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
  int reports = 3;
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  options.memory_limit = (size_t)32 << 20;
  options.progress = stop_soon;
  options.progress_user = &reports;
  laves_context *context = laves_context_create(&options);
  FUZZ_REQUIRE(context != NULL);
  laves_domain *domain = laves__alloc_zeroed(context, 1, sizeof *domain);
  FUZZ_REQUIRE(domain != NULL);
  domain->context = context;
  laves_error error = {0};
  const laves_result result =
      laves__implicit_build(context, (const char *)bytes, length, length % 2 == 0, "input", "/nowhere", domain, &error);
  if (result == LAVES_OK)
    check_solid(domain);
  else
    FUZZ_REQUIRE(error.result == result && strlen(error.text) > 10 && result != LAVES_ERROR_INTERNAL);
  laves_domain_free(domain);
  FUZZ_REQUIRE(laves_context_bytes(context) == 0);
  laves_context_free(context);
  return 0;
}
