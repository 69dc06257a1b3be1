// SPDX-License-Identifier: Apache-2.0
#include "conforming/check_conforming.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

double facet_area(const ConformingMesh& mesh, const ValidFacet& f) {
    double area = 0;
    for (const auto& t : f.triangles)
        area += std::abs(dot(cross(mesh.point(t[1]) - mesh.point(t[0]), mesh.point(t[2]) - mesh.point(t[0])), f.normal)) / 2;
    return area;
}

std::string triple(const ConformingMesh& mesh, const std::array<VertexId, 3>& c) {
    std::string s;
    for (const VertexId v : c) s += fmt::format("{} ({}, {}, {}) ", v.value(), mesh.point(v).x, mesh.point(v).y, mesh.point(v).z);
    return s;
}

}  // namespace

std::string check_conforming(ConformingMesh& mesh, bool gabriel) {
    const TetStore& tets = mesh.tets();
    const ValidPlc& plc = mesh.plc();
    std::string leak;  // told last: what is missing from a facet explains it
    std::vector<double> area(plc.facets.size(), 0), length(plc.segments.size(), 0);
    std::map<std::pair<VertexId, VertexId>, SegmentId> edges;
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        const TetId t{i};
        if (!tets.is_live(t)) continue;
        const auto& c = tets.corners(t);
        for (unsigned f = 0; f < 4; ++f) {
            const TetFace mine{t, f}, other = tets.across(mine);
            const FacetId facet = mesh.facet_at(mine);
            if (facet != mesh.facet_at(other)) return "labels differ on the two sides of face " + triple(mesh, tets.face_corners(mine));
            if (!facet.valid()) {
                if (mesh.cell(t) != mesh.cell(other.tet())) leak = "cells differ across an unlabelled face " + triple(mesh, tets.face_corners(mine));
                continue;
            }
            const auto fc = tets.face_corners(mine);
            for (const VertexId v : fc)
                if (!mesh.is_on_facet(v, facet)) return fmt::format("facet {} labels a face that has vertex {}, which is not on it", facet.value(), v.value());
            const ValidFacet& info = plc.facets[facet.index()];
            if (t < other.tet())
                area[facet.index()] += std::abs(dot(cross(mesh.point(fc[1]) - mesh.point(fc[0]), mesh.point(fc[2]) - mesh.point(fc[0])), info.normal)) / 2;
            if (gabriel && c[f] != kInfiniteVertex &&
                side_of_equatorial_sphere(mesh.point(fc[0]), mesh.point(fc[1]), mesh.point(fc[2]), mesh.point(c[f])) == Sign::positive)
                return "encroached subface " + triple(mesh, fc);
        }
        for (unsigned e = 0; e < 6; ++e) {
            const SegmentId s = mesh.segment_at(t, e);
            if (!s.valid()) continue;
            const VertexId a = std::min(c[kEdgeCorners[e][0]], c[kEdgeCorners[e][1]]), b = std::max(c[kEdgeCorners[e][0]], c[kEdgeCorners[e][1]]);
            const auto [it, fresh] = edges.try_emplace({a, b}, s);
            if (it->second != s) return "an edge has two segments";
            if (fresh) length[s.index()] += distance(mesh.point(a), mesh.point(b));
            if (gabriel)
                for (const VertexId v : c)
                    if (v != a && v != b && v != kInfiniteVertex && side_of_diametral_sphere(mesh.point(a), mesh.point(b), mesh.point(v)) == Sign::positive)
                        return fmt::format("encroached subsegment {} {}", a.value(), b.value());
        }
    }
    for (std::size_t i = 0; i < tets.slots(); ++i) {  // every tetrahedron around a labelled edge knows it
        if (!tets.is_live(TetId{i})) continue;
        const auto& c = tets.corners(TetId{i});
        for (unsigned e = 0; e < 6; ++e) {
            const auto it = edges.find({std::min(c[kEdgeCorners[e][0]], c[kEdgeCorners[e][1]]), std::max(c[kEdgeCorners[e][0]], c[kEdgeCorners[e][1]])});
            if (it != edges.end() && mesh.segment_at(TetId{i}, e) != it->second)
                return fmt::format("a tetrahedron does not know the subsegment {} {}", it->first.first.value(), it->first.second.value());
        }
    }
    for (std::size_t f = 0; f < area.size(); ++f) {
        const double wanted = facet_area(mesh, plc.facets[f]);
        if (!(std::abs(area[f] - wanted) <= 1e-6 * wanted)) return fmt::format("facet {} has area {}, its subfaces {}", f, wanted, area[f]);
    }
    for (std::size_t s = 0; s < length.size(); ++s) {
        const double wanted = distance(mesh.point(plc.segments[s].ends[0]), mesh.point(plc.segments[s].ends[1]));
        if (!(std::abs(length[s] - wanted) <= 1e-6 * wanted)) return fmt::format("segment {} has length {}, its subsegments {}", s, wanted, length[s]);
    }
    return leak;
}

}  // namespace wellmesh
