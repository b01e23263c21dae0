// SPDX-License-Identifier: Apache-2.0
// The values where rays enter and leave the volume. Sheets alone would miss a body that is thinner than their distance, and put
// the value of a sheet outside the volume on its surface.
//
//     ray 1 --|---|-------(x)--|------|--(x)---|-->       Layer 0 has the first end of each ray of a tile (x), layer 1 the
//     ray 2 --|--(x)------|----|----(x)--------|-->       second, and so on. A layer is summed like a sheet, but each pixel
//     ray 3 --|---|-------|(x)-|-(x)--|--------|-->       has its own depth.
//
// Several layers are summed at once, so that the kernels of a tile are gone through once for nearly all volumes. kPlain is that
// of the tile renderer.
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
#include <bit>
#include <new>

#include "splat_classify-inl.h"
#include "splat_general-inl.h"
#include "subvol/raster.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

template <bool kPlain>
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
        if (!frame_.meets_intervals(x0_, y0_)) return;
        place_pixels(view_, x0_, y0_, tile_);
        blocks_ = scratch();
        place_blocks();
        const std::size_t layers = list_ends();
        for (std::size_t first = 0; first < layers; first += kLayers) {
            for (std::size_t k = 0; k < kLayers; ++k) start_layer(first + k, k);
            const auto begin = frame_.tile_offsets[static_cast<std::size_t>(tile)];
            const auto end = frame_.tile_offsets[static_cast<std::size_t>(tile) + 1];
            for (std::size_t i = begin; i < end; ++i) add_kernel(frame_.tile_splats[i]);
            for (std::size_t block = 0; block < kBlocks; ++block) {
                for (std::size_t k = 0; k < kLayers; ++k) {
                    if (blocks_[block].layers[k].any()) write(first + k, block, blocks_[block].layers[k], ends);
                }
            }
        }
    }

private:
    static constexpr std::size_t kLayers = 4;
    static constexpr float kNone = std::numeric_limits<float>::infinity();
    static constexpr float kRoom = 1.001f;  // lengths are this much larger, so that rounding does not lose a kernel

    /// Depths, none if low > high.
    struct Depths {
        float low = kNone, high = -kNone;

        [[nodiscard]] bool any() const { return low <= high; }
        [[nodiscard]] bool meets(float front, float back) const { return front <= high && back >= low; }
        void add(float depth) {
            low = std::min(low, depth);
            high = std::max(high, depth);
        }
    };
    struct Layer : Depths {
        HWY_ALIGN float depth[kBlock];
        HWY_ALIGN float sums[(kPlain ? 2 : kSums) * kBlock];
    };
    struct PixelBlock {
        Layer layers[kLayers];
        std::uint32_t first[kBlock], ends[kBlock];  // of each pixel: its first interval, and twice the number of them
    };
    static PixelBlock* scratch() {
        thread_local const hwy::AlignedFreeUniquePtr<PixelBlock[]> memory = hwy::AllocateAligned<PixelBlock>(kBlocks);
        if (!memory) throw std::bad_alloc();
        return memory.get();
    }

    /// The middles of the blocks, as slopes of rays.
    void place_blocks() {
        const auto middle = [](const float* x) { return 0.5f * (x[0] + x[kBlock - 1]); };
        for (std::size_t column = 0; column < kColumns; ++column) block_x_[column] = middle(tile_.x + column * kBlock);
        for (std::size_t row = 0; row < kRows; ++row) block_y_[row] = middle(tile_.y + row * kBlock);
    }

    /// Lists the ends of each pixel, none outside the picture. Returns the largest number of them.
    std::size_t list_ends() {
        std::uint32_t most = 0;
        for (std::size_t block = 0; block < kBlocks; ++block) {
            PixelBlock& b = blocks_[block];
            for (std::size_t lane = 0; lane < kBlock; ++lane) {
                const int x = x0_ + static_cast<int>(block % kColumns * kBlockWidth + lane % kBlockWidth);
                const int y = y0_ + static_cast<int>(block / kColumns * kBlockHeight + lane / kBlockWidth);
                b.first[lane] = b.ends[lane] = 0;
                if (x >= view_.width() || y >= view_.height()) continue;
                const auto id = pixel_index(view_.width(), x, y);
                b.first[lane] = frame_.intervals.offsets[id];
                b.ends[lane] = 2 * (frame_.intervals.offsets[id + 1] - b.first[lane]);
                most = std::max(most, b.ends[lane]);
            }
        }
        return most;
    }

    /// Sets the depths of a layer of the tile, which is summed as the k-th one.
    void start_layer(std::size_t layer, std::size_t k) {
        layers_[k] = {};
        for (std::size_t block = 0; block < kBlocks; ++block) {
            PixelBlock& b = blocks_[block];
            start_block(layer, b, b.layers[k]);
            low_[k][block] = b.layers[k].low;
            high_[k][block] = b.layers[k].high;
            if (b.layers[k].any()) {
                layers_[k].add(b.layers[k].low);
                layers_[k].add(b.layers[k].high);
            }
        }
    }

    void start_block(std::size_t layer, const PixelBlock& b, Layer& to) {
        static_cast<Depths&>(to) = {};
        for (std::size_t lane = 0; lane < kBlock; ++lane) {
            if (b.ends[lane] > layer) to.add(frame_.intervals.depths[2 * std::size_t{b.first[lane]} + layer]);
        }
        if (!to.any()) return;
        // The other lanes compute something finite that is not used.
        for (std::size_t lane = 0; lane < kBlock; ++lane) {
            to.depth[lane] = b.ends[lane] > layer ? frame_.intervals.depths[2 * std::size_t{b.first[lane]} + layer] : to.low;
        }
        std::fill(std::begin(to.sums), std::end(to.sums), 0.0f);
    }

    /// Adds a kernel to the blocks that it touches.
    HWY_ATTR void add_kernel(std::uint32_t id) {
        const EyeSplat& s = frame_.kernels.splats[id];
        Depths met;
        for (const Depths& layer : layers_) {
            const float off = std::max(std::max(layer.low - s.depth, s.depth - layer.high), 0.0f);
            if (!(off * off * s.inv_szz <= kRoom)) continue;
            met.add(layer.low);
            met.add(layer.high);
        }
        if (!met.any() || !usable(id)) return;
        const float reach = 1.0f / std::sqrt(s.inv_szz), front = s.depth - reach, back = s.depth + reach;
        const auto half = [&](float extent, float shear) { return std::sqrt(extent * extent + shear * reach * shear * reach); };
        const float hx = half(s.extent_x, s.shear_x), hy = half(s.extent_y, s.shear_y);
        const float near = std::max(front, met.low), far = std::min(back, met.high);
        const auto [x0, x1] = range(s.center_x - hx, s.center_x + hx, near, far,
                                    0.5f * static_cast<float>(view_.width()) - tile_.left, kBlockWidth, kColumns);
        const auto [y0, y1] = range(-s.center_y - hy, -s.center_y + hy, near, far,
                                    0.5f * static_cast<float>(view_.height()) - tile_.top, kBlockHeight, kRows);
        if (x1 < x0) return;
        for (int row = y0; row <= y1; ++row) {
            for (std::size_t k = 0; k < kLayers; ++k) {
                if (!layers_[k].meets(near, far)) continue;
                add_to_row(id, s, kRoom * reach, k, static_cast<std::size_t>(row), x0, x1);
            }
        }
    }

    /// Adds a kernel to the blocks of a row that its sections at the depths of a layer touch. Over the depths z of a block,
    /// relative to the kernel, that its reach meets, the middle of the block is off the middle of the section by (x·M − c) + (x
    /// − shear)·z, M being the kernel's distance from the eye; the section is largest at the least |z|.
    HWY_ATTR void add_to_row(std::uint32_t id, const EyeSplat& s, float reach, std::size_t k, std::size_t row, int x0, int x1) {
        using Columns = hn::CappedTag<float, 8>;
        const Columns d;
        const auto set = [&](float v) HWY_ATTR { return hn::Set(d, v); };
        const float scale = view_.perspective() ? 1.0f : 0.0f,
                    distance = scale * (frame_.sheets.middle + s.depth) + (1 - scale);
        const auto per_depth = set(scale),
                   half = set((0.5f * kBlockWidth - kPastCenter_px) * static_cast<float>(view_.pixel()));
        const auto half_y = set((0.5f * kBlockHeight - kPastCenter_px) * static_cast<float>(view_.pixel()));
        for (std::size_t first = static_cast<std::size_t>(x0) / hn::Lanes(d) * hn::Lanes(d);
             first <= static_cast<std::size_t>(x1); first += hn::Lanes(d)) {
            const auto low = hn::Load(d, low_[k] + row * kColumns + first),
                       high = hn::Load(d, high_[k] + row * kColumns + first);
            const auto a = hn::Max(hn::Sub(low, set(s.depth)), set(-reach)),
                       b = hn::Min(hn::Sub(high, set(s.depth)), set(reach));
            const auto off = hn::Max(hn::Max(a, hn::Neg(b)), hn::Zero(d));
            const auto root = hn::Sqrt(hn::Max(hn::NegMulAdd(hn::Mul(off, off), set(s.inv_szz), set(kRoom)), hn::Zero(d)));
            const auto z = hn::Mul(set(0.5f), hn::Add(a, b)), around = hn::Mul(set(0.5f), hn::Sub(b, a));
            const auto far = hn::MulAdd(per_depth, b, set(distance));
            const auto touches = [&](auto place, auto half_block, float center, float shear, float extent) HWY_ATTR {
                const auto slope = hn::MulSub(per_depth, place, set(shear));
                const auto apart = hn::Abs(hn::MulAdd(slope, z, hn::MulSub(place, set(distance), set(center))));
                const auto sizes = hn::MulAdd(hn::Abs(slope), around, hn::MulAdd(set(extent), root, hn::Mul(half_block, far)));
                return hn::Le(apart, hn::Mul(sizes, set(kRoom)));
            };
            auto touched =
                hn::And(hn::Le(a, b), touches(hn::Load(d, block_x_ + first), half, s.center_x, s.shear_x, s.extent_x));
            touched = hn::And(touched, touches(set(block_y_[row]), half_y, s.center_y, s.shear_y, s.extent_y));
            static_assert(hn::MaxLanes(d) <= 8);
            std::uint8_t bytes[8] = {};
            (void)hn::StoreMaskBits(d, touched, bytes);
            for (std::uint32_t bits = bytes[0]; bits != 0; bits &= bits - 1) {
                const std::size_t column = first + static_cast<std::size_t>(std::countr_zero(bits));
                add_to_block(id, s, row, column, blocks_[row * kColumns + column].layers[k]);
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

    /// The blocks with pixels whose centres are in an interval of eye space between two depths.
    [[nodiscard]] std::pair<int, int> range(float low, float high, float near, float far, float middle_px, std::size_t size_px,
                                            std::size_t count) const {
        const auto per_pixel = static_cast<float>(1 / view_.pixel());
        float a = per_pixel, b = per_pixel;
        if (view_.perspective()) {
            a /= frame_.sheets.middle + near;
            b /= frame_.sheets.middle + far;
        }
        const float first = middle_px + std::min(low * a, low * b) + kPastCenter_px;
        const float last = middle_px + std::max(high * a, high * b) - kPastCenter_px;
        const auto size = static_cast<float>(size_px), end = static_cast<float>(count);
        if (!(last >= 0) || !(first < size * end)) return {0, -1};
        return {static_cast<int>(std::max(first / size, 0.0f)), static_cast<int>(std::min(last / size, end - 1))};
    }

    HWY_ATTR void add_to_block(std::uint32_t id, const EyeSplat& s, std::size_t row, std::size_t column, Layer& b) const {
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
        if constexpr (kPlain) {
            add_plain_block(s, at, b.sums);
        } else {
            general_.add_block(id, s, at, b.sums);
        }
    }

    /// GeneralSums::add_block for scenes of which `plain` is true.
    HWY_ATTR static void add_plain_block(const EyeSplat& s, const Offsets& at, float* to) {
        const Lanes d;
        const auto left = hn::Max(hn::Sub(hn::Set(d, 1.0f), at.e), hn::Zero(d));
        const auto w = hn::Mul(hn::Mul(left, left), left);
        auto v = hn::MulAdd(hn::Set(d, s.value_slope), at.zs, hn::Set(d, s.value));
        v = hn::MulAdd(hn::Set(d, s.gradient_y), at.y, v);
        v = hn::MulAdd(hn::Set(d, s.moment), at.e, hn::MulAdd(hn::Set(d, s.gradient_x), at.x, v));
        hn::Store(hn::Add(hn::Load(d, to), w), d, to);
        hn::Store(hn::MulAdd(w, v, hn::Load(d, to + kBlock)), d, to + kBlock);
    }

    HWY_ATTR void write(std::size_t layer, std::size_t block, const Layer& b, std::vector<IntervalEnd>& ends) {
        const Lanes d;
        const SplatScene& scene = *frame_.scene;
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
        hn::Store(!kPlain && scene.color_channel ? mean(kColor, color_offset_) : hn::Zero(d), d, colors);
        const Light light = light_in(block, b, scene.normalized ? hn::Div(hn::Set(d, 1.0f), divisor) : hn::Set(d, 1.0f));
        hn::Store(light.diffuse, d, diffuse);
        hn::Store(light.specular, d, specular);
        const bool lit = scene.shading && layer % 2 == 0;
        if (lit) hn::Store(cover_of_pixel(x, hn::Load(d, b.depth)), d, cover);
        for (std::size_t lane = 0; lane < kBlock; ++lane) {
            if (blocks_[block].ends[lane] <= layer) continue;
            const std::size_t first = blocks_[block].first[lane];
            IntervalEnd& to = ends[2 * first + layer];
            to = {values[lane], colors[lane], {diffuse[lane], specular[lane]}};
            if (!lit) continue;
            const SurfaceLight& entry = frame_.entry_lights[first + layer / 2];
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

    HWY_ATTR Light light_in(std::size_t block, const Layer& b, Floats scale) const {
        const Lanes d;
        Arrival arrives{hn::Set(d, 1.0f), hn::Set(d, 1.0f)};
        if constexpr (kPlain) return unlit(Shading{}, arrives);
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
    PixelBlock* blocks_ = nullptr;
    Depths layers_[kLayers];                                          // of the tile
    HWY_ALIGN float low_[kLayers][kBlocks], high_[kLayers][kBlocks];  // of the blocks
    HWY_ALIGN float block_x_[kColumns];
    float block_y_[kRows];
    int x0_ = 0, y0_ = 0;
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
