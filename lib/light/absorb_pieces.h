// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace subvol::detail {

/// Pieces as `absorb_piece` takes them, in rows aligned to 64 bytes. Lengths are not negative.
struct PieceRows {
    const double* alpha_front;
    const double* alpha_back;
    const double* length;
};

/// `absorb_piece` of each, to about 1e-11 relative, in vectors where pieces are thin. Rows are read and written up to the next
/// multiple of 8.
void absorb_pieces(const PieceRows& pieces, std::size_t count, double* mean, double* whole);

}  // namespace subvol::detail
