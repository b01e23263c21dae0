// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "ranks.h"
#include "share.h"
#include "subvol/brick_points.h"
#include "subvol/picture_maker.h"
#include "subvol/render_brick_tets.h"
#include "subvol/render_bricks.h"
#include "subvol/splat.h"
#include "subvol/splat_shares.h"

namespace subvol::cli {

/// The rows of a picture that this process draws.
struct OwnRows {
    std::optional<Share> share{};  ///< the share of the rows; none: all of them
    Ranks* ranks = nullptr;        ///< the processes that draw the other rows; null: this one is alone

    [[nodiscard]] PixelRows of(int height) const { return share ? rows_of(*share, height) : PixelRows{}; }
    /// Whether rank 0 puts the rows of all ranks together.
    [[nodiscard]] bool gathered() const { return share && ranks != nullptr; }
    /// Whether this process gets a finished picture.
    [[nodiscard]] bool finished() const { return !gathered() || ranks->first(); }
};

/// What ranks have sent to each other for a picture.
struct ShippedKernels {
    std::size_t kernels = 0;  // that another rank got; one that two ranks got counts twice
    std::size_t bytes = 0;
};

/// A picture of which this process draws a share of the rows: for --part, or with all ranks, which join them at rank 0.
class PictureShares : public PictureTeam {
public:
    /// rows: with a share
    explicit PictureShares(const OwnRows& rows) : rows_(rows) {}

    [[nodiscard]] PixelRows rows(int height) const override { return rows_.of(height); }
    [[nodiscard]] bool finishes() const override { return rows_.finished(); }
    [[nodiscard]] SplatResult splat(const RbfVolume& volume, const SplatOptions& options, const BoundaryValues& skin,
                                    const View& view, const Optics& optics, Progress* progress, Facts& facts) override;
    [[nodiscard]] SplatResult splat(const MeshSource& source, Surface boundary, const BrickSplatOptions& options,
                                    const View& view, const Optics& optics, Facts& facts) override;
    [[nodiscard]] BrickTets measure(const MeshSource& source, const BrickTetsOptions& options) override;
    void add_up(std::span<std::size_t> counts) override;
    void gather(Picture& picture) override;

private:
    OwnRows rows_;
};

/// `write_points_of_bricks` by all ranks: each samples a range of the pieces, one after the other, and sends the kernels of
/// each to rank 0, which writes. Elsewhere nothing is returned.
BrickPointsReport write_points_ranked(const std::filesystem::path& path, const MeshSource& source, const SampleOptions& options,
                                      Ranks& ranks);

}  // namespace subvol::cli
