// Values at the centres found in a cell. Included once for every instruction set: see fill_block.cpp.
#if defined(SUBVOL_FILL_VALUES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_FILL_VALUES_INL_H
#undef SUBVOL_FILL_VALUES_INL_H
#else
#define SUBVOL_FILL_VALUES_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>

#include "fill_block.h"
#include "fill_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

constexpr int kNewtonSteps = 10;
constexpr double kNewtonTolerance = 1e-8;  // of the cell's size: below the rounding of a float
constexpr double kOutside = 0.25;          // how far a bent face may lie beyond its two triangles, in parameters

/// The coefficients of 1, u, v, w, uv, vw, wu, uvw of what is trilinear between 8 corners.
struct Polynomial {
    double c[8];

    explicit Polynomial(const double* v)
        : c{v[0],
            v[1] - v[0],
            v[3] - v[0],
            v[4] - v[0],
            v[0] - v[1] + v[2] - v[3],
            v[0] - v[3] + v[7] - v[4],
            v[0] - v[1] + v[5] - v[4],
            v[1] - v[0] + v[3] - v[2] + v[4] - v[5] + v[6] - v[7]} {}
};

/// Places of a vector of centres in the parameters of a cell.
struct Parameters {
    Doubles u, v, w;
};

HWY_ATTR inline Doubles value_at(const Polynomial& p, const Parameters& q) {
    const Lanes d;
    const auto c = [&](int k) HWY_ATTR { return hn::Set(d, p.c[k]); };
    const auto low = hn::MulAdd(hn::MulAdd(c(4), q.v, c(1)), q.u, hn::MulAdd(c(2), q.v, c(0)));
    const auto high = hn::MulAdd(hn::MulAdd(c(7), q.v, c(6)), q.u, hn::MulAdd(c(5), q.v, c(3)));
    return hn::MulAdd(high, q.w, low);
}

/// What one coordinate misses, and its derivatives by u, v, w.
struct Residual {
    Doubles left, du, dv, dw;
};

HWY_ATTR inline Residual residual(const Polynomial& p, const Parameters& q, Doubles wanted) {
    const Lanes d;
    const auto c = [&](int k) HWY_ATTR { return hn::Set(d, p.c[k]); };
    const auto dw = hn::MulAdd(hn::MulAdd(c(7), q.v, c(6)), q.u, hn::MulAdd(c(5), q.v, c(3)));
    const auto du = hn::MulAdd(hn::MulAdd(c(7), q.v, c(6)), q.w, hn::MulAdd(c(4), q.v, c(1)));
    const auto dv = hn::MulAdd(hn::MulAdd(c(7), q.u, c(5)), q.w, hn::MulAdd(c(4), q.u, c(2)));
    const auto value = hn::MulAdd(dw, q.w, hn::MulAdd(hn::MulAdd(c(4), q.v, c(1)), q.u, hn::MulAdd(c(2), q.v, c(0))));
    return {hn::Sub(wanted, value), du, dv, dw};
}

/// Gives centres in a cell the values of its channels.
class ValueFiller {
public:
    HWY_ATTR ValueFiller(const CellShape& shape, const FillOptions& options)
        : shape_(shape),
          options_(options),
          x_(shape.corners[0].data()),
          y_(shape.corners[1].data()),
          z_(shape.corners[2].data()) {
        double size = 0;
        for (const auto& c : shape.corners) size = std::max(size, *std::ranges::max_element(c) - *std::ranges::min_element(c));
        tolerance_ = kNewtonTolerance * kNewtonTolerance * size * size;
    }

    /// The list is empty afterwards.
    HWY_ATTR void fill(FoundVoxels& found) {
        for (std::size_t i = found.count; i % kLanes != 0; ++i) {
            for (auto& along : found.places) along[i] = found.count > 0 ? along[found.count - 1] : 0;
        }
        for (std::size_t i = 0; i < found.count; i += kLanes) fill(found, i, std::min(kLanes, found.count - i));
        found.count = 0;
    }

private:
    HWY_ATTR void fill(const FoundVoxels& found, std::size_t first, std::size_t count) {
        const Lanes d;
        Parameters q{hn::Set(d, 0.5), hn::Set(d, 0.5), hn::Set(d, 0.5)};
        const auto good = invert(hn::Load(d, &found.places[0][first]), hn::Load(d, &found.places[1][first]),
                                 hn::Load(d, &found.places[2][first]), q);
        for (std::size_t c = 0; c < options_.channels; ++c) {
            const double* corners = &shape_.values[8 * c];
            const auto [lowest, highest] = std::ranges::minmax(std::span(corners, 8));
            // The weights reach beyond [0,1] between a bent face and its two triangles; the field's values must not.
            const auto value = hn::Clamp(value_at(Polynomial(corners), q), hn::Set(d, lowest), hn::Set(d, highest));
            HWY_ALIGN double values[kLanes];
            hn::Store(value, d, values);
            for (std::size_t i = 0; i < count; ++i) {
                found.values[first + i][c * kLeafVoxels] = static_cast<float>(values[i]);
            }
        }
        if (!hn::AllTrue(d, good)) mend(found, first, count, good);
        if (!options_.cell_numbers) return;
        for (std::size_t i = 0; i < count; ++i) {
            found.values[first + i][options_.channels * kLeafVoxels] = bits_of(shape_.cell);
        }
    }

    static float bits_of(Index cell) { return std::bit_cast<float>(static_cast<std::uint32_t>(cell)); }

    /// Newton's steps for all of them at once. returns: which have arrived, and near the cell
    HWY_ATTR hn::Mask<Lanes> invert(Doubles px, Doubles py, Doubles pz, Parameters& q) const {
        const Lanes d;
        for (int step = 0;; ++step) {
            const Residual x = residual(x_, q, px), y = residual(y_, q, py), z = residual(z_, q, pz);
            const auto square = hn::MulAdd(x.left, x.left, hn::MulAdd(y.left, y.left, hn::Mul(z.left, z.left)));
            const auto arrived = hn::Le(square, hn::Set(d, tolerance_));
            if (step == kNewtonSteps || hn::AllTrue(d, arrived)) return hn::And(arrived, near(q));
            // Cramer's rule. Those that have arrived stay; what is not finite never arrives.
            const auto ax = hn::MulSub(y.dv, z.dw, hn::Mul(y.dw, z.dv)), ay = hn::MulSub(z.dv, x.dw, hn::Mul(z.dw, x.dv));
            const auto az = hn::MulSub(x.dv, y.dw, hn::Mul(x.dw, y.dv));
            const auto determinant = hn::MulAdd(x.du, ax, hn::MulAdd(y.du, ay, hn::Mul(z.du, az)));
            const auto scale = hn::IfThenZeroElse(arrived, hn::Div(hn::Set(d, 1.0), determinant));
            const auto bx = hn::MulSub(y.left, z.dw, hn::Mul(y.dw, z.left));
            const auto by = hn::MulSub(z.left, x.dw, hn::Mul(z.dw, x.left));
            const auto bz = hn::MulSub(x.left, y.dw, hn::Mul(x.dw, y.left));
            const auto cx = hn::MulSub(y.dv, z.left, hn::Mul(y.left, z.dv));
            const auto cy = hn::MulSub(z.dv, x.left, hn::Mul(z.left, x.dv));
            const auto cz = hn::MulSub(x.dv, y.left, hn::Mul(x.left, y.dv));
            const auto du = hn::MulAdd(x.left, ax, hn::MulAdd(y.left, ay, hn::Mul(z.left, az)));
            const auto dv = hn::MulAdd(x.du, bx, hn::MulAdd(y.du, by, hn::Mul(z.du, bz)));
            const auto dw = hn::MulAdd(x.du, cx, hn::MulAdd(y.du, cy, hn::Mul(z.du, cz)));
            q = {hn::MulAdd(scale, du, q.u), hn::MulAdd(scale, dv, q.v), hn::MulAdd(scale, dw, q.w)};
        }
    }

    HWY_ATTR static hn::Mask<Lanes> near(const Parameters& q) {
        const Lanes d;
        const auto half = hn::Set(d, 0.5);
        const auto beyond =
            hn::Max(hn::Abs(hn::Sub(q.u, half)), hn::Max(hn::Abs(hn::Sub(q.v, half)), hn::Abs(hn::Sub(q.w, half))));
        return hn::Le(beyond, hn::Set(d, 0.5 + kOutside));
    }

    /// Those that Newton's steps did not find a place for are linear in their tetrahedron.
    HWY_ATTR void mend(const FoundVoxels& found, std::size_t first, std::size_t count, hn::Mask<Lanes> good) const {
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(Lanes(), good, bits);
        for (std::size_t i = 0; i < count; ++i) {
            if (bits[0] >> i & 1) continue;
            const std::size_t at = first + i;
            const auto weights = linear_weights(shape_, {found.places[0][at], found.places[1][at], found.places[2][at]});
            for (std::size_t c = 0; c < options_.channels; ++c) {
                double sum = 0;
                for (std::size_t k = 0; k < 8; ++k) sum += weights[k] * shape_.values[8 * c + k];
                const auto [lowest, highest] = std::ranges::minmax(std::span(&shape_.values[8 * c], 8));
                found.values[at][c * kLeafVoxels] = static_cast<float>(std::clamp(sum, lowest, highest));
            }
        }
    }

    const CellShape& shape_;
    const FillOptions& options_;
    Polynomial x_, y_, z_;
    double tolerance_;
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
