// SPDX-License-Identifier: Apache-2.0
// What is made is to be the same for any number of threads.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace wellmesh::testing {

/// A sanitizer makes everything five to twenty times as slow. Faults that it looks for are in small inputs, too.
#ifdef WELLMESH_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// Calls make(threads) for each number, and compare(first, other) for what it returns. A sanitizer sees what there is to see when several threads make it once.
/// @return the first
template <class Make, class Compare>
auto compare_for_any_threads(const Make& make, const Compare& compare, const std::vector<unsigned>& numbers = {1, 2, 3, 8}) {
    if constexpr (kSanitized) return make(3U);
    auto first = make(numbers[0]);
    for (std::size_t i = 1; i < numbers.size(); ++i) {
        SCOPED_TRACE(::testing::Message() << numbers[i] << " threads");
        compare(first, make(numbers[i]));
    }
    return first;
}

template <class Make>
auto same_for_any_threads(const Make& make, const std::vector<unsigned>& numbers = {1, 2, 3, 8}) {
    return compare_for_any_threads(make, [](const auto& first, const auto& other) { EXPECT_TRUE(first == other); }, numbers);
}

}  // namespace wellmesh::testing
