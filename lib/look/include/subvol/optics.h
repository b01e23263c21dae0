// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/transfer_function.h"

namespace subvol {

/// The effect of a stretch of a ray: its premultiplied emission, and the part of the light from behind that passes.
struct Segment {
    Vec3 color{0.0};
    double transmittance = 1;
};

/// The optical model of every renderer: emission–absorption, extinction τ = −ln(1−α)/D per world length, emission τ·c.
///
/// opacity_unit: D, the world distance to which the opacities refer, > 0. α is clamped to 1 − 1e-6 so that τ stays finite.
class Optics {
public:
    /// throws: Error(InvalidInput) as validate(function), or if D is not positive and finite
    Optics(TransferFunction function, double opacity_unit_world);

    [[nodiscard]] const TransferFunction& function() const { return function_; }
    [[nodiscard]] double opacity_unit() const { return unit_; }
    [[nodiscard]] Vec3 color(double value) const;
    [[nodiscard]] double extinction(double value) const;  // world⁻¹

    /// ∫ τ ds from the first knot to `value`, closed form.
    [[nodiscard]] double extinction_integral(double value) const;

    /// All values at which colour or opacity has a kink, ascending.
    [[nodiscard]] std::span<const double> knots() const { return knots_; }

    /// Integrates a stretch of `length` world units on which the value changes linearly from `front` to `back`. It is split at
    /// the knots; the optical depth of each piece is exact, its emission right to 1e-9 relative.
    ///
    /// source: docs/science.md; α, not τ, is linear between knots, so the erfcx/Dawson forms do not apply (docs/adr/0003)
    [[nodiscard]] Segment integrate(double front, double back, double length) const;

    /// Between neighbouring knots colour and opacity are linear in (value − begin) · inverse_width; beyond the ends constant.
    struct Span {
        double begin = 0, inverse_width = 0;
        double alpha = 0, alpha_step = 0;
        Vec3 color{0.0}, color_step{0.0};
        double integral = 0;  // of the extinction, from the first knot to begin
        bool transparent = false;
    };
    /// One more than there are knots: span i is from knot i − 1 to knot i, the upper end excluded.
    [[nodiscard]] std::span<const Span> spans() const { return spans_; }

private:
    [[nodiscard]] const Span& span_at(double value) const;
    [[nodiscard]] Segment integrate_piece(const Span& span, double front, double back, double length) const;

    TransferFunction function_;
    double unit_;
    std::vector<double> knots_;
    std::vector<Span> spans_;  // span i ends at knot i; the last has no end
};

/// Composites `behind` under `front` (front to back).
inline void composite(Segment& front, const Segment& behind) {
    front.color += front.transmittance * behind.color;
    front.transmittance *= behind.transmittance;
}

}  // namespace subvol
