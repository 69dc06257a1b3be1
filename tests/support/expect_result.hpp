// SPDX-License-Identifier: Apache-2.0
// What every result of generate() promises.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "wellmesh/result.hpp"

namespace wellmesh::testing {

/// Claims that hold whatever ended the run: all but those about goals.
inline void expect_valid(const MeshResult& result) {
    EXPECT_FALSE(result.mesh.tets.empty());
    EXPECT_FALSE(result.certificate.claims.empty());
    for (const Claim& c : result.certificate.claims) {
        const bool goal = c.name == "radius_edge" || c.name == "dihedral";
        if (goal && result.termination != Termination::goals_met) continue;
        EXPECT_NE(c.state, Claim::State::refuted) << c.name << ": " << c.violations << " violations, " << c.detail;
    }
    const TetMesh& mesh = result.mesh;
    EXPECT_EQ(mesh.vertex_carriers.size(), mesh.vertices.size());
    EXPECT_EQ(mesh.tet_regions.size(), mesh.tets.size());
    EXPECT_EQ(mesh.subface_facets.size(), mesh.subfaces.size());
    EXPECT_EQ(mesh.subsegment_segments.size(), mesh.subsegments.size());
    // A run that was cancelled does not check what it hands out.
    if (result.termination != Termination::cancelled) { EXPECT_EQ(result.certificate.all.tets, mesh.tets.size()); }
}

inline std::string listing(const std::vector<AskedAchieved>& goals) {
    std::string s;
    for (const AskedAchieved& g : goals) s += g.goal + (g.met ? " met; " : " missed; ");
    return s;
}

/// The whole promise: goals met, everything proven.
inline void expect_goals_met(const MeshResult& result) {
    EXPECT_EQ(result.termination, Termination::goals_met) << listing(result.goals);
    EXPECT_TRUE(result.certificate.proven());
    expect_valid(result);
    EXPECT_TRUE(std::all_of(result.goals.begin(), result.goals.end(), [](const AskedAchieved& g) { return g.met && g.elements_missed == 0; })) << listing(result.goals);
    for (const RegionVolume& r : result.certificate.regions)
        if (r.plc_volume) { EXPECT_NEAR(r.volume, *r.plc_volume, 1e-6 * *r.plc_volume); }
}

}  // namespace wellmesh::testing
