// SPDX-License-Identifier: Apache-2.0
// What markers and regions are called.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace wellmesh {

/// Names of markers by the dimension of what they mark: 0 vertices, 1 segments, 2 facets, 3 regions. A marker has at most one name
/// in each dimension; two markers of one dimension may share a name, and then mean one group of two parts.
struct Names {
    std::array<std::map<std::int32_t, std::string>, 4> of_dimension;

    /// The name of a marker, or null. @pre dimension < 4
    [[nodiscard]] const std::string* find(std::size_t dimension, std::int32_t marker) const {
        const auto at = of_dimension[dimension].find(marker);
        return at == of_dimension[dimension].end() ? nullptr : &at->second;
    }
    /// The lowest marker of that name; nothing if there is none. @pre dimension < 4
    [[nodiscard]] std::optional<std::int32_t> marker_of(std::size_t dimension, std::string_view name) const {
        for (const auto& [marker, its_name] : of_dimension[dimension])
            if (its_name == name) return marker;
        return std::nullopt;
    }
    [[nodiscard]] bool empty() const {
        for (const auto& names : of_dimension)
            if (!names.empty()) return false;
        return true;
    }
    friend bool operator==(const Names&, const Names&) = default;
};

}  // namespace wellmesh
