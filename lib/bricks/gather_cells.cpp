// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/gather_cells.h"

#include <algorithm>

#include "brick_layers.h"

namespace subvol::detail {

BrickMesh chosen_cells(const BrickMesh& part, std::span<const std::uint8_t> chosen, int layers) {
    if (std::ranges::find(chosen, 1) == chosen.end()) return {};
    std::vector<std::uint8_t> kept(chosen.begin(), chosen.end());
    grow(part.mesh, kept, layers);
    BrickMesh result = subset(part, kept);
    result.owned_cells.clear();
    for (std::size_t c = 0; c < kept.size(); ++c) {
        if (kept[c]) result.owned_cells.push_back(chosen[c]);
    }
    return result;
}

std::optional<BrickMesh> gather_cells(const Bricks& bricks, const GatherOptions& options) {
    std::vector<BrickMesh> parts;
    std::uint64_t cells = 0;
    for (std::size_t b = 0; b < bricks.bricks.size(); ++b) {
        report_progress(options.progress, "gather", static_cast<double>(b) / static_cast<double>(bricks.bricks.size()));
        if (!options.reads(b)) continue;
        BrickMesh brick = read_brick(bricks, b);
        if (options.fields) brick.mesh = options.fields(std::move(brick.mesh));
        BrickMesh part = chosen_cells(brick, options.chooses(brick), options.layers);
        cells += part.mesh.cells.size();
        if (!part.mesh.cells.empty()) parts.push_back(std::move(part));
        if (cells <= options.most_cells) continue;
        BrickMesh sum = merged(std::move(parts));  // cells about the chosen ones may be in several parts
        cells = sum.mesh.cells.size();
        if (cells > options.most_cells) return std::nullopt;
        parts.clear();
        parts.push_back(std::move(sum));
    }
    return merged(std::move(parts));
}

}  // namespace subvol::detail
