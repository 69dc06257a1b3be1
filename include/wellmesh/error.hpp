// SPDX-License-Identifier: Apache-2.0
// The one exception type of the library's boundary.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// Stable codes for programs. The comment names the exit status of the command line tool.
enum class ErrorCode {
    bad_input,           ///< 2: the file or PLC is wrong; offenders say where
    coordinate_range,    ///< 2: coordinates outside the range in which the predicates are exact
    bad_options,         ///< 3: an option is out of its range
    budget_exhausted,    ///< 4: vertices, time or memory spent before the mesh conformed
    unsupported_acute,   ///< 4: an acute input feature could not be conformed to; offenders name it
    cancelled,           ///< 130: stopped by the caller before the mesh conformed
    cannot_read,         ///< 5: file cannot be opened or read
    cannot_write,        ///< 5: file cannot be written
    mesh_too_large,      ///< 4: more elements than 32-bit ids hold
    internal_invariant,  ///< 70: a bug; please report
};

enum class Stage { read, validate, delaunay, conform, refine, shape, extract, certify, write };

enum class EntityKind { vertex, segment, facet, region, tetrahedron, triangle, edge, file };

/// An input or mesh entity that a message talks about. `number` is the source's own counting.
struct ElementRef {
    EntityKind kind = EntityKind::vertex;
    std::uint64_t number = 0;
    std::optional<Vec3> where{};
};

class MeshError : public std::runtime_error {
public:
    MeshError(ErrorCode code, Stage stage, const std::string& message, std::vector<ElementRef> offenders = {})
        : std::runtime_error(message), code_(code), stage_(stage), offenders_(std::move(offenders)) {}
    [[nodiscard]] ErrorCode code() const noexcept { return code_; }
    [[nodiscard]] Stage stage() const noexcept { return stage_; }
    [[nodiscard]] const std::vector<ElementRef>& offenders() const noexcept { return offenders_; }

private:
    ErrorCode code_;
    Stage stage_;
    std::vector<ElementRef> offenders_;
};

/// Name of a stage as messages and reports print it.
[[nodiscard]] const char* to_string(Stage stage) noexcept;
[[nodiscard]] const char* to_string(ErrorCode code) noexcept;
[[nodiscard]] const char* to_string(EntityKind kind) noexcept;

}  // namespace wellmesh
