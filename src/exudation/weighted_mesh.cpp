// SPDX-License-Identifier: Apache-2.0
#include "exudation/weighted_mesh.hpp"

#include <algorithm>

#include "core/check.hpp"

namespace wellmesh {
namespace {

using Edge = std::array<std::uint32_t, 2>;

Edge sorted_edge(VertexId a, VertexId b) { return a < b ? Edge{a.value(), b.value()} : Edge{b.value(), a.value()}; }

ConstraintFace sorted_face(ConstraintFace f) {
    std::sort(f.begin(), f.end());
    return f;
}

ConstraintFace corners_of(const TetStore& tets, TetFace f) {
    const auto c = tets.face_corners(f);
    return sorted_face({c[0].value(), c[1].value(), c[2].value()});
}

/// A face in the bucket of its lowest vertex: the other two in one word.
struct FaceRecord {
    std::uint64_t others = 0;
    TetFace face{};
};

}  // namespace

WeightedMesh::WeightedMesh(const TetMesh& mesh) : points_(&mesh.vertices), weights_(mesh.weights) {
    weights_.resize(mesh.vertices.size(), 0);
    const std::size_t n = mesh.tets.size();
    tet_of_.resize(mesh.vertices.size());
    degree_.assign(mesh.vertices.size(), 0);
    tets_.reserve(n + n / 16);
    for (const auto& c : mesh.tets) {
        const TetId t = tets_.allocate();
        tets_.set_corners(t, {VertexId{c[0]}, VertexId{c[1]}, VertexId{c[2]}, VertexId{c[3]}});
        for (const std::uint32_t v : c) {
            tet_of_[v] = t;
            ++degree_[v];
        }
    }
    region_ = mesh.tet_regions;
    region_.resize(n, 0);
    constrained_.assign(n, 0);
    mark_.assign(n, 0);
    connect_tets(mesh);
    constrain(mesh);
    for (const auto& s : mesh.subsegments) subsegments_.push_back(sorted_edge(VertexId{s[0]}, VertexId{s[1]}));
    std::sort(subsegments_.begin(), subsegments_.end());
    on_subsegment_.assign(mesh.vertices.size(), 0);
    for (const Edge& s : subsegments_) on_subsegment_[s[0]] = on_subsegment_[s[1]] = 1;
}

/// Equal faces meet in the bucket of their lowest vertex (counting sort, then a sort of each short bucket).
void WeightedMesh::connect_tets(const TetMesh& mesh) {
    std::vector<std::uint32_t> first(mesh.vertices.size() + 2, 0);
    const auto for_faces = [&](auto&& visit) {
        for (std::size_t t = 0; t < mesh.tets.size(); ++t)
            for (unsigned f = 0; f < 4; ++f) visit(corners_of(tets_, TetFace{TetId{t}, f}), TetFace{TetId{t}, f});
    };
    for_faces([&](const ConstraintFace& c, TetFace) { ++first[c[0] + 2]; });
    for (std::size_t v = 2; v < first.size(); ++v) first[v] += first[v - 1];
    std::vector<FaceRecord> records(first.back());
    for_faces([&](const ConstraintFace& c, TetFace f) { records[first[c[0] + 1]++] = {std::uint64_t{c[1]} << 32 | c[2], f}; });
    for (std::size_t v = 0; v + 2 < first.size(); ++v) {
        const auto begin = records.begin() + first[v], end = records.begin() + first[v + 1];
        std::sort(begin, end, [](const FaceRecord& a, const FaceRecord& b) {
            return a.others != b.others ? a.others < b.others : a.face.tet() < b.face.tet();
        });
        for (auto i = begin; i != end; ++i) {
            if (i + 1 == end || i->others != (i + 1)->others) continue;
            WELLMESH_CHECK(Stage::shape, i + 2 == end || (i + 2)->others != i->others);
            tets_.connect(i->face, (i + 1)->face);
            ++i;
        }
    }
}

void WeightedMesh::constrain(const TetMesh& mesh) {
    std::vector<ConstraintFace> listed;
    listed.reserve(mesh.subfaces.size());
    for (const auto& f : mesh.subfaces) listed.push_back(sorted_face(f));
    std::sort(listed.begin(), listed.end());
    std::vector<char> on_listed(mesh.vertices.size(), 0);
    for (const ConstraintFace& f : listed)
        for (const std::uint32_t v : f) on_listed[v] = 1;
    for (std::size_t i = 0; i < tets_.slots(); ++i)
        for (unsigned k = 0; k < 4; ++k) {
            const TetFace f{TetId{i}, k}, other = tets_.across(f);
            if (other.valid() && region_[other.tet().index()] == region_[i]) {
                const ConstraintFace c = corners_of(tets_, f);
                if (on_listed[c[0]] == 0 || on_listed[c[1]] == 0 || on_listed[c[2]] == 0 || !std::binary_search(listed.begin(), listed.end(), c)) continue;
            }
            constrain(f);
            if (!other.valid() || f.tet() < other.tet()) constraint_faces_.push_back(corners_of(tets_, f));
        }
}

bool WeightedMesh::is_subsegment(VertexId a, VertexId b) const {
    if (on_subsegment_[a.index()] == 0 || on_subsegment_[b.index()] == 0) return false;
    return std::binary_search(subsegments_.begin(), subsegments_.end(), sorted_edge(a, b));
}

bool WeightedMesh::find_star(VertexId v, std::vector<TetId>& star) const {
    star.clear();
    if (!tet_of_[v.index()].valid()) return false;
    ++mark_value_;
    star.push_back(tet_of_[v.index()]);
    mark_[star[0].index()] = mark_value_;
    for (std::size_t i = 0; i < star.size(); ++i) {
        const TetId t = star[i];
        const unsigned k = tets_.find_corner(t, v);
        for (unsigned f = 0; f < 4; ++f) {
            if (f == k) continue;
            const TetFace other = tets_.across(t, f);
            if (!other.valid() || mark_[other.tet().index()] == mark_value_) continue;
            mark_[other.tet().index()] = mark_value_;
            star.push_back(other.tet());
        }
    }
    return star.size() == degree_[v.index()];
}

/// Faces of t that v is on.
void WeightedMesh::collect_sides(VertexId v, TetId t) {
    const unsigned k = tets_.find_corner(t, v);
    for (unsigned f = 0; f < 4; ++f) {
        if (f == k) continue;
        VertexId ends[2];
        for (unsigned i = 0, n = 0; i < 4; ++i)
            if (i != f && i != k) ends[n++] = tets_.corner(t, i);
        sides_.push_back({sorted_edge(ends[0], ends[1]), TetFace{t, f}, is_constrained(TetFace{t, f})});
    }
}

/// Two new tetrahedra meet in each side, or it is on the hull.
void WeightedMesh::connect_sides() {
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) { return a.edge != b.edge ? a.edge < b.edge : a.face.tet() < b.face.tet(); });
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        const bool rim = std::binary_search(rim_edges_.begin(), rim_edges_.end(), sides_[i].edge);
        const bool pair = i + 1 < sides_.size() && sides_[i + 1].edge == sides_[i].edge;
        WELLMESH_CHECK(Stage::shape, pair || rim);
        if (rim) constrain(sides_[i].face);
        if (!pair) continue;
        tets_.connect(sides_[i].face, sides_[i + 1].face);
        if (rim) constrain(sides_[i + 1].face);
        ++i;
    }
}

void WeightedMesh::replace_star(VertexId v, double weight, const std::vector<TetId>& deleted, const std::vector<BoundaryFace>& link,
                                 std::vector<TetId>& created) {
    struct Piece {
        std::array<VertexId, 3> face{};
        TetFace outside{};
        std::int32_t region = 0;
        bool constrained = false;
    };
    std::vector<Piece> pieces;
    pieces.reserve(link.size());
    for (const BoundaryFace& f : link) pieces.push_back({tets_.face_corners(f.inside), f.outside, region_[f.inside.tet().index()], is_constrained(f.inside)});
    sides_.clear();
    for (const TetId t : deleted)
        if (tets_.find_corner(t, v) < 4) collect_sides(v, t);
    rim_edges_.clear();
    for (const Side& s : sides_)
        if (s.constrained) rim_edges_.push_back(s.edge);
    std::sort(rim_edges_.begin(), rim_edges_.end());
    for (const TetId t : deleted) {
        for (const VertexId c : tets_.corners(t)) --degree_[c.index()];
        tets_.release(t);
    }
    weights_[v.index()] = weight;
    created.clear();
    sides_.clear();
    for (const Piece& p : pieces) {
        const TetId t = tets_.allocate();
        if (t.index() >= region_.size()) {
            region_.resize(t.index() + 1);
            constrained_.resize(t.index() + 1);
            mark_.resize(t.index() + 1, 0);
        }
        // face_corners are seen counter-clockwise from the inside: with the vertex inside as the fourth corner the tetrahedron is positive.
        tets_.set(t, {p.face[0], p.face[1], p.face[2], v}, {});
        region_[t.index()] = p.region;
        constrained_[t.index()] = 0;
        if (p.outside.valid()) tets_.connect(TetFace{t, 3}, p.outside);
        if (p.constrained) constrain(TetFace{t, 3});
        for (const VertexId c : tets_.corners(t)) {
            ++degree_[c.index()];
            tet_of_[c.index()] = t;
        }
        created.push_back(t);
        collect_sides(v, t);
    }
    connect_sides();
}

void WeightedMesh::write_to(TetMesh& mesh) const {
    // As the mesh had them: by lowest vertex.
    std::vector<std::uint32_t> first(mesh.vertices.size() + 1, 0);
    const auto lowest = [&](TetId t) {
        const auto& c = tets_.corners(t);
        return std::min({c[0], c[1], c[2], c[3]}).index();
    };
    for (std::size_t i = 0; i < tets_.slots(); ++i)
        if (tets_.is_live(TetId{i})) ++first[lowest(TetId{i}) + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    const bool has_regions = !mesh.tet_regions.empty();
    mesh.tets.resize(tets_.live());
    if (has_regions) mesh.tet_regions.resize(tets_.live());
    for (std::size_t i = 0; i < tets_.slots(); ++i) {
        const TetId t{i};
        if (!tets_.is_live(t)) continue;
        const std::uint32_t at = first[lowest(t)]++;
        const auto& c = tets_.corners(t);
        mesh.tets[at] = {c[0].value(), c[1].value(), c[2].value(), c[3].value()};
        if (has_regions) mesh.tet_regions[at] = region_[i];
    }
    const bool any = std::any_of(weights_.begin(), weights_.end(), [](double w) { return w != 0; });
    mesh.weights = any ? weights_ : std::vector<double>{};
}

}  // namespace wellmesh
