// SPDX-License-Identifier: Apache-2.0
#include "eye_splats.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "kernel_axes.h"

namespace subvol::detail {

namespace {

/// Converts values into cells of a table.
struct Cells {
    double scale, offset;

    Cells(double min, double max, bool normalized)
        : scale(PreintegratedTable::kCells / (max - min)), offset(normalized ? -min * scale : 0) {}
};

Cells opacity_cells(const SplatScene& scene, const Classification& classification) {
    return {classification.table.min, classification.table.max, scene.normalized};
}
Cells color_cells(const SplatScene& scene, const Classification& classification) {
    return {classification.colors.min, classification.colors.max, scene.normalized};
}

float to_float(double v) {
    return static_cast<float>(v);
}

/// Converts kernels one after the other; all parts of a kernel use the same decomposition of its frame.
class ToEye {
public:
    ToEye(const SplatScene& scene, const View& view)
        : scene_(scene),
          to_eye_(glm::transpose(Mat3(view.axes()[0], view.axes()[1], view.axes()[2]))),
          middle_(view.to_eye(scene.middle)),
          reach_(scene.form == KernelForm::Separable ? 3 : 1) {}

    /// Sets the kernel for the other members.
    void set_kernel(std::size_t i) {
        i_ = i;
        const Mat3 s = to_eye_ * (reach_ * matrix(scene_.volume->frames[i])) * glm::transpose(to_eye_);
        szz_ = s[2][2];
        shear_ = {s[2][0] / szz_, s[2][1] / szz_};
        cxx_ = s[0][0] - s[2][0] * shear_.x;
        cxy_ = s[0][1] - s[2][0] * shear_.y;
        cyy_ = s[1][1] - s[2][1] * shear_.y;
    }

    [[nodiscard]] EyeSplat splat(const RbfChannel& channel, const Cells& cells) const {
        const Vec3 center = to_eye_ * (scene_.volume->centers[i_] - scene_.middle);
        const Vec3 g = gradient(channel, cells);
        const double det = cxx_ * cyy_ - cxy_ * cxy_;
        return {to_float(middle_.x + center.x),
                to_float(middle_.y + center.y),
                to_float(center.z),
                to_float(1 / szz_),
                to_float(shear_.x),
                to_float(shear_.y),
                to_float(std::sqrt(cyy_ / det)),
                to_float(-cxy_ / std::sqrt(cyy_ * det)),
                to_float(1 / std::sqrt(cyy_)),
                value(channel, cells),
                to_float(g.x),
                to_float(g.y),
                to_float(g.x * shear_.x + g.y * shear_.y + g.z),
                moment(channel, cells),
                to_float(std::sqrt(std::max(cxx_, 0.0))),
                to_float(std::sqrt(std::max(cyy_, 0.0)))};
    }

    [[nodiscard]] EyeRange range(const RbfChannel& channel, const Cells& cells) const {
        const double middle = static_cast<double>(value(channel, cells)), bow = static_cast<double>(moment(channel, cells));
        const double spread = value_spread(channel, i_, reach_ * matrix(scene_.volume->frames[i_])) * cells.scale * 1.001 +
                              1e-5 * (std::abs(middle) + std::abs(bow)) + 0.01;
        return {to_float(middle - spread + std::min(bow, 0.0)), to_float(middle + spread + std::max(bow, 0.0))};
    }

    [[nodiscard]] EyeColor color(const RbfChannel& channel, const Cells& cells) const {
        const Vec3 g = gradient(channel, cells);
        return {value(channel, cells),  to_float(g.x * shear_.x + g.y * shear_.y + g.z),
                to_float(g.x),          to_float(g.y),
                moment(channel, cells), {}};
    }

    [[nodiscard]] EyeBend bend(const RbfChannel& channel, const Cells& cells) const {
        if (channel.hessians.empty()) return {};
        const Mat3 bend = 0.5 * cells.scale * (to_eye_ * matrix(channel.hessians[i_]) * glm::transpose(to_eye_));
        const Vec3 shear(shear_.x, shear_.y, 1), sheared = bend * shear;
        return {to_float(glm::dot(shear, sheared)),
                to_float(2 * sheared.x),
                to_float(2 * sheared.y),
                to_float(bend[0][0]),
                to_float(bend[0][1]),
                to_float(bend[1][1]),
                {}};
    }

    [[nodiscard]] EyeAxes axes() const {
        const Mat3 world = inverse_symmetric_root(scene_.volume->frames[i_]);
        const Mat3 rows = world * glm::transpose(to_eye_);  // for offsets in eye space
        EyeAxes result{};
        for (std::size_t a = 0; a < 3; ++a) {
            const int row = static_cast<int>(a);
            result.rows[4 * a] = to_float(rows[0][row]);
            result.rows[4 * a + 1] = to_float(rows[1][row]);
            result.rows[4 * a + 2] = to_float(rows[0][row] * shear_.x + rows[1][row] * shear_.y + rows[2][row]);
        }
        return result;
    }

private:
    [[nodiscard]] Vec3 gradient(const RbfChannel& channel, const Cells& cells) const {
        const auto& g = channel.gradients[i_];
        return cells.scale * (to_eye_ * Vec3(g[0], g[1], g[2]));
    }
    [[nodiscard]] float value(const RbfChannel& channel, const Cells& cells) const {
        return to_float(static_cast<double>(channel.values[i_]) * cells.scale + cells.offset);
    }
    /// The moment for e in the widened frame.
    [[nodiscard]] float moment(const RbfChannel& channel, const Cells& cells) const {
        return to_float(static_cast<double>(channel.moments[i_]) * cells.scale * reach_);
    }

    const SplatScene& scene_;
    Mat3 to_eye_;
    Vec3 middle_;
    double reach_;
    std::size_t i_ = 0;
    double szz_ = 1, cxx_ = 1, cxy_ = 0, cyy_ = 1;
    Vec2 shear_{0.0};
};

}  // namespace

void eye_splats(EyeSplats& result, const SplatScene& scene, const View& view, const Classification& classification) {
    const std::size_t count = scene.volume->size();
    const bool separable = scene.form == KernelForm::Separable;
    result.splats.resize(count);
    if (scene.convex()) result.ranges.resize(count);
    if (scene.bent) result.bends.resize(count);
    if (scene.color_channel) result.colors.resize(count);
    if (scene.color_channel && scene.bent) result.color_bends.resize(count);
    if (separable) result.axes.resize(count);
    const Cells values = opacity_cells(scene, classification), colors = color_cells(scene, classification);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
        ToEye to_eye(scene, view);
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            to_eye.set_kernel(i);
            result.splats[i] = to_eye.splat(scene.opacity_values(), values);
            if (scene.convex()) result.ranges[i] = to_eye.range(scene.opacity_values(), values);
            if (scene.bent) result.bends[i] = to_eye.bend(scene.opacity_values(), values);
            if (scene.color_channel) result.colors[i] = to_eye.color(scene.color_values(), colors);
            if (scene.color_channel && scene.bent) result.color_bends[i] = to_eye.bend(scene.color_values(), colors);
            if (separable) result.axes[i] = to_eye.axes();
        }
    });
}

float value_offset(const SplatScene& scene, const Classification& classification) {
    return scene.normalized ? 0.0f : to_float(-classification.table.min * opacity_cells(scene, classification).scale);
}

float color_offset(const SplatScene& scene, const Classification& classification) {
    return scene.normalized ? 0.0f : to_float(-classification.colors.min * color_cells(scene, classification).scale);
}

}  // namespace subvol::detail
