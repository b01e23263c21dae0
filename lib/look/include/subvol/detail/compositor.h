// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "subvol/optics.h"

namespace subvol::detail {

/// Below this transmittance, what lies behind does not change a double.
inline constexpr double kOpaque = 1e-16;

/// Composites the stretches of a ray front to back. The result is that of `composite` with `Optics::integrate` of each stretch,
/// but many are integrated at once, in SIMD vectors: stretches are cut at the knots when they are added, and the pieces wait
/// until they fill the vectors. The same stretches after `start` give the same bits, whatever was added before it.
///
/// opaque: below this transmittance, what lies behind is left out
class Compositor {
public:
    explicit Compositor(const Optics& optics, double opaque = kOpaque);

    /// Begins a ray. light: what is in front of its first stretch
    void start(const Segment& light);

    /// Adds the next stretch: `length` world units on which the value changes linearly from `front` to `back`.
    void add(double front, double back, double length) {
        if (!(front >= low_ && front < high_)) enter(front);
        if (back >= low_ && back < high_) {
            add_piece(front, back, length);
        } else {
            add_across_knots(front, back, length);
        }
    }

    /// Whether the transmittance is below `opaque`. Waiting pieces do not count yet.
    [[nodiscard]] bool opaque() const { return transmittance_ < opaque_; }

    /// The result of all stretches since `start`.
    [[nodiscard]] Segment finish();

private:
    static constexpr std::size_t kPieces = 16;
    using Row = std::array<double, kPieces>;

    void enter(double value);
    void add_across_knots(double front, double back, double length);
    void composite_pieces();
    void close_run();

    void add_piece(double front, double back, double length) {
        const Optics::Span& span = *span_;
        if (span.transparent) return;
        const double s_front = (front - span.begin) * span.inverse_width, s_back = (back - span.begin) * span.inverse_width;
        alpha_front_[count_] = span.alpha + s_front * span.alpha_step;
        alpha_back_[count_] = span.alpha + s_back * span.alpha_step;
        length_[count_] = length * per_unit_;
        s_front_[count_] = s_front;
        s_back_[count_] = s_back;
        span_of_[count_] = span_;
        if (++count_ == kPieces) composite_pieces();
    }

    const Optics* optics_;
    double opaque_, per_unit_;
    const Optics::Span* span_;  // of the last value, which is in [low, high)
    double low_, high_;
    double transmittance_ = 1;
    Vec3 color_{0.0};
    // Consecutive pieces of one span share its colours: their weights are summed first.
    const Optics::Span* run_;
    double run_color_ = 0, run_step_ = 0;
    std::size_t count_ = 0;
    alignas(64) Row alpha_front_{}, alpha_back_{}, length_{}, s_front_{}, s_back_{};
    std::array<const Optics::Span*, kPieces> span_of_{};
};

}  // namespace subvol::detail
