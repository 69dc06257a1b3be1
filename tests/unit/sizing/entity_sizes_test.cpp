// SPDX-License-Identifier: Apache-2.0
#include "sizing/entity_sizes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

TEST(StatedSizes, GoToWhatHasTheId) {
    Plc input = cube_with_internal_facet();
    input.vertex_markers.assign(input.vertices.size(), 0);
    input.vertex_markers[3] = 9;
    input.facets[0].marker = 7;
    input.segments.push_back({{0, 1}, 5});
    const ValidPlc plc = validate(input);
    SizeGoals goals;
    goals.edge_length = 1;
    goals.entities = {{EntityKind::region, 2, 0.5}, {EntityKind::facet, 7, 0.25}, {EntityKind::facet, 7, 0.3}, {EntityKind::segment, 5, 0.125}, {EntityKind::vertex, 9, 0.0625}};
    const EntitySizes sizes = stated_sizes(plc, goals);
    for (std::size_t c = 0; c < plc.cells.size(); ++c) EXPECT_EQ(sizes.cells[c], plc.cells[c].region == 2 && plc.cells[c].filled ? 0.5 : 1);
    for (std::size_t f = 0; f < plc.facets.size(); ++f) EXPECT_EQ(sizes.facets[f], plc.facets[f].marker == 7 ? 0.25 : INFINITY);  // the smaller one
    std::size_t segments = 0;
    for (std::size_t s = 0; s < plc.segments.size(); ++s) {
        EXPECT_EQ(sizes.segments[s], plc.segments[s].marker == 5 ? 0.125 : INFINITY);
        segments += plc.segments[s].marker == 5;
    }
    EXPECT_EQ(segments, 1U);
    for (std::size_t v = 0; v < plc.vertices.size(); ++v) EXPECT_EQ(sizes.vertices[v], plc.vertex_markers[v] == 9 ? 0.0625 : INFINITY);
}

TEST(StatedSizes, UnknownIdsAreErrorsThatNameTheKnownOnes) {
    const ValidPlc plc = validate(cube_with_internal_facet());
    for (const EntityKind kind : {EntityKind::region, EntityKind::facet, EntityKind::segment, EntityKind::vertex}) {
        SizeGoals goals;
        goals.entities = {{kind, 4711, 1}};
        try {
            (void)stated_sizes(plc, goals);
            ADD_FAILURE() << to_string(kind);
        } catch (const MeshError& e) {
            EXPECT_EQ(e.code(), ErrorCode::bad_options);
            EXPECT_NE(std::string(e.what()).find(to_string(kind)), std::string::npos) << e.what();
            EXPECT_NE(std::string(e.what()).find("4711"), std::string::npos) << e.what();
            EXPECT_EQ(kind == EntityKind::region, std::string(e.what()).find("the regions 1, 2") != std::string::npos) << e.what();
        }
    }
}

TEST(StatedSizes, NamesStandForMarkers) {
    Names names;
    names.of_dimension[2] = {{3, "inlet"}, {4, "wall"}, {9, "inlet"}};
    const std::vector<EntitySize> found = with_ids({{EntityKind::facet, 0, 0.5, "inlet"}, {EntityKind::region, 7, 0.25}}, names);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_EQ(found[0].id, 3);
    EXPECT_EQ(found[1].id, 9);
    EXPECT_EQ(found[1].edge_length, 0.5);
    EXPECT_EQ(found[2].kind, EntityKind::region);
    EXPECT_EQ(found[2].id, 7);
    for (const EntityKind kind : {EntityKind::facet, EntityKind::segment}) EXPECT_THROW((void)with_ids({{kind, 0, 1, "outlet"}}, names), MeshError);
}

TEST(StatedSizes, TheInputsOwnCountUnlessTurnedOff) {
    Plc input = cube();
    input.vertex_sizes = {0.1, 0, 0, 0, 0, 0, 0, 0.3};
    const ValidPlc plc = validate(input);
    SizeGoals goals;
    EXPECT_EQ(stated_sizes(plc, goals).vertices[0], 0.1);
    EXPECT_EQ(stated_sizes(plc, goals).vertices[1], INFINITY);
    EXPECT_EQ(stated_sizes(plc, goals).vertices[7], 0.3);
    goals.vertex_sizes = false;
    for (const double h : stated_sizes(plc, goals).vertices) EXPECT_EQ(h, INFINITY);
}

}  // namespace
}  // namespace wellmesh::testing
