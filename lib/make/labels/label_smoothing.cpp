// SPDX-License-Identifier: Apache-2.0
// Smooth walls between labels that stay within half a voxel of where the voxels have them.
//
// A round is nearly one of [taubin1995]: points move towards the mean of those beside them, and then away from it by nine
// tenths of that, so that steps of voxels vanish while longer waves remain. A point where three materials meet, or on a
// sharp edge, looks at those beside it on the same line alone: walls do not pull lines inwards, and a body's rim stays sharp.
//
// Then the volumes are met as by pressures: with a pressure p in each material, 0 outside, a wall between a and b moves by
// (p_a − p_b) along its normal. What that does to the volumes is linear near the walls,
//
//     ΔV_l = Σ_m p_m Σ_x g_l(x) · g_m(x) / s(x)          g_l = ∂V_l/∂x,  s = the largest |g_m| at the point x,
//
// a symmetric system with one unknown for each material, which conjugate gradients solve.
#include "label_smoothing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "subvol/detail/conjugate_gradients.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/sparse_rows.h"

namespace subvol::detail {

namespace {

constexpr double kMostMove = 0.49;              // voxels, so that points of neighbours do not meet
constexpr double kShrink = 0.5, kGrow = -0.45;  // less than in [taubin1995], as volumes are kept besides
constexpr int kMostCorrections = 12;
constexpr double kNearEnough = 1e-5;  // of a material's volume

Vec3 clamped_move(const Vec3& move) {
    return glm::min(glm::max(move, Vec3(-kMostMove)), Vec3(kMostMove));
}

/// The directions in which points beside a point count; none: it stays where it is.
std::uint8_t directions_of(const LabelNet::Point& point) {
    std::uint8_t all = 0, opposite = 0;
    int lines = 0;
    for (unsigned d = 0; d < 6; ++d) {
        if (point.next[d] != kNone) all |= static_cast<std::uint8_t>(1U << d);
        lines += point.lines >> d & 1;
        if ((point.lines >> d & 1) != 0 && (point.lines >> (d ^ 1) & 1) != 0) opposite |= static_cast<std::uint8_t>(1U << d);
    }
    if (lines < 2) return all;
    return lines == 2 ? point.lines : opposite;  // where several meet, only one that goes on counts
}

Vec3 mean_beside(const LabelNet& net, Index p, std::uint8_t directions, const std::vector<Vec3>& moves) {
    Vec3 sum(0.0);
    int count = 0;
    for (unsigned d = 0; d < 6; ++d) {
        if ((directions >> d & 1) == 0) continue;
        sum += moves[net.points[p].next[d]];
        sum[static_cast<int>(d / 2)] += d % 2 == 0 ? -1 : 1;
        ++count;
    }
    return count == 0 ? moves[p] : sum / static_cast<double>(count);
}

/// What the volumes of the materials at a point change by when it moves.
struct VolumeGradients {
    struct One {
        std::uint32_t material;
        Vec3 gradient;
    };
    std::array<One, 8> all;
    std::size_t count = 0;

    void add(std::uint32_t material, const Vec3& gradient) {
        if (material == 0) return;
        for (std::size_t k = 0; k < count; ++k) {
            if (all[k].material == material) {
                all[k].gradient += gradient;
                return;
            }
        }
        all[count++] = {material, gradient};
    }
    [[nodiscard]] double largest() const {
        double most = 0;
        for (std::size_t k = 0; k < count; ++k) most = std::max(most, glm::length(all[k].gradient));
        return most;
    }
};

class VolumeKeeper {
public:
    VolumeKeeper(const LabelNet& net, std::span<const double> volumes) : net_(net), volumes_(volumes) {
        first_.assign(net.points.size() + 1, 0);
        for (const LabelNet::Quad& quad : net.quads) {
            for (const Index p : quad.points) ++first_[p + 1];
        }
        for (std::size_t p = 0; p < net.points.size(); ++p) first_[p + 1] += first_[p];
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        quads_.resize(4 * net.quads.size());
        for (std::size_t q = 0; q < net.quads.size(); ++q) {
            for (const Index p : net.quads[q].points) quads_[next[p]++] = static_cast<Index>(q);
        }
    }

    /// Moves the points; `moves` are from their middles, `places` follow.
    void correct(std::vector<Vec3>& moves, std::vector<Vec3>& places) const {
        for (int round = 0; round < kMostCorrections; ++round) {
            std::vector<double> missing = volumes_of(net_, places, volumes_.size());
            bool near = true;
            for (std::size_t m = 0; m < missing.size(); ++m) {
                missing[m] = volumes_[m] - missing[m];
                near = near && std::abs(missing[m]) <= kNearEnough * volumes_[m];
            }
            if (near) return;
            const std::vector<double> pressures = solved(places, std::move(missing));
            parallel_each(net_.points.size(), [&](std::size_t p) {
                const VolumeGradients gradients = gradients_at(p, places);
                const double scale = gradients.largest();
                if (!(scale > 0)) return;
                Vec3 move(0.0);
                for (std::size_t k = 0; k < gradients.count; ++k) {
                    move += pressures[gradients.all[k].material - 1] / scale * gradients.all[k].gradient;
                }
                moves[p] = clamped_move(moves[p] + move);
            });
            parallel_each(places.size(), [&](std::size_t p) { places[p] = net_.points[p].middle + moves[p]; });
        }
    }

private:
    [[nodiscard]] VolumeGradients gradients_at(std::size_t p, const std::vector<Vec3>& places) const {
        VolumeGradients gradients;
        for (std::size_t k = first_[p]; k < first_[p + 1]; ++k) {
            const LabelNet::Quad& quad = net_.quads[quads_[k]];
            for (const auto& t : split_quad(quad, places)) {
                if (t[0] != p && t[1] != p && t[2] != p) continue;
                constexpr double kSixth = 1.0 / 6;
                const Vec3 third = kSixth * glm::cross(places[t[1]] - places[t[0]], places[t[2]] - places[t[0]]);
                gradients.add(quad.materials[0], third);
                gradients.add(quad.materials[1], -third);
            }
        }
        return gradients;
    }

    /// The pressures that add the missing volumes.
    [[nodiscard]] std::vector<double> solved(const std::vector<Vec3>& places, std::vector<double> missing) const {
        std::map<std::pair<Index, Index>, double> entries;
        for (Index m = 0; m < missing.size(); ++m) entries[{m, m}] = 0;
        for (std::size_t p = 0; p < net_.points.size(); ++p) {
            const VolumeGradients at = gradients_at(p, places);
            const double scale = at.largest();
            if (!(scale > 0)) continue;
            for (std::size_t k = 0; k < at.count; ++k) {
                for (std::size_t j = 0; j < at.count; ++j) {
                    entries[{at.all[k].material - 1, at.all[j].material - 1}] +=
                        glm::dot(at.all[k].gradient, at.all[j].gradient) / scale;
                }
            }
        }
        SparseRows<double> matrix;
        std::vector<double> diagonal;
        for (const auto& [at, weight] : entries) {
            while (matrix.offsets.size() <= at.first) matrix.offsets.push_back(matrix.columns.size());
            matrix.columns.push_back(at.second);
            matrix.weights.push_back(weight);
            if (at.first == at.second) diagonal.push_back(weight);
        }
        matrix.offsets.push_back(matrix.columns.size());
        std::vector<double> pressures(missing.size(), 0);
        const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
            double sum = 0;
            for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
            return sum;
        };
        double first = -1;
        conjugate_gradients(
            pressures, missing,
            [&](std::vector<double>& scaled) {
                for (std::size_t m = 0; m < missing.size(); ++m) scaled[m] = diagonal[m] > 0 ? missing[m] / diagonal[m] : 0;
                return dot(scaled, missing);
            },
            [&](const std::vector<double>& direction, std::vector<double>& image) { multiply(matrix, direction, image); }, dot,
            [&](int step, double product) {
                constexpr double kEnough = 1e-12;
                if (first < 0) first = product;
                return product > kEnough * first && step < static_cast<int>(2 * missing.size() + 2);
            });
        return pressures;
    }

    const LabelNet& net_;
    std::span<const double> volumes_;
    std::vector<std::size_t> first_;  // of each point, in quads_
    std::vector<Index> quads_;
};

}  // namespace

std::array<std::array<Index, 3>, 2> split_quad(const LabelNet::Quad& quad, const std::vector<Vec3>& places) {
    const auto& q = quad.points;
    const auto length = [&](std::size_t a, std::size_t b) {
        const Vec3 diagonal = places[q[b]] - places[q[a]];
        return glm::dot(diagonal, diagonal);
    };
    if (length(1, 3) < length(0, 2)) return {{{q[0], q[1], q[3]}, {q[1], q[2], q[3]}}};
    return {{{q[0], q[1], q[2]}, {q[0], q[2], q[3]}}};
}

std::vector<double> volumes_of(const LabelNet& net, const std::vector<Vec3>& places, std::size_t materials) {
    std::vector<double> volumes(materials + 1, 0);
    const Vec3 base = places.empty() ? Vec3(0.0) : places.front();  // so that sums keep their digits far from the origin
    for (const LabelNet::Quad& quad : net.quads) {
        double sum = 0;
        for (const auto& t : split_quad(quad, places)) {
            sum += glm::dot(places[t[0]] - base, glm::cross(places[t[1]] - base, places[t[2]] - base)) / 6;
        }
        volumes[quad.materials[0]] += sum;
        volumes[quad.materials[1]] -= sum;
    }
    volumes.erase(volumes.begin());
    return volumes;
}

std::vector<Vec3> smoothed_places(const LabelNet& net, int rounds, std::span<const double> volumes, Progress* progress) {
    const std::size_t count = net.points.size();
    std::vector<std::uint8_t> directions(count);
    parallel_each(count, [&](std::size_t p) { directions[p] = directions_of(net.points[p]); });
    std::vector<Vec3> moves(count, Vec3(0.0)), next(count), places(count);
    for (int round = 0; round < rounds; ++round) {
        report_progress(progress, "smooth labels", static_cast<std::size_t>(round), static_cast<std::size_t>(rounds));
        for (const double part : {kShrink, kGrow}) {
            parallel_each(count, [&](std::size_t p) {
                const Vec3 towards = mean_beside(net, static_cast<Index>(p), directions[p], moves) - moves[p];
                next[p] = clamped_move(moves[p] + part * towards);
            });
            std::swap(moves, next);
        }
    }
    parallel_each(count, [&](std::size_t p) { places[p] = net.points[p].middle + moves[p]; });
    if (rounds > 0) VolumeKeeper(net, volumes).correct(moves, places);
    return places;
}

}  // namespace subvol::detail
