#pragma once

#include <algorithm>
#include <vector>

#include "cubic_basis.h"
#include "regular_grid.h"
#include "subvol/refine.h"

namespace subvol::detail {

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

/// Value and derivatives of all channels at one place: entry 4c is channel c, behind it its derivatives by u, v, w.
using Jet = std::vector<double>;

using Basis = std::array<CubicBasis, 3>;

/// Sums over 4×4×4 points, the first at `data`; points along an axis are `side` to its power apart.
/// scale: by how much derivatives grow, 2^level
inline void sum_grid(const double* data, std::size_t side, std::size_t channels, const Basis& basis, double scale, Jet& jet) {
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

/// What the grid of 4×4×4 points about a cell says at a place in the cell.
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
    /// Beyond a flat boundary a spline's control points are mirrored, 2 f₀ − f₁, which is what the boundary rules amount to; an
    /// interpolant goes on quadratically, which leaves out the missing point.
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

/// Which of the eight children a place is in, u + 2v + 4w; the place becomes one in the child.
inline std::size_t step_into_octant(Vec3& uvw) {
    std::size_t octant = 0;
    for (int a = 0; a < 3; ++a) {
        const bool upper = uvw[a] >= 0.5;
        octant |= std::size_t{upper} << a;
        uvw[a] = 2 * uvw[a] - (upper ? 1 : 0);
    }
    return octant;
}

inline void evaluate_linear(const HexMesh& mesh, std::size_t channels, Index cell, const Vec3& uvw, double scale, Jet& jet) {
    constexpr std::array<std::array<int, 3>, 8> kCorner{
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
    std::vector<double> data(channels);
    jet.assign(4 * channels, 0.0);
    for (std::size_t k = 0; k < 8; ++k) {
        Channels::read(mesh, mesh.cells[cell][k], data.data());
        std::array<double, 3> weight{}, slope{};
        for (std::size_t a = 0; a < 3; ++a) {
            const double t = uvw[static_cast<int>(a)];
            weight[a] = kCorner[k][a] ? t : 1 - t;
            slope[a] = kCorner[k][a] ? scale : -scale;
        }
        const std::array<double, 4> w{weight[0] * weight[1] * weight[2], slope[0] * weight[1] * weight[2],
                                      weight[0] * slope[1] * weight[2], weight[0] * weight[1] * slope[2]};
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t d = 0; d < 4; ++d) jet[4 * c + d] += w[d] * data[c];
        }
    }
}

}  // namespace subvol::detail
