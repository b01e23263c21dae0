// SPDX-License-Identifier: Apache-2.0
// The points of bricks, written brick by brick or by shares, are those of the mesh.
#include "subvol/brick_points.h"

#include <gtest/gtest.h>

#include "cut_meshes.h"
#include "lib/temp_folder.h"
#include "subvol/kernel_file.h"
#include "subvol/points_io.h"

namespace subvol {
namespace brick_points_test {

using test::error_of;
using test::irregular_ball;
using test::kCounts;
using test::kShapes;
using test::read_bytes;
using test::tagged;

class BrickPointsTest : public test::TempFolder {};

TEST_F(BrickPointsTest, PointsHaveTheSameBytes) {
    for (const HexMesh& mesh : {irregular_ball(), tagged()}) {
        for (const Correction correction : {Correction::Second, Correction::Full}) {
            const SampleOptions options{.correction = correction};
            write_points(path("whole.ply"), sample_rbf_points(mesh, options).volume);
            const std::string whole = read_bytes(path("whole.ply"));
            (void)write_points_of_bricks(path("memory.ply"), mesh, options);
            EXPECT_TRUE(read_bytes(path("memory.ply")) == whole) << "in memory";
            for (const BrickShape shape : kShapes) {
                for (const std::size_t count : kCounts) {
                    const SplitOptions split{
                        .bricks = count, .shape = shape, .halo_layers = correction == Correction::Full ? 4 : 3};
                    const Bricks bricks = split_mesh(path("m.bricks"), mesh, split).bricks;
                    const auto report = write_points_of_bricks(path("bricks.ply"), bricks, options);
                    EXPECT_EQ(report.points, mesh.points.size());
                    EXPECT_TRUE(read_bytes(path("bricks.ply")) == whole) << count << " bricks of shape " << int(shape);
                }
            }
        }
    }
}

TEST_F(BrickPointsTest, FilesWithLevelsOfDetailHaveTheSameBytes) {
    for (const HexMesh& mesh : {irregular_ball(), tagged()}) {
        for (const Correction correction : {Correction::Gradient, Correction::Second}) {
            const SampleOptions options{.correction = correction};
            write_kernel_file(path("whole.svk"), sample_rbf_points(mesh, options).volume);
            const std::string whole = read_bytes(path("whole.svk"));
            for (const BrickShape shape : kShapes) {
                const Bricks bricks = split_mesh(path("m.bricks"), mesh, {.bricks = 5, .shape = shape}).bricks;
                const std::size_t files = file_count();
                (void)write_points_of_bricks(path("bricks.svk"), bricks, options);
                EXPECT_TRUE(read_bytes(path("bricks.svk")) == whole) << "shape " << int(shape);
                std::filesystem::remove(path("bricks.svk"));
                EXPECT_EQ(file_count(), files);
            }
        }
    }
}

constexpr std::array kSplines{Scheme::CatmullClark, Scheme::Bsxw};

TEST_F(BrickPointsTest, PointsOnTheLimitHaveTheSameBytes) {
    for (const HexMesh& mesh : {irregular_ball(), tagged()}) {
        for (const Scheme scheme : kSplines) {
            for (const Correction correction : {Correction::Second, Correction::Full}) {
                const SampleOptions options{.scheme = {scheme}, .correction = correction};
                write_points(path("whole.ply"), sample_rbf_points(mesh, options).volume);
                const std::string whole = read_bytes(path("whole.ply"));
                for (const BrickShape shape : kShapes) {
                    const SplitOptions split{
                        .bricks = 5, .shape = shape, .halo_layers = correction == Correction::Full ? 5 : 4};
                    const Bricks bricks = split_mesh(path("m.bricks"), mesh, split).bricks;
                    (void)write_points_of_bricks(path("bricks.ply"), bricks, options);
                    EXPECT_TRUE(read_bytes(path("bricks.ply")) == whole) << int(scheme) << " shape " << int(shape);
                }
            }
        }
    }
}

TEST_F(BrickPointsTest, PointsOnTheLimitNeedOneLayerMore) {
    const Bricks bricks = split_mesh(path("m.bricks"), irregular_ball(), {.bricks = 2}).bricks;
    for (const Scheme scheme : kSplines) {
        for (const auto& [correction, said] :
             {std::pair{Correction::Second, "split with --halo 4"}, {Correction::Full, "split with --halo 5"}}) {
            const SampleOptions options{.scheme = {scheme}, .correction = correction};
            EXPECT_NE(error_of([&] { (void)sample_piece(bricks, read_brick(bricks, 0), options); }).find(said),
                      std::string::npos);
        }
    }
}

/// Writes the parts of some shares; returns their names.
std::vector<std::filesystem::path> write_shares(const std::filesystem::path& folder, const Bricks& bricks, std::size_t count,
                                                const SampleOptions& options) {
    std::vector<std::filesystem::path> parts;
    const std::size_t all = bricks.bricks.size();
    for (std::size_t k = 0; k < count; ++k) {
        const BrickShare share{all * k / count, all * (k + 1) / count, "part " + std::to_string(k)};
        parts.push_back(folder / ("part" + std::to_string(k) + ".ply"));
        (void)write_points_of_bricks(parts.back(), bricks, options, &share);
        EXPECT_EQ(read_points_note(parts.back()), share.note);
    }
    return parts;
}

TEST_F(BrickPointsTest, PartsOfThePointsMakeTheSameBytes) {
    const HexMesh mesh = tagged();
    for (const Correction correction : {Correction::Second, Correction::Full}) {
        const SampleOptions options{.correction = correction};
        write_points(path("whole.ply"), sample_rbf_points(mesh, options).volume);
        const Bricks bricks =
            split_mesh(path("m.bricks"), mesh, {.bricks = 5, .shape = BrickShape::Random, .halo_layers = 4}).bricks;
        for (const std::size_t count : kCounts) {  // seven shares of five bricks: some are empty
            const auto parts = write_shares(path("."), bricks, count, options);
            std::size_t points = 0;
            for (const auto& part : parts) points += read_points(part).size();
            EXPECT_EQ(points, mesh.points.size());
            EXPECT_EQ(join_points_of_bricks(path("joined.ply"), parts, bricks.points).points, mesh.points.size());
            EXPECT_TRUE(read_bytes(path("joined.ply")) == read_bytes(path("whole.ply"))) << count << " shares";
        }
    }
}

TEST_F(BrickPointsTest, PartsThatAreNotAllOfAMeshAreRefused) {
    const Bricks bricks = split_mesh(path("m.bricks"), make_model("twist", 5), {.bricks = 3}).bricks;
    auto parts = write_shares(path("."), bricks, 3, {});
    const auto said = [&](std::uint64_t points = 216) {
        return error_of([&] { (void)join_points_of_bricks(path("joined.ply"), parts, points); });
    };
    EXPECT_EQ(said(), "no error");
    std::filesystem::remove(path("joined.ply"));
    EXPECT_NE(said(std::uint64_t{1} << 50).find("cannot be one of parts"), std::string::npos);
    EXPECT_NE(said(100).find("does not exist"), std::string::npos);
    EXPECT_NE(said(300).find("216 of 300 points were found"), std::string::npos);
    std::swap(parts[1], parts[2]);
    EXPECT_EQ(said(), "no error") << "all but the first may have any order";
    parts[1] = parts[2];
    std::filesystem::remove(path("joined.ply"));
    EXPECT_NE(said().find("is in another part, too"), std::string::npos);
    write_points(parts[1], read_points(parts[0]));
    EXPECT_NE(said().find("no property \"number\""), std::string::npos);
    parts[1] = path("nothing.ply");
    const auto join_all = [&] { (void)join_points_of_bricks(path("joined.ply"), parts, 216); };
    EXPECT_NE(error_of(join_all, ErrorCode::Io).find("nothing.ply"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(path("joined.ply")));
}

}  // namespace brick_points_test
}  // namespace subvol
