// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "point_lines.h"
#include "subvol/sample.h"

namespace subvol::detail {

/// Sums over the directions about a point (a step along an axis of each cell, or along a line), from which its kernel follows:
/// the frame from the steps, the gradient by least squares, the second moment as a mean (docs/adr/0004).
class DirectionSums {
public:
    /// diagonal: of the mesh's bounding box
    DirectionSums(const SampleOptions& options, double diagonal, RbfVolume& volume);

    void begin(std::size_t point);

    /// Adds a direction.
    ///
    /// weight:     how many cells have it
    /// step, bend: derivative and second difference of the position per sample interval
    /// d_f, dd_f:  the same of each channel
    void add(double weight, const Vec3& step, const Vec3& bend, const double* d_f, const double* dd_f);

    /// Writes frame, gradients and moments of the point. cells: how many cells are about it
    ///
    /// returns: whether the frame was flat and was thickened
    bool finish(double cells);

private:
    const SampleOptions& options_;
    RbfVolume& volume_;
    double diagonal_;  // of the mesh
    double radius2_;
    std::size_t point_ = 0;
    Mat3 metric_{0.0};
    Vec3 bend_{0.0};
    std::vector<Vec3> metric_gradient_;
    std::vector<double> laplacian_;
};

/// The part of a Hessian that the moment does not have: H less its part along the inverse of the frame.
[[nodiscard]] Symmetric3 without_moment(const Mat3& hessian, const Symmetric3& frame);

/// Writes the Hessians of all channels by least squares over the neighbours on the lines: along a line from the values, across
/// it from the differences of the volume's gradients.
void fit_hessians(const PointLines& lines, RbfVolume& volume);

/// An RBF volume of `count` points with the channels of a mesh. Frames and channels are zero; there are no centres yet.
///
/// throws: Error(InvalidInput) if there are too many points
[[nodiscard]] RbfVolume empty_volume(const HexMesh& mesh, std::size_t count, const SampleOptions& options);

}  // namespace subvol::detail
