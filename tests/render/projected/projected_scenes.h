// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "render/constant_optics.h"
#include "render/hex_meshes.h"
#include "render/image_differences.h"
#include "subvol/mesh_io.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"

/// Views, colours and fields for tests of projected tetrahedra.
namespace subvol::test {

// Single precision on the device: places are right to 3e-8 of the diagonal, which is 1e-5 of the opacity unit below.
inline constexpr double kGlTol = 1e-4;
// For light with one closed form and few segments.
inline constexpr double kFewTol = 1e-5;

/// Skipped without OpenGL.
class ProjectedTest : public testing::Test {
protected:
    void SetUp() override {
        if (gl_devices().empty()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    }
};

// Colour and opacity change with the value in [0,1], with kinks and an invisible part.
inline Optics ramp_optics(double unit = 1) {
    return {{{{0, {1, 0, 0}}, {0.5, {0, 1, 0.2}}, {1, {0.1, 0.3, 1}}},
             {{0, 0}, {0.3, 0.1}, {0.35, 0.6}, {0.6, 0}, {0.65, 0}, {1, 0.8}}},
            unit};
}

inline View slanted_view(int size) {
    return {{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .fovy_deg = 35}, size, size};
}

inline View orthographic_view(int width, int height) {
    return {{.eye = {2.1, 1.7, 2.9}, .target = {0.5, 0.5, 0.5}, .up = {0, 1, 0}, .ortho_height = 1.9}, width, height};
}

inline View ball_view(int width, int height) {
    return {{.eye = {1.8, -2.9, 1.4}, .target = {0, 0, 0}, .up = {0, 0, 1}, .fovy_deg = 38}, width, height};
}

inline double waves(const Vec3& p) {
    return 0.5 + 0.3 * std::sin(7 * p.x + 2 * p.y) + 0.2 * std::cos(9 * p.z - 3 * p.y);
}

/// The largest difference of the mesh drawn with render_projected and with render_tets.
inline double difference_from_rays(const HexMesh& mesh, std::span<const double> values, const View& view, const Optics& optics,
                                   const ProjectedOptions& options = {}) {
    const auto rays = render_tets(valued(mesh, values), {}, view, optics);
    return largest_difference(render_projected(valued(mesh, values), {}, view, optics, options).image, rays.image);
}

/// Three real meshes, none of them convex, give the same pictures as with rays. None has cells that fold over, which projected
/// tetrahedra would count twice.
inline void expect_real_meshes_like_rays(const std::filesystem::path& data, const ProjectedOptions& options) {
    for (const char* name : {"ansys_td28_fig14.vtk", "vtkdata_post_tet.vtk", "hexdom_igea_improve.vtk"}) {
        const HexMesh mesh = read_mesh(data / name).mesh;
        const Box box = bounds(mesh);
        std::vector<double> values;
        for (const Vec3& p : mesh.points) values.push_back(waves((p - box.lower) / box.diagonal()));
        const View view(fit_camera(box, {-1, 1, -1}), 128, 128);
        EXPECT_LT(difference_from_rays(mesh, values, view, ramp_optics(0.1 * box.diagonal()), options), kGlTol) << name;
    }
}

}  // namespace subvol::test
