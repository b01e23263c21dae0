// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/fold_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include "subvol/limit.h"

namespace subvol::detail {

namespace {

/// Place k of a sequence of low discrepancy in [0,1)³.
///
/// source: [roberts2018]
Vec3 spread(std::size_t k) {
    constexpr double kU = 0.8191725133961645, kV = 0.6710436067037893, kW = 0.5497004779019703;  // 1/g, g⁴ = g + 1
    const Vec3 at = 0.5 + (static_cast<double>(k) + 1) * Vec3(kU, kV, kW);
    return at - glm::floor(at);
}

/// Corners, middles of edges and of sides, the middle of the cell, the same places an eighth of the cell away from corners and
/// edges, which may be irregular, and places between them.
std::vector<Vec3> first_places() {
    std::vector<Vec3> places;
    for (int i = 0; i < 27; ++i) places.push_back(0.5 * Vec3(i % 3, i / 3 % 3, i / 9));
    for (std::size_t k = 0; k < 27; ++k) {
        const Vec3 at = places[k];
        const auto middles = std::ranges::count(std::array{at.x, at.y, at.z}, 0.5);
        if (middles <= 1) places.push_back(0.5 + 0.75 * (at - 0.5));
    }
    constexpr std::size_t kBetween = 101;
    for (std::size_t k = 0; k < kBetween; ++k) places.push_back(spread(k));
    return places;
}

/// Places of a cell from which smaller determinants are looked for: of the first, for the smallest determinant, and of others
/// that are apart, for the smallest one beside the lengths of the derivatives. A cell that is thin at one place may fold at
/// another.
struct Seeds {
    std::array<Vec3, 4> uvw{};
    std::array<double, 4> least{};
};

/// det / |∂x/∂u| |∂x/∂v| |∂x/∂w|, −1 to 1; 0 where a derivative is 0 or the product is no number.
double shape_of(const Mat3& jacobian, double determinant) {
    const double lengths = glm::length(jacobian[0]) * glm::length(jacobian[1]) * glm::length(jacobian[2]);
    const double shape = determinant / lengths;
    return std::isfinite(shape) ? shape : 0;
}

/// determinants, shapes: at the places
Seeds seeds_of(std::span<const Vec3> places, std::span<const double> determinants, std::span<const double> shapes) {
    Seeds seeds;
    const auto least = static_cast<std::size_t>(std::ranges::min_element(determinants) - determinants.begin());
    seeds.uvw[0] = places[least];
    seeds.least[0] = determinants[least];
    std::vector<std::size_t> order(places.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::less<>(), [&](std::size_t n) { return shapes[n]; });
    constexpr double kApart = 0.25;
    std::size_t count = 1;
    for (const std::size_t n : order) {
        const auto near = [&](std::size_t k) { return glm::distance(seeds.uvw[k], places[n]) < kApart; };
        bool apart = true;
        for (std::size_t k = 1; k < count; ++k) apart = apart && !near(k);
        if (!apart) continue;
        seeds.uvw[count] = places[n];
        seeds.least[count] = shapes[n];
        if (++count == seeds.uvw.size()) break;
    }
    return seeds;
}

}  // namespace

std::vector<CellSamples> sample_folds(const HexMesh& mesh, std::span<const Index> cells, const SchemeOptions& scheme,
                                      Progress* progress) {
    std::vector<CellSamples> found(cells.size());
    std::vector<Seeds> seeds(cells.size());
    if (cells.empty()) return found;
    constexpr double kTolerance = 1e-6, kFine = 1e-9;
    const LimitEvaluator limit(mesh, {.scheme = scheme, .tolerance = kTolerance});
    std::optional<LimitEvaluator> fine;  // where it is needed
    const std::vector<Vec3> first = first_places();
    constexpr std::size_t kNear = 16, kTogether = std::size_t{1} << 12;  // places, cells
    constexpr std::array<double, 4> kRadii{1, 0.25, 0.06, 0.015};
    for (std::size_t begin = 0; begin < cells.size(); begin += kTogether) {
        const std::size_t end = std::min(cells.size(), begin + kTogether);
        for (std::size_t round = 0; round < kRadii.size(); ++round) {
            report_progress(progress, "sample", begin * kRadii.size() + round * (end - begin), cells.size() * kRadii.size());
            const std::size_t each = round == 0 ? first.size() : seeds[0].uvw.size() * kNear;
            std::vector<LimitQuery> queries;
            queries.reserve(each * (end - begin));
            for (std::size_t k = begin; k < end; ++k) {
                for (std::size_t n = 0; n < each; ++n) {
                    const Vec3 near =
                        seeds[k].uvw[n / kNear % seeds[k].uvw.size()] + kRadii[round] * (2.0 * spread(n % kNear) - 1.0);
                    queries.push_back({cells[k], round == 0 ? first[n] : glm::clamp(near, Vec3(0.0), Vec3(1.0))});
                }
            }
            LimitSamples at = limit.at(queries);
            std::vector<double> determinants;
            determinants.reserve(queries.size());
            for (const Mat3& jacobian : at.jacobians) determinants.push_back(glm::determinant(jacobian));
            std::vector<LimitQuery> doubted;
            std::vector<std::size_t> numbers;
            for (std::size_t n = 0; n < queries.size(); ++n) {
                if (determinants[n] >= 0) continue;
                doubted.push_back(queries[n]);
                numbers.push_back(n);
            }
            if (!doubted.empty() && !fine) fine.emplace(mesh, LimitOptions{.scheme = scheme, .tolerance = kFine});
            const LimitSamples again = doubted.empty() ? LimitSamples{} : fine->at(doubted);
            for (std::size_t n = 0; n < numbers.size(); ++n) {
                determinants[numbers[n]] = std::max(determinants[numbers[n]], glm::determinant(again.jacobians[n]));
                at.positions[numbers[n]] = again.positions[n];
            }
            std::vector<double> shapes(queries.size());
            for (std::size_t n = 0; n < queries.size(); ++n) shapes[n] = shape_of(at.jacobians[n], determinants[n]);
            for (std::size_t k = begin; k < end && round == 0; ++k) {
                const std::size_t from = (k - begin) * each;
                seeds[k] = seeds_of(first, std::span(determinants).subspan(from, each), std::span(shapes).subspan(from, each));
            }
            for (std::size_t n = 0; n < queries.size(); ++n) {
                CellSamples& cell = found[begin + n / each];
                const double determinant = determinants[n];
                if (round > 0) {
                    Seeds& near = seeds[begin + n / each];
                    const std::size_t seed = n % each / kNear;
                    const double value = seed == 0 ? determinant : shapes[n];
                    if (value < near.least[seed]) {
                        near.least[seed] = value;
                        near.uvw[seed] = queries[n].uvw;
                    }
                }
                if (cell.places == 0 || determinant < cell.least.determinant) {
                    cell.least = {queries[n].cell, queries[n].uvw, at.positions[n], determinant, true};
                }
                ++cell.places;
                cell.size += std::abs(determinant);
            }
        }
    }
    return found;
}

}  // namespace subvol::detail
