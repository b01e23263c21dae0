// SPDX-License-Identifier: Apache-2.0
#include "comparison.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kCompared = 8192;

}  // namespace

Comparison comparison_in_data(const DataField& data, SampleFinder& finder, Progress* progress) {
    Comparison made;
    const std::vector<LimitQuery> all = data.spread(kCompared);
    const ProbeResult found = finder.at(data.positions(all), progress);
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (!found.inside(k) || found.distances[k] > 0) continue;
        made.places.push_back({found.cells[k], found.parameters[k]});
        made.in_data.push_back(all[k]);
    }
    return made;
}

Comparison comparison_with_samples(const HexMesh& mesh, const Topology& topology, const Located& located,
                                   const SchemeOptions& scheme) {
    std::vector<std::vector<Index>> in_cell(topology.cells.size()), cells_at(topology.point_count);
    for (std::size_t k = 0; k < located.places.size(); ++k) in_cell[located.places[k].cell].push_back(static_cast<Index>(k));
    for (Index c = 0; c < topology.cells.size(); ++c) {
        for (const Index p : topology.cells[c]) cells_at[p].push_back(c);
    }
    const std::vector<LimitQuery> all = spread_places(topology.cells.size(), kCompared);
    const std::vector<Vec3> positions = limit_at(mesh, all, {.scheme = scheme}).positions;
    std::vector<Index> nearest(all.size(), kNone);
    parallel_each(all.size(), [&](std::size_t k) {
        double least = INFINITY;
        const auto look_in = [&](Index cell) {
            for (const Index s : in_cell[cell]) {
                const double distance = glm::distance(positions[k], located.positions[s]);
                if (distance < least) {
                    least = distance;
                    nearest[k] = s;
                }
            }
        };
        constexpr std::size_t kEnough = 64;  // in the cell itself
        look_in(all[k].cell);
        if (in_cell[all[k].cell].size() >= kEnough) return;
        for (const Index p : topology.cells[all[k].cell]) {
            for (const Index c : cells_at[p]) look_in(c);
        }
    });
    Comparison made;
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (nearest[k] == kNone) continue;
        made.places.push_back(all[k]);
        made.nearest.push_back(nearest[k]);
    }
    return made;
}

std::vector<LimitQuery> places_of_extremes(const Topology& topology, const Attribute& field) {
    const auto channels = static_cast<std::size_t>(field.channels);
    std::vector<std::uint8_t> chosen(topology.cells.size(), 0);
    std::vector<Index> order(topology.cells.size());
    std::iota(order.begin(), order.end(), Index{0});
    for (std::size_t c = 0; c < channels; ++c) {
        for (const double sign : {1.0, -1.0}) {
            std::vector<double> most(order.size());
            parallel_each(most.size(), [&](std::size_t cell) {
                most[cell] = -INFINITY;
                for (const Index p : topology.cells[cell])
                    most[cell] = std::max(most[cell], sign * field.values[p * channels + c]);
            });
            constexpr std::size_t kCells = 16;
            const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(kCells, order.size()));
            std::ranges::partial_sort(order, end, {}, [&](Index cell) { return std::pair(-most[cell], cell); });
            for (auto cell = order.begin(); cell != end; ++cell) chosen[*cell] = 1;
        }
    }
    std::vector<LimitQuery> places;
    constexpr int kSide = 5;
    for (Index cell = 0; cell < chosen.size(); ++cell) {
        for (int i = 0; chosen[cell] != 0 && i < kSide * kSide * kSide; ++i)
            places.push_back({cell, Vec3(i % kSide, i / kSide % kSide, i / (kSide * kSide)) / double(kSide - 1)});
    }
    return places;
}

}  // namespace subvol::detail
