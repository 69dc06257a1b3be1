// SPDX-License-Identifier: Apache-2.0
// cgal_delaunay POINTS.node: CGAL's Delaunay_triangulation_3 of points, exact predicates, one thread; prints one JSON object.
// Counted: the constructor from a range, which sorts the points itself; reading is not.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

#include <chrono>
#include <cstdio>

#include "points.hpp"

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel>;

int main(int argc, char** argv) {
    if (argc != 2) return 3;
    std::vector<Kernel::Point_3> points;
    for (const auto& p : read_points(argv[1])) points.emplace_back(p[0], p[1], p[2]);
    const auto start = std::chrono::steady_clock::now();
    const Triangulation triangulation(points.begin(), points.end());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("{\"version\": \"CGAL %s\", \"seconds\": %.6f, \"tets\": %zu, \"vertices\": %zu}\n", CGAL_VERSION_STR, seconds.count(),
                static_cast<std::size_t>(triangulation.number_of_finite_cells()), static_cast<std::size_t>(triangulation.number_of_vertices()));
}
