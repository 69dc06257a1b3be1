// SPDX-License-Identifier: Apache-2.0
// Regions and holes that the command line states, for inputs whose format has none.
#pragma once

#include <string>
#include <vector>

#include "wellmesh/plc.hpp"

namespace CLI {
class App;
}

namespace wellmesh::cli {

struct SeedFlags {
    struct Region {
        Vec3 point;
        std::string name;  ///< or a number: the region's id
    };
    std::vector<Region> regions;
    std::vector<Vec3> holes;
};

void add_seed_point_flags(CLI::App& command, SeedFlags& seeds);

/// Adds the seeds to those that the complex has. A name that it has for a region means that region; a new one gets the next free id.
void add_seeds(const SeedFlags& seeds, Plc& plc);

}  // namespace wellmesh::cli
