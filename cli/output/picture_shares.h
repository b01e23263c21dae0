// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ranked_splats.h"
#include "subvol/picture_maker.h"

namespace subvol::cli {

/// A picture of which this process draws a share of the rows: for --part, or with all ranks, which join them at rank 0.
class PictureShares : public PictureTeam {
public:
    /// rows: with a share
    explicit PictureShares(const OwnRows& rows) : rows_(rows) {}

    [[nodiscard]] PixelRows rows(int height) const override { return rows_.of(height); }
    [[nodiscard]] bool finishes() const override { return rows_.finished(); }
    [[nodiscard]] SplatResult splat(const RbfVolume& volume, const SplatOptions& options, const BoundaryValues& skin, const View& view, const Optics& optics, Progress* progress,
                                    Facts& facts) override;
    [[nodiscard]] SplatResult splat(const Bricks& bricks, const BrickFields& fields, Surface boundary,
                                    const BrickSplatOptions& options, const View& view, const Optics& optics,
                                    Facts& facts) override;
    [[nodiscard]] BrickTets measure(const Bricks& bricks, const BrickTetsOptions& options) override;
    void add_up(std::span<std::size_t> counts) override;
    void gather(Picture& picture) override;

private:
    OwnRows rows_;
};

}  // namespace subvol::cli
