// Meshes the inside of a triangle surface with CGAL Mesh_3, for section `peers` of bench/run, and prints one line of JSON.
//
//   cgal_mesh SURFACE.off SIZE OUTPUT.mesh [--slivers] [--features DEG]
//
// SIZE: bound on the radii of the Delaunay balls of facets and on the circumradii of cells; a tenth of it bounds the distance of
// facets to the surface. --slivers: removes slivers as CGAL does by default, by perturbing and exuding. --features: keeps edges of
// the surface whose normals turn by more than that, in degrees. The other criteria are those of CGAL's manual: 25 degrees for
// facets, radius over edge 3 for cells.
//
// Licence: CGAL's package Mesh_3 is under GPL-3.0-or-later, so the program built from this file is too. It is a separate program,
// built by bench/run only where CGAL is installed, run as a child, never linked into laves, and never installed.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_polyhedron_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polyhedral_mesh_domain_with_features_3.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/version.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polyhedron = CGAL::Mesh_polyhedron_3<Kernel>::type;
using Domain = CGAL::Polyhedral_mesh_domain_with_features_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
namespace param = CGAL::parameters;

struct Request {
  const char *surface = nullptr, *output = nullptr;
  double size = 0, feature_deg = 0;  // 0: no features
  bool slivers = false;
};

static bool parse(int count, char **words, Request &q) {
  if (count < 4) return false;
  q.surface = words[1];
  q.size = std::atof(words[2]);
  q.output = words[3];
  for (int i = 4; i < count; i++) {
    if (std::strcmp(words[i], "--slivers") == 0)
      q.slivers = true;
    else if (std::strcmp(words[i], "--features") == 0 && i + 1 < count)
      q.feature_deg = std::atof(words[++i]);
    else
      return false;
  }
  return q.size > 0;
}

static Complex mesh(const Domain &domain, const Request &q) {
  const double h = q.size;
  const Criteria criteria(param::edge_size = h, param::facet_angle = 25, param::facet_size = h, param::facet_distance = 0.1 * h,
                          param::cell_radius_edge_ratio = 3, param::cell_size = h);
  if (q.slivers) return CGAL::make_mesh_3<Complex>(domain, criteria);
  return CGAL::make_mesh_3<Complex>(domain, criteria, param::no_perturb(), param::no_exude());
}

int main(int count, char **words) {
  Request q;
  if (!parse(count, words, q)) {
    std::fputs("cgal_mesh SURFACE.off SIZE OUTPUT.mesh [--slivers] [--features DEG]\n", stderr);
    return 1;
  }
  Polyhedron surface;
  std::ifstream in(q.surface);
  if (!CGAL::IO::read_OFF(in, surface) || !CGAL::is_triangle_mesh(surface) || !CGAL::is_closed(surface)) {
    std::fprintf(stderr, "cgal_mesh: %s is not a closed manifold of triangles\n", q.surface);
    return 2;
  }
  Domain domain(surface);
  if (q.feature_deg > 0) domain.detect_features(q.feature_deg);
  const auto start = std::chrono::steady_clock::now();
  const Complex made = mesh(domain, q);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::ofstream out(q.output);
  made.output_to_medit(out);
  out.close();
  std::printf("{\"cgal\": \"%s\", \"tets\": %zu, \"mesh_wall\": %.6f}\n", CGAL_VERSION_STR,
              static_cast<std::size_t>(made.number_of_cells_in_complex()), seconds);
  return out ? 0 : 2;
}
