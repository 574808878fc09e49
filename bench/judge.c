/* Judges a tetrahedral mesh of any program and prints what the benchmark of graded meshes tells as one line of JSON.
 *
 *   judge MESH [--size EXPRESSION] [--surface INPUT] [--threads N]
 *
 * MESH: any format that laves reads. Told are counts, validity, topology, angles, the histogram of radius ratios, and the
 * tiles; angles apart for the interior, which is the tetrahedra without a vertex on the boundary.
 * --size: an expression of x, y and z, the wished edge length; adds the lengths of edges over the wish at their midpoints, at 1,
 * 5, 50, 95 and 99 %, and the share of edges within 0.6 and 1.5, of all edges and of those of the interior. Each edge counts
 * once.
 * --surface: what the mesh should fill; adds the distances both ways, in units of the input, and how many tetrahedra outside the
 * window stand where the surface is smooth. */
#include <laves/laves.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { RATIO_BINS = 20, EXPRESSION_BYTES = 4096, CHUNK = 4096, PLACES_MAX = 100000 };

static const double pi = 3.14159265358979323846;
/* What every tetrahedron of a graded interior shall keep. */
static const double window_min = 35, window_max = 132;
static const double smooth_radius = 2;
/* Between these, edges are as long as was wished; and where the lengths are read off. */
static const double fit_min = 0.6, fit_max = 1.5;
static const double levels[] = {0.01, 0.05, 0.5, 0.95, 0.99};
enum { LEVELS = sizeof levels / sizeof levels[0] };
/* How far beyond the mesh a size is asked for, in diagonals: the box that a domain needs must not be felt inside. */
static const double room = 16;

typedef struct request {
  const char *mesh, *size, *surface;
  int threads;
} request;

typedef struct edge {
  int32_t a, b;
  bool inner; /* of a tetrahedron without boundary vertices */
} edge;

typedef struct angles {
  size_t tets, outside; /* how many, and of those how many leave the window */
  double min, max;      /* degrees */
} angles;

/* ---- shapes ---- */

typedef struct vec {
  double x, y, z;
} vec;

static vec minus(vec a, vec b) { return (vec){a.x - b.x, a.y - b.y, a.z - b.z}; }
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b) { return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
static double norm(vec a) { return sqrt(dot(a, a)); }

static vec point(const laves_mesh *mesh, int32_t vertex) {
  const double *p = laves_mesh_points(mesh) + 3 * (size_t)vertex;
  return (vec){p[0], p[1], p[2]};
}

/* Smallest and largest dihedral angle in degrees. The normals point inwards: an angle of 180 less that between them. */
static void dihedrals(const vec p[4], double *least, double *most) {
  static const int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  vec n[4];
  for (int i = 0; i < 4; i++) n[i] = cross(minus(p[faces[i][1]], p[faces[i][0]]), minus(p[faces[i][2]], p[faces[i][0]]));
  *least = 180, *most = 0;
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++) {
      const double angle = 180 - atan2(norm(cross(n[i], n[j])), dot(n[i], n[j])) * 180 / pi;
      *least = fmin(*least, angle);
      *most = fmax(*most, angle);
    }
}

/* 3 r / R, 1 for the regular tetrahedron. R by Crelle: 24 V R is the area of a triangle, by Heron's formula four times over,
 * whose sides are the products of opposite edges. */
static double radius_ratio(const vec p[4]) {
  const vec u = minus(p[1], p[0]), v = minus(p[2], p[0]), w = minus(p[3], p[0]);
  const double six = fabs(dot(u, cross(v, w)));
  const double a = norm(u) * norm(minus(p[3], p[2])), b = norm(v) * norm(minus(p[3], p[1])),
               c = norm(w) * norm(minus(p[2], p[1]));
  const double square = (a + b + c) * (b + c - a) * (c + a - b) * (a + b - c);
  const double area =
      0.5 * (norm(cross(u, v)) + norm(cross(v, w)) + norm(cross(w, u)) + norm(cross(minus(p[2], p[1]), minus(p[3], p[1]))));
  if (!(square > 0 && area > 0)) return 0;
  const double inner = 0.5 * six / area, outer = sqrt(square) / (4 * six);
  return 3 * inner / outer;
}

/* ---- output ---- */

static void print_field(const char *name, double value) {
  if (isfinite(value))
    printf(", \"%s\": %.9g", name, value);
  else
    printf(", \"%s\": null", name);
}

static void print_angles(const char *name, const angles *a) {
  printf(", \"%s\": {\"tets\": %zu, \"outside\": %zu", name, a->tets, a->outside);
  print_field("min", a->tets ? a->min : NAN);
  print_field("max", a->tets ? a->max : NAN);
  printf("}");
}

/* ---- judging ---- */

static void count_tet(angles *a, double least, double most) {
  a->tets++;
  a->outside += least < window_min || most > window_max;
  a->min = fmin(a->min, least);
  a->max = fmax(a->max, most);
}

static bool is_inner(const int32_t *tet, const bool *boundary) {
  return !(boundary[tet[0]] || boundary[tet[1]] || boundary[tet[2]] || boundary[tet[3]]);
}

static void judge_shapes(const laves_mesh *mesh, const bool *boundary) {
  const int32_t *tets = laves_mesh_tets(mesh);
  angles all = {.min = 180}, inner = {.min = 180};
  size_t ratios[RATIO_BINS] = {0};
  for (size_t i = 0; i < laves_mesh_tet_count(mesh); i++) {
    const int32_t *tet = &tets[4 * i];
    const vec p[4] = {point(mesh, tet[0]), point(mesh, tet[1]), point(mesh, tet[2]), point(mesh, tet[3])};
    double least, most;
    dihedrals(p, &least, &most);
    count_tet(&all, least, most);
    if (is_inner(tet, boundary)) count_tet(&inner, least, most);
    ratios[(int)fmin(RATIO_BINS - 1, RATIO_BINS * radius_ratio(p))]++;
  }
  print_angles("all", &all);
  print_angles("inner", &inner);
  printf(", \"radius_ratio_histogram\": [");
  for (int i = 0; i < RATIO_BINS; i++) printf(i ? ", %zu" : "%zu", ratios[i]);
  printf("]");
}

static laves_result judge_mesh(laves_context *context, const laves_mesh *mesh, const laves_domain *domain, laves_error *error) {
  laves_certify_options options = laves_certify_options_default();
  laves_certificate *made = malloc(sizeof *made);
  if (!made) return LAVES_ERROR_MEMORY;
  options.domain = domain;
  const laves_result result = laves_certify(context, mesh, &options, made, error);
  if (result == LAVES_OK) {
    const laves_check *c = &made->check;
    printf("{\"valid\": %s, \"tets\": %zu, \"vertices\": %zu, \"faces\": %zu, \"components\": %zu, \"genus\": %lld",
           c->valid ? "true" : "false", c->tets, c->vertices, c->faces, c->components, (long long)c->genus);
    print_field("radius_ratio_min", c->radius_ratio.min);
    print_field("radius_ratio_mean", c->radius_ratio.mean);
    print_field("volume", c->volume);
    print_field("exact_tets", (double)made->lattice_tets);
    print_field("bcc_tets", made->bcc_tets == SIZE_MAX ? NAN : (double)made->bcc_tets);
    print_field("to_surface_mean", c->has_distance ? c->to_surface_mean : NAN);
    print_field("to_surface_max", c->has_distance ? c->to_surface_max : NAN);
    print_field("from_surface_mean", c->has_distance ? c->from_surface_mean : NAN);
    print_field("from_surface_max", c->has_distance ? c->from_surface_max : NAN);
  }
  free(made);
  return result;
}

/* Tets outside the window where the surface is smooth: its radius of curvature is at least smooth_radius mean edges of the tet.
 */
static laves_result judge_smooth(laves_context *context, const laves_mesh *mesh, const laves_domain *domain, laves_error *error) {
  size_t count = 0, smooth = 0;
  laves_place *places = malloc(PLACES_MAX * sizeof *places);
  if (!places) return LAVES_ERROR_MEMORY;
  const laves_result result =
      laves_check_window(context, mesh, domain, window_min, window_max, 0, places, PLACES_MAX, &count, error);
  for (size_t i = 0; result == LAVES_OK && i < count && i < PLACES_MAX; i++) {
    const int32_t *tet = laves_mesh_tets(mesh) + 4 * (size_t)places[i].tet;
    double length = 0;
    for (int a = 0; a < 4; a++)
      for (int b = a + 1; b < 4; b++) length += norm(minus(point(mesh, tet[a]), point(mesh, tet[b]))) / 6;
    smooth += places[i].curvature_radius >= smooth_radius * length;
  }
  print_field("outside_smooth", (double)smooth);
  free(places);
  return result;
}

/* ---- sizes ---- */

static int by_ends(const void *left, const void *right) {
  const edge *p = left, *q = right;
  if (p->a != q->a) return p->a < q->a ? -1 : 1;
  if (p->b != q->b) return p->b < q->b ? -1 : 1;
  return (int)q->inner - (int)p->inner;
}

static int by_value(const void *left, const void *right) {
  const double p = *(const double *)left, q = *(const double *)right;
  return (p > q) - (p < q);
}

/* All edges once, the inner one of equal ones; free the result. */
static edge *list_edges(const laves_mesh *mesh, const bool *boundary, size_t *count) {
  static const int ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  const int32_t *tets = laves_mesh_tets(mesh);
  const size_t most = 6 * laves_mesh_tet_count(mesh);
  edge *edges = malloc((most + 1) * sizeof *edges);
  if (!edges) return NULL;
  for (size_t i = 0; i < most; i++) {
    const int32_t *tet = &tets[4 * (i / 6)];
    const int32_t a = tet[ends[i % 6][0]], b = tet[ends[i % 6][1]];
    edges[i] = (edge){a < b ? a : b, a < b ? b : a, is_inner(tet, boundary)};
  }
  qsort(edges, most, sizeof *edges, by_ends);
  *count = 0;
  for (size_t i = 0; i < most; i++)
    if (!*count || edges[i].a != edges[*count - 1].a || edges[i].b != edges[*count - 1].b) edges[(*count)++] = edges[i];
  return edges;
}

/* A field as a solid that is inside everywhere near the mesh, so that its value is less the size. */
static laves_result read_size(laves_context *context, const laves_mesh *mesh, const char *size, laves_domain **field,
                              laves_error *error) {
  char text[EXPRESSION_BYTES];
  double lower[3], upper[3], diagonal = 0;
  for (int k = 0; k < 3; k++) lower[k] = INFINITY, upper[k] = -INFINITY;
  for (size_t i = 0; i < 3 * laves_mesh_vertex_count(mesh); i++) {
    lower[i % 3] = fmin(lower[i % 3], laves_mesh_points(mesh)[i]);
    upper[i % 3] = fmax(upper[i % 3], laves_mesh_points(mesh)[i]);
  }
  for (int k = 0; k < 3; k++) diagonal = hypot(diagonal, upper[k] - lower[k]);
  const double more = room * diagonal;
  snprintf(text, sizeof text, "bounds(-(%s), {%.17g, %.17g, %.17g}, {%.17g, %.17g, %.17g})", size, lower[0] - more,
           lower[1] - more, lower[2] - more, upper[0] + more, upper[1] + more, upper[2] + more);
  return laves_domain_from_expression(context, text, field, error);
}

static void measure_edges(const laves_mesh *mesh, const laves_domain *field, const edge *edges, size_t count, double *ratios) {
  double places[3 * CHUNK], values[CHUNK];
  for (size_t first = 0; first < count; first += CHUNK) {
    const size_t some = count - first < CHUNK ? count - first : CHUNK;
    for (size_t i = 0; i < some; i++) {
      const vec a = point(mesh, edges[first + i].a), b = point(mesh, edges[first + i].b);
      places[3 * i] = 0.5 * (a.x + b.x), places[3 * i + 1] = 0.5 * (a.y + b.y), places[3 * i + 2] = 0.5 * (a.z + b.z);
    }
    laves_domain_evaluate(field, places, some, values);
    for (size_t i = 0; i < some; i++)
      ratios[first + i] = norm(minus(point(mesh, edges[first + i].a), point(mesh, edges[first + i].b))) / -values[i];
  }
}

static void print_ratios(const char *name, double *ratios, size_t count) {
  size_t fit = 0;
  qsort(ratios, count, sizeof *ratios, by_value);
  for (size_t i = 0; i < count; i++) fit += ratios[i] >= fit_min && ratios[i] <= fit_max;
  printf(", \"%s\": {\"edges\": %zu", name, count);
  print_field("fit", (double)fit / (double)count);
  printf(", \"levels\": [");
  for (int i = 0; i < LEVELS && count; i++)
    printf(i ? ", %.6g" : "%.6g", ratios[(size_t)(levels[i] * (double)(count - 1) + 0.5)]);
  printf("]}");
}

static laves_result judge_sizes(laves_context *context, const laves_mesh *mesh, const bool *boundary, const char *size,
                                laves_error *error) {
  laves_domain *field = NULL;
  size_t count = 0, inner = 0;
  double *ratios = NULL;
  laves_result result = LAVES_ERROR_MEMORY;
  edge *edges = list_edges(mesh, boundary, &count);
  if (!edges || !(ratios = malloc((2 * count + 1) * sizeof *ratios))) goto end;
  if ((result = read_size(context, mesh, size, &field, error)) != LAVES_OK) goto end;
  measure_edges(mesh, field, edges, count, ratios);
  for (size_t i = 0; i < count; i++)
    if (edges[i].inner) ratios[count + inner++] = ratios[i];
  print_ratios("edges", ratios, count);
  print_ratios("inner_edges", ratios + count, inner);
end:
  laves_domain_free(field);
  free(ratios);
  free(edges);
  return result;
}

/* ---- the story ---- */

static laves_result judge(const request *q, laves_context *context, laves_error *error) {
  laves_mesh *mesh = NULL;
  laves_domain *domain = NULL;
  bool *boundary = NULL;
  laves_result result = laves_mesh_read(context, q->mesh, &mesh, error);
  if (result == LAVES_OK && q->surface)
    result = access(q->surface, F_OK) == 0 ? laves_domain_from_file(context, q->surface, &domain, error)
                                           : laves_domain_from_expression(context, q->surface, &domain, error);
  if (result == LAVES_OK) result = judge_mesh(context, mesh, domain, error);
  if (result != LAVES_OK) goto end;
  result = LAVES_ERROR_MEMORY;
  if (!(boundary = calloc(laves_mesh_vertex_count(mesh) + 1, sizeof *boundary))) goto end;
  for (size_t i = 0; i < 3 * laves_mesh_face_count(mesh); i++) boundary[laves_mesh_faces(mesh)[i]] = true;
  judge_shapes(mesh, boundary);
  result = domain ? judge_smooth(context, mesh, domain, error) : LAVES_OK;
  if (result == LAVES_OK && q->size) result = judge_sizes(context, mesh, boundary, q->size, error);
  printf("}\n");
end:
  free(boundary);
  laves_domain_free(domain);
  laves_mesh_free(mesh);
  return result;
}

static bool parse(int count, char **words, request *q) {
  *q = (request){0};
  for (int i = 1; i < count; i++) {
    const bool more = i + 1 < count;
    if (strcmp(words[i], "--size") == 0 && more)
      q->size = words[++i];
    else if (strcmp(words[i], "--surface") == 0 && more)
      q->surface = words[++i];
    else if (strcmp(words[i], "--threads") == 0 && more)
      q->threads = atoi(words[++i]);
    else if (!q->mesh)
      q->mesh = words[i];
    else
      return false;
  }
  return q->mesh != NULL;
}

int main(int count, char **words) {
  request q;
  laves_error error = {0};
  if (!parse(count, words, &q)) {
    fputs("judge MESH [--size EXPRESSION] [--surface INPUT] [--threads N]\n", stderr);
    return 1;
  }
  laves_context_options options = laves_context_options_default();
  options.thread_count = q.threads;
  laves_context *context = laves_context_create(&options);
  const laves_result result = context ? judge(&q, context, &error) : LAVES_ERROR_MEMORY;
  if (result != LAVES_OK) fprintf(stderr, "judge: %s: %s\n", q.mesh, error.text);
  laves_context_free(context);
  return laves_result_exit_code(result);
}
