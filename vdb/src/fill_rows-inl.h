// Which centres of a row of a leaf lie in a cell. Included once for every instruction set: see fill_block.cpp.
#if defined(SUBVOL_FILL_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_FILL_ROWS_INL_H
#undef SUBVOL_FILL_ROWS_INL_H
#else
#define SUBVOL_FILL_ROWS_INL_H
#endif

#include <hwy/highway.h>

#include <limits>

#include "fill_block.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 8>;
using IntLanes = hn::RebindToSigned<Lanes>;
using Doubles = hn::Vec<Lanes>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes());

// Rounding of a determinant of three edges, in units of the product of their lengths: some 50 roundings of 1.1e-16.
constexpr double kRounding = 1e-14;
// Below this a tetrahedron is flat; above it the tolerance of the barycentric coordinates stays under 1 %.
constexpr double kFlat = 1e-12;

/// The tetrahedra of a cell: each is where four functions n·x + offset are at least `least`, which allows for their rounding.
class TetPlanes {
public:
    HWY_ATTR explicit TetPlanes(const CellShape& shape) {
        for (std::size_t i = 0; i < 8; i += kLanes) set(shape, i);
    }

    /// Bit i: the centre at (x, y, z[i]) is inside.
    HWY_ATTR std::uint64_t inside(double x, double y, const double* z) const {
        const Lanes d;
        HWY_ALIGN double rows[4][8];
        for (std::size_t k = 0; k < 4; ++k) {
            for (std::size_t i = 0; i < 8; i += kLanes) {
                const auto along = hn::MulAdd(hn::Load(d, normals_[k][0] + i), hn::Set(d, x), hn::Load(d, offsets_[k] + i));
                hn::Store(hn::MulAdd(hn::Load(d, normals_[k][1] + i), hn::Set(d, y), along), d, rows[k] + i);
            }
        }
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < 8; i += kLanes) {
            const auto at = hn::LoadU(d, z + i);
            auto found = hn::Gt(hn::Zero(d), hn::Zero(d));  // none
            for (std::size_t t = 0; t < 6; ++t) {
                const auto s0 = hn::MulAdd(hn::Set(d, normals_[0][2][t]), at, hn::Set(d, rows[0][t]));
                const auto s1 = hn::MulAdd(hn::Set(d, normals_[1][2][t]), at, hn::Set(d, rows[1][t]));
                const auto s2 = hn::MulAdd(hn::Set(d, normals_[2][2][t]), at, hn::Set(d, rows[2][t]));
                const auto s3 = hn::MulAdd(hn::Set(d, normals_[3][2][t]), at, hn::Set(d, rows[3][t]));
                const auto lowest = hn::Min(hn::Min(s0, s1), hn::Min(s2, s3));
                found = hn::Or(found, hn::Ge(lowest, hn::Set(d, least_[t])));
            }
            std::uint8_t word[8] = {};
            hn::StoreMaskBits(d, found, word);
            bits |= static_cast<std::uint64_t>(word[0]) << i;
        }
        return bits;
    }

    /// Whether a tetrahedron with volume is not as the sign says: positively oriented, or negatively.
    bool has_turned(double sign) const {
        for (std::size_t t = 0; t < 6; ++t) {
            if (signs_[t] != sign && least_[t] != std::numeric_limits<double>::infinity()) return true;
        }
        return false;
    }

private:
    struct Vec {
        Doubles x, y, z;
    };

    HWY_ATTR static Vec corner(const CellShape& shape, std::size_t k, std::size_t i) {
        const Lanes d;
        const auto at = hn::LoadU(IntLanes(), shape.split->corners[k].data() + i);
        return {hn::GatherIndex(d, shape.corners[0].data(), at), hn::GatherIndex(d, shape.corners[1].data(), at),
                hn::GatherIndex(d, shape.corners[2].data(), at)};
    }
    HWY_ATTR static Vec minus(const Vec& a, const Vec& b) { return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)}; }
    HWY_ATTR static Vec cross(const Vec& a, const Vec& b) {
        return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
                hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
    }
    HWY_ATTR static Doubles dot(const Vec& a, const Vec& b) {
        return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
    }

    HWY_ATTR void set(const CellShape& shape, std::size_t i) {
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
        hn::Store(sign, d, signs_ + i);
        n[0] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        for (std::size_t k = 1; k < 4; ++k) {
            n[k] = {hn::Mul(sign, n[k].x), hn::Mul(sign, n[k].y), hn::Mul(sign, n[k].z)};
            n[0] = minus(n[0], n[k]);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            hn::Store(n[k].x, d, normals_[k][0] + i);
            hn::Store(n[k].y, d, normals_[k][1] + i);
            hn::Store(n[k].z, d, normals_[k][2] + i);
            const auto along = hn::Neg(dot(n[k], first));
            hn::Store(k == 0 ? hn::Add(volume, along) : along, d, offsets_[k] + i);
        }
        const auto scale = hn::Sqrt(hn::Mul(dot(a, a), hn::Mul(dot(b, b), dot(c, c))));
        const auto nothing = hn::Set(d, std::numeric_limits<double>::infinity());
        const auto is_flat = hn::Not(hn::Gt(volume, hn::Mul(hn::Set(d, kFlat), scale)));
        hn::Store(hn::IfThenElse(is_flat, nothing, hn::Mul(hn::Set(d, -kRounding), scale)), d, least_ + i);
    }

    HWY_ALIGN double normals_[4][3][8];
    HWY_ALIGN double offsets_[4][8];
    HWY_ALIGN double least_[8];
    HWY_ALIGN double signs_[8];
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
