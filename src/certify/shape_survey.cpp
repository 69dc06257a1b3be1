// SPDX-License-Identifier: Apache-2.0
#include "certify/shape_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/infinity.hpp"
#include "quality/shape_lanes.hpp"
#include "quality/shape_statistics.hpp"

namespace wellmesh::certifying {
namespace {

constexpr double kSlack = 1e-9;  // far more than the roundings of squares
constexpr std::size_t kBins = std::tuple_size_v<decltype(ShapeStatistics::min_dihedral_histogram)>;

/// Bins of the histogram by the squared cosine of the smallest dihedral angle. Lattices are full of angles of 60 degrees up to rounding: they count
/// as such.
class BinTable {
public:
    BinTable() {
        for (std::size_t k = 1; k < kBins; ++k) {
            const double c = std::cos(static_cast<double>(5 * k) * (std::numbers::pi / 180));
            ends_[k - 1] = c * c * (1 + 1e-12);
        }
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            const std::size_t least = bin(static_cast<double>(i + 1) / kCells), most = bin(static_cast<double>(i) / kCells);
            cells_[i] = least == most ? static_cast<std::uint8_t>(least) : kMixed;
        }
    }
    [[nodiscard]] std::size_t of(double cosine) const {
        if (!(cosine >= 0 && cosine < 1)) return bin(cosine);
        const std::uint8_t cell = cells_[static_cast<std::size_t>(cosine * kCells)];
        return cell == kMixed ? bin(cosine) : cell;
    }

private:
    static constexpr std::size_t kCells = 1024;
    static constexpr std::uint8_t kMixed = 255;
    [[nodiscard]] std::size_t bin(double cosine) const {  // the ends descend; NaN goes to bin 0
        return static_cast<std::size_t>(std::count_if(ends_.begin(), ends_.end(), [&](double end) { return cosine <= end; }));
    }
    std::array<double, kBins - 1> ends_{};
    std::array<std::uint8_t, kCells> cells_{};
};

/// What has been seen of one class of tetrahedra in one range, and from which squares on a tetrahedron is worth a closer look: because it may be the
/// most extreme one so far, or exceed a bound.
class Extremes {
public:
    void set_bounds(const std::vector<ShapeBound>& bounds, bool boundary) {
        for (const ShapeBound& b : bounds) {
            if (!b.applies(boundary)) continue;
            const double limit = *b.limit, squared = limit * std::abs(limit);
            if (std::isnan(limit)) always_ = true;
            else if (b.value == &TetShape::radius_edge) radius_edge_bound_ = std::min(radius_edge_bound_, squared * (1 - kSlack));
            else if (b.value == &TetShape::aspect) aspect_bound_ = std::min(aspect_bound_, limit * (1 - kSlack));
            else if (b.value == &TetShape::sigma) sigma_bound_ = std::max(sigma_bound_, squared * (1 + kSlack));
            else if (b.value == &TetShape::volume) volume_bound_ = std::min(volume_bound_, 6 * limit * (1 - kSlack));
            else if (b.value == &TetShape::min_dihedral_deg) {
                const double c = limit >= 180 ? -1 : std::cos(std::max(limit, 0.0) * (std::numbers::pi / 180));
                cosine_bound_ = std::min(cosine_bound_, c * std::abs(c) - kSlack);
            } else {
                always_ = true;
            }
        }
    }

    /// @return whether the lane is worth a closer look.
    bool count(const SquaredShapes& s, std::size_t i, const BinTable& bins) {
        const double six = s.six_volumes[i];
        if (statistics_.tets++ == 0) {
            least_six_ = greatest_six_ = six;
        } else {
            least_six_ = std::min(least_six_, six);
            greatest_six_ = std::max(greatest_six_, six);
        }
        // Cosines near 1 and -1 hardly tell angles apart.
        constexpr double kToldApart = (1 - 1e-3) * (1 - 1e-3);
        const bool trusted = may_trust(s, i);
        if (trusted) ++statistics_.min_dihedral_histogram[bins.of(s.largest_cosine[i])];
        const bool plain = trusted && !always_ && s.largest_cosine[i] <= std::min(largest_cosine_, kToldApart) &&
                           s.largest_cosine[i] <= cosine_bound_ && s.smallest_cosine[i] >= std::max(smallest_cosine_, -kToldApart) && s.radius_edge[i] <= radius_edge_ &&
                           s.radius_edge[i] <= radius_edge_bound_ && s.sigma[i] >= sigma_ && s.sigma[i] >= sigma_bound_ && six <= volume_bound_ && !aspect_matters(s, i);
        return !plain;
    }

    void add(const TetShape& shape, const SquaredShapes& s, std::size_t i) {
        seen_.add(shape);
        if (!may_trust(s, i)) return untrusted_.add(shape);
        largest_cosine_ = std::max(largest_cosine_, s.largest_cosine[i]);
        smallest_cosine_ = std::min(smallest_cosine_, s.smallest_cosine[i]);
        radius_edge_ = std::max(radius_edge_, s.radius_edge[i]);
        sigma_ = std::min(sigma_, s.sigma[i]);
        aspect_ = std::max(aspect_, aspect(s, i));
    }

    [[nodiscard]] ShapeStatistics result() const {
        ShapeStatistics s = seen_.result();
        s.min_dihedral_histogram = untrusted_.result().min_dihedral_histogram;
        s.tets = statistics_.tets;
        s.min_volume = least_six_ / 6;
        s.max_volume = greatest_six_ / 6;
        for (std::size_t k = 0; k < kBins; ++k) s.min_dihedral_histogram[k] += statistics_.min_dihedral_histogram[k];
        return s;
    }

private:
    static double aspect(const SquaredShapes& s, std::size_t i) {
        const double twice_surface = std::sqrt(s.areas[0][i]) + std::sqrt(s.areas[1][i]) + std::sqrt(s.areas[2][i]) + std::sqrt(s.areas[3][i]);
        return std::sqrt(s.scaled_radius[i]) * twice_surface / (2 * s.six_volumes[i] * s.six_volumes[i]);
    }
    [[nodiscard]] bool aspect_matters(const SquaredShapes& s, std::size_t i) const {
        const double limit = std::min(aspect_, aspect_bound_), volume = s.six_volumes[i] * s.six_volumes[i];
        if (!(limit > 0)) return true;
        // Four numbers have at most twice the root of the sum of their squares as their sum: mostly no root is needed.
        const double squared_surface = 4 * (s.areas[0][i] + s.areas[1][i] + s.areas[2][i] + s.areas[3][i]);
        // (An overflow on the left asks for roots; one on the right, where the left is finite, says what it should.)
        if (s.scaled_radius[i] * squared_surface <= (4 * limit * limit * (1 - kSlack)) * volume * volume) return false;
        return !(aspect(s, i) <= limit);
    }

    ShapeStatistics statistics_;
    ShapeAccumulator seen_, untrusted_;
    double least_six_ = 0, greatest_six_ = 0;
    double largest_cosine_ = -kInfinity, smallest_cosine_ = kInfinity, radius_edge_ = -kInfinity, sigma_ = kInfinity, aspect_ = 0;
    double cosine_bound_ = kInfinity, radius_edge_bound_ = kInfinity, sigma_bound_ = -kInfinity, aspect_bound_ = kInfinity, volume_bound_ = kInfinity;
    bool always_ = false;
};

/// Both sets together. Of sets without a tetrahedron the extremes don't count.
ShapeStatistics both(const ShapeStatistics& a, const ShapeStatistics& b) {
    if (a.tets == 0 || b.tets == 0) return a.tets == 0 ? b : a;
    ShapeStatistics s;
    s.tets = a.tets + b.tets;
    s.max_radius_edge_ratio = std::max(a.max_radius_edge_ratio, b.max_radius_edge_ratio);
    s.max_aspect_ratio = std::max(a.max_aspect_ratio, b.max_aspect_ratio);
    s.min_sigma = std::min(a.min_sigma, b.min_sigma);
    s.min_dihedral_angle_deg = std::min(a.min_dihedral_angle_deg, b.min_dihedral_angle_deg);
    s.max_dihedral_angle_deg = std::max(a.max_dihedral_angle_deg, b.max_dihedral_angle_deg);
    s.min_volume = std::min(a.min_volume, b.min_volume);
    s.max_volume = std::max(a.max_volume, b.max_volume);
    for (std::size_t k = 0; k < kBins; ++k) s.min_dihedral_histogram[k] = a.min_dihedral_histogram[k] + b.min_dihedral_histogram[k];
    return s;
}

/// Of the tetrahedra of one region.
struct RegionSum {
    std::uint64_t tets = 0;
    long double six_volumes = 0;
};

/// What is found in one range.
struct Part {
    std::map<std::int32_t, RegionSum> regions;
    std::array<std::array<ShapeStatistics, 2>, 2> statistics;  // [at the boundary][exempt]
    std::vector<ClaimBuilder> exceedances;
};

class RangeSurvey {
public:
    RangeSurvey(const SuspectMesh& mesh, const std::vector<std::uint8_t>& on_constraint, const std::vector<ShapeBound>& bounds, const std::vector<std::uint64_t>& exempt,
                const BinTable& bins, std::vector<TetClass>& classes)
        : mesh_(mesh), on_constraint_(on_constraint), bounds_(bounds), exempt_(exempt), bins_(bins), classes_(classes) {}

    void operator()(std::size_t begin, std::size_t end, Part& part) const {
        part.exceedances.resize(bounds_.size());
        std::array<std::array<Extremes, 2>, 2> extremes;
        for (const bool boundary : {false, true}) extremes[boundary][0].set_bounds(bounds_, boundary);
        auto exempt = std::lower_bound(exempt_.begin(), exempt_.end(), begin);
        auto region = part.regions.end();
        CornerLanes corners{};
        SquaredShapes shapes{};
        for (std::size_t first = begin; first < end; first += kShapeLanes) {
            const std::size_t lanes = std::min(kShapeLanes, end - first);
            for (std::size_t i = 0; i < lanes; ++i)
                for (std::size_t k = 0; k < 4; ++k) {
                    const Vec3& p = mesh_.point(mesh_.mesh().tets[first + i][k]);
                    corners.at[k][0][i] = p.x, corners.at[k][1][i] = p.y, corners.at[k][2][i] = p.z;
                }
            square_shapes(corners, shapes);
            for (std::size_t i = 0; i < lanes; ++i) {
                const std::size_t t = first + i;
                while (exempt != exempt_.end() && *exempt < t) ++exempt;
                const bool is_exempt = exempt != exempt_.end() && *exempt == t;
                if (region == part.regions.end() || region->first != mesh_.region(t)) region = part.regions.try_emplace(mesh_.region(t)).first;
                ++region->second.tets;
                region->second.six_volumes += static_cast<long double>(shapes.six_volumes[i]);
                if (!mesh_.positive(t)) continue;
                const auto& v = mesh_.mesh().tets[t];
                const bool boundary = (on_constraint_[v[0]] | on_constraint_[v[1]] | on_constraint_[v[2]] | on_constraint_[v[3]]) != 0;
                classes_[t] = boundary ? TetClass::boundary : TetClass::interior;
                Extremes& seen = extremes[boundary][is_exempt];
                if (!seen.count(shapes, i, bins_)) continue;
                const TetShape shape = shape_of(mesh_.point(v[0]), mesh_.point(v[1]), mesh_.point(v[2]), mesh_.point(v[3]));
                seen.add(shape, shapes, i);
                if (!is_exempt) hold_against_bounds(t, shape, boundary, part);
            }
        }
        for (const std::size_t boundary : {0U, 1U})
            for (const std::size_t is_exempt : {0U, 1U}) part.statistics[boundary][is_exempt] = extremes[boundary][is_exempt].result();
    }

private:
    void hold_against_bounds(std::size_t t, const TetShape& shape, bool boundary, Part& part) const {
        for (std::size_t k = 0; k < bounds_.size(); ++k) {
            const ShapeBound& b = bounds_[k];
            if (!b.applies(boundary) || b.kept(shape)) continue;
            part.exceedances[k].violated(EntityKind::tetrahedron, t + 1, mesh_.tet_centroid(t), [&] { return fmt::format("{} {:.6g}, bound {:g}", b.words, shape.*(b.value), *b.limit); });
        }
    }

    const SuspectMesh& mesh_;
    const std::vector<std::uint8_t>& on_constraint_;
    const std::vector<ShapeBound>& bounds_;
    const std::vector<std::uint64_t>& exempt_;
    const BinTable& bins_;
    std::vector<TetClass>& classes_;
};

}  // namespace

ShapeSurvey survey_shapes(const SuspectMesh& mesh, const std::vector<std::uint8_t>& on_constraint, const std::vector<ShapeBound>& bounds,
                          const std::vector<std::uint64_t>& exempt) {
    ShapeSurvey survey;
    survey.classes.assign(mesh.tet_count(), TetClass::left_out);
    survey.exceedances.resize(bounds.size());
    const BinTable bins;
    const RangeSurvey look(mesh, on_constraint, bounds, exempt, bins, survey.classes);
    std::vector<Part> parts((mesh.tet_count() + kGrain - 1) / kGrain);
    mesh.workers().for_ranges(mesh.tet_count(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) { look(begin, end, parts[piece]); });
    std::map<std::int32_t, RegionSum> regions;
    for (Part& part : parts) {
        for (const auto& [region, sum] : part.regions) {
            RegionSum& whole = regions[region];
            whole.tets += sum.tets;
            whole.six_volumes += sum.six_volumes;
        }
        const auto& [inside, outside] = part.statistics;
        survey.unexempt_interior = both(survey.unexempt_interior, inside[0]);
        survey.unexempt_boundary = both(survey.unexempt_boundary, outside[0]);
        survey.interior = both(survey.interior, both(inside[0], inside[1]));
        survey.boundary = both(survey.boundary, both(outside[0], outside[1]));
        for (std::size_t k = 0; k < bounds.size(); ++k) survey.exceedances[k].absorb(std::move(part.exceedances[k]));
    }
    survey.unexempt = both(survey.unexempt_interior, survey.unexempt_boundary);
    survey.all = both(survey.interior, survey.boundary);
    for (const auto& [region, sum] : regions) survey.regions.push_back({region, sum.tets, static_cast<double>(sum.six_volumes / 6), std::nullopt});
    return survey;
}

}  // namespace wellmesh::certifying
