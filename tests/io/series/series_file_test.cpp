// SPDX-License-Identifier: Apache-2.0
#include "subvol/series_file.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <set>

#include "io/series/series_parts.h"
#include "lib/expect_error.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "series_format.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_series.h"
#include "subvol/model.h"
#include "subvol/refine.h"
#include "subvol/topology.h"
#include "value_prediction.h"

namespace subvol {
namespace series_file_test {

using test::expect_error;

class SeriesFile : public test::TempFolder {};

/// A step of a ball that swells, with a wave, a flow, a fraction in bounds, a constant and noise.
HexMesh ball_at(std::size_t step) {
    const double t = static_cast<double>(step);
    HexMesh mesh = refine(make_model("ball", 3), {.levels = 1});
    mesh.attributes.clear();
    Attribute wave{"wave", 1, {}}, flow{"flow", 3, {}}, fraction{"fraction", 1, {}, {{0, 1}}}, constant{"constant", 1, {}},
        noise{"noise", 1, {}};
    std::mt19937 random(5 + static_cast<unsigned>(step));
    for (Vec3& p : mesh.points) {
        wave.values.push_back(std::sin(3 * p.x + t / 4));
        flow.values.insert(flow.values.end(), {p.y * t, -p.x * t, 0});
        fraction.values.push_back(p.z < t / 10 ? 1 : 0);
        constant.values.push_back(1.0 / 3);
        noise.values.push_back(static_cast<double>(random()));
        p *= 1 + t / 50;
    }
    mesh.attributes = {wave, flow, fraction, constant, noise};
    return mesh;
}

MeshSteps steps_of(std::size_t count, const std::function<HexMesh(std::size_t)>& read = ball_at) {
    MeshSteps steps{{}, read};
    for (std::size_t k = 0; k < count; ++k) steps.times.push_back(static_cast<double>(k) / 2);
    return steps;
}

double range(const std::vector<double>& values) {
    const auto [min, max] = std::ranges::minmax(values);
    return max - min;
}

double most_difference(const std::vector<double>& a, const std::vector<double>& b) {
    EXPECT_EQ(a.size(), b.size());
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
    return most;
}

TEST_F(SeriesFile, EveryValueOfEveryStepIsWithinTheMostError) {
    constexpr std::size_t kSteps = 7;
    std::uint64_t before = 0;
    for (const double tolerance : {1e-2, 1e-4, 1e-9}) {
        const SeriesFileReport report =
            write_series_file(path("a.svw"), steps_of(kSteps), {.tolerance = tolerance, .key_steps = 3});
        EXPECT_EQ(report.bytes, std::filesystem::file_size(path("a.svw")));
        EXPECT_GT(report.bytes, before);
        before = report.bytes;
        EXPECT_EQ(report.key_steps, 3u);
        EXPECT_EQ(report.meshes, 1u);
        const MeshSeries series = open_series(path("a.svw"));
        ASSERT_EQ(series.size(), kSteps);
        EXPECT_EQ(series.times[3], 1.5);
        const Vec3 size = bounds(ball_at(0)).size();
        const double length = std::max({size.x, size.y, size.z});
        const double flow_range = range(ball_at(kSteps - 1).attributes[1].values);
        for (const std::size_t k : {4u, 0u, 6u, 2u}) {  // in any order
            const HexMesh mesh = ball_at(k), read = read_mesh(path("a.svw"), {.step = k}).mesh;
            EXPECT_EQ(read.cells, mesh.cells);
            EXPECT_EQ(read.time, series.times[k]);
            ASSERT_EQ(read.attributes.size(), mesh.attributes.size());
            EXPECT_LE(most_difference(read.attributes[0].values, mesh.attributes[0].values), tolerance * 2);
            EXPECT_LE(most_difference(read.attributes[1].values, mesh.attributes[1].values), tolerance * flow_range);
            EXPECT_LE(most_difference(read.attributes[4].values, mesh.attributes[4].values), tolerance * 4294967295.0);
            EXPECT_EQ(read.attributes[2].values, mesh.attributes[2].values) << "0 and 1 are the ends of the range";
            EXPECT_EQ(read.attributes[2].bounds, mesh.attributes[2].bounds);
            EXPECT_EQ(read.attributes[3].values, mesh.attributes[3].values) << "a constant is exact";
            for (std::size_t p = 0; p < mesh.points.size(); ++p) {
                for (int c = 0; c < 3; ++c) EXPECT_LE(std::abs(read.points[p][c] - mesh.points[p][c]), tolerance / 10 * length);
            }
        }
        for (const SeriesArrayReport& array : report.arrays) EXPECT_LE(array.max, tolerance);
        EXPECT_EQ(report.arrays[4].bytes, 0u) << "a constant takes nothing";
    }
}

TEST_F(SeriesFile, WithoutAStepTheLastOneIsRead) {
    write_series_file(path("a.svw"), steps_of(3));
    const ReadResult read = read_mesh(path("a.svw"));
    EXPECT_EQ(read.steps, 3u);
    EXPECT_EQ(read.step, 2u);
    EXPECT_EQ(read.fields.size(), 5u);
    EXPECT_EQ(read_mesh(path("a.svw"), {.time = .6}).step, 1u);
    expect_error(ErrorCode::InvalidInput, "step 3", [&] { (void)read_mesh(path("a.svw"), {.step = 3}); });
}

TEST_F(SeriesFile, StepsAreReadWithoutTheOthers) {
    write_series_file(path("a.svw"), steps_of(6), {.key_steps = 2});
    const HexMesh good = read_mesh(path("a.svw"), {.step = 2}).mesh;
    std::string bytes = test::read_bytes(path("a.svw"));
    // What lies between the head and the middle, but for the mesh, are steps 0 and 1.
    const HexMesh five = read_mesh(path("a.svw"), {.step = 5}).mesh;
    const std::size_t third = bytes.size() / 3;
    for (std::size_t k = third; k < third + 40; ++k) bytes[k] = static_cast<char>(~bytes[k]);
    std::ofstream(path("b.svw"), std::ios::binary) << bytes;
    EXPECT_EQ(read_mesh(path("b.svw"), {.step = 5}).mesh.attributes[0].values, five.attributes[0].values);
    std::size_t refused = 0;
    for (std::size_t k = 0; k < 6; ++k) {
        try {
            (void)read_mesh(path("b.svw"), {.step = k});
        } catch (const Error&) {
            ++refused;
        }
    }
    EXPECT_GE(refused, 1u);
    EXPECT_LE(refused, 2u) << "a step and what depends on it";
    EXPECT_EQ(good.attributes.size(), 5u);
}

TEST_F(SeriesFile, ValuesThatAreNotFiniteAreKept) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
    HexMesh mesh = ball_at(1);
    mesh.points.insert(mesh.points.end(), {Vec3(kNan, 0, kInf), Vec3(1)});  // no cell uses them
    for (Attribute& a : mesh.attributes) a.values.insert(a.values.end(), 2 * static_cast<std::size_t>(a.channels), -kInf);
    const SeriesFileReport report = write_series_file(path("a.svw"), mesh, {.tolerance = 1e-3});
    EXPECT_EQ(report.arrays[1].exact, 2u);
    const HexMesh read = read_mesh(path("a.svw")).mesh;
    ASSERT_EQ(read.points.size(), mesh.points.size());
    EXPECT_TRUE(std::isnan(read.points[read.points.size() - 2].x));
    EXPECT_EQ(read.points[read.points.size() - 2].z, kInf);
    EXPECT_EQ(read.attributes[0].values.back(), -kInf);
    EXPECT_LE(std::abs(read.attributes[0].values.front() - mesh.attributes[0].values.front()), 2e-3);
}

TEST_F(SeriesFile, OtherCellsAndFieldsBeginAnew) {
    const auto changing = [](std::size_t k) {
        HexMesh mesh = k < 2 ? ball_at(k) : test::make_box(3, 3, 3);
        if (k == 1) mesh.attributes.erase(mesh.attributes.begin());
        if (k == 2) mesh.attributes.push_back({"wave", 1, std::vector<double>(mesh.points.size(), .5)});
        return mesh;
    };
    const SeriesFileReport report = write_series_file(path("a.svw"), steps_of(4, changing), {.tolerance = 1e-3});
    EXPECT_EQ(report.meshes, 2u);
    for (std::size_t k = 0; k < 4; ++k) {
        const HexMesh mesh = changing(k), read = read_mesh(path("a.svw"), {.step = k}).mesh;
        EXPECT_EQ(read.cells, mesh.cells);
        std::set<std::string> names, read_names;
        for (const Attribute& a : mesh.attributes) names.insert(a.name);
        for (const Attribute& a : read.attributes) read_names.insert(a.name);
        EXPECT_EQ(read_names, names) << k;
    }
}

TEST_F(SeriesFile, TheCellsOfARefinedMeshTakeWhatThoseOfItsControlMeshDo) {
    const HexMesh coarse = make_model("ball", 3);
    const std::uint64_t once = write_series_file(path("a.svw"), refine(coarse, {.levels = 1})).mesh_bytes;
    const HexMesh fine = refine(coarse, {.levels = 2});
    EXPECT_EQ(write_series_file(path("a.svw"), fine).mesh_bytes, once);
    EXPECT_EQ(read_mesh(path("a.svw")).mesh.cells, fine.cells);
}

TEST_F(SeriesFile, CreasesAndSharpFacesAreKept) {
    HexMesh mesh = make_model("ball", 4);
    tag_creases(mesh, 10);
    ASSERT_FALSE(mesh.creases.empty());
    write_series_file(path("a.svw"), mesh);
    EXPECT_EQ(read_mesh(path("a.svw")).mesh.creases, mesh.creases);
}

TEST_F(SeriesFile, TheSameBitsForAnyNumberOfThreads) {
    write_series_file(path("all.svw"), steps_of(3));
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    write_series_file(path("one.svw"), steps_of(3));
    EXPECT_EQ(test::read_bytes(path("one.svw")), test::read_bytes(path("all.svw")));
}

/// Trilinear fields have no residual in cells but at corners where these begin; what does not change takes no bytes.
TEST_F(SeriesFile, WhatIsPredictedTakesFewBytes) {
    HexMesh mesh = test::make_box(12, 12, 12);
    mesh.attributes.clear();
    test::add_field(mesh, "linear", [](const Vec3& p) { return p.x + 2 * p.y - p.z; });
    test::add_field(mesh, "smooth", [](const Vec3& p) { return std::sin(p.x / 6) * std::cos((p.y + p.z) / 12); });
    std::mt19937 random(3);
    test::add_field(mesh, "noise", [&](const Vec3&) { return static_cast<double>(random()); });
    const SeriesFileReport one = write_series_file(path("a.svw"), mesh, {.tolerance = 1e-5});
    EXPECT_LT(6 * one.arrays[1].bytes, mesh.points.size());
    EXPECT_LT(one.arrays[2].bytes, one.arrays[3].bytes / 2);
    EXPECT_GT(one.arrays[3].bytes, 2 * mesh.points.size()) << "16.6 bits of noise";
    const SeriesFileReport many =
        write_series_file(path("b.svw"), steps_of(8, [&](std::size_t) { return mesh; }), {.tolerance = 1e-5});
    EXPECT_LT(many.bytes, one.bytes + 8 * 200);
}

/// Each order names each point once, and predicts from points that it has named before; weights add up to the divisor.
TEST(ValuePrediction, RowsUseEarlierPoints) {
    for (const HexMesh& mesh : {make_model("ball", 4), test::make_nested_cubes(3), make_model("car", 0),
                                refine(make_model("fan", 0), {.levels = 1})}) {
        const Topology topology = build_topology(mesh);
        for (const auto& prediction : {detail::predict_by_number(mesh.points.size()), detail::predict_in_cells(topology),
                                       detail::predict_between_sheets(topology)}) {
            ASSERT_EQ(prediction.order.size(), mesh.points.size());
            std::vector<std::uint8_t> known(mesh.points.size(), 0);
            for (std::size_t i = 0; i < prediction.order.size(); ++i) {
                int sum = 0;
                for (std::size_t k = prediction.offsets[i]; k < prediction.offsets[i + 1]; ++k) {
                    EXPECT_TRUE(known[prediction.points[k]] != 0);
                    sum += prediction.weights[k];
                }
                EXPECT_EQ(sum, i == 0 ? 0 : prediction.parts[i]);
                EXPECT_TRUE(known[prediction.order[i]] == 0);
                known[prediction.order[i]] = 1;
            }
        }
    }
}

/// In a grid most points lie between joined sheets, and polynomials of degree 3 are met inside.
TEST(ValuePrediction, CubicsAreMetBetweenSheets) {
    HexMesh mesh = test::make_box(16, 16, 16);
    const auto prediction = detail::predict_between_sheets(build_topology(mesh));
    std::vector<std::int64_t> numbers;
    for (const Vec3& p : mesh.points) {
        const auto i = std::llround(p.x);
        numbers.push_back(16 * 3 * i * i * i);
    }
    std::size_t met = 0;
    for (std::size_t i = 0; i < prediction.order.size(); ++i)
        met += prediction.predict(i, numbers) == numbers[prediction.order[i]] ? 1 : 0;
    EXPECT_GT(met, mesh.points.size() * 7 / 10);
}

TEST(ValuePrediction, RoundsDownwardsOnEitherSideOfZero) {
    detail::ValuePrediction p;
    p.order = {1};
    p.offsets = {0, 1};
    p.points = {0};
    p.weights = {1};
    p.parts = {16};
    const auto at = [&](std::int64_t n) { return p.predict(0, std::vector<std::int64_t>{n, 0}); };
    EXPECT_EQ(at(7), 0);
    EXPECT_EQ(at(8), 1);  // a half goes up
    EXPECT_EQ(at(-8), 0);
    EXPECT_EQ(at(-9), -1);
    EXPECT_EQ(at(-24), -1);
    EXPECT_EQ(at(-25), -2);
}

TEST_F(SeriesFile, Mistakes) {
    const auto refused = [&](const MeshSteps& steps, const SeriesFileOptions& options, const char* what) {
        expect_error(ErrorCode::InvalidInput, what, [&] { (void)write_series_file(path("a.svw"), steps, options); });
        EXPECT_FALSE(std::filesystem::exists(path("a.svw")));
    };
    for (const double wrong : {0.0, -1.0, 2.0, std::nan("")}) {
        refused(steps_of(1), {.tolerance = wrong}, "max_error");
        refused(steps_of(1), {.point_tolerance = wrong}, "max_point_error");
    }
    refused(steps_of(1), {.key_steps = 0}, "key_steps");
    refused(steps_of(0), {}, "no step");
    refused({{1, 1}, ball_at}, {}, "ascend");
    HexMesh loose = test::make_box(2, 2, 2);
    loose.attributes.clear();
    loose.points.resize(8 * loose.cells.size() + 1);
    refused(steps_of(1, [&](std::size_t) { return loose; }), {}, "without_unused_points");
}

/// Every damage is a sentence that names the file, or leaves a valid mesh.
TEST_F(SeriesFile, DamagedFilesAreRefused) {
    write_series_file(path("a.svw"), steps_of(4), {.tolerance = 1e-2, .key_steps = 2});
    const std::string good = test::read_bytes(path("a.svw"));
    const auto attempt = [&](const std::string& bytes) {
        std::ofstream(path("b.svw"), std::ios::binary) << bytes;
        bool all = true;
        for (std::size_t k = 0; k < 4; ++k) {
            try {
                validate(read_mesh(path("b.svw"), {.step = k}).mesh);
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << error.what();
                EXPECT_NE(std::string(error.what()).find("b.svw"), std::string::npos) << error.what();
                all = false;
            }
        }
        return all;
    };
    EXPECT_TRUE(attempt(good));
    for (std::size_t length = 0; length < good.size(); length += 1 + good.size() / 41)
        EXPECT_FALSE(attempt(good.substr(0, length)));
    std::mt19937 random(17);
    const char* rounds = std::getenv("SUBVOL_MUTATIONS");
    for (int round = 0; round < (rounds ? std::atoi(rounds) : 150); ++round) {
        std::string bad = good;
        const std::size_t at = round % 2 == 0 ? random() % detail::kSeriesHead : random() % bad.size();
        bad[at] = static_cast<char>(random());
        attempt(bad);
    }
}

TEST_F(SeriesFile, StepsThatFitIntoMemoryAreReadOnce) {
    std::size_t reads = 0;
    const auto read = [&](std::size_t k) {
        ++reads;
        return ball_at(k);
    };
    write_series_file(path("a.svw"), steps_of(4, read), {});
    EXPECT_EQ(reads, 4u);
}

TEST_F(SeriesFile, TagsPatchesAndSetsAreKept) {
    HexMesh box = test::make_box(4, 4, 4);
    box.sharp_faces = {{box.cells[0][1], box.cells[0][2], box.cells[0][6], box.cells[0][5]}};
    box.creases = {{box.cells[1][0], box.cells[1][1]}};
    HexMesh part = box;
    part.cells.resize(40);
    part.sharp_faces.clear();
    part.creases.clear();
    const MeshSets of_box{{{"inlet", {{0, 4}, {63, 1}, {7, 5}}}, {"empty", {}}}, {{"core", {1, 2, 60}}}},
        of_part{{}, {{"rest", {39}}}};
    std::size_t last = 0;
    const MeshSteps steps{{0, 1, 2},
                          [&](std::size_t k) {
                              last = k;
                              return k < 2 ? box : part;
                          },
                          [&] { return last < 2 ? of_box : of_part; }};
    write_series_file(path("a.svw"), steps, {});
    for (const std::size_t k : {0u, 1u, 2u}) {
        const ReadResult read = read_mesh(path("a.svw"), {.step = k});
        const MeshSets& sets = k < 2 ? of_box : of_part;
        ASSERT_EQ(read.sets.patches.size(), sets.patches.size());
        for (std::size_t p = 0; p < sets.patches.size(); ++p) {
            EXPECT_EQ(read.sets.patches[p].name, sets.patches[p].name);
            EXPECT_EQ(read.sets.patches[p].sides, sets.patches[p].sides);
        }
        ASSERT_EQ(read.sets.sets.size(), 1u);
        EXPECT_EQ(read.sets.sets[0].name, sets.sets[0].name);
        EXPECT_EQ(read.sets.sets[0].cells, sets.sets[0].cells);
        EXPECT_EQ(read.mesh.creases, k < 2 ? box.creases : part.creases);
        EXPECT_EQ(read.mesh.sharp_faces, k < 2 ? box.sharp_faces : part.sharp_faces);
    }
}

/// The first step is a key step and the last one depends on all, so that each byte of the file is read.
TEST_F(SeriesFile, NoBitOfASmallFileIsTurnedSilently) {
    const auto step = [](std::size_t k) {
        HexMesh mesh = test::make_box(1, 1, 1);
        mesh.attributes = {{"f", 1, {}, {{0, 9}}}};
        for (std::size_t p = 0; p < 8; ++p) mesh.attributes[0].values.push_back(static_cast<double>((p * p + k) % 7));
        return mesh;
    };
    write_series_file(path("a.svw"), steps_of(2, step), {.tolerance = 1e-2});
    const std::string good = test::read_bytes(path("a.svw"));
    EXPECT_EQ(read_mesh(path("a.svw")).mesh.points.size(), 8u);
    std::size_t silent = 0;
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        std::string bad = good;
        bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << bit % 8));
        std::ofstream(path("b.svw"), std::ios::binary) << bad;
        try {
            (void)read_mesh(path("b.svw"));
            ++silent;
        } catch (const Error& error) {
            ASSERT_EQ(error.code(), ErrorCode::InvalidInput) << error.what();
        }
    }
    EXPECT_EQ(silent, 0u) << "of " << 8 * good.size();
}

/// What no hash finds: files that are packed as a writer would, but that say what is not so.
class SeriesLies : public SeriesFile {
protected:
    void SetUp() override {
        SeriesFile::SetUp();
        const auto step = [](std::size_t k) {
            HexMesh mesh = test::make_box(2, 2, 2);
            mesh.attributes.clear();
            test::add_field(mesh, "T", [&](const Vec3& p) { return p.x + p.y * static_cast<double>(k); });
            mesh.attributes[0].bounds = {{0, 9}};
            return mesh;
        };
        MeshSteps steps = steps_of(3, step);
        steps.sets = [] { return MeshSets{{{"inlet", {{0, 1}, {3, 5}}}}, {{"core", {1, 2, 4}}}}; };
        write_series_file(path("a.svw"), steps, {.tolerance = 1e-2});
        parts_ = test::SeriesParts::of(test::read_bytes(path("a.svw")), 27);
        index_ = test::SeriesParts::index_of(parts_.index_of_packed());
    }

    /// The sentence with which the file is refused.
    [[nodiscard]] std::string wrong() const {
        std::ofstream(path("b.svw"), std::ios::binary) << parts_.packed();
        return test::error_of([&] { (void)read_mesh(path("b.svw")); });
    }
    [[nodiscard]] std::string wrong_index() {
        parts_.index_text = test::SeriesParts::text_of(index_);
        return wrong();
    }
    /// A mesh part: so many levels of a box of 4 x 2 x 2 cells.
    static std::string box_part(std::uint64_t levels, const MeshSets& sets) {
        HexMesh box = test::make_box(4, 2, 2);
        box.points.assign(box.points.size(), Vec3(0));
        detail::Bytes out;
        out.number(levels);
        detail::put_mesh(box, out);
        out.number(sets.patches.size());
        for (const Patch& patch : sets.patches) {
            out.text(patch.name);
            out.number(patch.sides.size());
            std::int64_t last = 0;
            for (const CellSide& side : patch.sides) {
                const std::int64_t number = 6 * std::int64_t{side.cell} + side.side;
                out.number(detail::folded(number - last));
                last = number;
            }
        }
        out.number(0);
        return out.all();
    }

    test::SeriesParts parts_;
    detail::SeriesIndex index_;
};

TEST_F(SeriesLies, FilesOfTheFirstVersionAreRead) {
    std::ofstream(path("b.svw"), std::ios::binary) << parts_.packed_as_first();
    EXPECT_LT(std::filesystem::file_size(path("b.svw")), std::filesystem::file_size(path("a.svw")));
    for (const std::size_t k : {0u, 1u, 2u}) {
        const ReadResult first = read_mesh(path("b.svw"), {.step = k}), now = read_mesh(path("a.svw"), {.step = k});
        EXPECT_EQ(first.mesh.points, now.mesh.points);
        EXPECT_EQ(first.mesh.attributes[0].values, now.mesh.attributes[0].values);
        EXPECT_EQ(first.sets.patches[0].sides, now.sets.patches[0].sides);
    }
}

TEST_F(SeriesLies, StepsThatNameTheSameBytes) {
    index_.steps[2].place = index_.steps[1].place;
    EXPECT_NE(wrong_index().find("where another one is"), std::string::npos) << wrong_index();
    SetUp();
    index_.steps[1].place.length -= 1;  // leaves a byte to none
    EXPECT_NE(wrong_index().find("where none does"), std::string::npos) << wrong_index();
}

TEST_F(SeriesLies, NothingFollowsTheIndex) {
    std::ofstream(path("b.svw"), std::ios::binary) << parts_.packed() << 'x';
    const std::string said = test::error_of([&] { (void)read_mesh(path("b.svw")); });
    EXPECT_NE(said.find("not the end of the file"), std::string::npos) << said;
}

TEST_F(SeriesLies, StepsFarFromAKeyStep) {
    for (std::size_t k = 3; k < 1100; ++k) {
        index_.steps.push_back(index_.steps[1]);  // which needs one step before
        index_.steps.back().time = static_cast<double>(k);
        parts_.steps.push_back(parts_.steps[1]);
    }
    parts_.index = index_;
    EXPECT_NE(wrong().find("step 1000 depends on 1000 others"), std::string::npos) << wrong();
    parts_.index.steps[1].key = false;
    parts_.index.steps[999].key = true;
    parts_.steps[999] = parts_.steps[0];
    EXPECT_EQ(wrong(), "no error");
}

TEST_F(SeriesLies, AKeyIsOneOrNone) {
    std::string text = parts_.index_of_packed();
    // The first step has mesh 0, is a key step, and has its place.
    detail::Bytes first;
    first.number(0);
    first.number(1);
    first.number(index_.steps[0].place.place);
    const std::size_t at = text.rfind(first.all());
    ASSERT_NE(at, std::string::npos);
    text[at + 1] = 2;
    parts_.index_text = text;
    EXPECT_NE(wrong().find("key step 2"), std::string::npos) << wrong();
}

/// 16 cells refined 6 times are 4,194,304: more than two gigabytes, of some hundred bytes.
TEST_F(SeriesLies, RefinedCellsCountAgainstTheBytesOfTheFile) {
    parts_.meshes[0] = box_part(6, {});
    EXPECT_NE(wrong().find("bytes say that they are"), std::string::npos) << wrong();
    parts_.meshes[0] = box_part(7, {});
    EXPECT_NE(wrong().find("the number of levels is 7"), std::string::npos) << wrong();
}

/// An array of 900 channels, all 0, at half a million points.
TEST_F(SeriesLies, ChannelsCountAgainstTheBytesOfTheFile) {
    parts_.meshes[0] = box_part(5, {});
    parts_.index.arrays.push_back({"many", std::vector<detail::Quantization>(900, {0, 1, 0, 1})});
    EXPECT_NE(wrong().find("bytes say that they are"), std::string::npos) << wrong();
}

TEST_F(SeriesLies, SidesAndNamesThatAreThereTwice) {
    const std::string box = parts_.meshes[0];
    const auto with_sets = [&](const MeshSets& sets) {
        const std::string of_mesh = box_part(0, sets);
        // The sets alone, after the cells of the good mesh.
        parts_.meshes[0] = box.substr(0, box.find("inlet") - 2) + of_mesh.substr(box_part(0, {}).size() - 2);
        return wrong();
    };
    EXPECT_EQ(with_sets({{{"p", {{0, 1}, {3, 5}}}}, {}}), "no error");
    EXPECT_NE(with_sets({{{"p", {{0, 1}, {3, 5}, {0, 1}}}}, {}}).find("patch \"p\" has side 1 of cell 0 more than once"),
              std::string::npos);
    EXPECT_EQ(with_sets({{{"p", {{0, 1}}}, {"p", {{3, 5}}}}, {}}), "no error");
    const ReadResult read = read_mesh(path("b.svw"));
    EXPECT_EQ(read.sets.patches[1].name, "p_2");
    EXPECT_NE(read.warnings.back().find("more than one patch \"p\""), std::string::npos);
}

TEST_F(SeriesLies, FieldsOfOneNameAndNamesThatAreNotPrintable) {
    parts_.index.arrays[1].name = "a\x1b[31m\n\u202e";
    EXPECT_EQ(wrong(), "no error");
    EXPECT_EQ(read_mesh(path("b.svw")).mesh.attributes[0].name, "a\\x1b[31m\\x0a\\xe2\\x80\\xae");
}

TEST_F(SeriesLies, BoundsThatExcludeAllValues) {
    // The values of the last step are 0 to 6, in bounds of 0 to 9.
    detail::Bytes good, bad, narrow;
    for (const double x : {0.0, 9.0}) good.real(x);
    for (const double x : {100.0, 200.0}) bad.real(x);
    for (const double x : {0.0, 3.0}) narrow.real(x);
    std::string& head = parts_.steps[2].head;
    const std::size_t at = head.find(good.all());
    ASSERT_NE(at, std::string::npos);
    head.replace(at, 16, bad.all());
    EXPECT_NE(wrong().find("no value lies within them"), std::string::npos) << wrong();
    head.replace(at, 16, narrow.all());
    EXPECT_EQ(wrong(), "no error");
    EXPECT_NE(read_mesh(path("b.svw")).warnings.back().find("outside of the bounds"), std::string::npos);
}

/// The same for what checksums do not find: parts that are damaged before they are compressed.
TEST_F(SeriesFile, DamagedPartsAreRefused) {
    HexMesh control = make_model("ball", 2);
    control.attributes.front().bounds = {{-5, 5}};
    control.points.emplace_back(1, 1, 1);  // no cell uses it
    control.attributes.front().values.push_back(0);
    const auto step = [&](std::size_t k) {
        HexMesh mesh = control;
        for (Vec3& p : mesh.points) p *= 1 + static_cast<double>(k) / 10;
        for (double& x : mesh.attributes.front().values) x = std::sin(x + static_cast<double>(k));
        mesh.attributes.front().values.back() = std::numeric_limits<double>::quiet_NaN();  // kept as it is
        return mesh;
    };
    MeshSteps steps = steps_of(3, step);
    steps.sets = [] { return MeshSets{{{"inlet", {{0, 1}, {3, 5}}}}, {{"core", {1, 2, 4}}}}; };
    write_series_file(path("a.svw"), steps, {.tolerance = 1e-2});
    const auto good = test::SeriesParts::of(test::read_bytes(path("a.svw")), control.points.size());
    ASSERT_EQ(good.packed(), test::read_bytes(path("a.svw")));
    std::size_t refused = 0, valid = 0;
    const auto attempt = [&](const test::SeriesParts& parts) {
        std::ofstream(path("b.svw"), std::ios::binary) << parts.packed();
        for (const std::size_t k : {0u, 2u}) {
            try {
                validate(read_mesh(path("b.svw"), {.step = k}).mesh);
                ++valid;
            } catch (const Error& error) {
                EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << error.what();
                EXPECT_NE(std::string(error.what()).find("b.svw"), std::string::npos) << error.what();
                ++refused;
            }
        }
    };
    attempt(good);
    ASSERT_EQ(valid, 2u);
    std::mt19937 random(19);
    const auto damage = [&](std::string& text) {
        const std::size_t at = random() % text.size();
        switch (random() % 4) {
            case 0:
                return void(text.erase(at, 1 + random() % 3));
            case 1:
                return void(text.insert(at, 1, static_cast<char>(random())));
            case 2:
                return void(text.replace(at, 1, "\xff\xff\xff\xff\xff\xff\xff\x7f"));  // a large number
            default:
                text[at] = static_cast<char>(random());
        }
    };
    const char* rounds = std::getenv("SUBVOL_MUTATIONS");
    for (int round = 0; round < (rounds ? std::atoi(rounds) : 150); ++round) {
        test::SeriesParts bad = good;
        const std::array<std::string*, 5> parts{&bad.index_text.emplace(good.index_of_packed()), &bad.meshes[0],
                                                &bad.steps[0].head, &bad.steps[0].block, &bad.steps[2].head};
        const std::size_t which = static_cast<std::size_t>(round) % parts.size();
        damage(*parts[which]);
        if (which != 0) bad.index_text.reset();
        attempt(bad);
    }
    EXPECT_GT(refused, 0u);
}

}  // namespace series_file_test
}  // namespace subvol
