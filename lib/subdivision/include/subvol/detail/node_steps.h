// SPDX-License-Identifier: Apache-2.0
// How far the nodes of one level lie from their prediction by those of the level before.
//
//    ●───○───●───○───●     the nodes of level l along an edge of a control cell: even nodes ● are those of level l − 1
//
// The step to level l is the distance of an odd node ○ from its prediction by even nodes: from the mean of the two beside it,
// if cells of level l − 1 are trilinear, or from a parabola through three of them (weights 3/8, 3/4, −1/8), if they are
// triquadratic. In a face or cell the predictions are products of those along the axes. Where the limit is smooth the steps
// from level to level shrink by a factor of 4 or more, so the last step bounds what is left: 1/4 + 1/16 + … = 1/3 of it.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "subvol/dense_cells.h"

namespace subvol::detail {

/// Distances in world space, and of values as parts of their attribute's range.
struct Step {
    double position = 0, value = 0;
};

[[nodiscard]] inline Step larger(const Step& a, const Step& b) {
    return {std::max(a.position, b.position), std::max(a.value, b.value)};
}
[[nodiscard]] inline Step smaller(const Step& a, const Step& b) {
    return {std::min(a.position, b.position), std::min(a.value, b.value)};
}

/// Trilinear: by the mean of the even nodes beside the odd one. Triquadratic: by the parabola through three even nodes, the
/// middle one at twice an odd number.
enum class Prediction { Trilinear, Triquadratic };

/// The nodes of a cubic part of a grid: for each node its position relative to the first one, then the channels of all
/// attributes.
class NodeBlock {
public:
    /// first: the lowest node; step: between nodes of the block; side: nodes along each axis
    void gather(const DenseCell& grid, const std::array<std::size_t, 3>& first, std::size_t step, std::size_t side);

    [[nodiscard]] std::size_t channels() const { return channels_; }
    [[nodiscard]] const Vec3& origin() const { return origin_; }
    /// channels() numbers
    [[nodiscard]] const double* node(std::size_t n) const { return &nodes_[n * channels_]; }

    /// The step of each node, 0 for the even ones. side: at least 3, and at least 5 and one more than a multiple of 4 for
    /// triquadratic predictions
    ///
    /// scales: for each channel of the attributes 1/range, or 0
    void steps(Prediction by, const std::vector<double>& scales, std::vector<Step>& steps);

    /// The largest of these.
    [[nodiscard]] Step largest_step(Prediction by, const std::vector<double>& scales);

private:
    void predict(Prediction by);
    void predict_along(std::size_t stride, std::size_t across, std::size_t outer, Prediction by);
    [[nodiscard]] Step square_step(std::size_t n, const std::vector<double>& scales) const;

    std::size_t side_ = 0, channels_ = 0;
    Vec3 origin_{0.0};
    std::vector<double> nodes_, predicted_;
};

/// How many more levels make a step short enough, if each makes it four times shorter; negative if fewer would do.
[[nodiscard]] double levels_between(double tolerance, double step);

/// For each channel of the attributes 1/range, over the points that cells use, or 0 for a constant; other points may have any
/// value. The mesh must be valid.
[[nodiscard]] std::vector<double> value_scales(const HexMesh& mesh);

/// The scale of values between a least and a largest one.
[[nodiscard]] double value_scale(double min, double max);

}  // namespace subvol::detail
