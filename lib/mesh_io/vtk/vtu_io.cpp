// SPDX-License-Identifier: Apache-2.0
#include "formats.h"
#include "output_file.h"
#include "sharp_groups.h"
#include "text_scanner.h"
#include "vtk_xml_writer.h"

namespace subvol::detail {

namespace {

constexpr std::uint8_t kHexahedron = 12;

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");

void write_cells(VtkXmlWriter& out, const HexMesh& mesh) {
    const std::size_t cells = mesh.cells.size();
    const auto corner = [&](std::size_t i) { return static_cast<std::int64_t>(mesh.cells[i / 8][i % 8]); };
    out.line("<Cells>");
    out.made_array<std::int64_t>("connectivity", 1, 8 * cells, corner);
    out.made_array<std::int64_t>("offsets", 1, cells, [](std::size_t c) { return static_cast<std::int64_t>(8 * (c + 1)); });
    out.made_array<std::uint8_t>("types", 1, cells, [](std::size_t) { return kHexahedron; });
    out.line("</Cells>");
}

void write_piece(VtkXmlWriter& out, const HexMesh& mesh) {
    const std::size_t points = mesh.points.size();
    out.line("<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" + std::to_string(mesh.cells.size()) +
             "\">\n<Points>");
    out.array<double>("Points", 3, {reinterpret_cast<const double*>(mesh.points.data()), 3 * points});
    out.line("</Points>");
    write_cells(out, mesh);
    out.line("<PointData>");
    for (const auto& attribute : mesh.attributes) {
        out.array<double>(attribute.name, static_cast<std::size_t>(attribute.channels), attribute.values);
    }
    out.line("</PointData>\n</Piece>");
}

}  // namespace

std::vector<std::string> write_vtu(const std::filesystem::path& path, const HexMesh& mesh) {
    OutputFile out(path);
    VtkXmlWriter xml(out, "UnstructuredGrid");
    write_piece(xml, mesh);
    xml.end();
    out.commit();
    if (mesh.creases.empty() && mesh.sharp_faces.empty()) return {};
    return {sharp_counts(mesh) + " not written"};
}

}  // namespace subvol::detail
