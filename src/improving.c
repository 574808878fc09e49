/* The story of a mesh of any program that is improved, in one function: laves_improve().
 *
 *     check -> layer (patches, creases, corners of its own boundary) -> improve -> mesh -> check
 *
 * The engine is that of the boundary layers of our own meshes (improve/); here the whole mesh is the layer, and its boundary is
 * given by its own faces (improve/given.h). No angle may get beyond the worst that the mesh has at the start, so it
 * never gets worse; that is checked again in the end, by code that shares nothing with the engine. */
#include <string.h>

#include "improve/given.h"
#include "improve/improve.h"

static const uint32_t improve_cookie = 0x696d7076;

/* Improvement aims at a little more than is asked, so that last digits do not matter; degrees, and of the volume-length ratio. */
static const double aim_slack = 0.1, length_slack = 0.005;
/* Two computations of an angle may differ by this, degrees. */
static const double angle_rounding = 1e-6;

laves_improve_options laves_improve_options_default(void) {
  return (laves_improve_options){.min_dihedral = 30, .max_dihedral = 140, .cookie = improve_cookie};
}

static laves_result check_range(const char *name, double value, double low, double high, laves_error *error) {
  if (value >= low && value <= high) return LAVES_OK;
  return laves__fail(error, LAVES_ERROR_OPTION, "%s is %g but must lie between %g and %g", name, value, low, high);
}

static laves_result check_options(const laves_improve_options *o, laves_error *error) {
  if (o->cookie != improve_cookie)
    return laves__fail(error, LAVES_ERROR_OPTION, "the options did not come from laves_improve_options_default()");
  laves_result result = check_range("min_dihedral", o->min_dihedral, 0, 60, error);
  if (result == LAVES_OK) result = check_range("max_dihedral", o->max_dihedral, 80, 180, error);
  if (result == LAVES_OK) result = check_range("volume_length", o->volume_length, 0, 0.8, error);
  if (result == LAVES_OK) result = check_range("tolerance", o->tolerance, 0, 1e300, error);
  if (result == LAVES_OK) result = check_range("seconds", o->seconds, 0, 1e300, error);
  return result;
}

/* What the engine can work on. A boundary that touches itself is let through: its vertices stay. */
static laves_result check_input(const laves_check *c, laves_error *error) {
  if (c->tets == 0) return laves__fail(error, LAVES_ERROR_INPUT, "the mesh has no tetrahedra");
  if (c->bad_indices > 0)
    return laves__fail(error, LAVES_ERROR_INPUT, "%zu corners of tetrahedra are repeated; improvement needs a valid mesh",
                       c->bad_indices);
  if (c->inverted_tets > 0)
    return laves__fail(error, LAVES_ERROR_INPUT, "%zu tetrahedra are flat or inside out; improvement needs a valid mesh",
                       c->inverted_tets);
  if (c->nonconforming_faces > 0)
    return laves__fail(error, LAVES_ERROR_INPUT,
                       "%zu faces have more than two tetrahedra, or two on one side; improvement needs a valid mesh",
                       c->nonconforming_faces);
  return LAVES_OK;
}

/* Whether a mesh is as good as another in all that is promised. */
static bool as_good(const laves_check *now, const laves_check *before) {
  return now->bad_indices == 0 && now->inverted_tets == 0 && now->nonconforming_faces == 0 &&
         now->nonmanifold_edges <= before->nonmanifold_edges && now->nonmanifold_vertices <= before->nonmanifold_vertices &&
         now->min_dihedral.min >= before->min_dihedral.min - angle_rounding &&
         now->max_dihedral.max <= before->max_dihedral.max + angle_rounding;
}

static void count_moves(const laves__given *given, laves_improve_report *r) {
  r->fixed_vertices = given->held_vertices;
  r->crease_vertices = given->crease_vertices;
  r->flat_vertices = given->flat_vertices;
  r->patches = given->patch_count;
  r->sharpest = given->sharpest;
}

/* The layer, improved. */
static laves_result improve_layer(const laves_improve_options *o, double start, laves__layer *layer, laves_improve_report *r,
                                  laves_error *error) {
  static const laves__frame no_domain; /* nothing is asked of it where the boundary is given */
  const laves__window asked = {
      .min_dihedral = o->min_dihedral, .max_dihedral = o->max_dihedral, .volume_length = o->volume_length};
  const laves__window aim = {.min_dihedral = o->min_dihedral + aim_slack,
                             .max_dihedral = fmin(o->max_dihedral, 180 - 2 * aim_slack) - aim_slack,
                             .volume_length = o->volume_length > 0 ? o->volume_length + length_slack : 0,
                             .held_min = r->before.min_dihedral.min,
                             .held_max = r->before.max_dihedral.max,
                             .passes = o->passes,
                             .deadline = o->seconds > 0 ? start + o->seconds : 0};
  r->outside_before = laves__improve_outside(&asked, layer);
  const laves_result result = laves__improve(&no_domain, &aim, layer, error);
  r->outside_after = laves__improve_outside(&asked, layer);
  r->out_of_time = aim.deadline > 0 && laves__wall_seconds() > aim.deadline;
  return result;
}

static laves_result run(laves_context *context, const laves_mesh *mesh, const laves_improve_options *o, double start,
                        laves_mesh **improved, laves_improve_report *r, laves_error *error) {
  laves__given given = {0};
  laves__layer layer = {0};
  laves_result result = laves__given_layer(context, mesh, o->tolerance, o->fixed_boundary, &given, &layer, error);
  if (result == LAVES_OK) {
    count_moves(&given, r);
    result = improve_layer(o, start, &layer, r, error);
  }
  if (result == LAVES_OK) result = laves__given_mesh(&given, &layer, improved, error);
  laves__layer_free(&layer);
  laves__given_free(&given);
  return result;
}

/* The mesh as it was, should the improved one have a fault. */
static laves_result copy_mesh(laves_context *context, const laves_mesh *mesh, laves_mesh **copy, laves_error *error) {
  laves__given given = {0};
  laves__layer layer = {0};
  laves_result result = laves__given_layer(context, mesh, 0, true, &given, &layer, error);
  if (result == LAVES_OK) result = laves__given_mesh(&given, &layer, copy, error);
  laves__layer_free(&layer);
  laves__given_free(&given);
  return result;
}

laves_result laves_improve(laves_context *context, const laves_mesh *mesh, const laves_improve_options *options,
                           laves_mesh **improved, laves_improve_report *report, laves_error *error) {
  const double start = laves__wall_seconds(), cpu = laves__cpu_seconds();
  const laves_improve_options o = options ? *options : laves_improve_options_default();
  laves_improve_report unused, *r = report ? report : &unused;
  *improved = NULL;
  memset(r, 0, sizeof *r);
  laves_result result = check_options(&o, error);
  if (result == LAVES_OK) result = laves__mesh_require_arrays(mesh, "improvement", error);
  if (result == LAVES_OK) result = laves_check_mesh(context, mesh, NULL, &r->before, error);
  if (result == LAVES_OK) result = check_input(&r->before, error);
  if (result == LAVES_OK) result = run(context, mesh, &o, start, improved, r, error);
  if (result == LAVES_OK) result = laves_check_mesh(context, *improved, NULL, &r->after, error);
  if (result == LAVES_OK && !as_good(&r->after, &r->before)) { /* rounding of coordinates, where tets are nearly flat */
    laves_mesh_free(*improved);
    *improved = NULL;
    r->kept_as_it_was = true;
    r->after = r->before;
    r->outside_after = r->outside_before;
    result = copy_mesh(context, mesh, improved, error);
  }
  r->wall_seconds = laves__wall_seconds() - start;
  r->cpu_seconds = laves__cpu_seconds() - cpu;
  r->peak_bytes = laves_context_peak_bytes(context);
  if (result == LAVES_OK) return r->outside_after > 0 ? LAVES_TARGET_MISSED : LAVES_OK;
  laves_mesh_free(*improved);
  *improved = NULL;
  return result;
}
