#include "value_rules.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "child_cells.h"
#include "subvol/error.h"
#include "subvol/refine.h"

namespace subvol {

namespace detail {

namespace {

constexpr std::array<int, 3> kStrides{1, 4, 16};

/// Fills in nodes outside the known ones: along an axis quadratically if the three next nodes are real, else by what the sides
/// next to it say: f(i,j) = f(i,0) + f(0,j) − f(0,0).
void extrapolate(const GridPoints& grid, double* nodes) {
    for (int outside = 1; outside <= 3; ++outside) {  // nodes beyond a side, then beyond two, then beyond three
        for (int n = 0; n < 64; ++n) {
            if (grid[static_cast<std::size_t>(n)] != kNone) continue;
            std::array<int, 3> inward{};  // steps towards the cell, 0 along axes on which the node is not outside
            int axes = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const int at = n / kStrides[a] % 4;
                inward[a] = at == 0 ? kStrides[a] : at == 3 ? -kStrides[a] : 0;
                axes += inward[a] != 0;
            }
            if (axes != outside) continue;
            double sum = 0;
            bool real = false;
            for (std::size_t a = 0; a < 3 && !real; ++a) {
                if (inward[a] == 0) continue;
                const int one = n + inward[a], two = one + inward[a], three = two + inward[a];
                const auto known = [&](int m) { return grid[static_cast<std::size_t>(m)] != kNone; };
                real = known(one) && known(two) && known(three);
                if (real) sum = 3 * nodes[one] - 3 * nodes[two] + nodes[three];
            }
            if (!real && axes == 1) {
                const int step = inward[0] + inward[1] + inward[2];
                sum = 2 * nodes[n + step] - nodes[n + 2 * step];
            } else if (!real) {
                const int corner = n + inward[0] + inward[1] + inward[2];
                for (std::size_t a = 0; a < 3; ++a) {
                    if (inward[a] != 0) sum += nodes[corner - inward[a]];
                }
                sum -= (axes - 1) * nodes[corner];
            }
            nodes[n] = sum;
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
        const Vec3 node(static_cast<double>(n % 4) - 1, static_cast<double>(n / 4 % 4) - 1, static_cast<double>(n / 16) - 1);
        const double w = kernel_value(kernel_, uvw - node);
        weights += w;
        sum += w * nodes[n];
    }
    return sum / weights;
}

}  // namespace detail

std::vector<double> values_at_new_points(const HexMesh& mesh, const Attribute& attribute, ValueRule rule,
                                         const Kernel& kernel) {
    if (attribute.channels != 1)
        throw Error(ErrorCode::InvalidInput, "the attribute " + attribute.name + " has several channels");
    HexMesh bare{mesh.points, mesh.cells, {attribute}, mesh.creases, mesh.sharp_faces};
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
    // Every cell writes its own point and those of the edges and faces that no smaller cell has.
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
                const Vec3 uvw(.5 * static_cast<double>(n % 3), .5 * static_cast<double>(n / 3 % 3),
                               .5 * static_cast<double>(n / 9));
                if (mine) values[p - old] = in_cell.value(0, uvw);
            }
        }
    });
    return values;
}

}  // namespace subvol
