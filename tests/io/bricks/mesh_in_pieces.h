// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/split.h"

namespace subvol::test {

/// What the pieces of a mesh have besides a field at their points.
struct Extras {
    bool point_numbers = false, cell_numbers = false, cell_field = false, ghosts = true;
    bool repeat_cell_numbers = false;
    double apart = 0;  // how far the copies of a point are from each other
};

/// Cells with 8, 4, 6 or 5 corners, in VTK's order.
struct PlainMesh {
    std::vector<Vec3> points;
    std::vector<std::vector<Index>> cells;

    PlainMesh() = default;
    explicit PlainMesh(const HexMesh& mesh) : points(mesh.points) {
        for (const auto& cell : mesh.cells) cells.emplace_back(cell.begin(), cell.end());
    }
};

inline std::string array(const std::string& type, const std::string& name, const std::string& numbers, int components = 1) {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" + std::to_string(components) +
           "\" format=\"ascii\">" + numbers + "</DataArray>\n";
}

class MeshInPieces : public TempFolder {
protected:
    /// A .pvtu of the pieces of a mesh. piece_of: of each cell; the last piece is empty
    std::filesystem::path write_pieces(const HexMesh& mesh, const std::vector<int>& piece_of, const Extras& extras) const {
        return write_pieces(PlainMesh(mesh), piece_of, extras);
    }
    std::filesystem::path write_pieces(const PlainMesh& mesh, const std::vector<int>& piece_of, const Extras& extras) const {
        std::string listed;
        const int count = *std::ranges::max_element(piece_of) + 1;
        for (int k = 0; k <= count; ++k) {
            (void)write("piece" + std::to_string(k) + ".vtu", piece(mesh, piece_of, k, extras));
            listed += "<Piece Source=\"piece" + std::to_string(k) + ".vtu\"/>";
        }
        return write("all.pvtu", "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid GhostLevel=\"1\">" + listed +
                                     "</PUnstructuredGrid></VTKFile>");
    }

    static std::string piece(const PlainMesh& mesh, const std::vector<int>& piece_of, int k, const Extras& extras) {
        std::vector<std::size_t> cells;
        std::set<Index> touched, points;
        for (std::size_t c = 0; c < piece_of.size(); ++c) {
            if (piece_of[c] != k) continue;
            cells.push_back(c);
            touched.insert(mesh.cells[c].begin(), mesh.cells[c].end());
        }
        const std::size_t own = cells.size();
        for (std::size_t c = 0; extras.ghosts && c < piece_of.size(); ++c) {
            const bool near = std::ranges::any_of(mesh.cells[c], [&](Index p) { return touched.contains(p); });
            if (piece_of[c] != k && near) cells.push_back(c);
        }
        for (const std::size_t c : cells) points.insert(mesh.cells[c].begin(), mesh.cells[c].end());
        // Not in the order of the mesh, and with a point that no cell uses.
        std::vector<Index> order(points.rbegin(), points.rend());
        if (!order.empty() && points.size() < mesh.points.size()) {
            for (Index p = 0; order.size() == points.size(); ++p) {
                if (!points.contains(p)) order.push_back(p);
            }
        }
        std::vector<Index> place(mesh.points.size());
        for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<Index>(i);
        std::ostringstream at, field, vector, ids, corners, ends, types, ghosts, cell_ids, heat;
        for (auto* stream : {&at, &field, &heat}) stream->precision(17);
        for (const Index p : order) {
            const Vec3 x = mesh.points[p] + Vec3(k * extras.apart, 0, 0);
            at << x.x << ' ' << x.y << ' ' << x.z << '\n';
            field << std::sin(x.x) + x.y + k << ' ';  // each piece has its own values: the first counts
            vector << p << " 1 " << k << ' ';
            ids << 3 * p - 5.0 << ' ';
        }
        std::size_t end = 0;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const std::size_t c = cells[i];
            for (const Index p : mesh.cells[c]) corners << place[p] << ' ';
            end += mesh.cells[c].size();
            ends << end << ' ';
            types << (mesh.cells[c].size() == 8   ? 12
                      : mesh.cells[c].size() == 4 ? 10
                      : mesh.cells[c].size() == 6 ? 13
                                                  : 14)
                  << ' ';
            ghosts << (i < own ? 0 : 1) << ' ';
            cell_ids << (extras.repeat_cell_numbers ? c % 9 : 7 * c + 2) << ' ';
            heat << std::cos(static_cast<double>(c)) << ' ';
        }
        const bool any = !cells.empty();
        return "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"" + std::to_string(order.size()) +
               "\" NumberOfCells=\"" + std::to_string(cells.size()) + "\"><Points>" + array("Float64", "Points", at.str(), 3) +
               "</Points><Cells>" + array("Int64", "connectivity", corners.str()) + array("Int64", "offsets", ends.str()) +
               array("UInt8", "types", types.str()) + "</Cells><PointData>" + array("Float64", "density", field.str()) +
               array("Float64", "v", vector.str(), 3) + (k == 0 ? array("Float64", "extra", field.str()) : "") +
               (extras.point_numbers ? array("Int64", "GlobalNodeId", ids.str()) : "") + "</PointData><CellData>" +
               (any && extras.ghosts ? array("UInt8", "vtkGhostType", ghosts.str()) : "") +
               (any && extras.cell_numbers ? array("Int64", "GlobalElementId", cell_ids.str()) : "") +
               (any && extras.cell_field ? array("Float64", "heat", heat.str()) + array("Float64", "density", heat.str())
                                         : "") +
               "</CellData></Piece></UnstructuredGrid></VTKFile>";
    }

    void expect_same_bricks(const std::filesystem::path& pieces, const SplitOptions& options, const std::string& what,
                            const ReadOptions& read = {}) const {
        const ReadResult whole = read_mesh(pieces, read);
        const Bricks expected = split_mesh(path("whole.bricks"), whole.mesh, options).bricks;
        const PiecesSplit split = split_pieces(path("parts.bricks"), pieces, {.read = read}, options);
        ASSERT_TRUE(split.result) << what << split.held_whole;
        const Bricks& found = split.result->bricks;
        ASSERT_EQ(found.bricks.size(), expected.bricks.size()) << what;
        EXPECT_EQ(found.cells, expected.cells) << what;
        EXPECT_EQ(found.points, expected.points) << what;
        for (std::size_t b = 0; b < found.bricks.size(); ++b) {
            const MeshPiece a = read_brick(found, b), e = read_brick(expected, b);
            EXPECT_EQ(a.point_numbers, e.point_numbers) << what;
            EXPECT_EQ(a.cell_numbers, e.cell_numbers) << what;
            EXPECT_EQ(a.owned_points, e.owned_points) << what;
            EXPECT_EQ(a.owned_cells, e.owned_cells) << what;
            EXPECT_EQ(a.mesh.points, e.mesh.points) << what;
            EXPECT_EQ(a.mesh.cells, e.mesh.cells) << what;
            ASSERT_EQ(a.mesh.attributes.size(), e.mesh.attributes.size()) << what;
            for (std::size_t f = 0; f < a.mesh.attributes.size(); ++f) {
                EXPECT_EQ(a.mesh.attributes[f].name, e.mesh.attributes[f].name) << what;
                EXPECT_EQ(a.mesh.attributes[f].values, e.mesh.attributes[f].values) << what;
            }
        }
        std::vector<std::string> expected_warnings = whole.warnings, warnings = split.warnings;
        // The whole mesh has what only some pieces have with gaps, if no cells lie between; bricks do not have it.
        for (std::string& warning : expected_warnings) {
            if (warning.find("\"extra\"") != std::string::npos) warning = "array \"extra\" ignored: it is not in every piece";
        }
        std::ranges::sort(expected_warnings);
        std::ranges::sort(warnings);
        EXPECT_EQ(warnings, expected_warnings) << what;
    }
};

}  // namespace subvol::test
