// SPDX-License-Identifier: Apache-2.0
// Claims about how tetrahedra and vertices lie in space: no overlaps, Delaunay, Gabriel.
//
// Mostly hull_proof.hpp proves all of them. Where it does not, (1) and (2) ask for less, and what they don't prove is searched for.
//
// Why looking at faces can be enough. Let every tetrahedron be positive, no face have more than two, and two at a face lie on opposite
// sides of it.
//
// (1) If two tetrahedra overlap, then some tetrahedron with a hull face overlaps another one. The number w(x) of tetrahedra that
//     contain a generic point x changes only across hull faces, and is 0 far away. Take a generic path from a point with w >= 2 to
//     infinity, and the last hull-face crossing before which w >= 2 and after which w <= 1. On the near side two tetrahedra A, B share
//     points next to the crossing; not both go on beyond it, so one of them has a hull face there, and it overlaps the other.
//     More precisely, let A have the hull face F at the crossing x. A generic path avoids the edges of all tetrahedra and the lines in
//     which two planes of faces meet, so x is inside B or inside a face of B that lies in F's plane. So B meets the box of F, and either has
//     corners strictly on both sides of F's plane, or three corners on it and the fourth on the inner side (on the outer, A and B would
//     be apart).
//     Hence `disjoint_tets` is proven if, for no hull face, a tetrahedron of this kind overlaps the one at the face. If one does, or if the
//     premises fail, tetrahedra with a hull face are compared with all others, to count. Where too many meet the boxes of hull faces, because
//     both are needles or worse, the way of delaunay_cells.hpp is tried first.
//
// (2) If moreover no two overlap, every interior face is locally Delaunay (neither apex strictly inside the other's circumsphere), every
//     vertex is used, and no vertex is strictly inside the equatorial sphere of a hull face, then no vertex is strictly inside any
//     circumsphere. Suppose that p were, inside that of t. Walk from a point in t to p along a generic segment. While the walk leaves
//     through interior faces, p stays strictly inside the circumspheres met: beyond a locally Delaunay face the ball of the tetrahedron
//     behind it contains that of the one before. If the walk leaves tau through a hull face F, then tau's apex is on or outside F's
//     equatorial sphere, so the part of tau's ball beyond F is inside the equatorial ball of F, and so is p: excluded. So the walk ends at
//     p in a tetrahedron tau. p is none of its corners (they are on the sphere). A tetrahedron that uses p would overlap tau or a
//     neighbour of it, unless p is on a hull face, or on an edge of one, without being its corner: then p is strictly inside its
//     equatorial sphere, excluded.
//     Hence `delaunay` is proven by the faces where these premises hold; otherwise every circumball is searched.
//
// (3) The same with weights: read "in conflict with the orthogonal sphere" for "strictly inside the circumsphere", and so on. Beyond a locally
//     regular face the power with respect to the orthogonal sphere of the tetrahedron behind it is at most that of the one before. Spheres
//     orthogonal to a hull face F form a pencil: their powers of x differ by a multiple of x's height over F. tau's apex, not in conflict
//     with F's smallest sphere, has there at least the power it has in tau's, which is its weight; so beyond F it is the other way round, and p
//     is in conflict with F's smallest sphere, too: excluded. The walk ends at p in a tetrahedron; if p is on a hull face without being its corner,
//     its height is 0 and both powers are equal: excluded again.
#pragma once

#include <optional>
#include <vector>

#include "certify/ball_search.hpp"
#include "certify/hull_proof.hpp"
#include "certify/mesh_faces.hpp"
#include "certify/suspect_mesh.hpp"

namespace wellmesh::certifying {

/// All vertices, to be searched: made when first asked for, as mostly there is nothing to search.
class VertexSearch {
public:
    explicit VertexSearch(const SuspectMesh& mesh) : mesh_(mesh) {}
    const BallSearch& get() {
        if (!search_) search_.emplace(mesh_.points(), mesh_.weights(), mesh_.workers());
        return *search_;
    }

private:
    const SuspectMesh& mesh_;
    std::optional<BallSearch> search_;
};

/// No two tetrahedra have a common interior point; exact, see (1) and hull_proof.hpp.
/// @param faces_in_order  the premises of (1) hold: otherwise a clean search proves nothing.
[[nodiscard]] Claim claim_disjoint(const SuspectMesh& mesh, VertexSearch& search, const std::vector<ConstraintTriangle>& triangles,
                                   const HullProof& proof, bool faces_in_order);

/// No vertex strictly inside the circumsphere of a positive tetrahedron (or in conflict with its orthogonal sphere, with weights); exact
/// and global. Counts tetrahedra with at least one.
/// @param proven_by_faces  the premises of (2) hold.
[[nodiscard]] Claim claim_delaunay(const SuspectMesh& mesh, VertexSearch& search, bool proven_by_faces);

/// A vertex inside by less than this fraction of the squared radius is not counted as encroaching, only mentioned: input vertices that
/// are cocircular but for the rounding of their coordinates are beyond the reach of any mesh. The referee's margin.
inline constexpr double kGabrielMargin = 1e-12;

struct GabrielFindings {
    Claim claim;
    std::uint64_t touched_hull_faces = 0;  ///< with a vertex strictly inside, however little
};
/// @param proven_by_hull  the premises of hull_proof.hpp hold, so that there is none.
[[nodiscard]] GabrielFindings claim_gabriel_subfaces(const SuspectMesh& mesh, VertexSearch& search, const std::vector<ConstraintTriangle>& triangles,
                                                     bool proven_by_hull);
[[nodiscard]] Claim claim_gabriel_subsegments(const SuspectMesh& mesh, VertexSearch& search, const std::vector<ConstraintSegment>& segments,
                                              bool proven_by_hull);

/// Exact: do the tetrahedra, neither of them flat, have a common interior point?
[[nodiscard]] bool overlap(const SuspectMesh& mesh, std::size_t tet, std::size_t other);

}  // namespace wellmesh::certifying
