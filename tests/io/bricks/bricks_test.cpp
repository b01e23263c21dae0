// SPDX-License-Identifier: Apache-2.0
// A mesh in bricks is the mesh: whatever is computed brick by brick has the bits that it has in one piece.
#include "subvol/bricks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "cut_meshes.h"
#include "lib/temp_folder.h"
#include "subvol/brick_points.h"
#include "subvol/detail/mesh_share.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/points_io.h"
#include "subvol/split.h"

namespace subvol {
namespace bricks_test {

using test::error_of;
using test::irregular_ball;
using test::kCounts;
using test::kShapes;
using test::read_bytes;
using test::tagged;

class BricksTest : public test::TempFolder {};

TEST_F(BricksTest, TogetherTheyAreTheMesh) {
    const HexMesh mesh = irregular_ball();
    for (const BrickShape shape : kShapes) {
        const SplitResult split = split_mesh(path("ball.bricks"), mesh, {.bricks = 5, .shape = shape});
        EXPECT_EQ(split.bricks.cells, mesh.cells.size());
        EXPECT_EQ(split.bricks.points, mesh.points.size());
        std::set<std::uint64_t> cells, points;
        for (std::size_t b = 0; b < split.bricks.bricks.size(); ++b) {
            const MeshPiece brick = read_brick(split.bricks, b);
            for (std::size_t c = 0; c < brick.cell_numbers.size(); ++c) {
                const auto& corners = mesh.cells[brick.cell_numbers[c]];
                for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(brick.point_numbers[brick.mesh.cells[c][k]], corners[k]);
                if (brick.owned_cells[c]) {
                    EXPECT_TRUE(cells.insert(brick.cell_numbers[c]).second) << "owned twice";
                }
            }
            for (std::size_t p = 0; p < brick.point_numbers.size(); ++p) {
                EXPECT_EQ(brick.mesh.points[p], mesh.points[brick.point_numbers[p]]);
                EXPECT_EQ(brick.mesh.attributes[0].values[p], mesh.attributes[0].values[brick.point_numbers[p]]);
                if (brick.owned_points[p]) {
                    EXPECT_TRUE(points.insert(brick.point_numbers[p]).second) << "owned twice";
                }
            }
        }
        EXPECT_EQ(cells.size(), mesh.cells.size());
        EXPECT_EQ(points.size(), mesh.points.size());
        const auto [min, max] = std::ranges::minmax(mesh.attributes[0].values);
        EXPECT_EQ(split.bricks.fields[0].min[0], min);
        EXPECT_EQ(split.bricks.fields[0].max[0], max);
        EXPECT_EQ(split.bricks.bounds.lower, bounds(mesh).lower);
        EXPECT_EQ(split.bricks.bounds.upper, bounds(mesh).upper);
    }
}

TEST_F(BricksTest, FiguresOfSharesAreThoseOfAll) {
    HexMesh mesh = irregular_ball();
    for (const std::size_t c : {5U, 77U, 300U}) std::swap_ranges(&mesh.cells[c][0], &mesh.cells[c][4], &mesh.cells[c][4]);
    const Bricks bricks = split_mesh(path("m.bricks"), mesh, {.bricks = 5, .shape = BrickShape::Random}).bricks;
    const MeshReport whole = inspect(bricks);
    for (const std::size_t count : kCounts) {
        std::vector<detail::MeshShare> shares;
        for (int part = 1; part <= static_cast<int>(count); ++part) {
            shares.push_back(detail::inspect_share(bricks, {part, static_cast<int>(count)}, 2));
        }
        const detail::MeshShare joined = detail::join_shares(shares, 2);
        EXPECT_EQ(joined.counts.volume, whole.volume);
        EXPECT_EQ(joined.counts.edges, whole.edges);
        EXPECT_EQ(joined.counts.min_scaled_jacobian, whole.min_scaled_jacobian);
        EXPECT_EQ(joined.counts.inverted_cells, 3U);
        EXPECT_EQ(joined.inverted, (std::vector<std::size_t>{5, 77})) << "the first two";
    }
}

TEST_F(BricksTest, CreasesByAngleAndRefinedBoundariesToo) {
    const HexMesh mesh = irregular_ball();
    const Bricks bricks = split_mesh(path("m.bricks"), mesh, {.bricks = 6, .halo_layers = 4}).bricks;
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark, Scheme::Bsxw}) {
        const SampleOptions options{.scheme = {.kind = scheme, .crease_angle_deg = 20}, .boundary_levels = 2};
        write_points(path("whole.ply"), sample_rbf_points(mesh, options).volume);
        (void)write_points_of_bricks(path("bricks.ply"), bricks, options);
        EXPECT_TRUE(read_bytes(path("bricks.ply")) == read_bytes(path("whole.ply"))) << int(scheme);
    }
}

TEST_F(BricksTest, RealMeshes) {
    const auto folder = test::data_folder();
    if (!folder) GTEST_SKIP() << "SUBVOL_DATA names no folder";
    const HexMesh mesh = read_mesh(*folder / "hexdom_igea_improve.vtk").mesh;
    HexMesh with_field = without_unused_points(mesh);
    with_field.attributes.clear();
    test::add_field(with_field, "f", [](const Vec3& x) { return x.x * x.y + x.z; });
    write_points(path("whole.ply"), sample_rbf_points(with_field).volume);
    for (const BrickShape shape : kShapes) {
        const Bricks bricks = split_mesh(path("m.bricks"), with_field, {.bricks = 7, .shape = shape}).bricks;
        (void)write_points_of_bricks(path("bricks.ply"), bricks, {});
        EXPECT_TRUE(read_bytes(path("bricks.ply")) == read_bytes(path("whole.ply")));
    }
}

TEST_F(BricksTest, GatherHasAllThatTouchesTheBox) {
    const HexMesh mesh = irregular_ball();
    const Bricks bricks = split_mesh(path("m.bricks"), mesh, {.bricks = 7}).bricks;
    const Box box{{-0.2, -0.3, 0.1}, {0.1, 0.2, 0.4}};
    const MeshPiece part = gather(bricks, box);
    EXPECT_TRUE(std::ranges::is_sorted(part.cell_numbers));
    EXPECT_LT(part.mesh.cells.size(), mesh.cells.size());
    std::set<std::uint64_t> owned, all(part.cell_numbers.begin(), part.cell_numbers.end());
    for (std::size_t c = 0; c < part.owned_cells.size(); ++c) {
        if (part.owned_cells[c]) owned.insert(part.cell_numbers[c]);
    }
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        Box cell;
        for (const Index p : mesh.cells[c]) cell.add(mesh.points[p]);
        bool touches = true;
        for (int d = 0; d < 3; ++d) touches = touches && cell.lower[d] <= box.upper[d] && cell.upper[d] >= box.lower[d];
        EXPECT_TRUE(!touches || owned.contains(c)) << "cell " << c;
    }
    // The halo: every cell that shares a point with an owned one is there.
    std::set<Index> points;
    for (const auto c : owned) points.insert(mesh.cells[c].begin(), mesh.cells[c].end());
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const bool next = std::ranges::any_of(mesh.cells[c], [&](Index p) { return points.contains(p); });
        EXPECT_TRUE(!next || all.contains(c)) << "cell " << c;
    }
}

TEST_F(BricksTest, CountsAreThoseOfTheWhole) {
    const HexMesh mesh = irregular_ball();
    const MeshReport whole = inspect(mesh);
    for (const BrickShape shape : kShapes) {
        const MeshReport report = inspect(split_mesh(path("m.bricks"), mesh, {.bricks = 7, .shape = shape}).bricks);
        EXPECT_EQ(report.points, whole.points);
        EXPECT_EQ(report.points_used, whole.points_used);
        EXPECT_EQ(report.cells, whole.cells);
        EXPECT_EQ(report.edges, whole.edges);
        EXPECT_EQ(report.faces, whole.faces);
        EXPECT_EQ(report.boundary_faces, whole.boundary_faces);
        EXPECT_EQ(report.interior_edge_valence, whole.interior_edge_valence);
        EXPECT_EQ(report.singular_nodes, whole.singular_nodes);
        EXPECT_EQ(report.min_scaled_jacobian, whole.min_scaled_jacobian);
        EXPECT_EQ(report.bounds.lower, whole.bounds.lower);
        EXPECT_NEAR(report.volume, whole.volume, 1e-13 * whole.volume) << "summed in another order";
    }
}

TEST_F(BricksTest, TheTwistIsWrittenWithoutTheWhole) {
    const HexMesh mesh = make_model("twist", 12);
    write_points(path("whole.ply"), sample_rbf_points(mesh).volume);
    for (const std::size_t count : kCounts) {
        const Bricks bricks = split_twist(path("t.bricks"), 12, {.bricks = count}).bricks;
        EXPECT_EQ(bricks.bricks.size(), count);
        EXPECT_EQ(bricks.cells, mesh.cells.size());
        (void)write_points_of_bricks(path("bricks.ply"), bricks, {});
        EXPECT_TRUE(read_bytes(path("bricks.ply")) == read_bytes(path("whole.ply"))) << count;
    }
}

TEST_F(BricksTest, ATwistOfTooManyBricksIsRefusedBeforeAnyIsWritten) {
    const SplitOptions options{.memory_bytes = 1'000'000};
    const std::string said = test::error_of([&] { (void)split_twist(path("t.bricks"), 4096, options); });
    EXPECT_NE(said.find("at most a million"), std::string::npos) << said;
    EXPECT_EQ(file_count(), 0U);
}

TEST_F(BricksTest, NumbersThatAMeshHasAreNoField) {
    HexMesh mesh = make_model("twist", 6);  // as it comes from pieces
    test::add_field(mesh, "GlobalNodeId", [](const Vec3& x) { return x.x; });
    const Bricks bricks = split_mesh(path("t.bricks"), mesh, {.bricks = 3}).bricks;
    ASSERT_EQ(bricks.fields.size(), 1U);
    EXPECT_EQ(bricks.fields[0].name, "density");
    for (std::size_t b = 0; b < 3; ++b) EXPECT_EQ(read_brick(bricks, b).mesh.attributes.size(), 1U);
}

TEST_F(BricksTest, ABrickOpensAlone) {
    const HexMesh mesh = make_model("twist", 8);
    const Bricks bricks = split_mesh(path("t.bricks"), mesh, {.bricks = 3}).bricks;
    std::size_t cells = 0;
    for (const Brick& brick : bricks.bricks) cells += read_mesh(bricks.path / brick.file).mesh.cells.size();
    EXPECT_EQ(cells, mesh.cells.size()) << "the halo is left out";
}

TEST_F(BricksTest, AnInterruptedSplitIsContinued) {
    const HexMesh mesh = make_model("twist", 8);
    (void)split_mesh(path("t.bricks"), mesh, {.bricks = 4});
    // As after an interruption: two bricks are there, one is damaged.
    std::filesystem::rename(path("t.bricks"), path("t.bricks.unfinished"));
    std::filesystem::rename(path("t.bricks.unfinished/index.json"), path("t.bricks.unfinished/progress.json"));
    std::filesystem::remove(path("t.bricks.unfinished/brick_00002.vtu"));
    std::string bytes = read_bytes(path("t.bricks.unfinished/brick_00001.vtu"));
    bytes[bytes.size() / 2] ^= 1;
    (void)write("t.bricks.unfinished/brick_00001.vtu", bytes);
    const SplitResult split = split_mesh(path("t.bricks"), mesh, {.bricks = 4});
    EXPECT_EQ(split.kept, 2U);
    EXPECT_EQ(split.written, 2U);
    EXPECT_FALSE(std::filesystem::exists(path("t.bricks.unfinished")));
    for (std::size_t b = 0; b < 4; ++b) EXPECT_GT(read_brick(split.bricks, b).mesh.cells.size(), 0U);
}

TEST_F(BricksTest, DamageIsSaidInOneSentence) {
    const HexMesh mesh = make_model("twist", 6);
    const std::filesystem::path folder = path("t.bricks"), first = folder / "brick_00000.vtu", index = folder / "index.json";
    const Bricks sound = split_mesh(folder, mesh, {.bricks = 2}).bricks;
    const std::string brick = read_bytes(first), list = read_bytes(index);
    const auto open_all = [&] {
        const Bricks bricks = open_bricks(folder);
        for (std::size_t b = 0; b < bricks.bricks.size(); ++b) (void)read_brick(bricks, b);
    };
    const auto put = [](const std::filesystem::path& file, const std::string& bytes) {
        std::ofstream(file, std::ios::binary) << bytes;
    };
    std::filesystem::remove(first);
    EXPECT_NE(error_of(open_all).find("a brick is missing: brick_00000.vtu"), std::string::npos);
    put(first, brick.substr(0, brick.size() / 2));
    EXPECT_NE(error_of(open_all).find("in the index it has"), std::string::npos);
    std::string changed = brick;
    changed[brick.size() - 200] ^= 4;
    put(first, changed);
    EXPECT_NE(error_of(open_all).find("has changed since the index was written"), std::string::npos);
    HexMesh moved = mesh;
    moved.points[0].x += 1e-9;
    (void)split_mesh(path("other.bricks"), moved, {.bricks = 2});
    put(first, read_bytes(path("other.bricks") / "brick_00000.vtu"));
    EXPECT_NE(error_of(open_all).find("is a brick of another mesh"), std::string::npos);
    put(first, brick);
    EXPECT_EQ(error_of(open_all), "no error");
    put(index, list.substr(0, list.size() / 2));
    EXPECT_NE(error_of(open_all).find("not well-formed JSON"), std::string::npos);
    std::string newer = list;
    newer.replace(newer.find("\"version\": 1"), 12, "\"version\": 9");
    put(index, newer);
    EXPECT_NE(error_of(open_all).find("has version 9 of the format of bricks"), std::string::npos);
    put(index, "{}");
    EXPECT_NE(error_of(open_all).find("is not an index of bricks"), std::string::npos);
    for (const auto& [said, wrong] : {std::pair{"\"halo_layers\": 3", "\"halo_layers\": 2000000000"},
                                      {"\"halo_layers\": 3", "\"halo_layers\": 0"},
                                      {"\"cells\": 216", "\"cells\": -216"},
                                      {"\"points\": 343", "\"points\": 343.5"}}) {
        std::string other = list;
        ASSERT_NE(other.find(said), std::string::npos) << said;
        other.replace(other.find(said), std::string_view(said).size(), wrong);
        put(index, other);
        EXPECT_NE(error_of(open_all).find("is not an index of bricks"), std::string::npos) << wrong;
    }
}

TEST_F(BricksTest, AnIndexThatContradictsItselfOrItsBricksIsRefused) {
    const std::filesystem::path folder = path("t.bricks"), index = folder / "index.json";
    const HexMesh mesh = make_model("twist", 6);
    const Bricks sound = split_mesh(folder, mesh, {.bricks = 3}).bricks;
    const nlohmann::json list = nlohmann::json::parse(read_bytes(index));
    const auto said_of = [&](const auto& change) {
        nlohmann::json changed = list;
        change(changed);
        std::ofstream(index, std::ios::binary) << changed.dump();
        return error_of([&] {
            const Bricks bricks = open_bricks(folder);
            for (std::size_t b = 0; b < bricks.bricks.size(); ++b) (void)read_brick(bricks, b);
        });
    };
    using Json = nlohmann::json;
    EXPECT_EQ(said_of([](Json&) {}), "no error");
    const auto expect = [&](const char* sentence, const auto& change) {
        const std::string said = said_of(change);
        EXPECT_NE(said.find(sentence), std::string::npos) << said;
    };
    expect("names the brick brick_00000.vtu twice", [](Json& j) { j["bricks"][1] = j["bricks"][0]; });
    expect("has the same hash", [](Json& j) { j["bricks"][1]["hash"] = j["bricks"][0]["hash"]; });
    for (const std::string& name : {std::string("../t.bricks/brick_00000.vtu"), std::string("brick_00000.vtu\0x", 17),
                                    folder.string() + "/brick_00000.vtu", std::string(".."), std::string()}) {
        expect("is not an index of bricks", [&](Json& j) { j["bricks"][0]["file"] = name; });
    }
    expect("says that the mesh has 215 cells, and its bricks own 216", [](Json& j) { j["cells"] = 215; });
    expect("says that the mesh has 344 points, and its bricks own 343", [](Json& j) { j["points"] = 344; });
    expect("other bounds", [](Json& j) { j["bounds"][1][0] = 1e3; });
    expect("other ranges", [](Json& j) { j["fields"][0]["max"][0] = 1e3; });
    expect("other fields", [](Json& j) { j["bricks"][1]["fields"][0]["name"] = "none"; });
    expect("is not an index of bricks", [](Json& j) { j["bricks"][0]["cells"] = 0; });
    expect("is not an index of bricks", [](Json& j) { j["bricks"][0]["stored_cells"] = 1; });
    expect("is not an index of bricks", [](Json& j) { j["bricks"][0]["points"] = std::uint64_t{1} << 63U; });
    expect("is not an index of bricks", [](Json& j) { j["bricks"][0]["reach"] = {{0, 0, 0}, {0, 0, 0}}; });
    // Sums that are right, of numbers that are wrong, are found when the bricks are read.
    expect("has not the counts and bounds that the index gives", [](Json& j) {
        j["bricks"][0]["cells"] = j["bricks"][0]["cells"].get<int>() - 1;
        j["bricks"][1]["cells"] = j["bricks"][1]["cells"].get<int>() + 1;
    });
    expect("has not the counts and bounds that the index gives",
           [](Json& j) { j["bricks"][0]["reach"] = j["bricks"][0]["bounds"]; });
    const std::filesystem::path first = folder / sound.bricks[0].file;
    std::filesystem::rename(first, path("elsewhere.vtu"));
    std::filesystem::create_symlink(path("elsewhere.vtu"), first);
    expect("no regular file", [](Json&) {});
}

TEST_F(BricksTest, NothingElseIsOverwritten) {
    std::filesystem::create_directories(path("mine"));
    (void)write("mine/letter.txt", "dear");
    const HexMesh mesh = make_model("twist", 4);
    EXPECT_NE(error_of([&] { (void)split_mesh(path("mine"), mesh, {.bricks = 2}); }).find("is not a folder of bricks"),
              std::string::npos);
    EXPECT_EQ(read_bytes(path("mine/letter.txt")), "dear");
    std::filesystem::create_directories(path("t.bricks.old0"));
    (void)write("t.bricks.old0/letter.txt", "dear");
    (void)split_mesh(path("t.bricks"), mesh, {.bricks = 2});
    EXPECT_EQ(split_mesh(path("t.bricks"), mesh, {.bricks = 3}).bricks.bricks.size(), 3U);
    EXPECT_EQ(read_bytes(path("t.bricks.old0/letter.txt")), "dear");
    EXPECT_FALSE(std::filesystem::exists(path("t.bricks.old1")));
    EXPECT_NE(error_of([&] { (void)split_mesh(path("m"), mesh, {.bricks = 1000}); }).find("1000 bricks"), std::string::npos);
    EXPECT_NE(error_of([&] {
                  (void)split_mesh(path("m"), mesh, {.bricks = 2, .halo_layers = 0});
              }).find("halo: 0 is out of range (1 to 16)"),
              std::string::npos);
    const Bricks thin = split_mesh(path("thin"), mesh, {.bricks = 2, .halo_layers = 1}).bricks;
    EXPECT_NE(error_of([&] { (void)sample_piece(thin, read_brick(thin, 0)); }).find("split with --halo 3"), std::string::npos);
}

}  // namespace bricks_test
}  // namespace subvol
