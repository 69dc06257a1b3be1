// SPDX-License-Identifier: Apache-2.0
#include "flags.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>
#include <system_error>

#include "output_file.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh::cli {

namespace fs = std::filesystem;

std::string lower_extension(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    return extension;
}

namespace {

constexpr std::array<const char*, 6> kMeshExtensions = {".mesh", ".vtu", ".msh", ".inp", ".node", ".ele"};

[[noreturn]] void bad_options(const std::vector<std::string>& problems) {
    throw MeshError(ErrorCode::bad_options, Stage::read, fmt::format("{}", fmt::join(problems, "\n  ")));
}

/// Seconds as people type them. The range keeps the product within 64 bits and refuses NaN.
std::chrono::milliseconds read_seconds(const std::string& text, const std::string& flag) {
    constexpr double kLongest = 1e9;  // 31 years
    double seconds = 0;
    if (!CLI::detail::lexical_cast(text, seconds) || !(seconds > 0 && seconds <= kLongest))
        throw CLI::ValidationError(flag, fmt::format("must be above 0 and at most 1e9 seconds, not '{}'", text));
    return std::chrono::milliseconds(std::max<std::int64_t>(1, std::llround(seconds * 1000)));
}

/// A whole number of 64 bits, all of the text; the parser's own conversion wraps negative and large ones.
std::uint64_t read_count(const std::string& text, const std::string& flag) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end) throw CLI::ValidationError(flag, fmt::format("must be a whole number from 0 to 2^64 - 1, not '{}'", text));
    return value;
}

/// Bytes as people type them: 4000000000, 500M, 1.5G, 2GiB.
std::uint64_t read_bytes(const std::string& text, const std::string& flag) {
    constexpr std::string_view kUnits = "KMGT";
    constexpr double kLeast = 1 << 20, kMost = 0x1p60;
    std::string_view number = text;
    for (const std::string_view ending : {"iB", "B"})
        if (number.ends_with(ending)) {
            number.remove_suffix(ending.size());
            break;
        }
    double unit = 1;
    if (const std::size_t power = number.empty() ? std::string_view::npos : kUnits.find(static_cast<char>(number.back() & ~0x20)); power != std::string_view::npos) {
        unit = std::ldexp(1.0, 10 * (static_cast<int>(power) + 1));
        number.remove_suffix(1);
    }
    double value = 0;
    const bool digits_first = !number.empty() && number.front() >= '0' && number.front() <= '9';
    if (!digits_first || !CLI::detail::lexical_cast(std::string(number), value) || !(value * unit >= kLeast && value * unit <= kMost))
        throw CLI::ValidationError(flag, fmt::format("must be between 1M and 1048576T, in bytes or with K, M, G or T after the number, not '{}'", text));
    return static_cast<std::uint64_t>(value * unit);
}

/// All files that reading or writing this one touches: in TetGen's family one name stands for several.
std::vector<fs::path> files_behind(const fs::path& path) {
    std::vector<fs::path> files{resolved(path)};
    const std::string extension = lower_extension(path);
    const auto add = [&](std::initializer_list<const char*> siblings) {
        for (const char* sibling : siblings) files.push_back(fs::path(files[0]).replace_extension(sibling));
    };
    if (extension == ".node" || extension == ".ele" || extension == ".mtr") add({".node", ".ele", ".face", ".edge", ".mtr"});
    if (extension == ".poly" || extension == ".smesh") add({".node", ".mtr"});
    if (extension == ".vtu") add({".boundary.vtu"});
    return files;
}

bool share_a_file(const fs::path& a, const fs::path& b) {
    std::error_code ignored;
    for (const fs::path& p : files_behind(a))
        for (const fs::path& q : files_behind(b))
            if (p == q || fs::equivalent(p, q, ignored)) return true;
    return false;
}

References read_references(const std::string& text) {
    if (text == "entity") return References::entity;
    if (text == "marker") return References::marker;
    throw CLI::ValidationError("--references", fmt::format("must be entity or marker, not '{}'", text));
}

Mode read_mode(const std::string& text) {
    if (text == "practical") return Mode::practical;
    if (text == "certified") return Mode::certified;
    throw CLI::ValidationError("--mode", fmt::format("must be practical or certified, not '{}'", text));
}

std::string strategy_names(const char* separator) {
    std::vector<const char*> names;
    for (const SliverStrategy strategy : kSliverStrategies) names.push_back(to_string(strategy));
    return fmt::format("{}", fmt::join(names, separator));
}

/// The paper's constants, and the mode, which has its own defaults for two goals (they hold where the goal is not given).
void add_paper_flags(CLI::App& command, MeshOptions& options, const CLI::Option* ratio, const CLI::Option* angle) {
    command.add_option_function<std::string>(
        "--mode", [&options](const std::string& text) { options.mode = read_mode(text); },
        "certified: constants for which the paper proves its claims, each checked on the run; it then judges slivers by sigma0")
        ->type_name("practical|certified")->default_str("practical");
    command.add_option("--delta", options.paper.delta, fmt::format("radius of a picking region over the circumradius (default: {}; certified: {})", kPracticalDelta, kCertifiedDelta))
        ->type_name("DELTA");
    command.add_option("--b", options.paper.b, fmt::format("new slivers below b circumradii of what was split are avoided (certified: {}; refine: {}; improve: none)", kCertifiedB, kPracticalB))->type_name("B");
    const CLI::Option* rho = command.add_option("--rho0", options.quality.max_radius_edge_ratio,
                                                fmt::format("the paper's name of --max-radius-edge (default in certified mode: {})", kCertifiedRadiusEdgeRatio))
        ->type_name("RATIO");
    command.add_option("--sigma0", options.paper.sigma0, fmt::format("slivers have volume / shortest edge^3 below this (certified: {}; refine, improve: the angle decides)", kCertifiedSigma))
        ->type_name("SIGMA");
    command.add_option("--sigma0-boundary", options.paper.sigma0_boundary, "refine, improve: --sigma0 of tetrahedra that touch the boundary (default: the same)")->type_name("SIGMA");
    command.add_flag("--invariants", options.invariants, "report what the paper claims of the insertions, and what they did");
    command.parse_complete_callback([&options, ratio, angle, rho] {
        // Where slivers are left alone, or judged by sigma0, angles are no goal unless one is given.
        const bool by_angle = options.slivers != SliverStrategy::none && !options.paper.sigma0;
        if (!by_angle && angle->count() == 0) options.quality.min_dihedral_angle_deg = 0;
        if (options.mode != Mode::certified) return;
        const MeshOptions certified = certified_options();
        if (ratio->count() == 0 && rho->count() == 0) options.quality.max_radius_edge_ratio = certified.quality.max_radius_edge_ratio;
        if (angle->count() == 0) options.quality.min_dihedral_angle_deg = certified.quality.min_dihedral_angle_deg;
    });
}

/// "ID=H" of --size-region and its like.
EntitySize read_entity_size(const std::string& text, EntityKind kind, const std::string& flag) {
    const std::size_t equals = text.rfind('=');
    EntitySize size{kind, 0, 0};
    const bool good = equals != std::string::npos && equals > 0 && CLI::detail::lexical_cast(text.substr(equals + 1), size.edge_length);
    if (!good || !(size.edge_length > 0 && size.edge_length <= std::numeric_limits<double>::max()))
        throw CLI::ValidationError(flag, fmt::format("must be ID=H, a number or a name and an edge length above 0, not '{}'", text));
    if (!CLI::detail::lexical_cast(text.substr(0, equals), size.id)) size.name = text.substr(0, equals);
    return size;
}

/// Sizes that differ from place to place, and how they grow.
void add_size_field_flags(CLI::App& command, MeshOptions& options) {
    SizeGoals& size = options.size;
    const auto on_entities = [&](const std::string& flag, EntityKind kind, const char* what) {
        command.add_option_function<std::vector<std::string>>(
            flag, [&size, kind, flag](const std::vector<std::string>& texts) { for (const std::string& text : texts) size.entities.push_back(read_entity_size(text, kind, flag)); }, what)
            ->type_name("ID=H")->expected(1)->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    };
    on_entities("--size-region", EntityKind::region, "target edge length in a region, by its id or name; may be given several times, as may the next three");
    on_entities("--size-facet", EntityKind::facet, "target edge length on the facets of this marker or name");
    on_entities("--size-segment", EntityKind::segment, "target edge length on the segments of this marker or name");
    on_entities("--size-vertex", EntityKind::vertex, "target edge length at the vertices of this marker or name");
    command.add_option_function<std::string>(
        "--vertex-sizes",
        [&size](const std::string& text) {
            if (text != "auto" && text != "off") throw CLI::ValidationError("--vertex-sizes", fmt::format("'{}' is neither auto nor off", text));
            size.vertex_sizes = text == "auto";
        },
        "target edge lengths at the input's vertices, where a .mtr file lies beside a .poly or .smesh")
        ->type_name("auto|off")->default_str("auto");
    command.add_option("--lfs", size.per_local_feature_size, "target edge length over the distance of features without a common point (default: none)")->type_name("K");
    command.add_option("--curvature", size.elements_per_circle, "so many edges for a full circle of what is curved smoothly (default: none)")->type_name("N");
    command.add_option_function<std::string>(
        "--gradation",
        [&size](const std::string& text) {
            if (text == "off") size.gradation = 0;
            else if (!CLI::detail::lexical_cast(text, size.gradation)) throw CLI::ValidationError("--gradation", fmt::format("must be a number or off, not '{}'", text));
        },
        "sizes grow by at most this per unit of distance; off: as they like")
        ->type_name("G|off")->default_str(fmt::format("{}", size.gradation));
    command.add_option("--min-size", size.min_edge_length, "no size asked for counts as less than this (default: none)")->type_name("H");
}

}  // namespace

SliverStrategy read_strategy(const std::string& text, const std::string& flag) {
    if (const auto strategy = parse_sliver_strategy(text)) return *strategy;
    throw CLI::ValidationError(flag, fmt::format("must be one of {}, not '{}'", strategy_names(" "), text));
}

void add_coplanar_tolerance_flag(CLI::App& command, MeshOptions& options) {
    command.add_option("--coplanar-tolerance", options.coplanar_tolerance,
                       "merge and accept facets whose vertices leave their plane by at most this, in input units (default: from the rounding of the input)")
        ->type_name("D");
}

GoalFlags add_goal_flags(CLI::App& command, MeshOptions& options) {
    command.add_option("--size", options.size.edge_length, "target edge length, in input units (default: none)")->type_name("H");
    command.add_option("--max-volume", options.size.max_volume, "bound on the volume of every tetrahedron (default: none)")->type_name("V");
    add_size_field_flags(command, options);
    const CLI::Option* ratio = command.add_option("--max-radius-edge", options.quality.max_radius_edge_ratio, "bound on circumradius / shortest edge of every tetrahedron")
        ->type_name("RATIO")->capture_default_str();
    const CLI::Option* angle = command.add_option("--min-dihedral", options.quality.min_dihedral_angle_deg, "least dihedral angle, in degrees; 0 ignores slivers")
        ->type_name("DEG")->capture_default_str();
    return {ratio, angle};
}

void add_seed_flag(CLI::App& command, MeshOptions& options) {
    command.add_option_function<std::string>(
        "--seed", [&options](const std::string& text) { options.seed = read_count(text, "--seed"); },
        "seed of the pseudo-random choices; input, options and seed fix the output")
        ->type_name("N")->default_str(fmt::format("{}", options.seed));
}

void add_threads_flag(CLI::App& command, unsigned& threads) {
    command.add_option_function<std::string>(
        "--threads",
        [&threads](const std::string& text) {
            const std::uint64_t n = read_count(text, "--threads");
            if (n > kMostThreads) throw CLI::ValidationError("--threads", fmt::format("{} is more than {}", n, kMostThreads));
            threads = static_cast<unsigned>(n);
        },
        "threads at work; 0: one for each core. The output is the same for any number")
        ->type_name("N")->default_str(fmt::format("{}", threads));
}

void add_thin_features_flag(CLI::App& command, MeshOptions& options) {
    command.add_option_function<std::string>(
        "--thin-features",
        [&options](const std::string& text) {
            if (text != "join" && text != "refuse") throw CLI::ValidationError("--thin-features", fmt::format("'{}' is neither join nor refuse", text));
            options.thin_features = text == "join" ? ThinFeatures::join : ThinFeatures::refuse;
        },
        "what is thinner than the rounding of the input's coordinates: join (closed within that rounding, reported) or refuse (an error)")
        ->type_name("WHAT")->default_str("join");
}

void add_limit_flags(CLI::App& command, MeshOptions& options) {
    add_coplanar_tolerance_flag(command, options);
    add_thin_features_flag(command, options);
    command.add_option_function<std::string>(
        "--max-vertices", [&options](const std::string& text) { options.limits.max_vertices = read_count(text, "--max-vertices"); },
        "stop at this many vertices, input included (default: none)")
        ->type_name("N");
    command.add_option_function<std::string>(
        "--time-limit", [&options](const std::string& text) { options.limits.time = read_seconds(text, "--time-limit"); },
        "stop refining after this many seconds; the certificate and writing come on top (default: none)")
        ->type_name("SECONDS");
    command.add_option_function<std::string>(
        "--max-memory", [&options](const std::string& text) { options.limits.memory_bytes = read_bytes(text, "--max-memory"); },
        "stop refining before the program holds more than this: bytes, or with K, M, G or T after the number, powers of 1024 (default: none)")
        ->type_name("SIZE");
}

void add_seeding_flag(CLI::App& command, MeshOptions& options) {
    command.add_option_function<std::string>(
        "--seeding",
        [&options](const std::string& text) {
            if (text != "auto" && text != "off") throw CLI::ValidationError("--seeding", fmt::format("'{}' is neither auto nor off", text));
            options.seeding = text == "auto" ? Seeding::automatic : Seeding::off;
        },
        "start from a lattice inside, where a size is asked for: fewer vertices for the same size")
        ->type_name("auto|off")->default_str("auto");
}

void add_mesh_flags(CLI::App& command, MeshOptions& options) {
    const GoalFlags goals = add_goal_flags(command, options);
    command.add_option("--min-dihedral-boundary", options.quality.min_dihedral_boundary_deg,
                       "--slivers refine, improve: --min-dihedral of tetrahedra that touch the boundary (default: the same)")
        ->type_name("DEG");
    command.add_option_function<std::string>(
        "--slivers", [&options](const std::string& text) { options.slivers = read_strategy(text, "--slivers"); },
        "how slivers are removed: none (they stay; --min-dihedral defaults to 0 then), a published way, or best (docs/strategies.md)")
        ->type_name(strategy_names("|"))->default_str(to_string(options.slivers));
    add_seeding_flag(command, options);
    add_paper_flags(command, options, goals.radius_edge, goals.dihedral);
    add_seed_flag(command, options);
    add_threads_flag(command, options.threads);
    add_limit_flags(command, options);
}

void add_write_flags(CLI::App& command, WriteOptions& options) {
    command.add_option("--msh-version", options.msh_version, "flavour of .msh files: 41 or 22")->type_name("41|22")->capture_default_str();
    command.add_option_function<std::string>(
        "--references", [&options](const std::string& text) { options.references = read_references(text); },
        "what references in a .mesh are: numbers of the input's vertices, segments and facets, or their markers")
        ->type_name("entity|marker")->default_str("entity");
}

void add_certify_flags(CLI::App& command, CertifyOptions& options) {
    command.add_option("--max-radius-edge", options.max_radius_edge_ratio, "refute if circumradius / shortest edge exceeds this")->type_name("RATIO");
    command.add_option("--min-dihedral", options.min_dihedral_angle_deg, "refute if a dihedral angle is below this, in degrees")->type_name("DEG");
    command.add_option("--min-dihedral-boundary", options.min_dihedral_boundary_deg, "the same for tetrahedra that touch the boundary (default: the same)")->type_name("DEG");
    command.add_option("--max-aspect", options.max_aspect_ratio, "refute if circumradius / inradius exceeds this (3 is regular)")->type_name("RATIO");
    command.add_option("--min-sigma", options.min_sigma, "refute if volume / shortest edge^3 is below this")->type_name("SIGMA");
    command.add_option("--min-sigma-boundary", options.min_sigma_boundary, "the same for tetrahedra that touch the boundary (default: the same)")->type_name("SIGMA");
    command.add_option("--max-volume", options.max_volume, "refute if the volume of a tetrahedron exceeds this")->type_name("V");
    command.add_option("--tolerance", options.tolerance, "how far a subface may leave the input, relative to the input's diagonal")
        ->type_name("REL")->capture_default_str();
    command.add_option("--flat-angle", options.flat_angle_rad, "constraint triangles that bend less than this make no segment, in radians")
        ->type_name("RAD")->capture_default_str();
}

void add_json_flag(CLI::App& command, std::string& path) {
    command.add_option("--json", path, "write the report as JSON; - is standard output")->type_name("FILE");
}

void add_output_flag(CLI::App& command, std::vector<std::string>& paths, const std::string& what) {
    command.add_option("-o,--output", paths, what)->type_name("FILE")->expected(1)->allow_extra_args(false)->multi_option_policy(
        CLI::MultiOptionPolicy::TakeAll);
}

void require_valid(const MeshOptions& options) {
    if (const std::vector<std::string> problems = check(options); !problems.empty()) bad_options(problems);
}

void require_valid(const WriteOptions& options) {
    if (options.msh_version != 41 && options.msh_version != 22)
        bad_options({fmt::format("--msh-version must be 41 or 22, not {}", options.msh_version)});
}

void require_valid(const CertifyOptions& options) {
    std::vector<std::string> problems;
    const auto need = [&](const char* flag, std::optional<double> value, double least, double most, const char* range) {
        if (value && !(*value >= least && *value <= most)) problems.push_back(fmt::format("{} must be {}, not {}", flag, range, *value));
    };
    constexpr double kMost = std::numeric_limits<double>::max();
    constexpr double kLeast = std::numeric_limits<double>::denorm_min();
    need("--max-radius-edge", options.max_radius_edge_ratio, kLeast, kMost, "a positive number");
    need("--min-dihedral", options.min_dihedral_angle_deg, 0, 90, "between 0 and 90 degrees");
    need("--min-dihedral-boundary", options.min_dihedral_boundary_deg, 0, 90, "between 0 and 90 degrees");
    need("--min-sigma-boundary", options.min_sigma_boundary, 0, kMost, "a number not below 0");
    need("--max-aspect", options.max_aspect_ratio, kLeast, kMost, "a positive number");
    need("--min-sigma", options.min_sigma, 0, kMost, "a number not below 0");
    need("--max-volume", options.max_volume, kLeast, kMost, "a positive number");
    need("--tolerance", options.tolerance, 0, 1, "between 0 and 1");
    need("--flat-angle", options.flat_angle_rad, 0, std::numbers::pi, "between 0 and pi radians");
    if (!problems.empty()) bad_options(problems);
}

void require_mesh_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
    std::vector<std::string> problems;
    for (const std::string& output : outputs)
        if (const std::string extension = lower_extension(output); std::find(kMeshExtensions.begin(), kMeshExtensions.end(), extension) == kMeshExtensions.end())
            problems.push_back(fmt::format("{}: unknown mesh format '{}'; known are {}", output, extension, fmt::join(kMeshExtensions, " ")));
    require_outputs(outputs, inputs, std::move(problems));
}

void require_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs, std::vector<std::string> problems) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const std::string& output = outputs[i];
        for (const std::string& input : inputs)
            if (share_a_file(output, input)) problems.push_back(fmt::format("{}: writing it would replace the input {}", output, input));
        const bool twice = std::any_of(outputs.begin(), outputs.begin() + static_cast<std::ptrdiff_t>(i), [&](const std::string& o) { return share_a_file(o, output); });
        if (twice) problems.push_back(fmt::format("{}: named twice", output));
    }
    if (!problems.empty()) bad_options(problems);
    for (const std::string& output : outputs) require_writable(output);
}

void require_report(const std::string& flag, const std::string& report, const std::vector<std::string>& others) {
    if (report.empty()) return;
    const fs::path target = resolved(report);
    std::error_code ignored;
    for (const std::string& other : others)
        for (const fs::path& file : files_behind(other))
            if (target == file || fs::equivalent(target, file, ignored)) bad_options({fmt::format("{} {}: writing it would replace {}", flag, report, file.string())});
    require_writable(report);
}

}  // namespace wellmesh::cli
