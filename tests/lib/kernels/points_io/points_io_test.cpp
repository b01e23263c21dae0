// SPDX-License-Identifier: Apache-2.0
#include "subvol/points_io.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <map>
#include <random>
#include <sstream>

#include "lib/kernel_samples.h"
#include "lib/rbf_volumes.h"
#include "lib/temp_folder.h"
#include "subvol/detail/principal_axes.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/surface_io.h"

namespace subvol::test {

using namespace detail;

namespace points_io_test {

using testing::HasSubstr;

struct Form {
    const char* file;
    PointsWriteOptions options;
    bool boundary_beside;
};

const std::vector<Form> kForms{{"a.ply", {}, false},
                               {"a.ply", {.ascii = true}, false},
                               {"a.ply", {.splats = true}, true},
                               {"a.ply", {.ascii = true, .splats = true}, true},
                               {"a.vtp", {}, true}};

class PointsIo : public TempFolder {
protected:
    RbfVolume written(const Form& form, const RbfVolume& volume) const {
        write_points(path(form.file), volume, form.options);
        return read_points(path(form.file));
    }

    void remove_all() const {
        for (const char* name : {"a.ply", "a.vtp", "a.boundary.vtp"}) std::filesystem::remove(path(name));
    }
};

TEST_F(PointsIo, EveryFormGivesBackEveryBit) {
    for (const std::size_t channels : {1U, 3U}) {
        const RbfVolume volume = random_points(500, channels);
        for (const Form& form : kForms) {
            SCOPED_TRACE(std::string(form.file) + (form.options.ascii ? " ascii" : "") +
                         (form.options.splats ? " splats" : ""));
            remove_all();
            const RbfVolume read = written(form, volume);
            EXPECT_EQ(read.centers, volume.centers);
            expect_same_but_centers(read, volume);
            EXPECT_EQ(file_count(), form.boundary_beside ? 2u : 1u);
        }
    }
}

TEST_F(PointsIo, HessiansOfASampledVolumeComeBack) {
    const RbfVolume volume = ball_with_hessians();
    for (const Form& form : kForms) {
        remove_all();
        const RbfVolume read = written(form, volume);
        EXPECT_EQ(read.centers, volume.centers);
        expect_same_but_centers(read, volume);
    }
}

TEST_F(PointsIo, EveryKernelComesBack) {
    RbfVolume volume = random_points(5, 1);
    const auto expect_kernel = [&](const Kernel& kernel) {
        volume.kernel = kernel;
        for (const Form& form : kForms) expect_same_but_centers(written(form, volume), volume);
    };
    for (const std::string& name : kernel_names()) expect_kernel(named_kernel(name));
    for (const auto& [name, kernel] : every_kernel()) expect_kernel(kernel);
}

// Hessians are stored in VTK's order: the array is replaced by the same tensor written as text in that order.
TEST_F(PointsIo, VtpHessiansAreInTheOrderOfVtk) {
    RbfVolume volume = random_points(1, 2);
    volume.channels[1].name = "t";
    volume.channels[1].hessians = {{1, 2, 3, 4, 5, 6}};  // xx xy xz yy yz zz
    write_points(path("a.vtp"), volume);
    const std::string text = read_bytes(path("a.vtp"));
    EXPECT_THAT(text, testing::Not(HasSubstr("\"density.hessian\"")));
    const std::string array = "<DataArray type=\"Float32\" Name=\"t.hessian\" NumberOfComponents=\"6\" format=\"binary\"";
    ASSERT_THAT(text, HasSubstr(array));
    // xx yy zz xy yz xz
    const std::string close = "</DataArray>";
    const std::size_t at = text.find(array), end = text.find(close, at);
    const std::string ascii =
        "<DataArray type=\"Float32\" Name=\"t.hessian\" NumberOfComponents=\"6\" format=\"ascii\">1 4 6 2 5 3</DataArray>";
    write("b.vtp", text.substr(0, at) + ascii + text.substr(end + close.size()));
    EXPECT_EQ(read_points(path("b.vtp")).channels[1].hessians, volume.channels[1].hessians);
    EXPECT_EQ(read_points(path("a.vtp")).channels[1].hessians, volume.channels[1].hessians);
}

TEST_F(PointsIo, WithoutABoundaryThereIsNone) {
    RbfVolume volume = random_points(5, 1);
    volume.boundary = {};
    for (const Form& form : kForms) {
        remove_all();
        const RbfVolume read = written(form, volume);
        EXPECT_TRUE(read.boundary.points.empty());
        EXPECT_EQ(read.bounds.lower, box_of(volume).lower);
        EXPECT_EQ(file_count(), 1u);
    }
}

TEST_F(PointsIo, NoPointsAreFineToo) {
    for (const Form& form : kForms) EXPECT_EQ(written(form, random_points(0, 2)).size(), 0u);
}

TEST_F(PointsIo, ABoundaryThatIsGoneIsEmptyAndAForeignOneIsRefused) {
    const RbfVolume volume = random_points(5, 1);
    RbfVolume other = volume;
    other.boundary.triangles.pop_back();
    for (const char* name : {"a.vtp", "a.ply"}) {
        const PointsWriteOptions options{.splats = std::string(name) == "a.ply"};
        write_points(path("b.vtp"), other);
        write_points(path(name), volume, options);
        std::filesystem::copy_file(path("b.boundary.vtp"), path("a.boundary.vtp"),
                                   std::filesystem::copy_options::overwrite_existing);
        const std::string message = error_of([&] { static_cast<void>(read_points(path(name))); });
        EXPECT_THAT(message, HasSubstr("a.boundary.vtp: has 3 triangles"));
        std::filesystem::remove(path("a.boundary.vtp"));
        const RbfVolume read = read_points(path(name));
        EXPECT_TRUE(read.boundary.triangles.empty());
        EXPECT_EQ(read.centers, volume.centers);
    }
}

// Files that are cut off or changed give an error with a sentence, or other points; never a crash, which the sanitizers check.
TEST_F(PointsIo, DamagedFilesDoNotCrash) {
    std::mt19937 random(3);
    for (const Form& form : kForms) {
        write_points(path(form.file), random_points(20, 2), form.options);
        const std::string good = read_bytes(path(form.file));
        const std::string name = std::string("damaged") + std::filesystem::path(form.file).extension().string();
        for (int trial = 0; trial < 300; ++trial) {
            std::string bad = good;
            if (trial % 3 == 0) bad.resize(random() % bad.size());
            for (int n = trial % 4; n > 0 && !bad.empty(); --n) bad[random() % bad.size()] = static_cast<char>(random());
            const auto file = write(name, bad);
            try {
                const RbfVolume read = read_points(file);
                validate(read);
                for (const RbfChannel& channel : read.channels) EXPECT_EQ(channel.name, printable(channel.name));
            } catch (const Error& error) {
                EXPECT_EQ(printable(error.what()), error.what());
                EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << error.what();
            }
        }
    }
}

TEST_F(PointsIo, CutOffFilesAreRefused) {
    for (const Form& form : kForms) {
        write_points(path(form.file), random_points(20, 2), form.options);
        const std::string good = read_bytes(path(form.file));
        const std::string name = std::string("cut") + std::filesystem::path(form.file).extension().string();
        // A part of the last number of a text is still a number: a cut at three quarters is noticed in every format.
        for (const std::size_t size : {good.size() / 4, good.size() / 2, 3 * good.size() / 4}) {
            const auto file = write(name, good.substr(0, size));
            EXPECT_THAT(error_of([&] { static_cast<void>(read_points(file)); }), HasSubstr(name));
        }
    }
}

TEST_F(PointsIo, WhatCannotBeWrittenLeavesNothing) {
    const RbfVolume volume = random_points(2000, 1);
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{20000, before.rlim_max};  // simulates a full disk
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    for (const Form& form : kForms) {
        EXPECT_THAT(error_of([&] { write_points(path(form.file), volume, form.options); }, ErrorCode::Io),
                    HasSubstr(std::string(form.file) + ": cannot be written"));
    }
    EXPECT_THAT(error_of([&] { write_points(path("a.npz"), volume); }, ErrorCode::Io), HasSubstr("a.npz: cannot be written"));
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(file_count(), 0u);

    // The points could be written, but not their boundary, as a folder has its name.
    std::filesystem::create_directory(path("a.boundary.vtp"));
    EXPECT_THAT(error_of([&] { write_points(path("a.vtp"), volume); }, ErrorCode::Io), HasSubstr("is a folder"));
    EXPECT_EQ(file_count(), 1u);
    EXPECT_THAT(error_of([&] { write_points(path("a.obj"), volume); }), HasSubstr(".ply, .vtp, .npz or .glb"));
    EXPECT_THAT(error_of([&] { static_cast<void>(read_points(path("none.ply"))); }, ErrorCode::Io), HasSubstr("none.ply"));
}

TEST_F(PointsIo, VolumesThatAreNoneAreRefused) {
    const RbfVolume good = random_points(3, 2);
    const auto error_with = [&](const auto& change) {
        RbfVolume volume = good;
        change(volume);
        return error_of([&] { write_points(path("a.ply"), volume); });
    };
    EXPECT_THAT(error_with([](RbfVolume& v) { v.frames.pop_back(); }), HasSubstr("number of frames"));
    EXPECT_THAT(error_with([](RbfVolume& v) { v.channels[1].name = "density"; }), HasSubstr("two channels are named"));
    EXPECT_THAT(error_with([](RbfVolume& v) { v.channels.clear(); }), HasSubstr("no channel"));
    EXPECT_THAT(error_with([](RbfVolume& v) { v.channels[1].moments.pop_back(); }), HasSubstr("\"Temp."));
    EXPECT_THAT(error_with([](RbfVolume& v) { v.channels[1].hessians.pop_back(); }),
                HasSubstr("does not have one Hessian per point"));
    EXPECT_THAT(error_with([](RbfVolume& v) { v.channels[1].hessians[2][4] = NAN; }), HasSubstr("point 2: the Hessian of"));
    EXPECT_THAT(error_with([](RbfVolume& v) { v.kernel = CompactKernel{-1}; }), HasSubstr("'radius' is -1"));
    EXPECT_THAT(error_with([](RbfVolume& v) { v.frames[2][3] = 0; }), HasSubstr("point 2"));
    EXPECT_THAT(error_with([](RbfVolume& v) { v.boundary.triangles[0][0] = 4; }), HasSubstr("no point 4"));
    RbfVolume clash = good;
    clash.channels[1].name = "frame";
    EXPECT_THAT(error_of([&] { write_points(path("a.vtp"), clash); }), HasSubstr("two arrays would be named \"frame\""));
    clash.channels[1].name = "density.hessian";  // though "density" has none
    EXPECT_THAT(error_of([&] { write_points(path("a.vtp"), clash); }), HasSubstr("named \"density.hessian\""));
    EXPECT_EQ(file_count(), 0u);
}

TEST(PrincipalAxes, MakeTheFrameAgain) {
    for (const auto& frame : random_points(200, 1).frames) {
        const auto [half_axes, directions] = principal_axes(frame);
        EXPECT_GE(half_axes.x, half_axes.y);
        EXPECT_GE(half_axes.y, half_axes.z);
        const Mat3 s = directions *
                       Mat3(half_axes.x * half_axes.x, 0, 0, 0, half_axes.y * half_axes.y, 0, 0, 0, half_axes.z * half_axes.z) *
                       glm::transpose(directions);
        const std::array<double, 6> again{s[0][0], s[0][1], s[0][2], s[1][1], s[1][2], s[2][2]};
        const double tolerance = 1e-13 * half_axes.x * half_axes.x;  // rounding of some tens of double operations
        for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(again[k], static_cast<double>(frame[k]), tolerance);
        EXPECT_NEAR(glm::determinant(directions), 1, 1e-13);
        // The quaternion turns x, y and z to the columns: R v = v + 2 q × (q × v + w v).
        const auto [w, x, y, z] = quaternion(directions);
        const Vec3 q(x, y, z);
        for (int k = 0; k < 3; ++k) {
            Vec3 v(0.0);
            v[k] = 1;
            EXPECT_NEAR(glm::length(v + 2.0 * glm::cross(q, glm::cross(q, v) + w * v) - directions[k]), 0, 1e-13);
        }
    }
}

// Reads the file as viewers of splats do: all properties are those of the vertex; the axes are exp(scale), turned by rot.
// They have -y at the top: up is turned there, and the other axes stay right-handed.
class SplatsFor : public PointsIo, public testing::WithParamInterface<UpAxis> {};

TEST_P(SplatsFor, ViewersAreTheKernelsEllipsoidsUpright) {
    const RbfVolume volume = random_points(50, 1);
    write_points(path("a.ply"), volume, {.ascii = true, .splats = true, .up = GetParam()});
    const int up = static_cast<int>(GetParam());
    const std::array<Mat3, 3> turns{Mat3(Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)),
                                    Mat3(Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)),
                                    Mat3(Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, -1, 0))};
    const Mat3 turn = turns[static_cast<std::size_t>(up)];
    EXPECT_EQ(turn[up], Vec3(0, -1, 0));
    EXPECT_NEAR(glm::determinant(turn), 1, 1e-15);
    std::istringstream in(read_bytes(path("a.ply")));
    std::map<std::string, std::size_t> columns;
    for (std::string line; std::getline(in, line) && line != "end_header";) {
        std::istringstream words(line);
        std::string key, type, name;
        words >> key >> type >> name;
        if (key == "property") columns.insert({name, columns.size()});
    }
    // (1-ρ²)³ has the integral 64π/315, as a Gaussian of this σ; the sum over midpoints is good to 1e-3.
    const double sigma = std::cbrt(64 * 3.141592653589793 / 315) / std::sqrt(2 * 3.141592653589793);
    for (std::size_t i = 0; i < volume.size(); ++i) {
        std::vector<double> row(columns.size());
        for (double& number : row) in >> number;
        const auto get = [&](const char* name) { return row.at(columns.at(name)); };
        Mat3 axes;
        const Vec3 q(get("rot_1"), get("rot_2"), get("rot_3"));
        for (int k = 0; k < 3; ++k) {
            Vec3 v(0.0);
            v[k] = 1;
            axes[k] = std::exp(get(("scale_" + std::to_string(k)).c_str())) *
                      (v + 2.0 * glm::cross(q, glm::cross(q, v) + get("rot_0") * v));
        }
        const Mat3 covariance = glm::transpose(turn) * axes * glm::transpose(axes) * turn;
        const double largest = static_cast<double>(std::max({volume.frames[i][0], volume.frames[i][3], volume.frames[i][5]}));
        EXPECT_NEAR(covariance[0][0], sigma * sigma * static_cast<double>(volume.frames[i][0]), 3e-3 * sigma * sigma * largest);
        EXPECT_NEAR(covariance[2][0], sigma * sigma * static_cast<double>(volume.frames[i][2]), 3e-3 * sigma * sigma * largest);
        EXPECT_NEAR(covariance[2][1], sigma * sigma * static_cast<double>(volume.frames[i][4]), 3e-3 * sigma * sigma * largest);
        const double opacity = 1 / (1 + std::exp(-get("opacity")));
        EXPECT_GT(opacity, 0.003);
        EXPECT_LE(opacity, 0.5 + 1e-6);  // viridis ramps to .5
        const Vec3 at = turn * volume.centers[i];
        EXPECT_NEAR(get("x"), at.x, 1e-5);
        EXPECT_NEAR(get("y"), at.y, 1e-5);
        EXPECT_NEAR(get("z"), at.z, 1e-5);  // floats at 100
        EXPECT_EQ(get("cx"), volume.centers[i].x);
        EXPECT_EQ(get("cy"), volume.centers[i].y);
    }
}

INSTANTIATE_TEST_SUITE_P(Axes, SplatsFor, testing::Values(UpAxis::X, UpAxis::Y, UpAxis::Z));

}  // namespace points_io_test

}  // namespace subvol::test
