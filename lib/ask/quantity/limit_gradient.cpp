// SPDX-License-Identifier: Apache-2.0
#include "limit_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "subvol/cell.h"
#include "subvol/limit.h"

namespace subvol::detail {
namespace {

constexpr std::size_t kCellsAtOnce = 1 << 13;  // cells that are evaluated together

/// A corner's own place, and one inside the cell for corners at which the cell has no volume.
Vec3 place_of(int corner, double inset) {
    const std::array<int, 3>& at_corner = kCornerParameters[static_cast<std::size_t>(corner)];
    const Vec3 at(at_corner[0], at_corner[1], at_corner[2]);
    return at + inset * (Vec3(0.5) - at);
}

bool has_volume(const Mat3& jacobian) {
    constexpr double kFlat = 1e-9;
    const double size = glm::length(jacobian[0]) * glm::length(jacobian[1]) * glm::length(jacobian[2]);
    return std::abs(glm::determinant(jacobian)) > kFlat * size;
}

class GradientSum {
public:
    GradientSum(const HexMesh& mesh, const Attribute& attribute)
        : channels_(static_cast<std::size_t>(attribute.channels)),
          weights_(mesh.points.size(), 0),
          result_{attribute.name, 3 * attribute.channels, std::vector<double>(3 * channels_ * mesh.points.size(), 0)} {}

    /// Adds the derivatives of a sample of a corner.
    void add(Index point, const LimitSamples& samples, std::size_t sample) {
        const Mat3& jacobian = samples.jacobians[sample];
        const double volume = std::abs(glm::determinant(jacobian));
        const Mat3 inverse = glm::inverse(jacobian);
        weights_[point] += volume;
        for (std::size_t c = 0; c < channels_; ++c) {
            const Vec3 gradient = samples.attributes[0].derivatives[sample * channels_ + c] * inverse;
            for (int k = 0; k < 3; ++k)
                result_.values[3 * (point * channels_ + c) + static_cast<std::size_t>(k)] += volume * gradient[k];
        }
    }

    [[nodiscard]] Attribute mean() && {
        const std::size_t width = 3 * channels_;
        for (std::size_t p = 0; p < weights_.size(); ++p) {
            if (weights_[p] == 0) continue;
            for (std::size_t k = 0; k < width; ++k) result_.values[p * width + k] /= weights_[p];
        }
        return std::move(result_);
    }

private:
    std::size_t channels_;
    std::vector<double> weights_;
    Attribute result_;
};

}  // namespace

Attribute limit_gradient(const HexMesh& mesh, const Attribute& attribute, Progress* progress) {
    constexpr double kInset = 0.05;
    const auto channels = static_cast<std::size_t>(attribute.channels);
    HexMesh alone{mesh.points, mesh.cells, {attribute}, mesh.creases, mesh.sharp_faces};
    alone.attributes[0].bounds.clear();
    alone.attributes[0].constant = false;
    const LimitEvaluator limit(alone);
    GradientSum sum(mesh, attribute);
    for (std::size_t begin = 0; begin < mesh.cells.size(); begin += kCellsAtOnce) {
        const std::size_t end = std::min(begin + kCellsAtOnce, mesh.cells.size());
        report_progress(progress, "derivatives", begin, mesh.cells.size());
        std::vector<LimitQuery> queries, flat;
        for (std::size_t cell = begin; cell < end; ++cell) {
            for (int corner = 0; corner < 8; ++corner) queries.push_back({static_cast<Index>(cell), place_of(corner, 0)});
        }
        const LimitSamples samples = limit.at(queries);
        std::vector<Index> flat_points;
        for (std::size_t q = 0; q < queries.size(); ++q) {
            const Index point = mesh.cells[queries[q].cell][q % 8];
            if (has_volume(samples.jacobians[q])) {
                sum.add(point, samples, q);
            } else {
                flat.push_back({queries[q].cell, place_of(static_cast<int>(q % 8), kInset)});
                flat_points.push_back(point);
            }
        }
        const LimitSamples inside = limit.at(flat);
        for (std::size_t q = 0; q < flat.size(); ++q) {
            if (has_volume(inside.jacobians[q])) sum.add(flat_points[q], inside, q);
        }
    }
    Attribute gradient = std::move(sum).mean();
    gradient.derived = true;
    if (channels == 1 && attribute.cells.empty())
        gradient.potential = std::make_shared<const Attribute>(std::move(alone.attributes[0]));
    for (std::size_t i = 0; i < attribute.walls.points.size(); ++i) {
        for (std::size_t c = 0; c < channels; ++c) {
            const Vec3& known = attribute.walls.gradients[i * channels + c];
            for (std::size_t k = 0; k < 3; ++k)
                gradient.values[3 * (attribute.walls.points[i] * channels + c) + k] = known[static_cast<int>(k)];
        }
    }
    return gradient;
}

}  // namespace subvol::detail
