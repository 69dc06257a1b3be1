// SPDX-License-Identifier: Apache-2.0
// What sizes are known point by point: a callback, background meshes, the local feature size.
#pragma once

#include <memory>
#include <vector>

#include "sizing/nodal_sizes.hpp"
#include "validation/local_feature_size.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

class PointSizes {
public:
    /// @param vertex_sizes  of the input's vertices; infinite: none. @throws MeshError{bad_options} for a background mesh that isn't one
    PointSizes(const ValidPlc& plc, const SizeGoals& goals, const std::vector<double>& vertex_sizes);

    /// Is anything asked?
    [[nodiscard]] bool asks() const { return goals_.at || lfs_ || !nodal_.empty(); }
    /// The smallest of all at p. @throws MeshError{bad_options} if the callback's answer is no length
    [[nodiscard]] double operator()(const Vec3& p) const;
    /// Points where sizes may be smaller than around: vertices of the input and of background meshes.
    [[nodiscard]] const std::vector<Vec3>& probes() const { return probes_; }

private:
    const SizeGoals& goals_;
    std::unique_ptr<const LocalFeatureSize> lfs_;
    std::unique_ptr<const BackgroundMesh> between_vertices_;
    std::vector<std::unique_ptr<const NodalSizes>> nodal_;
    std::vector<Vec3> probes_;
};

}  // namespace wellmesh
