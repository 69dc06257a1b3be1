// SPDX-License-Identifier: Apache-2.0
// The pipeline's stages one at a time, for tests that look between them.
#pragma once

#include <map>
#include <string>

#include "conforming/boundary_refiner.hpp"
#include "conforming/check_conforming.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "core/vec3_math.hpp"
#include "core/workers.hpp"
#include "delaunay/check_delaunay.hpp"
#include "quality/tet_shape.hpp"
#include "refinement/refine.hpp"
#include "shape/improve.hpp"
#include "validation/valid_plc.hpp"

namespace wellmesh::testing {

struct StagedMesh {
    MeshOptions options;
    RunControl control{};
    ValidPlc plc;
    RunGuard guard;
    Workers workers{1};
    ConformingMesh mesh;
    AcuteGeometry acute;
    BoundaryRefiner boundary;

    /// @param has_narrow_gaps  as of AcuteGeometry
    explicit StagedMesh(const Plc& input, const MeshOptions& wanted = {}, bool has_narrow_gaps = false)
        : options(wanted), plc(validate(input, options)), guard(options.limits, control), mesh(plc), acute(plc, workers, has_narrow_gaps), boundary(mesh, guard, options.seed, acute) {}
    StagedMesh(const StagedMesh&) = delete;
    StagedMesh& operator=(const StagedMesh&) = delete;

    void conform() {
        boundary.recover_all();
        boundary.conform();
    }
    /// Empty, or what is wrong with the triangulation or its labels.
    [[nodiscard]] std::string problem(bool gabriel) {
        for (const std::string& s : {check_adjacency(mesh.triangulation()), check_delaunay(mesh.triangulation()), check_conforming(mesh, gabriel)})
            if (!s.empty()) return s;
        return {};
    }
    [[nodiscard]] double largest_coordinate() const {
        double c = 0;
        for (const Vec3& p : plc.vertices) c = std::max({c, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        return c;
    }
    /// Calls f(t) for every tetrahedron of the domain.
    template <class F>
    void for_domain(F&& f) const {
        for (std::size_t i = 0; i < mesh.tets().slots(); ++i)
            if (mesh.tets().is_finite(TetId{i}) && mesh.in_domain(TetId{i})) f(TetId{i});
    }
    [[nodiscard]] TetShape shape(TetId t) const {
        const auto& c = mesh.tets().corners(t);
        return shape_of(mesh.point(c[0]), mesh.point(c[1]), mesh.point(c[2]), mesh.point(c[3]));
    }
    [[nodiscard]] std::size_t domain_tets() const {
        std::size_t n = 0;
        for_domain([&](TetId) { ++n; });
        return n;
    }
    [[nodiscard]] std::map<CellId, double> cell_volumes() const {
        std::map<CellId, double> volumes;
        for_domain([&](TetId t) { volumes[mesh.cell(t)] += shape(t).volume; });
        return volumes;
    }
};

}  // namespace wellmesh::testing
