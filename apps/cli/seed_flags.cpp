// SPDX-License-Identifier: Apache-2.0
#include "seed_flags.hpp"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

namespace wellmesh::cli {

namespace {

std::optional<double> read_real(std::string_view text) {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0), end, value);
    if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
    return value;
}

Vec3 read_point(std::string_view text, const std::string& flag, const char* form) {
    std::array<double, 3> c{};
    std::string_view rest = text;
    for (std::size_t k = 0; k < c.size(); ++k) {
        const std::size_t comma = k < 2 ? rest.find(',') : rest.size();
        const auto value = comma == std::string_view::npos ? std::nullopt : read_real(rest.substr(0, comma));
        if (!value) throw CLI::ValidationError(flag, fmt::format("must be {} with finite numbers, not '{}'", form, text));
        c[k] = *value;
        rest = k < 2 ? rest.substr(comma + 1) : std::string_view();
    }
    return {c[0], c[1], c[2]};
}

SeedFlags::Region read_region(const std::string& text, const std::string& flag) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals + 1 == text.size()) throw CLI::ValidationError(flag, fmt::format("must be X,Y,Z=NAME, not '{}'", text));
    return {read_point(std::string_view(text).substr(0, equals), flag, "X,Y,Z=NAME"), text.substr(equals + 1)};
}

std::optional<std::int32_t> read_id(const std::string& text) {
    std::int32_t id = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), id);
    if (error != std::errc() || stop != text.data() + text.size()) return std::nullopt;
    return id;
}

}  // namespace

void add_seed_point_flags(CLI::App& command, SeedFlags& seeds) {
    constexpr const char* kRegion = "--region-at";
    constexpr const char* kHole = "--hole-at";
    command
        .add_option_function<std::vector<std::string>>(
            kRegion,
            [&seeds, kRegion](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) seeds.regions.push_back(read_region(text, kRegion));
            },
            "the cell around this point is the region of that name, or number; may be given several times")
        ->type_name("X,Y,Z=NAME")
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command
        .add_option_function<std::vector<std::string>>(
            kHole,
            [&seeds, kHole](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) seeds.holes.push_back(read_point(text, kHole, "X,Y,Z"));
            },
            "the cell around this point is not meshed; may be given several times")
        ->type_name("X,Y,Z")
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_seeds(const SeedFlags& seeds, Plc& plc) {
    auto& names = plc.names.of_dimension[3];
    const auto taken = [&](std::int32_t id) {
        const auto has = [&](const RegionSeed& seed) { return seed.id == id; };
        const auto states = [&](const SeedFlags::Region& region) { return read_id(region.name) == id; };
        return names.contains(id) || std::any_of(plc.region_seeds.begin(), plc.region_seeds.end(), has) ||
               std::any_of(seeds.regions.begin(), seeds.regions.end(), states);
    };
    for (const SeedFlags::Region& region : seeds.regions) {
        std::optional<std::int32_t> id = read_id(region.name);
        if (!id) id = plc.names.marker_of(3, region.name);
        if (!id) {
            std::int32_t next = 1;
            while (taken(next)) ++next;
            id = next;
            names.emplace(next, region.name);
        }
        plc.region_seeds.push_back({region.point, *id, 0});
    }
    plc.hole_seeds.insert(plc.hole_seeds.end(), seeds.holes.begin(), seeds.holes.end());
}

}  // namespace wellmesh::cli
