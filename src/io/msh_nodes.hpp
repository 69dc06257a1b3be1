// SPDX-License-Identifier: Apache-2.0
// The section $Nodes of a Gmsh file: points under numbers that may have gaps and any order.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "io/msh_cursor.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::io {

class MshNodes {
public:
    /// All must outlive this. @param points  where the nodes go, in the order of their numbers
    MshNodes(MshCursor& in, std::vector<Vec3>& points, TextPrecision& precision) : in_(in), points_(points), precision_(precision) {}
    MshNodes(const MshNodes&) = delete;
    MshNodes& operator=(const MshNodes&) = delete;

    void read_2();  ///< what stands between $Nodes and $EndNodes in version 2
    void read_4();  ///< and 4.1

    /// @throws MeshError{bad_input}  no node has that number.
    /// @param in  where it stands
    [[nodiscard]] std::uint32_t index_of(std::int64_t tag, const MshCursor& in) const;

private:
    /// Reads `n` rows behind those that are there; of text several at once. @param read  read(in, row, precision): sets tag and point `row`
    template <class Read>
    void read_nodes(std::size_t n, const Read& read);
    [[nodiscard]] static Vec3 read_coordinates(MshCursor& in, TextPrecision& precision);
    static void check(std::int64_t tag, std::size_t row, const MshCursor& in);
    void index();

    MshCursor& in_;
    std::vector<Vec3>& points_;
    TextPrecision& precision_;
    std::vector<std::int64_t> tags_;  // as they come in the file
    bool sequential_ = true;
    std::unordered_map<std::int64_t, std::uint32_t> index_of_;  // only looked up; empty if sequential
};

}  // namespace wellmesh::io
