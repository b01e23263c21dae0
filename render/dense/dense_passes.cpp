// SPDX-License-Identifier: Apache-2.0
#include "dense_passes.h"

#include <algorithm>
#include <cmath>

namespace subvol::detail {

namespace {

bool overlap(const PixelRect& a, const PixelRect& b) {
    return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

void plan(const PixelRect& rect, const std::vector<SeenGrid>& grids, std::size_t at_once, std::vector<DensePass>& passes) {
    constexpr int kTile = 16;
    std::vector<SeenGrid> here;
    std::copy_if(grids.begin(), grids.end(), std::back_inserter(here),
                 [&](const SeenGrid& grid) { return overlap(grid.rect, rect); });
    if (here.empty()) return;
    const int width = rect.x1 - rect.x0, height = rect.y1 - rect.y0;
    if (here.size() > at_once && std::max(width, height) > kTile) {
        PixelRect first = rect, second = rect;
        if (width >= height) {
            first.x1 = second.x0 = rect.x0 + width / 2;
        } else {
            first.y1 = second.y0 = rect.y0 + height / 2;
        }
        plan(first, here, at_once, passes);
        plan(second, here, at_once, passes);
        return;
    }
    DensePass pass{rect, {}};
    for (const SeenGrid& grid : here) pass.cells.push_back(grid.cell);
    passes.push_back(std::move(pass));
}

}  // namespace

std::optional<PixelRect> pixels_of(const Box& box, const View& view) {
    constexpr double kMargin = 1;  // in pixels, for rounding
    const PixelRect all{0, 0, view.width(), view.height()};
    Vec2 low(std::numeric_limits<double>::infinity()), high(-std::numeric_limits<double>::infinity());
    int near_eye = 0, behind = 0;
    for (int k = 0; k < 8; ++k) {
        const Vec3 corner(k & 1 ? box.upper.x : box.lower.x, k & 2 ? box.upper.y : box.lower.y,
                          k & 4 ? box.upper.z : box.lower.z);
        const Vec3 eye = view.to_eye(corner);
        if (!(eye.z > 1e-6 * glm::length(eye))) {
            ++near_eye;
            behind += eye.z <= 0;
            continue;
        }
        const Vec2 at = view.to_pixels(eye);
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    if (behind == 8) return std::nullopt;
    if (near_eye > 0) return all;
    const auto pixel = [](double x, int most) { return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(most))); };
    const PixelRect rect{pixel(std::floor(low.x - kMargin), all.x1), pixel(std::floor(low.y - kMargin), all.y1),
                         pixel(std::ceil(high.x + kMargin), all.x1), pixel(std::ceil(high.y + kMargin), all.y1)};
    if (rect.x0 >= rect.x1 || rect.y0 >= rect.y1) return std::nullopt;
    return rect;
}

std::vector<DensePass> plan_passes(const View& view, const std::vector<SeenGrid>& grids, std::size_t at_once) {
    std::vector<DensePass> passes;
    plan({0, 0, view.width(), view.height()}, grids, std::max<std::size_t>(at_once, 1), passes);
    return passes;
}

}  // namespace subvol::detail
