/* The files that jobs read. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fault/jobs.h"
#include "fixtures/line_files.h"
#include "fixtures/shapes.h"
#include "fixtures/size_files.h"
#include "fixtures/spoilt.h"
#include "fixtures/tagged_cube.h"

enum { PATH_BYTES = FIXTURE_FOLDER_MAX + 100 };

static bool put_bytes(const job_place *place, const char *name, const char *bytes, size_t length) {
  char path[PATH_BYTES];
  snprintf(path, sizeof path, "%s/%s", place->inputs, name);
  FILE *file = fopen(path, "wb");
  if (!file) return false;
  const bool written = fwrite(bytes, 1, length, file) == length;
  return fclose(file) == 0 && written;
}

static bool put_text(const job_place *place, const char *name, const char *text) {
  return put_bytes(place, name, text, strlen(text));
}

static bool put_shape(const job_place *place, const char *name, shape s) {
  char path[PATH_BYTES];
  snprintf(path, sizeof path, "%s/%s", place->inputs, name);
  FILE *file = fopen(path, "w");
  if (!file) return false;
  fprintf(file, "OFF\n%zu %zu 0\n", s.point_count, s.triangle_count);
  for (size_t i = 0; i < s.point_count; i++)
    fprintf(file, "%.17g %.17g %.17g\n", s.points[3 * i], s.points[3 * i + 1], s.points[3 * i + 2]);
  for (size_t i = 0; i < s.triangle_count; i++)
    fprintf(file, "3 %u %u %u\n", s.triangles[3 * i], s.triangles[3 * i + 1], s.triangles[3 * i + 2]);
  shape_free(&s);
  return fclose(file) == 0;
}

static shape cube(double half) { return shape_box((const double[]){-half, -half, -half}, (const double[]){half, half, half}, 1); }

static shape joined(shape a, shape b) {
  shape_append(&a, &b);
  shape_free(&b);
  return a;
}

static shape open_sphere(void) {
  shape s = shape_sphere(1, 2);
  shape_drop(&s, 3, 4);
  return s;
}

static shape crossing_cubes(void) {
  shape b = cube(0.7);
  shape_move(&b, 0.6, 0.5, 0.4);
  return joined(cube(0.7), b);
}

static bool put_solids(const job_place *place) {
  return put_shape(place, "cube.off", cube(0.5)) && put_shape(place, "open.off", open_sphere()) &&
         put_shape(place, "crossing.off", crossing_cubes()) && put_shape(place, "parts.off", joined(cube(1), cube(0.5))) &&
         put_text(place, "leaf.lua",
                  "local hole = cylinder{r=0.2, h=4}\n"
                  "return tag('leaf', surface('cube.off')) - tag('hole', hole)\n") &&
         put_text(place, "size.lua", "return max(0.3, 0.2 + 0.1*x*x)\n") &&
         put_text(place, "drawn.txt", "0 0 0.5\n\n-0.25 -0.25 0.5\n0.25 -0.25 0.5\n0.25 0.25 0.5\n-0.25 -0.25 0.5\n");
}

static bool put_drawings(const job_place *place) {
  bool right = true;
  for (int kind = 0; kind < LINE_FILE_KINDS && right; kind++) {
    char name[40];
    snprintf(name, sizeof name, "lines%d", kind);
    line_file file = fixture_line_file(kind);
    right = file.bytes && put_bytes(place, name, file.bytes, file.length);
    free(file.bytes);
  }
  return right;
}

static bool put_sizes(const job_place *place) {
  bool right = true;
  for (int kind = 0; kind < SIZE_FILE_KINDS && right; kind++) {
    char name[40];
    snprintf(name, sizeof name, "size%d", kind);
    size_file file = fixture_size_file(kind, 2);
    right = file.bytes && put_bytes(place, name, file.bytes, file.length);
    free(file.bytes);
  }
  return right;
}

static bool write_as(laves_context *context, const laves_mesh *mesh, const job_place *place, const char *name) {
  char path[PATH_BYTES];
  snprintf(path, sizeof path, "%s/%s", place->inputs, name);
  laves_write_options options = laves_write_options_default();
  options.ascii = strstr(name, "_text") != NULL;
  if (strstr(name, "22")) options.format = LAVES_FORMAT_GMSH22;
  return laves_mesh_write(context, mesh, path, &options, NULL) == LAVES_OK;
}

/* A mesh with regions, tags and names in every format, surfaces too. */
static bool put_tagged(laves_context *context, const job_place *place) {
  static const char *const names[] = {"tagged.vtu",  "tagged_text.vtu", "tagged22.msh",  "tagged.msh", "tagged_text.msh",
                                      "tagged.mesh", "tagged.meshb",    "tagged.node",   "cube.stl",   "cube_text.stl",
                                      "cube.obj",    "cube.ply",        "cube_text.ply", "cube22.msh", "cube.msh"};
  laves_mesh *mesh = fixture_tagged_cube(context, 2);
  bool right = true;
  for (size_t i = 0; i < sizeof names / sizeof *names && right; i++) right = write_as(context, mesh, place, names[i]);
  laves_mesh_free(mesh);
  return right;
}

/* The mesh that checks look at, and its certificate. */
static bool put_subject(laves_context *context, const job_place *place) {
  static laves_certificate certificate;
  char path[PATH_BYTES];
  laves_domain *domain = NULL;
  laves_mesh *mesh = NULL;
  laves_options options = laves_options_default();
  options.size = 0.4;
  snprintf(path, sizeof path, "%s/cube.off", place->inputs);
  bool right = laves_domain_from_file(context, path, &domain, NULL) == LAVES_OK &&
               laves_generate(context, domain, &options, &mesh, NULL, NULL) == LAVES_OK &&
               write_as(context, mesh, place, "cube.vtu") && laves_certify(context, mesh, NULL, &certificate, NULL) == LAVES_OK;
  snprintf(path, sizeof path, "%s/cube.json", place->inputs);
  right = right && laves_certificate_write(context, &certificate, path, NULL) == LAVES_OK;
  laves_mesh_free(mesh);
  laves_domain_free(domain);
  return right;
}

/* A mesh with much to improve, as Abaqus's input, and two tets in VTK's legacy form. */
static bool put_bad_meshes(laves_context *context, const job_place *place) {
  laves_mesh *plain = fixture_plain_cube(context, 2), *mesh = fixture_spoilt(context, plain, 25, 1, 4);
  char path[PATH_BYTES];
  snprintf(path, sizeof path, "%s/bad.inp", place->inputs);
  FILE *file = fopen(path, "w");
  if (file) fprintf(file, "*NODE\n");
  for (size_t v = 0; file && v < mesh->vertex_count; v++)
    fprintf(file, "%zu, %.17g, %.17g, %.17g\n", v + 1, mesh->points[v].x, mesh->points[v].y, mesh->points[v].z);
  if (file) fprintf(file, "*ELEMENT, TYPE=C3D4, ELSET=all\n");
  for (size_t t = 0; file && t < mesh->tet_count; t++)
    fprintf(file, "%zu, %d, %d, %d, %d\n", t + 1, mesh->tets[t][0] + 1, mesh->tets[t][1] + 1, mesh->tets[t][2] + 1,
            mesh->tets[t][3] + 1);
  if (file) fprintf(file, "*ELSET, ELSET=some, GENERATE\n3, 90, 2\n*SURFACE, NAME=side\nsome, S2\n");
  laves_mesh_free(mesh);
  laves_mesh_free(plain);
  return file && fclose(file) == 0 &&
         put_text(
             place, "two.vtk",
             "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n"
             "CELLS 3 14\n4 0 1 2 3\n4 1 2 3 4\n3 0 2 1\nCELL_TYPES 3\n10 10 5\nCELL_DATA 3\nSCALARS region int\n"
             "LOOKUP_TABLE default\n4 9 6\n");
}

bool job_place_make(job_place *place) {
  laves_context *context = laves_context_create(NULL);
  const bool right = context && fixture_folder_make(place->inputs) && fixture_folder_make(place->outputs) && put_solids(place) &&
                     put_drawings(place) && put_sizes(place) && put_tagged(context, place) && put_subject(context, place) &&
                     put_bad_meshes(context, place);
  laves_context_free(context);
  return right;
}

void job_place_remove(const job_place *place) {
  fixture_folder_remove(place->inputs);
  fixture_folder_remove(place->outputs);
}
