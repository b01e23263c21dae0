// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/compositor.h"

#include <algorithm>
#include <limits>

#include "absorption.h"

namespace subvol::detail {

namespace {
constexpr std::size_t kVector = 8;  // lanes of the widest vectors
}  // namespace

Compositor::Compositor(const Optics& optics, double opaque)
    : optics_(&optics), opaque_(opaque), per_unit_(1 / optics.opacity_unit()) {
    enter(optics.knots().front());
    start({});
}

void Compositor::start(const Segment& light) {
    transmittance_ = light.transmittance;
    color_ = light.color;
    count_ = 0;
    run_ = span_;
    run_color_ = run_step_ = 0;
}

void Compositor::enter(double value) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const auto knots = optics_->knots();
    const auto next = static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), value) - knots.begin());
    span_ = optics_->spans().data() + next;
    low_ = next > 0 ? knots[next - 1] : -kInfinity;
    high_ = next < knots.size() ? knots[next] : kInfinity;
}

void Compositor::add_across_knots(double front, double back, double length) {
    const Optics::Span* span = span_;
    enter(back);
    const Optics::Span* const last = span_;
    const bool up = back > front;
    for (double at = front;;) {
        const double to = span == last ? back : up ? (span + 1)->begin : span->begin;
        span_ = span;
        if (span == last) return add_piece(at, to, at == front ? length : (to - at) / (back - front) * length);
        if (to != at) add_piece(at, to, (to - at) / (back - front) * length);
        span += up ? 1 : -1;
        at = to;
    }
}

void Compositor::composite_pieces() {
    // The rest of the last vector is cleared, so that it is the same each time.
    for (std::size_t i = count_; i < kPieces && i % kVector != 0; ++i) alpha_front_[i] = alpha_back_[i] = length_[i] = 0;
    alignas(64) Row mean, whole;
    absorb_pieces({alpha_front_.data(), alpha_back_.data(), length_.data()}, count_, mean.data(), whole.data());
    for (std::size_t i = 0; i < count_ && !opaque();) {
        if (span_of_[i] != run_) {
            close_run();
            run_ = span_of_[i];
        }
        // Local variables, which stay in registers for all pieces of one span.
        double color = run_color_, step = run_step_, passed = transmittance_;
        for (; i < count_ && span_of_[i] == run_ && !(passed < opaque_); ++i) {
            // C_f (1−Ψ) + C_b (Ψ−ζ), with mean = 1−Ψ and whole = 1−ζ.
            color += passed * whole[i];
            step += passed * (s_front_[i] * mean[i] + s_back_[i] * (whole[i] - mean[i]));
            passed *= 1 - whole[i];
        }
        run_color_ = color;
        run_step_ = step;
        transmittance_ = passed;
    }
    count_ = 0;
}

void Compositor::close_run() {
    color_ += run_color_ * run_->color + run_step_ * run_->color_step;
    run_color_ = run_step_ = 0;
}

Segment Compositor::finish() {
    composite_pieces();
    close_run();
    return {color_, transmittance_};
}

}  // namespace subvol::detail
