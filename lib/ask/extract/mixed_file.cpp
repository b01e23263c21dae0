// SPDX-License-Identifier: Apache-2.0
#include "subvol/mixed_file.h"

#include "subvol/detail/mixed_shapes.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/vtk_xml_writer.h"
#include "subvol/error.h"

namespace subvol {

namespace {

/// The cells one after the other as VTK lists them.
struct CellList {
    std::vector<std::int64_t> corners, ends;
    std::vector<std::uint8_t> types;

    template <class Cells>
    void add(const Cells& cells, std::uint8_t type, std::span<const std::size_t> order = {}) {
        for (const auto& cell : cells) {
            for (std::size_t k = 0; k < cell.size(); ++k) {
                corners.push_back(static_cast<std::int64_t>(cell[order.empty() ? k : order[k]]));
            }
            ends.push_back(static_cast<std::int64_t>(corners.size()));
            types.push_back(type);
        }
    }
};

CellList list_cells(const MixedMesh& mesh) {
    constexpr std::uint8_t kTetrahedron = 10, kHexahedron = 12, kWedge = 13, kPyramid = 14;
    MixedMesh octahedra;
    octahedra.points = mesh.points;
    octahedra.octahedra = mesh.octahedra;
    CellList list;
    list.add(mesh.tets, kTetrahedron);
    list.add(in_tetrahedra(std::move(octahedra)).tets, kTetrahedron);
    list.add(mesh.hexes, kHexahedron);
    // VTK's wedge has its first triangle counter-clockwise seen from outside.
    static constexpr std::array<std::size_t, 6> kTurned{0, 2, 1, 3, 5, 4};
    list.add(mesh.prisms, kWedge, kTurned);
    list.add(mesh.pyramids, kPyramid);
    return list;
}

}  // namespace

void write_mixed_mesh(const std::filesystem::path& path, const MixedMesh& mesh) {
    if (path.extension() != ".vtu") {
        throw Error(ErrorCode::InvalidInput, "meshes of tetrahedra are written as .vtu only", path.string(), ".vtu");
    }
    validate(mesh);
    const CellList cells = list_cells(mesh);
    detail::OutputFile out(path);
    detail::VtkXmlWriter xml(out, "UnstructuredGrid");
    xml.line("<Piece NumberOfPoints=\"" + std::to_string(mesh.points.size()) + "\" NumberOfCells=\"" +
             std::to_string(cells.types.size()) + "\">\n<Points>");
    xml.array<double>("Points", 3, {reinterpret_cast<const double*>(mesh.points.data()), 3 * mesh.points.size()});
    xml.line("</Points>\n<Cells>");
    xml.array<std::int64_t>("connectivity", 1, cells.corners);
    xml.array<std::int64_t>("offsets", 1, cells.ends);
    xml.array<std::uint8_t>("types", 1, cells.types);
    xml.line("</Cells>\n<PointData>");
    for (const Attribute& attribute : mesh.attributes) {
        xml.array<double>(attribute.name, static_cast<std::size_t>(attribute.channels), attribute.values);
    }
    xml.line("</PointData>\n</Piece>");
    xml.end();
    out.commit();
}

}  // namespace subvol
