/* Meshes of second order: the nodes that --order 2 adds, and what is told of them. */
#include "second_order.h"

#include <math.h>

#include "text.h"

laves_result second_order_check(session *run) {
  if (run->given->order != 2 || !run->given->stream) return LAVES_OK;
  return session_fail(run, LAVES_ERROR_OPTION, "'--order 2' needs the mesh in memory; leave --stream away, or --order");
}

laves_result second_order_make(session *run, laves_mesh *mesh, const laves_domain *domain, const laves_options *options,
                               const laves_report *report, second_order *out) {
  const double start = progress_now();
  laves_curve_options wish = laves_curve_options_default();
  wish.feature_angle = options->feature_angle;
  wish.feature_tags = options->feature_tags;
  wish.features = options->features;
  wish.feature_size = report->feature_size;
  const laves_result result = laves_mesh_curve(run->context, mesh, domain, &wish, &out->report, &run->error);
  out->seconds = progress_now() - start;
  out->made = result == LAVES_OK;
  return session_settle(run, result);
}

void second_order_say(const second_order *curved) {
  const laves_curve_report *r = &curved->report;
  text_buffer nodes, edges, count, back, straight;
  text_say("order 2: %s, least Jacobian %.3g of the straight tet's; angles and certificate are of the straight tets",
           text_plural(&nodes, r->nodes, "node"), r->least_jacobian);
  text_say("  %s of the boundary: %s on the surface, %s moved back, %s straightened",
           text_plural(&edges, r->boundary_edges, "edge"), text_count(&count, r->on_surface), text_count(&back, r->moved_back),
           text_count(&straight, r->straightened + r->unreached));
  if (r->has_distance)
    text_say("  distance to the surface: mean %.3g, was %.3g; at most %.3g, was %.3g", r->curved_mean, r->straight_mean,
             r->curved_max, r->straight_max);
}

void second_order_write_json(json *out, const second_order *curved) {
  const laves_curve_report *r = &curved->report;
  json_open_object(out, "second_order");
  json_integer(out, "nodes", (int64_t)r->nodes);
  json_integer(out, "edges", (int64_t)r->edges);
  json_integer(out, "boundary_edges", (int64_t)r->boundary_edges);
  json_integer(out, "on_surface", (int64_t)r->on_surface);
  json_integer(out, "on_crease", (int64_t)r->on_crease);
  json_integer(out, "moved_back", (int64_t)r->moved_back);
  json_integer(out, "straightened", (int64_t)r->straightened);
  json_integer(out, "unreached", (int64_t)r->unreached);
  json_number(out, "least_jacobian", r->least_jacobian);
  json_number(out, "straight_max", r->has_distance ? r->straight_max : NAN);
  json_number(out, "straight_mean", r->has_distance ? r->straight_mean : NAN);
  json_number(out, "curved_max", r->has_distance ? r->curved_max : NAN);
  json_number(out, "curved_mean", r->has_distance ? r->curved_mean : NAN);
  json_close(out);
}
