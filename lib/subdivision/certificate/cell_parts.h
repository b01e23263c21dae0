// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "box_rules.h"
#include "fold_test.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// Where a part lies in its cell: a cube with its low corner and its size, in the cell's parameters; and the axes of the cell
/// along those of the part, which may be turned round.
struct PartFrame {
    Vec3 low{0.0};
    double size = 1;
    std::array<std::uint8_t, 3> axes{0, 1, 2};
    std::array<std::uint8_t, 3> turned{};

    /// The place of a corner of the part, 4u + 2v + w along its own axes.
    [[nodiscard]] Vec3 corner(std::size_t corner) const;
    /// The place of a corner of its children, 9i + 3j + k at (i, j, k) / 2 along its own axes.
    [[nodiscard]] Vec3 corner_of_child(std::size_t number) const;
    /// The frame of a child; bit 2 of `child` is its half along the first axis.
    [[nodiscard]] PartFrame child(std::size_t child) const;
};

/// A cell of a grid of MCQ, or one of its descendants, by the points of its window.
class GridPart {
public:
    /// type:    with a bound in any order and direction of its axes
    /// points:  of its window
    GridPart(const BoxType& type, std::vector<Vec3> points, const PartFrame& frame);

    [[nodiscard]] const PartFrame& frame() const { return frame_; }
    /// The Jacobians at the corners, and at the corners of all children (PartFrame).
    [[nodiscard]] PartJacobians corners() const;
    [[nodiscard]] PartJacobians corners_of_children() const;
    /// No differences of neighbouring points are larger in a component.
    [[nodiscard]] Vec3 size() const;
    /// The polynomials' Jacobian in the middle.
    [[nodiscard]] Mat3 center() const;
    /// In coordinates y = H x.
    [[nodiscard]] PartDerivatives derivatives(const Mat3& h) const;
    [[nodiscard]] std::vector<GridPart> children() const;

private:
    void put_in_order();

    BoxType type_;
    std::vector<Vec3> points_;
    PartFrame frame_;
};

/// Whether the derivatives of a type have bounds, in some order and direction of its axes.
[[nodiscard]] bool has_bounds(BoxType type);

/// Tricubic Bézier points, coordinate by coordinate, in the order (4 i + j) 4 + k.
using BezierPoints = std::array<std::array<double, 64>, 3>;

/// Makes them of the points of a uniform cubic spline in the same order.
void make_bezier(BezierPoints& points);
/// The same of points (i, j, k) at i + 4j + 16k.
[[nodiscard]] BezierPoints bezier_of_spline_points(std::span<const Vec3, 64> points);

/// The derivatives of a tricubic piece, and of the trilinear cell with these corners, in VTK's order.
[[nodiscard]] PartSlopes<48> slopes_of(const BezierPoints& points);
[[nodiscard]] PartSlopes<4> slopes_of(std::span<const Vec3, 8> corners);

/// A cell whose derivatives are polynomials, or one of its descendants.
class PolynomialPart {
public:
    PolynomialPart(BernsteinColumns columns, const PartFrame& frame) : columns_(std::move(columns)), frame_(frame) {}

    /// The trilinear cell with these corners, in VTK's order.
    [[nodiscard]] static PolynomialPart trilinear(std::span<const Vec3, 8> corners, const PartFrame& frame);
    /// A tricubic piece.
    [[nodiscard]] static PolynomialPart tricubic(const BezierPoints& points, const PartFrame& frame);

    [[nodiscard]] const PartFrame& frame() const { return frame_; }
    [[nodiscard]] PartJacobians corners() const;
    [[nodiscard]] PartJacobians corners_of_children() const;
    [[nodiscard]] Vec3 size() const;
    [[nodiscard]] Mat3 center() const;
    [[nodiscard]] PartDerivatives derivatives(const Mat3& h) const;
    [[nodiscard]] std::vector<PolynomialPart> children() const;

private:
    BernsteinColumns columns_;
    PartFrame frame_;
};

}  // namespace subvol::detail
