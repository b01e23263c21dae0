// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace subvol::detail {

/// What a stretch of a ray on which the opacity goes linearly takes from the light: T the optical depth from its front.
///
/// mean:  1 − the mean of e^{−T} over the stretch (1−Ψ of docs/science.md)
/// whole: 1 − e^{−T} at its back (1−ζ)
struct Absorption {
    double mean = 0;
    double whole = 0;
};

/// Optical depth, closed form. alpha: in [0,1) at front and back; length: in opacity units, may be negative
[[nodiscard]] double piece_depth(double alpha_front, double alpha_back, double length);

/// Absorption to about 1e-11 relative, by Gauss–Legendre on the closed-form depth over stretches that are thin enough.
[[nodiscard]] Absorption absorb_piece(double alpha_front, double alpha_back, double length);

}  // namespace subvol::detail
