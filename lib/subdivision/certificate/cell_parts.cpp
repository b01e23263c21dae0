// SPDX-License-Identifier: Apache-2.0
// Cells and their descendants, as parts for which a test can ask for derivatives and children.
//
// A part of a grid is a window of points. Its axes are turned round and exchanged until its type is the one that bounds are
// known for; the frame notes how, and where that makes the cell left-handed, x changes its sign. For each axis c, differences d
// along c give the polynomial B d, the derivatives at the corners, and the rest d − V W d, which the type's bound κ multiplies.
// Children are products of the type's rules, which are kept as sparse rows, with the points.
//
// A part whose derivatives are polynomials has their Bernstein coefficients, for each axis: of the trilinear cell the
// differences of its corners, of the tricubic spline three times the differences of its Bézier points. Children halve them
// along each axis and take half of the values, as derivatives are by the child's own parameters. Such a part has no rest.
#include "cell_parts.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <numeric>

#include "subvol/detail/sparse_rows.h"
#include "subvol/stencil_table.h"

namespace subvol::detail {

namespace {

// The rules of a type.
const std::array<CsrMatrix, 8>& rules_of(const BoxType& type) {
    static std::mutex mutex;
    static std::map<BoxType, std::array<CsrMatrix, 8>> all;
    const std::scoped_lock lock(mutex);
    const auto found = all.find(type);
    if (found != all.end()) return found->second;
    const BoxRules rules = box_rules(type);
    std::array<CsrMatrix, 8> sparse;
    for (std::size_t s = 0; s < 8; ++s) {
        for (Eigen::Index row = 0; row < rules.children[s].rows(); ++row) {
            for (Eigen::Index column = 0; column < rules.children[s].cols(); ++column) {
                if (rules.children[s](row, column) == 0) continue;
                sparse[s].columns.push_back(static_cast<Index>(column));
                sparse[s].weights.push_back(rules.children[s](row, column));
            }
            sparse[s].offsets.push_back(sparse[s].columns.size());
        }
    }
    return all.emplace(type, std::move(sparse)).first->second;
}

// A part is too small to share its rows.
std::vector<Vec3> product_of(const CsrMatrix& matrix, const std::vector<Vec3>& values) {
    std::vector<Vec3> sums(row_count(matrix));
    for (std::size_t row = 0; row < sums.size(); ++row) sums[row] = row_times(matrix, row, values);
    return sums;
}

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

// Calls visit(c, type, differences, back) for each axis c of the part, with the type in which that axis comes first, its
// differences, and how axes of the form are those of the part: axis k of the part is back[k] of the form.
template <class Visit>
void GridPart::each_axis(const Visit& visit) const {
    const std::array<std::size_t, 3> size{type_[0].points(), type_[1].points(), type_[2].points()};
    for (std::size_t c = 0; c < 3; ++c) {
        // Axis k of the form is axes[k] of the part: 0 1 2, 1 0 2 or 2 0 1; back it is 0 1 2, 1 0 2 or 1 2 0.
        const std::array<std::size_t, 3> axes = c == 0   ? std::array<std::size_t, 3>{0, 1, 2}
                                                : c == 1 ? std::array<std::size_t, 3>{1, 0, 2}
                                                         : std::array<std::size_t, 3>{2, 0, 1};
        const std::array<std::size_t, 3> back = c == 2 ? std::array<std::size_t, 3>{1, 2, 0} : axes;
        const std::vector<Vec3> points = reordered(points_, size, axes);
        const std::size_t across = size[axes[1]] * size[axes[2]];
        std::vector<Vec3> differences(points.size() - across);
        for (std::size_t d = 0; d < differences.size(); ++d) differences[d] = points[d + across] - points[d];
        visit(c, BoxType{type_[axes[0]], type_[axes[1]], type_[axes[2]]}, differences, back);
    }
}

namespace {

// Puts the derivatives along axis c at the corners.
void put_corners(PartCorners& part, std::size_t c, const std::vector<Vec3>& values, const std::vector<Vec3>& differences,
                 const std::array<std::size_t, 3>& back) {
    for (const Vec3& d : differences) part.size = glm::max(part.size, glm::abs(d));
    const auto corners = reordered(values, {2, 2, 2}, back);
    for (std::size_t k = 0; k < 8; ++k) part.corners[k][static_cast<int>(c)] = corners[k];
}

}  // namespace

PartDerivatives GridPart::derivatives() const {
    PartDerivatives part;
    each_axis([&](std::size_t c, const BoxType& type, const std::vector<Vec3>& differences, const auto& back) {
        const DerivativeForm& form = derivative_form(type);
        const std::vector<Vec3> all = form.all_rows.times(differences);
        const auto bernstein = all.begin() + form.bernstein.rows(), weights = bernstein + form.weights.rows();
        part.columns[c] = {{2, 2, 2}, reordered(std::vector<Vec3>(all.begin(), bernstein), {3, 3, 3}, back)};
        put_corners(part.at, c, {weights, all.end()}, differences, back);
        std::vector<Vec3> rest = form.kept_rows.times(std::vector<Vec3>(bernstein, weights));
        for (std::size_t d = 0; d < rest.size(); ++d) rest[d] = differences[d] - rest[d];
        part.rest[c] = {*derivative_bound(type), std::move(rest)};
    });
    return part;
}

PartCorners GridPart::corners() const {
    PartCorners part;
    each_axis([&](std::size_t c, const BoxType& type, const std::vector<Vec3>& differences, const auto& back) {
        put_corners(part, c, derivative_form(type).corner_rows.times(differences), differences, back);
    });
    return part;
}

std::vector<GridPart> GridPart::children() const {
    const auto& rules = rules_of(type_);
    std::vector<GridPart> parts;
    for (std::size_t s = 0; s < 8; ++s) {
        parts.emplace_back(child_type(type_, s), product_of(rules[s], points_), frame_.child(s));
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

PolynomialPart PolynomialPart::tricubic(std::span<const Vec3, 64> points, const PartFrame& frame) {
    // Bézier points of a uniform cubic spline along each axis.
    constexpr std::array<std::array<double, 4>, 4> kBezier{
        {{1.0 / 6, 4.0 / 6, 1.0 / 6, 0}, {0, 4.0 / 6, 2.0 / 6, 0}, {0, 2.0 / 6, 4.0 / 6, 0}, {0, 1.0 / 6, 4.0 / 6, 1.0 / 6}}};
    constexpr std::array<std::array<std::size_t, 2>, 4> kUsed{{{0, 3}, {1, 3}, {1, 3}, {1, 4}}};  // the weights other than 0
    std::array<Vec3, 64> bezier;
    for (std::size_t p = 0; p < 64; ++p) bezier[p] = points[p / 16 + p / 4 % 4 * 4 + p % 4 * 16];
    for (const std::size_t stride : {std::size_t{16}, std::size_t{4}, std::size_t{1}}) {
        for (std::size_t first = 0; first < 64; ++first) {
            if (first / stride % 4 != 0) continue;
            std::array<Vec3, 4> line;
            for (std::size_t at = 0; at < 4; ++at) {
                Vec3 sum(0.0);
                for (std::size_t k = kUsed[at][0]; k < kUsed[at][1]; ++k) sum += bezier[first + k * stride] * kBezier[at][k];
                line[at] = sum;
            }
            for (std::size_t at = 0; at < 4; ++at) bezier[first + at * stride] = line[at];
        }
    }
    BernsteinColumns columns;
    const std::array<std::size_t, 3> strides{16, 4, 1};
    for (std::size_t c = 0; c < 3; ++c) {
        columns[c].degree = {3, 3, 3};
        columns[c].degree[c] = 2;
        columns[c].values.reserve(48);
        for (std::size_t p = 0; p < 64; ++p) {
            if (p / strides[c] % 4 != 3) columns[c].values.push_back((bezier[p + strides[c]] - bezier[p]) * 3.0);
        }
    }
    return {std::move(columns), frame};
}

PartDerivatives PolynomialPart::derivatives() const {
    return {columns_, {}, corners()};
}

PartCorners PolynomialPart::corners() const {
    PartCorners part;
    for (std::size_t c = 0; c < 3; ++c) {
        for (const Vec3& value : columns_[c].values) {
            part.size = glm::max(part.size, glm::abs(value));
        }
        for (std::size_t k = 0; k < 8; ++k) {
            part.corners[k][static_cast<int>(c)] = columns_[c].corner(k >> 2 & 1, k >> 1 & 1, k & 1);
        }
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
