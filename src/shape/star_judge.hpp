// SPDX-License-Identifier: Apache-2.0
// Judges the star that a point would get, face by face while its cavity is being found: most candidates fail at one of the first faces.
#pragma once

#include <algorithm>

#include "conforming/conforming_mesh.hpp"
#include "predicates/predicates.hpp"
#include "shape/tet_judge.hpp"

namespace wellmesh {

class StarJudge {
public:
    StarJudge(const ConformingMesh& mesh, const TetJudge& judge, const Placement& where, const Vec3& point, double limit)
        : mesh_(mesh), judge_(judge), where_(where), point_(point), limit_(limit) {}

    /// Takes the tetrahedron of the point and this face of its cavity. @return false if it is worse than `limit`. Part of each search for a cavity, also where
    /// there is one for the whole mesh and one for views.
    [[gnu::always_inline]] bool take(const BoundaryFace& b) {
        const TetId behind = b.inside.tet();
        if (!mesh_.in_domain(behind)) return true;
        const auto c = mesh_.tets().face_corners(b.inside);
        if (c[0] == kInfiniteVertex || c[1] == kInfiniteVertex || c[2] == kInfiniteVertex) return true;
        const Vec3 &p0 = mesh_.point(c[0]), &p1 = mesh_.point(c[1]), &p2 = mesh_.point(c[2]);
        if (!TetJudge::is_surely_worse(p0, p1, p2, point_, limit_)) {
            const double badness = judge_.badness(p0, p1, p2, point_, mesh_.cell(behind));
            if (badness <= limit_) {
                worst_ = std::max(worst_, badness);
                return true;
            }
        }
        // A flat tetrahedron on a subface of the point's own carrier will belong to the other side.
        return where_.carrier != CarrierKind::region && mesh_.facet_at(b.inside).valid() && side_of_equatorial_sphere(p0, p1, p2, point_) == Sign::positive;
    }
    /// Badness of the worst tetrahedron taken.
    [[nodiscard]] double worst() const { return worst_; }

private:
    const ConformingMesh& mesh_;
    const TetJudge& judge_;
    const Placement& where_;
    const Vec3& point_;
    double limit_, worst_ = 0;
};

}  // namespace wellmesh
