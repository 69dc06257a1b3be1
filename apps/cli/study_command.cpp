// SPDX-License-Identifier: Apache-2.0
// wellmesh study: every strategy with every goal and seed on every model, each run certified, in one table and one page.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <system_error>

#include "commands.hpp"
#include "exit_status.hpp"
#include "flags.hpp"
#include "number_list.hpp"
#include "output_file.hpp"
#include "study_table.hpp"
#include "wellmesh/generate.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::cli {

namespace {

namespace fs = std::filesystem;

struct StudyCommand {
    std::vector<std::string> models;
    std::vector<SliverStrategy> strategies{SliverStrategy::none, SliverStrategy::best};
    std::vector<double> theta, sizes, relative_sizes;
    std::vector<std::uint64_t> seeds;
    std::string folder;
    bool quiet = false;
    MeshOptions options;  ///< what all runs share
};

std::vector<SliverStrategy> read_strategies(const std::string& text) {
    std::vector<SliverStrategy> strategies;
    for (std::size_t from = 0; from <= text.size();) {
        const std::size_t to = std::min(text.find(',', from), text.size());
        const SliverStrategy strategy = read_strategy(text.substr(from, to - from), "--strategies");
        if (std::find(strategies.begin(), strategies.end(), strategy) == strategies.end()) strategies.push_back(strategy);
        from = to + 1;
    }
    return strategies;
}

double diagonal(const std::vector<Vec3>& points) {
    if (points.empty()) return 0;
    Vec3 low = points[0], high = points[0];
    for (const Vec3& p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    return std::hypot(high.x - low.x, high.y - low.y, high.z - low.z);
}

class Study {
public:
    Study(const StudyCommand& arguments, Interrupt& interrupt) : arguments_(arguments), interrupt_(interrupt) {}

    int run();

private:
    void check_options() const;
    void study(const std::string& model);
    void study(const std::string& model, const Plc& plc, std::optional<double> size, std::uint64_t seed);
    StudyRow make(const std::string& model, const Plc& plc, const MeshOptions& options);
    void add(StudyRow row);
    void write();
    [[nodiscard]] MeshOptions options_of(SliverStrategy strategy, double theta) const;
    [[nodiscard]] std::string description() const;
    [[nodiscard]] std::size_t runs() const;
    [[nodiscard]] std::string file(const char* name) const { return (fs::path(arguments_.folder) / name).string(); }

    const StudyCommand& arguments_;
    Interrupt& interrupt_;
    std::vector<StudyRow> rows_;
    Stopwatch since_written_;
    bool failed_ = false;
};

MeshOptions Study::options_of(SliverStrategy strategy, double theta) const {
    MeshOptions options = arguments_.options;
    options.slivers = strategy;
    options.quality.min_dihedral_angle_deg = strategy == SliverStrategy::none ? 0 : theta;
    return options;
}

/// What is wrong with the arguments is said before the first run, not after hours.
void Study::check_options() const {
    std::vector<std::optional<double>> sizes(arguments_.sizes.begin(), arguments_.sizes.end());
    sizes.insert(sizes.end(), arguments_.relative_sizes.begin(), arguments_.relative_sizes.end());  // as if the diagonal were 1
    if (sizes.empty()) sizes.emplace_back();
    for (const SliverStrategy strategy : arguments_.strategies)
        for (const double theta : arguments_.theta)
            for (const auto& size : sizes) {
                MeshOptions options = options_of(strategy, theta);
                options.size.edge_length = size;
                require_valid(options);
            }
}

std::size_t Study::runs() const {
    std::size_t a_seed = 0;
    for (const SliverStrategy strategy : arguments_.strategies) a_seed += strategy == SliverStrategy::none ? 1 : arguments_.theta.size();
    return arguments_.models.size() * std::max<std::size_t>(1, arguments_.sizes.size() + arguments_.relative_sizes.size()) * arguments_.seeds.size() * a_seed;
}

std::string Study::description() const {
    std::vector<const char*> names;
    for (const SliverStrategy strategy : arguments_.strategies) names.push_back(to_string(strategy));
    std::string text = fmt::format("{} of {} runs: strategies {}; goals {} degrees; seeds {}", rows_.size(), runs(), fmt::join(names, ", "), fmt::join(arguments_.theta, ", "),
                                   fmt::join(arguments_.seeds, ", "));
    if (!arguments_.sizes.empty()) text += fmt::format("; sizes {}", fmt::join(arguments_.sizes, ", "));
    if (!arguments_.relative_sizes.empty()) text += fmt::format("; sizes over the diagonal {}", fmt::join(arguments_.relative_sizes, ", "));
    return text;
}

/// Both files are whole at any time: what was done stays even if the program is killed.
void Study::write() {
    write_text(file("study.csv"), render_csv(rows_));
    write_text(file("study.html"), render_page(rows_, description()));
    since_written_ = Stopwatch();
}

void Study::add(StudyRow row) {
    failed_ = failed_ || !row.has_mesh();
    rows_.push_back(std::move(row));
    const StudyRow& last = rows_.back();
    if (!arguments_.quiet) {
        const std::string what = last.has_mesh() ? fmt::format("{} vertices, {:.2f} degrees, {:.2f} s", last.vertices, last.all.min_dihedral_angle_deg, last.seconds) : last.error;
        fmt::print(stderr, "{}/{} {} {}{}{}: {}: {}\n", rows_.size(), runs(), last.model, last.strategy, last.theta ? fmt::format(" {}", *last.theta) : "",
                   last.seed ? fmt::format(" seed {}", *last.seed) : "", last.status, what);
    }
    constexpr double kSecondsBetweenWrites = 2;
    if (since_written_.seconds() > kSecondsBetweenWrites) write();
}

StudyRow Study::make(const std::string& model, const Plc& plc, const MeshOptions& options) {
    StudyRow row;
    row.model = model;
    row.strategy = to_string(options.slivers);
    if (options.slivers != SliverStrategy::none) row.theta = options.quality.min_dihedral_angle_deg;
    row.seed = options.seed;
    row.size = options.size.edge_length;
    RunControl control;
    control.stop = interrupt_.token();
    const Stopwatch running;
    try {
        take_result(row, generate(plc, options, control));
    } catch (const MeshError& error) {
        row.status = to_string(error.code());
        row.error = error.what();
        row.seconds = running.seconds();
    } catch (const std::bad_alloc&) {
        row.status = "out_of_memory";
        row.error = "out of memory";
        row.seconds = running.seconds();
    }
    if (interrupt_.requested())
        throw MeshError(ErrorCode::cancelled, Stage::write, fmt::format("interrupted; the {} of {} runs that were done are in {}", rows_.size(), runs(), arguments_.folder));
    return row;
}

void Study::study(const std::string& model, const Plc& plc, std::optional<double> size, std::uint64_t seed) {
    const auto run_one = [&](SliverStrategy strategy, double theta) {
        MeshOptions options = options_of(strategy, theta);
        options.size.edge_length = size;
        options.seed = seed;
        return make(model, plc, options);
    };
    // The measure of all others, a row of its own only if it was asked for.
    StudyRow almost_good = run_one(SliverStrategy::none, 0);
    if (almost_good.has_mesh()) almost_good.almost_good_vertices = almost_good.vertices;
    const std::optional<std::uint64_t> measure = almost_good.almost_good_vertices;
    for (const SliverStrategy strategy : arguments_.strategies) {
        if (strategy == SliverStrategy::none) {
            add(almost_good);
            continue;
        }
        for (const double theta : arguments_.theta) {
            StudyRow row = run_one(strategy, theta);
            row.almost_good_vertices = measure;
            add(std::move(row));
        }
    }
}

void Study::study(const std::string& model) {
    Plc plc;
    try {
        plc = read_plc(model);
    } catch (const MeshError& error) {
        StudyRow row;
        row.model = model;
        row.status = to_string(error.code());
        row.error = error.what();
        return add(std::move(row));
    }
    std::vector<std::optional<double>> sizes(arguments_.sizes.begin(), arguments_.sizes.end());
    for (const double relative : arguments_.relative_sizes) sizes.emplace_back(relative * diagonal(plc.vertices));
    if (sizes.empty()) sizes.emplace_back();
    for (const auto& size : sizes)
        for (const std::uint64_t seed : arguments_.seeds) study(model, plc, size, seed);
}

int Study::run() {
    check_options();
    std::error_code error;
    fs::create_directories(arguments_.folder, error);
    if (error) throw MeshError(ErrorCode::cannot_write, Stage::write, fmt::format("cannot make the folder {}: {}", arguments_.folder, error.message()));
    for (const char* name : {"study.csv", "study.html"}) require_writable(file(name));
    const Interrupt::Cooperative cooperative(interrupt_);
    try {
        for (const std::string& model : arguments_.models) study(model);
    } catch (const MeshError& stop) {
        if (stop.code() == ErrorCode::cancelled) write();
        throw;
    }
    write();
    if (!arguments_.quiet) write_stdout(fmt::format("{}\nwrote {}\nwrote {}\n", render_summary(rows_), file("study.csv"), file("study.html")));
    return failed_ ? kGoalsUnmet : kGoalsMet;
}

}  // namespace

void add_study_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("study", "compare strategies, goals and seeds on models: one table, one page");
    const auto arguments = std::make_shared<StudyCommand>();
    command.add_option("MODEL", arguments->models, "domains: .poly .smesh .off .stl .obj .ply .mesh")->required()->type_name("");
    command.add_option_function<std::string>(
        "--strategies", [arguments](const std::string& text) { arguments->strategies = read_strategies(text); },
        "of --slivers, by commas; none is measured once a seed and is what vertices are compared with")
        ->type_name("LIST")->default_str("none,best");
    const auto numbers = [&command](const char* flag, std::vector<double>& values, const std::string& what, const char* fallback) {
        command.add_option_function<std::string>(flag, [flag, &values](const std::string& text) { values = read_numbers(text, flag); }, what)
            ->type_name("LIST")->default_str(fallback)->force_callback(*fallback != '\0');
    };
    numbers("--theta", arguments->theta, "least dihedral angles, in degrees: a,b,c or FIRST:STEP:LAST", "5:5:35");
    command.add_option_function<std::string>(
        "--seeds", [arguments](const std::string& text) { arguments->seeds = read_counts(text, "--seeds"); }, "seeds: a,b,c or FIRST:LAST")
        ->type_name("LIST")->default_str("1:5")->force_callback();
    numbers("--size", arguments->sizes, "target edge lengths, in input units (default: none)", "");
    numbers("--size-over-diagonal", arguments->relative_sizes, "the same as parts of each model's diagonal (default: none)", "");
    command.add_option("--max-radius-edge", arguments->options.quality.max_radius_edge_ratio, "bound on circumradius / shortest edge of every tetrahedron")
        ->type_name("RATIO")->capture_default_str();
    add_seeding_flag(command, arguments->options);
    add_limit_flags(command, arguments->options);
    command.add_option("-o,--output", arguments->folder, "folder for study.csv and study.html; made if it is not there")->required()->type_name("DIR");
    command.add_flag("--quiet", arguments->quiet, "no line a run and no summary; errors still go to standard error");
    command.callback([&selected, arguments] { selected = [arguments](Interrupt& interrupt) { return Study(*arguments, interrupt).run(); }; });
}

}  // namespace wellmesh::cli
