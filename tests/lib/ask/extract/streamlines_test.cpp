// SPDX-License-Identifier: Apache-2.0
#include "subvol/streamlines.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "subvol/model.h"

namespace subvol {
namespace streamlines_test {

template <class Field>
HexMesh with_vectors(HexMesh mesh, const Field& field) {
    Attribute vectors{"U", 3, {}};
    for (const Vec3& p : mesh.points) {
        const Vec3 v = field(p);
        vectors.values.insert(vectors.values.end(), {v.x, v.y, v.z});
    }
    mesh.attributes = {vectors};
    return mesh;
}

Vec3 turning(const Vec3& p) {
    return {-p.y, p.x, 0};
}

/// A block of 4³ cells about the origin, whose limit is exact.
HexMesh centred_block() {
    HexMesh mesh = test::make_box(4, 4, 4);
    for (Vec3& p : mesh.points) p -= Vec3(2.0);
    return mesh;
}

// Linear fields keep their values on the limit of any mesh, so that the lines of a rotation are circles: here through the faces
// between cells of extraordinary edges, where the parameters of cells do not continue each other.
TEST(Streamlines, OfARotationAreCirclesThroughIrregularCells) {
    const HexMesh mesh = with_vectors(test::irregular(), turning);
    for (const Scheme scheme : {Scheme::Mcq, Scheme::CatmullClark}) {
        const std::vector<Vec3> seeds{{.3, 0, .1}, {0, .6, -.2}, {.5, .5, .4}};
        const Streamlines lines = trace_streamlines(mesh, "U", seeds,
                                                    {.limit = {.scheme = {.kind = scheme}, .tolerance = 1e-9, .max_levels = 14},
                                                     .direction = StreamDirection::Forward,
                                                     .length_world = 100,
                                                     .duration = 2 * std::numbers::pi,
                                                     .tolerance = 1e-9});
        ASSERT_EQ(lines.count(), seeds.size());
        for (std::size_t i = 0; i < lines.count(); ++i) {
            const double radius = glm::length(Vec2(seeds[i]));
            for (std::size_t p = lines.firsts[i]; p < lines.firsts[i + 1]; ++p) {
                const Vec3& x = lines.points[p];
                // of 2 π / h steps, each with an error of 1e-9 of the diagonal and of the limit
                EXPECT_NEAR(glm::length(Vec2(x)), radius, 3e-6);
                EXPECT_NEAR(x.z, seeds[i].z, 3e-6);
                EXPECT_NEAR(std::cos(lines.times[p] + std::atan2(seeds[i].y, seeds[i].x)) * radius, x.x, 3e-6);
            }
            EXPECT_LT(glm::distance(lines.points[lines.firsts[i + 1] - 1], seeds[i]), 1e-5) << "they close";
            EXPECT_EQ(lines.ends[i][0], StreamEnd::Seed);
            EXPECT_EQ(lines.ends[i][1], StreamEnd::Time);
        }
    }
}

// The error of the method falls with the fifth power of the step.
TEST(Streamlines, AreOfTheFifthOrder) {
    const HexMesh mesh = with_vectors(centred_block(), turning);
    const double diagonal = 4 * std::sqrt(3.0), time = 2.4;
    const auto error = [&](double angle) {
        const std::vector<Vec3> seeds{{1, 0, .3}};
        const Streamlines lines = trace_streamlines(mesh, "U", seeds,
                                                    {.limit = {.scheme = {.kind = Scheme::CatmullClark}},
                                                     .direction = StreamDirection::Forward,
                                                     .duration = time,
                                                     .tolerance = 1e-2,
                                                     .longest_step = angle / diagonal});
        return glm::distance(lines.points.back(), {std::cos(time), std::sin(time), .3});
    };
    const double coarse = error(.24), fine = error(.12);
    EXPECT_GT(coarse, 1e-8);  // far above what the places are exact to
    EXPECT_GT(coarse / fine, 25);
    EXPECT_LT(coarse / fine, 45);
}

TEST(Streamlines, OfAUniformFlowAreStraightAndEndAtTheBoundaryOfATwistedBlock) {
    const Vec3 flow(1, .3, -.2);
    const HexMesh mesh = with_vectors(make_model("twist", 6), [&](const Vec3&) { return flow; });
    const std::vector<Vec3> seeds = middles_of_cells(mesh, 20);
    EXPECT_EQ(seeds.size(), 20U);
    const Streamlines lines = trace_streamlines(mesh, "U", seeds);
    ASSERT_EQ(lines.count(), seeds.size());
    Box box;
    for (const Vec3& p : mesh.points) box.add(p);
    const LimitProbe probe(mesh);
    for (std::size_t i = 0; i < lines.count(); ++i) {
        for (std::size_t p = lines.firsts[i]; p < lines.firsts[i + 1]; ++p)
            EXPECT_LT(glm::distance(lines.points[p], seeds[i] + lines.times[p] * flow), 1e-6 * box.diagonal());
        const Vec3 first = lines.points[lines.firsts[i]], last = lines.points[lines.firsts[i + 1] - 1];
        const Vec3 beyond = 1e-5 * box.diagonal() * glm::normalize(flow);
        const ProbeResult found = probe.at(std::vector<Vec3>{first - beyond, first, last, last + beyond});
        EXPECT_FALSE(found.inside(0)) << "the line could go on before line " << i;
        EXPECT_TRUE(found.inside(1) && found.inside(2));
        EXPECT_FALSE(found.inside(3)) << "the line could go on after line " << i;
    }
    EXPECT_EQ(lines.ends_by(StreamEnd::Boundary), 2 * lines.count());
}

TEST(Streamlines, EndWhereTheFieldStandsStill) {
    const HexMesh sink = with_vectors(centred_block(), [](const Vec3& p) { return -p; });
    const std::vector<Vec3> seeds{{1, .5, -.2}};
    const Streamlines lines = trace_streamlines(sink, "U", seeds, {.direction = StreamDirection::Forward});
    EXPECT_EQ(lines.ends[0][1], StreamEnd::Still);
    EXPECT_LT(glm::length(lines.points.back()), 1e-5);
    for (std::size_t p = 0; p < lines.points.size(); ++p) {
        if (glm::length(lines.points[p]) < 1e-3) break;
        EXPECT_NEAR(lines.times[p], std::log(glm::length(seeds[0]) / glm::length(lines.points[p])), 1e-3);
    }
    const HexMesh saddle = with_vectors(centred_block(), [](const Vec3& p) { return Vec3(p.x, -p.y, 0); });
    const std::vector<Vec3> beside{{.01, 1.5, 0}};
    const Streamlines around = trace_streamlines(saddle, "U", beside);
    for (const Vec3& p : around.points) EXPECT_NEAR(p.x * p.y, .015, 1e-4);
    EXPECT_EQ(around.ends_by(StreamEnd::Boundary), 2U);
    const HexMesh still = with_vectors(centred_block(), [](const Vec3&) { return Vec3(0.0); });
    EXPECT_EQ(trace_streamlines(still, "U", seeds).ends_by(StreamEnd::Still), 2U);
}

TEST(Streamlines, AreAsLongAsTheyMayBe) {
    const HexMesh mesh = with_vectors(centred_block(), turning);
    const std::vector<Vec3> seeds{{1, 0, 0}};
    const Streamlines lines = trace_streamlines(mesh, "U", seeds, {.length_world = 2.5, .longest_step = 2e-3});
    EXPECT_NEAR(lines.length(), 5, 1e-3);
    EXPECT_EQ(lines.ends_by(StreamEnd::Length), 2U);
    const Streamlines back = trace_streamlines(mesh, "U", seeds, {.direction = StreamDirection::Backward, .duration = .5});
    EXPECT_EQ(back.times.front(), -.5);
    EXPECT_EQ(back.times.back(), 0);
    EXPECT_LT(glm::distance(back.points.front(), {std::cos(.5), -std::sin(.5), 0}), 1e-5);
}

// Points beside a crack are at one place, but belong to one of its sides.
TEST(Streamlines, DoNotCrossACrack) {
    HexMesh mesh = test::make_box(2, 2, 2);
    const HexMesh other = mesh;
    const auto first = static_cast<Index>(mesh.points.size());
    for (const Vec3& p : other.points) mesh.points.push_back(p + Vec3(2, 0, 0));
    for (auto cell : other.cells) {
        for (Index& corner : cell) corner += first;
        mesh.cells.push_back(cell);
    }
    mesh = with_vectors(std::move(mesh), [](const Vec3&) { return Vec3(1, 0, 0); });
    const std::vector<Vec3> seeds{{.5, 1.1, 1.2}};
    const Streamlines lines = trace_streamlines(mesh, "U", seeds);
    EXPECT_NEAR(lines.points.back().x, 2, 1e-5);
    EXPECT_EQ(lines.ends[0][1], StreamEnd::Boundary);
}

TEST(Streamlines, AreTheSameForAnyNumberOfThreadsAndBesideOthers) {
    const HexMesh mesh = with_vectors(test::irregular(), [](const Vec3& p) { return turning(p) + Vec3(.1, 0, .2 * p.x); });
    const std::vector<Vec3> seeds = parse_seeds("sphere:0,0,0,.8", 12);
    const Streamlines lines = trace_streamlines(mesh, "U", seeds);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const Streamlines again = trace_streamlines(mesh, "U", seeds);
    EXPECT_EQ(lines.points, again.points);
    EXPECT_EQ(lines.times, again.times);
    const Streamlines alone = trace_streamlines(mesh, "U", std::span(seeds).subspan(5, 1));
    const auto begin = lines.points.begin() + static_cast<std::ptrdiff_t>(lines.firsts[5]);
    EXPECT_EQ(alone.points, std::vector<Vec3>(begin, lines.points.begin() + static_cast<std::ptrdiff_t>(lines.firsts[6])));
}

TEST(Streamlines, HaveNoneFromSeedsOutside) {
    const HexMesh mesh = with_vectors(centred_block(), turning);
    const std::vector<Vec3> seeds{{9, 0, 0}, {1, 0, 0}};
    const Streamlines lines = trace_streamlines(mesh, "U", seeds, {.duration = .1});
    EXPECT_EQ(lines.outside, std::vector<std::size_t>{0});
    EXPECT_EQ(lines.seeds, std::vector<std::size_t>{1});
    EXPECT_NE(facts_of(lines).find("warnings"), nullptr);
    test::expect_error(ErrorCode::InvalidInput, "no field", [&] { (void)trace_streamlines(mesh, "V", seeds); });
    HexMesh scalar = mesh;
    test::add_field(scalar, "T", [](const Vec3& p) { return p.x; });
    test::expect_error(ErrorCode::InvalidInput, "another kind", [&] { (void)trace_streamlines(scalar, "T", seeds); });
    test::expect_error(ErrorCode::InvalidInput, "out of range",
                       [&] { (void)trace_streamlines(mesh, "U", seeds, {.tolerance = 1}); });
}

TEST(StreamSeeds, FillWhatTheirTextSays) {
    EXPECT_EQ(parse_seeds("at:1,2,3", 9), (std::vector<Vec3>{{1, 2, 3}}));
    EXPECT_EQ(parse_seeds("line:0,0,0,1,0,0", 3), (std::vector<Vec3>{{0, 0, 0}, {.5, 0, 0}, {1, 0, 0}}));
    Vec3 sum(0.0);
    for (const Vec3& p : parse_seeds("disk:1,0,0,0,0,2,.5", 400)) {
        EXPECT_LE(glm::distance(p, {1, 0, 0}), .5);
        EXPECT_NEAR(p.z, 0, 1e-12);
        sum += p;
    }
    EXPECT_LT(glm::distance(sum / 400.0, {1, 0, 0}), .02) << "they are even";
    for (const Vec3& p : parse_seeds("sphere:1,1,1,2", 100)) EXPECT_LE(glm::distance(p, Vec3(1.0)), 2);
    for (const Vec3& p : parse_seeds("box:0,0,0,1,2,3", 100)) EXPECT_TRUE(p.x > 0 && p.x < 1 && p.y < 2 && p.z > 0 && p.z < 3);
    for (const char* wrong :
         {"", "rim:1,2,3", "at:1,2", "at:1,2,x", "sphere:0,0,0,0", "disk:0,0,0,0,0,0,1", "line:0,0,0,1,1,inf"})
        test::expect_error(ErrorCode::InvalidInput, "seeds", [&] { (void)parse_seeds(wrong, 5); });
    test::expect_error(ErrorCode::InvalidInput, "no place", [&] { (void)parse_seeds("line:0,0,0,1,1,1", 0); });
}

class StreamFiles : public test::TempFolder {};

TEST_F(StreamFiles, HaveALineForEachSeed) {
    const HexMesh mesh = with_vectors(centred_block(), turning);
    const Streamlines lines = trace_streamlines(mesh, "U", parse_seeds("line:.5,0,0,1,0,0", 2), {.duration = .2});
    write_streamlines(path("lines.csv"), lines);
    std::ifstream file(path("lines.csv"));
    std::string row;
    std::getline(file, row);
    EXPECT_EQ(row, "line,seed,time,x,y,z,U.x,U.y,U.z");
    std::size_t rows = 0;
    while (std::getline(file, row)) ++rows;
    EXPECT_EQ(rows, lines.points.size());
    write_streamlines(path("lines.vtp"), lines);
    EXPECT_NE(test::read_bytes(path("lines.vtp")).find("NumberOfLines=\"2\""), std::string::npos);
    test::expect_error(ErrorCode::InvalidInput, "not a format", [&] { write_streamlines(path("lines.stl"), lines); });
}

}  // namespace streamlines_test
}  // namespace subvol
