// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "formats.h"
#include "output_file.h"
#include "sharp_groups.h"
#include "text_scanner.h"
#include "vtk_xml_writer.h"

namespace subvol::detail {

namespace {

constexpr std::uint8_t kHexType = 12, kQuadType = 9, kLineType = 3;

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");

/// What is written: a mesh, then quads and lines over its points and those that follow them.
struct Contents {
    const HexMesh& mesh;
    const std::vector<std::array<Index, 4>>& quads;
    const std::vector<std::array<Index, 2>>& lines;
};

void write_cells(VtkXmlWriter& out, const Contents& contents) {
    const HexMesh& mesh = contents.mesh;
    const auto& quads = contents.quads;
    const auto& lines = contents.lines;
    const std::size_t cells = mesh.cells.size(), of_cells = 8 * cells, of_quads = of_cells + 4 * quads.size();
    const auto corner = [&](std::size_t i) {
        if (i < of_cells) return static_cast<std::int64_t>(mesh.cells[i / 8][i % 8]);
        if (i < of_quads) return static_cast<std::int64_t>(quads[(i - of_cells) / 4][(i - of_cells) % 4]);
        return static_cast<std::int64_t>(lines[(i - of_quads) / 2][(i - of_quads) % 2]);
    };
    const std::size_t with_quads = cells + quads.size(), all = with_quads + lines.size();
    out.line("<Cells>");
    out.made_array<std::int64_t>("connectivity", 1, of_quads + 2 * lines.size(), corner);
    out.made_array<std::int64_t>("offsets", 1, all, [&](std::size_t c) {
        const std::size_t hexes = std::min(c + 1, cells), more = c + 1 - hexes, of_quad = std::min(more, quads.size());
        return static_cast<std::int64_t>(8 * hexes + 4 * of_quad + 2 * (more - of_quad));
    });
    out.made_array<std::uint8_t>("types", 1, all, [&](std::size_t c) {
        return c < cells ? kHexType : c < with_quads ? kQuadType : kLineType;
    });
    out.line("</Cells>");
}

void write_piece(VtkXmlWriter& out, const Contents& contents) {
    const HexMesh& mesh = contents.mesh;
    const std::size_t points = mesh.points.size();
    const std::size_t cells = mesh.cells.size() + contents.quads.size() + contents.lines.size();
    out.line("<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" + std::to_string(cells) +
             "\">\n<Points>");
    out.array<double>("Points", 3, {reinterpret_cast<const double*>(mesh.points.data()), 3 * points});
    out.line("</Points>");
    write_cells(out, contents);
    out.line("<PointData>");
    for (const auto& attribute : mesh.attributes) {
        out.array<double>(attribute.name, static_cast<std::size_t>(attribute.channels), attribute.values);
    }
    out.line("</PointData>\n</Piece>");
}

std::vector<std::string> write(const std::filesystem::path& path, const Contents& contents) {
    OutputFile out(path);
    VtkXmlWriter xml(out, "UnstructuredGrid");
    write_piece(xml, contents);
    xml.end();
    out.commit();
    if (contents.mesh.creases.empty() && contents.mesh.sharp_faces.empty()) return {};
    return {sharp_counts(contents.mesh) + " not written"};
}

}  // namespace

std::vector<std::string> write_vtu(const std::filesystem::path& path, const HexMesh& mesh) {
    return write(path, {mesh, {}, {}});
}

std::vector<std::string> write_vtu(const std::filesystem::path& path, const HexMesh& mesh, const Sheets& sheets) {
    HexMesh with = mesh;
    std::vector<Index> number;
    for (std::size_t p = 0; p < sheets.points.size(); ++p) {
        const auto& [cell, corner] = sheets.solid[p];
        number.push_back(cell != kNone ? mesh.cells[cell][corner] : static_cast<Index>(with.points.size()));
        if (cell != kNone) continue;
        with.points.push_back(sheets.points[p]);
        for (std::size_t a = 0; a < with.attributes.size(); ++a) {
            const auto channels = static_cast<std::size_t>(with.attributes[a].channels);
            const auto first = sheets.attributes[a].values.begin() + static_cast<std::ptrdiff_t>(p * channels);
            with.attributes[a].values.insert(with.attributes[a].values.end(), first,
                                             first + static_cast<std::ptrdiff_t>(channels));
        }
    }
    auto quads = sheets.quads;
    for (auto& quad : quads) {
        for (Index& p : quad) p = number[p];
    }
    auto lines = sheets.lines;
    for (auto& line : lines) {
        for (Index& p : line) p = number[p];
    }
    return write(path, {with, quads, lines});
}

}  // namespace subvol::detail
