// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace subvol::detail {

// A piece is a stretch of a ray on which the opacity α is linear. With q = 1 − α and u in [0,1] along the piece, its optical
// depth up to u is
//
//     T(u) = −L ∫₀ᵘ ln q du,   L: the piece's length in opacity units,
//
// which has a closed form. The absorbed light, ∫ e^{−T}, has none for linear α (docs/adr/0003): it is integrated by
// Gauss–Legendre over pieces that are thin enough, and thicker ones are halved.

/// The light that a piece absorbs. T is the optical depth from its front.
struct Absorption {
    double mean = 0;   ///< 1 − the mean of e^{−T} over the piece (1−Ψ of docs/science.md)
    double whole = 0;  ///< 1 − e^{−T} at its back (1−ζ)
};

/// The optical depth of a piece, in closed form. alpha: in [0,1), at front and back; length: in opacity units, may be negative
[[nodiscard]] double piece_depth(double alpha_front, double alpha_back, double length);

/// The absorption of a piece, to about 1e-11 relative.
[[nodiscard]] Absorption absorb_piece(double alpha_front, double alpha_back, double length);

/// The arguments of `absorb_piece` for many pieces, in rows aligned to 64 bytes. Lengths are not negative.
struct PieceRows {
    const double* alpha_front;
    const double* alpha_back;
    const double* length;
};

/// `absorb_piece` of each piece, to about 1e-11 relative, in SIMD vectors where pieces are thin. Rows are read and written up
/// to the next multiple of 8.
void absorb_pieces(const PieceRows& pieces, std::size_t count, double* mean, double* whole);

}  // namespace subvol::detail
