// SPDX-License-Identifier: Apache-2.0
// Which level of dense grids is enough for a picture, before anything is drawn.
//
//    ●─────○─────●    The nodes of level 1 along an edge of a control cell, on the limit. Between two corners ● the cell of
//          ┊ step     level 0 is linear; the node ○ lies a step away from it. Where the limit is smooth, each further level
//      ────┴────      makes the step four times shorter, so level L lies (4/3) step / 4^L from the limit.
//
// Only the part of a node's step δx across the boundary is seen, in pixels. Inside, a step moves the point and its value
// together: what is wrong at a fixed place is δ = δv − ∇v·δx, and is seen as a change of colour, by the steepness of the
// transfer function there. Means are taken over the rectangles that cells, or their open sides, have in the picture.
//
// Where colours jump (bands, categories, colours beyond the range), the steepness times δ says nothing: the colour changes by
// no more than it does within ±δ. What is seen there is a line, like the outline of the body, that lies beside its place: in a
// cell whose values differ by R over a number of pixels, δ / R of them.
#include "dense_level.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "dense_grid.h"
#include "subvol/dense_cells.h"
#include "subvol/detail/all_cells.h"

namespace subvol::detail {

namespace {

constexpr double kMost_px = .25;
constexpr double kMostColor = 1 / 256.0;  // a step of a picture with 8 bits
constexpr std::size_t kNodes = 27;
constexpr std::array<std::size_t, 3> kStride{1, 3, 9};

template <class T>
using Nodes = std::array<T, kNodes>;

/// What the corners of a cell say about its node n, u fastest: the trilinear mean of those beside it.
template <class T>
T between_corners(const Nodes<T>& nodes, std::size_t n) {
    T sum{};
    for (std::size_t k = 0; k < 8; ++k) {
        double weight = 1;
        std::size_t corner = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double u = .5 * static_cast<double>(n / kStride[axis] % 3);
            const bool upper = (k >> axis & 1) != 0;
            weight *= upper ? u : 1 - u;
            corner += upper ? 2 * kStride[axis] : 0;
        }
        if (weight > 0) sum += weight * nodes[corner];
    }
    return sum;
}

/// The derivative along an axis at the centre of the trilinear cell, per side of it.
template <class T>
T along(const Nodes<T>& nodes, std::size_t axis) {
    T sum{};
    for (const std::size_t corner : {0u, 2u, 6u, 8u, 18u, 20u, 24u, 26u}) {
        sum += (corner / kStride[axis] % 3 == 0 ? -.25 : .25) * nodes[corner];
    }
    return sum;
}

/// ∇v of the trilinear cell at its centre; 0 if the cell is flat there.
Vec3 gradient(const Nodes<Vec3>& points, const Nodes<double>& values) {
    const Vec3 u = along(points, 0), v = along(points, 1), w = along(points, 2);
    const double volume = dot(u, cross(v, w));
    if (!(std::abs(volume) > 1e-9 * glm::length(u) * glm::length(v) * glm::length(w))) return Vec3(0.0);
    return (along(values, 0) * cross(v, w) + along(values, 1) * cross(w, u) + along(values, 2) * cross(u, v)) / volume;
}

/// How colours and opacities change with the value, as the largest change of one of the four.
class ColorChanges {
public:
    explicit ColorChanges(const Optics& optics) : knots_(optics.knots()), spans_(optics.spans()) {
        double sum = 0;
        for (std::size_t k = 0; k < spans_.size(); ++k) {
            const Optics::Span& span = spans_[k];
            const Vec3 color = span.transparent ? Vec3(0.0) : glm::abs(span.color_step);
            steps_.push_back(std::max({color.x, color.y, color.z, std::abs(span.alpha_step)}));
            sums_.push_back(sum += steps_.back());
        }
    }

    [[nodiscard]] bool visible(double min, double max) const {
        const auto [first, end] = spans_within(min, max);
        return std::any_of(spans_.begin() + first, spans_.begin() + end, [](const auto& span) { return !span.transparent; });
    }

    /// color: of values from min to max, if each may be wrong by `error`, where colours change slowly
    /// jumps: whether they change faster somewhere, so that one sees it
    struct Seen {
        double color = 0;
        bool jumps = false;
    };
    [[nodiscard]] Seen seen(double min, double max, double error) const {
        Seen seen;
        const auto [first, end] = spans_within(min, max);
        for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(first, 1); k < std::min(end, std::ssize(knots_)); ++k) {
            const auto at = static_cast<std::size_t>(k);
            const double change = steps_[at] * spans_[at].inverse_width * error;
            if (change <= seen.color) continue;
            const double most = sum_at(knots_[at] + error) - sum_at(knots_[at - 1] - error);
            if (change <= most)
                seen.color = change;
            else
                seen.jumps |= most > kMostColor;
        }
        return seen;
    }

private:
    /// The spans that values from min to max lie in: the first, and the one after the last.
    [[nodiscard]] std::pair<std::ptrdiff_t, std::ptrdiff_t> spans_within(double min, double max) const {
        return {std::lower_bound(knots_.begin(), knots_.end(), min) - knots_.begin(),
                std::upper_bound(knots_.begin(), knots_.end(), max) - knots_.begin() + 1};
    }

    /// The sum of all changes up to a value.
    [[nodiscard]] double sum_at(double value) const {
        const auto k = static_cast<std::size_t>(std::upper_bound(knots_.begin(), knots_.end(), value) - knots_.begin());
        return k == 0 ? 0 : sums_[k - 1] + steps_[k] * spans_[k].inverse_width * (value - knots_[k - 1]);
    }

    std::span<const double> knots_;
    std::span<const Optics::Span> spans_;
    std::vector<double> steps_, sums_;  // of each span, and up to its end
};

/// What level 0 of a cell shows beside its place: weights are pixels in the picture.
struct CellError {
    float value = 0, value_weight = 0;
    float min = 0, max = 0;              // of its values, less the first knot of the transfer function
    float side_px = 0, side_weight = 0;  // the largest of its open sides, and all of them
};

class CellJudge {
public:
    CellJudge(const View& view, const ColorChanges& changes, double first, const DenseCell& cell)
        : view_(view), changes_(changes), first_(first) {
        for (std::size_t n = 0; n < kNodes; ++n) {
            points_[n] = cell.points[n];
            values_[n] = cell.values[0][n];
        }
        for (std::size_t n = 0; n < kNodes; ++n) steps_[n] = points_[n] - between_corners(points_, n);
    }

    [[nodiscard]] CellError judge(const CellSides& sides, Index cell) const {
        const auto [min, max] = std::ranges::minmax(values_);
        Nodes<bool> all;
        all.fill(true);
        const double seen = changes_.visible(min, max) ? pixels(all) : 0;
        if (seen == 0) return {};
        const Vec3 slope = gradient(points_, values_);
        double value = 0;
        for (std::size_t n = 0; n < kNodes; ++n) {
            value = std::max(value, std::abs(values_[n] - between_corners(values_, n) - dot(slope, steps_[n])));
        }
        CellError error{static_cast<float>(4.0 / 3 * value), static_cast<float>(seen), static_cast<float>(min - first_),
                        static_cast<float>(max - first_)};
        for (std::size_t side = 0; side < 6; ++side) {
            if (sides.open(cell, side)) add_side(side, error);
        }
        return error;
    }

private:
    void add_side(std::size_t number, CellError& error) const {
        const CellSide side = cell_side(number);
        const auto axis = static_cast<std::size_t>(side.axis);
        const Vec3 area = cross(along(points_, (axis + 1) % 3), along(points_, (axis + 2) % 3));
        const double size = glm::length(area);
        Nodes<bool> on_side{};
        double step = 0;
        for (std::size_t n = 0; n < kNodes; ++n) {
            on_side[n] = n / kStride[axis] % 3 == 2 * static_cast<std::size_t>(side.end);
            if (!on_side[n] || size == 0) continue;
            const Vec3 eye = view_.to_eye(points_[n]);
            const double pixel = view_.pixel() * (view_.perspective() ? eye.z : 1);
            if (pixel > 0) step = std::max(step, std::abs(dot(area, steps_[n])) / size / pixel);
        }
        error.side_px = std::max(error.side_px, static_cast<float>(4.0 / 3 * step));
        error.side_weight += static_cast<float>(pixels(on_side));
    }

    /// The pixels of the picture in the rectangle of some nodes; 0 if they lie beside the picture or behind the eye.
    [[nodiscard]] double pixels(const Nodes<bool>& chosen) const {
        Vec2 low(view_.width(), view_.height()), high(0.0);
        for (std::size_t n = 0; n < kNodes; ++n) {
            if (!chosen[n]) continue;
            const Vec3 eye = view_.to_eye(points_[n]);
            if (view_.perspective() && !(eye.z > 1e-6 * glm::length(eye))) continue;
            const Vec2 pixel = view_.to_pixels(eye);
            low = glm::min(low, pixel);
            high = glm::max(high, pixel);
        }
        const Vec2 size = glm::min(high, Vec2(view_.width(), view_.height())) - glm::max(low, Vec2(0.0));
        return size.x > 0 && size.y > 0 ? size.x * size.y : 0;
    }

    const View& view_;
    const ColorChanges& changes_;
    double first_;
    Nodes<Vec3> points_{}, steps_{};
    Nodes<double> values_{};
};

/// √(Σ w e² / Σ w)
class Mean {
public:
    void add(double error, double weight) {
        sum_ += weight * error * error;
        weights_ += weight;
    }
    [[nodiscard]] double value() const { return weights_ > 0 ? std::sqrt(sum_ / weights_) : 0; }

private:
    double sum_ = 0, weights_ = 0;
};

/// What a level shows beside its place, where errors are 4^level times smaller than those of level 0.
///
/// first: what the cells' values are less
DenseLevel errors_of(int level, const std::vector<CellError>& errors, const ColorChanges& changes, double first,
                     double most_px) {
    Mean sides, colors, jumps;
    for (const CellError& cell : errors) {
        sides.add(std::min(std::ldexp(double{cell.side_px}, -2 * level), most_px), double{cell.side_weight});
        if (cell.value_weight == 0) continue;
        const double min = double{cell.min} + first, max = double{cell.max} + first;
        const double error = std::ldexp(double{cell.value}, -2 * level);
        const auto seen = changes.seen(min, max, error);
        colors.add(std::min(seen.color, 1.0), double{cell.value_weight});
        if (!seen.jumps) continue;
        const double across_px = std::sqrt(double{cell.value_weight});
        jumps.add(std::min(error / (max - min), 1.0) * across_px, across_px);
    }
    const double pixels = std::max(sides.value(), jumps.value());
    return {level, pixels, colors.value(), pixels <= kMost_px && colors.value() <= kMostColor};
}

}  // namespace

DenseLevel find_dense_level(const HexMesh& mesh, const CellSides& sides, const RefineOptions& refine, const View& view,
                            const Optics& optics, int most) {
    RefineOptions once = refine;
    once.levels = 1;
    once.progress = nullptr;
    std::vector<CellError> errors(mesh.cells.size());
    const ColorChanges changes(optics);
    const double first = optics.knots().front();
    const DenseCells cells(mesh, once, true, DenseBits::ToRounding);
    cells.for_each(all_cells(mesh), [&](const DenseCell& cell) {
        errors[cell.cell] = CellJudge(view, changes, first, cell).judge(sides, cell.cell);
    });
    DenseLevel found;
    for (int level = 0; level <= most && !found.within; ++level)
        found = errors_of(level, errors, changes, first, view.width() + view.height());
    return found;
}

}  // namespace subvol::detail
