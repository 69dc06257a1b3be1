// SPDX-License-Identifier: Apache-2.0
// The pipeline: one call a stage, nothing else (src/README.md).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <new>

#include <fmt/format.h>

#include "adoption/adopt.hpp"
#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "exudation/exude.hpp"
#include "pipeline/extract_mesh.hpp"
#include "pipeline/list_exemptions.hpp"
#include "pipeline/report_goals.hpp"
#include "pipeline/report_sizes.hpp"
#include "pipeline/theory_run.hpp"
#include "predicates/predicates.hpp"
#include "refinement/lattice_seeding.hpp"
#include "refinement/refine.hpp"
#include "sizing/entity_sizes.hpp"
#include "strategies/sliver_strategies.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/generate.hpp"
#include "wellmesh/improve.hpp"

namespace wellmesh {
namespace {

/// Of memory at the peak, which is in the certificate: 255 MB measured for 395 540 vertices of a cube.
constexpr double kBytesPerVertex = 650;

MeshOptions with_names_resolved(const MeshOptions& options, const Plc& plc) {
    MeshOptions out = options;
    out.size.entities = with_ids(options.size.entities, plc.names);
    return out;
}

void check_vertex_sizes(const Plc& plc) {
    const std::vector<double>& sizes = plc.vertex_sizes;
    if (sizes.empty()) return;
    const auto fail = [](const std::string& what) { throw MeshError(ErrorCode::bad_input, Stage::validate, what); };
    if (sizes.size() != plc.vertices.size()) fail(fmt::format("there are {} sizes of vertices, but {} vertices", sizes.size(), plc.vertices.size()));
    for (std::size_t v = 0; v < sizes.size(); ++v)
        if (!(sizes[v] >= 0) || !std::isfinite(sizes[v]))
            fail(fmt::format("the size of vertex {} is {}; it must be a finite number above 0, or 0 for none", v + plc.first_number, sizes[v]));
}

class Generator {
public:
    /// @param given  the mesh to start from; null: from the input's vertices alone.
    Generator(const Plc& plc, const TetMesh* given, const MeshOptions& options, const RunControl& control)
        : plc_(plc), given_(given), options_(with_names_resolved(options, plc)), control_(control), guard_(options.limits, control) {}

private:
    template <class F>
    auto timed(Stage stage, F&& work) {
        guard_.enter(stage);
        const auto start = std::chrono::steady_clock::now();
        auto note = [&] {
            const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
            result_.statistics.stages.push_back({stage, spent.count(), vertices_, tets_});
        };
        if constexpr (std::is_void_v<decltype(work())>) {
            work();
            note();
        } else {
            auto value = work();
            note();
            return value;
        }
    }

public:
    MeshResult run_within_memory() {
        try {
            return run();
        } catch (const std::bad_alloc&) {
            throw MeshError(ErrorCode::budget_exhausted, guard_.stage(), fmt::format("out of memory in stage {}; a memory limit would have ended the run in time", to_string(guard_.stage())));
        }
    }

private:
    MeshResult run() {
        check_vertex_sizes(plc_);
        const std::uint64_t exact_before = exact_predicate_calls();
        const ValidPlc valid = timed(Stage::validate, [&] { return validate(plc_, options_, guard_.checkpoint()); });
        require_room(valid.vertices.size());
        result_.statistics.coplanar_tolerance = valid.coplanar_tolerance;
        result_.statistics.cells = valid.diagnosis.cells;
        note_defects(valid);
        if (options_.size.vertex_sizes && std::any_of(plc_.vertex_sizes.begin(), plc_.vertex_sizes.end(), [](double h) { return h > 0; }))
            result_.statistics.notes.emplace_back("the input states sizes at its vertices, which count");
        try {
            fill(valid);
        } catch (const MeshError& e) {
            if (e.code() == ErrorCode::budget_exhausted && !valid.acute_features.empty()) throw acute_failure(valid, e);
            throw;
        }
        CertifyOptions bounds;
        bounds.max_radius_edge_ratio = options_.quality.max_radius_edge_ratio;
        if (options_.quality.min_dihedral_angle_deg > 0) bounds.min_dihedral_angle_deg = options_.quality.min_dihedral_angle_deg;
        bounds.min_dihedral_boundary_deg = options_.quality.min_dihedral_boundary_deg;
        bounds.max_volume = options_.size.max_volume;
        bounds.stop = control_.stop;
        for (const Exemption& e : result_.exemptions) bounds.exempt.push_back(e.tet);
        if (const double sigma0 = paper_constants(options_).sigma0; sigma0 > 0) bounds.min_sigma = sigma0;
        bounds.min_sigma_boundary = options_.paper.sigma0_boundary;
        const double extent = input_extent(plc_);
        // Beyond the defaults only by what the input's own rounding did: the facets' tolerance, and the bend that it makes in the mesh.
        bounds.tolerance = std::max(bounds.tolerance, 4 * valid.coplanar_tolerance / extent);
        if (4 * valid.coplanar_tolerance > 1e-12 * extent) bounds.flat_angle_rad = std::max(bounds.flat_angle_rad, 1.01 * largest_bend_rad(result_.mesh));
        result_.statistics.certificate_tolerance = bounds.tolerance;
        result_.statistics.certificate_flat_angle_rad = bounds.flat_angle_rad;
        result_.certificate = timed(Stage::certify, [&] { return certify(result_.mesh, bounds, &plc_); });
        fail_if_refuted();
        if (given_ && result_.certificate.all.min_dihedral_angle_deg < result_.statistics.given->min_dihedral_angle_deg * (1 - 1e-9))
            result_.statistics.notes.push_back(
                fmt::format("the smallest dihedral angle has gone from {:.4g} to {:.4g} degrees: the mesh had to be triangulated or refined anew, and the goal is lower",
                            result_.statistics.given->min_dihedral_angle_deg, result_.certificate.all.min_dihedral_angle_deg));
        try {
            judge_invariants(result_, options_);
        } catch (const MeshError& e) {
            if (!valid.acute_features.empty()) throw acute_failure(valid, e);  // the paper assumes that there are none
            throw;
        }
        report_goals(result_, options_, valid, size_rows_);
        result_.statistics.exact_predicate_calls = exact_predicate_calls() - exact_before;
        return std::move(result_);
    }

private:
    void fill(const ValidPlc& valid) {
        ConformingMesh mesh = timed(Stage::delaunay, [&] { return start(valid); });
        require_room(mesh.vertex_count());
        const bool acute = !valid.acute_features.empty();
        if (acute) guard_.set_ceiling(100 * mesh.vertex_count() + 1'000'000);
        AcuteGeometry acute_geometry(valid);
        BoundaryRefiner boundary(mesh, guard_, options_.seed, acute_geometry);
        const std::unique_ptr<RunRecorder> recorder = prepare_theory(mesh, boundary, options_);
        const auto count = [&] {
            vertices_ = mesh.vertex_count();
            tets_ = 0;
            for (std::size_t i = 0; i < mesh.tets().slots(); ++i) tets_ += mesh.tets().is_finite(TetId{i}) && mesh.in_domain(TetId{i});
        };
        timed(Stage::conform, [&] {
            const std::size_t before = mesh.vertex_count();
            boundary.recover_all();
            if (given_) settle_regions(mesh);
            boundary.conform();
            count();
            require_room(vertices_);
            guard_.set_conforming();
            if (given_) result_.statistics.given->added_for_conformity = mesh.vertex_count() - before;
        });
        Refiner refiner(mesh, boundary, guard_, options_);
        refuse_hopeless(refiner.sizes().expected_vertices());
        refiner.guard_edges();
        const bool certified = options_.mode == Mode::certified;
        if (certified) set_sliver_rule(refiner, options_);
        else prepare_refinement(refiner, boundary, options_);
        if (acute) guard_.set_ceiling(40 * mesh.vertex_count() + 300'000 + 4 * static_cast<std::uint64_t>(std::min(refiner.sizes().expected_vertices(), 4e9)));
        RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
        timed(Stage::refine, [&] {
            // The published ways have no seeds: they begin with what Delaunay refinement makes.
            if (!given_ && options_.slivers == SliverStrategy::best && options_.seeding == Seeding::automatic && !certified)
                LatticeSeeder(mesh, boundary, guard_, refiner.sizes()).seed();
            const std::size_t before = mesh.vertex_count();
            verdict = refiner.refine();
            if (given_) result_.statistics.given->added_for_refinement = mesh.vertex_count() - before;
            if (certified || !only_refines(options_.slivers)) finish_theory(recorder.get(), boundary, result_);
            count();
        });
        const bool exudes = options_.slivers == SliverStrategy::exude;  // the finished mesh gets weights
        if (verdict == RunGuard::Verdict::go_on && !certified && !exudes && asks_for_shape(options_))
            timed(Stage::shape, [&] {
                const SliverOutcome outcome = remove_slivers(mesh, boundary, refiner, guard_, options_);
                verdict = outcome.verdict;
                result_.statistics.moved_vertices = outcome.moved_vertices;
                if (!outcome.note.empty()) result_.statistics.notes.push_back(outcome.note);
                count();
            });
        if (!certified && only_refines(options_.slivers)) finish_theory(recorder.get(), boundary, result_);
        std::vector<TetId> order;
        result_.mesh = extract_mesh(mesh, order);
        result_.mesh.names = plc_.names;
        result_.exemptions = list_exemptions(mesh, order, refiner, options_, plc_.first_number);
        size_rows_ = report_sizes(result_, options_, valid, refiner.sizes());
        if (verdict == RunGuard::Verdict::go_on && exudes && asks_for_shape(options_))
            timed(Stage::shape, [&] {
                const ExudationReport report = exude(result_.mesh, options_.quality.min_dihedral_angle_deg, exudation_bounds(valid, refiner.sizes()), guard_);
                verdict = report.verdict;
                result_.statistics.weighted_vertices = report.weighted_vertices;
                tets_ = result_.mesh.tets.size();
            });
        result_.statistics.guarded_insertions = refiner.refused();
        result_.termination = termination(verdict);
    }

    /// Goals that the mesh has met stay met; sizes within the tolerance that moving vertices has, too.
    [[nodiscard]] ExudationBounds exudation_bounds(const ValidPlc& valid, const SizeField& sizes) const {
        ExudationBounds bounds;
        bounds.max_radius_edge_ratio = options_.quality.max_radius_edge_ratio;
        const double slack = kSizeTolerance * kSizeTolerance;
        for (std::size_t c = 0; c < valid.cells.size(); ++c) {
            ExudationBounds::Size& size = bounds.size_of_region[valid.cells[c].region];
            size.max_squared_circumradius = std::min(size.max_squared_circumradius, slack * sizes.of_cell(CellId{c}).max_squared_circumradius);
            size.max_volume = std::min(size.max_volume, sizes.of_cell(CellId{c}).max_volume);
        }
        if (sizes.varies()) bounds.max_squared_circumradius_at = [&sizes, slack](const Vec3& p) { return slack * sizes.at(p, CellId{0}).max_squared_circumradius; };
        return bounds;
    }

    ConformingMesh start(const ValidPlc& valid) {
        if (!given_) return ConformingMesh(valid, {}, guard_.checkpoint());
        return adopt_mesh(*given_, valid, adoption_tolerance(*given_, plc_), result_.statistics.given.emplace(), guard_.checkpoint());
    }

    /// An input may conform without any new vertex, and have more than were allowed.
    void require_room(std::size_t vertices) const {
        const auto& most = options_.limits.max_vertices;
        if (most && vertices > *most)
            throw MeshError(ErrorCode::budget_exhausted, guard_.stage(),
                            fmt::format("at most {} vertices were allowed, and {} are there already in stage {}, before the mesh conformed to its input", *most, vertices, to_string(guard_.stage())));
    }

    /// A size that asks for more than a mesh can hold is told at once, not when memory ends. A limit of the user's may end the run before.
    void refuse_hopeless(double expected) const {
        constexpr double kMostVertices = (1U << 30U) / 6.0;  // about six tetrahedra a vertex, 2^30 of them
        if (options_.limits.max_vertices || options_.limits.time) return;
        if (expected > kMostVertices)
            throw MeshError(ErrorCode::mesh_too_large, Stage::refine,
                            fmt::format("the size asks for about {:.2g} vertices; a mesh can have {:.2g}: ask for a coarser one, or set a limit", expected, kMostVertices));
        // What is beyond the limit by less is begun: the estimate is no better.
        constexpr double kSurelyTooMuch = 1.5;
        const auto& memory = options_.limits.memory_bytes;
        if (memory && expected * kBytesPerVertex > kSurelyTooMuch * static_cast<double>(*memory))
            throw MeshError(ErrorCode::mesh_too_large, Stage::refine,
                            fmt::format("the size asks for about {:.2g} vertices, which take about {:.2g} GiB, and {:.2g} are allowed: ask for a coarser one, or set another limit",
                                        expected, expected * kBytesPerVertex / (1 << 30), static_cast<double>(*memory) / (1 << 30)));
    }

    /// Delaunay, conforming and Gabriel hold or the run fails; shape and size are asked and achieved instead.
    void fail_if_refuted() const {
        for (const Claim& claim : result_.certificate.claims) {
            const bool goal = claim.name == "radius_edge" || claim.name == "dihedral" || claim.name == "aspect_ratio" || claim.name == "sigma" || claim.name == "max_volume" ||
                              claim.name == "dihedral_boundary" || claim.name == "sigma_boundary";
            if (goal || claim.state != Claim::State::refuted) continue;
            std::vector<ElementRef> offenders;
            if (claim.witness) offenders.push_back(*claim.witness);
            throw MeshError(ErrorCode::internal_invariant, Stage::certify,
                            fmt::format("the finished mesh fails its own certificate, claim {}: {} of {}: {}; please report this input", claim.name, claim.violations,
                                        claim.checked, claim.detail),
                            offenders);
        }
    }

    /// Every note, but of the acute features only how many there are and which is the sharpest: surfaces have tens of thousands.
    void note_defects(const ValidPlc& valid) {
        std::size_t acute = 0;
        const Defect* sharpest = nullptr;
        for (const Defect& d : valid.diagnosis.defects) {
            if (d.kind != DefectKind::acute_segment_angle && d.kind != DefectKind::acute_dihedral_angle) {
                result_.statistics.notes.push_back(d.message);
                continue;
            }
            ++acute;
            if (!sharpest || d.value < sharpest->value) sharpest = &d;
        }
        if (acute > 1) result_.statistics.notes.push_back(fmt::format("{} input angles are below 90 degrees; the sharpest: {}", acute, sharpest->message));
        else if (acute == 1) result_.statistics.notes.push_back(sharpest->message);
    }

    static Termination termination(RunGuard::Verdict verdict) {
        switch (verdict) {
            case RunGuard::Verdict::cancelled: return Termination::cancelled;
            case RunGuard::Verdict::out_of_time: return Termination::time_budget_reached;
            case RunGuard::Verdict::out_of_vertices: return Termination::vertex_budget_reached;
            case RunGuard::Verdict::out_of_memory: return Termination::memory_budget_reached;
            case RunGuard::Verdict::go_on: break;
        }
        return Termination::goals_met;
    }

    /// Names the sharpest angle, which is the likely reason, also where it was the user's limit that ended the run.
    [[nodiscard]] MeshError acute_failure(const ValidPlc& valid, const MeshError& cause) const {
        const AcuteFeature& worst = valid.acute_features.front();
        const bool segment = worst.kind == EntityKind::segment;
        const Vec3 where = segment ? valid.vertices[valid.segments[worst.id].ends[0].index()] : valid.vertices[worst.id];
        return {guard_.user_limit_spent() ? cause.code() : ErrorCode::unsupported_acute, cause.stage(),
                fmt::format("{}; the input has {} features at less than 90 degrees, the sharpest {:.4g} degrees at {} {} ({}, {}, {})", cause.what(),
                            valid.acute_features.size(), worst.angle_deg, to_string(worst.kind), segment ? worst.id + 1 : valid.source_vertex[worst.id] + 1, where.x,
                            where.y, where.z),
                {{worst.kind, segment ? worst.id + 1U : valid.source_vertex[worst.id] + 1U, where}}};
    }

    static double input_extent(const Plc& plc) {
        Vec3 lo, hi;
        bounding_box(plc.vertices, lo, hi);
        return std::hypot(hi.x - lo.x, hi.y - lo.y, hi.z - lo.z);
    }

    const Plc& plc_;
    const TetMesh* given_;
    const MeshOptions options_;
    const RunControl& control_;
    RunGuard guard_;
    MeshResult result_;
    std::vector<AskedAchieved> size_rows_;
    std::uint64_t vertices_ = 0, tets_ = 0;
};

}  // namespace

MeshResult generate(const Plc& plc, const MeshOptions& options, const RunControl& control) {
    const std::vector<std::string> wrong = check(options);
    if (!wrong.empty()) throw MeshError(ErrorCode::bad_options, Stage::validate, fmt::format("{}", fmt::join(wrong, "; ")));
    return Generator(plc, nullptr, options, control).run_within_memory();
}

MeshResult improve(const TetMesh& mesh, const Plc& plc, const MeshOptions& options, const RunControl& control) {
    std::vector<std::string> wrong = check(options);
    if (options.mode == Mode::certified) wrong.push_back("the mode must be practical: the paper's claims are about meshes that are made from scratch");
    if (options.slivers != SliverStrategy::best) wrong.push_back("slivers must be best where a mesh is given");
    if (options.invariants) wrong.push_back("invariants are claims about insertions and can't be asked for where a mesh is given");
    if (!wrong.empty()) throw MeshError(ErrorCode::bad_options, Stage::validate, fmt::format("{}", fmt::join(wrong, "; ")));
    return Generator(plc, &mesh, options, control).run_within_memory();
}

}  // namespace wellmesh
