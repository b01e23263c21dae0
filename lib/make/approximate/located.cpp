// SPDX-License-Identifier: Apache-2.0
#include "located.h"

#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/parallel_sums.h"
#include "subvol/error.h"
#include "subvol/refine.h"

namespace subvol::detail {

namespace {

using Vector = std::vector<double>;

/// How well the samples decide a control value: the sum of the squares of its trilinear weights in them.
Vector support_of(const Topology& topology, const std::vector<LimitQuery>& places) {
    return parallel_sums(topology.point_count, places.size(), [&](std::size_t k, Vector& sums) {
        const auto& cell = topology.cells[places[k].cell];
        const Vec3& at = places[k].uvw;
        for (std::size_t c = 0; c < 8; ++c) {
            double weight = 1;
            for (std::size_t a = 0; a < 3; ++a) {
                const double t = at[static_cast<int>(a)];
                weight *= kCornerParameters[c][a] != 0 ? t : 1 - t;
            }
            sums[cell[c]] += weight * weight;
        }
    });
}

Located locate(const ProbeResult& found, std::span<const Vec3> positions) {
    Located located;
    for (std::size_t p = 0; p < positions.size(); ++p) {
        if (!found.inside(p)) {
            ++located.outside;
            continue;
        }
        if (found.distances[p] > 0) ++located.snapped;
        located.places.push_back({found.cells[p], found.parameters[p]});
        located.positions.push_back(positions[p]);
        located.is_snapped.push_back(found.distances[p] > 0 ? 1 : 0);
        located.samples.push_back(static_cast<Index>(p));
    }
    return located;
}

/// A flag for each cell: whether a field between the data's points is to be sampled in it, too: the cells about it have few
/// samples, or they hardly decide a value at its corners. Points of a mesh with cells of half the size are eight a cell.
std::vector<std::uint8_t> cells_with_few(const Topology& topology, const std::vector<LimitQuery>& places) {
    constexpr double kFewSamples = 4;
    const Support support(topology, places);
    Vector in_cell(topology.cells.size(), 0), at_point(topology.point_count, 0), cells_at(topology.point_count, 0);
    for (const LimitQuery& place : places) in_cell[place.cell] += 1;
    for (std::size_t c = 0; c < in_cell.size(); ++c) {
        for (const Index p : topology.cells[c]) {
            at_point[p] += in_cell[c];
            cells_at[p] += 1;
        }
    }
    std::vector<std::uint8_t> few(in_cell.size());
    parallel_each(few.size(), [&](std::size_t c) {
        double samples = 0, cells = 0;
        bool poor = false;
        for (const Index p : topology.cells[c]) {
            samples += at_point[p];
            cells += cells_at[p];
            poor |= support.is_poor(p);
        }
        few[c] = poor || samples < kFewSamples * cells ? 1 : 0;
    });
    return few;
}

/// Adds places where samples are few: the points of level 1 of the limit, if they lie in cells of the data.
void add_between(const HexMesh& mesh, const Topology& topology, const DataField& data, const ApproximateOptions& options,
                 Located& located) {
    if (!data.has_cells()) return;
    const std::vector<std::uint8_t> few = cells_with_few(topology, located.places);
    if (std::ranges::count(few, 1) == 0) return;
    const HexMesh fine = on_limit(refine(mesh, {.scheme = options.scheme, .levels = 1}), options.scheme.kind);
    std::vector<std::uint8_t> taken(fine.points.size(), 0);
    std::vector<LimitQuery> places;
    std::vector<Vec3> positions;
    for (Index c = 0; c < few.size(); ++c) {
        for (std::size_t child = 0; few[c] != 0 && child < 8; ++child) {
            for (std::size_t k = 0; k < 8; ++k) {
                const Index point = fine.cells[8 * c + child][k];
                if (taken[point] != 0) continue;
                taken[point] = 1;
                const auto &lower = kCornerParameters[child], &at = kCornerParameters[k];
                places.push_back({c, Vec3(lower[0] + at[0], lower[1] + at[1], lower[2] + at[2]) / 2.0});
                positions.push_back(fine.points[point]);
            }
        }
    }
    const std::vector<LimitQuery> in_data = data.find(positions, options.progress);
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (in_data[k].cell == kNone) continue;
        located.places.push_back(places[k]);
        located.positions.push_back(positions[k]);
        located.is_snapped.push_back(0);
        located.between.push_back(in_data[k]);
    }
}

}  // namespace

Support::Support(const Topology& topology, const std::vector<LimitQuery>& places) : of_points(support_of(topology, places)) {
    Vector some = of_points;
    std::erase(some, 0.0);
    if (some.empty()) return;
    const auto middle = some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2);
    std::ranges::nth_element(some, middle);
    usual = *middle;
}

Located located_samples(const HexMesh& mesh, const Topology& topology, const DataField& data, const ApproximateOptions& options,
                        SampleFinder& finder) {
    const std::vector<Vec3>& positions = data.mesh().points;
    Located located = locate(finder.at(positions, options.progress), positions);
    add_between(mesh, topology, data, options, located);
    if (located.places.empty()) {
        throw Error(ErrorCode::InvalidInput, "none of the samples lies in the limit of the mesh", "samples",
                    "places in the box of the mesh");
    }
    return located;
}

}  // namespace subvol::detail
