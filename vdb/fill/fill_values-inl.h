// SPDX-License-Identifier: Apache-2.0
// Values at the centres found in a cell. Included once for every instruction set: see fill_block.cpp.
//
// A cell maps parameters u = (u, v, w) to space, x(u) = Σ Nᵢ(u) xᵢ, and its field is f(u) = Σ Nᵢ(u) fᵢ; the Nᵢ are trilinear
// over 8 corners or triquadratic over 27 nodes. The value at a centre p is f(u) where x(u) = p. Newton's method finds that u,
// for a vector of centres at once:
//
//     u₀   = ½ + J(½)⁻¹ (p − x(½))      one matrix per cell: MiddleOfCell
//     uₖ₊₁ = uₖ + J(uₖ)⁻¹ (p − x(uₖ))   Cramer's rule, until |p − x(uₖ)| ≤ 1e-8 of the cell's size or the step was short enough
//
// A Newton step of at most m parameters misses p by at most bend·m², where `bend` bounds the mixed derivatives of x: in a
// nearly parallelepipedal cell u₀ is exact enough, and its residual is never computed. Where Newton's method does not converge
// near the cell, because that is folded or flat, the value is linear in the tetrahedron that contains the centre (`mend`).
#if defined(SUBVOL_FILL_VALUES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_FILL_VALUES_INL_H
#undef SUBVOL_FILL_VALUES_INL_H
#else
#define SUBVOL_FILL_VALUES_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "fill_block.h"
#include "fill_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

constexpr int kNewtonSteps = 10;
constexpr double kNewtonTolerance = 1e-8;  // relative to the cell's size: below the rounding of a float
constexpr double kOutside = 0.25;          // how far a bent face may lie beyond its two triangles, in parameters

/// A trilinear function by its values at 8 corners: the coefficients of 1, u, v, w, uv, vw, wu, uvw.
struct Trilinear {
    double c[8];

    explicit Trilinear(const double* v)
        : c{v[0],
            v[1] - v[0],
            v[3] - v[0],
            v[4] - v[0],
            v[0] - v[1] + v[2] - v[3],
            v[0] - v[3] + v[7] - v[4],
            v[0] - v[1] + v[5] - v[4],
            v[1] - v[0] + v[3] - v[2] + v[4] - v[5] + v[6] - v[7]} {}
};

/// The parameters of a vector of centres in a cell.
struct Parameters {
    Doubles u, v, w;
};

HWY_ATTR inline Doubles value_at(const Trilinear& p, const Parameters& q) {
    const Lanes d;
    const auto c = [&](int k) HWY_ATTR { return hn::Set(d, p.c[k]); };
    const auto low = hn::MulAdd(hn::MulAdd(c(4), q.v, c(1)), q.u, hn::MulAdd(c(2), q.v, c(0)));
    const auto high = hn::MulAdd(hn::MulAdd(c(7), q.v, c(6)), q.u, hn::MulAdd(c(5), q.v, c(3)));
    return hn::MulAdd(high, q.w, low);
}

/// How much is missing in one coordinate, and the derivatives of that coordinate with respect to u, v, w.
struct Residual {
    Doubles left, du, dv, dw;
};

HWY_ATTR inline Residual residual(const Trilinear& p, const Parameters& q, Doubles wanted) {
    const Lanes d;
    const auto c = [&](int k) HWY_ATTR { return hn::Set(d, p.c[k]); };
    const auto dw = hn::MulAdd(hn::MulAdd(c(7), q.v, c(6)), q.u, hn::MulAdd(c(5), q.v, c(3)));
    const auto du = hn::MulAdd(hn::MulAdd(c(7), q.v, c(6)), q.w, hn::MulAdd(c(4), q.v, c(1)));
    const auto dv = hn::MulAdd(hn::MulAdd(c(7), q.u, c(5)), q.w, hn::MulAdd(c(4), q.u, c(2)));
    const auto value = hn::MulAdd(dw, q.w, hn::MulAdd(hn::MulAdd(c(4), q.v, c(1)), q.u, hn::MulAdd(c(2), q.v, c(0))));
    return {hn::Sub(wanted, value), du, dv, dw};
}

/// A triquadratic function by its values at 27 nodes: the coefficient of uⁱ vʲ wᵏ is at i + 3j + 9k.
struct Triquadratic {
    double c[kCurvedNodes];

    explicit Triquadratic(const double* v) {
        std::copy_n(v, kCurvedNodes, c);
        along<1>();
        along<3>();
        along<9>();
    }

private:
    /// From values to coefficients along one axis. kStride: between its nodes
    template <std::size_t kStride>
    void along() {
        for (std::size_t line = 0; line < kCurvedNodes; line += 3 * kStride) {
            for (std::size_t n = line; n < line + kStride; ++n) {
                const double low = c[n], middle = c[n + kStride], high = c[n + 2 * kStride];
                c[n + kStride] = 4 * middle - 3 * low - high;
                c[n + 2 * kStride] = 2 * (low + high - 2 * middle);
            }
        }
    }
};

HWY_ATTR inline Doubles value_at(const Triquadratic& p, const Parameters& q) {
    const Lanes d;
    auto along_w = hn::Zero(d);
    for (int k = 2; k >= 0; --k) {
        auto along_v = hn::Zero(d);
        for (int j = 2; j >= 0; --j) {
            const double* c = &p.c[3 * j + 9 * k];
            const auto along_u = hn::MulAdd(hn::MulAdd(hn::Set(d, c[2]), q.u, hn::Set(d, c[1])), q.u, hn::Set(d, c[0]));
            along_v = hn::MulAdd(along_v, q.v, along_u);
        }
        along_w = hn::MulAdd(along_w, q.w, along_v);
    }
    return along_w;
}

/// Horner's rule along each axis, with the derivatives.
HWY_ATTR inline Residual residual(const Triquadratic& p, const Parameters& q, Doubles wanted) {
    const Lanes d;
    const auto twice_u = hn::Add(q.u, q.u);
    auto value = hn::Zero(d), du = hn::Zero(d), dv = hn::Zero(d), dw = hn::Zero(d);
    for (int k = 2; k >= 0; --k) {
        auto x = hn::Zero(d), x_du = hn::Zero(d), x_dv = hn::Zero(d);
        for (int j = 2; j >= 0; --j) {
            const double* c = &p.c[3 * j + 9 * k];
            const auto c1 = hn::Set(d, c[1]), c2 = hn::Set(d, c[2]);
            x_dv = hn::MulAdd(x_dv, q.v, x);
            x = hn::MulAdd(x, q.v, hn::MulAdd(hn::MulAdd(c2, q.u, c1), q.u, hn::Set(d, c[0])));
            x_du = hn::MulAdd(x_du, q.v, hn::MulAdd(c2, twice_u, c1));
        }
        dw = hn::MulAdd(dw, q.w, value);
        value = hn::MulAdd(value, q.w, x);
        du = hn::MulAdd(du, q.w, x_du);
        dv = hn::MulAdd(dv, q.w, x_dv);
    }
    return {hn::Sub(wanted, value), du, dv, dw};
}

/// An upper bound of the length.
inline double sum_of_sides(const std::array<double, 3>& v) {
    return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]);
}

/// The linear map at the middle of a cell: the first Newton step, whose matrix is the same for all centres.
class MiddleOfCell {
public:
    explicit MiddleOfCell(const std::array<Trilinear, 3>& map) {
        std::array<std::array<double, 3>, 3> d;  // by u, v, w
        for (std::size_t a = 0; a < 3; ++a) {
            const double* c = map[a].c;
            place_[a] = c[0] + 0.5 * (c[1] + c[2] + c[3]) + 0.25 * (c[4] + c[5] + c[6]) + 0.125 * c[7];
            d[0][a] = c[1] + 0.5 * (c[4] + c[6]) + 0.25 * c[7];
            d[1][a] = c[2] + 0.5 * (c[4] + c[5]) + 0.25 * c[7];
            d[2][a] = c[3] + 0.5 * (c[5] + c[6]) + 0.25 * c[7];
        }
        double determinant = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t r = 0; r < 3; ++r) {
                const auto &e = d[(r + 1) % 3], &f = d[(r + 2) % 3];
                inverse_[r][a] = e[(a + 1) % 3] * f[(a + 2) % 3] - e[(a + 2) % 3] * f[(a + 1) % 3];
            }
            determinant += d[0][a] * inverse_[0][a];
        }
        const double scale = 1 / determinant;
        for (auto& row : inverse_) {
            for (double& x : row) x *= scale;
        }
        set_bend(map, d, std::abs(determinant));
    }

    HWY_ATTR Parameters parameters(Doubles x, Doubles y, Doubles z) const {
        const Lanes d;
        const auto px = hn::Sub(x, hn::Set(d, place_[0])), py = hn::Sub(y, hn::Set(d, place_[1]));
        const auto pz = hn::Sub(z, hn::Set(d, place_[2]));
        const auto along = [&](const std::array<double, 3>& row) HWY_ATTR {
            const auto sum = hn::MulAdd(hn::Set(d, row[0]), px, hn::MulAdd(hn::Set(d, row[1]), py, hn::Set(d, 0.5)));
            return hn::MulAdd(hn::Set(d, row[2]), pz, sum);
        };
        return {along(inverse_[0]), along(inverse_[1]), along(inverse_[2])};
    }

    /// Parameter `a` at the place + (0, 0, z) is the first + z times the second.
    [[nodiscard]] std::pair<double, double> along_z(std::size_t a, const Vec3& place) const {
        const auto& row = inverse_[a];
        const double at = row[0] * (place.x - place_[0]) + row[1] * (place.y - place_[1]) + row[2] * (place.z - place_[2]);
        return {0.5 + at, row[2]};
    }

    /// How parameter `a` changes along axis d.
    [[nodiscard]] double slope(std::size_t a, std::size_t d) const { return inverse_[a][d]; }

    /// A Newton step of at most m ≤ 1 parameters that ends near the cell leaves a residual of at most bend·m². Infinite where
    /// the map is so bent or so flat that rounding might matter.
    [[nodiscard]] double bend() const { return bend_; }

private:
    void set_bend(const std::array<Trilinear, 3>& map, const std::array<std::array<double, 3>, 3>& d, double volume) {
        const auto term = [&](std::size_t k) { return sum_of_sides({map[0].c[k], map[1].c[k], map[2].c[k]}); };
        const double bend = term(4) + term(5) + term(6) + 8 * term(7);
        const double length = std::max({sum_of_sides(d[0]), sum_of_sides(d[1]), sum_of_sides(d[2])});
        // The map stretches no direction by less than volume/length² at the middle, and if `tame` by about that everywhere.
        const bool tame = 4 * bend * length * length < volume && 1e4 * volume > length * length * length;
        bend_ = tame ? bend : std::numeric_limits<double>::infinity();
    }

    std::array<double, 3> place_;
    std::array<std::array<double, 3>, 3> inverse_;
    double bend_ = 0;
};

/// The nodes that a map interpolates, and the values there.
template <class Map>
inline const double* nodes_of(const CellShape& shape, std::size_t axis) {
    return std::is_same_v<Map, Trilinear> ? shape.corners[axis].data() : shape.nodes[axis].data();
}
template <class Map>
inline std::span<const double> values_of(const CellShape& shape, std::size_t channel) {
    if constexpr (std::is_same_v<Map, Trilinear>) return std::span(shape.values).subspan(8 * channel, 8);
    return std::span(shape.node_values).subspan(kCurvedNodes * channel, kCurvedNodes);
}

/// Computes the values of a cell's channels at centres.
template <class Map>
class ValueFiller {
public:
    HWY_ATTR ValueFiller(const CellShape& shape, const CellBlock& block)
        : shape_(shape),
          block_(block),
          map_{Map(nodes_of<Map>(shape, 0)), Map(nodes_of<Map>(shape, 1)), Map(nodes_of<Map>(shape, 2))},
          middle_(
              {Trilinear(shape.corners[0].data()), Trilinear(shape.corners[1].data()), Trilinear(shape.corners[2].data())}) {
        const double tolerance = kNewtonTolerance * shape.size;
        tolerance_ = tolerance * tolerance;
        if (!shape.curved) most_ = std::min(1.0, std::sqrt(tolerance / middle_.bend()));
    }

    /// Empties the list.
    HWY_ATTR void fill(FoundVoxels& found) {
        for (std::size_t i = found.count; i % kLanes != 0; ++i) {
            for (auto& along : found.places) along[i] = found.count > 0 ? along[found.count - 1] : 0;
        }
        Parameters q[kVectors] = {};
        hn::Mask<Lanes> good[kVectors];
        for (std::size_t v = 0; v * kLanes < found.count; ++v) good[v] = find(found, v * kLanes, q[v]);
        store(found, q);
        for (std::size_t v = 0; v * kLanes < found.count; ++v) {
            const std::size_t first = v * kLanes;
            if (!hn::AllTrue(Lanes(), good[v])) mend(found, first, std::min(kLanes, found.count - first), good[v]);
        }
        found.count = 0;
    }

    /// The parameters of a vector of centres.
    ///
    /// returns: the lanes for which Newton's method has found some near the cell
    HWY_ATTR hn::Mask<Lanes> find(const FoundVoxels& found, std::size_t first, Parameters& q) const {
        const Lanes d;
        return invert(hn::Load(d, &found.places[0][first]), hn::Load(d, &found.places[1][first]),
                      hn::Load(d, &found.places[2][first]), q);
    }

    /// Stores the values at all centres, except those whose place for a value is null.
    ///
    /// q: the parameters of each vector of centres
    HWY_ATTR void store(const FoundVoxels& found, const Parameters* q) const {
        const Lanes d;
        for (std::size_t c = 0; c < block_.channels; ++c) {
            const std::span<const double> nodes = values_of<Map>(shape_, c);
            const auto [lowest, highest] = std::ranges::minmax(nodes);
            // Between a bent face and its two triangles the weights leave [0,1], but values must stay in the cell's range. A
            // parabola exceeds the range of its nodes by an eighth at most.
            const double beyond = shape_.curved ? (highest - lowest) / 8 : 0;
            const auto least = hn::Set(d, lowest - beyond), most = hn::Set(d, highest + beyond);
            const Map map(nodes.data());
            for (std::size_t first = 0; first < found.count; first += kLanes, ++q) {
                HWY_ALIGN double values[kLanes];
                hn::Store(hn::Clamp(value_at(map, *q), least, most), d, values);
                for (std::size_t i = first; i < std::min(first + kLanes, found.count); ++i) {
                    if (found.values[i]) found.values[i][c * kLeafVoxels] = static_cast<float>(values[i - first]);
                }
            }
            q -= (found.count + kLanes - 1) / kLanes;
        }
        if (!block_.cell_numbers) return;
        for (std::size_t i = 0; i < found.count; ++i) {
            if (found.values[i]) found.values[i][block_.channels * kLeafVoxels] = bits_of(block_.cell);
        }
    }

    static constexpr std::size_t kVectors = FoundVoxels::kMost / kLanes;

    [[nodiscard]] const std::array<Map, 3>& map() const { return map_; }
    [[nodiscard]] const MiddleOfCell& middle() const { return middle_; }

private:
    static float bits_of(Index cell) { return std::bit_cast<float>(static_cast<std::uint32_t>(cell)); }

    HWY_ATTR Parameters start(Doubles px, Doubles py, Doubles pz) const {
        const Lanes d;
        const Parameters q = middle_.parameters(px, py, pz);
        if (!shape_.curved) return q;
        const auto part = hn::Set(d, shape_.part);
        const auto& first = shape_.first_part;
        return {hn::MulAdd(q.u, part, hn::Set(d, first[0])), hn::MulAdd(q.v, part, hn::Set(d, first[1])),
                hn::MulAdd(q.w, part, hn::Set(d, first[2]))};
    }

    HWY_ATTR hn::Mask<Lanes> is_short(Doubles du, Doubles dv, Doubles dw) const {
        const auto longest = hn::Max(hn::Abs(du), hn::Max(hn::Abs(dv), hn::Abs(dw)));
        return hn::Le(longest, hn::Set(Lanes(), most_));
    }

    /// Newton's method for all lanes at once.
    ///
    /// returns: the lanes that have converged to parameters near the cell
    HWY_ATTR hn::Mask<Lanes> invert(Doubles px, Doubles py, Doubles pz, Parameters& q) const {
        const Lanes d;
        const auto half = hn::Set(d, 0.5);
        q = start(px, py, pz);
        auto arrived = is_short(hn::Sub(q.u, half), hn::Sub(q.v, half), hn::Sub(q.w, half));  // never in a curved cell
        for (int step = 1; !hn::AllTrue(d, arrived); ++step) {
            const Residual x = residual(map_[0], q, px), y = residual(map_[1], q, py), z = residual(map_[2], q, pz);
            const auto square = hn::MulAdd(x.left, x.left, hn::MulAdd(y.left, y.left, hn::Mul(z.left, z.left)));
            arrived = hn::Or(arrived, hn::Le(square, hn::Set(d, tolerance_)));
            if (step == kNewtonSteps || hn::AllTrue(d, arrived)) break;
            // Cramer's rule. Lanes that have converged do not move; lanes that are not finite never converge.
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
            const auto du = hn::Mul(scale, hn::MulAdd(x.left, ax, hn::MulAdd(y.left, ay, hn::Mul(z.left, az))));
            const auto dv = hn::Mul(scale, hn::MulAdd(x.du, bx, hn::MulAdd(y.du, by, hn::Mul(z.du, bz))));
            const auto dw = hn::Mul(scale, hn::MulAdd(x.du, cx, hn::MulAdd(y.du, cy, hn::Mul(z.du, cz))));
            q = {hn::Add(q.u, du), hn::Add(q.v, dv), hn::Add(q.w, dw)};
            arrived = hn::Or(arrived, is_short(du, dv, dw));
        }
        return hn::And(arrived, near(q));
    }

    HWY_ATTR static hn::Mask<Lanes> near(const Parameters& q) {
        const Lanes d;
        const auto half = hn::Set(d, 0.5);
        const auto beyond =
            hn::Max(hn::Abs(hn::Sub(q.u, half)), hn::Max(hn::Abs(hn::Sub(q.v, half)), hn::Abs(hn::Sub(q.w, half))));
        return hn::Le(beyond, hn::Set(d, 0.5 + kOutside));
    }

    /// Where Newton's method failed, the value is linear in the tetrahedron.
    HWY_ATTR void mend(const FoundVoxels& found, std::size_t first, std::size_t count, hn::Mask<Lanes> good) const {
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(Lanes(), good, bits);
        for (std::size_t i = 0; i < count; ++i) {
            if (bits[0] >> i & 1) continue;
            const std::size_t at = first + i;
            const auto weights = linear_weights(shape_, {found.places[0][at], found.places[1][at], found.places[2][at]});
            for (std::size_t c = 0; c < block_.channels; ++c) {
                double sum = 0;
                for (std::size_t k = 0; k < 8; ++k) sum += weights[k] * shape_.values[8 * c + k];
                const auto [lowest, highest] = std::ranges::minmax(std::span(&shape_.values[8 * c], 8));
                found.values[at][c * kLeafVoxels] = static_cast<float>(std::clamp(sum, lowest, highest));
            }
        }
    }

    const CellShape& shape_;
    const CellBlock& block_;
    std::array<Map, 3> map_;
    MiddleOfCell middle_;
    double tolerance_;
    double most_ = -1;  // the largest step, in parameters, whose residual needs no check
};

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
