// SPDX-License-Identifier: Apache-2.0
#include "certify/plane_triangulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "certify/planar_mesh.hpp"
#include "core/infinity.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

/// Twice the vector area of a polygon (Newell), about its first vertex.
Vec3 vector_area(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& polygon) {
    Vec3 sum{};
    const Vec3& origin = points[polygon[0]];
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) sum = sum + cross(points[polygon[i]] - origin, points[polygon[i + 1]] - origin);
    return sum;
}

struct Projection {
    int dropped = 2;
    [[nodiscard]] Point2 operator()(const Vec3& p) const {
        // Adding zero turns -0 into 0, so that equal points have equal bits.
        return dropped == 0 ? Point2{p.y + 0.0, p.z + 0.0} : dropped == 1 ? Point2{p.x + 0.0, p.z + 0.0} : Point2{p.x + 0.0, p.y + 0.0};
    }
};

/// Position along a curve that keeps neighbours together (bits of x and y interleaved), so that walks are short.
std::uint64_t curve_position(const Point2& p, const Point2& low, double scale) {
    const auto cell = [&](double x, double least) { return static_cast<std::uint64_t>(std::clamp((x - least) * scale, 0.0, 65535.0)); };
    const std::uint64_t x = cell(p.x, low.x), y = cell(p.y, low.y);
    std::uint64_t position = 0;
    for (std::uint64_t bit = 0; bit < 16; ++bit) position |= ((x >> bit & 1) << (2 * bit)) | ((y >> bit & 1) << (2 * bit + 1));
    return position;
}

struct Site {
    Point2 at;
    std::uint32_t vertex = 0;  // of the PLC
    std::uint64_t position = 0;
};

/// Where a crossing lies in space: on the plane through three corners of the largest polygon, in the dropped direction.
class Lift {
public:
    Lift(const Vec3& origin, const Vec3& normal, int dropped) : origin_(origin), normal_(normal), dropped_(dropped) {}
    [[nodiscard]] Vec3 operator()(const Point2& p) const {
        const Vec3 &o = origin_, &n = normal_;
        if (dropped_ == 0) return {o.x - (n.y * (p.x - o.y) + n.z * (p.y - o.z)) / n.x, p.x, p.y};
        if (dropped_ == 1) return {p.x, o.y - (n.x * (p.x - o.x) + n.z * (p.y - o.z)) / n.y, p.y};
        return {p.x, p.y, o.z - (n.x * (p.x - o.x) + n.y * (p.y - o.y)) / n.z};
    }

private:
    Vec3 origin_, normal_;
    int dropped_;
};

std::optional<std::vector<Corners>> triangulate(const std::vector<Vec3>& points, const PlcFacet& facet, const Projection& projected, const Lift& lift) {
    std::vector<Site> sites;
    Point2 low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};
    for (const auto& polygon : facet.polygons)
        for (const std::uint32_t v : polygon) {
            const Point2 p = projected(points[v]);
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
            sites.push_back({p, v, 0});
        }
    const double scale = 65535 / std::max({high.x - low.x, high.y - low.y, std::numeric_limits<double>::min()});
    for (Site& s : sites) s.position = curve_position(s.at, low, scale);
    std::sort(sites.begin(), sites.end(), [](const Site& a, const Site& b) { return a.position != b.position ? a.position < b.position : a.vertex < b.vertex; });

    PlanarMesh mesh(low, high);
    std::vector<std::uint32_t> plc_vertex(4, 0);                           // of each planar vertex; the outer four have none
    std::vector<std::pair<std::uint32_t, std::uint32_t>> planar_vertex;  // (PLC vertex, planar vertex), sorted
    for (const Site& s : sites) {
        const std::uint32_t v = mesh.insert(s.at);
        if (v == plc_vertex.size()) plc_vertex.push_back(s.vertex);
        planar_vertex.emplace_back(s.vertex, v);
    }
    std::sort(planar_vertex.begin(), planar_vertex.end());
    const auto planar = [&](std::uint32_t v) { return std::lower_bound(planar_vertex.begin(), planar_vertex.end(), std::pair{v, 0U})->second; };
    mesh.freeze();
    mesh.max_crossings = 4 * sites.size() + 64;
    for (const auto& polygon : facet.polygons)
        for (std::size_t i = 0; i < polygon.size(); ++i)
            if (!mesh.constrain(planar(polygon[i]), planar(polygon[(i + 1) % polygon.size()]))) return std::nullopt;
    mesh.mark_from_outside();
    for (const Vec3& h : facet.holes) mesh.mark_from(projected(h));

    std::vector<Corners> result;
    for (const auto& t : mesh.unmarked()) {
        Corners c;
        for (std::size_t k = 0; k < 3; ++k) c[k] = mesh.made_by_crossing(t[k]) ? lift(mesh.points()[t[k]]) : points[plc_vertex[t[k]]];
        result.push_back(c);
    }
    return result;
}

}  // namespace

std::optional<std::vector<Corners>> triangulate_facet(const std::vector<Vec3>& points, const PlcFacet& facet) {
    Vec3 normal{}, origin{};
    for (const auto& polygon : facet.polygons) {
        if (polygon.size() < 3) continue;
        const Vec3 n = vector_area(points, polygon);
        if (squared_norm(n) > squared_norm(normal)) normal = n, origin = points[polygon[0]];
    }
    if (!(squared_norm(normal) > 0)) return std::vector<Corners>{};
    if (facet.polygons.size() == 1 && facet.polygons[0].size() == 3 && facet.holes.empty()) {
        const auto& t = facet.polygons[0];
        return std::vector<Corners>{{points[t[0]], points[t[1]], points[t[2]]}};
    }
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    const int dropped = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    return triangulate(points, facet, Projection{dropped}, Lift(origin, normal, dropped));
}

}  // namespace wellmesh::certifying
