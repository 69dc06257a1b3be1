// SPDX-License-Identifier: Apache-2.0
#include "number_list.hpp"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

namespace wellmesh::cli {

namespace {

constexpr std::size_t kMostNumbers = 10'000;  // a study of more runs than this was not meant

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t to = std::min(text.find(separator, from), text.size());
        parts.push_back(text.substr(from, to - from));
        from = to + 1;
    }
    return parts;
}

/// All of `word`, which std::from_chars reads without regard to the locale; "inf" and "nan" are no numbers here.
template <class T>
bool read_all(std::string_view word, T& value) {
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error != std::errc() || stop != end) return false;
    if constexpr (std::is_floating_point_v<T>) return std::isfinite(value);
    return true;
}

/// How many steps lead from `first` to `last`; more than kMostNumbers where there is no end to them.
std::size_t steps(double first, double step, double last) {
    constexpr double kRounding = 1e-9;  // of a step: 0.1:0.1:0.3 has three numbers
    return static_cast<std::size_t>(std::min((last - first) / step + kRounding, static_cast<double>(kMostNumbers)));
}
std::size_t steps(std::uint64_t first, std::uint64_t step, std::uint64_t last) { return static_cast<std::size_t>(std::min<std::uint64_t>((last - first) / step, kMostNumbers)); }

template <class T>
std::vector<T> read_list(const std::string& text, const std::string& flag, const char* kind) {
    const auto refuse = [&](const std::string& why) { return CLI::ValidationError(flag, fmt::format("must be {}{}, not '{}'{}", kind, kNumberListForm, text, why)); };
    std::vector<T> numbers;
    for (const std::string_view item : split(text, ',')) {
        const std::vector<std::string_view> words = split(item, ':');
        std::vector<T> values(words.size());
        if (words.size() > 3) throw refuse("");
        for (std::size_t i = 0; i < words.size(); ++i)
            if (!read_all(words[i], values[i])) throw refuse("");
        const T first = values.front(), last = values.back(), step = values.size() == 3 ? values[1] : T{1};
        if (!(step > 0) || first > last) throw refuse("");
        for (std::size_t i = 0, n = steps(first, step, last); i <= n; ++i) {
            const T value = first + static_cast<T>(i) * step;
            if (std::find(numbers.begin(), numbers.end(), value) == numbers.end()) numbers.push_back(value);
            if (numbers.size() > kMostNumbers) throw refuse(fmt::format(", which is more than {} numbers", kMostNumbers));
        }
    }
    return numbers;
}

}  // namespace

std::vector<double> read_numbers(const std::string& text, const std::string& flag) { return read_list<double>(text, flag, ""); }

std::vector<std::uint64_t> read_counts(const std::string& text, const std::string& flag) { return read_list<std::uint64_t>(text, flag, "whole "); }

}  // namespace wellmesh::cli
