// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/coverage.h"

#include <algorithm>
#include <cmath>
#include "subvol/raster.h"

namespace subvol::detail {
namespace {

/// Signed areas of polygons in the pixels of a box: the sum of a row up to a pixel is its cover. Each edge adds what lies to
/// its right.
class Areas {
public:
    Areas(int left, int top, int width, int height)
        : left_(left), top_(top), width_(width), height_(height), cells_(width + 2, height) {}

    void add_edge(Vec2 a, Vec2 b) {
        a -= Vec2(left_, top_);
        b -= Vec2(left_, top_);
        if (a.y == b.y) return;
        const double sign = a.y < b.y ? 1 : -1;
        if (a.y > b.y) std::swap(a, b);
        const double slope = (b.x - a.x) / (b.y - a.y);
        const int first = std::max(0, static_cast<int>(std::floor(a.y)));
        for (int row = first; row < height_ && row < b.y; ++row) {
            const double y0 = std::max(a.y, double(row)), y1 = std::min(b.y, double(row + 1));
            if (y1 <= y0) continue;
            add_in_row(row, a.x + slope * (y0 - a.y), a.x + slope * (y1 - a.y), sign * (y1 - y0));
        }
    }

    template <class Take>
    void for_each(const Take& take) const {
        for (int y = 0; y < height_; ++y) {
            double sum = 0;
            for (int x = 0; x < width_; ++x) {
                sum += cells_.at(x, y);
                const double cover = std::min(1.0, std::abs(sum));
                if (cover > 1e-3) take(left_ + x, top_ + y, cover);
            }
        }
    }

private:
    /// The piece of an edge in one row: the height is spread over the columns that it crosses.
    void add_in_row(int row, double x0, double x1, double height) {
        const double low = std::clamp(std::min(x0, x1), 0.0, double(width_));
        const double high = std::clamp(std::max(x0, x1), 0.0, double(width_));
        const int first = static_cast<int>(low), last = std::min(width_, static_cast<int>(high));
        for (int x = first; x <= last; ++x) {
            const double from = std::max(low, double(x)), to = std::min(high, double(x + 1));
            const double part = high > low ? height * (to - from) / (high - low) : height;
            const double right = x + 1 - 0.5 * (from + to);  // what is covered of this pixel; the rest is of the next
            cells_.at(x, row) += part * right;
            cells_.at(x + 1, row) += part * (1 - right);
            if (!(high > low)) return;
        }
    }

    int left_, top_, width_, height_;
    Raster<double> cells_;
};

}  // namespace

void fill(Image& image, std::span<const std::vector<Vec2>> polygons, const Vec3& rgb) {
    Vec2 low(image.width, image.height), high(0, 0);
    for (const auto& polygon : polygons) {
        for (const Vec2& p : polygon) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    }
    const int left = static_cast<int>(std::floor(std::max(low.x, 0.0))),
              top = static_cast<int>(std::floor(std::max(low.y, 0.0)));
    const int right = static_cast<int>(std::ceil(std::min(high.x, double(image.width))));
    const int bottom = static_cast<int>(std::ceil(std::min(high.y, double(image.height))));
    if (left >= right || top >= bottom) return;
    Areas areas(left, top, right - left, bottom - top);
    for (const auto& polygon : polygons) {
        for (std::size_t i = 0; i < polygon.size(); ++i) areas.add_edge(polygon[i], polygon[(i + 1) % polygon.size()]);
    }
    areas.for_each([&](int x, int y, double cover) { put_over(image, x, y, rgb, cover); });
}

void for_each_pixel_of_line(int width, int height, const Vec2& from, const Vec2& to, double width_px,
                            const std::function<void(int, int, double, double)>& take) {
    const Vec2 along = to - from;
    const double squared = glm::dot(along, along), reach = 0.5 * width_px + 0.5;
    if (!std::isfinite(squared)) return;
    const auto in = [](double v, int most) { return static_cast<int>(std::clamp(std::floor(v), 0.0, double(most))); };
    const int top = in(std::min(from.y, to.y) - reach, height);
    const int bottom = in(std::max(from.y, to.y) + reach + 1, height);
    for (int y = top; y < bottom; ++y) {
        // The part of the line that can reach this row, so that slanted lines do not visit their whole box.
        double t0 = 0, t1 = 1;
        if (std::abs(along.y) > 1e-9) {
            const double a = (y + 0.5 - reach - 0.5 - from.y) / along.y, b = (y + 0.5 + reach + 0.5 - from.y) / along.y;
            t0 = std::clamp(std::min(a, b), 0.0, 1.0);
            t1 = std::clamp(std::max(a, b), 0.0, 1.0);
        }
        const double xa = from.x + t0 * along.x, xb = from.x + t1 * along.x;
        const int left = in(std::min(xa, xb) - reach, width), right = in(std::max(xa, xb) + reach + 1, width);
        for (int x = left; x < right; ++x) {
            const Vec2 centre(x + 0.5, y + 0.5);
            const double t = squared > 0 ? std::clamp(glm::dot(centre - from, along) / squared, 0.0, 1.0) : 0.0;
            const double cover = std::min({1.0, width_px, reach - glm::length(centre - (from + t * along))});
            if (cover > 1e-3) take(x, y, cover, t);
        }
    }
}

}  // namespace subvol::detail
