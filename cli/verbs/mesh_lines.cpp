// SPDX-License-Identifier: Apache-2.0
#include "mesh_lines.h"

#include <algorithm>
#include <iomanip>

#include "quantities.h"
#include "text.h"

namespace subvol::cli {
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
                                                         : text(" of ", field.components);
        lines.emplace_back(&field == &read.fields.front() ? "fields" : "",
                           text(std::left, std::setw(static_cast<int>(name_width) + 2), field.name, std::setw(15),
                                "at " + field.location + "s" + kind, "  ", range(field.min, field.max)));
    }
    if (read.fields.empty()) lines.emplace_back("fields", "none");
}

}  // namespace

std::string verdict(const HexMesh& mesh, const MeshReport& report) {
    return verdict(report, report.inverted_cells > 0 ? inverted_cells(mesh, kCellsNamed) : std::vector<std::size_t>());
}

std::string verdict(const MeshReport& report, std::span<const std::size_t> inverted) {
    std::vector<std::string> faults;
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

std::string mesh_lines(const ReadResult& read, const MeshReport& mesh, const Json& seconds) {
    return mesh_lines(read,
                      {mesh, {}, mesh.inverted_cells > 0 ? inverted_cells(read.mesh, kCellsNamed) : std::vector<std::size_t>()},
                      seconds);
}

std::string mesh_lines(const ReadResult& read, const detail::MeshShare& joined, const Json& seconds) {
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
    if (!read.shells.empty()) {
        lines.emplace_back("shells", counted(shells.quads, "quad") + ", " + counted(shells.lines, "beam") + "; " +
                                         count_text(shells.attached) + " of " + counted(shells.points, "point") + " on cells");
    }
    if (mesh.nonmanifold_edges + mesh.nonmanifold_points > 0) {
        lines.emplace_back("touching", counted(mesh.nonmanifold_edges, "edge") + " and " +
                                           counted(mesh.nonmanifold_points, "point") + " where parts touch");
    }
    if (mesh.singular_nodes > 0) lines.emplace_back("singular nodes", count_text(mesh.singular_nodes));
    const Vec3 size = mesh.bounds.size();
    for (int axis = 0; axis < 3; ++axis) {
        lines.emplace_back(text("xyz"[axis]),
                           range(mesh.bounds.lower[axis], mesh.bounds.upper[axis]) + "  (" + number(size[axis]) + ")");
    }
    lines.emplace_back("volume", number(mesh.volume));
    lines.emplace_back("worst corner", text(std::setprecision(3), mesh.min_scaled_jacobian,
                                            " (scaled Jacobian: 1 a cube's, below 0 inverted)"));
    add_fields(read, lines);
    std::vector<std::string> stages;
    for (const auto& [stage, value] : seconds.items()) stages.push_back(stage + " " + seconds_text(value.get<double>()));
    lines.emplace_back("time", join(stages));
    lines.emplace_back("memory", bytes_text(static_cast<double>(peak_memory_bytes())));
    lines.emplace_back("verdict", verdict(mesh, joined.inverted));
    return aligned(lines);
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
