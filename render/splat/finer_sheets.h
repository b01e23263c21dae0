// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace subvol::detail {

struct SheetStack;
struct SplatFrame;
struct SplatScene;

/// Where a picture has more sheets than its stack. A cell is a square of pixels and some sheets; each stretch that ends at one
/// of these sheets is cut into 2^level equal ones.
struct FinerSheets {
    static constexpr int kSide_px = 8, kSheets = 8, kMostLevel = 6;

    int columns = 0, rows = 0, layers = 0;
    std::vector<std::uint8_t> levels{};  // of cell (x, y, z): (y · columns + x) · layers + z; empty: 0 everywhere

    [[nodiscard]] bool any() const { return !levels.empty(); }
    /// The sheets that a stack would have that is everywhere as fine as the finest cell.
    [[nodiscard]] int sheets_finest(int sheets) const {
        return any() ? ((sheets - 1) << std::ranges::max(levels)) + 1 : sheets;
    }
    /// The level at a pixel in the stretch that ends at a sheet.
    [[nodiscard]] int level(int x_px, int y_px, int sheet) const {
        if (!any()) return 0;
        const int x = x_px / kSide_px, y = y_px / kSide_px;
        return x < columns && y < rows ? levels[static_cast<std::size_t>((y * columns + x) * layers + sheet / kSheets)] : 0;
    }
};

/// The level that is left of a cell's where this part of the light arrives at most: half of it allows twice the error.
[[nodiscard]] inline int level_in_light(int level, float light) {
    const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(light) >> 23) - 127;  // of light ≥ 0; −127 for 0
    return std::clamp(level + exponent + 1, 0, level);
}

/// Whether the scene may have kernels that are thin beside the sheets; otherwise no cell needs more of them.
[[nodiscard]] bool may_be_thin(const SplatScene& scene, const SheetStack& sheets);

/// Finds the cells that need more sheets for the scene's tolerance, from an estimate of the error that each kernel causes.
///
/// frame: needs its scene, view, classification, sheets and kernels
[[nodiscard]] FinerSheets finer_sheets(const SplatFrame& frame);

}  // namespace subvol::detail
