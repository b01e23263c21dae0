// SPDX-License-Identifier: Apache-2.0
// Classification of values, a block of pixels at a time. Included once for every instruction set: see splat_cpu.cpp.
#if defined(SUBVOL_SPLAT_CLASSIFY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_SPLAT_CLASSIFY_INL_H
#undef SUBVOL_SPLAT_CLASSIFY_INL_H
#else
#define SUBVOL_SPLAT_CLASSIFY_INL_H
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "splat_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

constexpr float kNever = std::numeric_limits<float>::infinity();

/// The pixels of a block between two sheets.
struct BlockState {
    HWY_ALIGN float opacity[kBlock], red[kBlock], green[kBlock], blue[kBlock], depth[kBlock];
    HWY_ALIGN float value[kBlock], known[kBlock], weight[kBlock];  // on the last sheet
    HWY_ALIGN float color[kBlock], diffuse[kBlock], specular[kBlock];
    // The interval that a ray is in or reaches next; enter = kNever: the ray is done.
    HWY_ALIGN float enter[kBlock], exit[kBlock];
    HWY_ALIGN float enter_x[kBlock], exit_x[kBlock];  // the values there; kUnknownValue: not known
    HWY_ALIGN float enter_color[kBlock], exit_color[kBlock];
    HWY_ALIGN float enter_diffuse[kBlock], exit_diffuse[kBlock], enter_specular[kBlock], exit_specular[kBlock];
    HWY_ALIGN float ray_length[kBlock];
    std::uint32_t interval[kBlock], intervals_end[kBlock];
};

/// The place of a value in the table, and the four integrals from the lower end of its cell.
struct TablePlace {
    Floats x;
    Ints prefix[4];
    Floats within[4];
};

#if HWY_TARGET != HWY_SCALAR
/// Loads the rows of every fourth lane, one into each 128 bits of a vector.
template <class D>
HWY_ATTR inline hn::Vec<D> load_quads(D d, const float* table, const std::int32_t* offsets) {
    if constexpr (hn::MaxLanes(d) <= 4) {
        return hn::LoadU(d, table + offsets[0]);
    } else {
        const hn::Half<D> half;
        return hn::Combine(d, load_quads(half, table, offsets + hn::MaxLanes(d) / 2), load_quads(half, table, offsets));
    }
}

#endif

/// Loads four numbers for each lane from rows of a table. Whole rows are loaded and transposed, which is faster than gathers.
HWY_INLINE HWY_ATTR void load_rows(const float* table, const std::int32_t* offsets, Floats& a, Floats& b, Floats& c,
                                   Floats& e) {
    const Lanes d;
#if HWY_TARGET == HWY_SCALAR
    a = hn::Set(d, table[offsets[0]]);
    b = hn::Set(d, table[offsets[0] + 1]);
    c = hn::Set(d, table[offsets[0] + 2]);
    e = hn::Set(d, table[offsets[0] + 3]);
#else
    const hn::RepartitionToWide<Lanes> wide;
    const auto row0 = load_quads(d, table, offsets), row1 = load_quads(d, table, offsets + 1);
    const auto row2 = load_quads(d, table, offsets + 2), row3 = load_quads(d, table, offsets + 3);
    const auto low01 = hn::BitCast(wide, hn::InterleaveLower(d, row0, row1));
    const auto low23 = hn::BitCast(wide, hn::InterleaveLower(d, row2, row3));
    const auto high01 = hn::BitCast(wide, hn::InterleaveUpper(d, row0, row1));
    const auto high23 = hn::BitCast(wide, hn::InterleaveUpper(d, row2, row3));
    a = hn::BitCast(d, hn::InterleaveLower(wide, low01, low23));
    b = hn::BitCast(d, hn::InterleaveUpper(wide, low01, low23));
    c = hn::BitCast(d, hn::InterleaveLower(wide, high01, high23));
    e = hn::BitCast(d, hn::InterleaveUpper(wide, high01, high23));
#endif
}

/// The optical model of a frame, for vectors.
class Classifier {
public:
    explicit Classifier(const Classification& classification) : classification_(classification) {
        const auto& visible = classification.table.visible;
        const auto rows = classification.table.rows.size(), seen = static_cast<std::size_t>(visible.back());
        const auto first = static_cast<std::size_t>(std::ranges::upper_bound(visible, 0) - visible.begin()) - 1;
        const auto last = static_cast<std::size_t>(std::ranges::lower_bound(visible, visible.back()) - visible.begin()) - 1;
        all_visible_ = seen == rows;
        if (seen == 0) {
            first_visible_ = kNever;
            return;
        }
        // Row i is of the values from i − 1 to i; the first and the last row have no end.
        if (first > 0) first_visible_ = static_cast<float>(first) - 1;
        if (last + 1 < rows) end_visible_ = static_cast<float>(last);
        gaps_ = seen != last + 1 - first;
    }

    /// The mean extinction and emission (colour times extinction) of a stretch of ray between two values.
    HWY_ATTR void means(const TablePlace& front, const TablePlace& back, Floats mean[4]) const {
        const Lanes d;
        const auto dx = hn::Sub(back.x, front.x);
        const auto near = hn::Lt(hn::Abs(dx), hn::Set(d, kNearValues));
        const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::IfThenElse(near, hn::Set(d, 1.0f), dx));
        for (std::size_t c = 0; c < 4; ++c) {
            const auto counts = hn::ConvertTo(d, hn::Sub(back.prefix[c], front.prefix[c]));
            const auto integral =
                hn::MulAdd(hn::Set(d, classification_.table.unit[c]), counts, hn::Sub(back.within[c], front.within[c]));
            mean[c] = hn::Max(hn::Mul(integral, inverse), hn::Zero(d));
        }
        if (hn::AllFalse(d, near)) return;
        Floats here[4];
        middle(hn::Mul(hn::Set(d, 0.5f), hn::Add(front.x, back.x)), here);
        for (std::size_t c = 0; c < 4; ++c) mean[c] = hn::IfThenElse(near, here[c], mean[c]);
    }

    /// The extinction and emission at a value.
    HWY_ATTR void middle(Floats x, Floats mean[4]) const {
        const Lanes d;
        Floats s, bend[4];
        HWY_ALIGN std::int32_t offsets[kBlock];
        find(x, s, offsets);
        const float* rows = reinterpret_cast<const float*>(classification_.table.rows.data());
        load_rows(rows + 4, offsets, mean[0], mean[1], mean[2], mean[3]);
        load_rows(rows + 8, offsets, bend[0], bend[1], bend[2], bend[3]);
        const auto slope = hn::MulSub(hn::Set(d, 2.0f), s, hn::Set(d, 1.0f));
        for (std::size_t c = 0; c < 4; ++c) mean[c] = hn::Max(hn::MulAdd(slope, bend[c], mean[c]), hn::Zero(d));
    }

    HWY_ATTR TablePlace place(Floats x) const {
        const Lanes d;
        TablePlace p;
        p.x = x;
        Floats s, bend[4], prefix[4];
        HWY_ALIGN std::int32_t offsets[kBlock];
        find(x, s, offsets);
        const float* rows = reinterpret_cast<const float*>(classification_.table.rows.data());
        load_rows(rows, offsets, prefix[0], prefix[1], prefix[2], prefix[3]);
        load_rows(rows + 4, offsets, p.within[0], p.within[1], p.within[2], p.within[3]);
        load_rows(rows + 8, offsets, bend[0], bend[1], bend[2], bend[3]);
        const auto left = hn::Sub(s, hn::Set(d, 1.0f));
        for (std::size_t c = 0; c < 4; ++c) {
            p.prefix[c] = hn::BitCast(IntLanes(), prefix[c]);
            p.within[c] = hn::Mul(s, hn::MulAdd(left, bend[c], p.within[c]));
        }
        return p;
    }

    HWY_ATTR void color(Floats x, Floats rgb[3]) const {
        Floats s, low[4], step[4];
        HWY_ALIGN std::int32_t offsets[kBlock];
        find(x, s, offsets);
        for (std::size_t i = 0; i < kBlock; ++i) offsets[i] = offsets[i] / kRowFloats * kColorFloats;
        const float* rows = reinterpret_cast<const float*>(classification_.colors.rows.data());
        load_rows(rows, offsets, low[0], low[1], low[2], low[3]);
        load_rows(rows + 4, offsets, step[0], step[1], step[2], step[3]);
        for (std::size_t c = 0; c < 3; ++c) rgb[c] = hn::MulAdd(s, step[c], low[c]);
    }

    /// Whether all values between two ends are invisible, in each of the lanes.
    HWY_ATTR bool transparent(Mask lanes, Floats x0, Floats x1) const {
        if (all_visible_) return false;
        const Lanes d;
        const auto before = hn::Lt(hn::Max(x0, x1), hn::Set(d, first_visible_));
        const auto behind = hn::Ge(hn::Min(x0, x1), hn::Set(d, end_visible_));
        if (hn::AllFalse(d, hn::AndNot(hn::Or(before, behind), lanes))) return true;
        if (!gaps_) return false;
        const auto low = hn::IfThenElse(lanes, hn::Min(x0, x1), hn::Set(d, 3e38f));
        const auto high = hn::IfThenElse(lanes, hn::Max(x0, x1), hn::Set(d, -3e38f));
        return classification_.table.transparent(static_cast<double>(hn::GetLane(hn::MinOfLanes(d, low))),
                                                 static_cast<double>(hn::GetLane(hn::MaxOfLanes(d, high))));
    }

    [[nodiscard]] bool transparent(float x0, float x1) const {
        return classification_.table.transparent(static_cast<double>(x0), static_cast<double>(x1));
    }
    [[nodiscard]] bool all_visible() const { return all_visible_; }

private:
    static constexpr std::int32_t kRowFloats = sizeof(PreintegratedTable::Row) / sizeof(float);
    static constexpr std::int32_t kColorFloats = sizeof(ColorTable::Row) / sizeof(float);

    /// The row of a value, and its place s within the row.
    HWY_ATTR static void find(Floats x, Floats& s, std::int32_t* offsets) {
        const Lanes d;
        const IntLanes di;
        const auto cell = hn::Min(hn::Max(hn::Floor(x), hn::Set(d, -1.0f)), hn::Set(d, PreintegratedTable::kCells));
        s = hn::Sub(x, cell);
        const auto row = hn::Add(hn::ConvertTo(di, cell), hn::Set(di, 1));
        hn::Store(hn::Mul(row, hn::Set(di, kRowFloats)), di, offsets);
    }

    const Classification& classification_;
    bool all_visible_ = false, gaps_ = false;               // gaps: invisible values between visible ones
    float first_visible_ = -kNever, end_visible_ = kNever;  // in cells; all values before and behind are invisible
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
