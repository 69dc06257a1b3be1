// SPDX-License-Identifier: Apache-2.0
// Reports for programs. Keys are snake_case and stable; numbers that are not finite become null.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

#include "wellmesh/certificate.hpp"
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/invariants.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/repair.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh::cli {

using Json = nlohmann::ordered_json;

/// An object with the program's version and the command: every report starts so.
[[nodiscard]] Json json_header(const std::string& command, const std::string& input);
[[nodiscard]] Json to_json(const MeshOptions& options);
[[nodiscard]] Json to_json(const CertifyOptions& options);
[[nodiscard]] Json to_json(const std::vector<AskedAchieved>& goals);
[[nodiscard]] Json to_json(const Certificate& certificate);
[[nodiscard]] Json to_json(const std::vector<Exemption>& exemptions);
[[nodiscard]] Json to_json(const ShapeStatistics& statistics);
[[nodiscard]] Json to_json(const InvariantReport& report);
[[nodiscard]] Json to_json(const GivenMeshStatistics& given);
[[nodiscard]] Json to_json(const MeshStatistics& statistics);
[[nodiscard]] Json to_json(const std::vector<StageTime>& stages);
[[nodiscard]] Json to_json(const Diagnosis& diagnosis);
[[nodiscard]] Json to_json(const RepairResult& result);  ///< without the complex and its diagnosis
[[nodiscard]] Json to_json(const MeshError& error);

/// Writes `report` to `path` ("-": standard output), ended by a newline. @throws MeshError{cannot_write}
void write_json(const std::string& path, const Json& report);

}  // namespace wellmesh::cli
