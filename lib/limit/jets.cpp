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
CubicWeights lagrange(double t) {
    const double a = t + 1, b = t, c = t - 1, d = t - 2;
    return {
        {-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6},
        {-(c * d + b * d + b * c) / 6, (c * d + a * d + a * c) / 2, -(b * d + a * d + a * b) / 2, (b * c + a * c + a * b) / 6}};
}

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
    if (form_ != Form::Corners) {
        std::array<CubicWeights, 3> weights;
        for (int a = 0; a < 3; ++a) weights[static_cast<std::size_t>(a)] = spline_ ? spline(uvw[a]) : lagrange(uvw[a]);
        if (form_ == Form::Block) return sum_tricubic(block_, weights, scale, jet);
        return sum_tricubic(points_, grid_, stride_, weights, scale, jet);
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

/// A place is done if it is exact, if enough consecutive levels agree (one agreement for a cubic; two for a trilinear value,
/// which may agree by accident), or if this is the last level.
bool Settling::settle(OpenPlace& at, const double* jet, int level, bool regular, bool exact) {
    at.agreed = level >= 1 && is_close(jet, at.last, level) ? static_cast<std::uint8_t>(at.agreed + 1) : std::uint8_t{0};
    // At the centre of a cell whose cell point is the mean of its corners, a trilinear value does not change for one level. In
    // the corner of a body all new points of a spline are means: there it changes on no level, though it is not the limit, and
    // agreement does not count.
    const bool in_doubt = !interpolates(options_.scheme.kind) && !regular && at.stays;
    const int needed = regular || in_doubt ? 1 : 2;
    const bool settled = level >= 2 && at.agreed >= needed && (!in_doubt || level >= options_.max_levels);
    if (in_doubt) at.agreed = 0;
    if (!exact && !settled && level < options_.max_levels) {
        std::copy_n(jet, 4 * stride_, at.last);
        return false;
    }
    ++(exact ? report_.exact : report_.refined);
    report_.unconverged += !exact && !settled;
    write(at.query, jet);
    return true;
}

/// Whether two jets agree: values within the tolerance, derivatives within its square root, because they converge with half the
/// order of values. Around extraordinary edges and vertices derivatives may not converge at all, so after some levels the
/// values alone decide.
bool Settling::is_close(const double* a, const double* b, int level) const {
    constexpr int kSlopeLevels = 7;
    const double slope_tolerance = level < kSlopeLevels ? std::sqrt(options_.tolerance) : HUGE_VAL;
    for (std::size_t c = 0; c < scales_.size(); ++c) {
        if (!(std::abs(a[c] - b[c]) <= options_.tolerance * scales_[c])) return false;
    }
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
