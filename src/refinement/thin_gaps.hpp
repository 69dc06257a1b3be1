// SPDX-License-Identifier: Apache-2.0
// Gaps between features of the input that have no point in common and are so near each other that no mesh of bounded radius-edge ratio can fill them: a
// slab of width w and area A takes about A / w^2 vertices. What lies in such a gap is left as it conforms, and said; the mesh around it is refined as ever.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "conforming/conforming_mesh.hpp"
#include "validation/local_feature_size.hpp"

namespace wellmesh {

/// The gaps that are left.
struct LeftGaps {
    std::array<VertexId, 2> sides{};  ///< of that which takes most vertices: of the mesh, on features without a common point
    double width = 0;                 ///< of that one
    double narrowest = 0, filled_from = 0;  ///< widths of the narrowest that is left, and of those that are not
    double vertices = 0;              ///< that filling all that are left would take
};

class ThinGaps {
public:
    /// No gaps.
    ThinGaps() = default;
    /// Looks through a conforming mesh. @param most_vertices  that may be spent on gaps: the widest are filled as far as these go.
    /// @param is_forced  is a tetrahedron excused by an acute angle anyway? What narrows there is no gap.
    /// @param feature_size  of the mesh's domain, if somebody has it
    ThinGaps(const ConformingMesh& mesh, double most_vertices, const std::function<bool(TetId)>& is_forced, std::unique_ptr<const LocalFeatureSize> feature_size);

    /// Is any gap left?
    [[nodiscard]] bool any() const { return left_.has_value(); }
    /// Vertices that filling the gaps which are not left will take.
    [[nodiscard]] double expected_vertices() const { return expected_vertices_; }
    [[nodiscard]] const std::optional<LeftGaps>& left() const { return left_; }
    /// Two vertices of the tetrahedron on the two sides of a gap that is left, if it has any.
    [[nodiscard]] std::optional<std::array<VertexId, 2>> sides_joined_by(const ConformingMesh& mesh, TetId t) const;

private:
    /// A piece of the boundary beside a gap.
    struct Sample {
        double width = 0;     // local feature size there
        double vertices = 0;  // that it needs if the gap is filled
        VertexId near{}, far{};
    };
    /// A face or edge of a tetrahedron that may be beside a gap.
    struct Candidate {
        double most = 0;    // vertices that it takes at most
        double height = 0;  // of the tetrahedron's other corner over it
        TetId tet{};
        unsigned at = 0;    // number of the face or edge
        VertexId far{};     // of an edge: that corner
    };
    void list_faces(const ConformingMesh& mesh, TetId t, std::vector<Candidate>& out) const;
    void list_edges(const ConformingMesh& mesh, TetId t, std::vector<Candidate>& out) const;
    void sample_face(const ConformingMesh& mesh, const Candidate& candidate);
    bool sample_edge(const ConformingMesh& mesh, const Candidate& candidate);
    void choose(double most_vertices);
    [[nodiscard]] bool are_apart(const ConformingMesh& mesh, VertexId u, VertexId v) const;
    [[nodiscard]] bool is_beside_left(const ConformingMesh& mesh, VertexId v) const;

    std::unique_ptr<const LocalFeatureSize> feature_size_;
    std::vector<Sample> samples_;
    double expected_vertices_ = 0;
    std::optional<LeftGaps> left_;

    /// Whether a vertex is beside a gap that is left, found when first asked for, and again once it has moved. One thread asks.
    struct Known {
        Vec3 point{};
        bool asked = false, beside = false;
    };
    mutable std::vector<Known> known_;
};

}  // namespace wellmesh
