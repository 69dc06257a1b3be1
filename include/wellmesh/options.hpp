// SPDX-License-Identifier: Apache-2.0
// What a caller may ask for. Every default is written here and nowhere else.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wellmesh/background_mesh.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// practical: outside the paper's theorem, which its defaults exceed by far. certified: constants for which every inequality of the paper
/// holds, its own definition of a sliver, and every claim checked on the run's insertions; nothing but what the paper describes (docs/theory.md).
enum class Mode { practical, certified };

/// Constants of the paper. Empty: the mode's own, below. Who uses which: docs/strategies.md.
struct PaperConstants {
    std::optional<double> delta{};   ///< radius of a picking region over the circumradius
    std::optional<double> b{};       ///< certified, refine, improve: new slivers below b circumradii of what was split count as small
    std::optional<double> sigma0{};  ///< certified, refine, improve: slivers have volume / shortest edge^3 below this, whatever their angles
    /// refine, improve: the same for tetrahedra that touch the boundary. Empty: sigma0.
    std::optional<double> sigma0_boundary{};
};
inline constexpr double kPracticalDelta = 0.3;  ///< docs/decisions/0010
inline constexpr double kPracticalB = 2;        ///< of refine; improve asks of every new tetrahedron to be better, however large
inline constexpr double kCertifiedDelta = 0.05, kCertifiedB = 4.5, kCertifiedRadiusEdgeRatio = 20, kCertifiedSigma = 0.005;

/// How slivers are kept away or removed: the systems that the paper compares with, each as its own source describes it, and this program's own
/// way (docs/strategies.md). All of them keep the mesh Delaunay, conforming and Gabriel (exude: with respect to its weights), and all end,
/// whether the goal is reached or not.
enum class SliverStrategy : std::uint8_t {
    none,     ///< Delaunay refinement [Shewchuk98]; slivers stay
    refine,   ///< slivers are split by points that make no new small ones [LiTeng01, section 3]
    improve,  ///< the same, but only where the local mesh gets better [LiTeng01, section 6]
    chew,     ///< uniform density, random points within half a unit of the circumcentres [Chew97]
    exude,    ///< weights on the vertices: the mesh is weighted Delaunay [Cheng00]
    perturb,  ///< vertices are smoothed and perturbed, none comes or goes [EdelsbrunnerEtAl00, Tournois09]
    best      ///< all of it that helps; in certified mode what the paper describes
};
inline constexpr std::array kSliverStrategies{SliverStrategy::none, SliverStrategy::refine,  SliverStrategy::improve, SliverStrategy::chew,
                                              SliverStrategy::exude, SliverStrategy::perturb, SliverStrategy::best};
[[nodiscard]] const char* to_string(SliverStrategy strategy) noexcept;
/// The strategy of this name; empty if there is none.
[[nodiscard]] std::optional<SliverStrategy> parse_sliver_strategy(std::string_view name) noexcept;

struct QualityGoals {
    /// Bound on circumradius / shortest edge of every tetrahedron. Below 2 there is no proof of termination.
    double max_radius_edge_ratio = 2.0;
    /// Every dihedral angle at least this many degrees; 0 ignores slivers.
    double min_dihedral_angle_deg = 20.0;
    /// refine, improve: the same for tetrahedra that touch the boundary (a segment, a facet or an input vertex). Empty: no other than inside.
    std::optional<double> min_dihedral_boundary_deg{};
};

/// A target edge length on a part of the input: a region, facets, segments or vertices.
struct EntitySize {
    EntityKind kind = EntityKind::region;  ///< region, facet, segment or vertex
    std::int32_t id = 0;                   ///< the region's id; the marker of facets, segments and vertices
    double edge_length = 0;                ///< input units, above 0
    std::string name{};                    ///< one of Plc::names in place of the id; empty: the id counts
};

/// How large tetrahedra are to be. The smallest of all that is asked for at a place counts, and sizes grow with the distance from there by at most
/// `gradation` (docs/sizing.md). Lengths in input units.
struct SizeGoals {
    /// Target edge length h everywhere: the mean edge length of a uniform mesh of a cube is within 10 % of h.
    /// Realised as the circumradius bound R <= kCircumradiusPerEdgeLength * h (src/sizing/size_field.hpp). Empty: none.
    std::optional<double> edge_length{};
    /// Bound on the volume of every tetrahedron, in cubed input units. Empty: none.
    std::optional<double> max_volume{};
    /// Target edge lengths on parts of the input.
    std::vector<EntitySize> entities{};
    /// Whether Plc::vertex_sizes count. They are linear in the Delaunay tetrahedra of the input's vertices.
    bool vertex_sizes = true;
    /// Target edge length at a point of the domain, above 0; infinite: nothing is asked there. Called on the caller's thread, a few times for each
    /// vertex that the mesh will have; details smaller than kCallbackResolution of the domain may be missed. An exception thrown from it ends the run
    /// and propagates. Empty: none.
    std::function<double(const Vec3&)> at{};
    /// Target edge lengths on a mesh. Null: none.
    std::shared_ptr<const BackgroundMesh> background{};
    /// Target edge length over local feature size: the radius of the smallest ball about a point that meets two vertices, segments or facets without a
    /// common point. Empty: none.
    std::optional<double> per_local_feature_size{};
    /// So many edges for a full circle of the curvature of smooth surfaces and curves, which the input has as facets and segments. Empty: none.
    std::optional<double> elements_per_circle{};
    /// Target edge lengths grow by at most this per unit of distance; 0: without a limit. No edge length that is asked for nowhere is limited: input
    /// details make small tetrahedra around them that grow as they like.
    double gradation = 0.3;
    /// No goal above asks for edges shorter than this, or for volumes below a tetrahedron's of that size. Details of the input may. Empty: none.
    std::optional<double> min_edge_length{};
};
/// Of the larger sides of the domain's box: spacing of the first samples of SizeGoals::at.
inline constexpr double kCallbackResolution = 1.0 / 32;

struct Limits {
    std::optional<std::uint64_t> max_vertices{};  ///< of the whole mesh, input vertices included
    /// From validation to the end of refinement and shape work; the certificate comes on top.
    std::optional<std::chrono::milliseconds> time{};
    /// Physical memory of the whole process, the caller's own included. Refinement stops in time for the certificate to fit, too.
    std::optional<std::uint64_t> memory_bytes{};
};

/// Vertices from a body-centred cubic lattice inside, where a size is asked for: about a third fewer for the same size.
enum class Seeding : std::uint8_t { automatic, off };

/// What becomes of a vertex that is nearer to a facet than the rounding of the input's coordinates, so that no mesh of doubles could keep them apart:
/// the gap is closed within that rounding, and the result says so; or the input is refused.
enum class ThinFeatures : std::uint8_t { join, refuse };

inline constexpr unsigned kMostThreads = 1024;  ///< beyond any machine's cores: more could only be a slip

struct MeshOptions {
    Mode mode = Mode::practical;
    PaperConstants paper{};
    QualityGoals quality{};
    SizeGoals size{};
    Limits limits{};
    SliverStrategy slivers = SliverStrategy::best;
    Seeding seeding = Seeding::automatic;
    /// Overrides the local planarity tolerance by which facets are merged and accepted, in input units.
    std::optional<double> coplanar_tolerance{};
    ThinFeatures thin_features = ThinFeatures::join;
    /// Input, options and seed fix the output bytes (time limits and cancellation apart).
    std::uint64_t seed = 0;
    /// Threads at work, the caller's among them; 0: as many as the machine has cores. Never changes the output. Callbacks come on the caller's thread.
    unsigned threads = 0;
    /// Keep account of the refinement's insertions and report the paper's claims on them. Always so in certified mode, where a violated
    /// claim is an internal error; in practical mode violations are counted.
    bool invariants = false;
};

/// Certified mode with its defaults: radius-edge ratio kCertifiedRadiusEdgeRatio, no goal for the dihedral angle.
[[nodiscard]] inline MeshOptions certified_options() {
    MeshOptions options;
    options.mode = Mode::certified;
    options.quality.max_radius_edge_ratio = kCertifiedRadiusEdgeRatio;
    options.quality.min_dihedral_angle_deg = 0;
    return options;
}

/// All that is wrong with `options`, one sentence a field with its valid range; empty when nothing is.
[[nodiscard]] std::vector<std::string> check(const MeshOptions& options);

}  // namespace wellmesh
