#include "splat_means.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace subvol::detail {

namespace {

struct Mean {
    std::array<float, 4> color{};
    float depth = std::numeric_limits<float>::infinity();
};

Mean mean_of(const SplatResult& drawn, int x, int y, int n) {
    std::array<double, 4> sum{};
    double depth = 0, seen = 0;
    for (int j = y * n; j < (y + 1) * n; ++j) {
        for (int i = x * n; i < (x + 1) * n; ++i) {
            const auto pixel = drawn.image.pixel(i, j);
            for (std::size_t c = 0; c < 4; ++c) sum[c] += double{pixel[c]};
            const auto at =
                static_cast<std::size_t>(j) * static_cast<std::size_t>(drawn.image.width) + static_cast<std::size_t>(i);
            if (!std::isfinite(drawn.depth[at])) continue;
            depth += double{pixel[3]} * double{drawn.depth[at]};
            seen += double{pixel[3]};
        }
    }
    Mean mean;
    for (std::size_t c = 0; c < 4; ++c) mean.color[c] = static_cast<float>(sum[c] / (n * n));
    if (seen > 0) mean.depth = static_cast<float>(depth / seen);
    return mean;
}

}  // namespace

void take_means(SplatResult& drawn, int n) {
    if (n == 1) return;
    Image image(drawn.image.width / n, drawn.image.height / n);
    std::vector<float> depth(image.rgba.size() / 4);
    tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            const Mean mean = mean_of(drawn, x, y, n);
            std::copy(mean.color.begin(), mean.color.end(), image.pixel(x, y).begin());
            depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)] =
                mean.depth;
        }
    });
    drawn.image = std::move(image);
    drawn.depth = std::move(depth);
}

}  // namespace subvol::detail
