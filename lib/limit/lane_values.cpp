// SPDX-License-Identifier: Apache-2.0
#include "lane_values.h"

#include <algorithm>

namespace subvol::detail {

void LaneValues::load(const HexMesh& mesh, std::span<const Member> cells, const WeightTable& table) {
    const std::size_t points = cells[0].point_count;
    channels_ = 3;
    for (const Attribute& attribute : mesh.attributes) channels_ += static_cast<std::size_t>(attribute.channels);
    stride_ = points * kTableLanes;
    if (cells.size() < kTableLanes) in_.clear();  // nothing but zeros in the lanes that have no cell
    in_.resize(channels_ * stride_, 0.0);
    for (std::size_t lane = 0; lane < cells.size(); ++lane) {
        for (const std::size_t p : table.used) {
            const Index point = cells[lane].points[p];
            double* to = &in_[p * kTableLanes + lane];
            for (int d = 0; d < 3; ++d, to += stride_) *to = mesh.points[point][d];
            for (const Attribute& attribute : mesh.attributes) {
                const auto count = static_cast<std::size_t>(attribute.channels);
                for (std::size_t c = 0; c < count; ++c, to += stride_) *to = attribute.values[point * count + c];
            }
        }
    }
}

void LaneValues::apply(const WeightTable& table) {
    rows_ = table.rows();
    out_.resize(channels_ * rows_ * kTableLanes);
    for (std::size_t c = 0; c < channels_; ++c) apply_table(table, &in_[c * stride_], &out_[c * rows_ * kTableLanes]);
}

void LaneValues::store(std::size_t lane, std::size_t side, std::uint8_t turn, CellGrid& grid) const {
    const auto& sides = cell_turns()[turn].sides;
    std::array<std::ptrdiff_t, 3> strides;  // of the cell's grid, along the axes of the rows
    std::ptrdiff_t first = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = sides[2 * a] / 2;
        const auto stride = static_cast<std::ptrdiff_t>(axis == 0 ? 1 : axis == 1 ? side : side * side);
        const bool reversed = (sides[2 * a] & 1) != 0;
        strides[a] = reversed ? -stride : stride;
        if (reversed) first += stride * static_cast<std::ptrdiff_t>(side - 1);
    }
    const std::size_t from_stride = rows_ * kTableLanes;
    const double* row = &out_[lane];
    for (std::size_t w = 0; w < side; ++w) {
        for (std::size_t v = 0; v < side; ++v) {
            std::ptrdiff_t node =
                first + static_cast<std::ptrdiff_t>(v) * strides[1] + static_cast<std::ptrdiff_t>(w) * strides[2];
            for (std::size_t u = 0; u < side; ++u, node += strides[0], row += kTableLanes) {
                grid.points[static_cast<std::size_t>(node)] = {row[0], row[from_stride], row[2 * from_stride]};
                const double* channel = row + 3 * from_stride;
                for (auto& values : grid.values) {
                    const std::size_t count = values.size() / rows_;
                    double* to = &values[static_cast<std::size_t>(node) * count];
                    for (std::size_t c = 0; c < count; ++c, channel += from_stride) to[c] = *channel;
                }
            }
        }
    }
}

}  // namespace subvol::detail
