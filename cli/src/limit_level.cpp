#include "limit_level.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "subvol/limit.h"

namespace subvol::cli {
namespace {

constexpr int kMaxLevel = 4;
constexpr std::size_t kMaxCells = 8'000'000;
constexpr double kPositionTolerance = 0.1;
constexpr double kValueTolerance = 1e-3;

/// Corner k of a cell in halves along u, v, w.
constexpr std::array<std::array<int, 3>, 8> kCorners{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

using Weights = std::array<double, 8>;

/// Trilinear weights of the parent's corners at corner `corner` of child `child`.
Weights midpoint_weights(std::size_t child, std::size_t corner) {
    Weights weights;
    for (std::size_t k = 0; k < 8; ++k) {
        double w = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double u = 0.5 * (kCorners[child][axis] + kCorners[corner][axis]);
            w *= kCorners[k][axis] == 1 ? u : 1 - u;
        }
        weights[k] = w;
    }
    return weights;
}

/// The largest of error(parent, point, weights) over all points of all cells, whichever way the cells are shared out.
template <class ErrorAt>
double largest(const HexMesh& parent, const HexMesh& child, const ErrorAt& error) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, child.cells.size(), 4096), 0.0,
        [&](const auto& range, double most) {
            for (std::size_t c = range.begin(); c != range.end(); ++c) {
                for (std::size_t k = 0; k < 8; ++k) {
                    if (k == c % 8) continue;  // the parent's own corner, which stays (or moves with its neighbours)
                    most = std::max(most, error(parent.cells[c / 8], child.cells[c][k], midpoint_weights(c % 8, k)));
                }
            }
            return most;
        },
        [](double a, double b) { return std::max(a, b); });
}

double position_deviation(const HexMesh& parent, const HexMesh& child) {
    return largest(parent, child, [&](const auto& cell, Index point, const Weights& weights) {
        Vec3 middle(0.0);
        for (std::size_t k = 0; k < 8; ++k) middle += weights[k] * parent.points[cell[k]];
        return glm::length(child.points[point] - middle);
    });
}

double value_deviation(const HexMesh& parent, const HexMesh& child, std::size_t attribute) {
    const std::vector<double>& old = parent.attributes[attribute].values;
    const std::vector<double>& refined = child.attributes[attribute].values;
    const auto [min, max] = std::ranges::minmax(old);
    constexpr double kRounding = 1e-12;  // relative: a field that varies less is constant
    if (!(max - min > kRounding * std::max(std::abs(min), std::abs(max)))) return 0;
    const double most = largest(parent, child, [&](const auto& cell, Index point, const Weights& weights) {
        double middle = 0;
        for (std::size_t k = 0; k < 8; ++k) middle += weights[k] * old[cell[k]];
        return std::abs(refined[point] - middle);
    });
    return most / (max - min);
}

}  // namespace

LimitMesh refine_to_limit(HexMesh mesh, RefineOptions options, double voxel_size_world) {
    LimitMesh result{.mesh = std::move(mesh)};
    options.levels = 1;
    while (result.level < kMaxLevel && 8 * result.mesh.cells.size() <= kMaxCells) {
        HexMesh next = refine(result.mesh, options);
        options.crease_angle_deg.reset();  // the angles of the mesh as it came decide; refined meshes carry their creases
        result.position_voxels = position_deviation(result.mesh, next) / voxel_size_world;
        result.value_range = 0;
        for (std::size_t a = 0; a < next.attributes.size(); ++a) {
            result.value_range = std::max(result.value_range, value_deviation(result.mesh, next, a));
        }
        result.converged = result.position_voxels <= kPositionTolerance && result.value_range <= kValueTolerance;
        if (result.converged) break;
        result.mesh = std::move(next);
        ++result.level;
    }
    result.mesh = on_limit(std::move(result.mesh), options.scheme);
    return result;
}

}  // namespace subvol::cli
