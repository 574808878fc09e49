/* Features of implicit solids: creases, corners, patches of primitives and of what is made of them, to rounding. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "domain/feature_implicit.h"
#include "fixtures/assert_close.h"
#include "fixtures/folders.h"
#include "fixtures/random_expression.h"
#include "fixtures/shapes.h"
#include "fixtures/stride.h"

static const double pi = 3.14159265358979323846;

typedef struct found {
  laves_context *context;
  laves_domain *domain;
  double diagonal;
  laves__features features;
  laves__feature_lines lines;
  int *degree;   /* [point_count] segments at each point */
  int *together; /* [point_count] parent in a forest of connected points */
} found;

static int root(const found *f, int i) {
  while (f->together[i] != i) i = f->together[i];
  return i;
}

/* size: a fraction of the diagonal. */
static found *find(const char *text, double size) {
  found *f = calloc(1, sizeof *f); /* features must stay where they are */
  f->context = laves_context_create(NULL);
  laves_error error;
  if (laves_domain_from_expression(f->context, text, &f->domain, &error) != LAVES_OK) fail_msg("%s: %s", text, error.text);
  f->diagonal = box3_diagonal(f->domain->oracle.bounds);
  const laves__feature_wish wish = {.angle = 40, .size = size * f->diagonal};
  f->features = (laves__features){.context = f->context, .oracle = &f->domain->oracle};
  f->lines = (laves__feature_lines){.context = f->context};
  assert_int_equal(f->domain->oracle.find_features(&wish, &f->features, &f->lines, &error), LAVES_OK);
  f->degree = calloc(f->lines.point_count + 1, sizeof *f->degree);
  f->together = calloc(f->lines.point_count + 1, sizeof *f->together);
  for (size_t i = 0; i < f->lines.point_count; i++) f->together[i] = (int)i;
  for (size_t i = 0; i < f->lines.segment_count; i++) {
    const uint32_t *ends = f->lines.segment[i].ends;
    for (int k = 0; k < 2; k++) f->degree[ends[k]]++;
    f->together[root(f, (int)ends[0])] = root(f, (int)ends[1]);
  }
  return f;
}

static void drop(found *f) {
  if (f->features.free_self) f->features.free_self(f->context, f->features.self);
  laves__feature_lines_free(&f->lines);
  laves_domain_free(f->domain);
  free(f->degree);
  free(f->together);
  assert_int_equal(laves_context_bytes(f->context), 0);
  laves_context_free(f->context);
  free(f);
}

static int count_degree(const found *f, int degree) {
  int count = 0;
  for (size_t i = 0; i < f->lines.point_count; i++) count += f->degree[i] == degree;
  return count;
}

static int count_pieces(const found *f) {
  int count = 0;
  for (size_t i = 0; i < f->lines.point_count; i++) count += f->degree[i] > 0 && root(f, (int)i) == (int)i;
  return count;
}

static double total_length(const found *f) {
  double sum = 0;
  for (size_t i = 0; i < f->lines.segment_count; i++) {
    const uint32_t *ends = f->lines.segment[i].ends;
    sum += v3_distance(f->lines.point[ends[0]], f->lines.point[ends[1]]);
  }
  return sum;
}

/* Points off the segment's middle, to its left and right as seen from outside, lie on its patches; the angle is that of
 * the two normals, and the solid bends to the side that it tells. */
static void assert_sides(const found *f) {
  const laves__oracle *o = &f->domain->oracle;
  for (size_t i = 0; i < f->lines.segment_count; i += 7) {
    const laves__feature_segment *s = &f->lines.segment[i];
    const laves__vec3 a = f->lines.point[s->ends[0]], b = f->lines.point[s->ends[1]];
    const laves__vec3 along = v3_unit(v3_sub(b, a)), middle = v3_lerp(a, b, 0.5);
    bool is_near_corner = false;
    for (size_t j = 0; j < f->lines.point_count && !is_near_corner; j++)
      is_near_corner = f->degree[j] != 2 && v3_distance(f->lines.point[j], middle) < 0.02 * f->diagonal;
    if (is_near_corner || s->patch[0] == s->patch[1]) continue; /* equal where an edge fades away */
    laves__vec3 foot[2], normal[2];
    for (int k = 0; k < 2; k++) {
      uint32_t hint = LAVES__NO_HINT;
      assert_true(f->features.project_patch(f->features.self, s->patch[k], middle, f->diagonal, &hint, &foot[k], &normal[k]));
      assert_true(v3_distance(foot[k], middle) < 2e-4 * f->diagonal);
      assert_close(v3_norm(normal[k]), 1, 1e-12);
    }
    const double turn = atan2(v3_norm(v3_cross(normal[0], normal[1])), v3_dot(normal[0], normal[1])) * 180 / pi;
    assert_close(fabs(180 - s->angle), turn, 1.5);
    const laves__vec3 outside = v3_unit(v3_add(normal[0], normal[1])), left = v3_cross(outside, along);
    const double step = 2e-3 * f->diagonal;
    for (int k = 0; k < 2; k++) { /* on the way to the side, where the face of that side is */
      const laves__vec3 way = v3_scale(left, k == 0 ? 1 : -1);
      const laves__vec3 face = v3_unit(v3_mad(way, normal[k], -v3_dot(way, normal[k])));
      const laves__vec3 p = v3_mad(middle, face, step);
      laves__vec3 on, n;
      uint32_t hint = LAVES__NO_HINT;
      if (!o->project(o->self, p, step, &hint, &on, &n)) fail_msg("segment %d: nothing beside it", (int)i);
      if (f->features.patch_at(f->features.self, on, hint) != s->patch[k])
        fail_msg("segment %d at (%g, %g, %g): patch %d is not where it should be", (int)i, p.x, p.y, p.z, s->patch[k]);
      assert_true(v3_dot(n, normal[k]) > 0.95);
    }
  }
}

typedef struct wanted {
  const char *text;
  int patches, pieces, corners, ends; /* corners: points of 3 segments or more; ends: of one */
  double length, tolerance;           /* relative: chords are shorter than arcs */
} wanted;

static const wanted solids[] = {
    {"box(1, 2, 3)", 6, 1, 8, 0, 24, 1e-12},
    {"box(1, 2, 3):rotate{angle=30, axis={1, 1, 1}}", 6, 1, 8, 0, 24, 1e-12},
    {"box(1, 2, 3):rotate{angle=30, axis={1, 1, 1}}:move(1e6, 2e6, 3e6)", 6, 1, 8, 0, 24, 1e-8},
    {"sphere(1)", 1, 0, 0, 0, 0, 0},
    {"torus(1, 0.3)", 1, 0, 0, 0, 0, 0},
    {"rounded_box(1, 2, 3, 0.1)", 1, 0, 0, 0, 0, 0},
    {"smooth_union(sphere(1), sphere(1):move(1.5, 0, 0), 0.5)", 1, 0, 0, 0, 0, 0},
    {"shell(sphere(1), 0.1)", 2, 0, 0, 0, 0, 0},
    {"cylinder{r=1, h=2}", 3, 2, 0, 0, 12.566370614359172, 1e-4},
    {"cone{r=1, h=2}", 2, 1, 0, 0, 6.283185307179586, 1e-4},
    {"cone{r=1, h=2, r2=0.5}", 3, 2, 0, 0, 9.42477796076938, 1e-4},
    {"box(1, 1, 1) - sphere(0.6)", 7, 7, 8, 0, 12 + 6 * 2 * 3.14159265358979323846 * 0.33166247903554, 1e-4},
    {"box(1, 1, 1) - cylinder{r=0.3, h=2}", 7, 3, 8, 0, 12 + 4 * 3.14159265358979323846 * 0.3, 1e-4},
    {"box(1, 1, 1) - box(0.5, 0.5, 2)", 10, 2, 16, 0, 12 + 8 * 0.5 + 4, 1e-12},
    {"box(1, 1, 1) - box(0.5, 0.5, 0.5):move(0.5, 0.5, 0.5)", 9, 1, 14, 0, 13.5, 1e-12},
    {"box(1, 1, 1) | box(1, 1, 1):move(1, 0, 0)", 6, 1, 8, 0, 16, 1e-12},
    {"box(1, 1, 1) | cylinder{r=0.5, h=1}:move(0.5, 0, 0)", 4, 1, 4, 0, 8 + 3.14159265358979323846, 1e-4},
    {"repeat_polar(box(0.3, 0.3, 0.3):move(1, 0, 0), {count=7})", 30, 7, 56, 0, 25.2, 1e-12},
    {"shell(box(1, 1, 1), 0.05) - box(1, 1, 1):move(0.5, 0.5, 0.5)", 15, 1, 26, 0, 25.8, 1e-12},
    {"max(abs(x) + abs(y) + abs(z) - 1, -1)", 8, 1, 6, 0, 16.97056274847714, 1e-12},
    {"smooth_union(box(1, 1, 1), sphere(0.5):move(0.5, 0.5, 0.5), 0.3)", 4, 1, 7, 3, NAN, 0},
    {"cylinder{r=1, h=4} | cylinder{r=0.7, h=4}:rotate(90, \"x\")", 6, 6, 0, 0, NAN, 0},
    {"gyroid{period=1, thickness=0.2} & sphere(1)", 3, 20, 0, 0, NAN, 0},
};

static void creases_and_corners_are_all_found(void **state) {
  (void)state;
  static const double sizes[] = {0.03, 0.013};
  for (size_t k = 0; k < LAVES__COUNT_OF(solids); k++)
    for (size_t j = 0; j < LAVES__COUNT_OF(sizes); j += (size_t)test_stride()) {
      const wanted *w = &solids[k];
      found *f = find(w->text, sizes[j]);
      int corners = 0;
      for (int degree = 3; degree < 8; degree++) corners += count_degree(f, degree);
      if (f->features.patch_count != w->patches || count_pieces(f) != w->pieces || corners != w->corners ||
          count_degree(f, 1) != w->ends)
        fail_msg("%s, size %g: %d patches, %d pieces, %d corners, %d ends", w->text, sizes[j], f->features.patch_count,
                 count_pieces(f), corners, count_degree(f, 1));
      if (!isnan(w->length)) assert_close(total_length(f), w->length, w->tolerance * w->length);
      assert_sides(f);
      drop(f);
    }
}

static void corners_of_a_box_are_exact(void **state) {
  (void)state;
  found *f = find("box(1, 2, 3)", 0.02);
  for (size_t i = 0; i < f->lines.point_count; i++) {
    const laves__vec3 p = f->lines.point[i];
    const double off[3] = {fabs(fabs(p.x) - 0.5), fabs(fabs(p.y) - 1), fabs(fabs(p.z) - 1.5)};
    int on = 0;
    for (int k = 0; k < 3; k++) on += off[k] <= 1e-12;
    assert_int_equal(on, f->degree[i] == 3 ? 3 : 2);
  }
  for (size_t i = 0; i < f->lines.segment_count; i++) assert_close(f->lines.segment[i].angle, 90, 1e-5);
  drop(f);
}

static void notches_turn_inwards(void **state) {
  (void)state;
  found *f = find("box(1, 1, 1) - box(0.5, 0.5, 0.5):move(0.5, 0.5, 0.5)", 0.02);
  double notches = 0;
  for (size_t i = 0; i < f->lines.segment_count; i++) {
    const laves__feature_segment *s = &f->lines.segment[i];
    const bool notch = s->angle > 180;
    assert_close(s->angle, notch ? 270 : 90, 1e-5);
    if (notch) notches += v3_distance(f->lines.point[s->ends[0]], f->lines.point[s->ends[1]]);
  }
  assert_close(notches, 0.75, 1e-12);
  drop(f);
}

static void rims_lie_on_both_surfaces(void **state) {
  (void)state;
  found *f = find("cylinder{r=1, h=4} | cylinder{r=0.7, h=4}:rotate(90, \"x\")", 0.02);
  int across = 0;
  for (size_t i = 0; i < f->lines.point_count; i++) {
    const laves__vec3 p = f->lines.point[i];
    const double wide = fabs(hypot(p.x, p.y) - 1), narrow = fabs(hypot(p.x, p.z) - 0.7);
    const bool on_end = fabs(fabs(p.z) - 2) < 1e-12 || fabs(fabs(p.y) - 2) < 1e-12;
    assert_true(on_end ? wide < 1e-12 || narrow < 1e-12 : wide < 1e-12 && narrow < 1e-12);
    across += !on_end;
  }
  assert_true(across > 100);
  drop(f);
}

static void tips_are_corners(void **state) {
  (void)state;
  found *f = find("cone{r=1, h=2}", 0.02);
  assert_int_equal(f->lines.fixed_count, 1);
  assert_true(v3_distance(f->lines.point[f->lines.fixed[0].point], v3(0, 0, 1)) < 1e-12);
  drop(f);
  f = find("torus(0.5, 0.8)", 0.02); /* a spindle: two tips, and nothing between them is on the surface */
  assert_int_equal(f->lines.fixed_count, 2);
  for (int i = 0; i < 2; i++) {
    const laves__vec3 p = f->lines.point[f->lines.fixed[i].point];
    assert_true(v3_distance(v3(p.x, p.y, fabs(p.z)), v3(0, 0, sqrt(0.39))) < 1e-12);
  }
  drop(f);
  f = find("(x^2 + y^2)^0.5 - 1 + z & halfspace{normal={0, 0, -1}, offset=0.5}", 0.02);
  assert_int_equal(f->lines.fixed_count, 1);
  assert_true(v3_distance(f->lines.point[f->lines.fixed[0].point], v3(0, 0, 1)) < 1e-12);
  drop(f);
}

static void feet_lie_on_their_patch(void **state) {
  (void)state;
  static const char *const texts[] = {"box(1, 1, 1) - sphere(0.6)", "gyroid{period=1, thickness=0.2} & sphere(1)",
                                      "smooth_union(box(1, 1, 1), sphere(0.5):move(0.5, 0.5, 0.5), 0.3)"};
  enum { CAPACITY = 20000 };
  laves__vec3 *points = malloc(CAPACITY * sizeof *points);
  for (size_t k = 0; k < LAVES__COUNT_OF(texts); k++) {
    found *f = find(texts[k], 0.02);
    const laves__oracle *o = &f->domain->oracle;
    const size_t count = o->sample(o->self, 0.02 * f->diagonal, points, CAPACITY);
    uint64_t seed = k;
    assert_true(count > 1000);
    for (size_t i = 0; i < count; i++) {
      const int32_t patch = f->features.patch_at(f->features.self, points[i], LAVES__NO_HINT);
      assert_in_range(patch, 0, f->features.patch_count - 1);
      const laves__vec3 off = v3_add(points[i], random_point(&seed, 1e-4 * f->diagonal));
      laves__vec3 foot, normal;
      uint32_t hint = LAVES__NO_HINT;
      double phi;
      assert_true(f->features.project_patch(f->features.self, patch, off, f->diagonal, &hint, &foot, &normal));
      o->evaluate(o->self, 1, &foot, &phi, NULL);
      if (!(v3_distance(foot, points[i]) < 1e-3 * f->diagonal))
        fail_msg("%s: patch %d at (%g, %g, %g): foot %g away", texts[k], patch, off.x, off.y, off.z,
                 v3_distance(foot, points[i]));
      /* Close to a crease the foot may be on the patch's continuation, a little off the solid. */
      assert_true(fabs(phi) < 3e-4 * f->diagonal);
      const laves__vec3 far = v3_mad(points[i], normal, 0.1 * f->diagonal);
      if (f->features.project_patch(f->features.self, patch, far, 0.01 * f->diagonal, &hint, &foot, &normal))
        assert_true(v3_distance(foot, far) <= 0.01 * f->diagonal);
    }
    drop(f);
  }
  free(points);
}

static void creases_are_refined_to_rounding(void **state) {
  (void)state;
  found *f = find("box(1, 1, 1) - sphere(0.6)", 0.04);
  laves__crease crease = {0}; /* as the chain would give it; only its patches are asked for */
  f->features.crease = &crease;
  double most = 0;
  for (size_t i = 0; i < f->lines.segment_count; i++) {
    const laves__feature_segment *s = &f->lines.segment[i];
    const laves__vec3 a = f->lines.point[s->ends[0]], b = f->lines.point[s->ends[1]];
    laves__vec3 foot = v3_lerp(a, b, 0.4), tangent = v3_unit(v3_sub(b, a));
    const laves__vec3 chord = foot, along = tangent;
    crease.patch[0] = s->patch[1]; /* either order */
    crease.patch[1] = s->patch[0];
    f->features.refine(f->features.self, 0, &foot, &tangent);
    most = fmax(most, v3_distance(foot, chord));
    assert_true(v3_dot(tangent, along) > 0.99);
    assert_close(v3_norm(tangent), 1, 1e-12);
    const double faces[3] = {fabs(foot.x), fabs(foot.y), fabs(foot.z)};
    int on = fabs(v3_norm(foot) - 0.6) < 1e-12;
    for (int k = 0; k < 3; k++) on += fabs(faces[k] - 0.5) < 1e-12;
    assert_int_equal(on, 2);
  }
  assert_true(most > 1e-6 && most < 1e-4 * f->diagonal); /* chords miss the circles, by less than is promised */
  f->features.crease = NULL;
  drop(f);
}

static void runs_are_equal(void **state) {
  (void)state;
  found *a = find(solids[18].text, 0.02), *b = find(solids[18].text, 0.02);
  assert_int_equal(a->lines.point_count, b->lines.point_count);
  assert_int_equal(a->lines.segment_count, b->lines.segment_count);
  assert_memory_equal(a->lines.point, b->lines.point, a->lines.point_count * sizeof *a->lines.point);
  for (size_t i = 0; i < a->lines.segment_count; i++) {
    const laves__feature_segment *s = &a->lines.segment[i], *t = &b->lines.segment[i];
    assert_memory_equal(s->ends, t->ends, sizeof s->ends);
    assert_memory_equal(s->patch, t->patch, sizeof s->patch);
    assert_true(s->angle == t->angle);
  }
  drop(a);
  drop(b);
}

/* The rim of a plane cut through a faceted sphere closes, facet by facet. */
static void leaves_meet_the_rest(void **state) {
  (void)state;
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 16], text[FIXTURE_FOLDER_MAX + 100];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/ball.obj", folder);
  shape ball = shape_sphere(1, 8);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  for (size_t i = 0; i < ball.point_count; i++)
    fprintf(file, "v %.17g %.17g %.17g\n", ball.points[3 * i], ball.points[3 * i + 1], ball.points[3 * i + 2]);
  for (size_t i = 0; i < ball.triangle_count; i++)
    fprintf(file, "f %d %d %d\n", (int)ball.triangles[3 * i] + 1, (int)ball.triangles[3 * i + 1] + 1,
            (int)ball.triangles[3 * i + 2] + 1);
  assert_int_equal(fclose(file), 0);
  shape_free(&ball);
  snprintf(text, sizeof text, "surface('%s') & halfspace{normal={0.1, 0.2, 1}, offset=0.3}", path);
  found *f = find(text, 0.02);
  assert_int_equal(f->features.patch_count, 2);
  assert_int_equal(count_pieces(f), 1);
  assert_int_equal(count_degree(f, 2), f->lines.segment_count);
  assert_close(total_length(f), 2 * pi * sqrt(1 - 0.09), 0.05);
  for (size_t i = 0; i < f->lines.point_count; i++) assert_close(v3_dot(f->lines.point[i], v3_unit(v3(0.1, 0.2, 1))), 0.3, 1e-12);
  drop(f);
  fixture_folder_remove(folder);
}

/* ---- random scripts ---- */

static void append(char *text, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));
static void append(char *text, size_t size, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const size_t used = strlen(text);
  vsnprintf(text + used, size - used, format, arguments);
  va_end(arguments);
}

static void write_solid(char *text, size_t size, uint64_t *seed, int depth) {
  const int kind = (int)(random_unit(seed) * (depth > 0 ? 10 : 5));
  const double a = 0.2 + random_unit(seed), b = 0.2 + random_unit(seed), c = 0.2 + random_unit(seed);
  static const char *const joined[] = {"(", "(", "(", "smooth_union(", "shell("};
  static const char *const between[] = {" | ", " & ", " - ", ", ", " | "};
  static const char *const after[] = {")", ")", ")", ", 0.2)", ", 0.05)"};
  if (kind == 0) append(text, size, "box(%.3f, %.3f, %.3f)", a, b, c);
  if (kind == 1) append(text, size, "sphere(%.3f)", a);
  if (kind == 2) append(text, size, "cylinder{r=%.3f, h=%.3f}", a, b);
  if (kind == 3) append(text, size, "cone{r=%.3f, h=%.3f, r2=%.3f}", a, b, random_unit(seed) < 0.5 ? 0 : c);
  if (kind == 4) append(text, size, "torus(%.3f, %.3f)", a, b);
  if (kind >= 5) {
    append(text, size, "%s", joined[kind - 5]);
    write_solid(text, size, seed, depth - 1);
    append(text, size, "%s", between[kind - 5]);
    write_solid(text, size, seed, depth - 1);
    append(text, size, "%s", after[kind - 5]);
  }
  if (random_unit(seed) < 0.5) append(text, size, ":move(%.2f, %.2f, %.2f)", a - 0.7, b - 0.7, c - 0.7);
  if (random_unit(seed) < 0.3) append(text, size, ":rotate(%.1f, {%.2f, 1, %.2f})", 90 * a, b, c);
}

/* Whatever a script makes, the search ends, and what it says fits together. */
static void random_solids_are_survived(void **state) {
  (void)state;
  int solid_count = 0;
  for (uint64_t k = 1; k <= 40; k += (uint64_t)test_stride()) {
    char text[4096] = "";
    uint64_t seed = k;
    write_solid(text, sizeof text, &seed, 4);
    laves_context *context = laves_context_create(NULL);
    laves_domain *domain;
    laves_error error;
    const bool is_solid = laves_domain_from_expression(context, text, &domain, &error) == LAVES_OK;
    if (is_solid) laves_domain_free(domain);
    laves_context_free(context);
    if (!is_solid) continue; /* empty */
    solid_count++;
    found *f = find(text, 0.03);
    for (size_t i = 0; i < f->lines.segment_count; i++) {
      const laves__feature_segment *s = &f->lines.segment[i];
      assert_true(s->ends[0] < f->lines.point_count && s->ends[1] < f->lines.point_count && s->ends[0] != s->ends[1]);
      for (int side = 0; side < 2; side++) assert_in_range(s->patch[side], 0, f->features.patch_count - 1);
      assert_true(s->angle >= 0 && s->angle <= 360 && fabs(180 - s->angle) >= 5);
    }
    for (size_t i = 0; i < f->lines.point_count; i++) {
      double phi;
      f->domain->oracle.evaluate(f->domain->oracle.self, 1, &f->lines.point[i], &phi, NULL);
      if (fabs(phi) > 1e-9 * f->diagonal) fail_msg("%s: phi %g at point %d", text, phi, (int)i);
    }
    drop(f);
  }
  assert_true(solid_count > 20 / test_stride());
}

/* Formulas with jumps, poles and slopes without bound. */
static void random_formulas_are_survived(void **state) {
  (void)state;
  size_t segments = 0;
  for (uint64_t k = 1; k <= 80; k += (uint64_t)test_stride()) {
    laves_context *context = laves_context_create(NULL);
    laves__expression e;
    laves__tape tape;
    laves_error error;
    uint64_t seed = k;
    laves__expression_init(&e, context);
    const laves__node node = random_expression(&e, &seed, 20, k % 2 == 0);
    assert_int_equal(laves__tape_build(&e, node, NULL, &tape, &error), LAVES_OK);
    const laves__box3 bounds = {v3(-3, -3, -3), v3(3, 3, 3)};
    const laves__implicit_solid solid = {.tape = &tape, .bounds = bounds, .diagonal = box3_diagonal(bounds)};
    const laves__feature_wish wish = {.angle = 30, .size = 0.6};
    laves__features features = {.context = context};
    laves__feature_lines lines = {.context = context};
    assert_int_equal(laves__features_of_implicit(&solid, &wish, &features, &lines, &error), LAVES_OK);
    segments += lines.segment_count;
    for (int i = 0; i < 200 && features.self; i++) {
      const laves__vec3 p = random_point(&seed, 3);
      const int32_t patch = features.patch_at(features.self, p, LAVES__NO_HINT);
      assert_in_range(patch, 0, features.patch_count - 1);
      uint32_t hint = (uint32_t)i;
      laves__vec3 foot, normal;
      if (features.project_patch(features.self, patch, p, 1, &hint, &foot, &normal)) assert_true(v3_distance(foot, p) <= 1);
    }
    if (features.free_self) features.free_self(context, features.self);
    laves__feature_lines_free(&lines);
    laves__tape_free(context, &tape);
    laves__expression_free(&e);
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
  assert_true(segments > (test_stride() == 1 ? 1000 : 0)); /* a few formulas may have few */
}

/* Lets everything go on but the search. */
static bool stop_search(void *user, const char *phase, double fraction) {
  (void)fraction;
  const bool is_search = strcmp(phase, "features") == 0;
  *(bool *)user = *(bool *)user || is_search;
  return !is_search;
}

static void searches_can_be_cancelled(void **state) {
  (void)state;
  bool asked = false;
  laves_error error;
  laves_domain *domain;
  laves_context_options options = laves_context_options_default();
  options.progress = stop_search;
  options.progress_user = &asked;
  laves_context *context = laves_context_create(&options);
  assert_int_equal(laves_domain_from_expression(context, "box(1, 1, 1) - sphere(0.6)", &domain, &error), LAVES_OK);
  const laves__feature_wish wish = {.angle = 40, .size = 0.01};
  laves__features features = {.context = context, .oracle = &domain->oracle};
  laves__feature_lines lines = {.context = context};
  assert_int_equal(domain->oracle.find_features(&wish, &features, &lines, &error), LAVES_ERROR_CANCELLED);
  assert_true(asked);
  assert_null(features.self);
  laves__feature_lines_free(&lines);
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

/* Whatever the limit, the search says so or ends well, and gives back what it took. */
static void memory_may_run_short(void **state) {
  (void)state;
  int refused = 0, done = 0;
  for (size_t limit = 40000; limit < 4000000; limit += limit / 3) {
    laves_error error;
    laves_domain *domain;
    laves_context_options options = laves_context_options_default();
    options.memory_limit = limit;
    laves_context *context = laves_context_create(&options);
    if (laves_domain_from_expression(context, "box(1, 1, 1) - sphere(0.6)", &domain, &error) == LAVES_OK) {
      const laves__feature_wish wish = {.angle = 40, .size = 0.03};
      laves__features features = {.context = context, .oracle = &domain->oracle};
      laves__feature_lines lines = {.context = context};
      const laves_result result = domain->oracle.find_features(&wish, &features, &lines, &error);
      assert_true(result == LAVES_OK || result == LAVES_ERROR_MEMORY);
      refused += result == LAVES_ERROR_MEMORY;
      done += result == LAVES_OK;
      if (features.free_self) features.free_self(context, features.self);
      laves__feature_lines_free(&lines);
      laves_domain_free(domain);
    }
    assert_int_equal(laves_context_bytes(context), 0);
    laves_context_free(context);
  }
  assert_true(refused > 2 && done > 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(creases_and_corners_are_all_found),
      cmocka_unit_test(corners_of_a_box_are_exact),
      cmocka_unit_test(notches_turn_inwards),
      cmocka_unit_test(rims_lie_on_both_surfaces),
      cmocka_unit_test(tips_are_corners),
      cmocka_unit_test(feet_lie_on_their_patch),
      cmocka_unit_test(creases_are_refined_to_rounding),
      cmocka_unit_test(runs_are_equal),
      cmocka_unit_test(leaves_meet_the_rest),
      cmocka_unit_test(random_solids_are_survived),
      cmocka_unit_test(random_formulas_are_survived),
      cmocka_unit_test(searches_can_be_cancelled),
      cmocka_unit_test(memory_may_run_short),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
