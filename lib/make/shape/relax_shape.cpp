// SPDX-License-Identifier: Apache-2.0
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "distortion.h"
#include "flatness.h"
#include "shape_fitter.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/transposed_table.h"

namespace subvol::detail {

namespace {

Mat3 edges_at(const std::array<Index, 8>& cell, std::size_t corner, const Vec3* points) {
    const Vec3& x = points[cell[corner]];
    const auto& [a, b, c] = kCornerNeighbors[corner];
    return {points[cell[a]] - x, points[cell[b]] - x, points[cell[c]] - x};
}

}  // namespace

/// What is minimised, as a function of the ways of the control points from their start, in sides.
class ShapeEnergy : public ceres::FirstOrderFunction {
public:
    ShapeEnergy(const ShapeFitter& fitter, const std::vector<Vec3>& control, const CellAims& cells, double weight)
        : fitter_(fitter),
          pulls_(fitter.pulls(control)),
          side_(std::ranges::max(cells.sides)),
          weight_(weight),
          cell_weights_(cells.weights),
          start_(control) {
        const std::vector<double>& sides = cells.sides;
        for (std::size_t c = 0; c < fitter_.children_.cells.size(); ++c) {
            scales_.push_back(parts() * side_ / sides[c / children_of_cell()]);
        }
        const std::vector<Vec3> children = fine(control);
        for (std::size_t c = 0; c < scales_.size(); ++c) {
            for (std::size_t k = 0; k < 8; ++k) {
                const Mat3 edges = edges_at(fitter_.children_.cells[c], k, children.data());
                least_ = std::min(least_, glm::determinant(edges) * std::pow(scales_[c] / side_, 3));
            }
        }
        weigh_by_size(sides);
        constexpr double kPart = 0.04, kTiny = 1e-6;
        const double below = std::min(least_, 0.0);
        epsilon_ = std::sqrt(kTiny + kPart * below * below);
    }

    [[nodiscard]] int NumParameters() const override { return static_cast<int>(3 * start_.size()); }

    bool Evaluate(const double* parameters, double* cost, double* gradient) const override {
        const std::size_t count = start_.size();
        std::vector<Vec3> ways(count), points(count);
        for (std::size_t p = 0; p < count; ++p) {
            ways[p] = {parameters[3 * p], parameters[3 * p + 1], parameters[3 * p + 2]};
            points[p] = start_[p] / side_ + ways[p];
        }
        const std::vector<Vec3> children = fine(points);
        const double part = 1 / (8 * std::pow(parts(), 3));  // of a corner of the children of a cell: a power of 2
        // The last place is the sum of the distortions.
        std::vector<double> slopes =
            parallel_sums(3 * children.size() + 1, fitter_.children_.cells.size(), [&](std::size_t c, std::vector<double>& to) {
                const auto& cell = fitter_.children_.cells[c];
                CornerCoordinates by_corners;
                const CornerCoordinates corners = corners_of(cell, children, scales_[c]);
                const double of_child = part * cell_weights_[c / children_of_cell()];
                to.back() += of_child * distortion_of(corners, epsilon_, by_corners);
                add_slopes(cell, scales_[c] * of_child, by_corners, to);
            });
        double shapes = slopes.back();
        slopes.pop_back();
        std::vector<double> sums = std::move(slopes);
        for (const StencilTable& table : fitter_.children_.levels) sums = apply_transpose(table, sums, 3);
        const std::vector<double> of_cells =
            parallel_sums(3 * count + 1, fitter_.cells_.size(), [&](std::size_t c, std::vector<double>& to) {
                const auto& cell = fitter_.cells_[c];
                CornerCoordinates by_corners;
                const double of_cell = kFlat * cell_weights_[c];
                to.back() += of_cell * flatness_of(corners_of(cell, points, 1), kLeast, by_corners);
                add_slopes(cell, of_cell, by_corners, to);
            });
        shapes += of_cells.back();
        for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += of_cells[k];
        const std::vector<Vec3> boundary_ways = fitter_.matrix_.apply(ways);
        const auto rest = [&](const Pull& pull, const Vec3& way) {
            return glm::dot(pull.direction, way) + pull.distance / side_;
        };
        constexpr double kSliding = 0.001;
        double distances = 0;
        for (const Pull& pull : pulls_) {
            const Vec3 way = pull.sum_of(boundary_ways);
            const double far = rest(pull, way);
            distances += pull.weight * (far * far + kSliding * glm::dot(way, way));
        }
        *cost = shapes + weight_ * distances;
        if (gradient != nullptr) {
            const std::vector<Vec3> forces = fitter_.gathered(pulls_, [&](const Pull& pull) {
                const Vec3 way = pull.sum_of(boundary_ways);
                return 2 * weight_ * pull.weight * (rest(pull, way) * pull.direction + kSliding * way);
            });
            for (std::size_t p = 0; p < count; ++p) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    gradient[3 * p + axis] = sums[3 * p + axis] + forces[p][static_cast<int>(axis)];
                }
            }
        }
        return std::isfinite(*cost);
    }

private:
    // Corners of control cells with a scaled Jacobian below the least one cost something. Their weight stays, so that in the
    // last rounds the distances count more.
    static constexpr double kLeast = 0.4, kFlat = 30;

    static CornerCoordinates corners_of(const std::array<Index, 8>& cell, const std::vector<Vec3>& points, double scale) {
        CornerCoordinates corners;
        for (std::size_t k = 0; k < 8; ++k) {
            const Vec3 x = scale * points[cell[k]];
            for (std::size_t axis = 0; axis < 3; ++axis) corners[axis][k] = x[static_cast<int>(axis)];
        }
        return corners;
    }

    static void add_slopes(const std::array<Index, 8>& cell, double scale, const CornerCoordinates& slopes,
                           std::vector<double>& to) {
        for (std::size_t k = 0; k < 8; ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) to[3 * cell[k] + axis] += scale * slopes[axis][k];
        }
    }

    /// How many children a cell has along an edge, and in all.
    [[nodiscard]] double parts() const { return fitter_.children_.levels.empty() ? 1 : 2; }
    [[nodiscard]] std::size_t children_of_cell() const { return fitter_.children_.levels.empty() ? 1 : 8; }

    /// Distances count by the sides of the cells where they are.
    void weigh_by_size(const std::vector<double>& sides) {
        std::vector<Vec3> sums(start_.size(), Vec3(0.0));  // of sides, and their number
        for (std::size_t c = 0; c < sides.size(); ++c) {
            for (const Index p : fitter_.cells_[c]) sums[p] += Vec3(sides[c], 1, 0);
        }
        for (Vec3& sum : sums) sum = Vec3(sum.x / std::max(sum.y, 1.0));
        const std::vector<Vec3> at = fitter_.matrix_.apply(sums);
        const double least = std::ranges::min(sides);
        for (Pull& pull : pulls_) {
            const double here = std::clamp(pull.sum_of(at).x, least, side_);
            pull.weight *= side_ * side_ / (here * here);
        }
    }

    [[nodiscard]] std::vector<Vec3> fine(const std::vector<Vec3>& points) const {
        std::vector<Vec3> children(fitter_.children_.points());
        fitter_.children_.apply(std::span<const double>(&points.front().x, 3 * points.size()), 3,
                                std::span<double>(&children.front().x, 3 * children.size()));
        return children;
    }

    const ShapeFitter& fitter_;
    std::vector<Pull> pulls_;
    double side_, weight_;  // the greatest side; ways are in it
    const std::vector<double>& cell_weights_;
    std::vector<double> scales_;  // from sides to those of each child
    std::vector<Vec3> start_;
    double least_ = 1, epsilon_ = 0;
};

namespace {

/// Ends the steps of Ceres when the work is cancelled.
class UntilCancelled : public ceres::IterationCallback {
public:
    explicit UntilCancelled(const Progress* progress) : progress_(progress) {}

    ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
        return is_cancelled(progress_) ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
    }

private:
    const Progress* progress_;
};

}  // namespace

std::vector<Vec3> ShapeFitter::relaxed(const std::vector<Vec3>& control, const CellAims& cells, double weight) const {
    std::vector<Vec3> ways(control.size(), Vec3(0.0));
    const ceres::GradientProblem problem(new ShapeEnergy(*this, control, cells, weight));
    ceres::GradientProblemSolver::Options options;
    constexpr int kSteps = 30;
    options.max_num_iterations = kSteps;
    options.logging_type = ceres::SILENT;
    options.function_tolerance = 1e-5;
    UntilCancelled until_cancelled(progress_);
    options.callbacks = {&until_cancelled};
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(options, problem, &ways.front().x, &summary);
    std::vector<Vec3> points = control;
    const double side = std::ranges::max(cells.sides);
    for (std::size_t p = 0; p < points.size(); ++p) points[p] += side * ways[p];
    return points;
}

}  // namespace subvol::detail
