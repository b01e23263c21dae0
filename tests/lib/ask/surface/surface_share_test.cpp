// SPDX-License-Identifier: Apache-2.0
// Shares of a surface, put together, have the bits of the surface that is made in one piece.
#include "subvol/detail/surface_share.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/model.h"

namespace subvol {
namespace surface_share_test {

using test::error_of;
using testing::HasSubstr;

std::vector<std::string> shares_of(const HexMesh& mesh, const SurfaceOptions& options, int count) {
    std::vector<std::string> shares;
    for (int number = 1; number <= count; ++number) {
        shares.push_back(detail::share_of_surface(mesh, "f", options, {number, count}).bytes);
    }
    return shares;
}

std::vector<std::string> names(std::size_t count) {
    std::vector<std::string> names;
    for (std::size_t part = 0; part < count; ++part) names.push_back("share " + std::to_string(part));
    return names;
}

LimitSurface joined(const std::vector<std::string>& shares) {
    return detail::join_surface(shares, names(shares.size()));
}

void expect_same(const LimitSurface& found, const LimitSurface& whole) {
    EXPECT_EQ(found.surface.triangles, whole.surface.triangles);
    EXPECT_EQ(found.surface.points, whole.surface.points);
    EXPECT_EQ(found.normals, whole.normals);
    ASSERT_EQ(found.places.size(), whole.places.size());
    for (std::size_t p = 0; p < whole.places.size(); ++p) {
        EXPECT_EQ(found.places[p].cell, whole.places[p].cell);
        EXPECT_EQ(found.places[p].uvw, whole.places[p].uvw);
    }
    ASSERT_EQ(found.fields.size(), whole.fields.size());
    for (std::size_t f = 0; f < whole.fields.size(); ++f) {
        EXPECT_EQ(found.fields[f].name, whole.fields[f].name);
        EXPECT_EQ(found.fields[f].values, whole.fields[f].values);
        EXPECT_EQ(found.fields[f].gradients, whole.fields[f].gradients);
    }
    EXPECT_EQ(found.report.level, whole.report.level);
    EXPECT_EQ(found.report.deviation_world, whole.report.deviation_world);
    EXPECT_EQ(found.report.converged, whole.report.converged);
    EXPECT_EQ(found.report.cells, whole.report.cells);
    EXPECT_EQ(found.report.mended, whole.report.mended);
    EXPECT_EQ(found.report.volume, whole.report.volume);
    EXPECT_EQ(found.report.euler, whole.report.euler);
}

HexMesh ball(int resolution) {
    HexMesh mesh = make_model("ball", resolution);
    mesh.attributes.clear();
    test::jitter(mesh, 0.08 / resolution, 3);
    test::add_field(mesh, "f", [](const Vec3& x) { return x.x * x.x + 2 * x.y * x.y + x.z + 0.3 * x.x * x.y; });
    test::add_field(mesh, "g", [](const Vec3& x) { return x.y; });
    return mesh;
}

TEST(SurfaceShare, SharesHaveTheBitsOfTheWhole) {
    const HexMesh mesh = ball(3);
    for (SurfaceOptions options :
         {SurfaceOptions{.boundary = true}, SurfaceOptions{.isos = {0.3}}, SurfaceOptions{.isos = {0.1, 0.6}, .cap = true},
          SurfaceOptions{.scheme = {.kind = Scheme::CatmullClark, .crease_angle_deg = 40}, .isos = {0.3}, .boundary = true},
          SurfaceOptions{.isos = {0.3}, .improve = false}}) {
        options.tolerance = 1e-2;
        const LimitSurface whole = limit_surface(mesh, "f", options);
        ASSERT_GT(whole.surface.triangles.size(), 100U);
        for (const int count : {1, 2, 7}) {
            SCOPED_TRACE(count);
            expect_same(joined(shares_of(mesh, options, count)), whole);
        }
    }
}

// Of surfaces that pass many cells some cells are looked at, until the level is known.
TEST(SurfaceShare, SharesOfManyCellsHaveTheBitsOfTheWhole) {
    HexMesh mesh = test::make_box(46, 46, 1);
    test::jitter(mesh, 0.1, 3);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.z + 0.2 * std::sin(0.6 * p.x) * std::cos(0.5 * p.y); });
    for (const SurfaceOptions& options :
         {SurfaceOptions{.isos = {0.5}, .tolerance = 3e-5}, SurfaceOptions{.boundary = true, .tolerance = 4e-4}}) {
        const LimitSurface whole = limit_surface(mesh, "f", options);
        ASSERT_GT(whole.report.cells, 2048U) << "all are looked at";
        EXPECT_EQ(whole.report.level, 2);
        EXPECT_TRUE(whole.report.converged);
        expect_same(joined(shares_of(mesh, options, 3)), whole);
    }
}

TEST(SurfaceShare, MoreSharesThanCells) {
    HexMesh mesh = test::make_box(2, 2, 1);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    const SurfaceOptions options{.boundary = true};
    expect_same(joined(shares_of(mesh, options, 9)), limit_surface(mesh, "f", options));
    EXPECT_TRUE(joined(shares_of(mesh, {.isos = {7}}, 3)).surface.triangles.empty());
}

TEST(SurfaceShare, RefusesBytesThatAreNoShares) {
    const HexMesh mesh = ball(2);
    const std::vector<std::string> shares = shares_of(mesh, {.isos = {0.3}, .tolerance = 2e-2}, 2);
    std::size_t refused = 0;
    for (std::size_t length = 0; length < shares[1].size(); length += 1 + shares[1].size() / 200) {
        const std::string error = error_of([&] { (void)joined({shares[0], shares[1].substr(0, length)}); });
        EXPECT_THAT(error, HasSubstr("share 1")) << length;
        ++refused;
    }
    EXPECT_GT(refused, 100U);
    const std::vector<std::string> other = shares_of(mesh, {.isos = {0.3}, .tolerance = 3e-2}, 2);
    EXPECT_THAT(error_of([&] { (void)joined({shares[0], other[1]}); }), HasSubstr("another surface"));
    // Any byte may be wrong: an error, or another surface, but no damage.
    for (std::size_t at = 0; at < shares[0].size(); at += 1 + shares[0].size() / 300) {
        std::string wrong = shares[0];
        wrong[at] = static_cast<char>(wrong[at] ^ 0x85);
        try {
            (void)joined({wrong, shares[1]});
        } catch (const std::exception&) {
        }
    }
}

class SurfaceShareFiles : public test::TempFolder {};

TEST_F(SurfaceShareFiles, AreReadAsTheyWereWritten) {
    const std::string bytes = detail::share_of_surface(ball(2), "f", {.boundary = true}, {1, 2}).bytes;
    detail::write_surface_share(path("a.svshare"), {"a note", bytes});
    const detail::SurfaceShareFile read = detail::read_surface_share(path("a.svshare"));
    EXPECT_EQ(read.note, "a note");
    EXPECT_EQ(read.bytes, bytes);

    std::ifstream in(path("a.svshare"), std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(in), {}};
    const auto refused = [&](const std::string& changed) {
        std::ofstream(path("b.svshare"), std::ios::binary) << changed;
        return error_of([&] { (void)detail::read_surface_share(path("b.svshare")); });
    };
    EXPECT_THAT(refused(""), HasSubstr("is not a share of a surface"));
    EXPECT_THAT(refused("ply\n" + whole), HasSubstr("is not a share of a surface"));
    for (const std::size_t length : {30u, 40u, 1000u}) EXPECT_THAT(refused(whole.substr(0, length)), HasSubstr("is cut off"));
    EXPECT_THAT(refused(whole.substr(0, whole.size() - 1)), HasSubstr("is cut off"));
    EXPECT_THAT(refused(whole + "x"), HasSubstr("is damaged"));
    std::string wrong = whole;
    wrong[whole.size() / 2] = static_cast<char>(wrong[whole.size() / 2] ^ 1);
    EXPECT_THAT(refused(wrong), HasSubstr("is damaged"));
}

}  // namespace surface_share_test
}  // namespace subvol
