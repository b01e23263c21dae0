// SPDX-License-Identifier: Apache-2.0
#include "mesh_figures.h"

#include <array>
#include <limits>

#include "mesh_lines.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"

namespace subvol::cli {
namespace {

[[noreturn]] void fail_figures(const std::string& file) {
    throw Error(ErrorCode::InvalidInput, "its figures of a share cannot be read", file);
}

Vec3 corner_from(const Json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// throws: Error(InvalidInput) if it is not a whole number of 0 or more
std::size_t count_from(const Json& json, const std::string& file) {
    if (!json.is_number_unsigned()) fail_figures(file);
    return json.get<std::size_t>();
}

/// The counts of a share that are added up, under the names of `info`.
struct Count {
    const char* name;
    std::size_t MeshReport::*count;
};
constexpr std::array<Count, 12> kCounts{Count{"points", &MeshReport::points},
                                        Count{"points_used", &MeshReport::points_used},
                                        Count{"cells", &MeshReport::cells},
                                        Count{"edges", &MeshReport::edges},
                                        Count{"faces", &MeshReport::faces},
                                        Count{"boundary_faces", &MeshReport::boundary_faces},
                                        Count{"interior_edges", &MeshReport::interior_edges},
                                        Count{"singular_nodes", &MeshReport::singular_nodes},
                                        Count{"inverted_cells", &MeshReport::inverted_cells},
                                        Count{"degenerate_cells", &MeshReport::degenerate_cells},
                                        Count{"nonmanifold_edges", &MeshReport::nonmanifold_edges},
                                        Count{"nonmanifold_points", &MeshReport::nonmanifold_points}};

}  // namespace

Json json_of(const Vec3& point) {
    return Json::array({point.x, point.y, point.z});
}

Json json_of(const Box& box) {
    return Json::array({json_of(box.lower), json_of(box.upper)});
}

void put_mesh_report(Report& report, const MeshReport& mesh) {
    Json valences = Json::object();
    for (const auto& [valence, count] : mesh.interior_edge_valence) valences[std::to_string(valence)] = count;
    report["points"] = mesh.points;
    report["points_used"] = mesh.points_used;
    report["cells"] = mesh.cells;
    report["edges"] = mesh.edges;
    report["faces"] = mesh.faces;
    report["boundary_faces"] = mesh.boundary_faces;
    report["interior_edges"] = mesh.interior_edges;
    report["interior_edge_valence"] = valences;
    report["singular_nodes"] = mesh.singular_nodes;
    report["inverted_cells"] = mesh.inverted_cells;
    report["degenerate_cells"] = mesh.degenerate_cells;
    report["min_scaled_jacobian"] = mesh.min_scaled_jacobian;
    report["nonmanifold_edges"] = mesh.nonmanifold_edges;
    report["nonmanifold_points"] = mesh.nonmanifold_points;
    report["nonmanifold_faces"] = mesh.nonmanifold_faces;
    report["volume"] = mesh.volume;
    report["bounds"] = json_of(mesh.bounds);
}

Json json_of(const detail::MeshShare& share) {
    Json json;
    for (const auto& [name, count] : kCounts) json[name] = share.counts.*count;
    json["interior_edge_valence"] = Json::array();
    for (const auto& [valence, count] : share.counts.interior_edge_valence) {
        json["interior_edge_valence"].push_back({valence, count});
    }
    json["min_scaled_jacobian"] = share.counts.min_scaled_jacobian;
    json["bounds"] = json_of(share.counts.bounds);
    json["volumes"] = share.volumes;
    json["inverted"] = share.inverted;
    return json;
}

detail::MeshShare mesh_share_from(const Json& json, const std::string& file) {
    try {
        detail::MeshShare share;
        for (const auto& [name, count] : kCounts) share.counts.*count = count_from(json.at(name), file);
        for (const Json& pair : json.at("interior_edge_valence")) {
            const std::size_t valence = count_from(pair.at(0), file);
            if (valence > std::numeric_limits<int>::max()) fail_figures(file);
            share.counts.interior_edge_valence[static_cast<int>(valence)] = count_from(pair.at(1), file);
        }
        share.counts.min_scaled_jacobian = json.at("min_scaled_jacobian").get<double>();
        share.counts.bounds = {corner_from(json.at("bounds").at(0)), corner_from(json.at("bounds").at(1))};
        share.volumes = json.at("volumes").get<std::vector<double>>();
        for (const Json& cell : json.at("inverted")) share.inverted.push_back(count_from(cell, file));
        return share;
    } catch (const Json::exception&) {
        fail_figures(file);
    }
}

Json object_in(const std::string& file) {
    Json json = Json::parse(detail::of_limited_depth(detail::read_text(file), file), nullptr, false);
    if (!json.is_object()) throw Error(ErrorCode::InvalidInput, "is not one object of JSON", file);
    return json;
}

detail::MeshShare FigureParts::join(const std::vector<detail::MeshShare>& parts, std::span<const std::string>) {
    return detail::join_shares(parts, kCellsNamed);
}

detail::MeshShare FigureParts::unpack(const std::string& bytes) {
    return mesh_share_from(Json::parse(bytes), "rank");
}

LoadedPart<detail::MeshShare> FigureParts::load(const std::string& file) {
    const Json json = object_in(file);
    if (!json.contains("part_note") || !json["part_note"].is_string()) return {};
    return {json["part_note"].get<std::string>(), mesh_share_from(json.value("part_figures", Json::object()), file)};
}

}  // namespace subvol::cli
