// SPDX-License-Identifier: Apache-2.0
// The cell of every tetrahedron: known next to each labelled face from the side it lies on, flooded over all other faces.
#include <fmt/format.h>

#include "conforming/boundary_refiner.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

/// The facet's cell on the side of tf's tetrahedron; `sure` says how well the (rounded) face shows its side.
CellId cell_beside(const ConformingMesh& mesh, TetFace tf, FacetId f, double& sure) {
    const auto c = mesh.tets().face_corners(tf);
    const Vec3 n = cross(mesh.point(c[1]) - mesh.point(c[0]), mesh.point(c[2]) - mesh.point(c[0]));  // points to the apex
    const ValidFacet& facet = mesh.plc().facets[f.index()];
    const double along = dot(n, facet.normal);
    sure = std::abs(along) / norm(n);
    const CellId cell = facet.cells[along > 0 ? 0 : 1];
    // Facets between two cells that are not meshed are no part of the complex: what is not meshed is all one.
    return mesh.is_filled(cell) ? cell : CellId{0};
}

constexpr CellId kUnknown{};
constexpr double kSure = 0.5;  // cosine: a needle-thin subface may be turned by its rounding; its neighbours decide then

}  // namespace

bool is_on_its_side(const ConformingMesh& mesh, TetId t) {
    for (unsigned f = 0; f < 4; ++f) {
        const FacetId facet = mesh.facet_at(TetFace{t, f});
        if (!facet.valid()) continue;
        double sure = 0;
        const CellId c = cell_beside(mesh, TetFace{t, f}, facet, sure);
        if (sure >= kSure && c != mesh.cell(t)) return false;
    }
    return true;
}

bool classify_again(ConformingMesh& mesh, const std::vector<TetId>& unknown) {
    const TetStore& tets = mesh.tets();
    const CellId none = mesh.unknown_cell();
    std::vector<TetId> part;
    for (const TetId seed : unknown) {
        if (mesh.cell(seed) != none) continue;
        // One part, connected not across labelled faces; whatever it touches must name the same cell.
        CellId found{};
        bool agree = true;
        const auto hear = [&](CellId c) {
            agree = agree && (!found.valid() || found == c);
            found = c;
        };
        part.assign(1, seed);
        mesh.set_cell(seed, kUnknown);
        for (std::size_t i = 0; i < part.size(); ++i)
            for (unsigned f = 0; f < 4; ++f) {
                const FacetId facet = mesh.facet_at(TetFace{part[i], f});
                if (facet.valid()) {
                    double sure = 0;
                    const CellId c = cell_beside(mesh, TetFace{part[i], f}, facet, sure);
                    if (sure >= kSure) hear(c);
                    continue;
                }
                const TetId next = tets.across(part[i], f).tet();
                if (mesh.cell(next) == none) {
                    mesh.set_cell(next, kUnknown);
                    part.push_back(next);
                } else if (mesh.cell(next) != kUnknown) {
                    hear(mesh.cell(next));
                }
            }
        if (!agree || !found.valid()) return false;
        for (const TetId t : part) mesh.set_cell(t, found);
    }
    return true;
}

void classify_cells(ConformingMesh& mesh) {
    const TetStore& tets = mesh.tets();
    std::vector<TetId> stack;
    const auto set = [&](TetId t, CellId c) {
        if (mesh.cell(t) != kUnknown) return;
        mesh.set_cell(t, c);
        stack.push_back(t);
    };
    for (std::size_t i = 0; i < tets.slots(); ++i) mesh.set_cell(TetId{i}, tets.is_live(TetId{i}) ? kUnknown : CellId{0});
    const auto flood = [&] {
        while (!stack.empty()) {
            const TetId t = stack.back();
            stack.pop_back();
            for (unsigned f = 0; f < 4; ++f)
                if (!mesh.facet_at(TetFace{t, f}).valid()) set(tets.across(t, f).tet(), mesh.cell(t));
        }
    };
    // Ghosts first: they are outside beyond doubt, and so are the flat tetrahedra between a rounded facet and the hull.
    for (std::size_t i = 0; i < tets.slots(); ++i)
        if (tets.is_live(TetId{i}) && tets.is_ghost(TetId{i})) set(TetId{i}, CellId{0});
    flood();
    for (const double threshold : {kSure, 0.0})
        for (std::size_t i = 0; i < tets.slots(); ++i) {
            const TetId t{i};
            if (!tets.is_live(t) || !mesh.has_labels(t) || mesh.cell(t) != kUnknown) continue;
            for (unsigned f = 0; f < 4; ++f) {
                const FacetId facet = mesh.facet_at(TetFace{t, f});
                if (!facet.valid()) continue;
                double sure = 0;
                const CellId c = cell_beside(mesh, TetFace{t, f}, facet, sure);
                if (sure < threshold) continue;
                set(t, c);
                flood();
                break;
            }
        }
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        const TetId t{i};
        if (!tets.is_live(t)) continue;
        if (mesh.cell(t) == kUnknown) mesh.set_cell(t, CellId{0});
        for (unsigned f = 0; f < 4; ++f) {
            const FacetId facet = mesh.facet_at(TetFace{t, f});
            if (!facet.valid()) continue;
            double sure = 0;
            const CellId c = cell_beside(mesh, TetFace{t, f}, facet, sure);
            if (sure < kSure || c == mesh.cell(t)) continue;
            const Vec3& p = mesh.point(tets.face_corners(TetFace{t, f})[0]);
            throw MeshError(ErrorCode::internal_invariant, Stage::conform,
                            fmt::format("facet {} does not separate its cells near ({}, {}, {})", mesh.plc().facets[facet.index()].source_facet + 1, p.x, p.y, p.z),
                            {{EntityKind::facet, mesh.plc().facets[facet.index()].source_facet + 1, p}});
        }
    }
}

}  // namespace wellmesh
