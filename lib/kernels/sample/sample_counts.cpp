// SPDX-License-Identifier: Apache-2.0
#include "sample_ways.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "subvol/camera.h"
#include "subvol/cell.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr int kMostIntervals = 1024;  // a cell of 10⁹ points is more likely a wrong unit

int intervals(double length, double spacing, const char* unit) {
    const double wanted = std::ceil(length / spacing);
    if (!(wanted <= kMostIntervals)) {
        throw Error(ErrorCode::InvalidInput,
                    "a spacing of " + number_text(spacing) + unit + " puts " + number_text(wanted) +
                        " samples on an edge of length " + number_text(length) + unit,
                    {}, "at most " + std::to_string(kMostIntervals));
    }
    return std::max(1, static_cast<int>(wanted));
}

/// Lengths in pixels for the footprint rule; never smaller than what is seen.
class Projection {
public:
    Projection(const Footprint& footprint, double diagonal_world)
        : footprint_(footprint),
          view_(footprint.camera, footprint.width_px, footprint.height_px),
          nearest_(kNearest * diagonal_world),
          slant_(std::sqrt(1 + glm::dot(view_.slopes(0, 0), view_.slopes(0, 0)))) {}

    /// The most pixels that a length at `depth` can cover: perpendicular to the ray through a corner of the picture.
    [[nodiscard]] double pixels(double length, double depth) const {
        return view_.perspective() ? length * slant_ / (view_.pixel() * std::max(depth, nearest_)) : length / view_.pixel();
    }
    [[nodiscard]] double depth(const Vec3& x) const { return view_.to_eye(x).z; }

    /// Whether a cell gets more than one interval: its projected box is large enough and meets the picture.
    [[nodiscard]] bool counts(const HexMesh& mesh, const std::array<Index, 8>& cell) const {
        Vec2 low(std::numeric_limits<double>::infinity()), high(-low);
        double front = low.x, back = high.x;
        for (const Index p : cell) {
            Vec3 eye = view_.to_eye(mesh.points[p]);
            front = std::min(front, eye.z);
            back = std::max(back, eye.z);
            eye.z = std::max(eye.z, nearest_);
            const Vec2 at = view_.to_pixels(eye);
            low = glm::min(low, at);
            high = glm::max(high, at);
        }
        if (view_.perspective() && back < nearest_) return false;  // behind the eye
        if (view_.perspective() && front < nearest_) return true;  // around the eye
        if (high.x < 0 || high.y < 0 || low.x > view_.width() || low.y > view_.height()) return false;
        return std::max(high.x - low.x, high.y - low.y) > footprint_.least_cell_px;
    }

private:
    static constexpr double kNearest = 1e-3;  // the least depth, of the diagonal of the mesh's box

    const Footprint& footprint_;
    View view_;
    double nearest_, slant_;
};

std::vector<int> seen_intervals(const HexMesh& mesh, const Topology& topology, const Footprint& footprint) {
    const Projection projection(footprint, bounds(mesh).diagonal());
    std::vector<int> edges(topology.edges.size(), 1);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto cells = topology.edge_cells[e];
        const auto counts = [&](Index c) { return projection.counts(mesh, topology.cells[c]); };
        if (std::none_of(cells.begin(), cells.end(), counts)) continue;
        const Vec3 &a = mesh.points[topology.edges[e][0]], &b = mesh.points[topology.edges[e][1]];
        const double length_px = projection.pixels(glm::distance(a, b), std::min(projection.depth(a), projection.depth(b)));
        edges[e] = intervals(length_px, footprint.spacing_px, " px");
    }
    return edges;
}

}  // namespace

std::vector<int> edge_intervals(const HexMesh& mesh, const Topology& topology, const SampleOptions& options) {
    if (options.footprint) return seen_intervals(mesh, topology, *options.footprint);
    std::vector<int> edges(topology.edges.size(), options.per_edge);
    for (std::size_t e = 0; options.spacing_world > 0 && e < edges.size(); ++e) {
        const auto [a, b] = topology.edges[e];
        edges[e] = intervals(glm::distance(mesh.points[a], mesh.points[b]), options.spacing_world, "");
    }
    return edges;
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
        const auto& corner = kCornerParameters[kCellEdges[k][0]];
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
