// SPDX-License-Identifier: Apache-2.0
// The pipeline: one call a stage, nothing else (src/README.md).
#include <algorithm>
#include <chrono>
#include <memory>
#include <new>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "adoption/adopt.hpp"
#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/resident_memory.hpp"
#include "core/run_guard.hpp"
#include "core/workers.hpp"
#include "exudation/exude.hpp"
#include "pipeline/certify_result.hpp"
#include "pipeline/extract_mesh.hpp"
#include "pipeline/exudation_bounds.hpp"
#include "pipeline/join_input.hpp"
#include "pipeline/list_exemptions.hpp"
#include "pipeline/refusals.hpp"
#include "pipeline/report_goals.hpp"
#include "pipeline/report_notes.hpp"
#include "pipeline/report_sizes.hpp"
#include "pipeline/theory_run.hpp"
#include "predicates/predicates.hpp"
#include "refinement/lattice_seeding.hpp"
#include "refinement/refine.hpp"
#include "sizing/entity_sizes.hpp"
#include "strategies/sliver_strategies.hpp"
#include "validation/gap_demand.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/generate.hpp"
#include "wellmesh/improve.hpp"

namespace wellmesh {
namespace {

MeshOptions with_names_resolved(const MeshOptions& options, const Plc& plc) {
    MeshOptions out = options;
    out.size.entities = with_ids(options.size.entities, plc.names);
    return out;
}

std::uint64_t count_filled(const ConformingMesh& mesh, Workers& workers) {
    constexpr std::size_t kSlotsAPiece = std::size_t{1} << 15;
    std::vector<std::uint64_t> counts((mesh.tets().slots() + kSlotsAPiece - 1) / kSlotsAPiece);
    workers.for_ranges(mesh.tets().slots(), kSlotsAPiece, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        std::uint64_t n = 0;
        for (std::size_t i = begin; i < end; ++i) n += mesh.tets().is_finite(TetId{i}) && mesh.in_domain(TetId{i});
        counts[piece] = n;
    });
    return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

class Generator {
public:
    /// @param given  the mesh to start from; null: from the input's vertices alone.
    Generator(const Plc& plc, const TetMesh* given, const MeshOptions& options, const RunControl& control)
        : plc_(plc), given_(given), options_(with_names_resolved(options, plc)), control_(control), guard_(options.limits, control),
          // Bulk insertion asks for its memory in large pieces, which a limit would not see coming.
          workers_(options.limits.memory_bytes ? 1 : options.threads) {
        result_.statistics.stages.reserve(64);  // noted while an exception passes, too
    }

    MeshResult run_within_memory() {
        try {
            return run();
        } catch (const std::bad_alloc&) {
            throw MeshError(ErrorCode::budget_exhausted, guard_.stage(), fmt::format("out of memory in stage {}; a memory limit would have ended the run in time", to_string(guard_.stage())));
        }
    }

private:
    /// What lies between two stages counts for the second; a stage that throws has its own time, too.
    template <class F>
    auto timed(Stage stage, F&& work) {
        guard_.enter(stage);
        struct Note {
            Generator& of;
            Stage stage;
            ~Note() {
                const auto end = std::chrono::steady_clock::now();
                const std::chrono::duration<double> spent = end - std::exchange(of.last_end_, end);
                of.result_.statistics.stages.push_back({stage, spent.count(), of.vertices_, of.tets_});
            }
        };
        const Note note{*this, stage};
        return work();
    }

    MeshResult run() {
        check_vertex_sizes(plc_);
        const std::uint64_t exact_before = exact_predicate_calls();
        const ValidPlc valid = fill_valid();
        timed(Stage::certify, [&] { certify_and_report(valid); });
        result_.statistics.exact_predicate_calls = exact_predicate_calls() - exact_before;
        return std::move(result_);
    }

    void certify_and_report(const ValidPlc& valid) {
        result_.certificate = certify(result_.mesh, certificate_bounds(result_, options_, plc_, valid, control_.stop), &plc_);
        // What was joined may have had no room between, such as a body as flat as the rounding: then the result is another domain's.
        if (joined_ && is_refuted(result_.certificate)) throw *refusal_;
        fail_if_refuted(result_.certificate);
        note_lower_angle(result_);
        try {
            judge_invariants(result_, options_);
        } catch (const MeshError& e) {
            if (!valid.acute_features.empty()) throw acute_failure(valid, e, guard_);  // the paper assumes that there are none
            throw;
        }
        report_goals(result_, options_, valid, size_rows_, workers_);
    }

    ValidPlc take_in() {
        ValidPlc valid = timed(Stage::validate, [&] {
            return joined_ ? validate(joined_->plc, options_, guard_.checkpoint(), &joined_->source) : validate(plc_, options_, guard_.checkpoint());
        });
        if (joined_) name_facets(valid, *joined_);
        require_room(options_.limits, valid.vertices.size(), guard_.stage());
        result_.statistics.coplanar_tolerance = valid.coplanar_tolerance;
        result_.statistics.cells = valid.diagnosis.cells;
        result_.statistics.notes.clear();
        note_input(result_, options_, plc_, valid);
        return valid;
    }

    ValidPlc fill_valid() {
        const std::optional<double> coplanar_tolerance = options_.coplanar_tolerance;
        try {
            return fill_stated();
        } catch (const MeshError& refusal) {
            // Slits within a coarse rounding may be found as late as when they can't be conformed to. Doubles may hide that they once were single precision.
            const bool coarse = plc_.relative_rounding > 0 || coplanar_tolerance.has_value();
            const bool late = refusal.stage() == Stage::conform && !guard_.user_limit_spent() &&
                              (refusal.code() == ErrorCode::unsupported_acute || (coarse && refusal.code() == ErrorCode::internal_invariant));
            if (given_ || !(late || refusal.code() == ErrorCode::bad_input) || options_.thin_features != ThinFeatures::join) throw;
            options_.coplanar_tolerance = coplanar_tolerance;
            joined_ = late && !coarse ? join_input(as_if_single_precision(plc_), options_, true) : join_input(plc_, options_);
            if (!joined_) throw;
            refusal_ = refusal;
            return fill_joined(refusal);
        }
    }

    /// What is joined may still be too thin for anything else; then it is the input that is.
    ValidPlc fill_joined(const MeshError& refusal) {
        options_.coplanar_tolerance.reset();
        try {
            ValidPlc valid = take_in();
            result_.statistics.joined = joined_->statistics;
            result_.statistics.notes.push_back(describe(joined_->statistics, plc_));
            fill(valid);
            name_vertices(result_, *joined_, plc_);
            return valid;
        } catch (const MeshError& e) {
            const bool refused = e.code() == ErrorCode::bad_input || e.code() == ErrorCode::unsupported_acute || e.code() == ErrorCode::budget_exhausted;
            if (refused && !guard_.user_limit_spent()) throw refusal;
            throw;
        }
    }

    ValidPlc fill_stated() {
        ValidPlc valid = take_in();
        try {
            fill(valid);
        } catch (const MeshError& e) {
            if (e.code() != ErrorCode::budget_exhausted || valid.acute_features.empty()) throw;
            const MeshError failure = acute_failure(valid, e, guard_);
            if (given_ || guard_.user_limit_spent() || !may_unmerge(options_, plc_)) throw failure;
            valid = fill_unmerged(failure);
        }
        return valid;
    }

    /// Facets that are plane within the source's rounding only can be too thin for that: as the single triangles of the source they are exactly plane.
    ValidPlc fill_unmerged(const MeshError& failure) {
        options_.coplanar_tolerance = rounding_of_doubles(plc_);
        try {
            ValidPlc valid = take_in();
            result_.statistics.notes.emplace_back("facets that are plane only within the rounding of the file were too thin to be meshed as one: their triangles stay apart");
            fill(valid);
            return valid;
        } catch (const MeshError& e) {
            if (e.code() == ErrorCode::budget_exhausted && guard_.user_limit_spent()) throw;
            if (e.code() == ErrorCode::budget_exhausted || e.code() == ErrorCode::bad_input) throw failure;
            throw;
        }
    }

    void fill(const ValidPlc& valid) {
        ConformingMesh mesh = timed(Stage::delaunay, [&] { return start(valid); });
        require_room(options_.limits, mesh.vertex_count(), guard_.stage());
        const bool acute = !valid.acute_features.empty();
        // Where the input is acute features copy each other anyway.
        const double enough = most_for_gaps(options_.limits, static_cast<double>(mesh.vertex_count()));
        AcuteGeometry acute_geometry(valid, workers_, !acute && options_.mode != Mode::certified && gaps_take_more_than(enough, valid, workers_), guard_.checkpoint());
        if (acute_geometry.copies()) guard_.set_ceiling(40 * mesh.vertex_count() + 20'000);
        BoundaryRefiner boundary(mesh, guard_, options_.seed, acute_geometry);
        const std::unique_ptr<RunRecorder> recorder = prepare_theory(mesh, boundary, options_);
        const auto count = [&] {
            vertices_ = mesh.vertex_count();
            tets_ = count_filled(mesh, workers_);
        };
        timed(Stage::conform, [&] {
            const std::size_t before = mesh.vertex_count();
            boundary.recover_all();
            if (given_) settle_regions(mesh);
            boundary.conform();
            count();
            require_room(options_.limits, vertices_, guard_.stage());
            guard_.set_conforming();
            if (given_) result_.statistics.given->added_for_conformity = mesh.vertex_count() - before;
        });
        Refiner refiner(mesh, boundary, guard_, options_, &workers_);
        refuse_hopeless(options_.limits, refiner.sizes().expected_vertices());
        refiner.guard_edges();
        const bool certified = options_.mode == Mode::certified;
        if (certified) set_sliver_rule(refiner, options_);
        else prepare_refinement(refiner, boundary, options_);
        const double vertices = static_cast<double>(mesh.vertex_count()), for_size = std::min(refiner.sizes().expected_vertices(), 4e9);
        if (!certified) refiner.leave_gaps(most_for_gaps(options_.limits, vertices, for_size));
        // Where two edges cross with no more than a left gap between them copies may chase each other.
        const double ordinary = refiner.gaps().any() ? 10 * vertices + 20'000 : 40 * vertices + 300'000;
        if (acute_geometry.copies()) guard_.set_ceiling(static_cast<std::uint64_t>(ordinary + 4 * for_size + 4 * refiner.gaps().expected_vertices()));
        RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
        timed(Stage::refine, [&] {
            // The published ways have no seeds: they begin with what Delaunay refinement makes.
            if (!given_ && options_.slivers == SliverStrategy::best && options_.seeding == Seeding::automatic && !certified)
                LatticeSeeder(mesh, boundary, guard_, refiner.sizes(), workers_).seed();
            return_freed_memory();  // of bulk insertion, beside which there would be the queues of refinement
            const std::size_t before = mesh.vertex_count();
            verdict = refiner.refine();
            if (given_) result_.statistics.given->added_for_refinement = mesh.vertex_count() - before;
            if (certified || !only_refines(options_.slivers)) finish_theory(recorder.get(), boundary, result_);
            count();
        });
        const bool exudes = options_.slivers == SliverStrategy::exude;  // the finished mesh gets weights
        if (verdict == RunGuard::Verdict::go_on && !certified && !exudes && asks_for_shape(options_))
            timed(Stage::shape, [&] {
                return_freed_memory();
                mesh.pack_records(workers_);
                const SliverOutcome outcome = remove_slivers(mesh, boundary, refiner, guard_, workers_, options_);
                verdict = outcome.verdict;
                result_.statistics.moved_vertices = outcome.moved_vertices;
                if (!outcome.note.empty()) result_.statistics.notes.push_back(outcome.note);
                count();
            });
        if (!certified && only_refines(options_.slivers)) finish_theory(recorder.get(), boundary, result_);
        timed(Stage::extract, [&] {
            mesh.triangulation().release_scratch();
            return_freed_memory();
            result_.mesh = extract_mesh(std::move(mesh), workers_, [&](std::span<const TetId> order) {
                result_.exemptions = list_exemptions(mesh, order, refiner, options_, plc_.first_number, workers_);
                result_.statistics.gaps = gaps_left(result_.exemptions, mesh, refiner, plc_.first_number);
            });
            result_.mesh.names = plc_.names;
            if (result_.statistics.gaps) result_.statistics.notes.push_back(describe(*result_.statistics.gaps));
            size_rows_ = report_sizes(result_, options_, valid, refiner.sizes(), workers_);
        });
        if (verdict == RunGuard::Verdict::go_on && exudes && asks_for_shape(options_))
            timed(Stage::shape, [&] {
                const ExemptionKeeper exempt(result_.mesh, std::move(result_.exemptions));
                const ExudationReport report = exude(result_.mesh, options_.quality.min_dihedral_angle_deg, exudation_bounds(options_, valid, refiner.sizes()), guard_);
                verdict = report.verdict;
                result_.exemptions = exempt.of(result_.mesh);
                result_.statistics.weighted_vertices = report.weighted_vertices;
                tets_ = result_.mesh.tets.size();
            });
        result_.statistics.guarded_insertions = refiner.refused();
        result_.termination = termination(verdict);
    }

    ConformingMesh start(const ValidPlc& valid) {
        if (!given_) return ConformingMesh(valid, {}, guard_.checkpoint());
        return adopt_mesh(*given_, valid, adoption_tolerance(*given_, plc_), result_.statistics.given.emplace(), guard_.checkpoint());
    }

    const Plc& plc_;
    const TetMesh* given_;
    MeshOptions options_;
    std::optional<JoinedPlc> joined_;  ///< what is meshed in place of plc_, if that is too thin
    std::optional<MeshError> refusal_;  ///< why it had to be joined
    const RunControl& control_;
    RunGuard guard_;
    Workers workers_;
    MeshResult result_;
    std::vector<AskedAchieved> size_rows_;
    std::uint64_t vertices_ = 0, tets_ = 0;
    std::chrono::steady_clock::time_point last_end_ = std::chrono::steady_clock::now();  ///< of a stage
};

}  // namespace

MeshResult generate(const Plc& plc, const MeshOptions& options, const RunControl& control) {
    require_valid_options(options, false);
    return Generator(plc, nullptr, options, control).run_within_memory();
}

MeshResult improve(const TetMesh& mesh, const Plc& plc, const MeshOptions& options, const RunControl& control) {
    require_valid_options(options, true);
    return Generator(plc, &mesh, options, control).run_within_memory();
}

}  // namespace wellmesh
