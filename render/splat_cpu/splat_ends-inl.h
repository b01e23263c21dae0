// SPDX-License-Identifier: Apache-2.0
// The values where rays enter and leave the volume. Sheets alone would miss a body that is thinner than their distance, and put
// the value of a sheet outside the volume on its surface.
//
//     ray 1 --|---|-------(x)--|------|--(x)---|-->       Layer 0 has the first end of each ray of a tile (x), layer 1 the
//     ray 2 --|--(x)------|----|----(x)--------|-->       second, and so on. A layer is summed like a sheet, but each pixel
//     ray 3 --|---|-------|(x)-|-(x)--|--------|-->       has its own depth.
//
// Included once for every instruction set: see splat_cpu.cpp.
#if defined(SUBVOL_SPLAT_ENDS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_SPLAT_ENDS_INL_H
#undef SUBVOL_SPLAT_ENDS_INL_H
#else
#define SUBVOL_SPLAT_ENDS_INL_H
#endif

#include <hwy/aligned_allocator.h>
#include <hwy/highway.h>

#include <algorithm>
#include <new>

#include "splat_classify-inl.h"
#include "splat_general-inl.h"
#include "subvol/raster.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

class EndFinder {
public:
    explicit EndFinder(const SplatFrame& frame)
        : frame_(frame),
          view_(*frame.view),
          classifier_(*frame.classification),
          general_(frame),
          x_offset_(value_offset(*frame.scene, *frame.classification)),
          color_offset_(color_offset(*frame.scene, *frame.classification)),
          least_gradient_(kLeastChange * PreintegratedTable::kCells / static_cast<float>(frame.scene->diagonal)) {}

    /// Sets the ends of all intervals of a tile's pixels.
    HWY_ATTR void find(int tile, std::vector<IntervalEnd>& ends) {
        x0_ = tile % frame_.tiles_x * SplatFrame::kTile_px;
        y0_ = tile / frame_.tiles_x * SplatFrame::kTile_px;
        place_pixels(view_, x0_, y0_, tile_);
        for (std::size_t layer = 0; start_layer(layer); ++layer) {
            const auto first = frame_.tile_offsets[static_cast<std::size_t>(tile)];
            const auto end = frame_.tile_offsets[static_cast<std::size_t>(tile) + 1];
            for (std::size_t i = first; i < end; ++i) add_kernel(frame_.tile_splats[i]);
            for (std::size_t block = 0; block < kBlocks; ++block) {
                if (scratch().blocks[block].any) write(layer, block, ends);
            }
        }
    }

private:
    struct Block {
        HWY_ALIGN float depth[kBlock];
        HWY_ALIGN float sums[kSums * kBlock];
        float low = 0, high = 0;  // of the depths
        bool any = false;
    };
    struct Scratch {
        hwy::AlignedFreeUniquePtr<Block[]> blocks = hwy::AllocateAligned<Block>(kBlocks);
        Scratch() {
            if (!blocks) throw std::bad_alloc();
        }
    };
    static Scratch& scratch() {
        thread_local Scratch memory;
        return memory;
    }

    /// The intervals of a pixel, {first, end}; none outside the picture.
    [[nodiscard]] std::pair<std::size_t, std::size_t> intervals(std::size_t block, std::size_t lane) const {
        const int x = x0_ + static_cast<int>(block % kColumns * kBlockWidth + lane % kBlockWidth);
        const int y = y0_ + static_cast<int>(block / kColumns * kBlockHeight + lane / kBlockWidth);
        if (x >= view_.width() || y >= view_.height()) return {0, 0};
        const auto id = pixel_index(view_.width(), x, y);
        return {frame_.intervals.offsets[id], frame_.intervals.offsets[id + 1]};
    }

    /// Returns whether any ray has so many ends.
    bool start_layer(std::size_t layer) {
        low_ = std::numeric_limits<float>::infinity();
        high_ = -low_;
        for (std::size_t block = 0; block < kBlocks; ++block) start_block(layer, block, scratch().blocks[block]);
        return low_ <= high_;
    }

    void start_block(std::size_t layer, std::size_t block, Block& b) {
        b.any = false;
        b.low = std::numeric_limits<float>::infinity();
        b.high = -b.low;
        float some = 0;
        for (std::size_t lane = 0; lane < kBlock; ++lane) {
            const auto [first, end] = intervals(block, lane);
            const bool has = 2 * (end - first) > layer;
            b.depth[lane] = has ? frame_.intervals.depths[2 * first + layer] : std::numeric_limits<float>::infinity();
            if (!has) continue;
            b.any = true;
            some = b.depth[lane];
            b.low = std::min(b.low, some);
            b.high = std::max(b.high, some);
        }
        if (!b.any) return;
        // The other lanes compute something finite that is not used.
        for (float& depth : b.depth) depth = std::isfinite(depth) ? depth : some;
        std::fill_n(b.sums, kSums * kBlock, 0.0f);
        low_ = std::min(low_, b.low);
        high_ = std::max(high_, b.high);
    }

    /// Adds a kernel to the blocks that its box touches.
    HWY_ATTR void add_kernel(std::uint32_t id) {
        const EyeSplat& s = frame_.kernels.splats[id];
        const float reach = 1.0f / std::sqrt(s.inv_szz), front = s.depth - reach, back = s.depth + reach;
        if (!(front <= high_ && back >= low_) || !usable(id)) return;
        const auto half = [&](float extent, float shear) { return std::sqrt(extent * extent + shear * reach * shear * reach); };
        const float hx = half(s.extent_x, s.shear_x), hy = half(s.extent_y, s.shear_y);
        const float near = std::max(front, low_), far = std::min(back, high_);
        const auto [x0, x1] = range(s.center_x - hx, s.center_x + hx, near, far,
                                    0.5f * static_cast<float>(view_.width()) - tile_.left, kBlockWidth, kColumns);
        const auto [y0, y1] = range(-s.center_y - hy, -s.center_y + hy, near, far,
                                    0.5f * static_cast<float>(view_.height()) - tile_.top, kBlockHeight, kRows);
        for (int row = y0; row <= y1; ++row) {
            for (int column = x0; column <= x1; ++column) {
                Block& b = scratch().blocks[static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(column)];
                if (!b.any || front > b.high || back < b.low) continue;
                add_to_block(id, s, static_cast<std::size_t>(row), static_cast<std::size_t>(column), b);
            }
        }
    }

    /// Whether the numbers of a kernel are such that its sums are finite at any depth. They are not if it is so flat that
    /// rounding made its frame indefinite, or infinitely thin.
    [[nodiscard]] bool usable(std::uint32_t id) const {
        const EyeSplat& s = frame_.kernels.splats[id];
        bool all = true;
        for (const float v : {s.inv_szz, s.shear_x, s.shear_y, s.root_xx, s.root_xy, s.root_yy, s.value_slope}) {
            all = all && std::abs(v) < kMostOfKernel;  // false for NaN
        }
        if (frame_.scene->form != KernelForm::Separable) return all;
        for (const float v : frame_.kernels.axes[id].rows) all = all && std::abs(v) < kMostOfKernel;
        return all;
    }

    /// The blocks that an interval of eye space meets between two depths, with a pixel more on each side.
    [[nodiscard]] std::pair<int, int> range(float low, float high, float near, float far, float middle_px, std::size_t size_px,
                                            std::size_t count) const {
        const auto per_pixel = static_cast<float>(1 / view_.pixel());
        float a = per_pixel, b = per_pixel;
        if (view_.perspective()) {
            a /= frame_.sheets.middle + near;
            b /= frame_.sheets.middle + far;
        }
        const float first = middle_px + std::min(low * a, low * b) - 1, last = middle_px + std::max(high * a, high * b) + 1;
        const auto size = static_cast<float>(size_px), end = static_cast<float>(count);
        if (!(last >= 0) || !(first < size * end)) return {0, -1};
        return {static_cast<int>(std::max(first / size, 0.0f)), static_cast<int>(std::min(last / size, end - 1))};
    }

    HWY_ATTR void add_to_block(std::uint32_t id, const EyeSplat& s, std::size_t row, std::size_t column, Block& b) const {
        const Lanes d;
        const auto z = hn::Load(d, b.depth);
        const auto across = view_.perspective() ? hn::Add(hn::Set(d, frame_.sheets.middle), z) : hn::Set(d, 1.0f);
        Offsets at;
        at.zs = hn::Sub(z, hn::Set(d, s.depth));
        const auto middle_x = hn::MulAdd(hn::Set(d, s.shear_x), at.zs, hn::Set(d, s.center_x));
        const auto middle_y = hn::MulAdd(hn::Set(d, s.shear_y), at.zs, hn::Set(d, s.center_y));
        at.x = hn::MulSub(hn::Load(d, tile_.x + column * kBlock), across, middle_x);
        at.y = hn::MulSub(hn::Load(d, tile_.y + row * kBlock), across, middle_y);
        const auto across_row = hn::Mul(hn::Set(d, s.root_yy), at.y);
        const auto along_row = hn::MulAdd(hn::Set(d, s.root_xx), at.x, hn::Mul(hn::Set(d, s.root_xy), at.y));
        at.e = hn::MulAdd(along_row, along_row,
                          hn::MulAdd(across_row, across_row, hn::Mul(hn::Mul(at.zs, at.zs), hn::Set(d, s.inv_szz))));
        // Far outside a flat kernel e overflows; beyond 1 its weight is 0 anyway.
        at.e = hn::Min(at.e, hn::Set(d, 4.0f));
        general_.add_block(id, s, at, b.sums);
    }

    HWY_ATTR void write(std::size_t layer, std::size_t block, std::vector<IntervalEnd>& ends) {
        const Lanes d;
        const SplatScene& scene = *frame_.scene;
        const Block& b = scratch().blocks[block];
        const auto weight = hn::Load(d, b.sums);
        auto known = scene.normalized ? hn::Gt(weight, hn::Set(d, static_cast<float>(kLeastWeight))) : hn::Eq(weight, weight);
        if (scene.half_weight > 0) known = hn::And(known, hn::Gt(weight, hn::Set(d, scene.half_weight)));
        const auto divisor = hn::IfThenElse(known, weight, hn::Set(d, 1.0f));
        const auto far = hn::Set(d, kFarCells);
        const auto mean = [&](std::size_t which, float offset) HWY_ATTR {
            const auto total = hn::Load(d, b.sums + which * kBlock);
            const auto v = scene.normalized ? hn::Div(total, divisor) : hn::Add(total, hn::Set(d, offset));
            return hn::Min(hn::Max(v, hn::Neg(far)), far);
        };
        const auto x = mean(kValue, x_offset_);
        HWY_ALIGN float values[kBlock], colors[kBlock], diffuse[kBlock], specular[kBlock], cover[kBlock];
        hn::Store(hn::IfThenElse(known, x, hn::Set(d, kUnknownValue)), d, values);
        hn::Store(scene.color_channel ? mean(kColor, color_offset_) : hn::Zero(d), d, colors);
        const Light light = light_in(block, b, scene.normalized ? hn::Div(hn::Set(d, 1.0f), divisor) : hn::Set(d, 1.0f));
        hn::Store(light.diffuse, d, diffuse);
        hn::Store(light.specular, d, specular);
        const bool lit = scene.shading && layer % 2 == 0;
        if (lit) hn::Store(cover_of_pixel(x, hn::Load(d, b.depth)), d, cover);
        for (std::size_t lane = 0; lane < kBlock; ++lane) {
            const auto [first, end] = intervals(block, lane);
            if (2 * (end - first) <= layer) continue;
            IntervalEnd& to = ends[2 * first + layer];
            to = {values[lane], colors[lane], {diffuse[lane], specular[lane]}};
            if (!lit) continue;
            const BoundaryLight& entry = frame_.entry_lights[first + layer / 2];
            to.light.diffuse += cover[lane] * (entry.diffuse - diffuse[lane]);
            to.light.specular += cover[lane] * (entry.specular - specular[lane]);
        }
    }

    /// How much the boundary is a surface: not at all if a stretch as long as a pixel is wide lets half of the light through or
    /// more, wholly if it lets none through.
    HWY_ATTR Floats cover_of_pixel(Floats x, Floats depth) const {
        const Lanes d;
        const auto pixel = hn::Set(d, static_cast<float>(view_.pixel()));
        const auto across = view_.perspective() ? hn::Add(hn::Set(d, frame_.sheets.middle), depth) : hn::Set(d, 1.0f);
        Floats mean[4];
        classifier_.middle(x, mean);
        const auto passes = hn::Exp(d, hn::Neg(hn::Mul(hn::Mul(pixel, across), mean[0])));
        return hn::Max(hn::NegMulAdd(hn::Set(d, 2.0f), passes, hn::Set(d, 1.0f)), hn::Zero(d));
    }

    HWY_ATTR Light light_in(std::size_t block, const Block& b, Floats scale) const {
        const Lanes d;
        Arrival arrives{hn::Set(d, 1.0f), hn::Set(d, 1.0f)};
        if (frame_.scene->light) {
            const auto depth = hn::Load(d, b.depth);
            const auto across = view_.perspective() ? hn::Add(hn::Set(d, frame_.sheets.middle), depth) : hn::Set(d, 1.0f);
            arrives = arrival_at(*frame_.scene->light, frame_.to_light,
                                 {hn::Mul(across, hn::Load(d, tile_.x + block % kColumns * kBlock)),
                                  hn::Mul(across, hn::Load(d, tile_.y + block / kColumns * kBlock)), depth});
        }
        if (!frame_.scene->shading) return unlit(Shading{}, arrives);
        const auto part = [&](std::size_t axis)
                              HWY_ATTR { return hn::Mul(hn::Load(d, b.sums + (kGradient + axis) * kBlock), scale); };
        const auto back = hn::Set(d, view_.perspective() ? -1.0f : 0.0f);
        const Vector to_eye{hn::Mul(back, hn::Load(d, tile_.x + block % kColumns * kBlock)),
                            hn::Mul(back, hn::Load(d, tile_.y + block / kColumns * kBlock)), hn::Set(d, -1.0f)};
        return light(*frame_.scene->shading, {part(0), part(1), part(2)}, normalize(to_eye), least_gradient_, arrives);
    }

    const SplatFrame& frame_;
    const View& view_;
    Classifier classifier_;
    GeneralSums general_;
    TilePixels tile_;
    float x_offset_, color_offset_, least_gradient_;
    float low_ = 0, high_ = 0;  // depths of the layer
    int x0_ = 0, y0_ = 0;
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
