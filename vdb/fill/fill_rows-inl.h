// SPDX-License-Identifier: Apache-2.0
// Which centres of a row lie in a cell. Included once for every instruction set: see fill_block.cpp.
//
// A tetrahedron is where four linear functions are not negative. Along a row of centres, which is parallel to z, each function
// cuts off one side, so what remains is an interval; the union of a cell's six intervals is kept as the bits of a word.
#if defined(SUBVOL_FILL_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_FILL_ROWS_INL_H
#undef SUBVOL_FILL_ROWS_INL_H
#else
#define SUBVOL_FILL_ROWS_INL_H
#endif

#include <hwy/highway.h>

#include "fill_block.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 8>;
using IntLanes = hn::RebindToSigned<Lanes>;
using BitLanes = hn::RebindToUnsigned<Lanes>;
using Doubles = hn::Vec<Lanes>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes());

// Rounding error of a determinant of three edges, relative to the product of their lengths: some 50 roundings of 1.1e-16.
constexpr double kRounding = 1e-14;
// Below this a tetrahedron is flat; above it the tolerance of the barycentric coordinates stays under 1 %.
constexpr double kFlat = 1e-12;

// A plane this steep counts as vertical: either all centres of a row are above it, or none.
constexpr double kVertical = 1e-200;

/// The tetrahedra of a cell, by the functions n·x + offset that are not negative inside, up to rounding. Each function bounds
/// the centres of a row from below or from above.
class TetPlanes {
public:
    /// lowest: the first centre of the first row, relative to the first corner
    HWY_ATTR TetPlanes(const CellShape& shape, const Vec3& lowest) {
        for (std::size_t i = 0; i < 8; i += kLanes) set(shape, lowest, i);
    }

    /// x, y:    positions of the rows relative to the first one, one row per lane
    /// count:   centres in a row, below 64
    /// returns: for each lane, the bits of the centres inside
    HWY_ATTR hn::Vec<BitLanes> inside(Doubles x, Doubles y, int count) const {
        const Lanes d;
        const BitLanes bits;
        const auto most = hn::Set(d, count);
        auto found = hn::Zero(bits);
        for (std::size_t t = 0; t < 6; ++t) {
            auto first = hn::Zero(d), end = most;
            for (std::size_t k = 0; k < 4; ++k) {
                const auto along = hn::MulAdd(hn::Set(d, slopes_[k][0][t]), x, hn::Set(d, crossings_[k][t]));
                const auto crossing = hn::MulAdd(hn::Set(d, slopes_[k][1][t]), y, along);
                first = hn::Max(first, hn::Add(crossing, hn::Set(d, unless_lower_[k][t])));
                end = hn::Min(end, hn::Add(crossing, hn::Set(d, unless_upper_[k][t])));
            }
            first = hn::Min(hn::Ceil(first), most);
            end = hn::Max(hn::Min(hn::Floor(hn::Add(end, hn::Set(d, 1.0))), most), first);
            const auto one = hn::Set(bits, 1);
            found = hn::Or(found, hn::Sub(one << small_number(end), one << small_number(first)));
        }
        return found;
    }

    /// Whether a tetrahedron with volume is oriented against the sign (1 or -1).
    bool has_turned(double sign) const {
        for (std::size_t t = 0; t < 6; ++t) {
            if (signs_[t] == -sign) return true;
        }
        return false;
    }

private:
    struct Vec {
        Doubles x, y, z;
    };

    /// A whole number from 0 to 2³¹.
    HWY_ATTR static hn::Vec<BitLanes> small_number(Doubles x) {
        const auto in_last_bits = hn::Set(Lanes(), 0x1p52);
        return hn::Xor(hn::BitCast(BitLanes(), hn::Add(x, in_last_bits)), hn::BitCast(BitLanes(), in_last_bits));
    }

    HWY_ATTR static Vec corner(const CellShape& shape, std::size_t k, std::size_t i) {
        const std::int64_t* at = shape.split->corners[k].data() + i;
        return {pick(shape.corners[0], at), pick(shape.corners[1], at), pick(shape.corners[2], at)};
    }
    HWY_ATTR static Doubles pick(const std::array<double, 8>& values, const std::int64_t* at) {
        const Lanes d;
        const auto places = hn::LoadU(IntLanes(), at);
        if constexpr (kLanes == 8) {
            return hn::TableLookupLanes(hn::LoadU(d, values.data()), hn::IndicesFromVec(d, places));
        } else {
            return hn::GatherIndex(d, values.data(), places);
        }
    }
    HWY_ATTR static Vec minus(const Vec& a, const Vec& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
    HWY_ATTR static Vec cross(const Vec& a, const Vec& b) {
        return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
                hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
    }
    HWY_ATTR static Doubles dot(const Vec& a, const Vec& b) {
        return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
    }

    HWY_ATTR void set(const CellShape& shape, const Vec3& lowest, std::size_t i) {
        const Lanes d;
        const Vec first = corner(shape, 0, i);
        const Vec a = minus(corner(shape, 1, i), first), b = minus(corner(shape, 2, i), first);
        const Vec c = minus(corner(shape, 3, i), first);
        Vec n[4];
        n[1] = cross(b, c);
        n[2] = cross(c, a);
        n[3] = cross(a, b);
        const auto determinant = dot(a, n[1]), volume = hn::Abs(determinant);
        const auto sign = hn::CopySign(hn::Set(d, 1.0), determinant);
        n[0] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        for (std::size_t k = 1; k < 4; ++k) {
            n[k] = {hn::Mul(sign, n[k].x), hn::Mul(sign, n[k].y), hn::Mul(sign, n[k].z)};
            n[0] = minus(n[0], n[k]);
        }
        const auto scale = hn::Sqrt(hn::Mul(dot(a, a), hn::Mul(dot(b, b), dot(c, c))));
        const auto is_flat = hn::Not(hn::Gt(volume, hn::Mul(hn::Set(d, kFlat), scale)));
        hn::Store(hn::IfThenZeroElse(is_flat, sign), d, signs_ + i);
        const auto least = hn::IfThenElse(is_flat, hn::Inf(d), hn::Mul(hn::Set(d, -kRounding), scale));
        const Vec start{hn::Sub(hn::Set(d, lowest.x), first.x), hn::Sub(hn::Set(d, lowest.y), first.y),
                        hn::Sub(hn::Set(d, lowest.z), first.z)};
        for (std::size_t k = 0; k < 4; ++k) {
            const auto along = dot(n[k], start);
            set_bounds(n[k], hn::Sub(k == 0 ? hn::Add(volume, along) : along, least), k, i);
        }
    }

    /// n·x + offset is not negative from, or up to, where it crosses zero, in centres.
    HWY_ATTR void set_bounds(const Vec& n, Doubles offset, std::size_t k, std::size_t i) {
        const Lanes d;
        const auto is_upper = hn::Le(n.z, hn::Set(d, -kVertical));
        const auto steep = hn::IfThenElse(is_upper, n.z, hn::Max(n.z, hn::Set(d, kVertical)));
        const auto scale = hn::Div(hn::Set(d, -1.0), steep);
        hn::Store(hn::Mul(scale, n.x), d, slopes_[k][0] + i);
        hn::Store(hn::Mul(scale, n.y), d, slopes_[k][1] + i);
        hn::Store(hn::Mul(scale, offset), d, crossings_[k] + i);
        const auto far = hn::Inf(d);
        hn::Store(hn::IfThenElseZero(is_upper, hn::Neg(far)), d, unless_lower_[k] + i);
        hn::Store(hn::IfThenZeroElse(is_upper, far), d, unless_upper_[k] + i);
    }

    HWY_ALIGN double signs_[8];         // of the orientation; 0: flat
    HWY_ALIGN double slopes_[4][2][8];  // by x and y
    HWY_ALIGN double crossings_[4][8];
    HWY_ALIGN double unless_lower_[4][8];  // 0 or −∞
    HWY_ALIGN double unless_upper_[4][8];  // 0 or ∞
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
