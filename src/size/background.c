/* Sizes from a file: finds the format from the content, has it read, checks the sizes and makes an image or a tree of it. */
#include "size/background.h"

#include <string.h>

#include "io/file.h"
#include "io/vtu.h"
#include "size/background_parts.h"

struct laves__background_sizes {
  laves_context *context;
  bool is_image;
  laves__background_image image;
  laves__background_tree tree;
};

/* Squares of distances between places up to here, and products of three, are far from the largest double. */
static const double farthest_coordinate = 1e90;

/* ---- meshes and points ---- */

/* Whether a tet or a loose point needs the number of a point; those of others, such as middles of curved edges, do not
 * matter. */
static laves_result check_value(const laves__mesh_input *input, size_t i, const char *what, size_t item, laves_error *error) {
  const double value = input->values.items[i];
  if (value > 0 && isfinite(value)) return LAVES_OK;
  if (isnan(value))
    return laves__mesh_input_fail(input, error, "%s %zu (counted from 1) has no size, or one that is not a number", what,
                                  item + 1);
  return laves__mesh_input_fail(input, error, "%s %zu (counted from 1) has the size %g; sizes must be greater than 0 and finite",
                                what, item + 1, value);
}

static laves_result check_values(const laves__mesh_input *input, laves_error *error) {
  laves_result result = LAVES_OK;
  const laves__mesh_values *values = &input->values;
  const size_t needed = values->per_tet ? input->tet_count : input->point_count;
  if (values->count != needed)
    return laves__mesh_input_fail(input, error, "it has %zu sizes, but needs %zu", values->count, needed);
  if (values->per_tet) {
    for (size_t i = 0; i < needed && result == LAVES_OK; i++) result = check_value(input, i, "tetrahedron", i, error);
  } else if (input->tet_count == 0) {
    for (size_t i = 0; i < needed && result == LAVES_OK; i++) result = check_value(input, i, "point", i, error);
  } else {
    for (size_t i = 0; i < 4 * input->tet_count && result == LAVES_OK; i++) {
      const size_t corner = (size_t)input->tets[i / 4][i % 4];
      result = check_value(input, corner, "vertex", corner, error);
    }
  }
  return result;
}

static laves_result check_places(const laves__mesh_input *input, laves_error *error) {
  for (size_t i = 0; i < input->point_count; i++) {
    const laves__vec3 p = input->points[i];
    if (!(fabs(p.x) < farthest_coordinate && fabs(p.y) < farthest_coordinate && fabs(p.z) < farthest_coordinate))
      return laves__mesh_input_fail(input, error, "point %zu (counted from 1) has a coordinate that is not finite or beyond 1e90",
                                    i + 1);
  }
  return LAVES_OK;
}

typedef laves_result read_fn(laves__mesh_input *input, laves_error *error);

/* Gmsh's older views start with a section of their own. */
static read_fn *find_reader(const laves__mesh_input *input) {
  if (laves__is_vtu(input)) return laves__read_vtu;
  if (laves__mesh_input_mentions(input, "$MeshFormat")) return laves__read_gmsh;
  if (laves__mesh_input_mentions(input, "$PostFormat")) return NULL;
  return laves__mesh_input_mentions(input, "View") ? laves__read_pos : NULL;
}

static laves_result read_mesh(laves__mesh_input *input, laves__background_sizes *background, laves_error *error) {
  read_fn *read = find_reader(input);
  if (!read)
    return laves__mesh_input_fail(input, error,
                                  "it has no format of size files that is known (NRRD; VTU; Gmsh: .msh and .pos with a view)");
  laves_result result = read(input, error);
  if (result == LAVES_OK && (input->tet_count > 0 || read != laves__read_pos)) result = laves__mesh_input_check(input, error);
  if (result == LAVES_OK) result = check_places(input, error);
  if (result == LAVES_OK) result = check_values(input, error);
  if (result == LAVES_OK) result = laves__background_tree_make(input, &background->tree, error);
  return result;
}

/* ---- images ---- */

static laves_result read_image(laves__image_input *image, const char *array_name, laves__background_sizes *background,
                               laves_error *error) {
  if (array_name)
    return laves__fail(error, LAVES_ERROR_INPUT, "%s: an image has one array without a name; leave out the name '%.60s'",
                       image->name, array_name);
  laves_result result = laves__read_nrrd(image, error);
  if (result == LAVES_OK) result = laves__background_image_make(image, &background->image, error);
  background->is_image = result == LAVES_OK;
  laves__image_input_free(image);
  return result;
}

/* ---- the interface ---- */

laves_result laves__background_parse(laves_context *context, const char *name, const char *bytes, size_t length,
                                     const char *array_name, laves__background_sizes **sizes, laves_error *error) {
  *sizes = NULL;
  laves__mesh_input mesh = {
      .context = context, .name = name, .begin = bytes, .end = bytes + length, .values = {.wanted = true, .array = array_name}};
  laves__image_input image = {.context = context, .name = name, .begin = bytes, .end = bytes + length};
  laves__background_sizes *made = laves__alloc_zeroed(context, 1, sizeof *made);
  if (!made) return laves__fail_memory(context, error);
  made->context = context;
  const bool is_nrrd = length >= 4 && memcmp(bytes, "NRRD", 4) == 0;
  const laves_result result = is_nrrd ? read_image(&image, array_name, made, error) : read_mesh(&mesh, made, error);
  laves__mesh_input_free(&mesh);
  if (result == LAVES_OK)
    *sizes = made;
  else
    laves__background_free(made);
  return result;
}

laves_result laves__background_load(laves_context *context, const char *path, const char *array_name,
                                    laves__background_sizes **sizes, laves_error *error) {
  char *bytes;
  size_t length;
  *sizes = NULL;
  laves_result result = laves__input_read(context, path, &bytes, &length, error);
  if (result != LAVES_OK) return result;
  result = laves__background_parse(context, path, bytes, length, array_name, sizes, error);
  laves__free(context, bytes, length + 1, 1);
  return result;
}

void laves__background_evaluate(const laves__background_sizes *background, size_t count, const laves__vec3 *points,
                                double *sizes) {
  for (size_t i = 0; i < count; i++)
    sizes[i] = background->is_image ? laves__background_image_at(&background->image, points[i])
                                    : laves__background_tree_at(&background->tree, points[i]);
}

void laves__background_free(laves__background_sizes *background) {
  if (!background) return;
  laves_context *context = background->context;
  if (background->is_image)
    laves__image_input_free(&background->image.samples);
  else if (background->tree.context)
    laves__background_tree_free(&background->tree);
  laves__free(context, background, 1, sizeof *background);
}
