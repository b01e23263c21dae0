// SPDX-License-Identifier: Apache-2.0
#include "subvol/wavelet_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/detail/vtu_bytes.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/refine.h"
#include "wavelet_format.h"

namespace subvol {
namespace wavelet_file_test {

using test::error_of;
using test::expect_error;

class WaveletFile : public test::TempFolder {};

HexMesh fine_ball(int levels) {
    HexMesh mesh = refine(make_model("ball", 3), {.levels = levels});
    mesh.attributes.clear();
    test::add_field(mesh, "density", [](const Vec3& p) { return BallField::density(p); });
    Attribute flow{"flow", 3, {}};
    for (const Vec3& p : mesh.points) flow.values.insert(flow.values.end(), {std::sin(3 * p.x), p.y * p.z, std::cos(2 * p.z)});
    mesh.attributes.push_back(std::move(flow));
    return mesh;
}

double rms(std::span<const double> a, std::span<const double> b, std::size_t channels) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(a.size() / channels));
}

TEST_F(WaveletFile, IsReadWithinItsTolerance) {
    const HexMesh mesh = fine_ball(2);
    std::uint64_t before = 0;
    for (const double tolerance : {1e-2, 1e-3, 1e-5}) {
        const auto file = path("ball.svw");
        const WaveletFileReport report = write_wavelet_file(file, mesh, {.tolerance = tolerance});
        EXPECT_EQ(report.bytes, std::filesystem::file_size(file));
        EXPECT_GT(report.bytes, before);
        before = report.bytes;
        const ReadResult read = read_mesh(file);
        EXPECT_EQ(read.mesh.cells, mesh.cells);  // a mesh that `refine` made keeps its numbers
        ASSERT_EQ(read.mesh.attributes.size(), 2u);
        EXPECT_EQ(read.fields.size(), 2u);
        const double range = 2;  // the ball's density is within [-1,1]; of the flow the widest channel
        EXPECT_LE(rms(read.mesh.attributes[0].values, mesh.attributes[0].values, 1), tolerance * range);
        EXPECT_NEAR(rms(read.mesh.attributes[1].values, mesh.attributes[1].values, 3),
                    report.arrays[2].rms * 2 * std::sin(1.5) * 1.002, report.arrays[2].rms * 3);
        double sum = 0;
        for (std::size_t p = 0; p < mesh.points.size(); ++p) {
            const Vec3 off = read.mesh.points[p] - mesh.points[p];
            sum += off.x * off.x + off.y * off.y + off.z * off.z;
        }
        EXPECT_LE(std::sqrt(sum / static_cast<double>(mesh.points.size())), tolerance / 10 * 2);  // the ball is 2 wide
        for (const WaveletArrayReport& array : report.arrays) EXPECT_LE(array.rms, tolerance);
        EXPECT_LE(report.arrays[0].rms, tolerance / 10);
    }
}

TEST_F(WaveletFile, OtherSchemesAreReadToo) {
    const HexMesh mesh = fine_ball(2);
    for (const Scheme scheme : {Scheme::Bsxw, Scheme::Linear}) {
        write_wavelet_file(path("a.svw"), mesh, {.scheme = {.kind = scheme}, .tolerance = 1e-4});
        EXPECT_LE(rms(read_mesh(path("a.svw")).mesh.attributes[0].values, mesh.attributes[0].values, 1), 2e-4);
    }
}

TEST_F(WaveletFile, AGridWithOddCountsLosesItsAddedCells) {
    HexMesh mesh = test::make_box(7, 9, 11);
    test::add_field(mesh, "f", [](const Vec3& p) { return std::sin(p.x) + p.y * p.z / 50; });
    const WaveletFileReport report = write_wavelet_file(path("grid.svw"), mesh, {.tolerance = 1e-4});
    EXPECT_GT(report.added_cells, 0u);
    const HexMesh read = read_mesh(path("grid.svw")).mesh;
    ASSERT_EQ(read.cells.size(), mesh.cells.size());
    ASSERT_EQ(read.points.size(), mesh.points.size());
    for (std::size_t p = 0; p < read.points.size(); ++p) {
        const Vec3& x = read.points[p];
        const auto at = [](double c) { return static_cast<Index>(std::lround(c)); };
        EXPECT_NEAR(x.x, at(x.x), .02);  // back at the points of the grid
        const Index own = at(x.x) + 8 * (at(x.y) + 10 * at(x.z));
        EXPECT_NEAR(read.attributes[0].values[p], mesh.attributes[0].values[own], .01);
    }
}

TEST_F(WaveletFile, KeepsTags) {
    HexMesh coarse = test::make_box(2, 2, 2);
    coarse.creases = {{1, 4}, {4, 7}};
    coarse.sharp_faces = {{4, 5, 14, 13}};
    const HexMesh mesh = refine(coarse, {.levels = 2});
    write_wavelet_file(path("tags.svw"), mesh);
    const HexMesh read = read_mesh(path("tags.svw")).mesh;
    EXPECT_EQ(read.creases, mesh.creases);
    EXPECT_EQ(read.sharp_faces.size(), mesh.sharp_faces.size());
}

TEST_F(WaveletFile, AConstantFieldStaysConstant) {
    HexMesh mesh = refine(test::irregular(), {.levels = 2});
    mesh.attributes = {{"one", 1, std::vector<double>(mesh.points.size(), 3.25)}};
    write_wavelet_file(path("one.svw"), mesh);
    const std::vector<double> read = read_mesh(path("one.svw")).mesh.attributes[0].values;
    EXPECT_NEAR(read[0], 3.25, 1e-3);
    for (const double v : read) EXPECT_NEAR(v, read[0], 1e-14);
}

TEST_F(WaveletFile, RefusesWhatItCannotWrite) {
    const HexMesh mesh = fine_ball(1);
    for (const double wrong : {0.0, -1.0, 1.5, std::nan("")}) {
        expect_error(ErrorCode::InvalidInput, "tolerance",
                     [&] { write_wavelet_file(path("a.svw"), mesh, {.tolerance = wrong}); });
    }
    expect_error(ErrorCode::InvalidInput, "not the refinement",
                 [&] { write_wavelet_file(path("a.svw"), test::make_nested_cubes(3)); });
    expect_error(ErrorCode::Io, "", [&] { write_wavelet_file(path("no/a.svw"), mesh); });
    EXPECT_EQ(file_count(), 0u);
}

TEST_F(WaveletFile, DamageIsFound) {
    write_wavelet_file(path("ball.svw"), fine_ball(1), {.tolerance = 1e-2});
    const std::string good = test::read_bytes(path("ball.svw"));
    const auto read = [&](const std::string& bytes) { (void)read_mesh(write("bad.svw", bytes)); };
    EXPECT_NE(error_of([&] { read("hello"); }).find("not a file of wavelets"), std::string::npos);
    for (const std::size_t length : {std::size_t{10}, std::size_t{20}, good.size() / 2, good.size() - 1}) {
        EXPECT_NE(error_of([&] { read(good.substr(0, length)); }), "no error") << length;
    }
    std::string longer = good;
    longer[detail::kWaveletMagic.size() + 6] = 'x';  // a length that no file of this size can have
    EXPECT_NE(error_of([&] { read(longer); }).find("damaged"), std::string::npos);
}

/// A file of zeros is refused before it takes the memory that it asks for.
TEST_F(WaveletFile, ManyBytesFromFewAreRefused) {
    constexpr std::size_t kMany = std::size_t{65} << 20;
    std::string file(detail::kWaveletMagic);
    for (std::size_t k = 0; k < 8; ++k) file += static_cast<char>((kMany >> 8 * k) & 255U);
    file += detail::compressed_numbers(std::string(kMany, '\0'));
    const auto said = [&] { return error_of([&] { (void)read_mesh(write("bomb.svw", file)); }); };
    EXPECT_NE(said().find("the number of levels is 0"), std::string::npos) << said();
    // A length that its few bytes cannot have is refused without looking at them.
    file[detail::kWaveletMagic.size() + 4] = '\x01';  // 4 GB and more
    EXPECT_NE(said().find("at most 8192 times as many"), std::string::npos) << said();
}

/// Few bytes of a compressed file can stand for millions of cells that no mesh has.
TEST_F(WaveletFile, CellsThatNoMeshHasEndTheReading) {
    const auto count = [](std::uint64_t n) {
        std::string bytes;
        for (; n >= 128; n >>= 7) bytes += static_cast<char>((n & 127U) | 128U);
        return bytes + static_cast<char>(n);
    };
    const auto said = [&](std::uint64_t points, std::uint64_t cells, const std::string& first) {
        const std::string start =
            std::string(9, '\0') + '\1' + count(points) + count(cells) + first;  // scheme, tension, levels
        return error_of([&] { (void)detail::mesh_of_wavelets(start + std::string(1 << 20, '\0'), "x.svw"); });
    };
    const std::string cell{'\0', '\2', '\4', '\6', '\10', '\12', '\14', '\16'};  // corners 0 to 7
    EXPECT_NE(said(1000, 1000, "").find("cell 0 has a corner twice"), std::string::npos) << said(1000, 1000, "");
    EXPECT_NE(said(1000, 1000, cell).find("cell 1 is there twice"), std::string::npos) << said(1000, 1000, cell);
    EXPECT_NE(said(1000, 2, cell).find("more than the corners"), std::string::npos) << said(1000, 2, cell);
}

TEST_F(WaveletFile, LongContentsAreReadPieceByPiece) {
    const std::string text(200'000, 'a'), packed = detail::compressed_numbers(text);
    detail::LzmaReader reader(packed);
    std::string all;
    for (auto piece = reader.next(); piece && !piece->empty(); piece = reader.next()) all += *piece;
    EXPECT_EQ(all, text);
    EXPECT_TRUE(reader.next()->empty());
    std::string damaged = packed;
    damaged[packed.size() - 10] ^= 1;
    detail::LzmaReader other(damaged);
    std::optional<std::string_view> piece;
    do piece = other.next();
    while (piece && !piece->empty());
    EXPECT_FALSE(piece) << "the checksum is compared";
}

/// Contents that anyone could compress: they are refused with a sentence, or they are a mesh.
TEST_F(WaveletFile, HostileContentsAreRefused) {
    write_wavelet_file(path("ball.svw"), fine_ball(1), {.tolerance = 1e-2});
    const std::string file = test::read_bytes(path("ball.svw"));
    const std::size_t head = detail::kWaveletMagic.size() + 8;
    std::uint64_t length = 0;
    for (std::size_t k = 8; k-- > 0;) length = length << 8 | static_cast<unsigned char>(file[detail::kWaveletMagic.size() + k]);
    const std::string good =
        detail::decompressed(detail::Compressor::Lzma, std::string_view(file).substr(head), length).value();
    const auto attempt = [](const std::string& contents) {
        try {
            validate(detail::mesh_of_wavelets(contents, "x.svw"));
            return true;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << error.what();
            EXPECT_NE(std::string(error.what()).find("x.svw"), std::string::npos) << error.what();
            return false;
        }
    };
    EXPECT_TRUE(attempt(good));
    for (std::size_t length_kept = 0; length_kept < good.size(); length_kept += 1 + good.size() / 61) {
        EXPECT_FALSE(attempt(good.substr(0, length_kept))) << length_kept;
    }
    EXPECT_FALSE(attempt(good + "x"));
    std::mt19937 random(11);
    for (int round = 0; round < 300; ++round) {
        std::string bad = good;
        const std::size_t at =
            round % 2 == 0 ? random() % 200 : random() % bad.size();  // most of what can go wrong is at the start
        bad[at] = static_cast<char>(random());
        attempt(bad);
    }
}

}  // namespace wavelet_file_test
}  // namespace subvol
