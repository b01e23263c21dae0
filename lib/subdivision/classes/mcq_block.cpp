// SPDX-License-Identifier: Apache-2.0
// Compiled once for every instruction set; the best one is chosen where it runs.
//
// With the sums along a line of points, on which the new point lies between x₁ and x₂,
//
//     M = x₁ + x₂,   D = M − (x₀ + x₃),
//
// an edge point is ½ M + ω/4 Σ D over the four lines beside it. Across a face, whose edges lie on such lines 1 and 2,
//
//     P = M₁ + M₂,   R = M₀ + M₃ + (M₁ − D₁) + (M₂ − D₂)
//
// are the sums of its corners and of the eight points beyond its edges: with those of the planes beside it they are all that a
// face point needs, and a cell point likewise.
#include "mcq_block.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mcq_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<double, 4>;
using Vector = hn::Vec<Lanes>;

/// One vector of channels of all points of a block. Along each axis kLines old points are read. New points lie on kSegments
/// segments, of which the first one begins at the second point read, and at kPoints old points, which begin there as well or
/// one later.
///
/// Stores could change the members as far as a compiler knows: what loops need is copied.
template <std::size_t kPoints, std::size_t kSegments, std::size_t kLines>
class Step {
public:
    using Three = std::array<std::size_t, 3>;

    /// later: along each axis, 1 if the old points begin one later, else 0
    Step(double tension, const double* from, const Three& from_steps, const Three& later, double* to, const Three& to_steps)
        : tension_(tension), from_(from), from_steps_(from_steps), later_(later), to_(to), to_steps_(to_steps) {}

    void run() {
        keep_points();
        run_lines<0, 1, 2>();
        run_faces<0, 1, 2, true>();
        run_faces<0, 2, 1, false>();
        run_lines<1, 0, 2>();
        run_faces<1, 2, 0, false>();
        run_lines<2, 0, 1>();
    }

private:
    static constexpr Lanes d{};
    static constexpr std::size_t kLanes = 4;

    /// The new points along an axis by their numbers among the old points that stay, or among the segments.
    struct Places {
        std::size_t later, step;
        [[nodiscard]] std::size_t of_point(std::size_t i) const { return (2 * i + later) * step; }
        [[nodiscard]] std::size_t of_segment(std::size_t i) const { return (2 * i + 1 - later) * step; }
    };
    [[nodiscard]] Places places(std::size_t axis) const { return {later_[axis], to_steps_[axis]}; }

    HWY_INLINE void keep_points() {
        const Places u = places(0), v = places(1), w = places(2);
        const auto [du, dv, dw] = from_steps_;
        const double* HWY_RESTRICT from = from_ + (1 + later_[0]) * du + (1 + later_[1]) * dv + (1 + later_[2]) * dw;
        double* HWY_RESTRICT to = to_;
        for (std::size_t k = 0; k < kPoints; ++k) {
            for (std::size_t j = 0; j < kPoints; ++j) {
                for (std::size_t i = 0; i < kPoints; ++i) {
                    hn::StoreU(hn::LoadU(d, from + i * du + j * dv + k * dw), d,
                               to + u.of_point(i) + v.of_point(j) + w.of_point(k));
                }
            }
        }
    }

    /// Where the sums of a segment are, along the axes: M, then D.
    template <std::size_t A, std::size_t B>
    static constexpr std::size_t line_step(std::size_t axis) {
        return 2 * kLanes * (axis == A ? 1 : axis == B ? kSegments : kSegments * kLines);
    }

    /// The sums of all lines along axis A, and the edge points on them. B < C
    template <std::size_t A, std::size_t B, std::size_t C>
    HWY_INLINE void run_lines() {
        const std::size_t step = from_steps_[A], along_b = from_steps_[B], along_c = from_steps_[C];
        const double* HWY_RESTRICT from = from_;
        double* HWY_RESTRICT sum = sums_;
        for (std::size_t r = 0; r < kLines; ++r) {
            for (std::size_t q = 0; q < kLines; ++q) {
                const double* HWY_RESTRICT x = from + q * along_b + r * along_c;
                auto x0 = hn::LoadU(d, x), x1 = hn::LoadU(d, x + step), x2 = hn::LoadU(d, x + 2 * step);
                for (std::size_t s = 0; s < kSegments; ++s, sum += 2 * kLanes) {
                    const auto x3 = hn::LoadU(d, x + (s + 3) * step);
                    const auto middle = hn::Add(x1, x2);
                    hn::Store(middle, d, sum);
                    hn::Store(hn::Sub(middle, hn::Add(x0, x3)), d, sum + kLanes);
                    x0 = x1;
                    x1 = x2;
                    x2 = x3;
                }
            }
        }
        constexpr std::size_t kB = line_step<A, B>(B), kC = line_step<A, B>(C);
        const auto half = hn::Set(d, 0.5), quarter = hn::Set(d, tension_ / 4);
        const Places a = places(A), b = places(B), c = places(C);
        const double* HWY_RESTRICT sums = sums_ + (1 + b.later) * kB + (1 + c.later) * kC;
        double* HWY_RESTRICT to = to_;
        for (std::size_t r = 0; r < kPoints; ++r) {
            for (std::size_t q = 0; q < kPoints; ++q) {
                for (std::size_t s = 0; s < kSegments; ++s) {
                    const double* HWY_RESTRICT m = sums + s * 2 * kLanes + q * kB + r * kC;
                    const double* HWY_RESTRICT second = m + kLanes;
                    const auto beside = hn::Add(hn::Add(hn::Load(d, second - kB), hn::Load(d, second + kB)),
                                                hn::Add(hn::Load(d, second - kC), hn::Load(d, second + kC)));
                    hn::StoreU(hn::MulAdd(quarter, beside, hn::Mul(half, hn::Load(d, m))), d,
                               to + a.of_segment(s) + b.of_point(q) + c.of_point(r));
                }
            }
        }
    }

    /// Points of the faces along axes A and B, whose lines along A are there, and of the cells between them.
    template <std::size_t A, std::size_t B, std::size_t C, bool kWithCells>
    HWY_INLINE void run_faces() {
        constexpr std::size_t kMiddle = A == 0 ? 1 : 0;  // the first of the other axes, in whose order the lines are
        constexpr std::size_t kB = line_step<A, kMiddle>(B), kC = line_step<A, kMiddle>(C);
        constexpr std::size_t kPlanes = kWithCells ? kLines : kPoints + 2;
        const auto of_face = hn::Set(d, (1 + 2 * tension_) / 4), beyond = hn::Set(d, -tension_ / 4);
        const auto beside = hn::Set(d, tension_ / 4), beside_beyond = hn::Set(d, -tension_ / 8);
        const auto of_cell = hn::Set(d, (1 + 6 * tension_) / 8);
        const Places a = places(A), b = places(B), c = places(C);
        // The planes beside the first old point that stays: the second one if the cells are wanted too.
        const std::size_t first = kWithCells ? c.later : 0;
        const double* HWY_RESTRICT sums = sums_ + kB + (kWithCells ? 0 : c.later * kC);
        double* HWY_RESTRICT to = to_;
        for (std::size_t q = 0; q < kSegments; ++q) {
            for (std::size_t s = 0; s < kSegments; ++s) {
                Vector corners[kPlanes], outer[kPlanes], sides[kPlanes];  // P, R and what they add to the faces beside
                for (std::size_t r = 0; r < kPlanes; ++r) {
                    const double* HWY_RESTRICT m = sums + s * 2 * kLanes + q * kB + r * kC;
                    const auto p = hn::Add(hn::Load(d, m), hn::Load(d, m + kB));
                    const auto inner = hn::Add(hn::Load(d, m + kLanes), hn::Load(d, m + kB + kLanes));
                    const auto far = hn::Add(hn::Load(d, m - kB), hn::Load(d, m + 2 * kB));
                    const auto rest = hn::Add(far, hn::Sub(p, inner));
                    corners[r] = p;
                    outer[r] = rest;
                    sides[r] = hn::MulAdd(beside_beyond, rest, hn::Mul(beside, p));
                }
                double* HWY_RESTRICT column = to + a.of_segment(s) + b.of_segment(q);
                for (std::size_t r = 0; r < kPoints; ++r) {
                    const std::size_t n = first + r;
                    const auto plane = hn::MulAdd(beyond, outer[n + 1], hn::Mul(of_face, corners[n + 1]));
                    hn::StoreU(hn::Add(plane, hn::Add(sides[n], sides[n + 2])), d, column + c.of_point(r));
                }
                if constexpr (kWithCells) {
                    for (std::size_t r = 0; r < kSegments; ++r) {
                        const auto near = hn::Add(corners[r + 1], corners[r + 2]);
                        const auto far = hn::Add(hn::Add(outer[r + 1], outer[r + 2]), hn::Add(corners[r], corners[r + 3]));
                        hn::StoreU(hn::MulAdd(beyond, far, hn::Mul(of_cell, near)), d, column + c.of_segment(r));
                    }
                }
            }
        }
    }

    double tension_;
    const double* from_;
    Three from_steps_, later_;
    double* to_;
    Three to_steps_;
    alignas(64) double sums_[2 * kLanes * kSegments * kLines * kLines];
};

template <std::size_t kPoints, std::size_t kSegments, std::size_t kLines>
void run(double tension, const GridRows& from, const std::array<std::size_t, 3>& later, double* to) {
    constexpr std::size_t kSide = kPoints + kSegments;
    const std::array<std::size_t, 3> from_steps{from.stride, from.stride * from.side, from.stride * from.side * from.side};
    const std::array<std::size_t, 3> to_steps{from.stride, from.stride * kSide, from.stride * kSide * kSide};
    for (std::size_t block = 0; block < from.stride; block += hn::Lanes(Lanes())) {
        Step<kPoints, kSegments, kLines>(tension, from.rows + block, from_steps, later, to + block, to_steps).run();
    }
}

void refine_one(double tension, const GridRows& from, double* to) {
    run<4, 3, 6>(tension, from, {}, to);
}

void refine_eight(double tension, const GridRows& from, double* to) {
    run<5, 4, 7>(tension, from, {}, to);
}

void refine_child(double tension, const GridRows& from, std::size_t octant, double* to) {
    run<3, 3, 6>(tension, from, {octant & 1, octant >> 1 & 1, octant >> 2}, to);
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(refine_one);
HWY_EXPORT(refine_eight);
HWY_EXPORT(refine_child);

void refine_mcq_cell(double tension, const GridRows& from, double* to) {
    HWY_DYNAMIC_DISPATCH(refine_one)(tension, from, to);
}

void refine_mcq_cells(double tension, const GridRows& from, double* to) {
    HWY_DYNAMIC_DISPATCH(refine_eight)(tension, from, to);
}

void refine_mcq_child(double tension, const GridRows& from, std::size_t octant, double* to) {
    HWY_DYNAMIC_DISPATCH(refine_child)(tension, from, octant, to);
}

}  // namespace subvol::detail
#endif
