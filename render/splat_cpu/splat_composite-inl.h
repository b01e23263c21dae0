// SPDX-License-Identifier: Apache-2.0
// From sums to light: composites a block of pixels through the sheets of a batch. Included once for every instruction set: see
// splat_cpu.cpp.
#if defined(SUBVOL_SPLAT_COMPOSITE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_SPLAT_COMPOSITE_INL_H
#undef SUBVOL_SPLAT_COMPOSITE_INL_H
#else
#define SUBVOL_SPLAT_COMPOSITE_INL_H
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "splat_classify-inl.h"
#include "splat_light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

/// The values of a block of pixels on one sheet.
struct SheetValues {
    Floats x;  // in cells
    Mask known;
    Floats weight;
    Floats color;  // the second channel's, in cells
    Light light;
};

/// A block of pixels in registers, between two sheets.
template <bool kPlain>
class BlockWalk {
public:
    HWY_ATTR BlockWalk(const SplatFrame& frame, const Classifier& classifier, BlockState& state)
        : frame_(frame), classifier_(classifier), state_(state) {
        const Lanes d;
        transmittance_ = hn::Load(d, state.transmittance);
        red_ = hn::Load(d, state.red);
        green_ = hn::Load(d, state.green);
        blue_ = hn::Load(d, state.blue);
        depth_ = hn::Load(d, state.depth);
        enter_ = hn::Load(d, state.enter);
        exit_ = hn::Load(d, state.exit);
        last_.x = hn::Load(d, state.value);
        last_.known = hn::Gt(hn::Load(d, state.known), hn::Zero(d));
        last_.weight = hn::Load(d, state.weight);
        last_.color = hn::Load(d, state.color);
        last_.light = {hn::Load(d, state.diffuse), hn::Load(d, state.specular)};
    }

    HWY_ATTR void store() {
        const Lanes d;
        hn::Store(transmittance_, d, state_.transmittance);
        hn::Store(red_, d, state_.red);
        hn::Store(green_, d, state_.green);
        hn::Store(blue_, d, state_.blue);
        hn::Store(depth_, d, state_.depth);
        hn::Store(enter_, d, state_.enter);
        hn::Store(exit_, d, state_.exit);
        hn::Store(last_.x, d, state_.value);
        hn::Store(hn::IfThenElseZero(last_.known, hn::Set(d, 1.0f)), d, state_.known);
        hn::Store(last_.weight, d, state_.weight);
        hn::Store(last_.color, d, state_.color);
        hn::Store(last_.light.diffuse, d, state_.diffuse);
        hn::Store(last_.light.specular, d, state_.specular);
    }

    /// Composites what lies between the last sheet, at `front_z`, and the next one, at `back_z` with the values `here`.
    HWY_ATTR void go(float front_z, float back_z, const SheetValues& here) {
        const Lanes d;
        const auto back = hn::Set(d, back_z);
        bool placed = false;
        Place place;
        for (auto active = hn::Lt(enter_, back); !hn::AllFalse(d, active); active = hn::And(active, hn::Lt(enter_, back))) {
            stretch(active, front_z, back_z, here, place, placed);
            const auto opaque = hn::And(active, hn::Lt(transmittance_, hn::Set(d, kSplatCutoff)));
            enter_ = hn::IfThenElse(opaque, hn::Set(d, kNever), enter_);
            active = hn::And(hn::AndNot(opaque, active), hn::Le(exit_, back));
            if (hn::AllFalse(d, active)) break;
            next_intervals(active);
        }
        last_ = here;
        last_placed_ = placed;
        if (placed) last_place_ = place;
    }

    /// Takes the values of a sheet without compositing what lies before it.
    HWY_ATTR void skip_to(const SheetValues& here) {
        last_ = here;
        last_placed_ = false;
    }

private:
    /// Composites the part of each ray between two sheets that lies in its interval.
    HWY_ATTR void stretch(Mask active, float front_z, float back_z, const SheetValues& here, Place& place, bool& placed) {
        const Lanes d;
        const auto front = hn::Set(d, front_z), back = hn::Set(d, back_z);
        auto from = hn::Max(enter_, front), to = hn::Min(exit_, back);
        if constexpr (!kPlain) {
            if (frame_.scene->half_weight > 0) cut_where_weights_end(front, back, here.weight, from, to);
        }
        const auto seen = hn::And(hn::And(active, hn::Lt(from, to)), hn::Or(last_.known, here.known));
        if (hn::AllFalse(d, seen)) return;
        // The depths of rays that are done are infinite and would lead to NaN.
        from = hn::IfThenElse(seen, from, front);
        to = hn::IfThenElse(seen, to, front);
        const auto x_front = hn::IfThenElse(last_.known, last_.x, here.x);
        const auto x_back = hn::IfThenElse(here.known, here.x, last_.x);
        const auto per_depth = hn::Div(hn::Set(d, 1.0f), hn::Sub(back, front));
        const auto slope = hn::Mul(hn::Sub(x_back, x_front), per_depth);
        const auto x0 = hn::IfThenElse(hn::Eq(from, front), x_front, hn::MulAdd(slope, hn::Sub(from, front), x_front));
        const auto x1 = hn::IfThenElse(hn::Eq(to, back), x_back, hn::MulAdd(slope, hn::Sub(to, front), x_front));
        if (classifier_.transparent(seen, x0, x1)) return;

        Floats mean[4];
        const auto whole = hn::And(hn::Eq(x0, last_.x), hn::Eq(x1, here.x));
        if (hn::AllTrue(d, hn::Or(whole, hn::Not(seen)))) {
            if (!last_placed_) last_place_ = classifier_.place(last_.x);
            if (!placed) place = classifier_.place(here.x);
            last_placed_ = placed = true;
            classifier_.means(last_place_, place, mean);
        } else {
            classifier_.means(classifier_.place(x0), classifier_.place(x1), mean);
        }
        const auto length = hn::Mul(hn::Sub(to, from), hn::Load(d, state_.ray_length));
        const auto passes = hn::Exp(d, hn::Neg(hn::Mul(length, mean[0])));
        // Rounding must not leave light where there is none, nor make a colour brighter than 1.
        const auto visible = hn::And(seen, hn::Gt(mean[0], hn::Zero(d)));
        const auto opacity = hn::IfThenElseZero(visible, hn::Sub(hn::Set(d, 1.0f), passes));
        for (std::size_t c = 1; c < 4; ++c) mean[c] = hn::Min(mean[c], mean[0]);
        const auto light = hn::Mul(transmittance_, opacity);
        if constexpr (!kPlain) {
            if (frame_.scene->color_channel) take_second_color(here, mean);
        }
        const auto per_extinction = hn::Div(light, hn::Max(mean[0], hn::Set(d, 1e-37f)));
        if constexpr (kPlain) {
            red_ = hn::MulAdd(per_extinction, mean[1], red_);
            green_ = hn::MulAdd(per_extinction, mean[2], green_);
            blue_ = hn::MulAdd(per_extinction, mean[3], blue_);
        } else {
            const auto half = hn::Set(d, 0.5f);
            const auto lit = hn::Mul(hn::Mul(half, both_ends(last_.light.diffuse, here.light.diffuse, here)), per_extinction);
            const auto gloss = hn::Mul(hn::Mul(half, both_ends(last_.light.specular, here.light.specular, here)), light);
            red_ = hn::Add(red_, hn::MulAdd(lit, mean[1], gloss));
            green_ = hn::Add(green_, hn::MulAdd(lit, mean[2], gloss));
            blue_ = hn::Add(blue_, hn::MulAdd(lit, mean[3], gloss));
        }
        // Rays that are done have no middle: it would be 0 times infinity.
        const auto middle = hn::IfThenElseZero(visible, hn::Mul(hn::Set(d, 0.5f), hn::Add(from, to)));
        depth_ = hn::MulAdd(light, middle, depth_);
        transmittance_ = hn::IfThenElse(visible, hn::Mul(transmittance_, passes), transmittance_);
    }

    /// Without a boundary the volume ends where the sum of weights, linear between sheets, falls below a level.
    HWY_ATTR void cut_where_weights_end(Floats front, Floats back, Floats weight, Floats& from, Floats& to) const {
        const Lanes d;
        const auto level = hn::Set(d, frame_.scene->half_weight);
        const auto inside0 = hn::Gt(last_.weight, level), inside1 = hn::Gt(weight, level);
        const auto difference = hn::Sub(weight, last_.weight);
        const auto part =
            hn::Div(hn::Sub(level, last_.weight), hn::IfThenElse(hn::Xor(inside0, inside1), difference, hn::Set(d, 1.0f)));
        const auto crossing = hn::MulAdd(part, hn::Sub(back, front), front);
        from = hn::IfThenElse(inside0, from, hn::IfThenElse(inside1, hn::Max(from, crossing), hn::Set(d, kNever)));
        to = hn::IfThenElse(inside1, to, hn::Min(to, crossing));
    }

    /// Keeps the extinction; the emission becomes its product with the mean of the second channel's colours at both ends.
    HWY_ATTR void take_second_color(const SheetValues& here, Floats mean[4]) const {
        const Lanes d;
        Floats front[3], back[3];
        classifier_.color(hn::IfThenElse(last_.known, last_.color, here.color), front);
        classifier_.color(hn::IfThenElse(here.known, here.color, last_.color), back);
        for (std::size_t c = 0; c < 3; ++c)
            mean[c + 1] = hn::Mul(hn::Mul(hn::Set(d, 0.5f), mean[0]), hn::Add(front[c], back[c]));
    }

    /// The sum over the two ends of a stretch; an end without a value is taken to be like the other.
    HWY_ATTR Floats both_ends(Floats front, Floats back, const SheetValues& here) const {
        return hn::Add(hn::IfThenElse(last_.known, front, back), hn::IfThenElse(here.known, back, front));
    }

    HWY_ATTR void next_intervals(Mask through) {
        const Lanes d;
        HWY_ALIGN float done[kBlock];
        hn::Store(hn::IfThenElseZero(through, hn::Set(d, 1.0f)), d, done);
        hn::Store(enter_, d, state_.enter);
        hn::Store(exit_, d, state_.exit);
        const auto& depths = frame_.intervals.depths;
        for (std::size_t i = 0; i < kBlock; ++i) {
            if (done[i] == 0) continue;
            const std::size_t next = ++state_.interval[i];
            const bool more = next < state_.intervals_end[i];
            state_.enter[i] = more ? depths[2 * next] : kNever;
            state_.exit[i] = more ? depths[2 * next + 1] : kNever;
        }
        enter_ = hn::Load(d, state_.enter);
        exit_ = hn::Load(d, state_.exit);
    }

    const SplatFrame& frame_;
    const Classifier& classifier_;
    BlockState& state_;
    Floats transmittance_, red_, green_, blue_, depth_, enter_, exit_;
    SheetValues last_;
    Place last_place_;
    bool last_placed_ = false;
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
