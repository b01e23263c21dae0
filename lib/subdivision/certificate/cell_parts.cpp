// SPDX-License-Identifier: Apache-2.0
// Cells and their descendants, as parts for which a test can ask for derivatives and children.
//
// A part of a grid is a window of points. Its axes are turned round and exchanged until its type is the one that bounds are
// known for; the frame notes how, and where that makes the cell left-handed, x changes its sign. For each axis c, differences d
// along c give the polynomial B d, the derivatives at the corners and at those of the children, and the rest d − V W d, which
// the type's bound κ multiplies. What the parts of a type share is kept (PartForm), in the order of the part's axes.
//
// The windows of the eight children have most points in common: 343 in all, not 8 · 216. They are made once, and copied.
//
// A part whose derivatives are polynomials has their Bernstein coefficients, for each axis: of the trilinear cell the
// differences of its corners, of the tricubic spline three times the differences of its Bézier points. Children halve them
// along each axis and take half of the values, as derivatives are by the child's own parameters. Such a part has no rest.
#include "cell_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "dense_rows.h"
#include "derivative_form.h"
#include "kept.h"
#include "subvol/detail/sparse_rows.h"
#include "subvol/stencil_table.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostPoints = 216, kMostFine = 343;  // of a window, and of the windows of all children
constexpr std::size_t kMostRows = 40;                      // of B and W

bool is_in_order(const BoxType& type) {
    return type[0] >= type[1] && type[1] >= type[2] &&
           std::ranges::all_of(type, [](const AxisType& a) { return a.low <= a.high; });
}

// The entries of a polynomial whose axes are given in another order: axis k of the result is axes[k] of `values`.
template <class Value>
std::vector<Value> reordered(const std::vector<Value>& values, const std::array<std::size_t, 3>& size,
                             const std::array<std::size_t, 3>& axes) {
    std::vector<Value> result;
    result.reserve(values.size());
    std::array<std::size_t, 3> stride{};
    const std::array<std::size_t, 3> strides{size[1] * size[2], size[2], 1};
    for (std::size_t k = 0; k < 3; ++k) stride[k] = strides[axes[k]];
    for (std::size_t i = 0; i < size[axes[0]]; ++i) {
        for (std::size_t j = 0; j < size[axes[1]]; ++j) {
            for (std::size_t k = 0; k < size[axes[2]]; ++k) {
                result.push_back(values[i * stride[0] + j * stride[1] + k * stride[2]]);
            }
        }
    }
    return result;
}

}  // namespace

Vec3 PartFrame::corner(std::size_t corner) const {
    Vec3 place = low;
    for (std::size_t a = 0; a < 3; ++a) {
        const bool upper = ((corner >> (2 - a) & 1) != 0) != (turned[a] != 0);
        if (upper) place[axes[a]] += size;
    }
    return place;
}

Vec3 PartFrame::corner_of_child(std::size_t number) const {
    Vec3 place = low;
    const std::array<std::size_t, 3> steps{number / 9, number / 3 % 3, number % 3};
    for (std::size_t a = 0; a < 3; ++a) {
        place[axes[a]] += size / 2 * static_cast<double>(turned[a] != 0 ? 2 - steps[a] : steps[a]);
    }
    return place;
}

PartFrame PartFrame::child(std::size_t child) const {
    PartFrame frame = *this;
    frame.size = size / 2;
    frame.low = frame.corner(child);
    return frame;
}

bool has_bounds(BoxType type) {
    for (AxisType& axis : type) {
        if (axis.low > axis.high) std::swap(axis.low, axis.high);
    }
    std::ranges::sort(type, std::greater());
    return derivative_bound(type).has_value();
}

GridPart::GridPart(const BoxType& type, std::vector<Vec3> points, const PartFrame& frame)
    : type_(type), points_(std::move(points)), frame_(frame) {
    if (!is_in_order(type_)) put_in_order();
}

// Turns axes round and exchanges them, so that the type is the one that the bounds are of. Where that makes the cell
// left-handed its mirror image is taken.
void GridPart::put_in_order() {
    bool mirrored = false;
    std::array<std::size_t, 3> size{type_[0].points(), type_[1].points(), type_[2].points()};
    for (std::size_t a = 0; a < 3; ++a) {
        if (type_[a].low <= type_[a].high) continue;
        std::swap(type_[a].low, type_[a].high);
        frame_.turned[a] ^= 1;
        mirrored = !mirrored;
        std::vector<Vec3> turned(points_.size());
        const std::size_t stride = a == 0 ? size[1] * size[2] : a == 1 ? size[2] : 1;
        for (std::size_t p = 0; p < points_.size(); ++p) {
            const std::size_t at = p / stride % size[a];
            turned[p + (size[a] - 1 - at) * stride - at * stride] = points_[p];
        }
        points_ = std::move(turned);
    }
    std::array<std::size_t, 3> axes{0, 1, 2};
    std::ranges::stable_sort(axes, std::greater(), [&](std::size_t a) { return type_[a]; });
    if (axes != std::array<std::size_t, 3>{0, 1, 2}) {
        points_ = reordered(points_, size, axes);
        const BoxType type = type_;
        const PartFrame frame = frame_;
        int inversions = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            type_[a] = type[axes[a]];
            frame_.axes[a] = frame.axes[axes[a]];
            frame_.turned[a] = frame.turned[axes[a]];
            for (std::size_t b = 0; b < a; ++b) inversions += axes[b] > axes[a] ? 1 : 0;
        }
        if (inversions % 2 != 0) mirrored = !mirrored;
    }
    if (mirrored) {
        for (Vec3& x : points_) x.x = -x.x;
    }
}

namespace {

/// Derivatives along an axis of a type of parts: rows over the differences of the window's points along it, whose numbers are
/// those of their lower points.
struct AxisForm {
    std::size_t stride = 0;      // from the lower to the upper point
    CsrMatrix corners;           // at the corners
    CsrMatrix places;            // at the corners of the children
    std::vector<Index> lower;    // of each difference; the rows below are over these
    DenseRows polynomial;        // B, and W below it
    DenseRows kept;              // V
    std::vector<double> center;  // the polynomial in the middle
    double kappa = 0;
};

/// What all parts of a type share, whose axes are in order.
struct PartForm {
    CsrMatrix fine;                             // the points of all children's windows, which have many in common
    std::array<std::vector<Index>, 8> windows;  // of the children, among these points
    std::array<AxisForm, 3> axes;
};

void add_row(CsrMatrix& to, const Eigen::MatrixXd& rows, Eigen::Index row, std::span<const Index> columns, double least) {
    for (Eigen::Index c = 0; c < rows.cols(); ++c) {
        if (std::abs(rows(row, c)) <= least) continue;
        to.columns.push_back(columns[static_cast<std::size_t>(c)]);
        to.weights.push_back(rows(row, c));
    }
    to.offsets.push_back(to.columns.size());
}

AxisForm axis_form(const BoxType& type, std::size_t c) {
    // Axis k of the form is axes[k] of the part: 0 1 2, 1 0 2 or 2 0 1.
    constexpr std::array<std::array<std::size_t, 3>, 3> kAxes{{{0, 1, 2}, {1, 0, 2}, {2, 0, 1}}};
    const std::array<std::size_t, 3>& axes = kAxes[c];
    const BoxType turned{type[axes[0]], type[axes[1]], type[axes[2]]};
    const DerivativeForm& form = derivative_form(turned);
    AxisForm made;
    made.kappa = derivative_bound(turned).value_or(HUGE_VAL);
    const std::array<std::size_t, 3> strides{type[1].points() * type[2].points(), type[2].points(), 1};
    made.stride = strides[c];
    // The numbers of a box's entries when its axes are those of the part, in the order of the form.
    const auto in_part = [&](const std::array<std::size_t, 3>& size, const std::array<std::size_t, 3>& stride) {
        std::vector<Index> numbers;
        for (std::size_t i = 0; i < size[axes[0]]; ++i) {
            for (std::size_t j = 0; j < size[axes[1]]; ++j) {
                for (std::size_t k = 0; k < size[axes[2]]; ++k) {
                    numbers.push_back(static_cast<Index>(i * stride[axes[0]] + j * stride[axes[1]] + k * stride[axes[2]]));
                }
            }
        }
        return numbers;
    };
    std::array<std::size_t, 3> size{type[0].points(), type[1].points(), type[2].points()};
    --size[c];
    made.lower = in_part(size, strides);
    // Rows of places and coefficients go back to the order of the part.
    const auto rows_in_part = [&](const Eigen::MatrixXd& rows, std::size_t side) {
        Eigen::MatrixXd result(rows.rows(), rows.cols());
        const std::vector<Index> numbers = in_part({side, side, side}, {side * side, side, 1});
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            result.row(static_cast<Eigen::Index>(numbers[k])) = rows.row(static_cast<Eigen::Index>(k));
        }
        return result;
    };
    constexpr double kZero = 1e-14;  // what should be 0; rounding is allowed more (fold_test.cpp)
    const Eigen::MatrixXd corners = rows_in_part(form.corners, 2), places = rows_in_part(form.places, 3);
    for (Eigen::Index k = 0; k < corners.rows(); ++k) add_row(made.corners, corners, k, made.lower, kZero);
    for (Eigen::Index k = 0; k < places.rows(); ++k) add_row(made.places, places, k, made.lower, kZero);
    Eigen::MatrixXd polynomial(form.bernstein.rows() + form.weights.rows(), form.bernstein.cols());
    polynomial << rows_in_part(form.bernstein, 3), form.weights;
    made.polynomial = DenseRows(polynomial);
    made.kept = DenseRows(form.kept);
    made.center.assign(static_cast<std::size_t>(form.bernstein.cols()), 0);
    constexpr std::array<double, 3> kMiddle{0.25, 0.5, 0.25};
    for (std::size_t k = 0; k < 27; ++k) {
        const double weight = kMiddle[k / 9] * kMiddle[k / 3 % 3] * kMiddle[k % 3];
        for (std::size_t d = 0; d < made.center.size(); ++d) {
            made.center[d] += weight * form.bernstein(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(d));
        }
    }
    return made;
}

PartForm make_part_form(const BoxType& type) {
    PartForm form;
    const BoxRules rules = box_rules(type);
    std::vector<Index> columns(window_points(type));
    std::iota(columns.begin(), columns.end(), Index{0});
    std::map<std::vector<double>, Index> numbers;  // of points by their weights
    for (std::size_t s = 0; s < 8; ++s) {
        const Eigen::MatrixXd& rows = rules.children[s];
        for (Eigen::Index row = 0; row < rows.rows(); ++row) {
            std::vector<double> weights(columns.size());
            for (std::size_t k = 0; k < weights.size(); ++k) weights[k] = rows(row, static_cast<Eigen::Index>(k));
            const auto [at, is_new] = numbers.try_emplace(std::move(weights), static_cast<Index>(numbers.size()));
            form.windows[s].push_back(at->second);
            if (is_new) add_row(form.fine, rows, row, columns, 0);
        }
    }
    for (std::size_t c = 0; c < 3; ++c) form.axes[c] = axis_form(type, c);
    return form;
}

const PartForm& part_form(const BoxType& type) {
    static Kept<BoxType, PartForm> kept;
    return kept.get(type, [&] { return make_part_form(type); });
}

/// J at places, by the rows of each axis.
std::vector<Mat3> jacobians(const PartForm& form, CsrMatrix AxisForm::*rows, const std::vector<Vec3>& points) {
    std::vector<Mat3> at(row_count(form.axes[0].*rows));
    for (int c = 0; c < 3; ++c) {
        const AxisForm& axis = form.axes[static_cast<std::size_t>(c)];
        const CsrMatrix& matrix = axis.*rows;
        for (std::size_t row = 0; row < at.size(); ++row) {
            Vec3 sum(0.0);
            for (std::size_t k = matrix.offsets[row]; k < matrix.offsets[row + 1]; ++k) {
                const std::size_t p = matrix.columns[k];
                sum += matrix.weights[k] * (points[p + axis.stride] - points[p]);
            }
            at[row][c] = sum;
        }
    }
    return at;
}

// The Bézier points of uniform cubic splines along an axis, in place of their points.
template <std::size_t kStride>
void make_bezier_along_axis(std::array<double, 64>& values) {
    for (std::size_t block = 0; block < 64; block += 4 * kStride) {
        for (std::size_t n = block; n < block + kStride; ++n) {
            const double a = values[n], b = values[n + kStride], c = values[n + 2 * kStride], d = values[n + 3 * kStride];
            values[n] = (a + 4 * b + c) * (1.0 / 6);
            values[n + kStride] = (2 * b + c) * (1.0 / 3);
            values[n + 2 * kStride] = (b + 2 * c) * (1.0 / 3);
            values[n + 3 * kStride] = (b + 4 * c + d) * (1.0 / 6);
        }
    }
}

}  // namespace

Vec3 GridPart::size() const {
    Box box;
    for (const Vec3& x : points_) box.add(x);
    return box.size();
}

PartJacobians GridPart::corners() const {
    return {jacobians(part_form(type_), &AxisForm::corners, points_), size()};
}

PartJacobians GridPart::corners_of_children() const {
    return {jacobians(part_form(type_), &AxisForm::places, points_), size()};
}

Mat3 GridPart::center() const {
    Mat3 middle(0.0);
    for (int c = 0; c < 3; ++c) {
        const AxisForm& axis = part_form(type_).axes[static_cast<std::size_t>(c)];
        for (std::size_t d = 0; d < axis.lower.size(); ++d) {
            middle[c] += axis.center[d] * (points_[axis.lower[d] + axis.stride] - points_[axis.lower[d]]);
        }
    }
    return middle;
}

// Coordinates are taken about a point of the window, so that those of small parts do not cancel.
PartDerivatives GridPart::derivatives(const Mat3& h) const {
    PartDerivatives part;
    std::array<Vec3, kMostPoints> y;
    for (std::size_t p = 0; p < points_.size(); ++p) y[p] = h * (points_[p] - points_[0]);
    for (std::size_t c = 0; c < 3; ++c) {
        const AxisForm& axis = part_form(type_).axes[c];
        const std::size_t count = axis.lower.size();
        std::array<Vec3, kMostPoints> differences, near;
        for (std::size_t d = 0; d < count; ++d) differences[d] = y[axis.lower[d] + axis.stride] - y[axis.lower[d]];
        std::array<Vec3, kMostRows> products;
        axis.polynomial.multiply({differences.data(), count}, products);
        constexpr std::size_t kCoefficients = 27;
        part.columns[c] = {{2, 2, 2}, {products.begin(), products.begin() + kCoefficients}};
        axis.kept.multiply({products.data() + kCoefficients, axis.polynomial.rows() - kCoefficients}, near);
        part.rest[static_cast<int>(c)] = axis.kappa * largest_difference({differences.data(), count}, {near.data(), count});
    }
    return part;
}

std::vector<GridPart> GridPart::children() const {
    const PartForm& form = part_form(type_);
    std::array<Vec3, kMostFine> fine;
    for (std::size_t p = 0; p < row_count(form.fine); ++p) fine[p] = row_times(form.fine, p, points_);
    std::vector<GridPart> parts;
    parts.reserve(8);
    for (std::size_t s = 0; s < 8; ++s) {
        std::vector<Vec3> window;
        window.reserve(form.windows[s].size());
        for (const Index p : form.windows[s]) window.push_back(fine[p]);
        parts.emplace_back(child_type(type_, s), std::move(window), frame_.child(s));
    }
    return parts;
}

PolynomialPart PolynomialPart::trilinear(std::span<const Vec3, 8> corners, const PartFrame& frame) {
    BernsteinColumns columns;
    const auto at = [&](std::size_t u, std::size_t v, std::size_t w) {  // 0, 1, 3, 2 go round the bottom
        return corners[4 * w + (v == 0 ? u : 3 - u)];
    };
    for (std::size_t c = 0; c < 3; ++c) {
        columns[c].degree = {1, 1, 1};
        columns[c].degree[c] = 0;
        for (std::size_t k = 0; k < 8; ++k) {
            const std::array<std::size_t, 3> low{k >> 2 & 1, k >> 1 & 1, k & 1};
            if (low[c] != 0) continue;
            std::array<std::size_t, 3> high = low;
            high[c] = 1;
            columns[c].values.push_back(at(high[0], high[1], high[2]) - at(low[0], low[1], low[2]));
        }
    }
    return {std::move(columns), frame};
}

void make_bezier(BezierPoints& points) {
    for (std::array<double, 64>& values : points) {
        make_bezier_along_axis<16>(values);
        make_bezier_along_axis<4>(values);
        make_bezier_along_axis<1>(values);
    }
}

namespace {

// Places of one coordinate, of which 4 lie along the axis.
template <std::size_t kStride>
std::array<double, 48> slopes_along_axis(const std::array<double, 64>& values) {
    std::array<double, 48> slopes;
    for (std::size_t block = 0, to = 0; block < 64; block += 4 * kStride) {
        for (std::size_t n = block; n < block + 3 * kStride; ++n, ++to) slopes[to] = 3 * (values[n + kStride] - values[n]);
    }
    return slopes;
}

}  // namespace

PartSlopes<48> slopes_of(const BezierPoints& points) {
    PartSlopes<48> slopes;
    for (std::size_t c = 0; c < 3; ++c) {
        slopes[0][c] = slopes_along_axis<16>(points[c]);
        slopes[1][c] = slopes_along_axis<4>(points[c]);
        slopes[2][c] = slopes_along_axis<1>(points[c]);
    }
    return slopes;
}

PartSlopes<4> slopes_of(std::span<const Vec3, 8> corners) {
    constexpr std::array<std::array<std::array<std::size_t, 2>, 4>, 3> kEdges{
        {{{{0, 1}, {3, 2}, {4, 5}, {7, 6}}}, {{{0, 3}, {1, 2}, {4, 7}, {5, 6}}}, {{{0, 4}, {1, 5}, {2, 6}, {3, 7}}}}};
    PartSlopes<4> slopes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 slope = corners[kEdges[axis][k][1]] - corners[kEdges[axis][k][0]];
            for (int c = 0; c < 3; ++c) slopes[axis][static_cast<std::size_t>(c)][k] = slope[c];
        }
    }
    return slopes;
}

BezierPoints bezier_of_spline_points(std::span<const Vec3, 64> points) {
    BezierPoints bezier;
    for (std::size_t p = 0; p < 64; ++p) {
        const Vec3& x = points[p / 16 + p / 4 % 4 * 4 + p % 4 * 16];
        for (std::size_t c = 0; c < 3; ++c) bezier[c][p] = x[static_cast<int>(c)];
    }
    make_bezier(bezier);
    return bezier;
}

PolynomialPart PolynomialPart::tricubic(const BezierPoints& points, const PartFrame& frame) {
    BernsteinColumns columns;
    const std::array<std::size_t, 3> strides{16, 4, 1};
    for (std::size_t c = 0; c < 3; ++c) {
        columns[c].degree = {3, 3, 3};
        columns[c].degree[c] = 2;
        columns[c].values.reserve(48);
        const auto at = [&](std::size_t p) { return Vec3(points[0][p], points[1][p], points[2][p]); };
        for (std::size_t p = 0; p < 64; ++p) {
            if (p / strides[c] % 4 != 3) columns[c].values.push_back((at(p + strides[c]) - at(p)) * 3.0);
        }
    }
    return {std::move(columns), frame};
}

Vec3 PolynomialPart::size() const {
    Vec3 largest(0.0);
    for (const auto& column : columns_) {
        for (const Vec3& value : column.values) largest = glm::max(largest, glm::abs(value));
    }
    return largest;
}

PartJacobians PolynomialPart::corners() const {
    PartJacobians part{std::vector<Mat3>(8), size()};
    for (std::size_t k = 0; k < 8; ++k) {
        for (std::size_t c = 0; c < 3; ++c) {
            part.at[k][static_cast<int>(c)] = columns_[c].corner(k >> 2 & 1, k >> 1 & 1, k & 1);
        }
    }
    return part;
}

PartJacobians PolynomialPart::corners_of_children() const {
    PartJacobians part{std::vector<Mat3>(27), size()};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto values = values_at_halves(columns_[c]);
        for (std::size_t k = 0; k < values.size(); ++k) part.at[k][static_cast<int>(c)] = values[k];
    }
    return part;
}

Mat3 PolynomialPart::center() const {
    Mat3 middle;
    for (std::size_t c = 0; c < 3; ++c) middle[static_cast<int>(c)] = value_at(columns_[c], Vec3(0.5));
    return middle;
}

PartDerivatives PolynomialPart::derivatives(const Mat3& h) const {
    PartDerivatives part{columns_};
    for (auto& column : part.columns) {
        for (Vec3& value : column.values) value = h * value;
    }
    return part;
}

std::vector<PolynomialPart> PolynomialPart::children() const {
    std::vector<PolynomialPart> parts;
    for (std::size_t s = 0; s < 8; ++s) {
        BernsteinColumns columns = columns_;
        for (auto& column : columns) {
            for (std::size_t axis = 0; axis < 3; ++axis) column = half(column, axis, (s >> (2 - axis) & 1) != 0);
            for (Vec3& value : column.values) value *= 0.5;  // by the child's parameters
        }
        parts.emplace_back(std::move(columns), frame_.child(s));
    }
    return parts;
}

}  // namespace subvol::detail
