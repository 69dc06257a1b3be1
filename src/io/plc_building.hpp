// SPDX-License-Identifier: Apache-2.0
// What the readers of surfaces and complexes share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "io/source_file.hpp"
#include "io/text_precision.hpp"
#include "io/text_scanner.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh::io {

/// Most vertices that 32-bit ids hold; the last number is the invalid id.
inline constexpr std::uint64_t kMostVertices = 0xfffffffe;

/// Reads x, y, z (possibly over several lines) and notes their precision.
Vec3 read_point(TextScanner& in, TextPrecision& precision);
/// Reads x, y, z without noting: seeds are not geometry.
Vec3 read_seed(TextScanner& in);

/// `number` counts from `first`; the result from 0. @throws MeshError{bad_input} naming the valid range.
std::uint32_t vertex_index(const TextScanner& in, std::int64_t number, std::uint32_t first, std::size_t vertices);

/// A facet of one polygon.
[[nodiscard]] PlcFacet polygon_facet(std::vector<std::uint32_t> polygon, std::int32_t marker);
/// Adds such a facet.
void add_polygon(Plc& plc, std::vector<std::uint32_t> polygon, std::int32_t marker);

/// An empty complex as surface files mean it: consistently oriented, coplanar neighbours are one facet.
Plc make_surface(const SourceFile& source);

/// Makes every zero coordinate +0, so that equal points are equal bit by bit.
void normalise_zeros(std::vector<Vec3>& points);

}  // namespace wellmesh::io
