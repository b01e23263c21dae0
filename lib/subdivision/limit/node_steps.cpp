// SPDX-License-Identifier: Apache-2.0
// Prediction is separable: first along u between nodes that are even in v and w, then along
// v, then along w. After the three passes an odd node in a face or a cell holds the product of the predictions along its axes.
// The passes overwrite odd nodes only, so a copy of the nodes is all the memory that they need.
#include "subvol/detail/node_steps.h"

#include <algorithm>
#include <cmath>

namespace subvol::detail {

void NodeBlock::gather(const DenseCell& grid, const std::array<std::size_t, 3>& first, std::size_t step, std::size_t side) {
    side_ = side;
    channels_ = 3;
    for (const auto& values : grid.values) channels_ += values.size() / grid.points.size();
    nodes_.resize(side * side * side * channels_);
    const auto place = [&](std::size_t u, std::size_t v, std::size_t w) {
        return first[0] + step * u + grid.side * (first[1] + step * v + grid.side * (first[2] + step * w));
    };
    origin_ = grid.points[place(0, 0, 0)];
    double* to = nodes_.data();
    for (std::size_t w = 0; w < side; ++w) {
        for (std::size_t v = 0; v < side; ++v) {
            for (std::size_t u = 0; u < side; ++u) {
                const std::size_t n = place(u, v, w);
                // Relative to the first node, so that differences of positions far from the origin keep their digits.
                const Vec3 p = grid.points[n] - origin_;
                *to++ = p.x;
                *to++ = p.y;
                *to++ = p.z;
                for (const auto& values : grid.values) {
                    const std::size_t count = values.size() / grid.points.size();
                    to = std::copy_n(&values[n * count], count, to);
                }
            }
        }
    }
}

/// Predicts the nodes at odd places along one axis.
///
/// stride: between nodes along the axis; across, outer: steps between the nodes from which lines start, along the other two
///         axes in their order
void NodeBlock::predict_along(std::size_t stride, std::size_t across, std::size_t outer, Prediction by) {
    const std::size_t plane = side_ * side_;
    const std::size_t first_axis = stride == 1 ? side_ : 1, second_axis = stride == plane ? side_ : plane;
    const auto line = static_cast<std::ptrdiff_t>(stride * channels_);
    for (std::size_t j = 0; j < side_; j += outer) {
        for (std::size_t i = 0; i < side_; i += across) {
            double* start = &predicted_[(i * first_axis + j * second_axis) * channels_];
            for (std::size_t k = 1; k < side_; k += 2) {
                double* to = start + static_cast<std::ptrdiff_t>(k) * line;
                if (by == Prediction::Trilinear) {
                    for (std::size_t c = 0; c < channels_; ++c, ++to) *to = 0.5 * (to[-line] + to[line]);
                } else {
                    // The parabola through three even nodes at −2, 0 and 2, at the odd node between the first two: 3/8, 3/4 and
                    // −1/8.
                    const std::ptrdiff_t on = k % 4 == 1 ? line : -line;  // towards the middle of the three
                    for (std::size_t c = 0; c < channels_; ++c, ++to) {
                        *to = 0.375 * to[-on] + 0.75 * to[on] - 0.125 * to[3 * on];
                    }
                }
            }
        }
    }
}

void NodeBlock::predict(Prediction by) {
    predicted_ = nodes_;
    predict_along(1, 2, 2, by);
    predict_along(side_, 1, 2, by);
    predict_along(side_ * side_, 1, 1, by);
}

/// The square of the distance in space, and the difference of values.
Step NodeBlock::square_step(std::size_t n, const std::vector<double>& scales) const {
    const double *a = &nodes_[n * channels_], *b = &predicted_[n * channels_];
    Step step;
    for (std::size_t d = 0; d < 3; ++d) step.position += (a[d] - b[d]) * (a[d] - b[d]);
    for (std::size_t c = 3; c < channels_; ++c) step.value = std::max(step.value, std::abs(a[c] - b[c]) * scales[c - 3]);
    return step;
}

void NodeBlock::steps(Prediction by, const std::vector<double>& scales, std::vector<Step>& steps) {
    predict(by);
    steps.resize(nodes_.size() / channels_);
    for (std::size_t n = 0; n < steps.size(); ++n) {
        steps[n] = square_step(n, scales);
        steps[n].position = std::sqrt(steps[n].position);
    }
}

Step NodeBlock::largest_step(Prediction by, const std::vector<double>& scales) {
    predict(by);
    Step most;
    for (std::size_t n = 0; n < nodes_.size() / channels_; ++n) most = larger(most, square_step(n, scales));
    most.position = std::sqrt(most.position);
    return most;
}

double levels_between(double tolerance, double step) {
    // Each level divides the step by four, so l levels by 4ˡ = 2²ˡ.
    return std::ceil(std::log2(step / tolerance) / 2);
}

double value_scale(double min, double max) {
    constexpr double kRounding = 1e-12;  // relative: a field that varies less is constant
    const bool varies = max - min > kRounding * std::max(std::abs(min), std::abs(max));
    return varies ? 1 / (max - min) : 0.0;
}

std::vector<double> value_scales(const HexMesh& mesh) {
    std::vector<std::uint8_t> used(mesh.points.size(), 0);
    for (const auto& cell : mesh.cells) {
        for (const Index p : cell) used[p] = 1;
    }
    std::vector<double> scales;
    for (const Attribute& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        double min = HUGE_VAL, max = -HUGE_VAL;
        for (std::size_t i = 0; i < attribute.values.size(); ++i) {
            if (!used[i / channels]) continue;
            min = std::min(min, attribute.values[i]);
            max = std::max(max, attribute.values[i]);
        }
        scales.insert(scales.end(), channels, value_scale(min, max));
    }
    return scales;
}

}  // namespace subvol::detail
