// SPDX-License-Identifier: Apache-2.0
// Budgets, cancellation, wrong options and inputs that can't be meshed: a typed error or a valid mesh, soon.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "support/expect_result.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

void expect_code(ErrorCode code, const std::function<void()>& run) {
    try {
        run();
        FAIL() << "no error";
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), code) << e.what();
        EXPECT_STRNE(e.what(), "");
    }
}

double seconds_of(const std::function<void()>& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(Limits, VertexBudgetsEndInATypedErrorOrAValidMesh) {
    std::size_t errors = 0;
    for (const NamedPlc& named : all_synthetic_plcs()) {
        std::size_t cut_short = 0;
        for (const std::uint64_t budget : {4U, 10U, 20U, 40U, 80U, 160U, 320U, 640U, 1500U}) {
            SCOPED_TRACE(fmt::format("{} budget {}", named.name, budget));
            MeshOptions options;
            options.limits.max_vertices = budget;
            options.size.edge_length = 0.04 * diagonal(named.plc);
            try {
                const MeshResult result = generate(transformed(named.plc, 1, 0, 1), options);
                EXPECT_EQ(result.termination, Termination::vertex_budget_reached);
                expect_valid(result);
                // One insertion, and what it takes to conform again.
                EXPECT_LE(result.mesh.vertices.size(), budget + 64);
                ++cut_short;
            } catch (const MeshError& e) {
                EXPECT_EQ(e.code(), ErrorCode::budget_exhausted) << e.what();
                ++errors;
            }
        }
        EXPECT_GT(cut_short, 2U);
    }
    EXPECT_GT(errors, 0U);  // the cavity, for one, conforms only with more vertices than its own
}

TEST(Limits, ABudgetThatIsEnoughChangesNothing) {
    const Plc plc = transformed(l_block(), 1, 0, 1);
    MeshOptions options;
    const MeshResult free = generate(plc, options);
    options.limits.max_vertices = 100000;
    options.limits.time = std::chrono::hours(1);
    const MeshResult limited = generate(plc, options);
    EXPECT_EQ(limited.termination, Termination::goals_met);
    EXPECT_EQ(limited.mesh.tets, free.mesh.tets);
    EXPECT_EQ(limited.mesh.vertices, free.mesh.vertices);
}

TEST(Limits, ATimeLimitEndsTheRunSoon) {
    for (const int limit : {1, 20, 100}) {
        SCOPED_TRACE(limit);
        MeshOptions options;
        options.limits.time = std::chrono::milliseconds(limit);
        options.size.edge_length = 0.01;  // ten million tetrahedra
        const double seconds = seconds_of([&] {
            try {
                const MeshResult result = generate(transformed(cube(), 1, 0, 1), options);
                EXPECT_EQ(result.termination, Termination::time_budget_reached);
                expect_valid(result);
            } catch (const MeshError& e) {
                EXPECT_EQ(e.code(), ErrorCode::budget_exhausted) << e.what();
            }
        });
        EXPECT_LT(seconds, 20);
    }
}

TEST(Limits, StopBeforeTheStart) {
    std::stop_source source;
    source.request_stop();
    RunControl control;
    control.stop = source.get_token();
    for (const NamedPlc& named : all_synthetic_plcs()) {
        SCOPED_TRACE(named.name);
        // A cube conforms without any insertion: then the mesh is handed out, marked as cancelled.
        MeshOptions options;
        options.size.edge_length = 0.1 * diagonal(named.plc);
        try {
            const MeshResult result = generate(named.plc, options, control);
            EXPECT_EQ(result.termination, Termination::cancelled);
            expect_valid(result);
            EXPECT_TRUE(certify(result.mesh, {}, &named.plc).proven());
        } catch (const MeshError& e) {
            EXPECT_EQ(e.code(), ErrorCode::cancelled) << e.what();
        }
    }
}

TEST(Limits, StopWhileRefiningHandsOutTheMesh) {
    std::stop_source source;
    RunControl control;
    control.stop = source.get_token();
    std::size_t calls = 0;
    control.on_progress = [&](const Progress& p) {
        ++calls;
        if (p.stage == Stage::refine || p.stage == Stage::shape) source.request_stop();
    };
    MeshOptions options;
    options.size.edge_length = 0.02;
    const Plc plc = transformed(cube(), 1, 0, 1);
    const MeshResult result = generate(plc, options, control);
    EXPECT_EQ(result.termination, Termination::cancelled);
    EXPECT_GT(calls, 0U);
    expect_valid(result);
    EXPECT_EQ(result.certificate.find("delaunay")->state, Claim::State::not_checked);
    EXPECT_TRUE(certify(result.mesh, {}, &plc).proven());
    EXPECT_LT(result.mesh.vertices.size(), 50000U);
}

TEST(Limits, ProgressIsToldInOrderAndNotTooOften) {
    RunControl control;
    std::vector<Progress> told;
    control.on_progress = [&](const Progress& p) { told.push_back(p); };
    MeshOptions options;
    options.size.edge_length = 0.07;
    const double seconds = seconds_of([&] { expect_goals_met(generate(transformed(cube(), 1, 0, 1), options, control)); });
    ASSERT_FALSE(told.empty());
    EXPECT_LE(static_cast<double>(told.size()), 10 * seconds + 2);
    for (std::size_t i = 0; i < told.size(); ++i) {
        EXPECT_GT(told[i].vertices, 0U);
        EXPECT_GT(told[i].tets, 0U);
        if (i > 0) { EXPECT_LE(told[i - 1].stage, told[i].stage); }
    }
}

TEST(Limits, ExceptionsFromTheCallbackPropagate) {
    RunControl control;
    control.on_progress = [](const Progress&) { throw std::out_of_range("enough"); };
    MeshOptions options;
    options.size.edge_length = 0.05;
    EXPECT_THROW((void)generate(transformed(cube(), 1, 0, 1), options, control), std::out_of_range);
}

TEST(Limits, WrongOptionsAreAllNamed) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const auto wrong = [](const std::function<void(MeshOptions&)>& spoil) {
        MeshOptions options;
        spoil(options);
        EXPECT_FALSE(check(options).empty());
        expect_code(ErrorCode::bad_options, [&] { (void)generate(cube(), options); });
    };
    EXPECT_TRUE(check(MeshOptions{}).empty());
    for (const double x : {nan, infinity, -1.0, 0.0, 0.6}) wrong([&](MeshOptions& o) { o.quality.max_radius_edge_ratio = x; });
    for (const double x : {nan, infinity, -1.0, 70.6, 90.0}) wrong([&](MeshOptions& o) { o.quality.min_dihedral_angle_deg = x; });
    for (const double x : {nan, infinity, -1.0, 0.0}) {
        wrong([&](MeshOptions& o) { o.size.edge_length = x; });
        wrong([&](MeshOptions& o) { o.size.max_volume = x; });
    }
    for (const double x : {nan, infinity, -1.0}) wrong([&](MeshOptions& o) { o.coplanar_tolerance = x; });
    for (const std::uint64_t n : {0U, 1U, 3U}) wrong([&](MeshOptions& o) { o.limits.max_vertices = n; });
    for (const int ms : {0, -5}) wrong([&](MeshOptions& o) { o.limits.time = std::chrono::milliseconds(ms); });
    wrong([&](MeshOptions& o) { o.thin_features = static_cast<ThinFeatures>(7); });
    MeshOptions all;
    all.quality = {0, -1};
    all.size = {-1, -1};
    all.limits = {1, std::chrono::milliseconds(0)};
    all.coplanar_tolerance = -1;
    EXPECT_EQ(check(all).size(), 7U);
}

TEST(Limits, WrongInputIsTold) {
    expect_code(ErrorCode::bad_input, [] { (void)generate(Plc{}); });
    Plc open = cube();
    open.facets.pop_back();
    expect_code(ErrorCode::bad_input, [&] { (void)generate(open); });
    Plc infinite = cube();
    infinite.vertices[3].x = std::numeric_limits<double>::infinity();
    EXPECT_THROW((void)generate(infinite), MeshError);
    expect_code(ErrorCode::coordinate_range, [] { (void)generate(transformed(cube(), 0, 0, 1e200)); });
    Plc flat = cube();
    flat.facets.resize(1);
    EXPECT_THROW((void)generate(flat), MeshError);
}

/// A prism over a triangle with the given angle at its first corner.
Plc wedge(double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    Plc plc;
    for (const double z : {0.0, 1.0}) {
        plc.vertices.push_back({0, 0, z});
        plc.vertices.push_back({1, 0, z});
        plc.vertices.push_back({std::cos(angle), std::sin(angle), z});
    }
    const auto facet = [&](std::vector<std::uint32_t> polygon) { plc.facets.push_back({{std::move(polygon)}, {}, 0}); };
    facet({0, 2, 1});
    facet({3, 4, 5});
    facet({0, 1, 4, 3});
    facet({1, 2, 5, 4});
    facet({2, 0, 3, 5});
    return plc;
}

TEST(Limits, AcuteWedgesEndInAMeshOrATypedError) {
    std::size_t meshes = 0;
    for (const double degrees : {85.0, 60.0, 45.0, 30.0, 10.0, 2.0, 0.1})
        for (std::uint64_t rotation = 0; rotation < 2; ++rotation) {
            SCOPED_TRACE(fmt::format("{} degrees, rotation {}", degrees, rotation));
            MeshOptions options;
            options.quality.min_dihedral_angle_deg = rotation == 0 ? 20 : 0;
            options.limits.max_vertices = 2000;  // the run's own ceiling is some 50 thousand: that takes long
            const double seconds = seconds_of([&] {
                try {
                    const MeshResult result = generate(transformed(wedge(degrees), rotation, 0, 1), options);
                    expect_valid(result);
                    ++meshes;
                } catch (const MeshError& e) {
                    // A limit of the user's is not blamed on the input, but the angle is named all the same.
                    EXPECT_TRUE(e.code() == ErrorCode::unsupported_acute || e.code() == ErrorCode::budget_exhausted) << e.what();
                    EXPECT_NE(std::string(e.what()).find("less than 90 degrees"), std::string::npos) << e.what();
                    EXPECT_FALSE(e.offenders().empty());
                }
            });
            EXPECT_LT(seconds, 60);
        }
    EXPECT_GT(meshes, 0U);
}

}  // namespace
}  // namespace wellmesh::testing
