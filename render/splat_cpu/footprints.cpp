// SPDX-License-Identifier: Apache-2.0
#include "footprints.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <utility>

#include "kernel_axes.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/raster.h"
#include "tile_finder.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kCells = 1024;          // of the table
constexpr float kLeastTransmittance = 1e-6F;  // below it a ray ends

/// Light on a kernel from its gradient (eye space), on either side: that of values inside the volume.
SurfaceLight light_on(const Shading& shading, const Vec3& gradient, const Vec3& to_eye, double least) {
    const double square = glm::dot(gradient, gradient);
    if (!(square > 0)) return {};
    const Vec3 normal = gradient / std::sqrt(square), key = glm::normalize(shading.key);
    const double head = std::abs(glm::dot(normal, to_eye)), side = std::abs(glm::dot(normal, key));
    const double halfway = std::abs(glm::dot(normal, glm::normalize(key + to_eye)));
    const double gloss = std::pow(head, shading.shininess) + std::pow(halfway, shading.shininess);
    const double lit = shading.ambient + shading.diffuse * (shading.head * head + (1 - shading.head) * side);
    const double surface = square / (square + least * least);
    return {static_cast<float>(1 + surface * (lit - 1)), static_cast<float>(surface * shading.specular * 0.5 * gloss)};
}

}  // namespace

/// In the world: e = |root · (x − center)|² is 1 at the end of the support.
struct Footprints::Kernel {
    Mat3 root;
    Vec3 center;
    float extinction;
    std::array<float, 3> color;
    float depth;  // relative to the scene's middle
};

void check_footprints(const SplatScene& scene) {
    const auto refuse = [](const char* what, const char* instead) {
        throw Error(ErrorCode::InvalidInput, what, "footprints", instead);
    };
    if (!is_radial(scene.volume->kernel))
        refuse("kernels that are not radial have no footprint for all directions", "a radial kernel");
    if (scene.shadowed()) refuse("footprints support neither shadows nor ambient occlusion", "the method splat");
    if (!scene.clip.empty()) refuse("footprints cannot be cut", "the method splat");
}

Footprints::Footprints(const SplatScene& scene) : scene_(scene), table_(kCells + 2) {
    check_footprints(scene);
    const auto& kernel = scene.volume->kernel;
    const double radius = support_radius(kernel);
    double volume = 0;  // ∫ weight = π R² ∫ line integral de, by the trapezoidal rule
    std::vector<double> lines(kCells + 1);
    for (std::size_t i = 0; i <= kCells; ++i) {
        lines[i] = line_integral(kernel, radius * std::sqrt(static_cast<double>(i) / kCells), 0);
        volume += std::numbers::pi * radius * radius * lines[i] * (i == 0 || i == kCells ? 0.5 : 1) / kCells;
    }
    const double scale = (scene.normalized ? 1 / volume : 1) / radius;
    for (std::size_t i = 0; i <= kCells; ++i) table_[i] = static_cast<float>(std::max(0.0, scale * lines[i]));
}

std::vector<Footprints::Kernel> Footprints::kernels_of(const SplatFrame& frame) const {
    const RbfVolume& volume = *scene_.volume;
    const RbfChannel& channel = scene_.opacity_values();
    const View& view = *frame.view;
    const std::array<Vec3, 3>& axes = view.axes();
    const double least = static_cast<double>(kLeastChange) / scene_.diagonal;
    const double range = frame.classification->table.max - frame.classification->table.min;
    std::vector<Kernel> kernels(volume.size());
    parallel_each(kernels.size(), [&](std::size_t i) {
        const EyeSplat& splat = frame.kernels.splats[i];
        const std::array<float, 4> light = frame.classification->light_at(splat.value);
        std::array<float, 3> color{};
        for (std::size_t c = 0; c < 3 && light[0] > 0; ++c) color[c] = std::min(light[c + 1] / light[0], 1.0F);
        if (scene_.color_channel) color = frame.classification->color_at(frame.kernels.colors[i].value);
        if (scene_.shading) {
            const auto& g = channel.gradients[i];
            const Vec3 world = Vec3(g[0], g[1], g[2]) / range;
            const Vec3 gradient(glm::dot(axes[0], world), glm::dot(axes[1], world), glm::dot(axes[2], world));
            const Vec3 to_eye = view.perspective() ? -glm::normalize(view.to_eye(volume.centers[i])) : Vec3(0, 0, -1);
            const SurfaceLight lit = light_on(*scene_.shading, gradient, to_eye, least);
            for (float& c : color) c = c * lit.diffuse + lit.specular;
        }
        kernels[i] = {inverse_symmetric_root(volume.frames[i]), volume.centers[i], light[0], color, splat.depth};
    });
    return kernels;
}

Drawn Footprints::draw(SplatFrame& frame, const View& view, const Classification& classification, Progress* progress) const {
    if (view.ends_rays())
        throw Error(ErrorCode::InvalidInput, "the rays of footprints cannot be ended", "footprints", "the method splat");
    prepare_kernels(frame, scene_, view, classification, 0, progress);
    const std::vector<Kernel> kernels = kernels_of(frame);
    Drawn drawn{Image(view.width(), view.height()), {}};
    drawn.depth.assign(drawn.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    const std::size_t tiles = frame.tile_offsets.size() - 1;
    std::mutex reporting;
    std::size_t done = 0;
    report_progress(progress, "splat", 0);
    tbb::parallel_for(std::size_t{0}, tiles, [&](std::size_t tile) {
        draw_tile(frame, kernels, tile, drawn);
        if (!progress) return;
        const std::lock_guard lock(reporting);
        report_progress(progress, "splat", ++done, tiles);
    });
    return drawn;
}

/// The kernels of a tile that are seen, from front to back.
std::vector<std::uint32_t> Footprints::order_of(const SplatFrame& frame, const std::vector<Kernel>& kernels, std::size_t tile) {
    const auto begin = frame.tile_splats.begin();
    std::vector<std::uint32_t> order(begin + static_cast<std::ptrdiff_t>(frame.tile_offsets[tile]),
                                     begin + static_cast<std::ptrdiff_t>(frame.tile_offsets[tile + 1]));
    std::erase_if(order, [&](std::uint32_t i) { return !(kernels[i].extinction > 0) || kernels[i].depth < frame.sheets.near; });
    std::ranges::sort(order, {}, [&](std::uint32_t i) { return std::pair(kernels[i].depth, i); });
    return order;
}

void Footprints::draw_tile(const SplatFrame& frame, const std::vector<Kernel>& kernels, std::size_t tile, Drawn& drawn) const {
    constexpr int kTile = SplatFrame::kTile_px;
    const View& view = *frame.view;
    const TileFinder finder(frame);
    const int x0 = static_cast<int>(tile) % frame.tiles_x * kTile, y0 = static_cast<int>(tile) / frame.tiles_x * kTile;
    const int x1 = std::min(x0 + kTile, view.width()), y1 = std::min(y0 + kTile, view.height());
    std::vector<Ray> rays;
    std::vector<float> depths(kTile * kTile, 0.0F);
    const auto place_of = [&](int x, int y) { return static_cast<std::size_t>((y - y0) * kTile + x - x0); };
    for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x0 + kTile; ++x) rays.push_back(view.ray(x + 0.5, y + 0.5));
    }
    for (const std::uint32_t i : order_of(frame, kernels, tile)) {
        const Kernel& kernel = kernels[i];
        const PixelBox box = finder.pixels_of(frame.kernels.splats[i]);
        for (int y = std::max(y0, box.y0); y < std::min(y1, box.y1 + 1); ++y) {
            for (int x = std::max(x0, box.x0); x < std::min(x1, box.x1 + 1); ++x) {
                const std::size_t at = place_of(x, y);
                const auto pixel = drawn.image.pixel(x, y);
                if (1 - pixel[3] < kLeastTransmittance) continue;
                const float light = (pixel[3] - 1) * std::expm1(-kernel.extinction * footprint(kernel, rays[at]));
                for (std::size_t c = 0; c < 3; ++c) pixel[c] += light * kernel.color[c];
                pixel[3] += light;
                depths[at] += light * kernel.depth;
            }
        }
    }
    for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
            const std::size_t at = place_of(x, y);
            const float opacity = drawn.image.pixel(x, y)[3];
            if (!(opacity > 0)) continue;
            drawn.depth[pixel_index(view.width(), x, y)] = frame.sheets.middle + depths[at] / opacity;
        }
    }
}

/// The integral of a kernel's weight along a ray (world length).
float Footprints::footprint(const Kernel& kernel, const Ray& ray) const {
    const Vec3 a = kernel.root * (ray.origin - kernel.center), b = kernel.root * ray.direction;
    const double along = glm::dot(b, b), middle = glm::dot(a, b);
    const auto e = static_cast<float>(glm::dot(a, a) - middle * middle / along);
    if (!(e < 1)) return 0;
    const float place = std::max(e, 0.0F) * kCells;
    const auto row = static_cast<std::size_t>(place);
    const float s = place - static_cast<float>(row);
    return ((1 - s) * table_[row] + s * table_[row + 1]) / static_cast<float>(std::sqrt(along));
}

}  // namespace subvol::detail
