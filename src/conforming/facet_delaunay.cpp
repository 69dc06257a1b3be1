// SPDX-License-Identifier: Apache-2.0
#include "conforming/facet_delaunay.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "conforming/place_point.hpp"
#include "core/vec3_math.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {

FacetDelaunay::FacetDelaunay(const ConformingMesh& mesh, FacetId f) : facet_(f) {
    collect_vertices(mesh);
    triangulate();
}

void FacetDelaunay::collect_vertices(const ConformingMesh& mesh) {
    const ValidPlc& plc = mesh.plc();
    const ValidFacet& facet = plc.facets[facet_.index()];
    vertices_ = facet.vertices;
    for (const VertexId v : mesh.steiner_vertices_of(facet_)) vertices_.push_back(v);
    for (const SegmentId s : facet.segments) {
        const std::vector<VertexId> chain = mesh.chain_of(s);
        for (std::size_t i = 0; i + 1 < chain.size(); ++i) subsegments_.push_back({{std::min(chain[i], chain[i + 1]), std::max(chain[i], chain[i + 1])}, s});
    }
    std::sort(subsegments_.begin(), subsegments_.end());
    // In a coordinate plane the coordinates themselves are exact, and their lexicographic order, which breaks ties, is the mesh's own.
    const Vec3& n = facet.normal;
    for (const VertexId v : vertices_) {
        const Vec3& p = mesh.point(v);
        if (n.y == 0 && n.z == 0) {
            flat_.push_back({p.y, p.z, 0});
        } else if (n.x == 0 && n.z == 0) {
            flat_.push_back({p.x, p.z, 0});
        } else if (n.x == 0 && n.y == 0) {
            flat_.push_back({p.x, p.y, 0});
        } else {
            const auto [u, w] = facet_coordinates(facet, p);
            flat_.push_back(flush_to_exact_range(Vec3{u, w, 0}));
        }
    }
}

/// The facet's segment of which ab is a piece, or an invalid one.
SegmentId FacetDelaunay::segment_between(VertexId a, VertexId b) const {
    const std::array<VertexId, 2> ends{std::min(a, b), std::max(a, b)};
    const auto at = std::lower_bound(subsegments_.begin(), subsegments_.end(), ends, [](const auto& s, const auto& e) { return s.first < e; });
    return at != subsegments_.end() && at->first == ends ? at->second : SegmentId{};
}

double FacetDelaunay::area2(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3 u = flat_[b] - flat_[a], v = flat_[c] - flat_[a];
    return u.x * v.y - u.y * v.x;
}

void FacetDelaunay::triangulate() {
    Vec3 lo, hi;
    bounding_box(flat_, lo, hi);
    std::vector<Vec3> points = flat_;
    const auto apex = static_cast<std::uint32_t>(points.size());
    const double height = std::max(hi.x - lo.x, hi.y - lo.y);
    points.push_back({lo.x, lo.y, height});
    Triangulation cone({lo.x, lo.y, 0}, {hi.x, hi.y, height});
    if (!cone.insert_all(points)) return;
    const TetStore& tets = cone.tets();
    std::vector<std::uint32_t> number(tets.slots(), kNone);
    const auto is_triangle = [&](TetId t) { return tets.is_finite(t) && tets.find_corner(t, VertexId{apex}) < 4; };
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        const TetId t{i};
        if (!is_triangle(t)) continue;
        number[i] = static_cast<std::uint32_t>(triangles_.size());
        const auto c = tets.face_corners(TetFace{t, tets.find_corner(t, VertexId{apex})});
        triangles_.push_back({c[0].value(), c[1].value(), c[2].value()});
    }
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        if (number[i] == kNone) continue;
        std::array<std::uint32_t, 3> around{};
        for (std::size_t k = 0; k < 3; ++k)
            around[k] = number[tets.across(TetId{i}, tets.find_corner(TetId{i}, VertexId{triangles_[number[i]][k]})).tet().index()];
        neighbours_.push_back(around);
    }
}

/// On which sides of its segments the facet lies, in the plane of flat_.
std::map<SegmentId, FacetDelaunay::InnerSides> FacetDelaunay::inner_sides(const ConformingMesh& mesh) const {
    const ValidPlc& plc = mesh.plc();
    const ValidFacet& facet = plc.facets[facet_.index()];
    const auto flat = [&](VertexId v) { return flat_[static_cast<std::size_t>(std::lower_bound(facet.vertices.begin(), facet.vertices.end(), v) - facet.vertices.begin())]; };
    double twice_area = 0;  // flat_ may be mirrored
    std::vector<std::pair<VertexId, VertexId>> edges;
    for (const auto& t : facet.triangles) {
        const Vec3 a = flat(t[0]), u = flat(t[1]) - a, v = flat(t[2]) - a;
        twice_area += u.x * v.y - u.y * v.x;
        for (std::size_t k = 0; k < 3; ++k) edges.push_back({t[k], t[(k + 1) % 3]});
    }
    std::sort(edges.begin(), edges.end());
    std::map<SegmentId, InnerSides> sides;
    for (const SegmentId s : facet.segments) {
        const auto& ends = plc.segments[s.index()].ends;
        const bool forth = std::binary_search(edges.begin(), edges.end(), std::pair{ends[0], ends[1]});
        const bool back = std::binary_search(edges.begin(), edges.end(), std::pair{ends[1], ends[0]});
        sides[s] = {flat(ends[1]) - flat(ends[0]), twice_area > 0 ? forth : back, twice_area > 0 ? back : forth};
    }
    return sides;
}

/// Drops the triangles outside the facet: components between subsegments, each judged by the sides of the subsegments that it has. Coordinates could
/// not tell: rounding bends straight outlines inwards, and what closes the hull there is as thin as the rounding.
void FacetDelaunay::keep_inside(const ConformingMesh& mesh) {
    const auto sides = inner_sides(mesh);
    double twice_area = 0;
    for (const auto& c : triangles_) twice_area += area2(c[0], c[1], c[2]);
    std::vector<std::uint32_t> component(triangles_.size(), kNone);
    std::vector<char> inside;
    for (std::uint32_t seed = 0; seed < triangles_.size(); ++seed) {
        if (component[seed] != kNone) continue;
        const auto id = static_cast<std::uint32_t>(inside.size());
        std::vector<std::uint32_t> stack{seed};
        component[seed] = id;
        double vote = 0;  // length of outline that has it inside, minus that which has it outside: rounding may turn short pieces
        while (!stack.empty()) {
            const std::uint32_t t = stack.back();
            stack.pop_back();
            const auto& c = triangles_[t];
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t n = neighbours_[t][k], from = c[(k + 1) % 3], to = c[(k + 2) % 3];
                if (n != kNone && component[n] == id) continue;
                const auto side = sides.find(segment_between(vertices_[from], vertices_[to]));
                if (side != sides.end()) {
                    const Vec3 edge = flat_[to] - flat_[from];
                    const bool on_left = (dot(edge, side->second.along) > 0) == (twice_area > 0);
                    vote += ((on_left ? side->second.left : side->second.right) ? 1 : -1) * norm(edge);
                } else if (n != kNone && component[n] == kNone) {
                    component[n] = id;
                    stack.push_back(n);
                }
            }
        }
        inside.push_back(vote > 0 ? 1 : 0);
    }
    std::vector<std::uint32_t> renumbered(triangles_.size(), kNone);
    std::uint32_t kept = 0;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
        if (inside[component[t]]) renumbered[t] = kept++;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        if (renumbered[t] == kNone) continue;
        triangles_[renumbered[t]] = triangles_[t];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t n = neighbours_[t][k];
            neighbours_[renumbered[t]][k] = n == kNone ? kNone : renumbered[n];
        }
    }
    triangles_.resize(kept);
    neighbours_.resize(kept);
    if (kept > 0) return;
    const ValidFacet& facet = mesh.plc().facets[facet_.index()];
    throw MeshError(ErrorCode::budget_exhausted, Stage::conform, fmt::format("facet {} is as thin as the rounding of its plane and turned over by it", facet.source_facet + 1),
                    {{EntityKind::facet, facet.source_facet + 1U, facet.origin}});
}

/// Advances a front from the outline of a cluster of missing triangles over faces of the mesh until the cluster is covered.
bool FacetDelaunay::cover(ConformingMesh& mesh, const std::vector<std::size_t>& cluster, std::vector<TetFace>& faces) const {
    const double turn = area2(triangles_[cluster[0]][0], triangles_[cluster[0]][1], triangles_[cluster[0]][2]) > 0 ? 1 : -1;
    std::map<VertexId, std::uint32_t> local;
    std::map<std::pair<std::uint32_t, std::uint32_t>, bool> front;  // directed edges with the uncovered part on the triangles' side
    double wanted = 0, covered = 0;
    for (const std::size_t t : cluster) {
        const auto& c = triangles_[t];
        wanted += std::abs(area2(c[0], c[1], c[2]));
        for (std::size_t k = 0; k < 3; ++k) {
            local[vertices_[c[k]]] = c[k];
            if (!front.erase({c[(k + 2) % 3], c[(k + 1) % 3]})) front[{c[(k + 1) % 3], c[(k + 2) % 3]}] = true;
        }
    }
    Triangulation& tri = mesh.triangulation();
    const TetStore& tets = tri.tets();
    std::vector<TetFace> found;
    while (!front.empty()) {
        const auto [from, to] = front.begin()->first;
        const VertexId a = vertices_[from], b = vertices_[to];
        const TetId first = tri.find_edge(a, b);
        if (!first.valid()) return false;
        TetId t = first;
        VertexId ahead{}, behind{};
        for (const VertexId v : tets.corners(t))
            if (v != a && v != b) (ahead.valid() ? behind : ahead) = v;
        TetFace chosen{};
        std::uint32_t third = kNone;
        do {
            const auto it = local.find(ahead);
            if (it != local.end() && turn * area2(from, to, it->second) > 0) {
                // Of two faces over one edge (a flat tetrahedron between them) take the one whose sphere is emptier.
                bool better = third == kNone;
                if (!better) better = side_of_equatorial_sphere(mesh.point(a), mesh.point(b), mesh.point(vertices_[third]), mesh.point(ahead)) == Sign::positive;
                if (better) {
                    third = it->second;
                    chosen = TetFace{t, tets.find_corner(t, behind)};
                }
            }
            const TetFace next = tets.across(t, tets.find_corner(t, behind));
            behind = ahead;
            ahead = tets.corner(next.tet(), next.face());
            t = next.tet();
        } while (t != first);
        if (third == kNone) return false;
        covered += std::abs(area2(from, to, third));
        if (covered > wanted * (1 + 1e-6)) return false;
        found.push_back(chosen);
        front.erase(front.begin());
        for (const auto& side : {std::pair{to, third}, std::pair{third, from}})
            if (!front.erase(side)) front[{side.second, side.first}] = true;
    }
    faces.insert(faces.end(), found.begin(), found.end());
    return true;
}

std::vector<FacetDelaunay::Missing> FacetDelaunay::match_faces(ConformingMesh& mesh) {
    keep_inside(mesh);
    faces_.clear();
    std::vector<char> missing(triangles_.size(), 0);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        const auto& c = triangles_[t];
        const TetFace tf = mesh.triangulation().find_face(vertices_[c[0]], vertices_[c[1]], vertices_[c[2]]);
        if (tf.valid()) faces_.push_back(tf);
        else missing[t] = 1;
    }
    std::vector<std::pair<double, Missing>> lost;
    for (std::size_t seed = 0; seed < triangles_.size(); ++seed) {
        if (missing[seed] != 1) continue;
        std::vector<std::size_t> cluster{seed};
        missing[seed] = 2;
        for (std::size_t i = 0; i < cluster.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t n = neighbours_[cluster[i]][k];
                const auto& c = triangles_[cluster[i]];
                if (n == kNone || missing[n] != 1 || segment_between(vertices_[c[(k + 1) % 3]], vertices_[c[(k + 2) % 3]]).valid()) continue;
                missing[n] = 2;
                cluster.push_back(n);
            }
        if (cluster.size() > 1 && cover(mesh, cluster, faces_)) continue;
        for (const std::size_t t : cluster) {
            const auto& c = triangles_[t];
            double radius = 0;
            (void)circumcentre(flat_[c[0]], flat_[c[1]], flat_[c[2]], &radius);
            lost.push_back({radius, {{vertices_[c[0]], vertices_[c[1]], vertices_[c[2]]}}});
        }
    }
    std::stable_sort(lost.begin(), lost.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Missing> out;
    for (const auto& l : lost) out.push_back(l.second);
    return out;
}

}  // namespace wellmesh
