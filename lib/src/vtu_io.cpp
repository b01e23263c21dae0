#include <algorithm>

#include "mesh_file.h"
#include "output_file.h"
#include "vtk_xml_writer.h"

namespace subvol {

namespace {

constexpr std::uint8_t kHexahedron = 12;

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");

// A block stands behind its own size.
std::size_t block_size(std::size_t bytes) {
    return sizeof(std::uint64_t) + bytes;
}

std::string header_text(const HexMesh& mesh) {
    const std::size_t points = mesh.points.size();
    const std::size_t cells = mesh.cells.size();
    VtkXmlHeader header("UnstructuredGrid");
    header.line("<UnstructuredGrid>\n<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" +
                std::to_string(cells) + "\">");
    header.line("<Points>");
    header.array("Float64", "Points", 3, block_size(points * sizeof(Vec3)));
    header.line("</Points>\n<Cells>");
    header.array("Int64", "connectivity", 1, block_size(cells * 8 * sizeof(std::int64_t)));
    header.array("Int64", "offsets", 1, block_size(cells * sizeof(std::int64_t)));
    header.array("UInt8", "types", 1, block_size(cells));
    header.line("</Cells>\n<PointData>");
    for (const auto& attribute : mesh.attributes) {
        header.array("Float64", attribute.name, static_cast<std::size_t>(attribute.channels),
                     block_size(attribute.values.size() * sizeof(double)));
    }
    header.line("</PointData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">");
    return header.text() + "_";
}

template <class T>
void write_block(OutputFile& out, std::span<const T> values) {
    const std::uint64_t bytes = values.size_bytes();
    out.write_values(std::span(&bytes, 1));
    out.write_values(values);
}

void write_cells(OutputFile& out, const HexMesh& mesh) {
    const std::uint64_t bytes = mesh.cells.size() * 8 * sizeof(std::int64_t);
    out.write_values(std::span(&bytes, 1));
    for (const auto& cell : mesh.cells) {
        std::array<std::int64_t, 8> wide;
        std::copy(cell.begin(), cell.end(), wide.begin());
        out.write_values<std::int64_t>(wide);
    }
    std::vector<std::int64_t> offsets(mesh.cells.size());
    for (std::size_t c = 0; c < offsets.size(); ++c) offsets[c] = static_cast<std::int64_t>(8 * (c + 1));
    write_block<std::int64_t>(out, offsets);
    write_block<std::uint8_t>(out, std::vector<std::uint8_t>(mesh.cells.size(), kHexahedron));
}

}  // namespace

std::vector<std::string> write_vtu(const std::filesystem::path& path, const HexMesh& mesh) {
    OutputFile out(path);
    out.write(header_text(mesh));
    write_block<Vec3>(out, mesh.points);
    write_cells(out, mesh);
    for (const auto& attribute : mesh.attributes) write_block<double>(out, attribute.values);
    out.write("\n</AppendedData>\n</VTKFile>\n");
    out.commit();
    if (mesh.creases.empty()) return {};
    return {counted(mesh.creases.size(), "crease", "creases") + " not written"};
}

}  // namespace subvol
