// SPDX-License-Identifier: Apache-2.0
#include "json_report.hpp"

#include "output_file.hpp"
#include "wellmesh/version.hpp"

namespace wellmesh::cli {

namespace {

template <class T>
Json or_null(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json to_json(const Vec3& p) { return Json::array({p.x, p.y, p.z}); }

Json to_json(const ElementRef& element) {
    Json json = {{"kind", to_string(element.kind)}, {"number", element.number}};
    json["point"] = element.where ? to_json(*element.where) : Json(nullptr);
    return json;
}

Json to_json(const std::vector<ElementRef>& elements) {
    Json json = Json::array();
    for (const ElementRef& element : elements) json.push_back(to_json(element));
    return json;
}

/// A volume that is not finite becomes null: the outer cell's.
Json to_json(const std::vector<CellSummary>& cells) {
    Json json = Json::array();
    for (const CellSummary& cell : cells)
        json.push_back({{"region", cell.region}, {"name", cell.name}, {"filled", cell.filled}, {"volume", cell.volume}, {"inside", to_json(cell.inside)}});
    return json;
}

const char* key(Claim::State state) {
    switch (state) {
        case Claim::State::not_checked: return "not_checked";
        case Claim::State::proven: return "proven";
        case Claim::State::refuted: return "refuted";
    }
    return "?";
}

const char* key(Severity severity) {
    switch (severity) {
        case Severity::note: return "note";
        case Severity::warning: return "warning";
        case Severity::error: return "error";
    }
    return "?";
}

}  // namespace

Json json_header(const std::string& command, const std::string& input) {
    return {{"wellmesh", WELLMESH_VERSION}, {"command", command}, {"input", input}};
}

Json to_json(const MeshOptions& options) {
    Json json;
    json["mode"] = options.mode == Mode::certified ? "certified" : "practical";
    json["delta"] = or_null(options.paper.delta);
    json["b"] = or_null(options.paper.b);
    json["sigma0"] = or_null(options.paper.sigma0);
    json["sigma0_boundary"] = or_null(options.paper.sigma0_boundary);
    json["invariants"] = options.invariants;
    json["max_radius_edge_ratio"] = options.quality.max_radius_edge_ratio;
    json["min_dihedral_angle_deg"] = options.quality.min_dihedral_angle_deg;
    json["min_dihedral_boundary_deg"] = or_null(options.quality.min_dihedral_boundary_deg);
    json["edge_length"] = or_null(options.size.edge_length);
    json["max_volume"] = or_null(options.size.max_volume);
    json["entity_sizes"] = Json::array();
    for (const EntitySize& size : options.size.entities) json["entity_sizes"].push_back({{"entity", to_string(size.kind)}, {"id", size.name.empty() ? Json(size.id) : Json(size.name)}, {"edge_length", size.edge_length}});
    json["vertex_sizes"] = options.size.vertex_sizes ? "auto" : "off";
    json["per_local_feature_size"] = or_null(options.size.per_local_feature_size);
    json["elements_per_circle"] = or_null(options.size.elements_per_circle);
    json["gradation"] = options.size.gradation;
    json["min_edge_length"] = or_null(options.size.min_edge_length);
    json["max_vertices"] = or_null(options.limits.max_vertices);
    json["time_limit_seconds"] = options.limits.time ? Json(static_cast<double>(options.limits.time->count()) / 1000) : Json(nullptr);
    json["max_memory_bytes"] = or_null(options.limits.memory_bytes);
    json["coplanar_tolerance"] = or_null(options.coplanar_tolerance);
    json["thin_features"] = options.thin_features == ThinFeatures::join ? "join" : "refuse";
    json["seed"] = options.seed;
    json["slivers"] = to_string(options.slivers);
    json["seeding"] = options.seeding == Seeding::automatic ? "auto" : "off";
    return json;
}

Json to_json(const CertifyOptions& options) {
    Json json;
    json["max_radius_edge_ratio"] = or_null(options.max_radius_edge_ratio);
    json["min_dihedral_angle_deg"] = or_null(options.min_dihedral_angle_deg);
    json["max_aspect_ratio"] = or_null(options.max_aspect_ratio);
    json["min_sigma"] = or_null(options.min_sigma);
    json["min_dihedral_boundary_deg"] = or_null(options.min_dihedral_boundary_deg);
    json["min_sigma_boundary"] = or_null(options.min_sigma_boundary);
    json["max_volume"] = or_null(options.max_volume);
    json["tolerance"] = options.tolerance;
    json["flat_angle_rad"] = options.flat_angle_rad;
    return json;
}

Json to_json(const std::vector<AskedAchieved>& goals) {
    Json json = Json::array();
    for (const AskedAchieved& goal : goals)
        json.push_back({{"goal", goal.goal}, {"asked", goal.asked}, {"achieved", goal.achieved}, {"met", goal.met},
                        {"elements_missed", goal.elements_missed}, {"worst", to_json(goal.worst)}});
    return json;
}

Json to_json(const ShapeStatistics& statistics) {
    Json json;
    json["tets"] = statistics.tets;
    json["max_radius_edge_ratio"] = statistics.max_radius_edge_ratio;
    json["max_aspect_ratio"] = statistics.max_aspect_ratio;
    json["min_sigma"] = statistics.min_sigma;
    json["min_dihedral_angle_deg"] = statistics.min_dihedral_angle_deg;
    json["max_dihedral_angle_deg"] = statistics.max_dihedral_angle_deg;
    json["min_dihedral_histogram"] = statistics.min_dihedral_histogram;
    json["min_edge"] = statistics.min_edge;
    json["mean_edge"] = statistics.mean_edge;
    json["max_edge"] = statistics.max_edge;
    json["min_volume"] = statistics.min_volume;
    json["max_volume"] = statistics.max_volume;
    return json;
}

Json to_json(const Certificate& certificate) {
    Json claims = Json::array();
    for (const Claim& claim : certificate.claims) {
        Json json = {{"name", claim.name}, {"statement", claim.statement}, {"state", key(claim.state)},
                     {"checked", claim.checked}, {"violations", claim.violations}};
        json["witness"] = claim.witness ? to_json(*claim.witness) : Json(nullptr);
        json["detail"] = claim.detail;
        claims.push_back(std::move(json));
    }
    Json regions = Json::array();
    for (const RegionVolume& region : certificate.regions)
        regions.push_back({{"region", region.region}, {"tets", region.tets}, {"volume", region.volume}, {"plc_volume", or_null(region.plc_volume)}});
    Json json = {{"proven", certificate.proven()}, {"claims", std::move(claims)}, {"regions", std::move(regions)}};
    json["shape"] = {{"all", to_json(certificate.all)}, {"interior", to_json(certificate.interior)}, {"boundary", to_json(certificate.boundary)},
                     {"unexempt", to_json(certificate.unexempt)}};
    return json;
}

Json to_json(const std::vector<Exemption>& exemptions) {
    Json json = Json::array();
    for (const Exemption& e : exemptions) json.push_back({{"tet", e.tet + 1}, {"feature", to_json(e.feature)}, {"angle_deg", e.angle_deg}});
    return json;
}

Json to_json(const InvariantReport& report) {
    Json claims = Json::array();
    for (const InvariantClaim& claim : report.claims)
        claims.push_back({{"name", claim.name}, {"statement", claim.statement}, {"relation", claim.at_least ? ">=" : "<="}, {"bound", claim.bound},
                          {"worst", claim.worst}, {"events", claim.events}, {"violations", claim.violations}, {"witness", claim.witness},
                          {"where", claim.witness.empty() ? Json(nullptr) : to_json(claim.where)}});
    Json json;
    json["delta"] = report.delta;
    json["b"] = report.b;
    json["rho0"] = report.rho0;
    json["sigma0"] = report.sigma0;
    json["log10_existence_sigma0"] = report.log10_existence_sigma0;
    json["d1"] = report.d1;
    json["d2"] = report.d2;
    json["d3"] = report.d3;
    json["original_edge"] = report.original_edge;
    json["shortest_edge"] = report.shortest_edge;
    json["original_vertices"] = report.original_vertices;
    json["almost_good_vertices"] = report.almost_good_vertices;
    json["final_vertices"] = report.final_vertices;
    json["violations"] = report.violations();
    json["claims"] = std::move(claims);
    return json;
}

Json to_json(const GivenMeshStatistics& given) {
    Json json;
    json["vertices"] = given.vertices;
    json["tets"] = given.tets;
    json["delaunay_tets"] = given.delaunay_tets;
    json["tolerance"] = given.tolerance;
    json["farthest_vertex"] = given.farthest_vertex;
    json["moved_onto_input"] = given.moved_onto_input;
    json["dropped_vertices"] = given.dropped_vertices;
    json["added_input_vertices"] = given.added_input_vertices;
    json["added_for_conformity"] = given.added_for_conformity;
    json["min_dihedral_angle_deg"] = given.min_dihedral_angle_deg;
    json["added_for_refinement"] = given.added_for_refinement;
    return json;
}

Json to_json(const JoinStatistics& joined) {
    Json features = Json::array();
    for (const JoinedFeature& f : joined.joined) features.push_back({{"vertex", to_json(f.vertex)}, {"with", to_json(f.with)}, {"distance", f.distance}});
    return {{"tolerance", joined.tolerance},
            {"largest_move", joined.largest_move},
            {"assumed_single_precision", joined.assumed_single_precision},
            {"features", std::move(features)}};
}

Json to_json(const MeshStatistics& statistics) {
    Json json;
    if (const auto& gaps = statistics.gaps)
        json["gaps"] = {{"side", to_json(gaps->side)},       {"other_side", to_json(gaps->other_side)}, {"width", gaps->width}, {"narrowest", gaps->narrowest},
                        {"filled_from", gaps->filled_from}, {"vertices", gaps->vertices},             {"tets", gaps->tets}};
    if (statistics.joined) json["joined"] = to_json(*statistics.joined);
    json["cells"] = to_json(statistics.cells);
    if (statistics.given) json["given_mesh"] = to_json(*statistics.given);
    json["input_vertices"] = statistics.input_vertices;
    json["segment_vertices"] = statistics.segment_vertices;
    json["facet_vertices"] = statistics.facet_vertices;
    json["interior_vertices"] = statistics.interior_vertices;
    json["moved_vertices"] = statistics.moved_vertices;
    json["removed_vertices"] = statistics.removed_vertices;
    json["weighted_vertices"] = statistics.weighted_vertices;
    json["guarded_insertions"] = statistics.guarded_insertions;
    json["exact_predicate_calls"] = statistics.exact_predicate_calls;
    json["coplanar_tolerance"] = statistics.coplanar_tolerance;
    json["certificate_tolerance"] = statistics.certificate_tolerance;
    json["certificate_flat_angle_rad"] = statistics.certificate_flat_angle_rad;
    json["notes"] = statistics.notes;
    return json;
}

Json to_json(const std::vector<StageTime>& stages) {
    Json json = Json::array();
    for (const StageTime& stage : stages)
        json.push_back({{"stage", to_string(stage.stage)}, {"seconds", stage.seconds}, {"vertices_after", stage.vertices_after}, {"tets_after", stage.tets_after}});
    return json;
}

Json to_json(const Diagnosis& diagnosis) {
    Json defects = Json::array();
    const auto places = [](const std::vector<Vec3>& points) {
        Json list = Json::array();
        for (const Vec3& p : points) list.push_back(to_json(p));
        return list;
    };
    for (const Defect& defect : diagnosis.defects)
        defects.push_back({{"severity", key(defect.severity)}, {"kind", to_string(defect.kind)}, {"message", defect.message},
                          {"value", defect.value}, {"elements", to_json(defect.elements)}, {"points", places(defect.points)}});
    Json json;
    json["has_errors"] = diagnosis.has_errors();
    json["vertices"] = diagnosis.vertices;
    json["segments"] = diagnosis.segments;
    json["facets"] = diagnosis.facets;
    json["coplanar_tolerance"] = diagnosis.coplanar_tolerance;
    const auto smallest = [&](const SmallestFeature& feature) {
        return feature.points.empty() ? Json() : Json{{"value", feature.value}, {"points", places(feature.points)}};
    };
    json["smallest"] = {{"segment", smallest(diagnosis.smallest.segment)}, {"gap", smallest(diagnosis.smallest.gap)},
                        {"angle_deg", smallest(diagnosis.smallest.angle)}};
    json["defects"] = std::move(defects);
    json["cells"] = to_json(diagnosis.cells);
    return json;
}

Json to_json(const RepairResult& result) {
    const RepairActions& a = result.actions;
    return {{"tolerance", result.tolerance},
            {"max_displacement", result.max_displacement},
            {"displaced_most", to_json(result.displaced_most)},
            {"rounds", result.rounds},
            {"resolved", result.resolved},
            {"summary", result.summary},
            {"actions",
             {{"unusable_dropped", a.unusable_dropped},
              {"vertices_merged", a.vertices_merged},
              {"unused_vertices_dropped", a.unused_vertices_dropped},
              {"degenerate_dropped", a.degenerate_dropped},
              {"duplicates_dropped", a.duplicates_dropped},
              {"folds_dropped", a.folds_dropped},
              {"inner_dropped", a.inner_dropped},
              {"facets_turned", a.facets_turned},
              {"vertices_joined_to_edges", a.vertices_joined_to_edges},
              {"vertices_joined_to_facets", a.vertices_joined_to_facets},
              {"intersection_points", a.intersection_points},
              {"facets_cut", a.facets_cut}}}};
}

Json to_json(const MeshError& error) {
    return {{"code", to_string(error.code())}, {"stage", to_string(error.stage())}, {"message", error.what()}, {"offenders", to_json(error.offenders())}};
}

void write_json(const std::string& path, const Json& report) {
    // File names need not be UTF-8; JSON must be.
    write_text(path, report.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
}

}  // namespace wellmesh::cli
