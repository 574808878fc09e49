/* Writes a smooth closed surface of any number of triangles: an icosahedron whose faces are subdivided, pushed out to a sphere
 * with bumps.
 *
 *   bumps TRIANGLES FILE.ply|FILE.off
 *
 * The number is the least 20 n^2 that is not below TRIANGLES, n being the pieces that each edge is cut into. The same bytes on
 * every run of one machine. Every size has the same shape, so that what differs between sizes is the number of triangles alone.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 12, EDGES = 30, FACES = 20 };
/* How high the bumps are, and how many of them go round: no wall gets thin, and the surface bends both ways. */
static const double bump_height = 0.12, bump_count = 5;

typedef struct vec {
  double x, y, z;
} vec;

static const int face_corners[FACES][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                           {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                           {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};

static vec corner(int i) {
  const double g = (1 + sqrt(5)) / 2;
  const vec corners[CORNERS] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  return corners[i];
}

/* Vertices are numbered: corners, then those inside edges, then those inside faces. */
typedef struct surface {
  int64_t n; /* pieces of an edge */
  int edges[EDGES][2], edge_of[CORNERS][CORNERS];
  FILE *file;
  int binary, failed;
} surface;

static int64_t vertex_count(const surface *s) { return 10 * s->n * s->n + 2; }

static void number_edges(surface *s) {
  int count = 0;
  for (int f = 0; f < FACES; f++)
    for (int k = 0; k < 3; k++) {
      const int a = face_corners[f][k], b = face_corners[f][(k + 1) % 3];
      if (a > b) continue; /* each edge is seen from both sides, once in each direction */
      s->edges[count][0] = a;
      s->edges[count][1] = b;
      s->edge_of[a][b] = s->edge_of[b][a] = count++;
    }
}

/* The vertex k pieces from corner a towards corner b. */
static int64_t on_edge(const surface *s, int a, int b, int64_t k) {
  if (k == 0) return a;
  if (k == s->n) return b;
  return CORNERS + s->edge_of[a][b] * (s->n - 1) + (a < b ? k : s->n - k) - 1;
}

/* The vertex of a face i pieces from its first corner towards its second and j towards its third. */
static int64_t in_face(const surface *s, int f, int64_t i, int64_t j) {
  const int *c = face_corners[f];
  const int64_t n = s->n;
  if (j == 0) return on_edge(s, c[0], c[1], i);
  if (i == 0) return on_edge(s, c[0], c[2], j);
  if (i + j == n) return on_edge(s, c[1], c[2], j);
  const int64_t before = (j - 1) * (n - 1) - j * (j - 1) / 2; /* rows j' < j hold n - 1 - j' each */
  return CORNERS + EDGES * (n - 1) + f * ((n - 1) * (n - 2) / 2) + before + i - 1;
}

static void put_point(surface *s, vec p) {
  const double length = sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  const vec u = {p.x / length, p.y / length, p.z / length};
  const double r = 1 + bump_height * sin(bump_count * u.x) * sin(bump_count * u.y) * sin(bump_count * u.z);
  const float at[3] = {(float)(r * u.x), (float)(r * u.y), (float)(r * u.z)};
  if (s->binary)
    s->failed |= fwrite(at, sizeof at, 1, s->file) != 1;
  else
    s->failed |= fprintf(s->file, "%.9g %.9g %.9g\n", at[0], at[1], at[2]) < 0;
}

static vec mix(const vec *c, int64_t n, int64_t i, int64_t j) {
  const double a = (double)(n - i - j), b = (double)i, d = (double)j;
  return (vec){a * c[0].x + b * c[1].x + d * c[2].x, a * c[0].y + b * c[1].y + d * c[2].y, a * c[0].z + b * c[1].z + d * c[2].z};
}

static void put_points(surface *s) {
  for (int i = 0; i < CORNERS; i++) put_point(s, corner(i));
  for (int e = 0; e < EDGES; e++) {
    const vec c[3] = {corner(s->edges[e][0]), corner(s->edges[e][1]), {0, 0, 0}};
    for (int64_t k = 1; k < s->n; k++) put_point(s, mix(c, s->n, k, 0));
  }
  for (int f = 0; f < FACES; f++) {
    const vec c[3] = {corner(face_corners[f][0]), corner(face_corners[f][1]), corner(face_corners[f][2])};
    for (int64_t j = 1; j < s->n; j++)
      for (int64_t i = 1; i + j < s->n; i++) put_point(s, mix(c, s->n, i, j));
  }
}

static void put_triangle(surface *s, int64_t a, int64_t b, int64_t c) {
  const int32_t corners[3] = {(int32_t)a, (int32_t)b, (int32_t)c};
  if (s->binary)
    s->failed |= fputc(3, s->file) == EOF || fwrite(corners, sizeof corners, 1, s->file) != 1;
  else
    s->failed |= fprintf(s->file, "3 %d %d %d\n", corners[0], corners[1], corners[2]) < 0;
}

static void put_triangles(surface *s) {
  for (int f = 0; f < FACES; f++)
    for (int64_t j = 0; j < s->n; j++)
      for (int64_t i = 0; i + j < s->n; i++) {
        put_triangle(s, in_face(s, f, i, j), in_face(s, f, i + 1, j), in_face(s, f, i, j + 1));
        if (i + j + 1 < s->n) put_triangle(s, in_face(s, f, i + 1, j), in_face(s, f, i + 1, j + 1), in_face(s, f, i, j + 1));
      }
}

static void put_head(surface *s) {
  const long long points = vertex_count(s), triangles = FACES * s->n * s->n;
  if (s->binary)
    fprintf(s->file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %lld\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %lld\nproperty list uchar int vertex_indices\nend_header\n",
            points, triangles);
  else
    fprintf(s->file, "OFF\n%lld %lld 0\n", points, triangles);
}

int main(int count, char **words) {
  surface s = {0};
  const double wished = count == 3 ? atof(words[1]) : 0;
  const char *dot = count == 3 ? strrchr(words[2], '.') : NULL;
  if (!(wished >= 20 && wished <= 4e9) || !dot || (strcmp(dot, ".ply") != 0 && strcmp(dot, ".off") != 0)) {
    fputs("bumps TRIANGLES FILE.ply|FILE.off\n", stderr);
    return 1;
  }
  s.n = (int64_t)ceil(sqrt(wished / FACES) - 1e-9);
  s.binary = strcmp(dot, ".ply") == 0;
  s.file = fopen(words[2], "wb");
  if (!s.file) {
    perror(words[2]);
    return 2;
  }
  number_edges(&s);
  put_head(&s);
  put_points(&s);
  put_triangles(&s);
  s.failed |= fclose(s.file) != 0;
  if (s.failed) fprintf(stderr, "bumps: %s cannot be written\n", words[2]);
  return s.failed ? 2 : 0;
}
