// SPDX-License-Identifier: Apache-2.0
// Kernels on the GPU, listed by bins. A bin is a tile of the picture times a batch of sheets; the list of a bin holds the
// kernels that may reach it. Data of kernels are packed once, without the view: 16 floats each, and extras (Hessian, second
// channel, axes) in vectors of four. Then, for each frame:
//
//     count    kernels to eye space; for each its rectangle of tiles, its range of batches, and how many bins it meets
//     scan     exclusive sums of these counts: where each kernel's entries begin
//     emit     entries {bin, kernel}
//     sort     radix sort by bin, with as many bits as bins need
//     ranges   where each bin begins in the sorted list
//
// Scan to ranges are left out if all that decides which bins kernels meet is that of the last call: kernels, view, sheets, size
// of the picture; colours do not matter. Features of the scene become defines of the shaders.
#include "gl_splat_bins.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "eye_splats.h"
#include "kernel_axes.h"
#include "shader_gl_groups_glsl.h"
#include "shader_splat_emit_comp.h"
#include "shader_splat_eye_comp.h"
#include "shader_splat_frame_glsl.h"
#include "subvol/detail/parallel_each.h"
#include "work_groups.h"

namespace subvol::detail {

namespace {

std::array<double, 4> row(const Vec3& axis, double last) {
    return {axis.x, axis.y, axis.z, last};
}

/// Factor and offset that convert values into cells of the table from `min` to `max`.
std::array<double, 2> cells_of(double min, double max, bool normalized) {
    const double scale = PreintegratedTable::kCells / (max - min);
    return {scale, normalized ? -min * scale : 0};
}

void set_light(GlSplatFrame& frame, const Shading& shading) {
    const Vec3 key = glm::normalize(shading.key);
    const auto to_float = [](double v) { return static_cast<float>(v); };
    frame.key = {to_float(key.x), to_float(key.y), to_float(key.z), to_float(shading.head)};
    frame.material = {to_float(shading.ambient), to_float(shading.diffuse), to_float(shading.specular),
                      to_float(shading.shininess)};
}

}  // namespace

GlSplatFrame gl_splat_frame(const SplatScene& scene, const View& view, const Classification& classification,
                            const SheetStack& sheets, int tile_px, int batch) {
    GlSplatFrame frame;
    const Vec3 middle = view.to_eye(scene.middle);
    frame.right = row(view.axes()[0], middle.x);
    frame.up = row(view.axes()[1], middle.y);
    frame.forward = row(view.axes()[2], 0);
    const auto values = cells_of(classification.table.min, classification.table.max, scene.normalized);
    const auto colors = cells_of(classification.colors.min, classification.colors.max, scene.normalized);
    frame.cells = {values[0], values[1], colors[0], colors[1]};
    frame.unit = classification.table.unit;
    if (scene.shading) set_light(frame, *scene.shading);
    frame.width = view.width();
    frame.height = view.height();
    frame.tiles_x = (view.width() + tile_px - 1) / tile_px;
    frame.tiles_y = (view.height() + tile_px - 1) / tile_px;
    frame.sheets = sheets.count;
    frame.batches = (sheets.count + batch - 1) / batch;
    frame.perspective = view.perspective();
    // Slices are seen in batches whose values are not.
    frame.all_visible = static_cast<std::size_t>(classification.table.visible.back()) == classification.table.rows.size() ||
                        scene.clip.has_slices();
    frame.first_depth = sheets.first;
    frame.sheet_distance = sheets.distance;
    frame.middle_depth = sheets.middle;
    frame.near_depth = sheets.near;
    frame.pixel = static_cast<float>(view.pixel());
    frame.value_offset = value_offset(scene, classification);
    frame.color_offset = color_offset(scene, classification);
    frame.half_weight = scene.half_weight;
    frame.least_gradient = kLeastChange * PreintegratedTable::kCells / static_cast<float>(scene.diagonal);
    frame.unlit_ambient = static_cast<float>(scene.shading.value_or(Shading{}).ambient);
    if (scene.light) {
        frame.to_light = eye_to_nodes(*scene.light, view, middle.z);
        for (std::size_t k = 0; k < 3; ++k) frame.light_nodes[k] = scene.light->size[k];
    }
    frame.kernel_cells = scene.kernel_table.empty() ? 0 : static_cast<float>(scene.kernel_table.size() - 1);
    return frame;
}

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

namespace {

constexpr std::size_t kSplat_bytes = 64, kVector_bytes = 16;

/// What the lists depend on besides the kernels: which tiles and batches a kernel meets, not its values or colours.
std::vector<double> list_key(const GlSplatFrame& f) {
    std::vector<double> key{static_cast<double>(f.perspective),    static_cast<double>(f.first_depth),
                            static_cast<double>(f.sheet_distance), static_cast<double>(f.middle_depth),
                            static_cast<double>(f.pixel),          static_cast<double>(f.kernels),
                            static_cast<double>(f.most_entries)};
    for (const auto* axis : {&f.right, &f.up, &f.forward}) key.insert(key.end(), axis->begin(), axis->end());
    for (const int n : {f.width, f.height, f.tiles_x, f.tiles_y, f.sheets, f.batches, f.first_batch, f.end_batch, f.finer})
        key.push_back(n);
    return key;
}

GlProgram bins_program(const char* file, const char* source, const std::string& defines) {
    return {
        file, source, defines, {{"gl_groups.glsl", kShader_gl_groups_glsl}, {"splat_frame.glsl", kShader_splat_frame_glsl}}};
}

}  // namespace

GlSplatBins::GlSplatBins(const std::string& defines, std::uint32_t extras)
    : extras_(extras),
      eye_(bins_program("splat_eye.comp", kShader_splat_eye_comp, defines)),
      emit_(bins_program("splat_emit.comp", kShader_splat_emit_comp, defines)),
      total_(2 * kWord_bytes) {
}

std::size_t GlSplatBins::kernel_bytes(std::uint32_t extras) {
    return std::max(kSplat_bytes, extras * kVector_bytes);
}

std::size_t GlSplatBins::bytes_of_kernel(std::uint32_t extras) {
    return GlKernelData::kFloats * sizeof(float) + kSplat_bytes + 2 * kVector_bytes + 2 * extras * kVector_bytes;
}

void GlSplatBins::upload(const GlKernelData& data) {
    listed_.clear();
    kernels_ = static_cast<std::uint32_t>(data.kernels.size() / GlKernelData::kFloats);
    kernel_buffer_.grow(data.kernels.size() * sizeof(float));
    kernel_buffer_.upload(data.kernels.size() * sizeof(float), data.kernels.data());
    if (extras_ > 0) {
        kernel_extras_.grow(data.extras.size() * sizeof(float));
        kernel_extras_.upload(data.extras.size() * sizeof(float), data.extras.data());
    }
    const std::size_t count = kernels_;
    splats_.grow(count * kSplat_bytes);
    splat_extras_.grow(count * extras_ * kVector_bytes);
    ranges_.grow(count * 2 * kWord_bytes);
    rects_.grow(count * kVector_bytes);
    counts_.grow((count + 1) * kWord_bytes);
}

void GlSplatBins::count(GlStages& stages) {
    stages.begin("kernels");
    total_.clear();
    eye_.use();
    kernel_buffer_.bind(0);
    kernel_extras_.bind(1);
    splats_.bind(2);
    splat_extras_.bind(3);
    ranges_.bind(4);
    rects_.bind(5);
    counts_.bind(6);
    total_.bind(7);
    dispatch(groups_for(kernels_));
    stages.begin("");
}

std::uint64_t GlSplatBins::entries() const {
    std::uint32_t words[2];
    total_.read(sizeof words, words);
    return std::uint64_t{words[1]} << 32 | words[0];
}

bool GlSplatBins::list(const GlSplatFrame& frame, GlStages& stages) {
    std::vector<double> key = list_key(frame);
    if (key == listed_) return false;
    listed_.clear();  // in case of an error
    const std::uint32_t most = frame.most_entries;
    stages.begin("bins");
    scan_.exclusive_scan(counts_, kernels_);
    keys_.grow(std::size_t{most} * kWord_bytes);
    ids_.grow(std::size_t{most} * kWord_bytes);
    emit_.use();
    counts_.bind(0);
    rects_.bind(1);
    keys_.bind(2);
    ids_.bind(3);
    dispatch(groups_for(most));
    stages.begin("sort");
    const GlCount entries(counts_, kernels_, most);
    const std::uint32_t bins = frame.bins();
    sort_.radix_sort(keys_, ids_, entries, std::max(1, static_cast<int>(std::bit_width(bins - 1))));
    find_.find_ranges(keys_, entries, bins, offsets_);
    stages.begin("");
    listed_ = std::move(key);
    return true;
}

void GlSplatBins::bind() {
    splats_.bind(0);
    splat_extras_.bind(1);
    ranges_.bind(2);
    offsets_.bind(3);
    ids_.bind(4);
}

}  // namespace subvol::detail
