// SPDX-License-Identifier: Apache-2.0
// Kernels at any number of intervals on each edge. Vertices, edges, faces and cells are sampled one after the other, so that a
// point shared by several cells gets one kernel.
//
//    ●───○───○───●     a face with 3 intervals along u and 2 along v:
//    │   │   │   │     ● at vertices
//    ○───□───□───○     ○ on edges: n − 1 points each
//    │   │   │   │     □ on the face: (n_u − 1)(n_v − 1) points; in a cell (n_u − 1)(n_v − 1)(n_w − 1)
//    ●───○───○───●
//
// Every cell about a point gives position and field there with their derivatives along u, v and w, per sample interval: by
// quartics through the 5×5×5 points of the cell's second level (cell_block.h). Positions and values of neighbouring cells
// agree; their derivatives and intervals need not. One kernel follows from all of them (docs/adr/0004, docs/adr/0009):
//
// With `centers` there is one more point in the middle of each small cell, and the interval is the edge of a cube that holds
// one point.
//
//    frame       S = R² mean Σ J_a J_aᵀ, J_a the derivative of the position along axis a
//    gradient    the least-squares solution g of J_aᵀ g = ∂_a f
//    moment      R²/6 mean Σ (∂²_a f − g·∂²_a x)
//    Hessian     mean J⁻ᵀ (∂²f − g·∂²x) J⁻¹, less the part that the moment has
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "cell_block.h"
#include "direction_sums.h"
#include "sample_ways.h"
#include "subvol/cell.h"
#include "subvol/detail/boundary_rings.h"
#include "subvol/detail/bucket_sort.h"
#include "value_rules.h"

namespace subvol::detail {

namespace {

constexpr double kCenteredInterval = 0.79370052598409973738;  // ∛½: two points for each small cell

Buckets<std::pair<Index, Index>> cells_of_points(const Topology& topology) {
    return bucket_sort<std::pair<Index, Index>>(
        topology.cells.size(), topology.point_count,
        [&](std::size_t c, const auto& sink) {
            for (const Index p : topology.cells[c]) sink({p, static_cast<Index>(c)});
        },
        [](const auto& record) { return record.first; });
}

/// The parameters, in one of the cells about it, of a point on an edge or face.
///
/// origin, ends: the entity's first corner and that corner's neighbours along it; parameters: of the point between them
template <std::size_t N>
std::array<double, 3> in_cell(const std::array<Index, 8>& cell, Index origin, const std::array<Index, N>& ends,
                              const std::array<double, N>& parameters) {
    const auto& o = kCornerParameters[slot_of(cell, origin)];
    std::array<double, 3> uvw{double(o[0]), double(o[1]), double(o[2])};
    for (std::size_t n = 0; n < N; ++n) {
        const auto& e = kCornerParameters[slot_of(cell, ends[n])];
        for (std::size_t a = 0; a < 3; ++a) uvw[a] += parameters[n] * (e[a] - o[a]);
    }
    return uvw;
}

/// Writes one kernel after the other, each from the jets of the cells about its point.
class KernelWriter {
public:
    KernelWriter(const Topology& topology, const SampleCounts& counts, const CellBlocks& blocks,
                 std::span<const ChannelView> control, const SampleOptions& options, double diagonal, RbfVolume& volume)
        : counts_(counts),
          blocks_(blocks),
          options_(options),
          volume_(volume),
          sums_(options, diagonal, volume),
          rule_(topology, control, options.values, options.value_kernel),
          d_(blocks.channels()),
          dd_(blocks.channels()) {}

    void begin(std::size_t point) {
        point_ = point;
        cells_ = 0;
        sums_.begin(point);
    }

    void add_cell(std::size_t cell, const std::array<double, 3>& uvw) {
        std::array<double, 3> step{1.0 / counts_.near(cell, 0, uvw), 1.0 / counts_.near(cell, 1, uvw),
                                   1.0 / counts_.near(cell, 2, uvw)};
        if (options_.centers) {
            for (double& s : step) s /= 2;  // from a centre a whole interval would reach out of the cell
        }
        const double* nodes = blocks_.nodes(cell);
        blocks_.evaluate(nodes, uvw, step, jet_);
        if (cells_++ == 0) {
            volume_.centers[point_] = jet_.position;
            write_values(static_cast<Index>(cell), uvw);
        }
        for (std::size_t a = 0; a < 3; ++a) {
            if (options_.centers) stretch(a, 2 * kCenteredInterval);
            for (std::size_t c = 0; c < jet_.value.size(); ++c) {
                d_[c] = jet_.d_value[c][a];
                dd_[c] = jet_.dd_value[c][a];
            }
            sums_.add(1, jet_.d_position[a], jet_.dd_position[a], d_.data(), dd_.data());
        }
        if (options_.correction != Correction::Full) return;
        if (options_.centers) {
            for (double& s : step) s *= 2 * kCenteredInterval;
        }
        blocks_.evaluate_mixed(nodes, uvw, step, jet_);
        jets_.push_back(jet_);
    }

    /// Returns whether the frame was flat and had to be thickened.
    bool finish() {
        const bool flat = sums_.finish(cells_);
        for (std::size_t c = 0; c < volume_.channels.size() && options_.correction == Correction::Full; ++c) {
            auto& channel = volume_.channels[c];
            if (flat) {
                channel.hessians[point_] = {};
                continue;
            }
            const auto& g = channel.gradients[point_];
            Mat3 mean(0.0);
            for (const auto& jet : jets_) mean += hessian_in(jet, c, {g[0], g[1], g[2]}) / double(cells_);
            channel.hessians[point_] = without_moment(mean, volume_.frames[point_]);
        }
        jets_.clear();
        return flat;
    }

private:
    /// Derivatives along an axis per another interval.
    void stretch(std::size_t axis, double factor) {
        jet_.d_position[axis] *= factor;
        jet_.dd_position[axis] *= factor * factor;
        for (std::size_t c = 0; c < jet_.value.size(); ++c) {
            jet_.d_value[c][axis] *= factor;
            jet_.dd_value[c][axis] *= factor * factor;
        }
    }

    /// J⁻ᵀ (∂²f − g·∂²x) J⁻¹; 0 where the cell is flat.
    [[nodiscard]] static Mat3 hessian_in(const CellBlocks::Jet& jet, std::size_t channel, const Vec3& g) {
        const Mat3 jacobian(jet.d_position[0], jet.d_position[1], jet.d_position[2]);
        const double size = glm::length(jacobian[0]) * glm::length(jacobian[1]) * glm::length(jacobian[2]);
        if (!(std::abs(glm::determinant(jacobian)) > 1e-6 * size)) return Mat3(0.0);
        Mat3 second;
        for (int a = 0; a < 3; ++a) {
            const auto n = static_cast<std::size_t>(a);
            second[a][a] = jet.dd_value[channel][n] - glm::dot(g, jet.dd_position[n]);
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            second[b][c] = second[c][b] = jet.mixed_value[channel][n] - glm::dot(g, jet.mixed_position[n]);
        }
        const Mat3 inverse = glm::inverse(jacobian);
        return glm::transpose(inverse) * second * inverse;
    }

    /// Control points keep their values under every rule.
    void write_values(Index cell, const std::array<double, 3>& uvw) {
        const auto at_end = [](double t) { return t == 0 || t == 1; };
        const bool by_rule = options_.values != ValueRule::Scheme && !std::all_of(uvw.begin(), uvw.end(), at_end);
        if (by_rule) rule_.enter(cell);
        for (std::size_t c = 0; c < jet_.value.size(); ++c) {
            const double value = by_rule ? rule_.value(c, {uvw[0], uvw[1], uvw[2]}) : jet_.value[c];
            volume_.channels[c].values[point_] = static_cast<float>(value);
        }
    }

    const SampleCounts& counts_;
    const CellBlocks& blocks_;
    const SampleOptions& options_;
    RbfVolume& volume_;
    DirectionSums sums_;
    RuleInCell rule_;
    CellBlocks::Jet jet_;
    std::size_t point_ = 0;
    int cells_ = 0;
    std::vector<double> d_, dd_;
    std::vector<CellBlocks::Jet> jets_;  // of the cells about the point
};

/// Samples all entities of a mesh.
class Sampler {
public:
    Sampler(const HexMesh& mesh, const CellBlocks& blocks, const Topology& topology, std::vector<int> intervals,
            const SampleOptions& options)
        : options_(options),
          topology_(topology),
          counts_(topology, std::move(intervals)),
          blocks_(blocks),
          control_(channels_of(mesh)),
          point_cells_(cells_of_points(topology_)),
          diagonal_(bounds(mesh).diagonal()) {}

    SampleResult run(const HexMesh& mesh) {
        const auto first_edge = prefix(topology_.point_count, topology_.edges.size(),
                                       [&](std::size_t e) { return std::size_t(counts_.edge(e)) - 1; });
        const auto first_face = prefix(first_edge.back(), topology_.faces.size(), [&](std::size_t f) {
            const auto n = counts_.face(f);
            return std::size_t(n[0] - 1) * std::size_t(n[1] - 1);
        });
        const auto first_cell = prefix(first_face.back(), topology_.cells.size(), [&](std::size_t c) {
            const auto n = counts_.cell(c);
            const auto inside = std::size_t(n[0] - 1) * std::size_t(n[1] - 1) * std::size_t(n[2] - 1);
            return inside + (options_.centers ? std::size_t(n[0]) * std::size_t(n[1]) * std::size_t(n[2]) : 0);
        });
        auto& report = result_.report;
        report.at_vertices = topology_.point_count;
        report.on_edges = first_edge.back() - topology_.point_count;
        report.on_faces = first_face.back() - first_edge.back();
        report.in_cells = first_cell.back() - first_face.back();
        report.points = first_cell.back();
        result_.volume = empty_volume(mesh, report.points, options_);
        result_.volume.centers.resize(report.points);

        each(topology_.point_count, "sample vertices", [&](std::size_t p, auto& writer) { return sample_vertex(p, writer); });
        each(topology_.edges.size(), "sample edges",
             [&](std::size_t e, auto& writer) { return sample_edge(e, first_edge[e], writer); });
        each(topology_.faces.size(), "sample faces",
             [&](std::size_t f, auto& writer) { return sample_face(f, first_face[f], writer); });
        each(topology_.cells.size(), "sample cells",
             [&](std::size_t c, auto& writer) { return sample_cell(c, first_cell[c], writer); });
        return std::move(result_);
    }

private:
    template <class Count>
    static std::vector<std::size_t> prefix(std::size_t start, std::size_t count, const Count& entries) {
        std::vector<std::size_t> first(count + 1, start);
        for (std::size_t i = 0; i < count; ++i) first[i + 1] = first[i] + entries(i);
        return first;
    }

    template <class Sample>
    void each(std::size_t count, const char* stage, const Sample& sample) {
        report_progress(options_.progress, stage, 0);
        std::atomic<std::size_t> flat{0};
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), [&](const auto& range) {
            if (options_.progress && options_.progress->cancelled()) return;  // the report below throws
            KernelWriter writer(topology_, counts_, blocks_, control_, options_, diagonal_, result_.volume);
            std::size_t flat_here = 0;
            for (std::size_t i = range.begin(); i != range.end(); ++i) flat_here += sample(i, writer);
            flat += flat_here;
        });
        result_.report.flat_frames += flat;
        report_progress(options_.progress, stage, 1);
    }

    std::size_t sample_vertex(std::size_t p, KernelWriter& writer) const {
        writer.begin(p);
        for (std::size_t i = point_cells_.offsets[p]; i < point_cells_.offsets[p + 1]; ++i) {
            const Index cell = point_cells_.records[i].second;
            writer.add_cell(cell, in_cell<0>(topology_.cells[cell], static_cast<Index>(p), {}, {}));
        }
        return writer.finish();
    }

    std::size_t sample_edge(std::size_t e, std::size_t first, KernelWriter& writer) const {
        const int n = counts_.edge(e);
        const auto [a, b] = topology_.edges[e];
        std::size_t flat = 0;
        for (int i = 1; i < n; ++i) {
            writer.begin(first++);
            for (const Index cell : topology_.edge_cells[e]) {
                writer.add_cell(cell, in_cell<1>(topology_.cells[cell], a, {b}, {double(i) / n}));
            }
            flat += writer.finish();
        }
        return flat;
    }

    std::size_t sample_face(std::size_t f, std::size_t first, KernelWriter& writer) const {
        const auto n = counts_.face(f);
        const auto& quad = topology_.faces[f];
        std::size_t flat = 0;
        for (int j = 1; j < n[1]; ++j) {
            for (int i = 1; i < n[0]; ++i) {
                writer.begin(first++);
                for (const Index cell : topology_.face_cells[f]) {
                    if (cell == kNone) continue;
                    writer.add_cell(cell, in_cell<2>(topology_.cells[cell], quad[0], {quad[1], quad[3]},
                                                     {double(i) / n[0], double(j) / n[1]}));
                }
                flat += writer.finish();
            }
        }
        return flat;
    }

    std::size_t sample_cell(std::size_t c, std::size_t first, KernelWriter& writer) const {
        const std::size_t flat = sample_inside(c, 1, 0, first, writer);
        return flat + (options_.centers ? sample_inside(c, 0, 0.5, first, writer) : 0);
    }

    /// The samples (i + shift) / n of a cell, from i = start; `next` goes on.
    std::size_t sample_inside(std::size_t c, int start, double shift, std::size_t& next, KernelWriter& writer) const {
        const auto n = counts_.cell(c);
        std::size_t flat = 0;
        for (int k = start; k < n[2]; ++k) {
            for (int j = start; j < n[1]; ++j) {
                for (int i = start; i < n[0]; ++i) {
                    writer.begin(next++);
                    writer.add_cell(c, {(i + shift) / n[0], (j + shift) / n[1], (k + shift) / n[2]});
                    flat += writer.finish();
                }
            }
        }
        return flat;
    }

    const SampleOptions& options_;
    const Topology& topology_;
    SampleCounts counts_;
    const CellBlocks& blocks_;
    std::vector<ChannelView> control_;
    Buckets<std::pair<Index, Index>> point_cells_;
    double diagonal_;  // of the mesh's bounding box
    SampleResult result_;
};

}  // namespace

SampleResult sample_in_cells(const HexMesh& control, const CellBlocks& blocks, const Topology& topology,
                             std::vector<int> intervals, const SampleOptions& options) {
    return Sampler(control, blocks, topology, std::move(intervals), options).run(control);
}

}  // namespace subvol::detail
