#include "sample_counts.h"

#include <algorithm>
#include <cmath>

#include "corner_parameters.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr int kMostIntervals = 1024;  // a cell of 10⁹ points is a wrong unit, not a wish

int intervals(double length, const SampleOptions& options) {
    if (options.spacing_world <= 0) return options.per_edge;
    const double wanted = std::ceil(length / options.spacing_world);
    if (wanted > kMostIntervals) {
        throw Error(ErrorCode::InvalidInput,
                    "a spacing of " + std::to_string(options.spacing_world) + " puts " + std::to_string(wanted) +
                        " samples on an edge of length " + std::to_string(length),
                    {}, "at most " + std::to_string(kMostIntervals));
    }
    return std::max(1, static_cast<int>(wanted));
}

}  // namespace

SampleCounts::SampleCounts(const HexMesh& mesh, const Topology& topology, const SampleOptions& options) : topology_(topology) {
    edges_.reserve(topology.edges.size());
    for (const auto& [a, b] : topology.edges)
        edges_.push_back(intervals(glm::distance(mesh.points[a], mesh.points[b]), options));
}

std::array<int, 2> SampleCounts::face(std::size_t f) const {
    const auto& e = topology_.face_edges[f];
    return {std::max(edges_[e[0]], edges_[e[2]]), std::max(edges_[e[1]], edges_[e[3]])};
}

std::array<int, 3> SampleCounts::cell(std::size_t c) const {
    const std::array<double, 3> inside{0.5, 0.5, 0.5};
    return {near(c, 0, inside), near(c, 1, inside), near(c, 2, inside)};
}

int SampleCounts::near(std::size_t c, std::size_t axis, const std::array<double, 3>& uvw) const {
    int most = 1;
    for (std::size_t k = 4 * axis; k < 4 * axis + 4; ++k) {
        const auto& corner = kCornerParameters[static_cast<std::size_t>(kCellEdges[k][0])];
        bool bounds_entity = true;
        for (const std::size_t other : {(axis + 1) % 3, (axis + 2) % 3}) {
            const bool on_side = uvw[other] == 0 || uvw[other] == 1;
            bounds_entity &= !on_side || uvw[other] == corner[other];
        }
        if (bounds_entity) most = std::max(most, edges_[topology_.cell_edges[c][k]]);
    }
    return most;
}

}  // namespace subvol::detail
