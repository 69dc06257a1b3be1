// SPDX-License-Identifier: Apache-2.0
// Lists of exempt tetrahedra: text, one a line, its number first, so that other checkers can read them.
#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "io/atomic_file.hpp"
#include "io/source_file.hpp"
#include "io/text_scanner.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {

std::vector<std::filesystem::path> write_exemptions(const std::vector<Exemption>& exemptions, const std::filesystem::path& path, const WriteOptions& options) {
    io::OutputSet files(options.stop, options.sync);
    io::OutputFile& out = files.add(path);
    out.text("# tetrahedron, from 1, input feature, its number, angle in degrees, x y z of the feature\n");
    for (const Exemption& e : exemptions) {
        out.integer(static_cast<std::int64_t>(e.tet) + 1);
        out.text(fmt::format(" {} {} ", to_string(e.feature.kind), e.feature.number));
        out.real(e.angle_deg);
        const Vec3 where = e.feature.where.value_or(Vec3{});
        for (const double x : {where.x, where.y, where.z}) {
            out.character(' ');
            out.real(x);
        }
        out.character('\n');
    }
    return files.commit();
}

std::vector<std::uint64_t> read_exemptions(const std::filesystem::path& path, std::size_t tets) {
    const io::SourceFile source = io::read_source(path, 1);
    io::TextScanner in(source, {});
    std::vector<std::uint64_t> out;
    while (!in.at_end()) {
        const std::int64_t number = in.integer("the number of a tetrahedron");
        if (number < 1 || static_cast<std::uint64_t>(number) > tets) in.fail(fmt::format("tetrahedron {} does not exist: the mesh has {}, counted from 1", number, tets));
        out.push_back(static_cast<std::uint64_t>(number) - 1);
        in.skip_line();
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

}  // namespace wellmesh
