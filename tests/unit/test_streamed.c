/* A streamed mesh has the bytes of the one in memory, whoever reads which range of it, and in every file; it takes less memory;
 * and what needs all of it at once refuses it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
/* cmocka.h wants the headers above. */
#include <cmocka.h>
#include <laves/laves.h>

#include "fixtures/folders.h"
#include "fixtures/stride.h"

static char folder[FIXTURE_FOLDER_MAX];

static laves_context *make_context(int threads) {
  laves_context_options options = laves_context_options_default();
  options.thread_count = threads;
  laves_context *context = laves_context_create(&options);
  assert_non_null(context);
  return context;
}

static int set_up(void **state) {
  (void)state;
  return fixture_folder_make(folder) ? 0 : -1;
}

static int tear_down(void **state) {
  (void)state;
  fixture_folder_remove(folder);
  return 0;
}

/* Smooth, with creases and corners, with tags, with walls thinner than the size (whose vertices are parted), and stuffed. */
typedef struct solid {
  const char *text;
  int64_t tets;
  laves_method method;
} solid;

static const solid solids[] = {
    {"sphere(1)", 9000, LAVES_METHOD_AUTO},
    {"box(1, 0.8, 0.6) - cylinder{r=0.2, h=2}", 7000, LAVES_METHOD_AUTO},
    {"tag('outer', sphere(1)) - tag('inner', sphere(0.5))", 7000, LAVES_METHOD_AUTO},
    {"sphere(1) - sphere(0.97)", 4000, LAVES_METHOD_AUTO},
    {"sphere(1)", 5000, LAVES_METHOD_STUFF},
};
enum { SOLIDS = sizeof solids / sizeof solids[0] };

/* Slow tools take every other solid where meshing takes longer than what is tried of the mesh. */
static int solid_step(void) { return test_stride() > 1 ? 2 : 1; }

static laves_domain *make_domain(laves_context *context, const char *text) {
  laves_domain *domain = NULL;
  laves_error error = {0};
  if (laves_domain_from_expression(context, text, &domain, &error) != LAVES_OK) fail_msg("%s: %s", text, error.text);
  return domain;
}

static laves_options options_for(const solid *s, bool streamed) {
  laves_options options = laves_options_default();
  options.tet_target = s->tets;
  options.method = s->method;
  options.streamed = streamed;
  return options;
}

static laves_mesh *make_mesh(laves_context *context, const laves_domain *domain, const solid *s, bool streamed) {
  const laves_options options = options_for(s, streamed);
  laves_mesh *mesh = NULL;
  laves_error error = {0};
  const laves_result result = laves_generate(context, domain, &options, &mesh, NULL, &error);
  if (result != LAVES_OK && result != LAVES_TARGET_MISSED) fail_msg("%s: %s", s->text, error.text);
  return mesh;
}

typedef struct pair {
  laves_context *context;
  laves_domain *domain;
  laves_mesh *whole, *streamed;
} pair;

static pair make_pair(const solid *s, int threads) {
  pair p = {.context = make_context(threads)};
  p.domain = make_domain(p.context, s->text);
  p.whole = make_mesh(p.context, p.domain, s, false);
  p.streamed = make_mesh(p.context, p.domain, s, true);
  return p;
}

static void free_pair(pair *p) {
  laves_mesh_free(p->whole);
  laves_mesh_free(p->streamed);
  laves_domain_free(p->domain);
  assert_int_equal(laves_context_bytes(p->context), 0);
  laves_context_free(p->context);
}

static void same_as_in_memory(void **state) {
  (void)state;
  for (int i = 0; i < SOLIDS; i++) {
    pair p = make_pair(&solids[i], 1 + i % 3);
    assert_true(laves_mesh_is_streamed(p.streamed) && !laves_mesh_is_streamed(p.whole));
    assert_null(laves_mesh_points(p.streamed));
    assert_null(laves_mesh_tets(p.streamed));
    assert_int_equal(laves_mesh_vertex_count(p.streamed), laves_mesh_vertex_count(p.whole));
    assert_int_equal(laves_mesh_tet_count(p.streamed), laves_mesh_tet_count(p.whole));
    assert_int_equal(laves_mesh_lattice_tet_count(p.streamed), laves_mesh_lattice_tet_count(p.whole));
    char a[33], b[33];
    laves_mesh_hash(p.whole, a);
    laves_mesh_hash(p.streamed, b);
    assert_string_equal(a, b);
    free_pair(&p);
  }
}

/* A number below `limit`, the same in every run. */
static size_t draw(uint64_t *state, size_t limit) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (size_t)(*state >> 33) % limit;
}

static void any_range_may_be_read(void **state) {
  (void)state;
  enum { RANGES = 150 };
  static const size_t longest[] = {3, 300, 20000};
  for (int i = 0; i < SOLIDS; i += solid_step()) {
    pair p = make_pair(&solids[i], 2);
    uint64_t seed = 7;
    for (int k = 0; k < RANGES; k++) {
      const size_t vertices = laves_mesh_vertex_count(p.whole), tets = laves_mesh_tet_count(p.whole), most = longest[k % 3];
      size_t first = draw(&seed, vertices + 1), count = draw(&seed, most);
      if (count > vertices - first) count = vertices - first;
      double *points = malloc((3 * count + 1) * sizeof *points);
      assert_int_equal(laves_mesh_read_points(p.streamed, first, count, points, NULL), LAVES_OK);
      assert_memory_equal(points, laves_mesh_points(p.whole) + 3 * first, 3 * count * sizeof *points);
      free(points);
      first = draw(&seed, tets + 1), count = draw(&seed, most);
      if (count > tets - first) count = tets - first;
      int32_t *corners = malloc((4 * count + 1) * sizeof *corners);
      assert_int_equal(laves_mesh_read_tets(p.streamed, first, count, corners, NULL), LAVES_OK);
      assert_memory_equal(corners, laves_mesh_tets(p.whole) + 4 * first, 4 * count * sizeof *corners);
      free(corners);
    }
    free_pair(&p);
  }
}

static void ranges_end_with_the_mesh(void **state) {
  (void)state;
  pair p = make_pair(&solids[4], 1);
  const laves_mesh *const meshes[] = {p.whole, p.streamed};
  for (int i = 0; i < 2; i++) {
    const size_t tets = laves_mesh_tet_count(meshes[i]);
    int32_t corners[4];
    double point[3];
    laves_error error = {0};
    assert_int_equal(laves_mesh_read_tets(meshes[i], tets - 1, 1, corners, &error), LAVES_OK);
    assert_int_equal(laves_mesh_read_tets(meshes[i], tets, 1, corners, &error), LAVES_ERROR_OPTION);
    assert_non_null(strstr(error.text, "the mesh has"));
    assert_int_equal(laves_mesh_read_tets(meshes[i], SIZE_MAX, 2, corners, &error), LAVES_ERROR_OPTION);
    assert_int_equal(laves_mesh_read_points(meshes[i], 1, SIZE_MAX, point, &error), LAVES_ERROR_OPTION);
  }
  free_pair(&p);
}

/* ---- files ---- */

static char *read_file(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  *size = (size_t)ftell(file);
  rewind(file);
  char *bytes = malloc(*size + 1);
  assert_int_equal(fread(bytes, 1, *size, file), *size);
  fclose(file);
  return bytes;
}

static void files_are_the_same(void **state) {
  (void)state;
  static const laves_write_options kinds[] = {{.format = LAVES_FORMAT_VTU},
                                              {.format = LAVES_FORMAT_VTU, .compression = 1},
                                              {.format = LAVES_FORMAT_VTU, .ascii = true},
                                              {.format = LAVES_FORMAT_GMSH41},
                                              {.format = LAVES_FORMAT_GMSH41, .ascii = true},
                                              {.format = LAVES_FORMAT_GMSH22},
                                              {.format = LAVES_FORMAT_GMSH22, .ascii = true},
                                              {.format = LAVES_FORMAT_VTKHDF},
                                              {.format = LAVES_FORMAT_VTK},
                                              {.format = LAVES_FORMAT_VTK, .ascii = true},
                                              {.format = LAVES_FORMAT_NPZ}};
  for (int i = 0; i < SOLIDS; i += solid_step()) {
    pair p = make_pair(&solids[i], 3);
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
      laves_write_options options = laves_write_options_default();
      options.format = kinds[k].format;
      options.ascii = kinds[k].ascii;
      options.compression = kinds[k].compression;
      char path[2][FIXTURE_FOLDER_MAX + 20];
      size_t size[2];
      char *bytes[2];
      for (int j = 0; j < 2; j++) {
        snprintf(path[j], sizeof path[j], "%s/mesh%d", folder, j);
        assert_int_equal(laves_mesh_write(p.context, j ? p.streamed : p.whole, path[j], &options, NULL), LAVES_OK);
        bytes[j] = read_file(path[j], &size[j]);
      }
      if (size[0] != size[1] || memcmp(bytes[0], bytes[1], size[0]) != 0)
        fail_msg("%s: %s%s differs", solids[i].text, laves_format_name(options.format), options.ascii ? ", text" : "");
      free(bytes[0]);
      free(bytes[1]);
    }
    free_pair(&p);
  }
}

/* XDMF's arrays; the XML names their file. */
static void files_of_arrays_are_the_same(void **state) {
  (void)state;
  for (int i = 1; i < 3; i++) { /* without and with tags */
    pair p = make_pair(&solids[i], 2);
    size_t size[2];
    char *bytes[2];
    for (int j = 0; j < 2; j++) {
      char path[FIXTURE_FOLDER_MAX + 20];
      snprintf(path, sizeof path, "%s/mesh%d.xdmf", folder, j);
      assert_int_equal(laves_mesh_write(p.context, j ? p.streamed : p.whole, path, NULL, NULL), LAVES_OK);
      snprintf(path, sizeof path, "%s/mesh%d.h5", folder, j);
      bytes[j] = read_file(path, &size[j]);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(bytes[0], bytes[1], size[0]);
    free(bytes[0]);
    free(bytes[1]);
    free_pair(&p);
  }
}

static void other_formats_refuse(void **state) {
  (void)state;
  pair p = make_pair(&solids[4], 1);
  for (int format = 0; format < LAVES_FORMAT_COUNT; format++) {
    if (format == LAVES_FORMAT_AUTO || laves_format_streams((laves_format)format)) continue;
    laves_write_options options = laves_write_options_default();
    options.format = (laves_format)format;
    char path[FIXTURE_FOLDER_MAX + 20];
    laves_error error = {0};
    snprintf(path, sizeof path, "%s/refused", folder);
    remove(path);
    assert_int_equal(laves_mesh_write(p.context, p.streamed, path, &options, &error), LAVES_ERROR_OPTION);
    assert_non_null(strstr(error.text, "streamed"));
    assert_null(fopen(path, "rb"));
  }
  free_pair(&p);
}

/* ---- what needs the mesh in memory ---- */

static void checks_refuse(void **state) {
  (void)state;
  pair p = make_pair(&solids[4], 1);
  laves_error error = {0};
  laves_check check;
  laves_certificate certificate;
  size_t count;
  const laves_certify_options options = laves_certify_options_default();
  assert_int_equal(laves_check_mesh(p.context, p.streamed, NULL, &check, &error), LAVES_ERROR_OPTION);
  assert_non_null(strstr(error.text, "streamed"));
  assert_int_equal(laves_check_window(p.context, p.streamed, NULL, 40, 125, 0, NULL, 0, &count, &error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_check_distance(p.context, p.streamed, p.domain, 0.1, NULL, 0, &count, &error), LAVES_ERROR_OPTION);
  assert_int_equal(laves_certify(p.context, p.streamed, &options, &certificate, &error), LAVES_ERROR_OPTION);
  free_pair(&p);
}

static void expect_refusal(const char *text, void (*change)(laves_options *options), const char *word) {
  laves_context *context = make_context(1);
  laves_domain *domain = make_domain(context, text);
  laves_options options = options_for(&solids[4], true);
  options.method = LAVES_METHOD_AUTO;
  if (change) change(&options);
  laves_mesh *mesh = NULL;
  laves_error error = {0};
  assert_int_equal(laves_generate(context, domain, &options, &mesh, NULL, &error), LAVES_ERROR_OPTION);
  assert_null(mesh);
  assert_non_null(strstr(error.text, word));
  laves_domain_free(domain);
  assert_int_equal(laves_context_bytes(context), 0);
  laves_context_free(context);
}

static void grade(laves_options *options) { options->interior_growth = 0.5; }

static void some_wishes_need_memory(void **state) {
  (void)state;
  expect_refusal("sphere(1)", grade, "one size");
  expect_refusal("region('core', sphere(0.5)) + region('shell', sphere(1))", NULL, "regions");
}

/* The interior takes no memory: sixteen times the tets of a ball cost 16^(2/3) = 6.3 times as much. */
static void memory_goes_with_the_surface(void **state) {
  (void)state;
  static const solid small = {"sphere(1)", 20000, LAVES_METHOD_AUTO}, large = {"sphere(1)", 320000, LAVES_METHOD_AUTO};
  size_t peak[2], whole;
  for (int i = 0; i < 3; i++) {
    laves_context *context = make_context(2);
    laves_domain *domain = make_domain(context, small.text);
    laves_mesh_free(make_mesh(context, domain, i == 0 ? &small : &large, i < 2));
    *(i < 2 ? &peak[i] : &whole) = laves_context_peak_bytes(context);
    laves_domain_free(domain);
    laves_context_free(context);
  }
  assert_true(peak[1] < 9 * peak[0]);
  assert_true(peak[1] + 16 * 250000 < whole);
}

/* What a context holds, and held at most. */
typedef struct tally {
  atomic_size_t held, most;
} tally;

static void *counted(void *user, void *pointer, size_t old_bytes, size_t new_bytes) {
  tally *t = user;
  void *block = NULL;
  if (new_bytes > 0)
    block = realloc(pointer, new_bytes);
  else
    free(pointer);
  if (new_bytes > 0 && !block) return NULL;
  const size_t held = atomic_fetch_add(&t->held, new_bytes - old_bytes) + new_bytes - old_bytes;
  size_t most = atomic_load(&t->most);
  while (held > most && !atomic_compare_exchange_weak(&t->most, &most, held)) {
  }
  return block;
}

static size_t size_of_file(const char *path) {
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  assert_int_equal(fseek(file, 0, SEEK_END), 0);
  const long size = ftell(file);
  fclose(file);
  return (size_t)size;
}

/* Blocks of a compressed file go to the file as they are made. */
static void compressed_blocks_do_not_wait_in_memory(void **state) {
  (void)state;
  if (test_stride() > 1) skip(); /* several million tets */
  static const solid ball = {"sphere(1)", 4000000, LAVES_METHOD_AUTO};
  tally t = {0};
  laves_context_options options = laves_context_options_default();
  options.thread_count = 2;
  options.reallocate = counted;
  options.reallocate_user = &t;
  laves_context *context = laves_context_create(&options);
  laves_domain *domain = make_domain(context, ball.text);
  laves_mesh *mesh = make_mesh(context, domain, &ball, true);
  char path[FIXTURE_FOLDER_MAX + 20];
  snprintf(path, sizeof path, "%s/ball.vtu", folder);
  laves_write_options compressed = laves_write_options_default();
  compressed.compression = 1;
  const size_t before = atomic_load(&t.held);
  atomic_store(&t.most, before);
  assert_int_equal(laves_mesh_write(context, mesh, path, &compressed, NULL), LAVES_OK);
  assert_int_equal(atomic_load(&t.held), before);
  const size_t took = atomic_load(&t.most) - before, size = size_of_file(path);
  if (4 * took > size) fail_msg("%zu bytes of memory for a file of %zu", took, size);
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  laves_context_free(context);
  assert_int_equal(atomic_load(&t.held), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(same_as_in_memory),
      cmocka_unit_test(any_range_may_be_read),
      cmocka_unit_test(ranges_end_with_the_mesh),
      cmocka_unit_test(files_are_the_same),
      cmocka_unit_test(files_of_arrays_are_the_same),
      cmocka_unit_test(other_formats_refuse),
      cmocka_unit_test(checks_refuse),
      cmocka_unit_test(some_wishes_need_memory),
      cmocka_unit_test(memory_goes_with_the_surface),
      cmocka_unit_test(compressed_blocks_do_not_wait_in_memory),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
