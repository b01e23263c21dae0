#include "subvol/limit.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cubic_basis.h"
#include "mcq_grid.h"
#include "patch.h"
#include "regular_grid.h"
#include "subvol/error.h"
#include "topology_tags.h"

namespace subvol {

using detail::CubicBasis;
using detail::Patch;

namespace {

/// All channels of a point of a mesh, position first.
class Channels {
public:
    explicit Channels(const HexMesh& mesh) : count_(3) {
        for (const auto& attribute : mesh.attributes) count_ += static_cast<std::size_t>(attribute.channels);
    }
    [[nodiscard]] std::size_t count() const { return count_; }

    static void read(const HexMesh& mesh, Index point, double* to) {
        for (int a = 0; a < 3; ++a) *to++ = mesh.points[point][a];
        for (const auto& attribute : mesh.attributes) {
            const auto channels = static_cast<std::size_t>(attribute.channels);
            to = std::copy_n(attribute.values.begin() + static_cast<std::ptrdiff_t>(point * channels), channels, to);
        }
    }

private:
    std::size_t count_;
};

/// Value and derivatives of all channels at one place: entry 4c is channel c, behind it its derivatives by u, v, w.
using Jet = std::vector<double>;

using Basis = std::array<CubicBasis, 3>;

/// Sums over 4×4×4 points, the first at `data`; points along an axis are `side` to its power apart.
/// scale: by how much derivatives grow, 2^level
void sum_grid(const double* data, std::size_t side, std::size_t channels, const Basis& basis, double scale, Jet& jet) {
    jet.assign(4 * channels, 0.0);
    for (std::size_t k = 0; k < 4; ++k) {
        for (std::size_t j = 0; j < 4; ++j) {
            for (std::size_t i = 0; i < 4; ++i) {
                const std::array<double, 4> weight{basis[0].value[i] * basis[1].value[j] * basis[2].value[k],
                                                   scale * basis[0].first[i] * basis[1].value[j] * basis[2].value[k],
                                                   scale * basis[0].value[i] * basis[1].first[j] * basis[2].value[k],
                                                   scale * basis[0].value[i] * basis[1].value[j] * basis[2].first[k]};
                const double* point = data + (i + side * (j + side * k)) * channels;
                for (std::size_t c = 0; c < channels; ++c) {
                    for (std::size_t d = 0; d < 4; ++d) jet[4 * c + d] += weight[d] * point[c];
                }
            }
        }
    }
}

/// What the grid of 4×4×4 points about a cell says at a place in the cell.
class GridEvaluator {
public:
    GridEvaluator(const HexMesh& mesh, std::size_t channels, Scheme scheme)
        : mesh_(mesh), channels_(channels), spline_(!interpolates(scheme)), data_(64 * channels) {}

    void load(const detail::GridPoints& grid) {
        for (std::size_t n = 0; n < 64; ++n) {
            if (grid[n] != kNone) Channels::read(mesh_, grid[n], &data_[n * channels_]);
        }
        for (std::size_t axis = 0, stride = 1; axis < 3; ++axis, stride *= 4) fill_missing(grid, stride);
    }

    void evaluate(const Vec3& uvw, double scale, Jet& jet) const {
        Basis basis;
        for (int a = 0; a < 3; ++a) {
            basis[static_cast<std::size_t>(a)] = spline_ ? CubicBasis::spline(uvw[a]) : CubicBasis::lagrange(uvw[a]);
        }
        sum_grid(data_.data(), 4, channels_, basis, scale, jet);
    }

private:
    /// Beyond a flat boundary a spline's control points are mirrored, 2 f₀ − f₁, which is what the boundary rules amount to; an
    /// interpolant goes on quadratically, which leaves out the missing point.
    void fill_missing(const detail::GridPoints& grid, std::size_t stride) {
        const std::size_t a = stride == 1 ? 4 : 1, b = stride == 16 ? 4 : 16;  // the strides of the other two axes
        for (const std::size_t layer : {std::size_t{0}, std::size_t{3}}) {
            if (grid[layer * stride + a + b] != kNone) continue;
            const std::size_t near = layer == 0 ? 1 : 2, far = 3 - near, beyond = 3 - layer;
            const bool quadratic = !spline_ && grid[beyond * stride + a + b] != kNone;
            for (std::size_t i = 0; i < 4; ++i) {
                for (std::size_t j = 0; j < 4; ++j) {
                    const std::size_t row = i * a + j * b;
                    for (std::size_t c = 0; c < channels_; ++c) {
                        const auto at = [&](std::size_t n) -> double& { return data_[(row + n * stride) * channels_ + c]; };
                        at(layer) = quadratic ? 3 * at(near) - 3 * at(far) + at(beyond) : 2 * at(near) - at(far);
                    }
                }
            }
        }
    }

    const HexMesh& mesh_;
    std::size_t channels_;
    bool spline_;
    std::vector<double> data_;
};

/// Which of the eight children a place is in, u + 2v + 4w; the place becomes one in the child.
std::size_t step_into_octant(Vec3& uvw) {
    std::size_t octant = 0;
    for (int a = 0; a < 3; ++a) {
        const bool upper = uvw[a] >= 0.5;
        octant |= std::size_t{upper} << a;
        uvw[a] = 2 * uvw[a] - (upper ? 1 : 0);
    }
    return octant;
}

void evaluate_linear(const HexMesh& mesh, std::size_t channels, Index cell, const Vec3& uvw, double scale, Jet& jet) {
    constexpr std::array<std::array<int, 3>, 8> kCorner{
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
    std::vector<double> data(channels);
    jet.assign(4 * channels, 0.0);
    for (std::size_t k = 0; k < 8; ++k) {
        Channels::read(mesh, mesh.cells[cell][k], data.data());
        std::array<double, 3> weight{}, slope{};
        for (std::size_t a = 0; a < 3; ++a) {
            const double t = uvw[static_cast<int>(a)];
            weight[a] = kCorner[k][a] ? t : 1 - t;
            slope[a] = kCorner[k][a] ? scale : -scale;
        }
        const std::array<double, 4> w{weight[0] * weight[1] * weight[2], slope[0] * weight[1] * weight[2],
                                      weight[0] * slope[1] * weight[2], weight[0] * weight[1] * slope[2]};
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t d = 0; d < 4; ++d) jet[4 * c + d] += w[d] * data[c];
        }
    }
}

/// A query on its way down: in which of the patch's wanted cells it is, where in it, and what the last level said.
struct Descent {
    std::size_t query;
    Index cell;
    Vec3 uvw;
    Jet last;
    int agreed = 0;  // levels in a row that said the same
};

/// Evaluates the queries of a few control cells.
class BatchEvaluator {
public:
    BatchEvaluator(const LimitOptions& options, const std::vector<double>& scales, LimitSamples& samples)
        : options_(options),
          refine_{.scheme = options.scheme, .tension = options.tension, .crease_angle_deg = {}},
          scales_(scales),
          samples_(samples),
          grid_rule_(options.tension) {}

    LimitReport run(Patch patch, std::vector<Descent> open) {
        for (int level = 0;; ++level) {
            report_.deepest_level = std::max(report_.deepest_level, level);
            const Topology topology = detail::build_topology(patch.mesh, detail::Tags::OfAPart);
            evaluate_level(patch, topology, level, open);
            if (open.empty()) return report_;
            patch = detail::refine_patch(keep_open(patch, open), refine_, 2);
            for (Descent& at : open) descend(at);
        }
    }

private:
    /// What is settled at this level is written and leaves `open`.
    void evaluate_level(const Patch& patch, const Topology& topology, int level, std::vector<Descent>& open) {
        const double scale = std::ldexp(1.0, level);
        GridEvaluator grid(patch.mesh, scales_.size(), options_.scheme);
        Index loaded = kNone;
        bool regular = false, wide = false;
        detail::GridPoints points;
        detail::WideGridPoints wide_points;
        Jet jet;
        std::erase_if(open, [&](Descent& at) {
            if (at.cell != loaded) {
                loaded = at.cell;
                regular = options_.scheme != Scheme::Linear && detail::regular_grid(topology, at.cell, points);
                if (regular) grid.load(points);
                wide = regular && options_.scheme == Scheme::Mcq && detail::wide_grid(topology, at.cell, wide_points);
                if (wide) load(patch.mesh, wide_points);
            }
            if (wide) {
                descend_in_grid(at, level);
                return true;
            }
            if (regular) {
                grid.evaluate(at.uvw, scale, jet);
            } else {
                evaluate_linear(patch.mesh, scales_.size(), at.cell, at.uvw, scale, jet);
            }
            const bool exact = options_.scheme == Scheme::Linear || (regular && !interpolates(options_.scheme));
            return settle(at, jet, level, regular, exact);
        });
    }

    /// Whether the query is done with what a level says of it; if so, it is written.
    bool settle(Descent& at, const Jet& jet, int level, bool regular, bool exact) {
        at.agreed = level >= 1 && is_close(jet, at.last, level) ? at.agreed + 1 : 0;
        // The trilinear guess stands still for a level at the centres of cells, whose points are means of the corners.
        const bool settled = level >= 2 && at.agreed >= (regular ? 1 : 2);
        at.last = jet;
        if (!exact && !settled && level < options_.max_levels) return false;
        ++(exact ? report_.exact : report_.refined);
        report_.unconverged += !exact && !settled;
        write(at.query, jet);
        return true;
    }

    void load(const HexMesh& mesh, const detail::WideGridPoints& points) {
        wide_data_.resize(points.size() * scales_.size());
        for (std::size_t n = 0; n < points.size(); ++n) Channels::read(mesh, points[n], &wide_data_[n * scales_.size()]);
    }

    /// Goes on where all about is a grid, so that children need no topology.
    void descend_in_grid(Descent& at, int level) {
        constexpr std::size_t kSide = detail::McqGrid::kSide;
        std::vector<double> data = wide_data_, child(data.size());
        for (Jet jet;; ++level) {
            const Basis basis{CubicBasis::lagrange(at.uvw[0]), CubicBasis::lagrange(at.uvw[1]),
                              CubicBasis::lagrange(at.uvw[2])};
            sum_grid(&data[(1 + kSide + kSide * kSide) * scales_.size()], kSide, scales_.size(), basis, std::ldexp(1.0, level),
                     jet);
            report_.deepest_level = std::max(report_.deepest_level, level);
            if (settle(at, jet, level, true, false)) return;
            grid_rule_.refine(step_into_octant(at.uvw), scales_.size(), data, child);
            data.swap(child);
        }
    }

    /// Derivatives are of half the order. About extraordinary edges and vertices they need not converge, so that after some
    /// levels the values alone decide.
    [[nodiscard]] bool is_close(const Jet& a, const Jet& b, int level) const {
        constexpr int kSlopeLevels = 7;
        const double slope_tolerance = level < kSlopeLevels ? std::sqrt(options_.tolerance) : HUGE_VAL;
        for (std::size_t c = 0; c < scales_.size(); ++c) {
            if (!(std::abs(a[4 * c] - b[4 * c]) <= options_.tolerance * scales_[c])) return false;
            for (std::size_t d = 1; d < 4; ++d) {
                if (std::abs(a[4 * c + d] - b[4 * c + d]) > slope_tolerance * scales_[c]) return false;
            }
        }
        return true;
    }

    /// The part of the patch that still has queries; they are numbered anew.
    static Patch keep_open(const Patch& patch, std::vector<Descent>& open) {
        std::stable_sort(open.begin(), open.end(), [](const Descent& a, const Descent& b) { return a.cell < b.cell; });
        std::vector<Index> cells;
        for (const Descent& at : open) {
            if (cells.empty() || cells.back() != at.cell) cells.push_back(at.cell);
        }
        for (std::size_t i = 0, k = 0; i < open.size(); ++i) {
            if (open[i].cell != cells[k]) ++k;
            open[i].cell = static_cast<Index>(k);
        }
        return detail::sub_patch(patch, cells, 2);
    }

    void descend(Descent& at) const {
        constexpr std::array<Index, 8> kChild{0, 1, 3, 2, 4, 5, 7, 6};  // by u + 2v + 4w
        at.cell = 8 * at.cell + kChild[step_into_octant(at.uvw)];
    }

    void write(std::size_t query, const Jet& jet) {
        for (int a = 0; a < 3; ++a) {
            const std::size_t c = 4 * static_cast<std::size_t>(a);
            samples_.positions[query][a] = jet[c];
            for (int d = 0; d < 3; ++d) samples_.jacobians[query][d][a] = jet[c + 1 + static_cast<std::size_t>(d)];
        }
        const double* next = jet.data() + 12;
        for (LimitAttribute& attribute : samples_.attributes) {
            for (std::size_t c = 0; c < attribute.channels; ++c, next += 4) {
                attribute.values[query * attribute.channels + c] = next[0];
                attribute.derivatives[query * attribute.channels + c] = {next[1], next[2], next[3]};
            }
        }
    }

    const LimitOptions& options_;
    RefineOptions refine_;
    const std::vector<double>& scales_;
    LimitSamples& samples_;
    LimitReport report_;
    detail::McqGrid grid_rule_;
    std::vector<double> wide_data_;
};

void check(const HexMesh& mesh, std::span<const LimitQuery> queries, const LimitOptions& options) {
    if (!(options.tolerance >= 0) || options.max_levels < 2 || options.max_levels > 20) {
        throw Error(ErrorCode::InvalidInput, "the tolerance or the number of levels is out of range", "limit",
                    "tolerance >= 0, 2 to 20 levels");
    }
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const auto& [cell, uvw] = queries[i];
        const bool inside = uvw.x >= 0 && uvw.x <= 1 && uvw.y >= 0 && uvw.y <= 1 && uvw.z >= 0 && uvw.z <= 1;
        if (cell < mesh.cells.size() && inside) continue;
        throw Error(ErrorCode::InvalidInput,
                    cell < mesh.cells.size() ? "the parameters are outside [0,1]" : "there is no cell " + std::to_string(cell),
                    "limit query " + std::to_string(i));
    }
}

/// What tolerances are relative to, a channel. A constant field still differs by rounding.
std::vector<double> channel_scales(const HexMesh& mesh) {
    const Box box = bounds(mesh);
    std::vector<double> scales(3, std::max(box.diagonal(), 1e-6 * glm::length(box.center())));
    for (const auto& attribute : mesh.attributes) {
        const auto [low, high] = std::minmax_element(attribute.values.begin(), attribute.values.end());
        const double scale = std::max(*high - *low, 1e-6 * std::max(std::abs(*low), std::abs(*high)));
        scales.insert(scales.end(), static_cast<std::size_t>(attribute.channels), scale);
    }
    return scales;
}

LimitSamples make_samples(const HexMesh& mesh, std::size_t count) {
    LimitSamples samples;
    samples.positions.resize(count);
    samples.jacobians.resize(count);
    for (const auto& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        samples.attributes.push_back(
            {attribute.name, channels, std::vector<double>(count * channels), std::vector<Vec3>(count * channels)});
    }
    return samples;
}

}  // namespace

LimitSamples evaluate_limit(const HexMesh& mesh, std::span<const LimitQuery> queries, const LimitOptions& options) {
    validate(mesh);
    check(mesh, queries, options);
    HexMesh control = without_unused_points(mesh);
    if (options.crease_angle_deg) tag_creases(control, *options.crease_angle_deg);
    const detail::PatchSource source(control);
    const auto scales = channel_scales(control);
    LimitSamples samples = make_samples(control, queries.size());

    std::vector<std::size_t> order(queries.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return queries[a].cell < queries[b].cell; });
    constexpr std::size_t kBatch = 64;  // queries
    const std::size_t batches = (queries.size() + kBatch - 1) / kBatch;
    std::vector<LimitReport> reports(batches);
    const auto evaluate_batch = [&](std::size_t b) {
        std::vector<Index> cells;
        std::vector<Descent> open;
        for (std::size_t i = b * kBatch; i < std::min(queries.size(), (b + 1) * kBatch); ++i) {
            const auto& [cell, uvw] = queries[order[i]];
            if (cells.empty() || cells.back() != cell) cells.push_back(cell);
            open.push_back({order[i], static_cast<Index>(cells.size() - 1), uvw, {}});
        }
        reports[b] = BatchEvaluator(options, scales, samples).run(source.cut(cells, 2), std::move(open));
    };
    constexpr std::size_t kTurn = 256;  // batches between two reports of progress
    for (std::size_t turn = 0; turn < batches; turn += kTurn) {
        report_progress(options.progress, "limit", static_cast<double>(turn) / static_cast<double>(batches));
        tbb::parallel_for(turn, std::min(batches, turn + kTurn),
                          [&](std::size_t b) { tbb::this_task_arena::isolate([&] { evaluate_batch(b); }); });
    }
    report_progress(options.progress, "limit", 1);
    for (const LimitReport& report : reports) {
        samples.report.exact += report.exact;
        samples.report.refined += report.refined;
        samples.report.unconverged += report.unconverged;
        samples.report.deepest_level = std::max(samples.report.deepest_level, report.deepest_level);
    }
    return samples;
}

}  // namespace subvol
