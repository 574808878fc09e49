/* Certificates: figures known in closed form, exceptions made on purpose, upper bounds of distances that brute force bears out,
 * a file that reads back the same, and lies that are found out. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>

#include "certify/certify.h"
#include "fixtures/folders.h"
#include "fixtures/graded.h"
#include "fixtures/meshes.h"
#include "fixtures/shapes.h"
#include "io/certificate_table.h"

static int set_up(void **state) {
  *state = laves_context_create(NULL);
  return *state == NULL;
}

static int tear_down(void **state) {
  const size_t left = laves_context_bytes(*state);
  laves_context_free(*state);
  return left != 0;
}

static laves_domain *domain_of(laves_context *context, const shape *s) {
  laves_domain *domain = NULL;
  assert_int_equal(
      laves_domain_from_triangles(context, s->points, s->point_count, s->triangles, s->triangle_count, NULL, &domain, NULL),
      LAVES_OK);
  return domain;
}

static void turn_over(laves_mesh *mesh, size_t tet) {
  const int32_t corner = mesh->tets[tet][0];
  mesh->tets[tet][0] = mesh->tets[tet][1];
  mesh->tets[tet][1] = corner;
}

static laves_certificate certify(laves_context *context, const laves_mesh *mesh, const laves_certify_options *options) {
  laves_certificate c;
  laves_error error;
  if (laves_certify(context, mesh, options, &c, &error) != LAVES_OK) fail_msg("%s", error.text);
  return c;
}

/* ---- figures ---- */

/* Kuhn's cubes have angles of 45 to 90 degrees. */
static void cubes_alone(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 3, 2, 2, NULL, NULL);
  const laves_certificate c = certify(*state, mesh, NULL);
  assert_true(c.check.valid);
  assert_false(c.has_input || c.has_options || c.has_promise || c.check.has_distance);
  assert_true(c.promise_holds);
  assert_int_equal(c.check.tets, 72);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_OUTSIDE_ASKED], 0); /* 40..125, and a ratio of 0.65 */
  assert_true(c.attained_min_dihedral < 45 && c.attained_min_dihedral > 45 - 1e-7);
  assert_true(c.attained_max_dihedral > 90 && c.attained_max_dihedral < 90 + 1e-7);
  assert_int_equal(c.exception_count, 0);
  assert_int_equal(strlen(c.mesh_hash), 64);
  laves_mesh_free(mesh);
}

/* A promise is kept by more than the margin or not at all. */
static void promises(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 2, NULL, NULL);
  laves_certify_options options = laves_certify_options_default();
  const struct {
    double least, most;
    size_t outside;
  } windows[] = {{44.9, 90.1, 0}, {45, 90.1, 48}, {44.9, 90, 48}, {45.1, 180, 48}, {0, 89, 48}};
  for (size_t i = 0; i < sizeof windows / sizeof windows[0]; i++) {
    options.promised_min_dihedral = windows[i].least;
    options.promised_max_dihedral = windows[i].most;
    const laves_certificate c = certify(*state, mesh, &options);
    assert_true(c.has_promise);
    assert_int_equal(c.exception_counts[LAVES_EXCEPTION_OUTSIDE_PROMISED], windows[i].outside);
    assert_int_equal(c.promise_holds, windows[i].outside == 0);
    assert_int_equal(c.exception_count, windows[i].outside ? LAVES_PLACE_CAPACITY : 0);
  }
  laves_mesh_free(mesh);
}

/* The hash knows points and tets, not what else a file may keep. */
static void what_the_hash_knows(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 2, NULL, NULL);
  const laves_certificate first = certify(*state, mesh, NULL);
  mesh->lattice_tet_count = 7;
  mesh->points[0].x = -0.0;
  assert_string_equal(certify(*state, mesh, NULL).mesh_hash, first.mesh_hash);
  mesh->points[0].x = 1e-300;
  assert_string_not_equal(certify(*state, mesh, NULL).mesh_hash, first.mesh_hash);
  mesh->points[0].x = 0;
  turn_over(mesh, 3);
  assert_string_not_equal(certify(*state, mesh, NULL).mesh_hash, first.mesh_hash);
  laves_mesh_free(mesh);
}

/* ---- exceptions ---- */

static void inverted_tet(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 2, NULL, NULL);
  turn_over(mesh, 5);
  laves_certify_options options = laves_certify_options_default();
  options.promised_min_dihedral = 14.4;
  laves_certificate c = certify(*state, mesh, &options);
  assert_false(c.check.valid || c.promise_holds);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_INVERTED_TET], 1);
  assert_int_equal(c.exceptions[0].kind, LAVES_EXCEPTION_INVERTED_TET);
  assert_int_equal(c.exceptions[0].index, 5);
  laves_mesh_free(mesh);
}

/* Without a promise, nothing is broken, and what was written is found again. */
static void invalid_without_a_promise(void **state) {
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/a.json", folder);
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 2, NULL, NULL);
  turn_over(mesh, 5);
  const laves_certificate c = certify(*state, mesh, NULL);
  assert_false(c.check.valid);
  assert_true(c.promise_holds);
  laves_certificate read;
  laves_difference differences[8];
  size_t count;
  assert_int_equal(laves_certificate_write(*state, &c, path, NULL), LAVES_OK);
  assert_int_equal(laves_certificate_read(*state, path, &read, NULL), LAVES_OK);
  assert_int_equal(laves_certificate_verify(*state, mesh, NULL, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  if (count) fail_msg("%s", differences[0].text);
  laves_mesh_free(mesh);
  fixture_folder_remove(folder);
}

static bool diagonal(void *user, int x, int y, int z) {
  (void)user;
  (void)z;
  return x == y;
}

static void nonmanifold_places(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 1, diagonal, NULL);
  const laves_certificate c = certify(*state, mesh, NULL);
  assert_false(c.check.valid);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_NONMANIFOLD_EDGE], 1);
  assert_int_equal(c.exceptions[0].kind, LAVES_EXCEPTION_NONMANIFOLD_EDGE);
  assert_float_equal(c.exceptions[0].place[0], 1, 1e-12);
  assert_float_equal(c.exceptions[0].place[1], 1, 1e-12);
  assert_float_equal(c.exceptions[0].place[2], 0.5, 1e-12);
  laves_mesh_free(mesh);
}

/* A cube against a cube that is a tenth wider: every boundary vertex is off, by 0.05 to sqrt(3) 0.05. */
static void off_the_surface(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 2, 2, 2, NULL, NULL);
  shape box = shape_box((const double[3]){-0.05, -0.05, -0.05}, (const double[3]){2.05, 2.05, 2.05}, 1);
  laves_domain *domain = domain_of(*state, &box);
  laves_certify_options options = laves_certify_options_default();
  options.domain = domain;
  const laves_certificate c = certify(*state, mesh, &options);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_OFF_SURFACE], 26);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_DISTANT], 0);
  assert_float_equal(c.check.to_surface_max, 0.05, 1e-12);
  assert_true(c.check.from_surface_max <= sqrt(3) * 0.05 && c.check.from_surface_at_most >= sqrt(3) * 0.05);
  assert_int_equal(c.exceptions[0].kind, LAVES_EXCEPTION_OFF_SURFACE);
  assert_float_equal(c.exceptions[0].value, 0.05, 1e-12);
  assert_true(c.has_input && strcmp(c.input_kind, "surface") == 0 && c.input_hash[0] == 0);
  laves_domain_free(domain);
  shape_free(&box);
  laves_mesh_free(mesh);
}

/* A plate of half a size, meshed with cubes of its thickness: thin is told as the cause. */
static void causes(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 6, 6, 1, NULL, NULL);
  for (size_t v = 0; v < mesh->vertex_count; v++) mesh->points[v].z *= 0.2;
  shape plate = shape_box((const double[3]){0, 0, 0}, (const double[3]){6, 6, 0.2}, 1);
  laves_domain *domain = domain_of(*state, &plate);
  laves_certify_options options = laves_certify_options_default();
  options.domain = domain;
  const laves_certificate c = certify(*state, mesh, &options);
  assert_true(c.exception_counts[LAVES_EXCEPTION_OUTSIDE_ASKED] > 100);
  assert_true(c.exception_counts[LAVES_EXCEPTION_THIN] > 0);
  for (size_t i = 0; i < c.exception_count; i++) assert_int_equal(c.exceptions[i].cause, LAVES_CAUSE_THIN);
  laves_domain_free(domain);
  shape_free(&plate);
  laves_mesh_free(mesh);
}

/* ---- upper bounds ---- */

static double random_unit(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / 9007199254740992.0;
}

/* No point of a triangle is further from its corners than the cover, and some point nearly is. */
static void cover_of_corners(void **state) {
  uint64_t seed = 7;
  (void)state;
  for (int i = 0; i < 300; i++) {
    laves__vec3 p[3];
    for (int k = 0; k < 3; k++) p[k] = v3(random_unit(&seed), random_unit(&seed), (i % 3 ? 1 : 0.01) * random_unit(&seed));
    const double cover = laves__corner_cover(p[0], p[1], p[2]);
    double furthest = 0;
    enum { STEPS = 60 };
    for (int u = 0; u <= STEPS; u++)
      for (int v = 0; u + v <= STEPS; v++) {
        const laves__vec3 q = v3_add(v3_scale(p[0], 1 - (u + v) / (double)STEPS),
                                     v3_add(v3_scale(p[1], u / (double)STEPS), v3_scale(p[2], v / (double)STEPS)));
        furthest = fmax(furthest, fmin(v3_distance(q, p[0]), fmin(v3_distance(q, p[1]), v3_distance(q, p[2]))));
      }
    assert_true(furthest <= cover * (1 + 1e-12));
    assert_true(furthest >= cover - 2.0 / STEPS);
  }
  assert_true(laves__corner_cover(v3(0, 0, 0), v3(0, 0, 0), v3(0, 0, 0)) == 0);
  assert_float_equal(laves__corner_cover(v3(0, 0, 0), v3(2, 0, 0), v3(1, 0, 0)), 0.5, 1e-12);
}

/* Distances of points that no sample is near, by a surface of slivers and by one of tiny faces, lie below the bound. */
static void bounds_hold(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 6, 1);
  const int counts[] = {1, 9};
  uint64_t seed = 3;
  for (size_t i = 0; i < 2; i++) {
    shape box = shape_box((const double[3]){-1, -0.7, -0.6}, (const double[3]){1.2, 0.8, 0.7}, counts[i]);
    laves_domain *domain = domain_of(*state, &box);
    laves_check check;
    assert_int_equal(laves_check_mesh(*state, mesh, domain, &check, NULL), LAVES_OK);
    assert_true(check.to_surface_at_most >= check.to_surface_max && check.from_surface_at_most >= check.from_surface_max);
    assert_true(check.from_surface_cover <= 0.31 * check.edge_mean * 2);
    double furthest = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
      for (int k = 0; k < 40; k++) {
        const double a = random_unit(&seed), b = random_unit(&seed) * (1 - a);
        const laves__vec3 *p = mesh->points;
        const int32_t *face = mesh->faces[f];
        const laves__vec3 q = v3_add(v3_scale(p[face[0]], 1 - a - b), v3_add(v3_scale(p[face[1]], a), v3_scale(p[face[2]], b)));
        double phi;
        laves_domain_evaluate(domain, &q.x, 1, &phi);
        furthest = fmax(furthest, fabs(phi));
      }
    assert_true(furthest <= check.to_surface_at_most && furthest > 0.8 * check.to_surface_max);
    laves_domain_free(domain);
    shape_free(&box);
  }
  laves_mesh_free(mesh);
}

/* What samples of an implicit surface must not miss: walls on which the gradient vanishes, and a plate of a fifth of their
 * distance that a ball has where its mesh has none. */
static void implicit_surfaces(void **state) {
  static const struct {
    const char *expression;
    double least, most; /* of the largest distance from the surface */
  } cases[] = {{"box(2, 2, 2)", 0.69, 0.74},
               {"sphere(1) + box(0.02, 0.8, 0.8):move(1.6, 0, 0)", 0.6, 0.85},
               {"sphere(1) + box(0.8, 0.02, 0.8):move(0, 0, 1.4) - sphere(0.999)", 0.7, 0.99}};
  laves_mesh *mesh = fixture_ball(*state, 6, 1);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    laves_domain *domain;
    laves_check check;
    assert_int_equal(laves_domain_from_expression(*state, cases[i].expression, &domain, NULL), LAVES_OK);
    assert_int_equal(laves_check_mesh(*state, mesh, domain, &check, NULL), LAVES_OK);
    if (!(check.from_surface_max >= cases[i].least && check.from_surface_max <= cases[i].most))
      fail_msg("%s: %g", cases[i].expression, check.from_surface_max);
    assert_true(isnan(check.from_surface_at_most));
    laves_domain_free(domain);
  }
  laves_mesh_free(mesh);
}

/* The bound from the mesh to an implicit surface holds, though feet come from iteration. */
static void bound_of_iterated_feet(void **state) {
  laves_mesh *mesh = fixture_ball(*state, 6, 1.05);
  laves_domain *domain;
  laves_check check;
  assert_int_equal(laves_domain_from_expression(*state, "sphere(1)", &domain, NULL), LAVES_OK);
  assert_int_equal(laves_check_mesh(*state, mesh, domain, &check, NULL), LAVES_OK);
  assert_float_equal(check.to_surface_max, 0.05, 1e-9);
  assert_true(check.to_surface_at_most >= check.to_surface_max);
  assert_true(check.to_surface_at_most <= check.to_surface_max + check.to_surface_cover + 1e-5 * check.edge_mean);
  laves_domain_free(domain);
  laves_mesh_free(mesh);
}

/* ---- files ---- */

/* Compares all members by the table, so that none is forgotten. */
static void assert_same(const laves_certificate *a, const laves_certificate *b) {
  for (size_t i = 0; i < laves__certificate_member_count; i++) {
    const laves__member *m = &laves__certificate_members[i];
    const char *x = (const char *)a + m->offset, *y = (const char *)b + m->offset;
    switch (m->kind) {
      case LAVES__MEMBER_TEXT:
        assert_string_equal(x, y);
        break;
      case LAVES__MEMBER_NUMBER:
        for (size_t k = 0; k < m->count; k++) {
          const double u = ((const double *)x)[k], v = ((const double *)y)[k];
          if (u != v && !(isnan(u) && isnan(v))) fail_msg("%s.%s: %.17g and %.17g", m->group, m->name, u, v);
        }
        break;
      case LAVES__MEMBER_LATER:
      case LAVES__MEMBER_COUNT:
        assert_memory_equal(x, y, m->count * sizeof(size_t));
        break;
      case LAVES__MEMBER_INTEGER:
        assert_int_equal(*(const int64_t *)x, *(const int64_t *)y);
        break;
      case LAVES__MEMBER_LATER_NUMBER:
        assert_true(*(const double *)x == *(const double *)y);
        break;
      case LAVES__MEMBER_FLAG:
      case LAVES__MEMBER_LATER_FLAG:
        assert_int_equal(*(const bool *)x, *(const bool *)y);
        break;
      default:
        assert_memory_equal(x, y, sizeof(int));
    }
  }
  assert_int_equal(a->exception_count, b->exception_count);
  assert_memory_equal(a->exception_counts, b->exception_counts, sizeof a->exception_counts);
}

/* A made mesh with all groups of members: write, read, compare, verify. */
static void through_a_file(void **state) {
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/a.json", folder);
  const char *expression = "sphere(1) - box(0.4, 3, 0.4)";
  laves_domain *domain;
  laves_mesh *mesh;
  laves_report report;
  laves_certificate read;
  assert_int_equal(laves_domain_from_expression(*state, expression, &domain, NULL), LAVES_OK);
  laves_options made = laves_options_default();
  made.size = 0.2;
  assert_int_equal(laves_generate(*state, domain, &made, &mesh, &report, NULL), LAVES_OK);
  laves_certify_options options = laves_certify_options_default();
  options.domain = domain;
  options.input = expression;
  options.options = &made;
  options.report = &report;
  const laves_certificate c = certify(*state, mesh, &options);
  assert_true(c.check.valid && c.has_options && c.has_input && c.check.has_distance);
  assert_true(c.lattice_tets >= report.lattice_tets);
  assert_float_equal(c.lattice_size, report.size, 1e-9);
  assert_string_equal(c.input_name, expression);

  assert_int_equal(laves_certificate_write(*state, &c, path, NULL), LAVES_OK);
  assert_int_equal(laves_certificate_read(*state, path, &read, NULL), LAVES_OK);
  assert_same(&c, &read);
  laves_difference differences[8];
  size_t count;
  assert_int_equal(laves_certificate_verify(*state, mesh, domain, expression, &read, differences, 8, &count, NULL), LAVES_OK);
  if (count) fail_msg("%s", differences[0].text);

  read.check.genus = 7;
  read.check.volume *= 1.001;
  read.promise_holds = !read.promise_holds;
  assert_int_equal(laves_certificate_verify(*state, mesh, NULL, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  assert_int_equal(count, 3);
  assert_string_equal(differences[0].text, "topology.genus: the certificate says 7, and it is 1");
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  fixture_folder_remove(folder);
}

/* Takes the lines of a file that have a word out. */
static void drop_lines(const char *path, const char *word) {
  char kept[60000], line[2000];
  size_t length = 0;
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) {
    if (strstr(line, word)) continue;
    assert_true(length + strlen(line) < sizeof kept);
    memcpy(kept + length, line, strlen(line));
    length += strlen(line);
  }
  fclose(file);
  file = fopen(path, "w");
  assert_non_null(file);
  assert_int_equal(fwrite(kept, 1, length, file), length);
  fclose(file);
}

/* What was asked of features stands in the file; files of versions that knew of none are read, and say that none were kept. */
static void features_asked(void **state) {
  static const char *const words[] = {"\"feature_angle\"", "\"feature_tags\"", "\"keep_thin\""};
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  laves_mesh *mesh = fixture_cubes(*state, 1, 1, 1, NULL, NULL);
  laves_options made = laves_options_default();
  laves_certificate read;
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/a.json", folder);
  made.feature_angle = 25;
  made.feature_tags = true;
  laves_report report = {.size = 1};
  laves_certify_options options = laves_certify_options_default();
  options.options = &made;
  options.report = &report;
  const laves_certificate c = certify(*state, mesh, &options);
  assert_int_equal(laves_certificate_write(*state, &c, path, NULL), LAVES_OK);
  assert_int_equal(laves_certificate_read(*state, path, &read, NULL), LAVES_OK);
  assert_true(read.options.feature_angle == 25 && read.options.feature_tags && read.options.keep_thin);
  for (size_t i = 0; i < LAVES__COUNT_OF(words); i++) drop_lines(path, words[i]);
  assert_int_equal(laves_certificate_read(*state, path, &read, NULL), LAVES_OK);
  assert_true(read.options.feature_angle == 0 && !read.options.feature_tags && !read.options.keep_thin);
  laves_mesh_free(mesh);
  fixture_folder_remove(folder);
}

/* The tiles of a graded mesh stand in the file; forged counts are found out, and older files, which lack one, are read. */
static void graded_tiles(void **state) {
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/a.json", folder);
  size_t tiles[3], count;
  laves_mesh *mesh = fixture_graded(*state, tiles);
  const laves_certificate c = certify(*state, mesh, NULL);
  laves_certificate read;
  laves_difference differences[8];
  assert_true(c.check.inverted_tets == 0 && c.lattice_tets > 0 && c.bcc_tets > 0);
  assert_int_equal(laves_certificate_write(*state, &c, path, NULL), LAVES_OK);
  assert_int_equal(laves_certificate_read(*state, path, &read, NULL), LAVES_OK);
  assert_same(&c, &read);
  assert_int_equal(laves_certificate_verify(*state, mesh, NULL, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  assert_int_equal(count, 0);

  read.lattice_tets++;
  read.bcc_tets--;
  read.lattice_size *= 2;
  assert_int_equal(laves_certificate_verify(*state, mesh, NULL, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  assert_int_equal(count, 3);
  assert_non_null(strstr(differences[1].text, "tiles.bcc_tets: the certificate says "));

  read = c;
  read.bcc_tets = SIZE_MAX;
  assert_int_equal(laves_certificate_write(*state, &read, path, NULL), LAVES_OK);
  assert_int_equal(laves_certificate_read(*state, path, &read, NULL), LAVES_OK);
  assert_true(read.bcc_tets == SIZE_MAX);
  assert_int_equal(laves_certificate_verify(*state, mesh, NULL, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  assert_int_equal(count, 0);
  laves_mesh_free(mesh);
  fixture_folder_remove(folder);
}

/* ---- command ---- */

static laves_certificate certify_command(laves_context *context, const laves_mesh *mesh, const char *const *words, int count) {
  laves_certify_options options = laves_certify_options_default();
  options.command = words;
  options.command_count = count;
  return certify(context, mesh, &options);
}

/* The words of a command go through a file as they are, whole or not at all. */
static void commands(void **state) {
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  static char long_word[LAVES_COMMAND_CAPACITY];
  static const char *many[LAVES_COMMAND_WORDS + 1];
  static const char *const words[] = {"laves", "mesh", "", "a \"b\"\\\n", "\xc3\xa9"};
  static const char bytes[] = "laves\0mesh\0\0a \"b\"\\\n\0\xc3\xa9";
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/a.json", folder);
  laves_mesh *mesh = fixture_cubes(*state, 1, 1, 1, NULL, NULL);
  const laves_certificate c = certify_command(*state, mesh, words, 5);
  laves_certificate read;
  assert_int_equal(laves_certificate_write(*state, &c, path, NULL), LAVES_OK);
  assert_int_equal(laves_certificate_read(*state, path, &read, NULL), LAVES_OK);
  assert_int_equal(read.command_count, 5);
  assert_memory_equal(read.command, bytes, sizeof bytes);

  for (int i = 0; i <= LAVES_COMMAND_WORDS; i++) many[i] = "w";
  assert_int_equal(certify_command(*state, mesh, many, LAVES_COMMAND_WORDS).command_count, LAVES_COMMAND_WORDS);
  assert_int_equal(certify_command(*state, mesh, many, LAVES_COMMAND_WORDS + 1).command_count, 0);
  memset(long_word, 'x', sizeof long_word - 1);
  assert_int_equal(certify_command(*state, mesh, (const char *[]){long_word}, 1).command_count, 1);
  const laves_certificate cut = certify_command(*state, mesh, (const char *[]){"a", long_word}, 2);
  assert_int_equal(cut.command_count, 0);
  assert_int_equal(cut.command[0], 0);
  assert_int_equal(certify_command(*state, mesh, (const char *[]){"a", "\xe9"}, 2).command_count, 0);
  laves_mesh_free(mesh);
  fixture_folder_remove(folder);
}

/* ---- features ---- */

static laves_certificate certify_features(laves_context *context, const laves_mesh *mesh, const laves_domain *domain,
                                          double angle, double least) {
  laves_certify_options options = laves_certify_options_default();
  options.domain = domain;
  options.feature_angle = angle;
  options.min_dihedral = least;
  return certify(context, mesh, &options);
}

static laves_domain *cube_domain(laves_context *context) {
  shape box = shape_box((const double[3]){0, 0, 0}, (const double[3]){4, 4, 4}, 2);
  laves_domain *domain = domain_of(context, &box);
  shape_free(&box);
  return domain;
}

/* The first exception of a kind; there must be one. */
static const laves_exception *exception_of(const laves_certificate *c, laves_exception_kind kind) {
  for (size_t i = 0; i < c->exception_count; i++)
    if (c->exceptions[i].kind == kind) return &c->exceptions[i];
  fail_msg("no exception %s", laves_exception_key(kind));
  return NULL;
}

static void kept_features(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 4, 4, 4, NULL, NULL);
  laves_domain *domain = cube_domain(*state);
  laves_certificate c = certify_features(*state, mesh, domain, 40, 40);
  assert_true(c.has_features && !c.features_tags && !c.features_drawn);
  assert_int_equal(c.features.creases_kept, 12);
  assert_int_equal(c.features.corners_kept, 8);
  assert_float_equal(c.features.kept_share, 1, 1e-12);
  assert_int_equal(c.exception_count, 0);
  c = certify_features(*state, mesh, domain, 0, 40);
  assert_false(c.has_features);
  c = certify_features(*state, mesh, domain, 120, 40); /* no edge, but each point of the cube is a tip */
  assert_true(c.has_features && c.features.creases == 0 && c.features.corners == 8);
  laves_certify_options wrong = laves_certify_options_default();
  laves_error error;
  wrong.domain = domain;
  wrong.feature_angle = 500;
  assert_int_equal(laves_certify(*state, mesh, &wrong, &c, &error), LAVES_ERROR_OPTION);
  laves_domain_free(domain);
  laves_mesh_free(mesh);
}

/* A corner pushed in takes three creases along; what is stated of it goes through a file, and forgeries are found out. */
static void lost_features(void **state) {
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/a.json", folder);
  laves_mesh *mesh = fixture_cubes(*state, 4, 4, 4, NULL, NULL);
  laves_domain *domain = cube_domain(*state);
  mesh->points[0] = v3(0.25, 0.25, 0.25);
  const laves_certificate c = certify_features(*state, mesh, domain, 40, 40);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_CREASE_LOST], 3);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_CORNER_LOST], 1);
  const laves_exception *crease = exception_of(&c, LAVES_EXCEPTION_CREASE_LOST);
  assert_float_equal(crease->crease_angle, 90, 1e-4);
  assert_float_equal(crease->value, c.features.to_mesh_max, 1e-12);
  assert_float_equal(crease->limit, c.features.tolerance, 0);
  assert_int_equal(crease->cause, LAVES_CAUSE_UNKNOWN);
  assert_true(isnan(exception_of(&c, LAVES_EXCEPTION_CORNER_LOST)->crease_angle));

  laves_certificate read;
  laves_difference differences[8];
  size_t count;
  assert_int_equal(laves_certificate_write(*state, &c, path, NULL), LAVES_OK);
  assert_int_equal(laves_certificate_read(*state, path, &read, NULL), LAVES_OK);
  assert_same(&c, &read);
  assert_int_equal(laves_certificate_verify(*state, mesh, domain, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  if (count) fail_msg("%s", differences[0].text);
  read.features.creases_kept = 12;
  read.exception_counts[LAVES_EXCEPTION_CORNER_LOST] = 0;
  assert_int_equal(laves_certificate_verify(*state, mesh, domain, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  assert_int_equal(count, 2);
  assert_string_equal(differences[0].text, "features.creases_kept: the certificate says 12, and it is 9");
  /* Without the surface, or with features that somebody drew, nothing of it can be told. */
  assert_int_equal(laves_certificate_verify(*state, mesh, NULL, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  assert_int_equal(count, 0);
  read.features_drawn = true;
  assert_int_equal(laves_certificate_verify(*state, mesh, domain, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  assert_int_equal(count, 0);
  /* An angle that none can have asked for. */
  read = c;
  read.features.angle = NAN;
  assert_int_equal(laves_certificate_verify(*state, mesh, domain, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  assert_true(count > 0);
  laves_domain_free(domain);
  laves_mesh_free(mesh);
  fixture_folder_remove(folder);
}

/* Half a cube: two of its edges are 45 degrees wide, which is less than the 50 that are asked for. */
static void sharp_input(void **state) {
  static const double points[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  static const uint32_t triangles[8][3] = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                                           {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  static const int32_t tets[3][4] = {{0, 1, 2, 3}, {1, 2, 3, 4}, {2, 5, 3, 4}};
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  assert_int_equal(laves_domain_from_triangles(*state, points[0], 6, triangles[0], 8, NULL, &domain, NULL), LAVES_OK);
  assert_int_equal(laves_mesh_from_arrays(*state, points[0], 6, tets[0], 3, NULL, &mesh, NULL), LAVES_OK);
  laves_certificate c = certify_features(*state, mesh, domain, 40, 50);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_SHARP_INPUT], 2);
  const laves_exception *sharp = exception_of(&c, LAVES_EXCEPTION_SHARP_INPUT);
  assert_int_equal(sharp->cause, LAVES_CAUSE_CREASE);
  assert_float_equal(sharp->value, 45, 1e-4);
  assert_float_equal(sharp->limit, 50, 0);
  const laves_exception *outside = exception_of(&c, LAVES_EXCEPTION_OUTSIDE_ASKED);
  assert_int_equal(outside->cause, LAVES_CAUSE_CREASE);
  assert_float_equal(outside->crease_angle, 45, 1e-4);
  c = certify_features(*state, mesh, domain, 40, 40);
  assert_int_equal(c.exception_counts[LAVES_EXCEPTION_SHARP_INPUT], 0);
  laves_domain_free(domain);
  laves_mesh_free(mesh);
}

/* Cuts the text from one place to just before another. */
static void cut(char *text, const char *from, const char *to) {
  char *start = strstr(text, from);
  assert_non_null(start);
  char *end = strstr(start, to);
  assert_non_null(end);
  memmove(start, end, strlen(end) + 1);
}

/* Certificates of before features were measured: without their group, their counts and their angles. */
static void older_certificates(void **state) {
  static char text[1 << 16];
  char folder[FIXTURE_FOLDER_MAX], path[FIXTURE_FOLDER_MAX + 20];
  assert_true(fixture_folder_make(folder));
  snprintf(path, sizeof path, "%s/a.json", folder);
  laves_mesh *mesh = fixture_cubes(*state, 4, 4, 4, NULL, NULL);
  laves_domain *domain = cube_domain(*state);
  mesh->points[0] = v3(0.25, 0.25, 0.25);
  const laves_certificate c = certify_features(*state, mesh, domain, 0, 50);
  laves_certificate read;
  laves_difference differences[8];
  size_t count;
  assert_int_equal(laves_certificate_write(*state, &c, path, NULL), LAVES_OK);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = 0;
  fclose(file);
  cut(text, "\"features\"", "\"input\"");
  cut(text, ",\n      \"crease_lost\"", "\n    }");
  while (strstr(text, ", \"crease_angle\"")) cut(text, ", \"crease_angle\"", "}");
  laves_error error = {0};
  if (laves__certificate_parse(*state, text, strlen(text), "old.json", &read, &error) != LAVES_OK) fail_msg("%s", error.text);
  assert_false(read.has_features);
  assert_int_equal(read.exception_counts[LAVES_EXCEPTION_CREASE_LOST], 0);
  assert_true(read.exception_count > 0 && isnan(read.exceptions[0].crease_angle));
  assert_int_equal(laves_certificate_verify(*state, mesh, domain, NULL, &read, differences, 8, &count, NULL), LAVES_OK);
  if (count) fail_msg("%s", differences[0].text);
  laves_domain_free(domain);
  laves_mesh_free(mesh);
  fixture_folder_remove(folder);
}

/* A text that ends amid a character of two bytes is cut before it. */
static void long_expressions(void **state) {
  char text[400] = "sphere(1) --";
  while (strlen(text) < 380) strcat(text, "\u00e4");
  laves_domain *domain;
  laves_mesh *mesh = fixture_cubes(*state, 1, 1, 1, NULL, NULL);
  assert_int_equal(laves_domain_from_expression(*state, text, &domain, NULL), LAVES_OK);
  laves_certify_options options = laves_certify_options_default();
  options.domain = domain;
  options.input = text;
  options.distances = false;
  const laves_certificate c = certify(*state, mesh, &options);
  assert_false(c.check.has_distance);
  assert_int_equal(strlen(c.input_name) % 2, 0);
  assert_memory_equal(c.input_name, text, strlen(c.input_name));
  laves_domain_free(domain);
  laves_mesh_free(mesh);
}

static void assert_refused(laves_context *context, const char *json, const char *sentence) {
  laves_certificate c;
  laves_error error = {0};
  assert_int_equal(laves__certificate_parse(context, json, strlen(json), "a.json", &c, &error), LAVES_ERROR_INPUT);
  if (!strstr(error.text, sentence)) fail_msg("'%s' is not in '%s'", sentence, error.text);
}

static void refused_files(void **state) {
  assert_refused(*state, "", "a.json:");
  assert_refused(*state, "[1]", "'certificate' is not \"laves\"");
  assert_refused(*state, "{\"certificate\": \"laves\"}", "the member 'schema' must be a whole number");
  assert_refused(*state, "{\"certificate\": \"laves\", \"schema\": 99}", "has schema 99");
  assert_refused(*state, "{\"certificate\": \"laves\", \"schema\": 1, \"version\": \"1\"}", "the member 'mesh' is missing");
  assert_refused(*state, "{\"certificate\": \"laves\", \"schema\": 1, \"version\": \"1\", \"mesh\": {\"sha256\": 5}}",
                 "the member 'mesh.sha256' must be a text");
  assert_refused(*state, "{\"a\": 1, \"a\": 2}", "it is no JSON");
}

static void options_of_ones_own(void **state) {
  laves_mesh *mesh = fixture_cubes(*state, 1, 1, 1, NULL, NULL);
  const laves_certify_options wrong = {0};
  laves_certificate c;
  laves_error error;
  assert_int_equal(laves_certify(*state, mesh, &wrong, &c, &error), LAVES_ERROR_OPTION);
  assert_string_equal(laves_exception_key(LAVES_EXCEPTION_THIN), "thin");
  assert_string_equal(laves_exception_key((laves_exception_kind)99), "unknown");
  assert_string_equal(laves_cause_key(LAVES_CAUSE_CREASE), "crease");
  laves_mesh_free(mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(cubes_alone, set_up, tear_down),
      cmocka_unit_test_setup_teardown(promises, set_up, tear_down),
      cmocka_unit_test_setup_teardown(what_the_hash_knows, set_up, tear_down),
      cmocka_unit_test_setup_teardown(inverted_tet, set_up, tear_down),
      cmocka_unit_test_setup_teardown(invalid_without_a_promise, set_up, tear_down),
      cmocka_unit_test_setup_teardown(nonmanifold_places, set_up, tear_down),
      cmocka_unit_test_setup_teardown(off_the_surface, set_up, tear_down),
      cmocka_unit_test_setup_teardown(causes, set_up, tear_down),
      cmocka_unit_test_setup_teardown(cover_of_corners, set_up, tear_down),
      cmocka_unit_test_setup_teardown(bounds_hold, set_up, tear_down),
      cmocka_unit_test_setup_teardown(implicit_surfaces, set_up, tear_down),
      cmocka_unit_test_setup_teardown(bound_of_iterated_feet, set_up, tear_down),
      cmocka_unit_test_setup_teardown(through_a_file, set_up, tear_down),
      cmocka_unit_test_setup_teardown(features_asked, set_up, tear_down),
      cmocka_unit_test_setup_teardown(graded_tiles, set_up, tear_down),
      cmocka_unit_test_setup_teardown(commands, set_up, tear_down),
      cmocka_unit_test_setup_teardown(kept_features, set_up, tear_down),
      cmocka_unit_test_setup_teardown(lost_features, set_up, tear_down),
      cmocka_unit_test_setup_teardown(sharp_input, set_up, tear_down),
      cmocka_unit_test_setup_teardown(older_certificates, set_up, tear_down),
      cmocka_unit_test_setup_teardown(long_expressions, set_up, tear_down),
      cmocka_unit_test_setup_teardown(refused_files, set_up, tear_down),
      cmocka_unit_test_setup_teardown(options_of_ones_own, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
