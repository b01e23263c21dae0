// SPDX-License-Identifier: Apache-2.0
#include "value_rules.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "subvol/detail/child_topology.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/refine.h"

namespace subvol {

namespace detail {

namespace {

constexpr std::array<int, 3> kStrides{1, 4, 16};

/// A node of the 4×4×4 grid about a cell: its step towards the cell along each axis, 0 where it is not beyond the cell, and the
/// number of axes along which it is.
struct OuterNode {
    std::array<int, 3> inward{};
    int axes = 0;

    explicit OuterNode(int node) {
        for (std::size_t a = 0; a < 3; ++a) {
            const int at = node / kStrides[a] % 4;
            inward[a] = at == 0 ? kStrides[a] : at == 3 ? -kStrides[a] : 0;
            axes += inward[a] != 0;
        }
    }
};

/// Extrapolates quadratically to nodes that have three known ones next to them along an axis, and from there to further ones.
void continue_lines(std::array<bool, 64>& known, double* nodes) {
    for (int sweep = 0; sweep < 3; ++sweep) {  // beyond one side of a box, beyond two, beyond three
        const std::array<bool, 64> before = known;
        for (int n = 0; n < 64; ++n) {
            const auto has = [&](int m) { return before[static_cast<std::size_t>(m)]; };
            const OuterNode outer(n);
            for (std::size_t a = 0; a < 3 && !known[static_cast<std::size_t>(n)]; ++a) {
                const int one = n + outer.inward[a], two = one + outer.inward[a], three = two + outer.inward[a];
                if (outer.inward[a] == 0 || !has(one) || !has(two) || !has(three)) continue;
                nodes[n] = 3 * nodes[one] - 3 * nodes[two] + nodes[three];
                known[static_cast<std::size_t>(n)] = true;
            }
        }
    }
}

/// Fills in the nodes that are not points of the mesh: quadratically along lines where possible; else linearly beyond one side
/// of the cell, and beyond two or three from the values beyond each of them: f(i,j) = f(i,0) + f(0,j) − f(0,0).
void extrapolate(const GridPoints& grid, double* nodes) {
    std::array<bool, 64> known;
    for (std::size_t n = 0; n < 64; ++n) known[n] = grid[n] != kNone;
    continue_lines(known, nodes);
    for (int axes = 1; axes <= 3; ++axes) {
        for (int n = 0; n < 64; ++n) {
            const OuterNode outer(n);
            if (known[static_cast<std::size_t>(n)] || outer.axes != axes) continue;
            const int corner = n + outer.inward[0] + outer.inward[1] + outer.inward[2];
            if (axes == 1) {
                nodes[n] = 2 * nodes[corner] - nodes[2 * corner - n];
                continue;
            }
            nodes[n] = -(axes - 1) * nodes[corner];
            for (std::size_t a = 0; a < 3; ++a) {
                if (outer.inward[a] != 0) nodes[n] += nodes[corner - outer.inward[a]];
            }
        }
    }
}

/// Catmull-Rom weights of the nodes −1, 0, 1, 2 at t in [0,1].
std::array<double, 4> catmull_rom(double t) {
    return {t * (-.5 + t * (1 - .5 * t)), 1 + t * t * (-2.5 + 1.5 * t), t * (.5 + t * (2 - 1.5 * t)), t * t * (-.5 + .5 * t)};
}

}  // namespace

std::vector<ChannelView> channels_of(const HexMesh& mesh) {
    std::vector<ChannelView> channels;
    for (const auto& attribute : mesh.attributes) {
        for (int c = 0; c < attribute.channels; ++c)
            channels.push_back({attribute.values.data() + c, static_cast<std::size_t>(attribute.channels)});
    }
    return channels;
}

void RuleInCell::enter(Index cell) {
    if (cell == cell_) return;
    cell_ = cell;
    if (!regular_grid(topology_, cell, grid_)) cross_grid(topology_, cell, grid_);
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        double* nodes = &nodes_[64 * c];
        for (std::size_t n = 0; n < 64; ++n) nodes[n] = grid_[n] == kNone ? 0 : channels_[c].at(grid_[n]);
        if (rule_ == ValueRule::Cubic) extrapolate(grid_, nodes);
    }
}

double RuleInCell::value(std::size_t channel, const Vec3& uvw) const {
    const double* nodes = &nodes_[64 * channel];
    return rule_ == ValueRule::Cubic ? cubic(nodes, uvw) : weighted_mean(nodes, uvw);
}

double RuleInCell::cubic(const double* nodes, const Vec3& uvw) const {
    const auto u = catmull_rom(uvw.x), v = catmull_rom(uvw.y), w = catmull_rom(uvw.z);
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t j = 0; j < 4; ++j) {
            const double across = w[k] * v[j];
            if (across == 0) continue;
            const double* row = nodes + 4 * j + 16 * k;
            sum += across * (u[0] * row[0] + u[1] * row[1] + u[2] * row[2] + u[3] * row[3]);
        }
    }
    return sum;
}

double RuleInCell::weighted_mean(const double* nodes, const Vec3& uvw) const {
    double weights = 0, sum = 0;
    for (std::size_t n = 0; n < 64; ++n) {
        if (grid_[n] == kNone) continue;
        const std::size_t x = n % 4, y = n / 4 % 4, z = n / 16;
        const Vec3 node = Vec3(x, y, z) - 1.0;
        const double w = kernel_value(kernel_, uvw - node);
        weights += w;
        sum += w * nodes[n];
    }
    if (!(weights > 0)) {
        throw Error(ErrorCode::InvalidInput,
                    "the weights of the kernel for values do not add up to a positive number at a place in cell " +
                        std::to_string(cell_) + "; its radius is " + number_text(support_radius(kernel_)) + " cells",
                    {}, "a kernel that is positive out to 0.87 cells, half a cell's diagonal");
    }
    return sum / weights;
}

}  // namespace detail

std::vector<double> values_at_new_points(const HexMesh& mesh, std::string_view field, ValueRule rule, const Kernel& kernel) {
    const HexMesh bare = with_scalar_field(mesh, field);
    const std::size_t old = mesh.points.size();
    if (rule == ValueRule::Scheme) {
        const auto all = refine(bare).attributes.front().values;
        return {all.begin() + static_cast<std::ptrdiff_t>(old), all.end()};
    }
    validate(bare);
    const Topology topology = build_topology(bare);
    const detail::ChildNumbering first(topology);
    const auto channels = detail::channels_of(bare);
    std::vector<double> values(first.end - old);
    // Every cell writes its own point, and those of its edges and faces that no cell with a smaller number has.
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, topology.cells.size(), 256), [&](const auto& range) {
        detail::RuleInCell in_cell(topology, channels, rule, kernel);
        for (std::size_t c = range.begin(); c != range.end(); ++c) {
            const auto cell = static_cast<Index>(c);
            in_cell.enter(cell);
            const auto points = detail::lattice_points(topology, cell);
            for (std::size_t n = 0; n < points.size(); ++n) {
                const Index p = points[n];
                if (p < first.edges) continue;
                const bool mine =
                    p >= first.cells || (p >= first.faces ? topology.face_cells[p - first.faces][0] == cell
                                                          : std::ranges::min(topology.edge_cells[p - first.edges]) == cell);
                const std::size_t x = n % 3, y = n / 3 % 3, z = n / 9;
                if (mine) values[p - old] = in_cell.value(0, .5 * Vec3(x, y, z));
            }
        }
    });
    return values;
}

}  // namespace subvol
