/* Fuzzes the whole: bytes become a small solid (a soup of triangles at integer places, where what is degenerate is common; or a
 * few primitives) and options. A mesh that comes out is valid and within the window that was promised; else there is a sentence.
 *
 * In: a byte for the kind of solid, then options, then the solid. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/base.h"
#include "fuzz/fuzz_target.h"

enum { TRIANGLES = 40, PLACES = 6, TEXT = 1000, MEMORY = 256 << 20 };

/* Reports of progress before the work is called off: none of these solids should need as many. */
static bool goes_on(void *user, const char *phase, double fraction) {
  int64_t *left = user;
  (void)phase;
  (void)fraction;
  return --*left > 0;
}

/* ---- from bytes ---- */

/* Triangles between few points: mostly open, crossing, or flat. */
static laves_result take_soup(fuzz_bytes *b, laves_context *context, laves_domain **domain, laves_error *error) {
  double points[3 * TRIANGLES][3];
  uint32_t triangles[TRIANGLES][3];
  int32_t tags[TRIANGLES];
  const int point_count = 4 + fuzz_below(b, 20), count = 1 + fuzz_below(b, TRIANGLES);
  for (int i = 0; i < point_count; i++) {
    for (int k = 0; k < 3; k++) points[i][k] = fuzz_below(b, PLACES);
  }
  for (int i = 0; i < count; i++) {
    for (int k = 0; k < 3; k++) triangles[i][k] = (uint32_t)fuzz_below(b, point_count);
    tags[i] = fuzz_below(b, 3);
  }
  return laves_domain_from_triangles(context, points[0], (size_t)point_count, triangles[0], (size_t)count, tags, domain, error);
}

/* A solid that is closed but for what the bytes do: a row of boxes that may touch, overlap, lie within one another, and lack a
 * face or have it twice. */
static laves_result take_boxes(fuzz_bytes *b, laves_context *context, laves_domain **domain, laves_error *error) {
  static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  double points[3 * 8][3];
  uint32_t triangles[3 * 12][3];
  int32_t tags[3 * 12];
  size_t triangle_count = 0;
  const uint32_t boxes = 1 + (uint32_t)fuzz_below(b, 3);
  for (uint32_t i = 0; i < boxes; i++) {
    double low[3], high[3];
    for (int k = 0; k < 3; k++) low[k] = fuzz_below(b, PLACES), high[k] = low[k] + 0.25 * fuzz_below(b, 16);
    for (uint32_t c = 0; c < 8; c++) {
      for (int k = 0; k < 3; k++) points[8 * i + c][k] = c >> k & 1 ? high[k] : low[k];
    }
    const int missing = fuzz_below(b, 64);
    for (int f = 0; f < 12; f++) {
      if (f == missing) continue;
      for (int k = 0; k < 3; k++) triangles[triangle_count][k] = 8 * i + faces[f][k];
      tags[triangle_count++] = (int32_t)i;
    }
  }
  return laves_domain_from_triangles(context, points[0], (size_t)8 * boxes, triangles[0], triangle_count, tags, domain, error);
}

/* A chain of primitives, each joined to what is there. */
static laves_result take_expression(fuzz_bytes *b, laves_context *context, laves_domain **domain, laves_error *error) {
  static const char *const operators[] = {"+", "-", "*"};
  static const char *const forms[] = {"sphere(%.2f)", "box(%.2f,1,0.7)", "cylinder{r=0.4,h=%.2f}", "torus(1,%.2f)",
                                      "cone{r=%.2f,r2=0.2,h=1}"};
  char text[TEXT], part[100];
  int used = 0;
  const int parts = 1 + fuzz_below(b, 4);
  for (int i = 0; i < parts; i++) {
    const double x = 0.25 * fuzz_below(b, 6), y = 0.25 * fuzz_below(b, 6), z = 0.25 * fuzz_below(b, 6), turn = fuzz_byte(b);
    snprintf(part, sizeof part, forms[fuzz_below(b, LAVES__COUNT_OF(forms))], 0.05 + 0.05 * fuzz_below(b, 30));
    used += snprintf(text + used, sizeof text - (size_t)used, "%s%s:rotate(%g, \"z\"):move(%g, %g, %g)%s", i ? "(" : "", part,
                     turn, x, y, z, i ? ")" : "");
    if (i + 1 < parts) used += snprintf(text + used, sizeof text - (size_t)used, " %s ", operators[fuzz_below(b, 3)]);
  }
  return laves_domain_from_expression(context, text, domain, error);
}

static laves_options take_options(fuzz_bytes *b) {
  static const double guarantees[] = {14.4, 0, 20, 28, 14.4};
  static const double angles[] = {40, 0, 10, 90};
  laves_options o = laves_options_default();
  const int bits = fuzz_byte(b);
  o.relative_size = 0.2 + 0.3 * fuzz_share(b);
  o.method = (laves_method)fuzz_below(b, 3);
  o.guarantee = guarantees[fuzz_below(b, LAVES__COUNT_OF(guarantees))];
  o.feature_angle = angles[fuzz_below(b, LAVES__COUNT_OF(angles))];
  o.improve = !(bits & 1);
  o.keep_thin = !(bits & 2);
  o.feature_tags = bits & 4;
  o.face_sources = bits & 8;
  o.regions = bits & 16 ? LAVES_REGIONS_PARTS : LAVES_REGIONS_NONE;
  o.align = bits & 32 ? LAVES_ALIGN_PCA : LAVES_ALIGN_NONE;
  if (bits & 64) {
    o.curvature_elements = 3 + fuzz_below(b, 10);
    o.thickness_elements = 0.5 * fuzz_below(b, 5);
    o.grading = 0.05 + 0.95 * fuzz_share(b);
  }
  if (bits & 128) o.interior_growth = fuzz_share(b);
  return o;
}

/* ---- what holds ---- */

static void check_mesh(laves_context *context, const laves_mesh *mesh, const laves_domain *domain, const laves_report *report) {
  laves_check check;
  size_t outside = 0;
  FUZZ_REQUIRE(laves_check_mesh(context, mesh, NULL, &check, NULL) == LAVES_OK);
  FUZZ_REQUIRE(check.valid && check.tets > 0);
  for (int i = 0; i < report->warning_count; i++) FUZZ_REQUIRE(!strstr(report->warnings[i], "should not happen"));
  if (report->promised_min_dihedral <= 0 || report->corners > 0 || report->crease_length > 0) return; /* sharp edges may force */
  FUZZ_REQUIRE(laves_check_window(context, mesh, domain, report->promised_min_dihedral, report->promised_max_dihedral, 0, NULL, 0,
                                  &outside, NULL) == LAVES_OK);
  FUZZ_REQUIRE(outside == 0);
}

static void try_domain(laves_context *context, const laves_domain *domain, const laves_options *options) {
  laves_mesh *mesh = NULL;
  laves_report report = {0};
  laves_error error = {0};
  const laves_result result = laves_generate(context, domain, options, &mesh, &report, &error);
  FUZZ_REQUIRE((result == LAVES_OK || result == LAVES_TARGET_MISSED) == (mesh != NULL));
  if (mesh)
    check_mesh(context, mesh, domain, &report);
  else
    FUZZ_REQUIRE(result != LAVES_ERROR_INTERNAL && error.result == result && strlen(error.text) > 10);
  laves_mesh_free(mesh);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
  fuzz_bytes b = {bytes, bytes + length};
  int64_t left = 200000;
  laves_context_options options = laves_context_options_default();
  options.thread_count = 1;
  options.memory_limit = MEMORY;
  options.progress = goes_on;
  options.progress_user = &left;
  laves_context *context = laves_context_create(&options);
  laves_domain *domain = NULL;
  laves_error error = {0};
  FUZZ_REQUIRE(context != NULL);
  const int kind = fuzz_below(&b, 4);
  const laves_options wishes = take_options(&b);
  const laves_result result = kind == 0   ? take_soup(&b, context, &domain, &error)
                              : kind == 1 ? take_expression(&b, context, &domain, &error)
                                          : take_boxes(&b, context, &domain, &error);
  if (result == LAVES_OK)
    try_domain(context, domain, &wishes);
  else
    FUZZ_REQUIRE(result != LAVES_ERROR_INTERNAL && error.result == result && strlen(error.text) > 10);
  laves_domain_free(domain);
  FUZZ_REQUIRE(laves_context_bytes(context) == 0);
  laves_context_free(context);
  return 0;
}
