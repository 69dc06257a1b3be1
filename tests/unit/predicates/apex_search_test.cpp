// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "ladder_check.hpp"
#include "oracle/rational_predicates.hpp"
#include "predicates/apex_search.hpp"

namespace wellmesh::test {
namespace {

constexpr std::array<std::uint32_t, 3> kFace{0, 1, 2};

struct Found {
    std::uint32_t nominee;
    std::vector<std::uint32_t> rivals;
};

/// With the tightest bounds, without lanes and, if there are any, with them.
std::vector<Found> search(const std::vector<Vec3>& points) {
    PointColumns columns;
    columns.reset(points.size());
    Vec3 low = points[0], high = points[0];
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& p = points[i];
        columns.set(i, p);
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const PredicateFilter filter({high.x - low.x, high.y - low.y, high.z - low.z});
    const ApexSearch of_face{columns, kFace, filter.orient3d_bound(), filter.insphere_bound()};
    std::vector<Found> found(has_insphere_lanes() ? 2 : 1);
    found[0].nominee = of_face.nominate(found[0].rivals);
    if (found.size() == 2) found[1].nominee = of_face.nominate_in_lanes(found[1].rivals);
    return found;
}

/// The nominee is in front, and who is no rival is behind or outside the nominee's sphere.
void expect_certain(const std::vector<Vec3>& p, const Found& found) {
    const bool has_nominee = found.nominee != ApexSearch::kNobody;
    if (has_nominee) { ASSERT_EQ(oracle::orient3d(p[0], p[1], p[2], p[found.nominee]), Sign::positive); }
    for (std::uint32_t i = 3; i < p.size(); ++i) {
        if (i == found.nominee || std::find(found.rivals.begin(), found.rivals.end(), i) != found.rivals.end()) continue;
        const bool is_behind = oracle::orient3d(p[0], p[1], p[2], p[i]) == Sign::negative;
        ASSERT_TRUE(is_behind || (has_nominee && oracle::insphere(p[0], p[1], p[2], p[found.nominee], p[i]) == Sign::negative)) << i;
    }
    for (const std::uint32_t rival : found.rivals) ASSERT_TRUE(rival >= 3 && rival < p.size() && rival != found.nominee);
}

TEST(ApexSearch, NeverErrsWithTheTightestBox) {
    int cases = 0, decided = 0;
    std::uint64_t stream = 500;
    for (const Family& family : kFamilies) {
        ++stream;
        const auto n = static_cast<std::uint64_t>(20'000 * family.share);
        for (std::uint64_t i = 0; i < n; ++i) {
            Random random(stream, i);
            const Quintuple q = family.generate(random);
            for (const Found& found : search({q.begin(), q.end()})) {
                SCOPED_TRACE(describe(q, family.name, i));
                expect_certain({q.begin(), q.end()}, found);
                ++cases;
                decided += found.rivals.empty() ? 1 : 0;
            }
        }
    }
    EXPECT_GT(decided, cases / 4);
}

/// Any number of points; on a coarse grid, many are on one sphere or in one plane.
TEST(ApexSearch, LeavesFewRivalsButTheTruth) {
    for (const bool on_grid : {false, true}) {
        int alone = 0, with_rivals = 0;
        for (std::uint64_t i = 0; i < 2'000; ++i) {
            Random r(501, i);
            std::vector<Vec3> p(4 + i % 150);
            for (Vec3& q : p) q = r.point([&] { return on_grid ? std::floor(6 * r.unit()) : r.unit(); });
            std::uint32_t best = ApexSearch::kNobody;
            for (std::uint32_t d = 3; d < p.size(); ++d)
                if (oracle::orient3d(p[0], p[1], p[2], p[d]) == Sign::positive &&
                    (best == ApexSearch::kNobody || oracle::insphere(p[0], p[1], p[2], p[best], p[d]) == Sign::positive))
                    best = d;
            for (const Found& found : search(p)) {
                expect_certain(p, found);
                ++(found.rivals.empty() ? alone : with_rivals);
                if (found.rivals.empty()) { ASSERT_EQ(found.nominee, best); }
            }
        }
        if (on_grid) EXPECT_GT(with_rivals, alone);
        else EXPECT_GT(alone, 100 * with_rivals);
    }
}

}  // namespace
}  // namespace wellmesh::test
