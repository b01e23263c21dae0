// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "point_lines.h"
#include "subvol/sample.h"

namespace subvol::detail {

/// Brings together what the directions about a point say of its kernel: the frame from their steps, the gradient by least
/// squares, the second moment as a mean (docs/adr/0004).
class DirectionSums {
public:
    DirectionSums(const SampleOptions& options, RbfVolume& volume);

    void begin(std::size_t point);

    /// A direction: step ∂x and second difference ∂²x of the position per sample interval, those of channel c at d_f[c],
    /// dd_f[c]. weight: how many cells have this direction
    void add(double weight, const Vec3& step, const Vec3& bend, const double* d_f, const double* dd_f);

    /// Writes frame, gradients and moments of the point; `cells`: how many cells are about it.
    ///
    /// returns: whether the frame was flat and had to be thickened
    bool finish(double cells);

private:
    const SampleOptions& options_;
    RbfVolume& volume_;
    double radius2_;
    std::size_t point_ = 0;
    Mat3 metric_{0.0};
    Vec3 bend_{0.0};
    std::vector<Vec3> metric_gradient_;
    std::vector<double> laplacian_;
};

/// What the moment leaves of a Hessian: H less its part along the frame's inverse, as six numbers.
[[nodiscard]] Symmetric3 without_moment(const Mat3& hessian, const Symmetric3& frame);

/// Fills in the Hessians of all channels from the gradients that the volume has, by least squares over the neighbours on the
/// lines: along a line from the values, across it from the differences of the gradients.
void fit_hessians(const PointLines& lines, RbfVolume& volume);

/// An RBF volume of `count` points with the channels of a mesh, nothing filled in; its centers are yet to come.
///
/// throws: Error(InvalidInput) if they are too many
[[nodiscard]] RbfVolume empty_volume(const HexMesh& mesh, std::size_t count, const SampleOptions& options);

}  // namespace subvol::detail
