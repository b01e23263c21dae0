// SPDX-License-Identifier: Apache-2.0
#include "subvol/optics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absorption.h"
#include "subvol/detail/compositor.h"
#include "subvol/detail/knot_values.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kMaxAlpha = 1 - 1e-6;

std::vector<double> merged_knots(const TransferFunction& function) {
    std::vector<double> knots;
    for (const auto& knot : function.color) knots.push_back(knot.value);
    for (const auto& knot : function.opacity) knots.push_back(knot.value);
    std::sort(knots.begin(), knots.end());
    knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
    return knots;
}

}  // namespace

Optics::Optics(TransferFunction function, double opacity_unit_world)
    : function_(std::move(function)), unit_(opacity_unit_world) {
    validate(function_);
    if (!(unit_ > 0) || !std::isfinite(unit_)) {
        throw Error(ErrorCode::InvalidInput, "the opacity unit is " + number_text(unit_), {}, "a positive world length");
    }
    TransferFunction bounded = function_;
    for (auto& knot : bounded.opacity) knot.alpha = std::min(knot.alpha, kMaxAlpha);
    knots_ = merged_knots(bounded);
    double integral = 0;
    for (std::size_t i = 0; i <= knots_.size(); ++i) {
        const double begin = knots_[i > 0 ? i - 1 : 0];
        Span span{.begin = begin, .alpha = alpha_at(bounded, begin), .color = color_at(bounded, begin), .integral = integral};
        if (i > 0 && i < knots_.size()) {
            span.inverse_width = 1 / (knots_[i] - begin);
            span.alpha_step = alpha_at(bounded, knots_[i]) - span.alpha;
            span.color_step = color_at(bounded, knots_[i]) - span.color;
            integral += piece_depth(span.alpha, span.alpha + span.alpha_step, (knots_[i] - begin) / unit_);
        }
        span.transparent = !(span.alpha > 0) && !(span.alpha_step > 0);
        spans_.push_back(span);
    }
}

const Optics::Span& Optics::span_at(double value) const {
    return spans_[static_cast<std::size_t>(std::upper_bound(knots_.begin(), knots_.end(), value) - knots_.begin())];
}

Vec3 Optics::color(double value) const {
    const Span& span = span_at(value);
    return span.color + (value - span.begin) * span.inverse_width * span.color_step;
}

double Optics::extinction(double value) const {
    const Span& span = span_at(value);
    return -std::log1p(-(span.alpha + (value - span.begin) * span.inverse_width * span.alpha_step)) / unit_;
}

double Optics::extinction_integral(double value) const {
    const Span& span = span_at(value);
    const double alpha = span.alpha + (value - span.begin) * span.inverse_width * span.alpha_step;
    return span.integral + piece_depth(span.alpha, alpha, (value - span.begin) / unit_);
}

Segment Optics::integrate_piece(const Span& span, double front, double back, double length) const {
    if (span.transparent) return {};
    const double s_front = (front - span.begin) * span.inverse_width;
    const double s_back = (back - span.begin) * span.inverse_width;
    const auto [mean, whole] =
        absorb_piece(span.alpha + s_front * span.alpha_step, span.alpha + s_back * span.alpha_step, length / unit_);
    // C_f (1−Ψ) + C_b (Ψ−ζ), with mean = 1−Ψ and whole = 1−ζ.
    return {whole * span.color + (s_front * mean + s_back * (whole - mean)) * span.color_step, 1 - whole};
}

Segment Optics::integrate(double front, double back, double length) const {
    const Span* span = &span_at(front);
    const Span* const last = &span_at(back);
    if (span == last) return integrate_piece(*span, front, back, length);
    const bool up = back > front;
    Segment total;
    for (double at = front; total.transmittance > kOpaque; span += up ? 1 : -1) {
        const double to = span == last ? back : up ? (span + 1)->begin : span->begin;
        if (to != at) composite(total, integrate_piece(*span, at, to, (to - at) / (back - front) * length));
        if (span == last) break;
        at = to;
    }
    return total;
}

}  // namespace subvol
