// SPDX-License-Identifier: Apache-2.0
// Runs a predicate's whole ladder on the families of points and compares every rung with the oracle.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <sstream>
#include <string>

#include "point_families.hpp"
#include "predicates/predicates_internal.hpp"

namespace wellmesh::test {

inline constexpr Rung kClimbedRungs[] = {Rung::forward_bound, Rung::exact_doubles, Rung::double_double, Rung::exact};

struct RungCounts {
    std::uint64_t cases = 0, zeros = 0;
    std::map<Rung, std::uint64_t> decided;
};

inline std::string describe(const Quintuple& q, const char* family, std::uint64_t number) {
    std::ostringstream out;
    out << family << " " << number << ":";
    for (const Vec3& p : q) out << " " << p;
    return out.str();
}

/// For `cases` cases over all families: each rung that decides says what the oracle says; the exact rung always decides;
/// and the ladder reports the first rung that does, and the oracle's sign. Returns what happened, by family.
template <class Decide, class SingleRung, class Oracle>
std::map<std::string, RungCounts> check_ladder(std::uint64_t cases, Decide decide, SingleRung single_rung, Oracle oracle) {
    std::map<std::string, RungCounts> result;
    std::uint64_t stream = 0;
    for (const Family& family : kFamilies) {
        RungCounts& counts = result[family.name];
        ++stream;
        const auto n = static_cast<std::uint64_t>(family.share * static_cast<double>(cases));
        for (std::uint64_t i = 0; i < n; ++i) {
            Random random(stream, i);
            const Quintuple q = family.generate(random);
            const Sign truth = oracle(q);
            const Decision decision = decide(q);
            std::optional<Rung> first;
            for (const Rung rung : kClimbedRungs) {
                const std::optional<Sign> sign = single_rung(rung, q);
                if (!sign) continue;
                if (!first) first = rung;
                if (*sign != truth) {
                    ADD_FAILURE() << "rung " << static_cast<int>(rung) << " says " << *sign << ", the oracle " << truth << " for "
                                  << describe(q, family.name, i);
                    return result;
                }
            }
            if (decision.sign != truth || first != decision.rung || !single_rung(Rung::exact, q)) {
                ADD_FAILURE() << "ladder says " << decision.sign << " on rung " << static_cast<int>(decision.rung) << ", the oracle " << truth
                              << " for " << describe(q, family.name, i);
                return result;
            }
            ++counts.cases;
            if (truth == Sign::zero) ++counts.zeros;
            ++counts.decided[decision.rung];
        }
    }
    return result;
}

/// Share of a family's cases that a rung decided.
inline double share(const RungCounts& counts, Rung rung) {
    const auto found = counts.decided.find(rung);
    return found == counts.decided.end() ? 0 : static_cast<double>(found->second) / static_cast<double>(counts.cases);
}

inline std::uint64_t total(const std::map<std::string, RungCounts>& counts, Rung rung) {
    std::uint64_t sum = 0;
    for (const auto& [family, c] : counts)
        if (const auto found = c.decided.find(rung); found != c.decided.end()) sum += found->second;
    return sum;
}

/// Shown with every failed expectation about counts.
inline std::string table(const std::map<std::string, RungCounts>& counts) {
    std::ostringstream out;
    out << "family: cases, zeros | forward, exact doubles, double double, exact\n";
    for (const auto& [family, c] : counts) {
        out << family << ": " << c.cases << ", " << c.zeros << " |";
        for (const Rung rung : kClimbedRungs) out << " " << share(c, rung);
        out << "\n";
    }
    return out.str();
}

}  // namespace wellmesh::test
