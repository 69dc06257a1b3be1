// SPDX-License-Identifier: Apache-2.0
// Random labelled lattices: the cells of the arrangement are the connected components of the labels.
#include "plc_helpers.hpp"

#include <map>

#include "core/rng.hpp"

namespace wellmesh::testing {
namespace {

using Cube = std::array<int, 3>;

struct Lattice {
    std::map<Cube, int> label;
    [[nodiscard]] int at(const Cube& c) const {
        const auto it = label.find(c);
        return it == label.end() ? 0 : it->second;
    }
};

Lattice random_lattice(std::uint64_t seed, int n, unsigned labels) {
    Lattice lattice;
    std::uint64_t k = 0;
    for (int x = 0; x < n; ++x)
        for (int y = 0; y < n; ++y)
            for (int z = 0; z < n; ++z) lattice.label[{x, y, z}] = static_cast<int>(mix64(seed, k++) % labels);
    return lattice;
}

/// Sizes of the components of equal label that hang together through faces; the one that holds the corner (-1, -1, -1) left out.
std::multiset<int> component_sizes(const Lattice& lattice, int n) {
    std::map<Cube, bool> seen;
    std::multiset<int> sizes;
    for (int x = -1; x <= n; ++x)
        for (int y = -1; y <= n; ++y)
            for (int z = -1; z <= n; ++z) {
                if (seen[{x, y, z}]) continue;
                const bool outer = x == -1 && y == -1 && z == -1;
                int size = 0;
                std::vector<Cube> stack{{x, y, z}};
                seen[{x, y, z}] = true;
                while (!stack.empty()) {
                    const Cube c = stack.back();
                    stack.pop_back();
                    ++size;
                    for (std::size_t axis = 0; axis < 3; ++axis)
                        for (const int step : {-1, 1}) {
                            Cube d = c;
                            d[axis] += step;
                            if (d[axis] < -1 || d[axis] > n || seen[d] || lattice.at(d) != lattice.at(c)) continue;
                            seen[d] = true;
                            stack.push_back(d);
                        }
                }
                if (!outer) sizes.insert(size);
            }
    return sizes;
}

Plc boundary_of(const Lattice& lattice, int n, bool as_triangles) {
    Plc plc;
    std::map<Cube, std::uint32_t> id;
    const auto vertex = [&](const Cube& c) {
        const auto [it, fresh] = id.try_emplace(c, static_cast<std::uint32_t>(plc.vertices.size()));
        if (fresh) plc.vertices.push_back({static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])});
        return it->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int x = -1; x <= n; ++x)
            for (int y = -1; y <= n; ++y)
                for (int z = -1; z <= n; ++z) {
                    const Cube c{x, y, z};
                    Cube d = c;
                    ++d[axis];
                    if (lattice.at(c) == lattice.at(d)) continue;
                    Cube q = d;
                    std::vector<std::uint32_t> ring{vertex(q)};
                    ++q[(axis + 1) % 3];
                    ring.push_back(vertex(q));
                    ++q[(axis + 2) % 3];
                    ring.push_back(vertex(q));
                    --q[(axis + 1) % 3];
                    ring.push_back(vertex(q));
                    if (as_triangles) {
                        for (std::size_t k = 1; k < 3; ++k) {
                            PlcFacet f;
                            f.polygons = {{ring[0], ring[k], ring[k + 1]}};
                            plc.facets.push_back(f);
                        }
                    } else {
                        PlcFacet f;
                        f.polygons = {ring};
                        plc.facets.push_back(f);
                    }
                }
    return plc;
}

TEST(RandomComplex, CellsAreTheComponents) {
    std::size_t most = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const int n = 2 + static_cast<int>(seed % 4);
        const Lattice lattice = random_lattice(seed, n, 2 + static_cast<unsigned>(seed % 3));
        Plc plc = boundary_of(lattice, n, seed % 2 == 0);
        if (plc.facets.empty()) continue;
        plc.merge_coplanar = seed % 3 == 0 ? MergeRule::all : MergeRule::triangles;
        plc = transformed(plc, seed % 5, seed % 4 == 0 ? 1e3 : 0, 1);
        SCOPED_TRACE(seed);
        const ValidPlc valid = validate(plc);
        expect_consistent(valid);
        EXPECT_TRUE(valid.acute_features.empty()) << valid.acute_features[0].angle_deg;
        std::multiset<int> sizes;
        for (std::size_t c = 1; c < valid.cells.size(); ++c) {
            sizes.insert(static_cast<int>(std::lround(valid.cells[c].volume)));
            EXPECT_NEAR(valid.cells[c].volume, std::round(valid.cells[c].volume), 1e-6);
        }
        EXPECT_EQ(sizes, component_sizes(lattice, n));
        most = std::max(most, sizes.size());
    }
    EXPECT_GT(most, 40U);
}

TEST(RandomComplex, InsideIsInsideWhereverOneAsks) {
    // a region seed at the reported inside of each cell names exactly that cell
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        Plc plc = boundary_of(random_lattice(seed, 3, 3), 3, true);
        plc = transformed(plc, seed, 0, 1);
        const ValidPlc valid = validate(plc);
        for (std::size_t c = 1; c < valid.cells.size(); ++c) plc.region_seeds.push_back({valid.cells[c].inside, static_cast<std::int32_t>(100 + c), 0});
        const ValidPlc named = validate(plc);
        for (std::size_t c = 1; c < named.cells.size(); ++c) EXPECT_EQ(named.cells[c].region, static_cast<std::int32_t>(100 + c));
    }
}

TEST(RandomComplex, DroppingAFacetMergesItsCells) {
    const Lattice lattice = random_lattice(3, 3, 3);
    const Plc whole = boundary_of(lattice, 3, false);
    const std::size_t cells = validate(whole).cells.size();
    std::size_t fewer = 0;
    for (std::size_t f = 0; f < whole.facets.size(); f += 5) {
        Plc plc = whole;
        plc.facets.erase(plc.facets.begin() + static_cast<std::ptrdiff_t>(f));
        const Diagnosis d = diagnose(plc);
        EXPECT_FALSE(d.has_errors()) << listing(d);
        EXPECT_TRUE(d.cells.size() == cells || d.cells.size() + 1 == cells);
        fewer += d.cells.size() < cells;
    }
    EXPECT_GT(fewer, 5U);
}

}  // namespace
}  // namespace wellmesh::testing
