// SPDX-License-Identifier: Apache-2.0
// Shadows and ambient occlusion by optical depths along the light.
//
//        light                     The volume is splatted as seen from the light, by an orthographic camera. Instead of a
//        colour
//     |    |    |    |             each sheet keeps the optical depth D that each of its rays has gone through so far. The
//     light
//   --0----0----0----0--  sheet    that arrives at a place is exp(-D) there. The same sums, boundary and pre-integration as in
//   --0---.3---.2----0--           pictures are used, so D is that of the picture, and it is linear between nodes: shadows are
//   --0---.7---.5---.1--           soft and have no bands.
//
// Ambient occlusion looks into fourteen directions. The light that a place gets over the distance R in the direction w is
// exp(-(D(x) - D(x + R w))), with D along w; the same sheets serve for w and -w. A place on a flat surface sees half of all
// directions, and that counts as fully open.
#include "make_light_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "splat_cpu.h"
#include "subvol/detail/across.h"

namespace subvol::detail {

namespace {

constexpr int kShadowNodes = 128, kOcclusionNodes = 64;

/// Optical depths on the sheets of a light's view.
struct LightSheets {
    View view;
    SheetStack sheets;
    std::vector<float> depths;  // of pixel (x, y) on sheet z: (z · height + y) · width + x

    /// Places in numbers of nodes: a row for each axis, and the offset.
    void place(Mat3& to_nodes, Vec3& offset) const {
        const auto& [right, up, forward] = view.axes();
        const double per_pixel = 1 / view.pixel(), per_sheet = 1 / static_cast<double>(sheets.distance);
        to_nodes = glm::transpose(Mat3(per_pixel * right, -per_pixel * up, per_sheet * forward));
        offset = Vec3(0.5 * view.width() - 0.5, 0.5 * view.height() - 0.5,
                      -(static_cast<double>(sheets.first) + static_cast<double>(sheets.middle)) * per_sheet) -
                 to_nodes * view.eye();
    }

    [[nodiscard]] double at(const Vec3& node) const {
        const GridCorners corners = corners_around(node, {view.width(), view.height(), sheets.count});
        double sum = 0;
        for (std::size_t k = 0; k < 8; ++k) sum += corners.weights[k] * static_cast<double>(depths[corners.nodes[k]]);
        return sum;
    }
};

/// to_light: of unit length
LightSheets sheets_along(const SplatScene& scene, const Classification& classification, const Vec3& to_light, int nodes) {
    const double width = 1.02 * scene.diagonal;
    LightSheets light{View({.eye = scene.middle + scene.diagonal * to_light,
                            .target = scene.middle,
                            .up = -across(to_light)[1],
                            .ortho_height = width},
                           nodes, nodes),
                      {},
                      {}};
    SplatFrame frame;
    prepare_frame(frame, scene, light.view, classification, nodes, nullptr);
    find_interval_ends(frame);
    light.sheets = frame.sheets;
    light.depths = optical_depths_cpu(frame);
    return light;
}

/// The scene without what does not change its optical depths.
SplatScene dark_scene(const SplatScene& scene) {
    SplatScene dark = scene;
    dark.shading.reset();
    dark.boundary_normals.clear();
    dark.color_channel.reset();
    dark.shadows = false;
    dark.occlusion_world = 0;
    dark.light = nullptr;
    dark.clip = scene.clip.without_slices();
    dark.solid = false;
    return dark;
}

/// The openness on a coarse grid over the nodes of a light volume.
std::vector<float> openness(const SplatScene& scene, const Classification& classification, const LightVolume& light,
                            int nodes) {
    constexpr double k = 0.57735026918962576;
    const std::array<Vec3, 7> directions{Vec3(1, 0, 0),  Vec3(0, 1, 0),  Vec3(0, 0, 1), Vec3(k, k, k),
                                         Vec3(-k, k, k), Vec3(k, -k, k), Vec3(k, k, -k)};
    const auto count = static_cast<std::size_t>(nodes);
    std::vector<float> open(count * count * count);
    const Mat3 to_world = glm::inverse(light.to_nodes);
    const Vec3 scale = (Vec3(light.size[0], light.size[1], light.size[2]) - 1.0) / static_cast<double>(nodes - 1);
    for (const Vec3& direction : directions) {
        const LightSheets sheets = sheets_along(scene, classification, direction, nodes);
        Mat3 to_sheets;
        Vec3 offset;
        sheets.place(to_sheets, offset);
        const Vec3 step = to_sheets * (scene.occlusion_world * direction);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t z) {
            for (std::size_t i = z * count * count; i < (z + 1) * count * count; ++i) {
                const Vec3 node(static_cast<double>(i % count), static_cast<double>(i / count % count), static_cast<double>(z));
                const Vec3 place = to_sheets * (to_world * (scale * node - light.offset)) + offset;
                const double here = sheets.at(place), before = sheets.at(place + step), behind = sheets.at(place - step);
                open[i] += static_cast<float>(std::exp(std::min(before - here, 0.0)) + std::exp(std::min(here - behind, 0.0)));
            }
        });
    }
    for (float& part : open) part = std::min(1.0f, 2.0f * part / static_cast<float>(2 * directions.size()));
    return open;
}

}  // namespace

LightVolume make_light_volume(const SplatScene& scene, const View& view, const Classification& classification) {
    const SplatScene dark = dark_scene(scene);
    const Vec3 key = glm::normalize(scene.shading.value_or(Shading{}).key);
    const auto& [right, up, forward] = view.axes();
    const Vec3 to_light = glm::normalize(key.x * right + key.y * up + key.z * forward);
    const LightSheets sheets = sheets_along(dark, classification, to_light, scene.shadows ? kShadowNodes : kOcclusionNodes);
    LightVolume light;
    light.size = {sheets.view.width(), sheets.view.height(), sheets.sheets.count};
    sheets.place(light.to_nodes, light.offset);
    light.spacing_world = std::max(sheets.view.pixel(), static_cast<double>(sheets.sheets.distance));
    light.nodes.assign(sheets.depths.size(), {1, 1});
    if (scene.shadows) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, light.nodes.size(), 4096), [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) light.nodes[i][0] = std::exp(-sheets.depths[i]);
        });
    }
    if (scene.occlusion_world > 0) {
        SplatScene near = dark;
        near.occlusion_world = scene.occlusion_world;
        LightVolume coarse = light;
        coarse.size = {kOcclusionNodes, kOcclusionNodes, kOcclusionNodes};
        const std::vector<float> open = openness(near, classification, light, kOcclusionNodes);
        coarse.nodes.resize(open.size());
        for (std::size_t i = 0; i < open.size(); ++i) coarse.nodes[i] = {1, open[i]};
        coarse.to_nodes = Mat3(1.0);
        coarse.offset = Vec3(0.0);
        const Vec3 scale = static_cast<double>(kOcclusionNodes - 1) / (Vec3(light.size[0], light.size[1], light.size[2]) - 1.0);
        const auto width = static_cast<std::size_t>(light.size[0]), height = static_cast<std::size_t>(light.size[1]);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, light.nodes.size(), 4096), [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const Vec3 node(static_cast<double>(i % width), static_cast<double>(i / width % height),
                                static_cast<double>(i / (width * height)));
                light.nodes[i][1] = coarse.at(scale * node)[1];
            }
        });
        light.spacing_world = std::max(light.spacing_world, 1.02 * scene.diagonal / kOcclusionNodes);
    }
    return light;
}

}  // namespace subvol::detail
