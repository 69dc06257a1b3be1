// SPDX-License-Identifier: Apache-2.0
// cgal_mesh SURFACE.off SIZE SLIVER_DEG OUT.mesh: CGAL's Mesh_3 of a closed surface with its sharp edges kept, then perturbation; prints one JSON object.
// Counted: refinement and perturbation; reading, detecting sharp edges and writing are not. One thread.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_polyhedron_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polyhedral_mesh_domain_with_features_3.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/perturb_mesh_3.h>
#include <CGAL/version.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polyhedron = CGAL::Mesh_polyhedron_3<Kernel>::type;
using Domain = CGAL::Polyhedral_mesh_domain_with_features_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
using Clock = std::chrono::steady_clock;

int main(int argc, char** argv) {
    if (argc != 5) return 3;
    std::ifstream in(argv[1]);
    Polyhedron surface;
    if (!(in >> surface) || !CGAL::is_triangle_mesh(surface)) {
        std::fprintf(stderr, "%s: not a triangulated surface\n", argv[1]);
        return 2;
    }
    const double size = std::atof(argv[2]), degrees = std::atof(argv[3]);
    Domain domain(surface);
    domain.detect_features();
    namespace p = CGAL::parameters;
    // Mesh_3's own examples bound facet angles by 25 degrees and radius-edge ratios by 2; edges, facets and cells have one size here.
    const Criteria criteria(p::edge_size = size, p::facet_angle = 25, p::facet_size = size, p::facet_distance = size / 10, p::cell_radius_edge_ratio = 2, p::cell_size = size);
    const auto start = Clock::now();
    Complex mesh = CGAL::make_mesh_3<Complex>(domain, criteria, p::no_perturb(), p::no_exude());
    const std::chrono::duration<double> refined = Clock::now() - start;
    CGAL::perturb_mesh_3(mesh, domain, p::time_limit = 0, p::sliver_bound = degrees);
    const std::chrono::duration<double> seconds = Clock::now() - start;
    std::ofstream out(argv[4]);
    out.precision(17);
    mesh.output_to_medit(out);
    std::printf("{\"version\": \"CGAL %s\", \"seconds\": %.6f, \"refinement_seconds\": %.6f, \"tets\": %zu}\n", CGAL_VERSION_STR, seconds.count(), refined.count(),
                static_cast<std::size_t>(mesh.number_of_cells_in_complex()));
}
