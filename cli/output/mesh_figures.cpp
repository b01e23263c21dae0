// SPDX-License-Identifier: Apache-2.0
// The figures of a mesh in two forms: lines of words for people, and JSON for programs and for shares that are joined later.
//
//     share of cells ─► counts, volumes, numbers of inverted cells ─► JSON ─► all shares ─► one report ─► lines, verdict
//
// Counts of shares are added up under the names of the JSON, so one table of names and members serves writing and reading.
// Figures that are read from a file are checked: a count is a whole number of 0 or more, and anything else is an error that
// names the file. The verdict is "sound", or lists what is wrong: inverted cells by their first numbers, cells without volume,
// edges at which more than two boundary faces meet.
#include "mesh_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <limits>
#include <optional>
#include <set>

#include "quantities.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"
#include "subvol/measure.h"
#include "text.h"

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

Json place_of(const LimitExtreme& extreme) {
    return std::isfinite(extreme.value) ? json_of(extreme.place) : Json();
}

Json json_of(const Box& box) {
    return Json::array({json_of(box.lower), json_of(box.upper)});
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

OpenedPart<detail::MeshShare> FigureParts::open(const std::string& file) {
    const Json json = object_in(file);
    if (!json.contains("part_note") || !json["part_note"].is_string()) return {};
    return {json["part_note"].get<std::string>(),
            [figures = json.value("part_figures", Json::object()), file] { return mesh_share_from(figures, file); }};
}

namespace {

std::string number(double value) {
    return text(std::setprecision(6), value);
}

std::string range(double min, double max) {
    return number(min) + " … " + number(max);
}

std::string valences(const MeshReport& mesh) {
    std::vector<std::string> irregular;
    for (const auto& [valence, count] : mesh.interior_edge_valence) {
        if (valence != 4)
            irregular.push_back(count_text(count) + " at " + counted(static_cast<std::uint64_t>(valence), "cell"));
    }
    return irregular.empty() ? "" : "; irregular: " + join(irregular);
}

/// The fields with their columns one below the other.
void add_fields(const ReadResult& read, Lines& lines) {
    std::size_t name_width = 0;
    for (const FieldInfo& field : read.fields) name_width = std::max(name_width, field.name.size());
    for (const FieldInfo& field : read.fields) {
        const std::string kind = field.components == 1   ? ""
                                 : field.components == 3 ? " vectors"
                                 : field.components == 6 ? " symmetric tensors"
                                 : field.components == 9 ? " tensors"
                                                         : text(" of ", field.components);
        lines.emplace_back(&field == &read.fields.front() ? "fields" : "",
                           text(std::left, std::setw(static_cast<int>(name_width) + 2), field.name, std::setw(15),
                                "at " + field.location + "s" + kind, "  ", range(field.min, field.max),
                                field.unit.empty() ? "" : " " + field.unit,
                                field.missing == 0 ? "" : text("; ", count_text(field.missing), " lack it")));
    }
    if (read.fields.empty()) lines.emplace_back("fields", "none");
}

/// The names of parts with the number of their cells or faces, and the volume of cells; of many the first.
class PartNames {
public:
    void add(const std::string& name, std::size_t count, std::optional<double> volume = {}) {
        constexpr std::size_t kMostNamed = 12;
        const std::string more = volume ? ", volume " + number(*volume) : "";
        if (words_.size() < kMostNamed) words_.push_back(name + " (" + count_text(count) + more + ")");
        ++count_;
    }
    void add_to(Lines& lines, const std::string& kind) {
        if (words_.empty()) return;
        if (count_ > words_.size()) words_.push_back("and " + count_text(count_ - words_.size()) + " more");
        lines.emplace_back(kind, join(words_));
    }

private:
    std::vector<std::string> words_;
    std::size_t count_ = 0;
};

/// Blocks, patches, and sets of cells that are not blocks.
void add_parts(const ReadResult& read, Lines& lines) {
    PartNames blocks, patches, sets, nodes;
    std::set<std::string_view> known;
    for (const MeshBlock& block : read.blocks) known.insert(block.name);
    for (const Patch& patch : read.sets.patches) patches.add(patch.name, patch.sides.size());
    for (const NodeSet& set : read.sets.nodes) nodes.add(set.name, points_of(read.mesh, set).size());
    for (const CellSet& set : read.sets.sets) {
        PartNames& names = known.contains(set.name) ? blocks : sets;
        if (&names == &sets || read.blocks.size() > 1) names.add(set.name, set.cells.size(), volume_of(read.mesh, set));
    }
    blocks.add_to(lines, "blocks");
    patches.add_to(lines, "patches");
    sets.add_to(lines, "sets");
    nodes.add_to(lines, "nodes");
}

}  // namespace

double volume_of(const HexMesh& mesh, const CellSet& set) {
    double volume = 0;
    for (const Index cell : set.cells) {
        std::array<Vec3, 8> corners;
        for (std::size_t k = 0; k < corners.size(); ++k) corners[k] = mesh.points[mesh.cells[cell][k]];
        volume += cell_volume(corners);
    }
    return volume;
}

std::string verdict(const MeshReport& report, std::span<const std::size_t> inverted) {
    std::vector<std::string> faults;
    if (!std::isfinite(report.volume)) faults.emplace_back("coordinates too large: the volume is beyond what can be computed");
    if (report.inverted_cells > 0) {
        std::vector<std::string> numbers;
        for (const std::size_t c : inverted) numbers.push_back(std::to_string(c));
        if (report.inverted_cells > kCellsNamed) numbers.emplace_back("…");
        faults.push_back(counted(report.inverted_cells, "cell") + " inverted: " + join(numbers));
    }
    if (report.degenerate_cells > 0)
        faults.push_back(counted(report.degenerate_cells, "cell") + " without volume or with an edge of no length");
    if (report.nonmanifold_edges > 0)
        faults.push_back(counted(report.nonmanifold_edges, "edge") + " where more than two boundary faces meet");
    std::string words;
    for (const std::string& fault : faults) words += (words.empty() ? "" : "; ") + fault;
    return words.empty() ? "sound" : words;
}

std::string mesh_lines(const ReadResult& read, const detail::MeshShare& joined, const Json& seconds, const std::string& steps) {
    const MeshReport& mesh = joined.counts;
    Lines lines;
    const ShellReport shells = inspect(read.shells);
    const std::size_t of_shells = shells.points - shells.attached;
    const std::size_t unused = mesh.points - std::min(mesh.points, mesh.points_used + of_shells);
    lines.emplace_back("cells", count_text(mesh.cells));
    lines.emplace_back("points", count_text(mesh.points) + (unused > 0 ? ", " + count_text(unused) + " of them unused" : ""));
    lines.emplace_back("faces", count_text(mesh.faces) + ", " + count_text(mesh.boundary_faces) + " of them on the boundary");
    lines.emplace_back("edges",
                       count_text(mesh.edges) + ", " + count_text(mesh.interior_edges) + " of them inside" + valences(mesh));
    if (read.curved) {
        lines.emplace_back("curved cells", count_text(read.curved->curved) + ": shape within " +
                                               number(read.curved->shape_error) + " of the size, fields within " +
                                               number(read.curved->fields_error) + " of their ranges" +
                                               (read.curved->limited ? ", above the tolerance" : ""));
    }
    if (!read.shells.empty()) {
        lines.emplace_back("shells", counted(shells.quads, "quad") + ", " + counted(shells.lines, "beam") + "; " +
                                         count_text(shells.attached) + " of " + counted(shells.points, "point") + " on cells");
    }
    if (mesh.nonmanifold_edges + mesh.nonmanifold_points > 0) {
        lines.emplace_back("touching", counted(mesh.nonmanifold_edges, "edge") + " and " +
                                           counted(mesh.nonmanifold_points, "point") + " where parts touch");
    }
    if (!read.mesh.creases.empty()) lines.emplace_back("creases", counted(read.mesh.creases.size(), "edge"));
    if (!read.mesh.sharp_faces.empty()) lines.emplace_back("sharp faces", count_text(read.mesh.sharp_faces.size()));
    if (mesh.singular_nodes > 0) lines.emplace_back("singular nodes", count_text(mesh.singular_nodes));
    const Vec3 size = mesh.bounds.size();
    for (int axis = 0; axis < 3; ++axis) {
        lines.emplace_back(text("xyz"[axis]),
                           range(mesh.bounds.lower[axis], mesh.bounds.upper[axis]) + "  (" + number(size[axis]) + ")");
    }
    lines.emplace_back("volume", std::isfinite(mesh.volume) ? number(mesh.volume) : "beyond what can be computed");
    lines.emplace_back("worst corner", text(std::setprecision(3), mesh.min_scaled_jacobian,
                                            " (scaled Jacobian: 1 a cube's, below 0 inverted)"));
    add_fields(read, lines);
    add_parts(read, lines);
    if (!steps.empty()) lines.emplace_back("steps", steps);
    std::vector<std::string> stages;
    for (const auto& [stage, value] : seconds.items()) stages.push_back(stage + " " + seconds_text(value.get<double>()));
    lines.emplace_back("time", join(stages));
    lines.emplace_back("memory", bytes_text(static_cast<double>(peak_memory_bytes())));
    lines.emplace_back("verdict", verdict(mesh, joined.inverted));
    return aligned(lines);
}

std::string fold_text(const FoldReport& folds, std::size_t cells) {
    std::vector<std::string> parts{text(count_text(folds.proved), " of ", counted(cells, "cell"), " proved not to fold")};
    if (folds.folded > 0) parts.push_back(text(count_text(folds.folded), " folded (check says where)"));
    if (folds.sampled.folded > 0) parts.push_back(text(count_text(folds.sampled.folded), " of them found to fold by sampling"));
    if (folds.open > 0) parts.push_back(text(count_text(folds.open), " undecided"));
    if (folds.irregular > 0) parts.push_back(text(count_text(folds.irregular), " near irregular edges not decided"));
    if (folds.sampled.cells > 0) parts.push_back(sample_text(folds));
    return join(parts);
}

std::string sample_text(const FoldReport& folds) {
    return text("sampled at ", count_text(folds.sampled.places), " places, least determinant ", folds.sampled.least,
                " of the mean");
}

std::string refined_lines(const Json& figures) {
    const auto count = [&](const char* key) { return figures.at(key).get<std::size_t>(); };
    std::string lines =
        aligned({{figures.at("scheme").get<std::string>(),
                  text(counted(count("control_cells"), "cell"), " to ", count_text(count("tets")), " tetrahedra and ",
                       count_text(count("octahedra")), " octahedra at level ", count("levels"), "; ",
                       count_text(count("inverted_cells")), " cells inverted, worst shape ", std::setprecision(3),
                       figures.at("worst_shape").get<double>(), " (1 a regular cell's), volume ",
                       number(figures.at("volume").get<double>()))}});
    lines.pop_back();
    return lines;
}

}  // namespace subvol::cli
