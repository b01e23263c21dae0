// SPDX-License-Identifier: Apache-2.0
// Which level of dense grids is enough for a picture, before anything is drawn.
//
//    ●─────○─────●    The nodes of level 1 along an edge of a control cell, on the limit. Between two corners ● the cell of
//          ┊ step     level 0 is linear; the node ○ lies a step away from it. Where the limit is smooth, each further level
//      ────┴────      makes the step four times shorter, so level L lies (4/3) step / 4^L from the limit.
//
// Only the part of a node's step δx across the boundary is seen, in pixels. Inside, a step moves the point and its value
// together: what is wrong at a fixed place is δv − ∇v·δx, and is seen as a change of colour, by the steepness of the transfer
// function there. Means are taken over the rectangles that cells, or their open sides, have in the picture.
#include "dense_level.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
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

/// The largest change of colour or opacity by a change of the value, for values from min to max; nothing if all are invisible.
std::optional<double> steepness(const Optics& optics, double min, double max) {
    double steepest = 0;
    bool visible = false;
    const auto spans = optics.spans();
    const auto knots = optics.knots();
    for (std::size_t k = 0; k < spans.size(); ++k) {
        if ((k > 0 && knots[k - 1] > max) || (k < knots.size() && knots[k] < min)) continue;
        visible |= !spans[k].transparent;
        const Vec3 color = spans[k].transparent ? Vec3(0.0) : glm::abs(spans[k].color_step);
        steepest = std::max({steepest, color.x * spans[k].inverse_width, color.y * spans[k].inverse_width,
                             color.z * spans[k].inverse_width, std::abs(spans[k].alpha_step) * spans[k].inverse_width});
    }
    return visible ? std::optional(steepest) : std::nullopt;
}

/// What level 0 of a cell shows beside its place: weights are pixels in the picture.
struct CellError {
    float color = 0, color_weight = 0;
    float side_px = 0, side_weight = 0;  // the largest of its open sides, and all of them
};

class CellJudge {
public:
    CellJudge(const View& view, const Optics& optics, const DenseCell& cell) : view_(view), optics_(optics) {
        for (std::size_t n = 0; n < kNodes; ++n) {
            points_[n] = cell.points[n];
            values_[n] = cell.values[0][n];
        }
        for (std::size_t n = 0; n < kNodes; ++n) steps_[n] = points_[n] - between_corners(points_, n);
    }

    [[nodiscard]] CellError judge(const CellSides& sides, Index cell) const {
        const auto [min, max] = std::ranges::minmax(values_);
        const std::optional<double> steep = steepness(optics_, min, max);
        Nodes<bool> all;
        all.fill(true);
        const double seen = steep ? pixels(all) : 0;
        if (seen == 0) return {};
        const Vec3 slope = gradient(points_, values_);
        double value = 0;
        for (std::size_t n = 0; n < kNodes; ++n) {
            value = std::max(value, std::abs(values_[n] - between_corners(values_, n) - dot(slope, steps_[n])));
        }
        CellError error{static_cast<float>(4.0 / 3 * value * *steep), static_cast<float>(seen)};
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
    const Optics& optics_;
    Nodes<Vec3> points_{}, steps_{};
    Nodes<double> values_{};
};

/// √(Σ w e² / Σ w) of errors that are 4^level times smaller; none is counted as more than `most`.
double mean(const std::vector<CellError>& errors, float CellError::*error, float CellError::*weight, int level, double most) {
    double sum = 0, weights = 0;
    for (const CellError& cell : errors) {
        const double e = std::min(std::ldexp(double{cell.*error}, -2 * level), most);
        sum += double{cell.*weight} * e * e;
        weights += double{cell.*weight};
    }
    return weights > 0 ? std::sqrt(sum / weights) : 0;
}

}  // namespace

DenseLevel find_dense_level(const HexMesh& mesh, const CellSides& sides, const RefineOptions& refine, const View& view,
                            const Optics& optics, int most) {
    RefineOptions once = refine;
    once.levels = 1;
    once.progress = nullptr;
    std::vector<CellError> errors(mesh.cells.size());
    const DenseCells cells(mesh, once, true, DenseBits::ToRounding);
    cells.for_each(all_cells(mesh),
                   [&](const DenseCell& cell) { errors[cell.cell] = CellJudge(view, optics, cell).judge(sides, cell.cell); });
    DenseLevel found;
    for (int level = 0; level <= most && !found.within; ++level) {
        const double pixels = mean(errors, &CellError::side_px, &CellError::side_weight, level, view.width() + view.height());
        const double color = mean(errors, &CellError::color, &CellError::color_weight, level, 1);
        found = {level, pixels, color, pixels <= kMost_px && color <= kMostColor};
    }
    return found;
}

}  // namespace subvol::detail
