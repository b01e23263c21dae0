// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/detail/regular_grid.h"
#include "subvol/sample.h"

namespace subvol::detail {

/// One channel of an attribute at the points of a mesh.
struct ChannelView {
    const double* values;
    std::size_t stride;
    [[nodiscard]] double at(Index point) const { return values[point * stride]; }
};

[[nodiscard]] std::vector<ChannelView> channels_of(const HexMesh& mesh);

/// Evaluates a rule in one cell after the other. Not thread-safe.
class RuleInCell {
public:
    /// rule: Cubic or Paper. All references are kept.
    RuleInCell(const Topology& topology, std::span<const ChannelView> channels, ValueRule rule, const Kernel& kernel)
        : topology_(topology), channels_(channels), rule_(rule), kernel_(kernel), nodes_(64 * channels.size()) {}

    void enter(Index cell);
    [[nodiscard]] double value(std::size_t channel, const Vec3& uvw) const;

private:
    [[nodiscard]] double cubic(const double* nodes, const Vec3& uvw) const;
    [[nodiscard]] double weighted_mean(const double* nodes, const Vec3& uvw) const;

    const Topology& topology_;
    std::span<const ChannelView> channels_;
    ValueRule rule_;
    const Kernel& kernel_;
    Index cell_ = kNone;
    GridPoints grid_;
    std::vector<double> nodes_;  // 64 for each channel
};

}  // namespace subvol::detail
