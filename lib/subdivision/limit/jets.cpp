// SPDX-License-Identifier: Apache-2.0
// The limit in one cell from the points around it. With weights a, b, c along the axes
//
//     f(u, v, w) = Σᵢⱼₖ aᵢ(u) bⱼ(v) cₖ(w) pᵢⱼₖ,   i, j, k = 0 … 3
//
// over the 4×4×4 points of the cell's regular grid; ∂f/∂u has a′ in place of a, and a factor 2ˡ for a cell of level l. For the
// spline schemes a is the uniform cubic B-spline, and f is the limit. MCQ interpolates: a is the cubic through four points,
//
//       p₀      p₁      p₂      p₃
//     ──●───────●━━━━━━━●───────●──      the cell lies between p₁ and p₂, which f passes through
//       −1      0   u   1       2
//
// and f approaches the limit as the cells become smaller, faster than a trilinear function does. A cell without a grid has its
// eight corners only, and f is trilinear.
//
// The limit of MCQ has no second derivatives: they grow with the level, and they differ on both sides of a point. So the slopes
// of the cubics in two cells that meet differ, and come together only like l·2⁻ˡ. What both cells agree on is the mean of their
// slopes, which converges like 4⁻ˡ because the two errors cancel:
//
//     ──●───────●───────●───────●───────●──      p₀′ = (p₋₂ − 8 p₋₁ + 8 p₁ − p₂)/12, the mean of the cubics' slopes
//      p₋₂     p₋₁      p₀      p₁      p₂
//
// a′ is therefore the derivative of the cubic with these slopes at its ends: one gradient on both sides of a vertex, an edge or
// a face, and still exact for cubic fields. Where only four points are known, p₀′ = (p₁ − p₋₁)/2.
#include "jets.h"

#include <algorithm>
#include <cmath>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

/// The uniform cubic B-spline.
CubicWeights spline(double t) {
    const double s = 1 - t;
    return {{s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6},
            {-s * s / 2, (3 * t * t - 4 * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2}};
}

/// The polynomial through the four points; exactly one of them where t is 0 or 1.
std::array<double, 4> lagrange(double t) {
    const double a = t + 1, b = t, c = t - 1, d = t - 2;
    return {-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6};
}

/// The derivative at t of the cubic with given values and slopes at 0 and 1: the weights of f(0), f′(0) and f′(1). That of f(1)
/// is the first with the other sign.
std::array<double, 3> hermite_slopes(double t) {
    return {6 * t * (t - 1), (3 * t - 1) * (t - 1), t * (3 * t - 2)};
}

/// Slopes at the ends from the points on both sides of them.
CubicWeights interpolant(double t) {
    const auto [f, left, right] = hermite_slopes(t);
    return {lagrange(t), {-left / 2, f - right / 2, left / 2 - f, right / 2}};
}

/// Slopes at the ends from two points on both sides of them.
WideWeights wide_interpolant(double t) {
    const auto [f, left, right] = hermite_slopes(t);
    return {lagrange(t),
            {left / 12, (right - 8 * left) / 12, f - 8 * right / 12, 8 * left / 12 - f, (8 * right - left) / 12, -right / 12}};
}

/// Weights along the three axes.
template <class WeightsAt>
auto weights_along(const Vec3& uvw, const WeightsAt& at) {
    return std::array{at(uvw.x), at(uvw.y), at(uvw.z)};
}

// Levels shorten what is left by two to sixteen: what agrees after a longer way than this does so by accident.
constexpr double kSome = 32;
// A first comparison has nothing before it, so it must be nearer.
constexpr double kFirstTime = 0.25;

}  // namespace

Channels::Channels(const HexMesh& mesh) : count_(3) {
    for (const auto& attribute : mesh.attributes) count_ += static_cast<std::size_t>(attribute.channels);
    stride_ = (count_ + 3) / 4 * 4;
}

void Channels::read(const HexMesh& mesh, Index point, double* to) {
    for (int a = 0; a < 3; ++a) *to++ = mesh.points[point][a];
    for (const auto& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        to = std::copy_n(attribute.values.begin() + static_cast<std::ptrdiff_t>(point * channels), channels, to);
    }
}

CellJets::CellJets(Scheme scheme, std::size_t stride) : spline_(!interpolates(scheme)), stride_(stride), data_(64 * stride) {
}

void CellJets::load_grid(const double* points, const GridPoints& grid) {
    form_ = Form::Grid;
    points_ = points;
    grid_ = grid;
    if (std::ranges::find(grid, kNone) == grid.end()) return;
    for (std::size_t n = 0; n < 64; ++n) {
        if (grid[n] != kNone) std::copy_n(points + grid[n] * stride_, stride_, &data_[n * stride_]);
        grid_[n] = static_cast<Index>(n);
    }
    points_ = data_.data();
    for (std::size_t along = 1; along <= 16; along *= 4) fill_missing(grid, along);
}

void CellJets::load_block(const GridRows& points) {
    form_ = Form::Block;
    block_ = points;
}

void CellJets::load_corners(const double* points, std::span<const Index, 8> corners) {
    form_ = Form::Corners;
    for (std::size_t k = 0; k < 8; ++k) std::copy_n(points + corners[k] * stride_, stride_, &data_[k * stride_]);
}

void CellJets::evaluate(const Vec3& uvw, double scale, double* jet) const {
    if (form_ == Form::Block) return sum_tricubic(block_, weights_along(uvw, wide_interpolant), scale, jet);
    if (form_ == Form::Grid) {
        return sum_tricubic(points_, grid_, stride_, weights_along(uvw, spline_ ? spline : interpolant), scale, jet);
    }
    std::fill_n(jet, 4 * stride_, 0.0);
    for (std::size_t k = 0; k < 8; ++k) {
        std::array<double, 3> weight{}, slope{};
        for (std::size_t a = 0; a < 3; ++a) {
            const double t = uvw[static_cast<int>(a)];
            weight[a] = (k >> a & 1) != 0 ? t : 1 - t;
            slope[a] = (k >> a & 1) != 0 ? scale : -scale;
        }
        const std::array<double, 4> w{weight[0] * weight[1] * weight[2], slope[0] * weight[1] * weight[2],
                                      weight[0] * slope[1] * weight[2], weight[0] * weight[1] * slope[2]};
        for (std::size_t d = 0; d < 4; ++d) {
            for (std::size_t c = 0; c < stride_; ++c) jet[d * stride_ + c] += w[d] * data_[k * stride_ + c];
        }
    }
}

/// Fills the layers of the grid that lie beyond a flat boundary, along one axis.
///
///     ○      ●      ●      ●      the boundary is at p₁, p₀ is missing
///     p₀     p₁     p₂     p₃
///
/// For a spline p₀ = 2 p₁ − p₂: then its second derivative across the boundary is 0, which is the limit of the boundary rules.
/// An interpolant is continued quadratically, p₀ = 3 p₁ − 3 p₂ + p₃: it becomes the parabola through the other three points. If
/// p₃ is missing, too, both are continued linearly.
void CellJets::fill_missing(const GridPoints& grid, std::size_t along) {
    const std::size_t a = along == 1 ? 4 : 1, b = along == 16 ? 4 : 16;  // the strides of the other two axes
    for (const std::size_t layer : {std::size_t{0}, std::size_t{3}}) {
        if (grid[layer * along + a + b] != kNone) continue;
        const std::size_t near = layer == 0 ? 1 : 2, far = 3 - near, beyond = 3 - layer;
        const bool quadratic = !spline_ && grid[beyond * along + a + b] != kNone;
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                const std::size_t row = i * a + j * b;
                for (std::size_t c = 0; c < stride_; ++c) {
                    const auto at = [&](std::size_t n) -> double& { return data_[(row + n * along) * stride_ + c]; };
                    at(layer) = quadratic ? 3 * at(near) - 3 * at(far) + at(beyond) : 2 * at(near) - at(far);
                }
            }
        }
    }
}

/// A place is done if it is exact, if enough consecutive levels agree (see below), or if this is the last level.
///
/// A cubic needs one agreement, unless it may be by accident: the jets of the two levels before it must have been near each
/// other, too, and if there were none, these two must be nearer. Trilinear values need two agreements. Their derivatives may
/// not converge at all around extraordinary edges and vertices, so after some levels the values alone decide there.
bool Settling::settle(OpenPlace& at, const double* jet, int level, bool regular, bool exact) {
    constexpr int kSlopeLevels = 7;
    const Nearness before = at.before;
    const bool with_slopes = regular || level < kSlopeLevels;
    at.before = level >= 1 && at.has_last ? nearness(at, jet, with_slopes) : Nearness::Unknown;
    const bool agrees = at.before == Nearness::Close && (!regular || before != Nearness::Far) &&
                        (!regular || before != Nearness::Unknown || is_close(jet, at.last, kFirstTime, with_slopes));
    at.agreed = agrees ? static_cast<std::uint8_t>(at.agreed + 1) : std::uint8_t{0};
    // At the centre of a cell whose cell point is the mean of its corners, a trilinear value does not change for one level. In
    // the corner of a body all new points of a spline are means: there it changes on no level, though it is not the limit, and
    // agreement does not count.
    const bool in_doubt = !interpolates(options_.scheme.kind) && !regular && at.stays;
    const int needed = regular || in_doubt ? 1 : 2;
    const bool settled = level >= 2 && at.agreed >= needed && (!in_doubt || level >= options_.max_levels);
    if (in_doubt) at.agreed = 0;
    if (!exact && !settled && level < options_.max_levels) {
        std::copy_n(jet, 4 * stride_, at.last);
        at.has_last = true;
        return false;
    }
    ++(exact ? report_.exact : report_.refined);
    report_.unconverged += !exact && !settled;
    write(at.query, jet);
    return true;
}

Nearness Settling::nearness(const OpenPlace& at, const double* jet, bool with_slopes) const {
    if (is_close(jet, at.last, 1, with_slopes)) return Nearness::Close;
    return is_close(jet, at.last, kSome, with_slopes) ? Nearness::Some : Nearness::Far;
}

/// Whether two jets agree: values within the tolerance, derivatives within its square root, because they converge with half the
/// order of values; times a factor.
bool Settling::is_close(const double* a, const double* b, double factor, bool with_slopes) const {
    const double tolerance = factor * options_.tolerance;
    for (std::size_t c = 0; c < scales_.size(); ++c) {
        if (!(std::abs(a[c] - b[c]) <= tolerance * scales_[c])) return false;
    }
    if (!with_slopes) return true;
    const double slope_tolerance = factor * std::sqrt(options_.tolerance);
    for (std::size_t d = 1; d < 4; ++d) {
        for (std::size_t c = 0; c < scales_.size(); ++c) {
            if (std::abs(a[d * stride_ + c] - b[d * stride_ + c]) > slope_tolerance * scales_[c]) return false;
        }
    }
    return true;
}

void Settling::prefetch(std::size_t query) const {
    __builtin_prefetch(&samples_.positions[query], 1);
    __builtin_prefetch(&samples_.jacobians[query], 1);
    __builtin_prefetch(&samples_.jacobians[query][2], 1);
    for (const LimitAttribute& attribute : samples_.attributes) {
        __builtin_prefetch(&attribute.values[query * attribute.channels], 1);
        __builtin_prefetch(&attribute.derivatives[query * attribute.channels], 1);
    }
}

void Settling::write(std::size_t query, const double* jet) {
    const double *du = jet + stride_, *dv = du + stride_, *dw = dv + stride_;
    samples_.positions[query] = {jet[0], jet[1], jet[2]};
    samples_.jacobians[query] = {Vec3(du[0], du[1], du[2]), Vec3(dv[0], dv[1], dv[2]), Vec3(dw[0], dw[1], dw[2])};
    std::size_t from = 3;
    for (LimitAttribute& attribute : samples_.attributes) {
        for (std::size_t c = 0; c < attribute.channels; ++c, ++from) {
            attribute.values[query * attribute.channels + c] = jet[from];
            attribute.derivatives[query * attribute.channels + c] = {du[from], dv[from], dw[from]};
        }
    }
}

/// `stays` finds places near a vertex: a place in the same octant twice is at the same corner of both cells.
void OpenPlace::step_down() {
    const auto next = static_cast<std::uint8_t>(step_into_octant(uvw));
    stays = next == octant;
    octant = next;
}

std::size_t step_into_octant(Vec3& uvw) {
    std::size_t octant = 0;
    for (int a = 0; a < 3; ++a) {
        const bool upper = uvw[a] >= 0.5;
        octant |= std::size_t{upper} << a;
        uvw[a] = 2 * uvw[a] - (upper ? 1 : 0);
    }
    return octant;
}

void add_report(const LimitReport& more, LimitReport& total) {
    total.exact += more.exact;
    total.refined += more.refined;
    total.unconverged += more.unconverged;
    total.deepest_level = std::max(total.deepest_level, more.deepest_level);
}

}  // namespace subvol::detail
