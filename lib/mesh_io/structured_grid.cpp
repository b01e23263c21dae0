// SPDX-License-Identifier: Apache-2.0
#include "structured_grid.h"

namespace subvol::detail {

namespace {

std::size_t product(const std::array<std::size_t, 3>& factors) {
    std::size_t result = 1;
    for (const std::size_t factor : factors) {
        if (factor == 0) return 0;
    }
    for (const std::size_t factor : factors) {
        if (factor >= kNone / result) return kNone;
        result *= factor;
    }
    return result;
}

std::array<std::size_t, 3> cells_along(const StructuredGrid& grid) {
    std::array<std::size_t, 3> cells{};
    for (std::size_t a = 0; a < 3; ++a) cells[a] = grid.points[a] == 0 ? 0 : grid.points[a] - 1;
    return cells;
}

}  // namespace

std::size_t StructuredGrid::point_count() const {
    return product(points);
}

std::size_t StructuredGrid::cell_count() const {
    return product(cells_along(*this));
}

std::string size_text(const StructuredGrid& grid) {
    const auto& [i, j, k] = grid.points;
    return std::to_string(i) + " x " + std::to_string(j) + " x " + std::to_string(k) + " points";
}

std::size_t most_points(std::size_t values) {
    constexpr std::size_t kFew = 1 << 16;
    return kFew + values;
}

void add_points(MeshFile& into, const std::array<std::vector<double>, 3>& at, std::size_t position) {
    for (const double z : at[2]) {
        for (const double y : at[1]) {
            for (const double x : at[0]) add_point(into, {x, y, z}, position);
        }
    }
}

void add_hexes(MeshFile& into, const StructuredGrid& grid, std::size_t first_point, std::size_t first_cell) {
    const auto cells = cells_along(grid);
    const std::size_t row = grid.points[0], layer = grid.points[0] * grid.points[1];
    std::size_t number = first_cell;
    for (std::size_t k = 0; k < cells[2]; ++k) {
        for (std::size_t j = 0; j < cells[1]; ++j) {
            for (std::size_t i = 0; i < cells[0]; ++i) {
                const std::size_t p = first_point + i + j * row + k * layer;
                auto& corners = into.hexes.corners.emplace_back();
                const std::array<std::size_t, 4> bottom{p, p + 1, p + 1 + row, p + row};
                for (std::size_t c = 0; c < 4; ++c) {
                    corners[c] = static_cast<Index>(bottom[c]);
                    corners[c + 4] = static_cast<Index>(bottom[c] + layer);
                }
                into.hexes.numbers.push_back(static_cast<Index>(number++));
            }
        }
    }
}

}  // namespace subvol::detail
