// SPDX-License-Identifier: Apache-2.0
// What follows from the hull: that no tetrahedra overlap, that all is Delaunay, and that constraints are Gabriel, with no search but of hull
// vertices.
//
// Let every tetrahedron be positive, no face have more than two, two at a face lie on opposite sides of it, and every vertex belong to a
// tetrahedron. A hull face has one tetrahedron; hull vertices are corners of hull faces. Spheres are named for spheres without weights; with
// weights read "in conflict with the smallest orthogonal sphere" for "strictly inside the equatorial sphere", and so on: what is used of them is
// that the difference of two powers is linear. Let P_F be the power with respect to F's sphere: 0 at its corners, negative at what is strictly
// inside.
//
// (a) Let no hull vertex be strictly inside the equatorial sphere of a hull face. If two hull faces F and G have a common point x, it is spanned
//     by corners of F and by corners of G. P_F - P_G is linear, at most 0 at F's corners and at least 0 at G's: it is 0 at x, and so at all
//     corners that span it. So those of G that F doesn't have lie on F's sphere. Hence no two hull faces have more in common than the triangle,
//     edge or corner that they share, if that holds for each F and the hull faces at the vertices on its sphere: mostly there is none.
// (b) Then the hull is embedded. The number w(x) of tetrahedra that contain a generic point x changes by one at a hull face and nowhere else.
//     Where two hull faces only are at an edge, the same side of space is outside of both (the hull bounds a sum of tetrahedra, so they are
//     oriented alike). So w has one value k outside of all the faces of a component (connected through such edges), and k + 1 inside of them. If
//     there is one component, its unbounded side has w = 0, which is k, as k + 1 = 0 is impossible: w is 0 or 1, and no two tetrahedra overlap.
//     If there are several, it is enough that for one face of each no other tetrahedron is on its inner side, beside its own.
// (c) Let moreover every interior face be locally Delaunay, and no apex of the tetrahedron at a hull face be strictly inside its equatorial
//     sphere. Then all is Delaunay. The walk of space_claims.hpp (2) goes on where it left the mesh: it leaves tau through F towards p, and
//     P_F(p) < 0. If it enters the mesh again, at a point x of the hull face G, having left at y: P_F - P_G is at most 0 on F, at least 0 on G,
//     so it is at least 0 beyond x as seen from y: P_G(p) <= P_F(p) < 0. On the inner side of G the power with respect to the sphere of the
//     tetrahedron there is at most P_G, as its apex is not inside: p is strictly inside that sphere, and the walk goes on. It ends at p, within
//     the mesh, which space_claims.hpp excludes, or from outside: then tetrahedra do not surround p, so that it is a hull vertex, which is not
//     strictly inside F's sphere.
// (d) Then no vertex p at all is strictly inside the equatorial sphere of a hull face F: on F's inner side, or on its plane, it would be inside
//     the sphere of the tetrahedron there; on the other side walk to it from a point of F, as above. Nor is one inside that of an interior face F
//     whose two apexes are not: it would be inside the sphere of the tetrahedron on its side.
// (e) Nor is one inside the diametral sphere of an edge e if none is of those that make a tetrahedron with e, nor, where e is on the hull, a hull
//     vertex. Let P be the power with respect to that sphere, P(p) < 0, m a point of e. If some tetrahedron t at e is in the direction of p as
//     seen from m: P minus the power with respect to t's sphere is linear, 0 on the line of e and at least 0 at the other corners of t, so it is
//     at least 0 at p, which is inside t's sphere: excluded. If none is, e is on the hull, and the way from m to p starts outside. It ends there,
//     at a hull vertex, or enters through a hull face G at x. P - P_G is at most 0 at m and at least 0 at x, so P_G(p) <= P(p) < 0, which (d)
//     excludes.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "certify/ball_search.hpp"
#include "certify/mesh_faces.hpp"
#include "certify/suspect_mesh.hpp"
#include "certify/tets_by_corner.hpp"

namespace wellmesh::certifying {

/// The premises above, looked at by exact predicates. What is false may be true all the same.
class HullProof {
public:
    /// @param faces_in_order  tetrahedra are positive, and not more than two at a face, on either side of it; otherwise nothing is looked at.
    HullProof(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, bool faces_in_order);
    HullProof(const HullProof&) = delete;
    HullProof& operator=(const HullProof&) = delete;

    /// Two hull faces have only the triangle, edge or corner in common that they share (a).
    [[nodiscard]] bool embedded() const { return embedded_; }
    /// Numbers of constraint triangles, one for each component of the embedded hull (b).
    [[nodiscard]] const std::vector<std::uint32_t>& components() const { return components_; }
    /// No hull vertex and no apex is strictly inside the equatorial sphere of a hull face (a, c).
    [[nodiscard]] bool hull_is_clear() const { return hull_is_clear_; }
    /// No apex is strictly inside the equatorial sphere of any other constraint triangle, and all are faces (d).
    [[nodiscard]] bool interfaces_are_clear() const { return interfaces_are_clear_; }
    /// All are edges, and what (e) names is not strictly inside their diametral spheres.
    [[nodiscard]] bool segments_are_clear(const TetsByCorner& stars, const std::vector<ConstraintSegment>& segments) const;

private:
    /// A hull vertex on the equatorial sphere of a hull face, by their places in vertices_ and faces_.
    struct Tie {
        std::uint32_t face, vertex;
    };
    void list_vertices();
    /// @return the ties, if there are few.
    std::optional<std::vector<Tie>> look_at_spheres();
    void list_faces_at_vertices();
    [[nodiscard]] bool meet_properly(const Tie& tie) const;
    [[nodiscard]] std::vector<std::uint32_t> find_components() const;

    const SuspectMesh& mesh_;
    const std::vector<ConstraintTriangle>& triangles_;
    std::vector<std::uint32_t> faces_;             // of the hull, numbers in triangles_
    std::vector<std::uint32_t> vertices_;          // of the hull, ascending
    std::vector<Triangle> corners_;                // of faces_, by their places in vertices_
    std::vector<Vec3> points_;                     // of vertices_
    std::vector<double> weights_;                  // the same; empty: none
    std::optional<BallSearch> search_;             // among them
    std::vector<std::uint32_t> first_, at_vertex_; // places in faces_ of those at each of vertices_, one after the other
    std::vector<std::uint32_t> components_;
    bool embedded_ = false, hull_is_clear_ = false, interfaces_are_clear_ = false;
};

/// Exact: two triangles, each with another corner of its tetrahedron at the end, have only the hull of the shared corners in common. False: they
/// have more, or it is not clear.
[[nodiscard]] bool meet_properly(const SuspectMesh& mesh, const std::array<std::uint32_t, 4>& a, const std::array<std::uint32_t, 4>& b);

}  // namespace wellmesh::certifying
