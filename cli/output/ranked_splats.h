// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "ranks.h"
#include "share.h"
#include "subvol/picture_maker.h"
#include "subvol/render_bricks.h"
#include "subvol/splat.h"
#include "subvol/splat_shares.h"

namespace subvol::cli {

/// The rows of a picture that this process draws.
///
/// share: none: all of them
/// ranks: the processes that draw the other rows; null: this one is alone
struct OwnRows {
    std::optional<Share> share{};
    Ranks* ranks = nullptr;

    [[nodiscard]] PixelRows of(int height) const { return share ? rows_of(*share, height) : PixelRows{}; }
    /// Whether rank 0 puts the rows of all ranks together.
    [[nodiscard]] bool gathered() const { return share && ranks != nullptr; }
    /// Whether this process gets a finished picture.
    [[nodiscard]] bool finished() const { return !gathered() || ranks->first(); }
};

/// The kernels of a volume without those that touch no row of a share; all of them if a pixel may depend on any kernel: without
/// a boundary, and with shadows or ambient occlusion. The picture of these has the bits of the whole one in the share's rows.
///
/// options: get the number of sheets of the whole picture
[[nodiscard]] RbfVolume kernels_of_rows(RbfVolume volume, const Share& share, const View& view, const Optics& optics,
                                        SplatOptions& options);

/// What ranks have sent to each other for a picture.
struct ShippedKernels {
    std::size_t kernels = 0;  // that another rank got; one that two ranks got counts twice
    std::size_t bytes = 0;
};

/// Sends every rank the kernels that touch its rows of the picture, in the order of all kernels, and the number of sheets of
/// the picture of all.
///
/// own:     the kernels of this rank, and the whole boundary
/// options: get the number of sheets of the whole picture
/// returns: those for this rank's rows, and the boundary
[[nodiscard]] RbfVolume ship_kernels(const RbfVolume& own, const View& view, const Optics& optics, SplatOptions& options,
                                     Ranks& ranks, ShippedKernels& shipped);

/// Puts each rank's rows of a picture together, at rank 0; elsewhere the picture stays as it is.
void gather_rows(Picture& picture, Ranks& ranks);

/// What all ranks have counted for their rows together; of one process its own.
void add_up(const OwnRows& rows, std::span<std::size_t> counts);

}  // namespace subvol::cli
