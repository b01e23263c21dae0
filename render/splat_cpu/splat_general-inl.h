// SPDX-License-Identifier: Apache-2.0
// Sums of kernels of any form, with Hessians, a second channel and gradients; splat_sums-inl.h has the short loop for the plain
// ones. Included once for every instruction set: see splat_cpu.cpp.
#if defined(SUBVOL_SPLAT_GENERAL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_SPLAT_GENERAL_INL_H
#undef SUBVOL_SPLAT_GENERAL_INL_H
#else
#define SUBVOL_SPLAT_GENERAL_INL_H
#endif

#include <hwy/highway.h>

#include "splat_light-inl.h"
#include "splat_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

/// The places of a block on a sheet, relative to the middle of a kernel's section.
struct Offsets {
    Floats x, y, zs, e;
};

class GeneralSums {
public:
    explicit GeneralSums(const SplatFrame& frame) : frame_(frame), scene_(*frame.scene) {}

    HWY_ATTR void add(std::uint32_t id, const BatchView& batch, const TilePixels& tile, Cuts& cuts, float* sums) const {
        const Lanes d;
        const EyeSplat& s = frame_.kernels.splats[id];
        cut(s, batch, tile, cuts);
        for (int k = batch.begin; k < batch.end; ++k) {
            const auto across = hn::Set(d, batch.across[k]), x = hn::Set(d, cuts.x[k]), y = hn::Set(d, cuts.y[k]);
            Offsets at{x, y, hn::Set(d, cuts.zs[k]), x};
            for (auto row = cuts.row0[k]; row <= cuts.row1[k]; ++row) {
                const auto c0 = std::max(cuts.column0[k], batch.first_column[k][row]);
                const auto c1 = std::min(cuts.column1[k], batch.last_column[k][row]);
                if (c0 > c1) continue;
                at.y = hn::MulSub(hn::Load(d, tile.y + static_cast<std::size_t>(row) * kBlock), across, y);
                const auto across_row = hn::Mul(hn::Set(d, s.root_yy), at.y);
                const auto e_row = hn::MulAdd(across_row, across_row, hn::Set(d, cuts.e[k]));
                const auto e_slope = hn::Mul(hn::Set(d, s.root_xy), at.y);
                float* to = sums + ((static_cast<std::size_t>(k) * kRows + static_cast<std::size_t>(row)) * kColumns +
                                    static_cast<std::size_t>(c0)) *
                                       (kSums * kBlock);
                for (auto column = c0; column <= c1; ++column, to += kSums * kBlock) {
                    at.x = hn::MulSub(hn::Load(d, tile.x + static_cast<std::size_t>(column) * kBlock), across, x);
                    const auto along_row = hn::MulAdd(hn::Set(d, s.root_xx), at.x, e_slope);
                    at.e = hn::MulAdd(along_row, along_row, e_row);
                    add_block(id, s, at, to);
                }
            }
        }
    }

    /// Adds a kernel to the sums of one block of pixels.
    HWY_ATTR void add_block(std::uint32_t id, const EyeSplat& s, const Offsets& at, float* to) const {
        const Lanes d;
        const auto w = weight(id, at);
        const auto v = value({s.value, s.value_slope, s.gradient_x, s.gradient_y, s.moment, {}},
                             scene_.bent ? &frame_.kernels.bends[id] : nullptr, at);
        const auto sum = [&](std::size_t which, Floats term) HWY_ATTR {
            hn::Store(hn::MulAdd(w, term, hn::Load(d, to + which * kBlock)), d, to + which * kBlock);
        };
        hn::Store(hn::Add(hn::Load(d, to), w), d, to);
        sum(kValue, v);
        if (scene_.color_channel) {
            sum(kColor, value(frame_.kernels.colors[id], scene_.bent ? &frame_.kernels.color_bends[id] : nullptr, at));
        }
        if (scene_.shading) {
            const Vector g = gradient(s, scene_.bent ? &frame_.kernels.bends[id] : nullptr, at);
            sum(kGradient, g.x);
            sum(kGradient + 1, g.y);
            sum(kGradient + 2, g.z);
        }
    }

private:
    HWY_ATTR Floats weight(std::uint32_t id, const Offsets& at) const {
        const Lanes d;
        if (scene_.form == KernelForm::Compact) {
            const auto left = hn::Max(hn::Sub(hn::Set(d, 1.0f), at.e), hn::Zero(d));
            return hn::Mul(hn::Mul(left, left), left);
        }
        if (scene_.form == KernelForm::Radial) return profile(at.e);
        const auto& rows = frame_.kernels.axes[id].rows;
        auto product = hn::Set(d, 1.0f);
        for (std::size_t a = 0; a < 3; ++a) {
            const auto xi =
                hn::MulAdd(hn::Set(d, rows[4 * a]), at.x,
                           hn::MulAdd(hn::Set(d, rows[4 * a + 1]), at.y, hn::Mul(hn::Set(d, rows[4 * a + 2]), at.zs)));
            product = hn::Mul(product, profile(hn::Abs(xi)));
        }
        return product;
    }

    /// The kernel's table over [0,1], linear between its entries, and 0 beyond.
    HWY_ATTR Floats profile(Floats t) const {
        const Lanes d;
        const IntLanes di;
        const auto last = static_cast<float>(scene_.kernel_table.size() - 1);
        const auto at = hn::Min(hn::Mul(t, hn::Set(d, last)), hn::Set(d, last));
        const auto cell = hn::Min(hn::Floor(at), hn::Set(d, last - 1));
        const auto index = hn::ConvertTo(di, cell);
        const auto low = hn::GatherIndex(d, scene_.kernel_table.data(), index);
        const auto high = hn::GatherIndex(d, scene_.kernel_table.data() + 1, index);
        return hn::MulAdd(hn::Sub(at, cell), hn::Sub(high, low), low);
    }

    HWY_ATTR static Floats value(const EyeColor& c, const EyeBend* bend, const Offsets& at) {
        const Lanes d;
        auto v = hn::MulAdd(hn::Set(d, c.value_slope), at.zs, hn::Set(d, c.value));
        v = hn::MulAdd(hn::Set(d, c.gradient_y), at.y, v);
        v = hn::MulAdd(hn::Set(d, c.moment), at.e, hn::MulAdd(hn::Set(d, c.gradient_x), at.x, v));
        if (!bend) return v;
        const auto along = hn::MulAdd(hn::Set(d, bend->zz), at.zs,
                                      hn::MulAdd(hn::Set(d, bend->zx), at.x, hn::Mul(hn::Set(d, bend->zy), at.y)));
        const auto row = hn::MulAdd(hn::Set(d, bend->xx), at.x, hn::Mul(hn::Set(d, 2 * bend->xy), at.y));
        v = hn::MulAdd(at.zs, along, v);
        v = hn::MulAdd(at.x, row, v);
        return hn::MulAdd(hn::Mul(hn::Set(d, bend->yy), at.y), at.y, v);
    }

    /// The gradient of the value that a kernel represents, in eye space.
    HWY_ATTR static Vector gradient(const EyeSplat& s, const EyeBend* bend, const Offsets& at) {
        const Lanes d;
        const auto set = [&](float v) HWY_ATTR { return hn::Set(d, v); };
        const float twice = 2 * s.moment;
        Vector g;
        const auto along_row = hn::MulAdd(set(s.root_xx), at.x, hn::Mul(set(s.root_xy), at.y));
        g.x = hn::MulAdd(set(twice * s.root_xx), along_row, set(s.gradient_x));
        g.y = hn::MulAdd(set(twice * s.root_xy), along_row,
                         hn::MulAdd(set(twice * s.root_yy * s.root_yy), at.y, set(s.gradient_y)));
        g.z = hn::MulAdd(set(twice * s.inv_szz), at.zs, set(s.value_slope));
        if (bend) {
            const auto two = set(2.0f);
            g.x = hn::Add(g.x, hn::MulAdd(set(bend->zx), at.zs,
                                          hn::Mul(two, hn::MulAdd(set(bend->xx), at.x, hn::Mul(set(bend->xy), at.y)))));
            g.y = hn::Add(g.y, hn::MulAdd(set(bend->zy), at.zs,
                                          hn::Mul(two, hn::MulAdd(set(bend->xy), at.x, hn::Mul(set(bend->yy), at.y)))));
            g.z = hn::Add(g.z,
                          hn::MulAdd(set(2 * bend->zz), at.zs, hn::MulAdd(set(bend->zx), at.x, hn::Mul(set(bend->zy), at.y))));
        }
        // Offsets are relative to the section's middle, which moves with the depth.
        g.z = hn::NegMulAdd(set(s.shear_x), g.x, hn::NegMulAdd(set(s.shear_y), g.y, g.z));
        return g;
    }

    const SplatFrame& frame_;
    const SplatScene& scene_;
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
