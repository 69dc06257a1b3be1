// SPDX-License-Identifier: Apache-2.0
// Removal of a vertex from a labelled mesh. The facets through the vertex cut its star into parts; each part's cell is flooded into the
// filling from the boundary of the hole, and where two parts meet runs the surface again. If the parts don't separate along faces of
// the right facet, the mesh without the vertex would not conform, and nothing is changed.
#include <algorithm>
#include <bit>

#include "conforming/conforming_mesh.hpp"

namespace wellmesh {

/// Lives for one removal, on the mesh's scratch.
class HoleLabeller {
public:
    HoleLabeller(ConformingMesh& mesh, const Hole& hole) : mesh_(mesh), tets_(mesh.tets()), hole_(hole), l_(mesh.hole_labels_) {}

    bool run() {
        const bool is_parted = collect_labels();
        if (!l_.ends.empty() && !segment_survives()) return false;
        inherit_facets();
        if (!is_parted) {
            l_.cell_of_part.assign(1, mesh_.cell(hole_.star[0]));
            l_.part.assign(hole_.filling.size(), 0);
            return true;
        }
        split_star();
        mark_loops();
        return flood() && find_surface();
    }

    void write(const std::vector<TetId>& fresh) {
        for (std::size_t i = 0; i < fresh.size(); ++i) {
            const TetId t = fresh[i];
            mesh_.cell_[t.index()] = l_.cell_of_part[l_.part[i]];
            for (unsigned f = 0; f < 4; ++f) {
                const FacetId facet = l_.facets[i][f];
                if (facet.valid()) mesh_.labels_for_writing(t).facets[f] = facet;
            }
            const auto& c = hole_.filling[i];
            for (unsigned e = 0; e < 6; ++e) {
                const std::uint32_t a = c[kEdgeCorners[e][0]], b = c[kEdgeCorners[e][1]];
                if ((l_.on_segment[a] & l_.on_segment[b]) == 0) continue;
                const auto s = std::find_if(l_.segments.rbegin(), l_.segments.rend(), [key = key_of(a, b)](const Edge& edge) { return edge.key == key; });
                if (s != l_.segments.rend()) mesh_.labels_for_writing(t).segments[e] = s->segment;
            }
        }
    }

    /// The healed subsegment may have been an edge already, an ulp beside the vertex: then tetrahedra outside the hole need the label too.
    void heal_segment() {
        if (!l_.ends.empty()) mesh_.label_edge(hole_.link[l_.ends[0]], hole_.link[l_.ends[1]], SegmentId{mesh_.info(hole_.vertex).carrier_id});
    }

private:
    static constexpr std::uint32_t kNone = 0xffffffffU;
    using Loop = ConformingMesh::HoleLabels::Loop;
    using LoopFace = ConformingMesh::HoleLabels::LoopFace;
    using Edge = ConformingMesh::HoleLabels::Edge;
    using Corners = std::array<std::uint32_t, 4>;

    static std::uint64_t key_of(std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }
    static bool is_inside(std::uint32_t opposite) { return (opposite & Hole::kBoundaryBit) == 0; }

    /// The star tetrahedron that has the edge ab on the link, seen from one side; its neighbour has ba. What is no such edge may hold anything.
    std::uint32_t& on_edge(std::uint32_t a, std::uint32_t b) { return l_.link_edges[a * hole_.link.size() + b]; }

    /// Parts of the star between labelled faces through the vertex.
    void split_star() {
        const std::size_t n = hole_.star.size(), most_edges = hole_.link.size() * hole_.link.size();
        if (l_.link_edges.size() < most_edges) l_.link_edges.resize(most_edges);
        for (std::size_t i = 0; i < n; ++i) {
            const Hole::LinkFace& c = hole_.link_faces[i];
            for (std::size_t k = 0; k < 3; ++k) on_edge(c[k], c[(k + 1) % 3]) = static_cast<std::uint32_t>(i);
        }
        l_.star_part.assign(n, kNone);
        l_.cell_of_part.clear();
        l_.stack.clear();
        for (std::size_t seed = 0; seed < n; ++seed) {
            if (l_.star_part[seed] != kNone) continue;
            const auto part = static_cast<std::uint32_t>(l_.cell_of_part.size());
            l_.cell_of_part.push_back(mesh_.cell(hole_.star[seed]));
            l_.star_part[seed] = part;
            l_.stack.push_back(seed);
            while (!l_.stack.empty()) {
                const std::size_t i = l_.stack.back();
                l_.stack.pop_back();
                const TetId t = hole_.star[i];
                const TetLabels* const labels = mesh_.has_labels(t) ? &mesh_.labels(t) : nullptr;
                const auto& corner = kFaceCorners[hole_.boundary[i].inside.face()];
                const Hole::LinkFace& c = hole_.link_faces[i];
                for (std::size_t k = 0; k < 3; ++k) {
                    if (labels != nullptr && labels->facets[corner[k]].valid()) continue;
                    const std::uint32_t j = on_edge(c[(k + 2) % 3], c[(k + 1) % 3]);
                    if (l_.star_part[j] != kNone) continue;
                    l_.star_part[j] = part;
                    l_.stack.push_back(j);
                }
            }
        }
    }

    std::size_t loop_of(FacetId f) {
        const auto loop = std::find_if(l_.loops.begin(), l_.loops.end(), [&](const Loop& l) { return l.facet == f; });
        const auto number = static_cast<std::size_t>(loop - l_.loops.begin());
        if (loop == l_.loops.end()) l_.loops.push_back({f, 0, 0});
        return number;
    }

    /// @return is there a labelled face through the vertex?
    bool collect_labels() {
        bool is_parted = false;
        l_.loops.clear();
        l_.loop_faces.clear();
        l_.ends.clear();
        l_.segments.clear();
        l_.on_segment.assign(hole_.link.size(), 0);
        for (std::size_t i = 0; i < hole_.star.size(); ++i) {
            const TetId t = hole_.star[i];
            if (!mesh_.has_labels(t)) continue;
            const TetLabels& labels = mesh_.labels(t);
            const unsigned apex = hole_.boundary[i].inside.face();
            Corners c{};
            for (std::size_t k = 0; k < 3; ++k) c[kFaceCorners[apex][k]] = hole_.link_faces[i][k];
            for (unsigned e = 0; e < 6; ++e) {
                if (!labels.segments[e].valid()) continue;
                const unsigned a = kEdgeCorners[e][0], b = kEdgeCorners[e][1];
                if (a != apex && b != apex) {
                    note_segment(c[a], c[b], labels.segments[e]);
                } else if (const std::uint32_t end = c[a == apex ? b : a]; std::find(l_.ends.begin(), l_.ends.end(), end) == l_.ends.end()) {
                    l_.ends.push_back(end);
                }
            }
            for (unsigned f = 0; f < 4; ++f) {
                if (f == apex || !labels.facets[f].valid()) continue;
                is_parted = true;
                if (t > tets_.across(t, f).tet()) continue;  // count each face once
                const unsigned g = kFaceCorners[f][0] == apex ? kFaceCorners[f][1] : kFaceCorners[f][0];
                const std::size_t loop = loop_of(labels.facets[f]);
                ++l_.loops[loop].faces;
                l_.loop_faces.push_back({loop, {c[g], c[6 - apex - f - g]}});
            }
        }
        // Faces of a facet at one end count its fans: one, or two where the facet goes on beyond the segment.
        if (!l_.ends.empty())
            for (const LoopFace& f : l_.loop_faces)
                if (f.corners[0] == l_.ends[0] || f.corners[1] == l_.ends[0]) ++l_.loops[f.loop].fans;
        return is_parted;
    }

    void note_segment(std::uint32_t a, std::uint32_t b, SegmentId s) {
        l_.segments.push_back({key_of(a, b), s});
        l_.on_segment[a] = l_.on_segment[b] = 1;
    }

    [[nodiscard]] std::size_t words_of_loops() const { return (l_.loops.size() + 63) / 64; }
    void mark_loops() {
        const std::size_t words = words_of_loops();
        l_.on_loops.assign(words * hole_.link.size(), 0);
        for (const LoopFace& f : l_.loop_faces)
            for (const std::uint32_t v : f.corners) l_.on_loops[words * v + f.loop / 64] |= std::uint64_t{1} << (f.loop % 64);
    }

    /// The first loop that has all corners of the face, or kNone.
    [[nodiscard]] std::size_t candidate_loop(const Corners& c, unsigned f) const {
        const auto& [a, b, d] = kFaceCorners[f];
        const std::size_t words = words_of_loops();
        for (std::size_t w = 0; w < words; ++w) {
            const std::uint64_t common = l_.on_loops[words * c[a] + w] & l_.on_loops[words * c[b] + w] & l_.on_loops[words * c[d] + w];
            if (common != 0) return 64 * w + static_cast<std::size_t>(std::countr_zero(common));
        }
        return kNone;
    }

    /// Labels of the hole's boundary.
    void inherit_facets() {
        l_.facets.assign(hole_.filling.size(), {});
        for (std::size_t i = 0; i < hole_.filling.size(); ++i)
            for (unsigned f = 0; f < 4; ++f)
                if (const std::uint32_t other = hole_.filling_opposite[i][f]; !is_inside(other))
                    l_.facets[i][f] = mesh_.facet_at(hole_.boundary[other & ~Hole::kBoundaryBit].inside);
    }

    bool flood() {
        const std::size_t n = hole_.filling.size();
        l_.part.assign(n, kNone);
        l_.stack.clear();
        for (std::size_t i = 0; i < n; ++i)
            for (unsigned f = 0; f < 4; ++f) {
                const std::uint32_t other = hole_.filling_opposite[i][f];
                if (!is_inside(other) && !reach(i, l_.star_part[other & ~Hole::kBoundaryBit])) return false;
            }
        while (true) {
            while (!l_.stack.empty()) {
                const std::size_t i = l_.stack.back();
                l_.stack.pop_back();
                for (unsigned f = 0; f < 4; ++f) {
                    const std::uint32_t other = hole_.filling_opposite[i][f];
                    if (is_inside(other) && candidate_loop(hole_.filling[i], f) == kNone && !reach(other / 4, l_.part[i])) return false;
                }
            }
            // What is left lies flat between faces of one facet: it goes to a neighbour, rather outside than inside.
            std::size_t chosen = n;
            std::uint32_t part = kNone;
            for (std::size_t i = 0; i < n; ++i) {
                if (l_.part[i] != kNone) continue;
                for (unsigned f = 0; f < 4; ++f) {
                    const std::uint32_t other = hole_.filling_opposite[i][f];
                    if (!is_inside(other)) continue;
                    const std::uint32_t theirs = l_.part[other / 4];
                    if (theirs == kNone) continue;
                    const bool outside = !mesh_.is_filled(l_.cell_of_part[theirs]);
                    if (part == kNone || (outside && mesh_.is_filled(l_.cell_of_part[part]))) {
                        chosen = i;
                        part = theirs;
                    }
                }
            }
            if (chosen == n) break;
            l_.part[chosen] = part;
            l_.stack.push_back(chosen);
        }
        return std::find(l_.part.begin(), l_.part.end(), kNone) == l_.part.end();
    }

    /// @return false if the filling's tetrahedron is in another part
    bool reach(std::size_t i, std::uint32_t part) {
        if (l_.part[i] != kNone) return l_.part[i] == part;
        l_.part[i] = part;
        l_.stack.push_back(i);
        return true;
    }

    bool find_surface() {
        l_.count.assign(l_.loops.size(), 0);
        for (std::size_t i = 0; i < hole_.filling.size(); ++i)
            for (unsigned f = 0; f < 4; ++f) {
                const std::uint32_t other = hole_.filling_opposite[i][f];
                if (!is_inside(other) || l_.part[other / 4] == l_.part[i]) continue;
                const std::size_t loop = candidate_loop(hole_.filling[i], f);
                if (loop == kNone) return false;
                l_.facets[i][f] = l_.loops[loop].facet;
                if (other / 4 > i) ++l_.count[loop];
            }
        // A disk of n faces about an inner vertex becomes n - 2 triangles; a fan of n at a segment n - 1.
        for (std::size_t l = 0; l < l_.loops.size(); ++l) {
            const std::size_t lost = l_.ends.empty() ? 2 : l_.loops[l].fans;
            if (l_.loops[l].faces < lost || l_.count[l] != l_.loops[l].faces - lost) return false;
        }
        return true;
    }

    /// Does the filling have the edge between the two ends?
    bool segment_survives() {
        if (l_.ends.size() != 2) return false;
        const std::uint32_t a = l_.ends[0], b = l_.ends[1];
        note_segment(a, b, SegmentId{mesh_.info(hole_.vertex).carrier_id});
        return std::any_of(hole_.filling.begin(), hole_.filling.end(), [&](const Corners& c) {
            return std::find(c.begin(), c.end(), a) != c.end() && std::find(c.begin(), c.end(), b) != c.end();
        });
    }

    ConformingMesh& mesh_;
    const TetStore& tets_;
    const Hole& hole_;
    ConformingMesh::HoleLabels& l_;
};

bool ConformingMesh::remove(const Hole& hole) {
    if (info(hole.vertex).carrier == CarrierKind::input_vertex) return false;
    if (std::none_of(hole.star.begin(), hole.star.end(), [&](TetId t) { return has_labels(t); })) {
        // Nothing to inherit but the one cell that the star is in.
        const CellId cell = cell_[hole.star[0].index()];
        remove_vertex(hole);
        for (const TetId t : tri_.new_tets()) cell_[t.index()] = cell;
        --vertex_count_;
        return true;
    }
    HoleLabeller labeller(*this, hole);
    if (!labeller.run()) return false;
    for (const TetId t : hole.star) drop_labels(t);
    remove_vertex(hole);
    labeller.write(tri_.new_tets());
    labeller.heal_segment();
    --vertex_count_;
    return true;
}

}  // namespace wellmesh
