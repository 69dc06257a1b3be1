// SPDX-License-Identifier: Apache-2.0
#include "brute_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "wellmesh/predicates.hpp"

namespace wellmesh::testing {
namespace {

using Tet = std::array<std::uint32_t, 4>;
using Tri = std::array<std::uint32_t, 3>;
using Seg = std::array<std::uint32_t, 2>;

constexpr std::array<std::uint32_t, 3> kCells{4, 2, 2};

std::vector<Vec3> jittered_grid() {
    std::vector<Vec3> points;
    for (std::uint32_t i = 0; i <= kCells[0]; ++i)
        for (std::uint32_t j = 0; j <= kCells[1]; ++j)
            for (std::uint32_t k = 0; k <= kCells[2]; ++k) {
                const std::uint64_t key = mix64(mix64(i, j), k);
                const auto jitter = [&](std::uint64_t axis) { return 0.24 * (unit_double(mix64(key, axis)) - 0.5); };
                const bool on_plane = i == 0 || i == 2 || i == kCells[0];
                points.push_back({i + (on_plane ? 0 : jitter(0)), j + (j == 1 ? jitter(1) : 0), k + (k == 1 ? jitter(2) : 0)});
            }
    return points;
}

std::vector<Tet> all_delaunay_tets(const std::vector<Vec3>& p) {
    std::vector<Tet> tets;
    const auto n = static_cast<std::uint32_t>(p.size());
    for (std::uint32_t a = 0; a < n; ++a)
        for (std::uint32_t b = a + 1; b < n; ++b)
            for (std::uint32_t c = b + 1; c < n; ++c)
                for (std::uint32_t d = c + 1; d < n; ++d) {
                    Tet t{a, b, c, d};
                    const Sign s = orient3d(p[a], p[b], p[c], p[d]);
                    if (s == Sign::zero) continue;
                    if (s == Sign::negative) std::swap(t[0], t[1]);
                    bool empty = true;
                    for (std::uint32_t q = 0; q < n && empty; ++q)
                        empty = q == a || q == b || q == c || q == d || insphere(p[t[0]], p[t[1]], p[t[2]], p[t[3]], p[q]) == Sign::negative;
                    if (empty) tets.push_back(t);
                }
    return tets;
}

Tri sorted(Tri t) {
    std::sort(t.begin(), t.end());
    return t;
}
Seg sorted(Seg e) {
    std::sort(e.begin(), e.end());
    return e;
}

std::map<Tri, std::vector<std::uint32_t>> tets_at_faces(const TetMesh& mesh) {
    std::map<Tri, std::vector<std::uint32_t>> faces;
    for (std::uint32_t t = 0; t < mesh.tets.size(); ++t)
        for (std::size_t skip = 0; skip < 4; ++skip) {
            Tri f{};
            for (std::size_t k = 0, n = 0; k < 4; ++k)
                if (k != skip) f[n++] = mesh.tets[t][k];
            faces[sorted(f)].push_back(t);
        }
    return faces;
}

int planes_through(const Vec3& p) { return (p.y == 0) + (p.y == 2) + (p.z == 0) + (p.z == 2) + (p.x == 0) + (p.x == 2) + (p.x == 4); }

Plc box_plc() {
    Plc plc;
    for (std::uint32_t i = 0; i < 3; ++i)
        for (std::uint32_t j = 0; j < 2; ++j)
            for (std::uint32_t k = 0; k < 2; ++k) plc.vertices.push_back({2.0 * i, 2.0 * j, 2.0 * k});
    const auto at = [](std::uint32_t i, std::uint32_t j, std::uint32_t k) { return 4 * i + 2 * j + k; };
    const auto add = [&](std::vector<std::uint32_t> polygon) { plc.facets.push_back({{std::move(polygon)}, {}, 0}); };
    for (std::uint32_t i = 0; i < 3; ++i) add({at(i, 0, 0), at(i, 1, 0), at(i, 1, 1), at(i, 0, 1)});
    for (std::uint32_t i = 0; i < 2; ++i) {
        for (std::uint32_t s = 0; s < 2; ++s) {
            add({at(i, s, 0), at(i + 1, s, 0), at(i + 1, s, 1), at(i, s, 1)});
            add({at(i, 0, s), at(i + 1, 0, s), at(i + 1, 1, s), at(i, 1, s)});
        }
    }
    return plc;
}

BoxMesh make_box() {
    BoxMesh box;
    box.plc = box_plc();
    TetMesh& m = box.mesh;
    m.vertices = jittered_grid();
    m.tets = all_delaunay_tets(m.vertices);
    for (const Tet& t : m.tets) {
        double x = 0;
        for (const std::uint32_t v : t) x += m.vertices[v].x / 4;
        m.tet_regions.push_back(x < 2 ? 1 : 2);
    }
    std::set<Seg> segments;
    for (const auto& [face, tets] : tets_at_faces(m)) {
        if (tets.size() == 2 && m.tet_regions[tets[0]] == m.tet_regions[tets[1]]) continue;
        m.subfaces.push_back(face);
        m.subface_facets.push_back(1);
        m.subface_markers.push_back(0);
        for (std::size_t k = 0; k < 3; ++k) {
            const Seg e = sorted(Seg{face[k], face[(k + 1) % 3]});
            const Vec3 middle = 0.5 * (m.vertices[e[0]] + m.vertices[e[1]]);
            if (planes_through(middle) == 2) segments.insert(e);
        }
    }
    for (const Seg& e : segments) {
        m.subsegments.push_back(e);
        m.subsegment_segments.push_back(1);
    }
    return box;
}

bool encroaches_beyond_margin(const Vec3& centre, double radius_squared, const Vec3& q) { return squared_distance(centre, q) < radius_squared * (1 - 1e-12); }

std::uint64_t encroached_triangles(const TetMesh& m, const std::set<Tri>& constraints) {
    std::uint64_t count = 0;
    for (const Tri& t : constraints) {
        const Vec3 &a = m.vertices[t[0]], u = m.vertices[t[1]] - a, v = m.vertices[t[2]] - a, n = cross(u, v);
        if (squared_norm(n) == 0) continue;
        const Vec3 to_centre = (1 / (2 * squared_norm(n))) * (squared_norm(u) * cross(v, n) + squared_norm(v) * cross(n, u));
        for (std::uint32_t q = 0; q < m.vertices.size(); ++q)
            if (q != t[0] && q != t[1] && q != t[2] && side_of_equatorial_sphere(a, m.vertices[t[1]], m.vertices[t[2]], m.vertices[q]) == Sign::positive &&
                encroaches_beyond_margin(a + to_centre, squared_norm(to_centre), m.vertices[q])) {
                ++count;
                break;
            }
    }
    return count;
}

std::set<Seg> constraint_edges(const TetMesh& m, const std::set<Tri>& constraints, double flat_angle) {
    double extent = 0;
    for (const Vec3& p : m.vertices) extent = std::max({extent, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    std::map<Seg, std::vector<std::uint32_t>> opposite;
    for (const Tri& t : constraints)
        for (std::size_t k = 0; k < 3; ++k) opposite[sorted(Seg{t[k], t[(k + 1) % 3]})].push_back(t[(k + 2) % 3]);
    std::set<Seg> edges;
    for (const auto& [e, o] : opposite) {
        if (o.size() == 2) {
            const Vec3 &p = m.vertices[e[0]], along = m.vertices[e[1]] - p;
            const Vec3 n0 = cross(along, m.vertices[o[0]] - p), n1 = cross(m.vertices[o[1]] - p, along);
            const double height = std::min(norm(n0), norm(n1)) / norm(along), bend = std::atan2(norm(cross(n0, n1)), dot(n0, n1));
            if (bend < std::max(flat_angle, 32 * std::numeric_limits<double>::epsilon() * extent / height)) continue;
        }
        edges.insert(e);
    }
    for (const Seg& e : m.subsegments) edges.insert(sorted(e));
    return edges;
}

std::uint64_t encroached_edges(const TetMesh& m, const std::set<Seg>& edges) {
    std::uint64_t count = 0;
    for (const Seg& e : edges) {
        const Vec3 &a = m.vertices[e[0]], &b = m.vertices[e[1]], centre = a + 0.5 * (b - a);
        for (std::uint32_t q = 0; q < m.vertices.size(); ++q)
            if (q != e[0] && q != e[1] && side_of_diametral_sphere(a, b, m.vertices[q]) == Sign::positive &&
                encroaches_beyond_margin(centre, squared_norm(b - a) / 4, m.vertices[q])) {
                ++count;
                break;
            }
    }
    return count;
}

std::uint64_t not_delaunay(const TetMesh& m) {
    std::uint64_t count = 0;
    for (const Tet& t : m.tets) {
        const Vec3 &a = m.vertices[t[0]], &b = m.vertices[t[1]], &c = m.vertices[t[2]], &d = m.vertices[t[3]];
        if (orient3d(a, b, c, d) != Sign::positive) continue;
        for (std::uint32_t q = 0; q < m.vertices.size(); ++q)
            if (std::find(t.begin(), t.end(), q) == t.end() && insphere(a, b, c, d, m.vertices[q]) == Sign::positive) {
                ++count;
                break;
            }
    }
    return count;
}

}  // namespace

const BoxMesh& two_region_box() {
    static const BoxMesh box = make_box();
    return box;
}

std::map<std::string, std::uint64_t> count_by_brute_force(const TetMesh& m, double flat_angle) {
    std::map<std::string, std::uint64_t> n;
    std::set<std::uint32_t> used;
    std::set<Tet> distinct;
    for (const Tet& t : m.tets) {
        n["positive_tets"] += orient3d(m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]], m.vertices[t[3]]) != Sign::positive;
        used.insert(t.begin(), t.end());
        Tet key = t;
        std::sort(key.begin(), key.end());
        distinct.insert(key);
    }
    n["distinct_tets"] = m.tets.size() - distinct.size();
    n["used_vertices"] = m.vertices.size() - used.size();
    std::set<std::array<double, 3>> places;
    for (const Vec3& p : m.vertices) places.insert({p.x, p.y, p.z});
    n["distinct_vertices"] = m.vertices.size() - places.size();

    const auto faces = tets_at_faces(m);
    std::set<Tri> constraints;
    std::set<Seg> edges;
    for (const auto& [face, tets] : faces) {
        n["face_sharing"] += tets.size() > 2 ? tets.size() - 2 : 0;
        if (tets.size() == 1 || (!m.tet_regions.empty() && m.tet_regions[tets[0]] != m.tet_regions[tets[1]])) constraints.insert(face);
        for (std::size_t k = 0; k < 3; ++k) edges.insert(sorted(Seg{face[k], face[(k + 1) % 3]}));
    }
    for (const Tri& t : m.subfaces) {
        n["listed_subfaces_exist"] += !faces.contains(sorted(t));
        constraints.insert(sorted(t));
    }
    for (const Seg& e : m.subsegments) n["listed_subsegments_exist"] += !edges.contains(sorted(e));
    n["delaunay"] = not_delaunay(m);
    n["gabriel_subfaces"] = encroached_triangles(m, constraints);
    n["gabriel_subsegments"] = encroached_edges(m, constraint_edges(m, constraints, flat_angle));
    return n;
}

}  // namespace wellmesh::testing
