// SPDX-License-Identifier: Apache-2.0
// Facets as formats without polygons or holes can state them.
#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "validation/report.hpp"
#include "validation/triangulate_facet.hpp"
#include "wellmesh/convert.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {
namespace {

class FacetSimplifier {
public:
    FacetSimplifier(const Plc& plc, std::size_t most_corners)
        : plc_(plc), most_corners_(most_corners), number_(plc.vertices.size(), kUnused), out_(plc) {}

    Plc run() {
        out_.facets.clear();
        out_.facet_lines.clear();
        for (std::size_t f = 0; f < plc_.facets.size(); ++f) {
            const PlcFacet& facet = plc_.facets[f];
            if (is_simple(facet)) keep(f, facet.polygons);
            else triangulate(f);
        }
        return std::move(out_);
    }

private:
    [[nodiscard]] bool is_simple(const PlcFacet& facet) const {
        return facet.polygons.size() == 1 && facet.holes.empty() &&
               (facet.polygons[0].size() == 1 || (facet.polygons[0].size() >= 3 && facet.polygons[0].size() <= most_corners_));
    }

    void keep(std::size_t f, std::vector<std::vector<std::uint32_t>> polygons) {
        out_.facets.push_back({std::move(polygons), {}, plc_.facets[f].marker});
        if (!plc_.facet_lines.empty()) out_.facet_lines.push_back(plc_.facet_lines[f]);
    }

    [[noreturn]] void fail(std::size_t f, const char* why) const {
        const Vec3& where = plc_.vertices[plc_.facets[f].polygons[0][0]];
        throw MeshError(ErrorCode::bad_input, Stage::validate,
                        fmt::format("facet {} at {} can't be triangulated: {}", f + plc_.first_number, format_point(where), why),
                        {{EntityKind::facet, f + plc_.first_number, where}});
    }

    void triangulate(std::size_t f) {
        const PlcFacet& facet = plc_.facets[f];
        std::vector<std::uint32_t> vertices;
        std::vector<Vec3> points;
        std::vector<std::array<std::uint32_t, 2>> edges;
        const auto local = [&](std::uint32_t v) {
            if (number_[v] == kUnused) {
                number_[v] = static_cast<std::uint32_t>(vertices.size());
                vertices.push_back(v);
                points.push_back(plc_.vertices[v]);
            }
            return number_[v];
        };
        for (const auto& polygon : facet.polygons) {
            for (std::size_t i = 0; i < polygon.size(); ++i) {
                const std::uint32_t a = local(polygon[i]), b = local(polygon[(i + 1) % polygon.size()]);
                if (a != b) edges.push_back({a, b});
            }
            if (polygon.size() == 2) out_.segments.push_back({{polygon[0], polygon[1]}, 0});
            if (polygon.size() == 1) keep(f, {polygon});
        }
        for (const std::uint32_t v : vertices) number_[v] = kUnused;
        if (points.size() < 3) return;
        const FittedPlane plane = fit_plane(points);
        const FacetTriangulation flat = triangulate_facet(points, PlaneProjection(plane.normal), edges, facet.holes, 0);
        if (!flat.crossings.empty()) fail(f, "two of its edges cross");
        if (!flat.coincident.empty()) fail(f, "two of its vertices are at one place of its plane");
        if (flat.triangles.empty()) fail(f, "it encloses no area");
        const bool turned = turns_against(facet, flat.triangles, points);
        for (const auto& t : flat.triangles) {
            std::vector<std::uint32_t> corners{vertices[t[0]], vertices[t[1]], vertices[t[2]]};
            if (turned) std::swap(corners[1], corners[2]);
            keep(f, {std::move(corners)});
        }
    }

    /// Whether the triangles turn against the largest polygon, which is the outer one.
    [[nodiscard]] bool turns_against(const PlcFacet& facet, const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                     const std::vector<Vec3>& points) const {
        const auto twice_area = [](const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a); };
        Vec3 of_triangles{}, of_polygon{};
        for (const auto& t : triangles) of_triangles = of_triangles + twice_area(points[t[0]], points[t[1]], points[t[2]]);
        const auto& outer = *std::max_element(facet.polygons.begin(), facet.polygons.end(),
                                              [&](const auto& p, const auto& q) { return squared_norm(area(p)) < squared_norm(area(q)); });
        of_polygon = area(outer);
        return dot(of_triangles, of_polygon) < 0;
    }
    [[nodiscard]] Vec3 area(const std::vector<std::uint32_t>& polygon) const {
        Vec3 sum{};
        for (std::size_t i = 2; i < polygon.size(); ++i)
            sum = sum + cross(plc_.vertices[polygon[i - 1]] - plc_.vertices[polygon[0]], plc_.vertices[polygon[i]] - plc_.vertices[polygon[0]]);
        return sum;
    }

    static constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    const Plc& plc_;
    std::size_t most_corners_;
    std::vector<std::uint32_t> number_;  // of a vertex within the facet at hand
    Plc out_;
};

}  // namespace

Plc with_simple_facets(const Plc& plc, std::size_t most_corners) { return FacetSimplifier(plc, most_corners).run(); }

}  // namespace wellmesh
