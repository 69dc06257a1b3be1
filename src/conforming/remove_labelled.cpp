// SPDX-License-Identifier: Apache-2.0
// Removal of a vertex from a labelled mesh. The facets through the vertex cut its star into parts; each part's cell is flooded into the
// filling from the boundary of the hole, and where two parts meet runs the surface again. If the parts don't separate along faces of
// the right facet, the mesh without the vertex would not conform, and nothing is changed.
#include <algorithm>

#include "conforming/conforming_mesh.hpp"

namespace wellmesh {

class HoleLabeller {
public:
    HoleLabeller(ConformingMesh& mesh, const Hole& hole) : mesh_(mesh), tets_(mesh.tets()), hole_(hole) {}

    bool run() {
        split_star();
        collect_labels();
        return flood() && find_surface() && segment_survives();
    }

    void write(const std::vector<TetId>& fresh) {
        for (std::size_t i = 0; i < fresh.size(); ++i) {
            const TetId t = fresh[i];
            mesh_.cell_[t.index()] = cell_of_part_[part_[i]];
            for (unsigned f = 0; f < 4; ++f) {
                const FacetId facet = new_labels_[i].facets[f];
                if (facet.valid()) mesh_.labels_for_writing(t).facets[f] = facet;
            }
            const auto& c = hole_.filling[i];
            for (const Subsegment& s : segments_)
                for (unsigned e = 0; e < 6; ++e) {
                    const VertexId a = c[kEdgeCorners[e][0]], b = c[kEdgeCorners[e][1]];
                    if ((a == s.a && b == s.b) || (a == s.b && b == s.a)) mesh_.labels_for_writing(t).segments[e] = s.segment;
                }
        }
    }

    /// The healed subsegment may have been an edge already, an ulp beside the vertex: then tetrahedra outside the hole need the label too.
    void heal_segment() {
        if (ends_.size() == 2) mesh_.label_edge(ends_[0], ends_[1], SegmentId{mesh_.info(hole_.vertex).carrier_id});
    }

private:
    static constexpr std::uint32_t kNone = 0xffffffffU;
    struct Loop {
        FacetId facet{};
        std::vector<VertexId> vertices;
        std::size_t faces = 0, fans = 0;
    };

    /// Parts of the star between labelled faces through the vertex.
    void split_star() {
        const auto& star = hole_.star;
        star_part_.assign(star.size(), kNone);
        const auto index = [&](TetId t) { return static_cast<std::size_t>(std::find(star.begin(), star.end(), t) - star.begin()); };
        for (std::size_t seed = 0; seed < star.size(); ++seed) {
            if (star_part_[seed] != kNone) continue;
            const auto part = static_cast<std::uint32_t>(cell_of_part_.size());
            cell_of_part_.push_back(mesh_.cell(star[seed]));
            std::vector<std::size_t> stack{seed};
            star_part_[seed] = part;
            while (!stack.empty()) {
                const TetId t = star[stack.back()];
                stack.pop_back();
                const unsigned at = tets_.find_corner(t, hole_.vertex);
                for (unsigned f = 0; f < 4; ++f) {
                    if (f == at || mesh_.facet_at(TetFace{t, f}).valid()) continue;
                    const std::size_t n = index(tets_.across(t, f).tet());
                    if (star_part_[n] != kNone) continue;
                    star_part_[n] = part;
                    stack.push_back(n);
                }
            }
        }
    }

    Loop& loop_of(FacetId f) {
        for (Loop& l : loops_)
            if (l.facet == f) return l;
        loops_.push_back({f, {}, 0, 0});
        return loops_.back();
    }

    void collect_labels() {
        const VertexId v = hole_.vertex;
        for (std::size_t i = 0; i < hole_.star.size(); ++i) {
            const TetId t = hole_.star[i];
            if (!mesh_.has_labels(t)) continue;
            const TetLabels& l = mesh_.labels(t);
            const auto& c = tets_.corners(t);
            for (unsigned e = 0; e < 6; ++e) {
                if (!l.segments[e].valid()) continue;
                const VertexId a = c[kEdgeCorners[e][0]], b = c[kEdgeCorners[e][1]];
                if (a == v || b == v) {
                    const VertexId end = a == v ? b : a;
                    if (std::find(ends_.begin(), ends_.end(), end) == ends_.end()) ends_.push_back(end);
                } else {
                    segments_.push_back({a, b, l.segments[e]});
                }
            }
            for (unsigned f = 0; f < 4; ++f) {
                if (!l.facets[f].valid() || c[f] == v) continue;
                if (t > tets_.across(t, f).tet()) continue;  // count each face once
                Loop& loop = loop_of(l.facets[f]);
                ++loop.faces;
                for (const VertexId w : tets_.face_corners(TetFace{t, f}))
                    if (w != v && std::find(loop.vertices.begin(), loop.vertices.end(), w) == loop.vertices.end()) loop.vertices.push_back(w);
            }
        }
        if (ends_.size() == 2) {
            for (Loop& loop : loops_) {
                // Faces of the facet at one end count its fans: one, or two where the facet goes on beyond the segment.
                for (const TetId t : hole_.star) {
                    if (!mesh_.has_labels(t)) continue;
                    for (unsigned f = 0; f < 4; ++f) {
                        if (mesh_.labels(t).facets[f] != loop.facet || t > tets_.across(t, f).tet()) continue;
                        const auto fc = tets_.face_corners(TetFace{t, f});
                        const bool at_vertex = std::find(fc.begin(), fc.end(), v) != fc.end();
                        if (at_vertex && std::find(fc.begin(), fc.end(), ends_[0]) != fc.end()) ++loop.fans;
                    }
                }
            }
        }
    }

    [[nodiscard]] FacetId candidate_facet(std::size_t i, unsigned f) const {
        const auto& c = hole_.filling[i];
        for (const Loop& loop : loops_) {
            bool all = true;
            for (unsigned k = 0; k < 4 && all; ++k)
                if (k != f) all = std::find(loop.vertices.begin(), loop.vertices.end(), c[k]) != loop.vertices.end();
            if (all) return loop.facet;
        }
        return {};
    }

    bool flood() {
        const std::size_t n = hole_.filling.size();
        part_.assign(n, kNone);
        new_labels_.assign(n, TetLabels{});
        std::vector<std::size_t> stack;
        for (std::size_t i = 0; i < n; ++i)
            for (unsigned f = 0; f < 4; ++f) {
                const std::uint32_t other = hole_.filling_opposite[i][f];
                if ((other & Hole::kBoundaryBit) == 0) continue;
                const std::size_t b = other & ~Hole::kBoundaryBit;
                const TetFace inside = hole_.boundary[b].inside;
                new_labels_[i].facets[f] = mesh_.facet_at(inside);
                const std::uint32_t part = star_part_[b];  // boundary face b belongs to star tetrahedron b
                if (part_[i] == kNone) {
                    part_[i] = part;
                    stack.push_back(i);
                } else if (part_[i] != part) {
                    return false;
                }
            }
        while (true) {
            while (!stack.empty()) {
                const std::size_t i = stack.back();
                stack.pop_back();
                for (unsigned f = 0; f < 4; ++f) {
                    const std::uint32_t other = hole_.filling_opposite[i][f];
                    if ((other & Hole::kBoundaryBit) != 0 || candidate_facet(i, f).valid()) continue;
                    const std::size_t j = other / 4;
                    if (part_[j] == kNone) {
                        part_[j] = part_[i];
                        stack.push_back(j);
                    } else if (part_[j] != part_[i]) {
                        return false;
                    }
                }
            }
            // What is left lies flat between faces of one facet: it goes to a neighbour, rather outside than inside.
            std::size_t chosen = n;
            std::uint32_t part = kNone;
            for (std::size_t i = 0; i < n; ++i) {
                if (part_[i] != kNone) continue;
                for (unsigned f = 0; f < 4; ++f) {
                    const std::uint32_t other = hole_.filling_opposite[i][f];
                    if ((other & Hole::kBoundaryBit) != 0) continue;
                    const std::uint32_t theirs = part_[other / 4];
                    if (theirs == kNone) continue;
                    const bool outside = !mesh_.is_filled(cell_of_part_[theirs]);
                    if (part == kNone || (outside && mesh_.is_filled(cell_of_part_[part]))) {
                        chosen = i;
                        part = theirs;
                    }
                }
            }
            if (chosen == n) break;
            part_[chosen] = part;
            stack.push_back(chosen);
        }
        return std::find(part_.begin(), part_.end(), kNone) == part_.end();
    }

    bool find_surface() {
        std::vector<std::size_t> count(loops_.size(), 0);
        for (std::size_t i = 0; i < hole_.filling.size(); ++i)
            for (unsigned f = 0; f < 4; ++f) {
                const std::uint32_t other = hole_.filling_opposite[i][f];
                if ((other & Hole::kBoundaryBit) != 0 || part_[other / 4] == part_[i]) continue;
                const FacetId facet = candidate_facet(i, f);
                if (!facet.valid()) return false;
                new_labels_[i].facets[f] = facet;
                if (other / 4 > i) ++count[static_cast<std::size_t>(&loop_of(facet) - loops_.data())];
            }
        // A disk of n faces about an inner vertex becomes n - 2 triangles; a fan of n at a segment n - 1.
        for (std::size_t l = 0; l < loops_.size(); ++l) {
            const std::size_t lost = ends_.empty() ? 2 : loops_[l].fans;
            if (loops_[l].faces < lost || count[l] != loops_[l].faces - lost) return false;
        }
        return true;
    }

    bool segment_survives() {
        if (ends_.empty()) return true;
        if (ends_.size() != 2) return false;
        segments_.push_back({ends_[0], ends_[1], SegmentId{mesh_.info(hole_.vertex).carrier_id}});
        for (const auto& c : hole_.filling)
            if (std::find(c.begin(), c.end(), ends_[0]) != c.end() && std::find(c.begin(), c.end(), ends_[1]) != c.end()) return true;
        return false;
    }

    ConformingMesh& mesh_;
    const TetStore& tets_;
    const Hole& hole_;
    std::vector<std::uint32_t> star_part_, part_;
    std::vector<CellId> cell_of_part_;
    std::vector<Loop> loops_;
    std::vector<VertexId> ends_;         // of the subsegments at the vertex
    std::vector<Subsegment> segments_;   // labelled edges of the link, and the one that heals
    std::vector<TetLabels> new_labels_;  // faces only
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
