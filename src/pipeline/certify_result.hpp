// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

#include "validation/valid_plc.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh {

/// What the finished mesh has to show: the options' goals, and tolerances beyond the defaults only by what the input's own rounding did. Notes the
/// tolerances in result.statistics.
[[nodiscard]] CertifyOptions certificate_bounds(MeshResult& result, const MeshOptions& options, const Plc& plc, const ValidPlc& valid, const std::stop_token& stop);

}  // namespace wellmesh
