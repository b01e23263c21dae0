// SPDX-License-Identifier: Apache-2.0
#include "gl_splat_kernels.h"

#include <cmath>

#include "kernel_axes.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

float to_float(double v) {
    return static_cast<float>(v);
}

void pack_kernel(const SplatScene& scene, std::size_t i, float* to) {
    const RbfVolume& volume = *scene.volume;
    const RbfChannel& channel = scene.opacity_values();
    const Vec3 center = volume.centers[i] - scene.middle;
    const auto& f = volume.frames[i];
    const auto& g = channel.gradients[i];
    const double reach = scene.form == KernelForm::Separable ? 3 : 1;
    const float packed[GlKernelData::kFloats] = {to_float(center.x),
                                                 to_float(center.y),
                                                 to_float(center.z),
                                                 channel.values[i],
                                                 f[0],
                                                 f[1],
                                                 f[2],
                                                 f[3],
                                                 f[4],
                                                 f[5],
                                                 g[0],
                                                 g[1],
                                                 g[2],
                                                 channel.moments[i],
                                                 to_float(value_spread(channel, i, reach * matrix(f))),
                                                 0};
    std::copy(std::begin(packed), std::end(packed), to);
}

void pack_bend(const RbfChannel& channel, std::size_t i, float* to) {
    if (channel.hessians.empty()) return;  // zero
    std::copy(channel.hessians[i].begin(), channel.hessians[i].end(), to);
}

void pack_extras(const SplatScene& scene, const GlExtras& layout, std::size_t i, float* to) {
    const auto slot = [&](std::uint32_t at) { return to + std::size_t{4} * at; };
    if (scene.bent) pack_bend(scene.opacity_values(), i, slot(layout.bend));
    if (scene.color_channel) {
        const RbfChannel& channel = scene.color_values();
        slot(layout.color)[0] = channel.values[i];
        std::copy(channel.gradients[i].begin(), channel.gradients[i].end(), slot(layout.color) + 1);
        slot(layout.color + 1)[0] = channel.moments[i];
        if (scene.bent) pack_bend(channel, i, slot(layout.color_bend));
    }
    if (scene.form == KernelForm::Separable) {
        const Mat3 world = inverse_symmetric_root(scene.volume->frames[i]);
        for (int row = 0; row < 3; ++row) {
            float* out = slot(layout.axes + static_cast<std::uint32_t>(row));
            // Column `row` of the rotated matrix, as in eye_splats.cpp.
            for (int column = 0; column < 3; ++column) out[column] = to_float(world[column][row]);
        }
    }
}

}  // namespace

GlExtras::GlExtras(const SplatScene& scene) {
    const auto take = [&](bool there, std::uint32_t vectors) {
        const std::uint32_t at = count;
        if (there) count += vectors;
        return at;
    };
    bend = take(scene.bent, 2);
    color = take(scene.color_channel.has_value(), 2);
    color_bend = take(scene.color_channel && scene.bent, 2);
    axes = take(scene.form == KernelForm::Separable, 3);
}

std::string gl_scene_defines(const SplatScene& scene) {
    std::string text;
    const auto flag = [&](const char* name, bool on) { text += std::string("#define ") + name + (on ? " 1\n" : " 0\n"); };
    const auto number = [&](const char* name, std::uint32_t n) {
        text += std::string("#define ") + name + " " + std::to_string(n) + "\n";
    };
    flag("COMPACT", scene.form == KernelForm::Compact);
    flag("SEPARABLE", scene.form == KernelForm::Separable);
    flag("BENT", scene.bent);
    flag("COLORED", scene.color_channel.has_value());
    flag("SHADED", scene.shading.has_value());
    flag("SHADOWED", scene.shadowed());
    flag("NORMALIZED", scene.normalized);
    flag("CONVEX", scene.convex());
    flag("UNBOUNDED", scene.half_weight > 0);
    flag("GENERAL", scene.bent || scene.color_channel || scene.shading || scene.form == KernelForm::Separable);
    const GlExtras extras(scene);
    number("kBendAt", extras.bend);
    number("kColorAt", extras.color);
    number("kColorBendAt", extras.color_bend);
    number("kAxesAt", extras.axes);
    number("kExtras", extras.count);
    text += scene.form == KernelForm::Separable ? "#define kReach 3.0\n" : "#define kReach 1.0\n";
    return text;
}

GlKernelData pack_kernels(const SplatScene& scene, std::optional<std::span<const std::uint32_t>> ids) {
    const GlExtras layout(scene);
    const std::size_t count = ids ? ids->size() : scene.volume->size(), extras = 4 * std::size_t{layout.count};
    GlKernelData data;
    data.kernels.resize(count * GlKernelData::kFloats);
    data.extras.resize(count * extras);
    parallel_each(count, [&](std::size_t i) {
        const std::size_t id = ids ? (*ids)[i] : i;
        pack_kernel(scene, id, data.kernels.data() + i * GlKernelData::kFloats);
        pack_extras(scene, layout, id, data.extras.data() + i * extras);
    });
    return data;
}

}  // namespace subvol::detail
