// SPDX-License-Identifier: Apache-2.0
#include "sizing/nodal_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "delaunay/triangulation.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {
namespace {

/// Of a tetrahedron's barycentric coordinates: points of its faces may come out so far beyond.
constexpr double kOnFace = 1e-9;

std::vector<Box> boxes_of(const BackgroundMesh& background) {
    const TetMesh& mesh = background.mesh;
    const auto fail = [](const std::string& what) { throw MeshError(ErrorCode::bad_options, Stage::refine, "background mesh: " + what); };
    if (background.sizes.size() != mesh.vertices.size()) fail(fmt::format("{} sizes for {} vertices", background.sizes.size(), mesh.vertices.size()));
    for (std::size_t v = 0; v < background.sizes.size(); ++v)
        if (!(background.sizes[v] >= 0) || !std::isfinite(background.sizes[v]))
            fail(fmt::format("the size of vertex {} (from 0) is {}; it must be a finite number above 0, or 0 for none", v, background.sizes[v]));
    std::vector<Box> boxes(mesh.tets.size());
    for (std::size_t t = 0; t < boxes.size(); ++t)
        for (const std::uint32_t v : mesh.tets[t]) {
            if (v >= mesh.vertices.size()) fail(fmt::format("tetrahedron {} (from 0) uses vertex {}, but there are only {}", t, v, mesh.vertices.size()));
            boxes[t].add(mesh.vertices[v]);
        }
    return boxes;
}

}  // namespace

NodalSizes::NodalSizes(const BackgroundMesh& background) : background_(background), boxes_(boxes_of(background)), tree_(boxes_) {}

void NodalSizes::look_in(std::uint32_t tet, const Vec3& p, double& depth, double& size) const {
    const auto& k = background_.mesh.tets[tet];
    const auto& points = background_.mesh.vertices;
    const Vec3 u = points[k[1]] - points[k[0]], v = points[k[2]] - points[k[0]], w = points[k[3]] - points[k[0]], x = p - points[k[0]];
    const double volume = determinant(u, v, w);
    if (volume == 0) return;
    const std::array<double, 3> at{determinant(x, v, w) / volume, determinant(u, x, w) / volume, determinant(u, v, x) / volume};
    const std::array<double, 4> weights{1 - at[0] - at[1] - at[2], at[0], at[1], at[2]};
    const double least = *std::min_element(weights.begin(), weights.end());
    if (!(least > depth)) return;
    depth = least;
    double sum = 0, smallest = std::numeric_limits<double>::infinity(), largest = 0;
    bool asks = true;
    for (std::size_t i = 0; i < 4; ++i) {
        const double s = background_.sizes[k[i]];
        asks = asks && s > 0;
        sum += weights[i] * s;
        smallest = std::min(smallest, s);
        largest = std::max(largest, s);
    }
    size = asks ? std::clamp(sum, smallest, largest) : std::numeric_limits<double>::infinity();
}

double NodalSizes::operator()(const Vec3& p) const {
    double depth = -kOnFace, size = std::numeric_limits<double>::infinity();
    tree_.query([&](const Box& b) { return p.x >= b.low.x && p.x <= b.high.x && p.y >= b.low.y && p.y <= b.high.y && p.z >= b.low.z && p.z <= b.high.z; },
                [&](std::uint32_t t) { look_in(t, p, depth, size); });
    return size;
}

BackgroundMesh triangulate_sizes(const std::vector<Vec3>& points, const std::vector<double>& sizes) {
    BackgroundMesh out;
    out.mesh.vertices = points;
    out.sizes = sizes;
    Box box;
    for (const Vec3& p : points) box.add(p);
    Triangulation triangulation(box.low, box.high);
    if (points.size() < 4 || !triangulation.insert_all(std::span<const Vec3>(points))) return out;
    for (std::size_t i = 0; i < triangulation.tets().slots(); ++i) {
        if (!triangulation.tets().is_finite(TetId{i})) continue;
        const auto& c = triangulation.tets().corners(TetId{i});
        out.mesh.tets.push_back({c[0].value(), c[1].value(), c[2].value(), c[3].value()});
    }
    return out;
}

}  // namespace wellmesh
