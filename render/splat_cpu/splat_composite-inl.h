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

/// More steps than these a stretch does not need: light ends at an optical depth of 9, and a step that is too long shrinks to a
/// sixteenth at most.
constexpr int kMostSteps = 96;

/// The largest optical depth of a stretch between two sheets where optical depths are kept: no light passes more than that.
constexpr float kMostDepth = 50;

/// 1 − exp(−x) of optical depths x ≥ 0, with all digits where they are small; the same as opacity_of in exp_log.glsl.
HWY_ATTR inline Floats opacity_of(Floats depth) {
    const Lanes d;
    const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
    const auto x = hn::Max(hn::Neg(depth), set(-87));
    const auto n = hn::Floor(hn::MulAdd(x, set(1.44269504f), set(0.5f)));
    const auto r = hn::MulAdd(n, set(2.12194440e-4f), hn::MulAdd(n, set(-0.693359375f), x));
    auto p = hn::MulAdd(r, hn::MulAdd(r, set(1.0f / 5040), set(1.0f / 720)), set(1.0f / 120));
    p = hn::MulAdd(r, hn::MulAdd(r, hn::MulAdd(r, p, set(1.0f / 24)), set(1.0f / 6)), set(0.5f));
    p = hn::MulAdd(hn::Mul(r, r), p, r);  // exp(r) − 1
    const IntLanes i;
    const auto power = hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(i, n), hn::Set(i, 127))));
    return hn::Sub(hn::Sub(set(1), power), hn::Mul(p, power));
}

/// Composites a volume that is opaque from its boundary on: whether all light ends within the skin.
inline bool see_boundary(const SplatFrame& frame, BlockState& state, std::size_t lane, const IntervalEnd& end) {
    if (!(end.x < 0.5f * kUnknownValue)) return false;
    const View& view = *frame.view;
    const float across = view.perspective() ? frame.sheets.middle + state.enter[lane] : 1.0f;
    const float skin = kSkin_px * static_cast<float>(view.pixel()) * across;
    if (!(frame.classification->most_extinction * skin * state.ray_length[lane] > kOpaqueDepth)) return false;
    const std::array<float, 4> light_at_end = frame.classification->light_at(end.x);
    if (!(light_at_end[0] * skin * state.ray_length[lane] > kOpaqueDepth && state.exit[lane] - state.enter[lane] > skin))
        return false;
    std::array<float, 3> color;
    for (std::size_t c = 0; c < 3; ++c) color[c] = std::min(light_at_end[c + 1] / light_at_end[0], 1.0f);
    if (frame.scene->color_channel) color = frame.classification->color_at(end.color);
    const float light = 1 - state.opacity[lane];
    state.red[lane] += light * (color[0] * end.light.diffuse + end.light.specular);
    state.green[lane] += light * (color[1] * end.light.diffuse + end.light.specular);
    state.blue[lane] += light * (color[2] * end.light.diffuse + end.light.specular);
    state.depth[lane] += light * state.enter[lane];
    state.opacity[lane] = 1;
    return true;
}

/// Composites a slice: whether there is a value on it.
inline bool see_slice(const SplatFrame& frame, BlockState& state, std::size_t lane, const IntervalEnd& end, float depth) {
    if (!(end.x < 0.5f * kUnknownValue)) return false;
    const std::array<float, 3> color = frame.classification->color_at(frame.scene->color_channel ? end.color : end.x);
    const float light = 1 - state.opacity[lane];
    state.red[lane] += light * color[0];
    state.green[lane] += light * color[1];
    state.blue[lane] += light * color[2];
    state.depth[lane] += light * depth;
    state.opacity[lane] = 1;
    return true;
}

/// Sets the ends of the interval of a pixel; those of a ray that is done or meets no more intervals are kNever.
template <bool kPlain>
void take_interval(const SplatFrame& frame, BlockState& state, std::size_t lane) {
    const auto end_ray = [&] {
        state.enter[lane] = state.exit[lane] = kNever;
        state.enter_x[lane] = state.exit_x[lane] = kUnknownValue;
    };
    for (; state.interval[lane] < state.intervals_end[lane] && frame.intervals.is_slice(state.interval[lane]);
         ++state.interval[lane]) {
        const std::size_t slice = state.interval[lane];
        if (see_slice(frame, state, lane, frame.ends[2 * slice], frame.intervals.depths[2 * slice])) return end_ray();
    }
    const std::size_t i = state.interval[lane];
    if (i >= state.intervals_end[lane]) return end_ray();
    const IntervalEnd &enter = frame.ends[2 * i], &exit = frame.ends[2 * i + 1];
    state.enter[lane] = frame.intervals.depths[2 * i];
    state.exit[lane] = frame.intervals.depths[2 * i + 1];
    state.enter_x[lane] = enter.x;
    state.exit_x[lane] = exit.x;
    if constexpr (!kPlain) {
        state.enter_color[lane] = enter.color;
        state.exit_color[lane] = exit.color;
        state.enter_diffuse[lane] = enter.light.diffuse;
        state.exit_diffuse[lane] = exit.light.diffuse;
        state.enter_specular[lane] = enter.light.specular;
        state.exit_specular[lane] = exit.light.specular;
    }
    if (!frame.optical_depths && see_boundary(frame, state, lane, enter)) end_ray();
}

/// A block of pixels in registers, between two sheets.
template <bool kPlain>
class BlockWalk {
public:
    HWY_ATTR BlockWalk(const SplatFrame& frame, const Classifier& classifier, BlockState& state)
        : frame_(frame), classifier_(classifier), state_(state) {
        const Lanes d;
        load();
        last_.x = hn::Load(d, state.value);
        last_.known = hn::Gt(hn::Load(d, state.known), hn::Zero(d));
        last_.weight = last_.color = last_.light.diffuse = last_.light.specular = hn::Zero(d);
        if constexpr (!kPlain) {
            last_.weight = hn::Load(d, state.weight);
            last_.color = hn::Load(d, state.color);
            last_.light = {hn::Load(d, state.diffuse), hn::Load(d, state.specular)};
        }
    }

    HWY_ATTR void store() {
        const Lanes d;
        hn::Store(opacity_, d, state_.opacity);
        hn::Store(red_, d, state_.red);
        hn::Store(green_, d, state_.green);
        hn::Store(blue_, d, state_.blue);
        hn::Store(depth_, d, state_.depth);
        hn::Store(enter_, d, state_.enter);
        hn::Store(exit_, d, state_.exit);
        hn::Store(last_.x, d, state_.value);
        hn::Store(hn::IfThenElseZero(last_.known, hn::Set(d, 1.0f)), d, state_.known);
        if constexpr (!kPlain) {
            hn::Store(last_.weight, d, state_.weight);
            hn::Store(last_.color, d, state_.color);
            hn::Store(last_.light.diffuse, d, state_.diffuse);
            hn::Store(last_.light.specular, d, state_.specular);
        }
    }

    /// Composites what lies between the last sheet, at `front_z`, and the next one, at `back_z` with the values `sheet`.
    HWY_ATTR void go(float front_z, float back_z, const SheetValues& sheet) {
        const Lanes d;
        const auto back = hn::Set(d, back_z);
        bool placed = false;
        TablePlace place;
        for (auto active = hn::Lt(enter_, back); !hn::AllFalse(d, active); active = hn::And(active, hn::Lt(enter_, back))) {
            stretch(active, front_z, back_z, sheet, place, placed);
            const auto opaque = hn::And(active, is_opaque());
            enter_ = hn::IfThenElse(opaque, hn::Set(d, kNever), enter_);
            active = hn::And(hn::AndNot(opaque, active), hn::Le(exit_, back));
            if (hn::AllFalse(d, active)) break;
            next_intervals(active);
        }
        last_ = sheet;
        last_placed_ = placed;
        if (placed) last_place_ = place;
    }

    /// The optical depth up to the last sheet, if optical depths are wanted.
    [[nodiscard]] HWY_ATTR Floats optical_depth() const { return depth_; }

    /// Takes the values of a sheet without compositing what lies before it.
    HWY_ATTR void skip_to(const SheetValues& sheet) {
        last_ = sheet;
        last_placed_ = false;
    }

private:
    [[nodiscard]] HWY_ATTR Mask is_opaque() const {
        const Lanes d;
        return hn::Lt(hn::Sub(hn::Set(d, 1.0f), opacity_), hn::Set(d, kSplatCutoff));
    }

    HWY_ATTR void load() {
        const Lanes d;
        opacity_ = hn::Load(d, state_.opacity);
        red_ = hn::Load(d, state_.red);
        green_ = hn::Load(d, state_.green);
        blue_ = hn::Load(d, state_.blue);
        depth_ = hn::Load(d, state_.depth);
        enter_ = hn::Load(d, state_.enter);
        exit_ = hn::Load(d, state_.exit);
    }

    /// One end of the stretches: values in cells, and what more is known there unless kPlain.
    struct StretchEnd {
        Floats x, color;
        Light light;
    };

    /// Composites the part of each ray between two sheets that lies in its interval.
    HWY_ATTR void stretch(Mask active, float front_z, float back_z, const SheetValues& sheet, TablePlace& place, bool& placed) {
        const Lanes d;
        const auto front = hn::Set(d, front_z), back = hn::Set(d, back_z);
        auto from = hn::Max(enter_, front), to = hn::Min(exit_, back);
        if constexpr (!kPlain) {
            if (frame_.scene->half_weight > 0) cut_where_weights_end(front, back, sheet.weight, from, to);
        }
        const auto limit = hn::Set(d, 0.5f * kUnknownValue);
        const auto enter_x = hn::Load(d, state_.enter_x), exit_x = hn::Load(d, state_.exit_x);
        const auto at_enter = hn::And(hn::Gt(enter_, front), hn::Lt(enter_x, limit));
        const auto at_exit = hn::And(hn::Lt(exit_, back), hn::Lt(exit_x, limit));
        const auto on_sheet = hn::Or(last_.known, sheet.known);
        const auto known = hn::Or(on_sheet, hn::Or(at_enter, at_exit));
        const auto seen = hn::And(hn::And(active, hn::Lt(from, to)), known);
        if (hn::AllFalse(d, seen)) return;
        // The depths of rays that are done are infinite and would lead to NaN.
        from = hn::IfThenElse(seen, from, front);
        to = hn::IfThenElse(seen, to, front);
        const auto x_front = hn::IfThenElse(last_.known, last_.x, sheet.x);
        const auto x_back = hn::IfThenElse(sheet.known, sheet.x, last_.x);
        const auto per_depth = hn::Div(hn::Set(d, 1.0f), hn::Sub(back, front));
        const auto slope = hn::Mul(hn::Sub(x_back, x_front), per_depth);
        auto x0 = hn::IfThenElse(hn::Eq(from, front), x_front, hn::MulAdd(slope, hn::Sub(from, front), x_front));
        auto x1 = hn::IfThenElse(hn::Eq(to, back), x_back, hn::MulAdd(slope, hn::Sub(to, front), x_front));
        x0 = hn::IfThenElse(at_enter, enter_x, hn::IfThenElse(on_sheet, x0, exit_x));
        x1 = hn::IfThenElse(at_exit, exit_x, hn::IfThenElse(on_sheet, x1, enter_x));
        // Values that are not known would lead to NaN in lanes without light.
        x0 = hn::IfThenElseZero(seen, x0);
        x1 = hn::IfThenElseZero(seen, x1);
        if (classifier_.transparent(seen, x0, x1)) return;

        Floats mean[4];
        const auto whole = hn::And(hn::Eq(x0, last_.x), hn::Eq(x1, sheet.x));
        if (hn::AllTrue(d, hn::Or(whole, hn::Not(seen)))) {
            if (!last_placed_) last_place_ = classifier_.place(last_.x);
            if (!placed) place = classifier_.place(sheet.x);
            last_placed_ = placed = true;
            classifier_.means(last_place_, place, mean);
        } else {
            classifier_.means(classifier_.place(x0), classifier_.place(x1), mean);
        }
        StretchEnd e0{x0, x0, {x0, x0}}, e1{x1, x1, {x1, x1}};
        if constexpr (!kPlain) {
            const auto f0 = hn::Mul(hn::Sub(from, front), per_depth), f1 = hn::Mul(hn::Sub(to, front), per_depth);
            find_rest(sheet, f0, at_enter, state_.enter_color, state_.enter_diffuse, state_.enter_specular, e0);
            find_rest(sheet, f1, at_exit, state_.exit_color, state_.exit_diffuse, state_.exit_specular, e1);
            take_other_end(hn::Or(on_sheet, at_enter), e1, e0);
            take_other_end(hn::Or(on_sheet, at_exit), e0, e1);
        }
        const auto length = hn::Mul(hn::Sub(to, from), hn::Load(d, state_.ray_length));
        if (frame_.optical_depths) {  // kept in place of the depth; more than kMostDepth is dark in any case
            const auto more = hn::Min(hn::Mul(length, mean[0]), hn::Set(d, kMostDepth));
            depth_ = hn::IfThenElse(seen, hn::Add(depth_, hn::Max(more, hn::Zero(d))), depth_);
            return;
        }
        const auto thick = hn::And(seen, hn::Gt(hn::Mul(length, mean[0]), hn::Set(d, kThickDepth)));
        if (hn::AllFalse(d, thick)) {
            add_light(seen, e0, e1, mean, length, hn::Mul(hn::Set(d, 0.5f), hn::Add(from, to)));
        } else {
            go_in_steps(seen, e0, e1, length, from, to);
        }
    }

    /// Where an end is at a part of the way between the sheets, and where it is an end of the interval.
    HWY_ATTR void find_rest(const SheetValues& sheet, Floats part, Mask at_end, const float* color, const float* diffuse,
                            const float* specular, StretchEnd& end) const {
        const Lanes d;
        const auto between = [&](Floats front, Floats back, const float* at) HWY_ATTR {
            const auto f = hn::IfThenElse(last_.known, front, back), b = hn::IfThenElse(sheet.known, back, front);
            return hn::IfThenElse(at_end, hn::Load(d, at), hn::MulAdd(part, hn::Sub(b, f), f));
        };
        end.color = between(last_.color, sheet.color, color);
        end.light.diffuse = between(last_.light.diffuse, sheet.light.diffuse, diffuse);
        end.light.specular = between(last_.light.specular, sheet.light.specular, specular);
    }

    /// An end of which nothing is known is taken to be like the other.
    HWY_ATTR static void take_other_end(Mask known, const StretchEnd& other, StretchEnd& end) {
        end.color = hn::IfThenElse(known, end.color, other.color);
        end.light.diffuse = hn::IfThenElse(known, end.light.diffuse, other.light.diffuse);
        end.light.specular = hn::IfThenElse(known, end.light.specular, other.light.specular);
    }

    /// Composites stretches that are not thin: the front hides the back, so the mean colour of a whole stretch would be wrong.
    /// Each step is as long as its optical depth allows; it shrinks until it is thin, and the next one may be twice as long.
    HWY_ATTR void go_in_steps(Mask seen, const StretchEnd& e0, const StretchEnd& e1, Floats length, Floats from, Floats to) {
        const Lanes d;
        const auto one = hn::Set(d, 1.0f), most = hn::Set(d, kThickDepth);
        const auto slope = hn::Sub(e1.x, e0.x), way = hn::Sub(to, from);
        auto begin = hn::Zero(d), step = one;
        auto front = classifier_.place(e0.x);
        for (int i = 0; i < kMostSteps && !hn::AllFalse(d, seen); ++i) {
            auto end = hn::Min(hn::Add(begin, step), one);
            if (i + 1 == kMostSteps) end = one;
            const auto back = classifier_.place(hn::IfThenElse(hn::Eq(end, one), e1.x, hn::MulAdd(slope, end, e0.x)));
            Floats mean[4];
            classifier_.means(front, back, mean);
            const auto part = hn::Mul(hn::Sub(end, begin), length), depth = hn::Mul(part, mean[0]);
            auto thin = hn::Le(depth, most);
            if (i + 1 == kMostSteps) thin = seen;
            const auto take = hn::And(seen, thin);
            if (!hn::AllFalse(d, take)) {
                StretchEnd f = e0, b = e1;
                if constexpr (!kPlain) {
                    f = between_ends(e0, e1, begin);
                    b = between_ends(e0, e1, end);
                }
                add_light(take, f, b, mean, part, hn::MulAdd(way, hn::Mul(hn::Set(d, 0.5f), hn::Add(begin, end)), from));
            }
            const auto shrink =
                hn::Max(hn::Min(hn::Div(hn::Set(d, kAimedDepth), hn::Max(depth, most)), hn::Set(d, 0.9f)), hn::Set(d, 0.0625f));
            step = hn::Mul(hn::Sub(end, begin), hn::IfThenElse(thin, hn::Set(d, 2.0f), shrink));
            front.x = hn::IfThenElse(take, back.x, front.x);
            for (std::size_t c = 0; c < 4; ++c) {
                front.prefix[c] = hn::IfThenElse(hn::RebindMask(IntLanes(), take), back.prefix[c], front.prefix[c]);
                front.within[c] = hn::IfThenElse(take, back.within[c], front.within[c]);
            }
            begin = hn::IfThenElse(take, end, begin);
            seen = hn::And(seen, hn::AndNot(is_opaque(), hn::Lt(begin, one)));
        }
    }

    HWY_ATTR static StretchEnd between_ends(const StretchEnd& e0, const StretchEnd& e1, Floats part) {
        const auto at = [&](Floats a, Floats b) HWY_ATTR { return hn::MulAdd(part, hn::Sub(b, a), a); };
        return {
            e0.x, at(e0.color, e1.color), {at(e0.light.diffuse, e1.light.diffuse), at(e0.light.specular, e1.light.specular)}};
    }

    /// Adds the light of stretches with the mean extinction and emission `mean`.
    HWY_ATTR void add_light(Mask seen, const StretchEnd& e0, const StretchEnd& e1, Floats mean[4], Floats length,
                            Floats middle) {
        const Lanes d;
        const auto opacity = opacity_of(hn::Mul(length, mean[0]));
        // Rounding must not leave light where there is none, nor make a colour brighter than 1.
        const auto visible = hn::And(seen, hn::Gt(mean[0], hn::Zero(d)));
        for (std::size_t c = 1; c < 4; ++c) mean[c] = hn::Min(mean[c], mean[0]);
        const auto light = hn::IfThenElseZero(visible, hn::Mul(hn::Sub(hn::Set(d, 1.0f), opacity_), opacity));
        if constexpr (!kPlain) {
            if (frame_.scene->color_channel) take_second_color(e0, e1, mean);
        }
        const auto per_extinction = hn::Div(light, hn::Max(mean[0], hn::Set(d, 1e-37f)));
        if constexpr (kPlain) {
            red_ = hn::MulAdd(per_extinction, mean[1], red_);
            green_ = hn::MulAdd(per_extinction, mean[2], green_);
            blue_ = hn::MulAdd(per_extinction, mean[3], blue_);
        } else {
            const auto half = hn::Set(d, 0.5f);
            const auto lit = hn::Mul(hn::Mul(half, hn::Add(e0.light.diffuse, e1.light.diffuse)), per_extinction);
            const auto gloss = hn::Mul(hn::Mul(half, hn::Add(e0.light.specular, e1.light.specular)), light);
            red_ = hn::Add(red_, hn::MulAdd(lit, mean[1], gloss));
            green_ = hn::Add(green_, hn::MulAdd(lit, mean[2], gloss));
            blue_ = hn::Add(blue_, hn::MulAdd(lit, mean[3], gloss));
        }
        // Rays that are done have no middle: it would be 0 times infinity.
        depth_ = hn::MulAdd(light, hn::IfThenElseZero(visible, middle), depth_);
        opacity_ = hn::Add(opacity_, light);
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
    HWY_ATTR void take_second_color(const StretchEnd& e0, const StretchEnd& e1, Floats mean[4]) const {
        const Lanes d;
        Floats front[3], back[3];
        classifier_.color(e0.color, front);
        classifier_.color(e1.color, back);
        for (std::size_t c = 0; c < 3; ++c)
            mean[c + 1] = hn::Mul(hn::Mul(hn::Set(d, 0.5f), mean[0]), hn::Add(front[c], back[c]));
    }

    HWY_ATTR void next_intervals(Mask through) {
        const Lanes d;
        HWY_ALIGN float done[kBlock];
        hn::Store(hn::IfThenElseZero(through, hn::Set(d, 1.0f)), d, done);
        store();
        for (std::size_t i = 0; i < kBlock; ++i) {
            if (done[i] == 0) continue;
            ++state_.interval[i];
            take_interval<kPlain>(frame_, state_, i);
        }
        load();
    }

    const SplatFrame& frame_;
    const Classifier& classifier_;
    BlockState& state_;
    Floats opacity_, red_, green_, blue_, depth_, enter_, exit_;
    SheetValues last_;
    TablePlace last_place_;
    bool last_placed_ = false;
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
