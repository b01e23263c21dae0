// SPDX-License-Identifier: Apache-2.0
// A mesh in pieces that is cut into bricks without being held gives the bricks of the mesh that is read as a whole.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "../temp_folder.h"
#include "../test_meshes.h"
#include "subvol/model.h"
#include "subvol/split.h"

namespace subvol {
namespace split_pieces_test {

using test::error_of;
using testing::HasSubstr;

/// What the pieces of a mesh have besides a field at their points.
struct Extras {
    bool point_numbers = false, cell_numbers = false, cell_field = false, ghosts = true;
    bool repeat_cell_numbers = false;
    double apart = 0;  // how far the copies of a point are from each other
};

std::string array(const std::string& type, const std::string& name, const std::string& numbers, int components = 1) {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" + std::to_string(components) +
           "\" format=\"ascii\">" + numbers + "</DataArray>\n";
}

class SplitPieces : public test::TempFolder {
protected:
    /// A .pvtu of the pieces of a mesh. piece_of: of each cell; the last piece is empty
    std::filesystem::path write_pieces(const HexMesh& mesh, const std::vector<int>& piece_of, const Extras& extras) const {
        std::string listed;
        const int count = *std::ranges::max_element(piece_of) + 1;
        for (int k = 0; k <= count; ++k) {
            (void)write("piece" + std::to_string(k) + ".vtu", piece(mesh, piece_of, k, extras));
            listed += "<Piece Source=\"piece" + std::to_string(k) + ".vtu\"/>";
        }
        return write("all.pvtu", "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid GhostLevel=\"1\">" + listed +
                                     "</PUnstructuredGrid></VTKFile>");
    }

    static std::string piece(const HexMesh& mesh, const std::vector<int>& piece_of, int k, const Extras& extras) {
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
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const std::size_t c = cells[i];
            for (const Index p : mesh.cells[c]) corners << place[p] << ' ';
            ends << 8 * (i + 1) << ' ';
            types << "12 ";
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

    void expect_same_bricks(const std::filesystem::path& pieces, const SplitOptions& options, const std::string& what) const {
        const ReadResult whole = read_mesh(pieces);
        const Bricks expected = split_mesh(path("whole.bricks"), whole.mesh, options).bricks;
        const PiecesSplit split = split_pieces(path("parts.bricks"), pieces, {}, options);
        ASSERT_TRUE(split.result) << what << split.held_whole;
        const Bricks& found = split.result->bricks;
        ASSERT_EQ(found.bricks.size(), expected.bricks.size()) << what;
        EXPECT_EQ(found.cells, expected.cells) << what;
        EXPECT_EQ(found.points, expected.points) << what;
        for (std::size_t b = 0; b < found.bricks.size(); ++b) {
            const BrickMesh a = read_brick(found, b), e = read_brick(expected, b);
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
        std::ranges::sort(expected_warnings);
        std::ranges::sort(warnings);
        EXPECT_EQ(warnings, expected_warnings) << what;
    }
};

std::vector<int> cut(const HexMesh& mesh, bool at_random) {
    std::vector<int> piece_of;
    std::mt19937 dice(5);
    for (const auto& cell : mesh.cells) {
        const Vec3& x = mesh.points[cell[0]];
        piece_of.push_back(at_random ? static_cast<int>(dice() % 4) : (x.x > 0.1 ? 1 : 0) + (x.z > 0.2 ? 2 : 0));
    }
    return piece_of;
}

HexMesh ball() {
    HexMesh mesh = make_model("ball", 4);
    test::jitter(mesh, 0.03, 3);
    for (std::size_t c = 0; c < mesh.cells.size(); c += 7) {  // left-handed
        std::swap_ranges(mesh.cells[c].begin(), mesh.cells[c].begin() + 4, mesh.cells[c].begin() + 4);
    }
    return mesh;
}

TEST_F(SplitPieces, TheBricksAreThoseOfTheWhole) {
    const HexMesh mesh = ball();
    for (const bool at_random : {false, true}) {
        for (int k = 0; k < 16; ++k) {
            const Extras extras{.point_numbers = (k & 1) != 0,
                                .cell_numbers = (k & 2) != 0,
                                .cell_field = (k & 4) != 0,
                                .ghosts = (k & 8) != 0,
                                .apart = (k & 1) != 0 ? 1e-8 : 0};
            const std::filesystem::path pieces = write_pieces(mesh, cut(mesh, at_random), extras);
            const BrickShape shape = k % 3 == 0 ? BrickShape::Blocks : k % 3 == 1 ? BrickShape::Slabs : BrickShape::Random;
            expect_same_bricks(pieces, {.bricks = 5, .shape = shape, .halo_layers = 1 + k % 3},
                               "case " + std::to_string(k) + (at_random ? " at random: " : ": "));
        }
    }
}

TEST_F(SplitPieces, NumbersThatNumberNothingAreNotUsed) {
    const HexMesh mesh = ball();
    // The same numbers at places that are too far apart.
    expect_same_bricks(write_pieces(mesh, cut(mesh, false), {.point_numbers = true, .apart = 0.5}), {.bricks = 3}, "");
}

TEST_F(SplitPieces, NumbersThatCellsShareAreNotUsed) {
    const HexMesh mesh = ball();
    const Extras repeated{.cell_numbers = true, .repeat_cell_numbers = true};
    expect_same_bricks(write_pieces(mesh, cut(mesh, true), repeated), {.bricks = 3}, "");
    EXPECT_THAT(read_mesh(path("all.pvtu")).warnings,
                testing::Contains("array \"GlobalElementId\" does not number the cells: not used"));
}

TEST_F(SplitPieces, CutsOfOneMeshWithNumberedCellsGiveOneMesh) {
    const HexMesh mesh = ball();
    const Extras numbered{.point_numbers = true, .cell_numbers = true, .cell_field = true};
    const ReadResult one = read_mesh(write_pieces(mesh, cut(mesh, false), numbered));
    const ReadResult other = read_mesh(write_pieces(mesh, cut(mesh, true), numbered));
    EXPECT_EQ(one.mesh.cells, other.mesh.cells);
    EXPECT_EQ(one.mesh.points, other.mesh.points);
    EXPECT_EQ(one.mesh.find_attribute("heat")->values, other.mesh.find_attribute("heat")->values);
    EXPECT_EQ(one.mesh.find_attribute("GlobalElementId"), nullptr);
    EXPECT_THAT(one.warnings, testing::Contains(HasSubstr("; cells in the order of \"GlobalElementId\"")));
    // Without numbers the cells come piece by piece.
    const ReadResult unnumbered = read_mesh(write_pieces(mesh, cut(mesh, true), {.point_numbers = true}));
    EXPECT_NE(one.mesh.cells, unnumbered.mesh.cells);
}

TEST_F(SplitPieces, OtherMeshesAreHeldWhole) {
    EXPECT_TRUE(split_pieces(path("b"), write("a.mesh", "")).held_whole.empty());
    const HexMesh mesh = test::make_box(2, 2, 2);
    const std::filesystem::path pieces = write_pieces(mesh, {0, 0, 0, 0, 1, 1, 1, 1}, {});
    EXPECT_EQ(split_pieces(path("b"), pieces, {.read = {.weld = 0}}).held_whole, "its points are welded");
    std::string text = test::read_bytes(path("piece1.vtu"));
    text.replace(text.find("12 12"), 5, "42 12");  // a polyhedron, which is ignored
    (void)write("piece1.vtu", text);
    EXPECT_TRUE(split_pieces(path("b"), pieces, {}, {.bricks = 2}).result);
}

TEST_F(SplitPieces, WhatIsMalformedIsSaidAndNothingIsLeft) {
    const HexMesh mesh = test::make_box(2, 2, 2);
    const std::filesystem::path pieces = write_pieces(mesh, {0, 0, 0, 0, 1, 1, 1, 1}, {});
    const std::string sound = test::read_bytes(path("piece1.vtu"));
    const auto said = [&] {
        const std::size_t files = file_count();
        const std::string error = error_of([&] { (void)split_pieces(path("b.bricks"), pieces, {}, {.bricks = 2}); });
        EXPECT_EQ(file_count(), files);
        return error;
    };
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = sound;
        text.replace(text.find(from), from.size(), to);
        (void)write("piece1.vtu", text);
    };
    std::filesystem::remove(path("piece1.vtu"));
    EXPECT_THAT(said(), HasSubstr("there is no file \"piece1.vtu\""));
    (void)write("piece1.vtu", sound.substr(0, sound.size() / 2));
    EXPECT_THAT(said(), HasSubstr("piece1.vtu"));
    changed("\"connectivity\" NumberOfComponents=\"1\" format=\"ascii\">",
            "\"connectivity\" NumberOfComponents=\"1\" format=\"ascii\">-");
    EXPECT_THAT(said(), HasSubstr("there is no point with index -"));
    changed("\"density\" NumberOfComponents=\"1\" format=\"ascii\">",
            "\"density\" NumberOfComponents=\"1\" format=\"ascii\">nan ");
    EXPECT_THAT(said(), HasSubstr("piece1.vtu"));
    (void)write("piece1.vtu", sound);
    EXPECT_TRUE(split_pieces(path("sound.bricks"), pieces, {}, {.bricks = 2}).result);
    EXPECT_THAT(error_of([&] { (void)split_pieces(path("b.bricks"), pieces, {}, {.bricks = 9}); }), HasSubstr("9 bricks"));
    EXPECT_THAT(error_of([&] { (void)split_pieces(path("none/b.bricks"), pieces); }, ErrorCode::Io),
                HasSubstr("does not exist"));
}

TEST_F(SplitPieces, ValuesThatAreNotFiniteAreSaidAsOfTheWhole) {
    const HexMesh mesh = test::make_box(2, 2, 2);
    const std::filesystem::path pieces = write_pieces(mesh, {0, 0, 0, 0, 1, 1, 1, 1}, {.cell_field = true, .ghosts = false});
    const std::string sound = test::read_bytes(path("piece1.vtu"));
    for (const std::string name : {"density", "heat"}) {
        std::string text = sound;
        const std::size_t at = text.find('>', text.find("\"" + name + "\"")) + 1;
        text.replace(at, text.find(' ', at) - at, "inf");
        (void)write("piece1.vtu", text);
        const std::string whole = error_of([&] { (void)read_mesh(pieces); });
        EXPECT_THAT(whole, HasSubstr("is not finite"));
        EXPECT_EQ(error_of([&] { (void)split_pieces(path("b.bricks"), pieces, {}, {.bricks = 2}); }), whole);
    }
}

}  // namespace split_pieces_test
}  // namespace subvol
