// SPDX-License-Identifier: Apache-2.0
// A mesh in pieces that is cut into bricks without being held gives the bricks of the mesh that is read as a whole.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "io/solver_io/exodus_texts.h"
#include "io/solver_io/foam_texts.h"
#include "mesh_in_pieces.h"
#include "subvol/model.h"

namespace subvol {
namespace split_pieces_test {

using test::error_of;
using test::Extras;
using testing::HasSubstr;

class SplitPieces : public test::MeshInPieces {};

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

#ifdef SUBVOL_SOLVERS
// Files that one name of Exodus stands for, joined by their places and by their node_num_map.
TEST_F(SplitPieces, PiecesOfExodus) {
    const HexMesh mesh = test::make_box(4, 3, 2);
    for (const bool numbered : {false, true}) {
        for (int k = 0; k < 2; ++k) {
            test::ExodusText half{.points = mesh.points, .blocks = {test::hex_block(mesh)}, .times = {0, 1}};
            const double apart = numbered ? 1e-9 : 0;
            for (Vec3& x : half.points) x.x += (4 + apart) * k;
            half.of_nodes = {{"T", test::count_from(100. * k, 2 * mesh.points.size())}};
            half.of_elements = {{"c", {test::count_from(10. * k, 2 * mesh.cells.size())}}};
            auto variables = test::exodus_variables(half);
            if (numbered) {
                std::vector<double> numbers;
                for (const Vec3& x : half.points) numbers.push_back(1 + std::round(x.x) + 9 * x.y + 36 * x.z);
                constexpr std::size_t kNodes = 0;  // the first dimension
                const std::size_t map = variables.variable("node_num_map", test::NetcdfText::Kind::Integers, {kNodes});
                variables.put(map, numbers);
            }
            write("m.e.2." + std::to_string(k), variables.text(2));
        }
        const ReadResult whole = read_mesh(path("m.e.2.0"));
        EXPECT_EQ(whole.mesh.points.size(), 2 * mesh.points.size() - 12);
        EXPECT_EQ(whole.mesh.find_attribute("node_num_map"), nullptr);
        expect_same_bricks(path("m.e.2.0"), {.bricks = 3}, numbered ? "numbered" : "by places");
    }
}

// Processors of a decomposed case, in folders of their own and in files of all; without the means, which need the whole.
TEST_F(SplitPieces, ProcessorsOfOpenFoam) {
    using namespace test::foam;
    HexMesh mesh = test::make_box(6, 3, 2);
    test::jitter(mesh, 0.1, 2);
    const auto put = [&](const std::string& name, const std::string& text) {
        std::filesystem::create_directories(path(name).parent_path());
        (void)write(name, text);
    };
    put("case/a.foam", "");
    std::map<std::string, std::string> collated;
    for (const auto& [name, text] : case_of_processors(mesh, 3)) {
        put("case/" + name, text);
        std::string& file = collated[name.substr(name.find('/'))];
        const std::string block = file.empty() ? text : text.substr(text.find("// * * //"));
        file += std::to_string(block.size()) + "\n(" + block + ")\n";
    }
    expect_same_bricks(path("case/a.foam"), {.bricks = 4}, "folders", {.cell_values = CellValues::Mean});
    EXPECT_EQ(split_pieces(path("b"), path("case/a.foam"), {}).held_whole, "its values at cells are fitted");
    for (int k = 0; k < 3; ++k) std::filesystem::remove_all(path("case/processor" + std::to_string(k)));
    for (const auto& [name, blocks] : collated) {
        put("case/processors3" + name, header("decomposedBlockData", {.binary = true}) + blocks);
    }
    expect_same_bricks(path("case/a.foam"), {.bricks = 4}, "collated", {.cell_values = CellValues::Mean});
    std::filesystem::remove_all(path("case/processors3/3"));
    put("case/processors3/3/p", header("decomposedBlockData", {.binary = true}) + "3\n(bad)\n");
    EXPECT_THAT(split_pieces(path("c.bricks"), path("case/a.foam"), {.read = {.cell_values = CellValues::Mean}}).warnings,
                testing::Contains(HasSubstr("array \"p\" left out: ")));
}
#endif

TEST_F(SplitPieces, NumbersThatNumberNothingAreNotUsed) {
    const HexMesh mesh = ball();
    // The same numbers at places that are too far apart.
    expect_same_bricks(write_pieces(mesh, cut(mesh, false), {.point_numbers = true, .apart = 0.5}), {.bricks = 3}, "");
}

TEST_F(SplitPieces, NumbersThatCellsShareAreNotUsed) {
    const HexMesh mesh = ball();
    const Extras repeated{.cell_numbers = true, .repeat_cell_numbers = true};
    expect_same_bricks(write_pieces(mesh, cut(mesh, true), repeated), {.bricks = 3}, "", {.cell_values = CellValues::Mean});
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

// A cell that a point was moved through has a negative volume, and is no left-handed one.
TEST_F(SplitPieces, FoldedCellsAreNotTurned) {
    HexMesh mesh = test::make_box(3, 3, 3);
    for (Vec3& x : mesh.points) {
        if (x == Vec3(1, 1, 1)) x = Vec3(2.6);
    }
    const std::filesystem::path pieces = write_pieces(mesh, cut(mesh, false), {});
    expect_same_bricks(pieces, {.bricks = 3}, "");
    const PiecesSplit split = split_pieces(path("f.bricks"), pieces, {}, {.bricks = 3});
    EXPECT_THAT(split.warnings, testing::Not(testing::Contains(HasSubstr("turned round"))));
    EXPECT_THAT(split.warnings, testing::Contains(HasSubstr("have a negative Jacobian")));
    EXPECT_EQ(split_pieces(path("f.bricks"), pieces, {}, {.bricks = 3}).warnings, split.warnings) << "of bricks that were kept";
}

// A tower whose lower third is folded back: the cells there have negative volumes, though they are of the hand of those above,
// which bricks at the bottom do not see.
TEST_F(SplitPieces, TheHandOfACellIsThatOfItsPartInTheWholeMesh) {
    HexMesh mesh = test::make_box(2, 2, 24);
    for (Vec3& x : mesh.points) {
        if (x.z < 8) x.z = 16.5 - x.z;  // the lower third is folded back over the middle
    }
    for (std::size_t c = 0; c < mesh.cells.size(); c += 3) {
        std::swap_ranges(mesh.cells[c].begin(), mesh.cells[c].begin() + 4, mesh.cells[c].begin() + 4);
    }
    const std::filesystem::path pieces = write_pieces(mesh, cut(mesh, false), {});
    expect_same_bricks(pieces, {.bricks = 6}, "");
    EXPECT_THAT(split_pieces(path("h.bricks"), pieces, {}, {.bricks = 6}).warnings,
                testing::Contains(HasSubstr("32 of 96 hexahedra")));
}

TEST_F(SplitPieces, OtherMeshesAreHeldWhole) {
    EXPECT_TRUE(split_pieces(path("b"), write("a.mesh", "")).held_whole.empty());
    const HexMesh mesh = test::make_box(2, 2, 2);
    const std::filesystem::path pieces = write_pieces(mesh, {0, 0, 0, 0, 1, 1, 1, 1}, {});
    EXPECT_EQ(split_pieces(path("b"), pieces, {.read = {.weld = 0}}).held_whole, "its points are welded");
    std::string text = test::read_bytes(path("piece1.vtu"));
    text.replace(text.find("12 12"), 5, "99 12");  // a type that is ignored
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

TEST_F(SplitPieces, FieldsThatAreNotFiniteAreLeftToTheWholeMesh) {
    const HexMesh mesh = test::make_box(2, 2, 2);
    const std::filesystem::path pieces = write_pieces(mesh, {0, 0, 0, 0, 1, 1, 1, 1}, {.cell_field = true, .ghosts = false});
    const std::string sound = test::read_bytes(path("piece1.vtu"));
    for (const std::string name : {"density", "heat"}) {
        std::string text = sound;
        const std::size_t at = text.find('>', text.find("\"" + name + "\"")) + 1;
        text.replace(at, text.find(' ', at) - at, "inf");
        (void)write("piece1.vtu", text);
        EXPECT_THAT(read_mesh(pieces).warnings,
                    testing::Contains(testing::AllOf(HasSubstr("\"" + name + "\""), HasSubstr("are not everywhere"))));
        const auto split = split_pieces(path("b.bricks"), pieces, {}, {.bricks = 2});
        EXPECT_FALSE(split.result);
        EXPECT_THAT(split.held_whole, HasSubstr("not finite"));
    }
}

}  // namespace split_pieces_test
}  // namespace subvol
