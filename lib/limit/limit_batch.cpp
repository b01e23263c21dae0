// SPDX-License-Identifier: Apache-2.0
#include "limit_batch.h"

#include <algorithm>
#include <cmath>

#include "topology_parts.h"

namespace subvol::detail {

namespace {

/// All channels of a point of a mesh, position first.
class Channels {
public:
    explicit Channels(const HexMesh& mesh) : count_(3) {
        for (const auto& attribute : mesh.attributes) count_ += static_cast<std::size_t>(attribute.channels);
    }
    [[nodiscard]] std::size_t count() const { return count_; }

    static void read(const HexMesh& mesh, Index point, double* to) {
        for (int a = 0; a < 3; ++a) *to++ = mesh.points[point][a];
        for (const auto& attribute : mesh.attributes) {
            const auto channels = static_cast<std::size_t>(attribute.channels);
            to = std::copy_n(attribute.values.begin() + static_cast<std::ptrdiff_t>(point * channels), channels, to);
        }
    }

private:
    std::size_t count_;
};

/// Weights of four grid points at −1, 0, 1, 2 for a parameter t in [0,1], and their derivatives.
struct CubicBasis {
    std::array<double, 4> value{}, first{};

    /// The uniform cubic B-spline.
    static CubicBasis spline(double t) {
        const double s = 1 - t;
        return {{s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6},
                {-s * s / 2, (3 * t * t - 4 * t) / 2, (4 * s - 3 * s * s) / 2, t * t / 2}};
    }

    /// The polynomial through the four points; exactly one of them where t is 0 or 1.
    static CubicBasis lagrange(double t) {
        const double a = t + 1, b = t, c = t - 1, d = t - 2;
        return {{-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6},
                {-(c * d + b * d + b * c) / 6, (c * d + a * d + a * c) / 2, -(b * d + a * d + a * b) / 2,
                 (b * c + a * c + a * b) / 6}};
    }

    /// The line between the two inner points.
    static CubicBasis linear(double t) { return {{0, 1 - t, t, 0}, {0, -1, 1, 0}}; }
};

using Basis = std::array<CubicBasis, 3>;

/// Sums over 4×4×4 points of a grid of side³ points; `data` is the first of them.
///
/// scale: factor of the derivatives, 2^level
void sum_grid(const double* data, std::size_t side, std::size_t channels, const Basis& basis, double scale, Jet& jet) {
    jet.assign(4 * channels, 0.0);
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t j = 0; j < 4; ++j) {
            for (std::size_t i = 0; i < 4; ++i) {
                const std::array<double, 4> weight{basis[0].value[i] * basis[1].value[j] * basis[2].value[k],
                                                   scale * basis[0].first[i] * basis[1].value[j] * basis[2].value[k],
                                                   scale * basis[0].value[i] * basis[1].first[j] * basis[2].value[k],
                                                   scale * basis[0].value[i] * basis[1].value[j] * basis[2].first[k]};
                const double* point = data + (i + side * (j + side * k)) * channels;
                for (std::size_t c = 0; c < channels; ++c) {
                    for (std::size_t d = 0; d < 4; ++d) jet[4 * c + d] += weight[d] * point[c];
                }
            }
        }
    }
}

/// Evaluates a cell from the grid of 4×4×4 points about it.
class GridEvaluator {
public:
    GridEvaluator(const HexMesh& mesh, std::size_t channels, Scheme scheme)
        : mesh_(mesh), channels_(channels), spline_(!interpolates(scheme)), data_(64 * channels) {}

    void load(const GridPoints& grid) {
        for (std::size_t n = 0; n < 64; ++n) {
            if (grid[n] != kNone) Channels::read(mesh_, grid[n], &data_[n * channels_]);
        }
        for (std::size_t axis = 0, stride = 1; axis < 3; ++axis, stride *= 4) fill_missing(grid, stride);
    }

    void evaluate(const Vec3& uvw, double scale, Jet& jet) const {
        Basis basis;
        for (int a = 0; a < 3; ++a) {
            basis[static_cast<std::size_t>(a)] = spline_ ? CubicBasis::spline(uvw[a]) : CubicBasis::lagrange(uvw[a]);
        }
        sum_grid(data_.data(), 4, channels_, basis, scale, jet);
    }

private:
    /// Beyond a flat boundary the control points of a spline are 2 f₀ − f₁: with them the spline is the limit of the boundary
    /// rules. An interpolant is continued quadratically: it becomes the parabola through the other three points.
    void fill_missing(const GridPoints& grid, std::size_t stride) {
        const std::size_t a = stride == 1 ? 4 : 1, b = stride == 16 ? 4 : 16;  // the strides of the other two axes
        for (const std::size_t layer : {std::size_t{0}, std::size_t{3}}) {
            if (grid[layer * stride + a + b] != kNone) continue;
            const std::size_t near = layer == 0 ? 1 : 2, far = 3 - near, beyond = 3 - layer;
            const bool quadratic = !spline_ && grid[beyond * stride + a + b] != kNone;
            for (std::size_t i = 0; i < 4; ++i) {
                for (std::size_t j = 0; j < 4; ++j) {
                    const std::size_t row = i * a + j * b;
                    for (std::size_t c = 0; c < channels_; ++c) {
                        const auto at = [&](std::size_t n) -> double& { return data_[(row + n * stride) * channels_ + c]; };
                        at(layer) = quadratic ? 3 * at(near) - 3 * at(far) + at(beyond) : 2 * at(near) - at(far);
                    }
                }
            }
        }
    }

    const HexMesh& mesh_;
    std::size_t channels_;
    bool spline_;
    std::vector<double> data_;
};

/// Which of the eight children a place is in, u + 2v + 4w. The place becomes that in the child.
std::size_t step_into_octant(Vec3& uvw) {
    std::size_t octant = 0;
    for (int a = 0; a < 3; ++a) {
        const bool upper = uvw[a] >= 0.5;
        octant |= std::size_t{upper} << a;
        uvw[a] = 2 * uvw[a] - (upper ? 1 : 0);
    }
    return octant;
}

void evaluate_linear(const HexMesh& mesh, std::size_t channels, Index cell, const Vec3& uvw, double scale, Jet& jet) {
    std::vector<double> data(channels);
    jet.assign(4 * channels, 0.0);
    for (std::size_t k = 0; k < 8; ++k) {
        Channels::read(mesh, mesh.cells[cell][k], data.data());
        std::array<double, 3> weight{}, slope{};
        for (std::size_t a = 0; a < 3; ++a) {
            const double t = uvw[static_cast<int>(a)];
            weight[a] = kCornerParameters[k][a] ? t : 1 - t;
            slope[a] = kCornerParameters[k][a] ? scale : -scale;
        }
        const std::array<double, 4> w{weight[0] * weight[1] * weight[2], slope[0] * weight[1] * weight[2],
                                      weight[0] * slope[1] * weight[2], weight[0] * weight[1] * slope[2]};
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t d = 0; d < 4; ++d) jet[4 * c + d] += w[d] * data[c];
        }
    }
}

/// The cells of the queries, ascending. OpenQuery::cell becomes an index into that list.
std::vector<Index> number_cells(std::vector<OpenQuery>& open) {
    std::stable_sort(open.begin(), open.end(), [](const OpenQuery& a, const OpenQuery& b) { return a.cell < b.cell; });
    std::vector<Index> cells;
    for (const OpenQuery& at : open) {
        if (cells.empty() || cells.back() != at.cell) cells.push_back(at.cell);
    }
    for (std::size_t i = 0, k = 0; i < open.size(); ++i) {
        if (open[i].cell != cells[k]) ++k;
        open[i].cell = static_cast<Index>(k);
    }
    return cells;
}

/// Moves a query to the child cell in which it lies.
void enter_child(OpenQuery& at) {
    at.cell = 8 * at.cell + static_cast<Index>(kCornerOctants[step_into_octant(at.uvw)]);
}

}  // namespace

BatchEvaluator::BatchEvaluator(const LimitOptions& options, const std::vector<double>& scales, LimitSamples& samples)
    : options_(options), scales_(scales), samples_(samples), grid_rule_(options.scheme.tension) {
}

void BatchEvaluator::begin(const HexMesh& control, const Topology& topology, std::vector<OpenQuery>& open) {
    evaluate_level(control, topology, 0, open);
}

void BatchEvaluator::finish(const PatchSource& source, std::vector<OpenQuery> open) {
    Patch patch = source.cut(number_cells(open), 2);
    for (int level = 1; !open.empty(); ++level) {
        patch = refine_patch(patch, options_.scheme, 2);
        for (OpenQuery& at : open) enter_child(at);
        evaluate_level(patch.mesh, build_topology(patch.mesh, InteriorCreases::Ignore), level, open);
        patch = sub_patch(patch, number_cells(open), 2);
    }
}

/// Writes the queries that have converged at this level and removes them from `open`.
void BatchEvaluator::evaluate_level(const HexMesh& mesh, const Topology& topology, int level, std::vector<OpenQuery>& open) {
    report_.deepest_level = std::max(report_.deepest_level, level);
    const double scale = std::ldexp(1.0, level);
    GridEvaluator grid(mesh, scales_.size(), options_.scheme.kind);
    Index loaded = kNone;
    bool regular = false, wide = false;
    GridPoints points;
    WideGridPoints wide_points;
    Jet jet;
    std::erase_if(open, [&](OpenQuery& at) {
        if (at.cell != loaded) {
            loaded = at.cell;
            regular = options_.scheme.kind != Scheme::Linear && regular_grid(topology, at.cell, points);
            if (regular) grid.load(points);
            wide = regular && options_.scheme.kind == Scheme::Mcq && wide_grid(topology, at.cell, wide_points);
            if (wide) load(mesh, wide_points);
        }
        if (wide) {
            refine_in_grid(at, level);
            return true;
        }
        if (regular) {
            grid.evaluate(at.uvw, scale, jet);
        } else {
            evaluate_linear(mesh, scales_.size(), at.cell, at.uvw, scale, jet);
        }
        const bool exact = options_.scheme.kind == Scheme::Linear || (regular && !interpolates(options_.scheme.kind));
        return settle(at, jet, level, regular, exact);
    });
}

/// Writes the query if it has converged with this level's jet. Returns whether it has.
bool BatchEvaluator::settle(OpenQuery& at, const Jet& jet, int level, bool regular, bool exact) {
    at.agreed = level >= 1 && is_close(jet, at.last, level) ? at.agreed + 1 : 0;
    // At the centre of a cell whose cell point is the mean of its corners, a trilinear value does not change for one level.
    const bool settled = level >= 2 && at.agreed >= (regular ? 1 : 2);
    at.last = jet;
    if (!exact && !settled && level < options_.max_levels) return false;
    ++(exact ? report_.exact : report_.refined);
    report_.unconverged += !exact && !settled;
    write(at.query, jet);
    return true;
}

void BatchEvaluator::load(const HexMesh& mesh, const WideGridPoints& points) {
    wide_data_.resize(points.size() * scales_.size());
    for (std::size_t n = 0; n < points.size(); ++n) Channels::read(mesh, points[n], &wide_data_[n * scales_.size()]);
}

/// Refines inside the wide grid until the query has converged: the children need no topology.
void BatchEvaluator::refine_in_grid(OpenQuery& at, int level) {
    constexpr std::size_t kSide = McqGrid::kSide;
    std::vector<double> data = wide_data_, child(data.size());
    for (Jet jet;; ++level) {
        const Basis basis{CubicBasis::lagrange(at.uvw[0]), CubicBasis::lagrange(at.uvw[1]), CubicBasis::lagrange(at.uvw[2])};
        sum_grid(&data[(1 + kSide + kSide * kSide) * scales_.size()], kSide, scales_.size(), basis, std::ldexp(1.0, level),
                 jet);
        report_.deepest_level = std::max(report_.deepest_level, level);
        if (settle(at, jet, level, true, false)) return;
        grid_rule_.refine(step_into_octant(at.uvw), scales_.size(), data, child);
        data.swap(child);
    }
}

/// Derivatives converge with half the order of values. About extraordinary edges and vertices they may not converge at all, so
/// after some levels the values alone decide.
bool BatchEvaluator::is_close(const Jet& a, const Jet& b, int level) const {
    constexpr int kSlopeLevels = 7;
    const double slope_tolerance = level < kSlopeLevels ? std::sqrt(options_.tolerance) : HUGE_VAL;
    for (std::size_t c = 0; c < scales_.size(); ++c) {
        if (!(std::abs(a[4 * c] - b[4 * c]) <= options_.tolerance * scales_[c])) return false;
        for (std::size_t d = 1; d < 4; ++d) {
            if (std::abs(a[4 * c + d] - b[4 * c + d]) > slope_tolerance * scales_[c]) return false;
        }
    }
    return true;
}

void BatchEvaluator::write(std::size_t query, const Jet& jet) {
    for (int a = 0; a < 3; ++a) {
        const std::size_t c = 4 * static_cast<std::size_t>(a);
        samples_.positions[query][a] = jet[c];
        for (int d = 0; d < 3; ++d) samples_.jacobians[query][d][a] = jet[c + 1 + static_cast<std::size_t>(d)];
    }
    const double* next = jet.data() + 12;
    for (LimitAttribute& attribute : samples_.attributes) {
        for (std::size_t c = 0; c < attribute.channels; ++c, next += 4) {
            attribute.values[query * attribute.channels + c] = next[0];
            attribute.derivatives[query * attribute.channels + c] = {next[1], next[2], next[3]};
        }
    }
}

}  // namespace subvol::detail
