#pragma once

#include <cmath>

#include "limit_jet.h"
#include "mcq_grid.h"
#include "patch.h"
#include "subvol/limit.h"
#include "topology_tags.h"

namespace subvol::detail {

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

    /// Settles what needs no refinement but in a grid; what is left stays in `open`.
    void begin(const HexMesh& control, const Topology& topology, std::vector<Descent>& open) {
        evaluate_level(control, topology, 0, open);
    }

    /// Settles the rest, refining the cells about it.
    void finish(const PatchSource& source, std::vector<Descent> open) {
        Patch patch = source.cut(number_cells(open), 2);
        for (int level = 1; !open.empty(); ++level) {
            patch = refine_patch(patch, refine_, 2);
            for (Descent& at : open) descend(at);
            evaluate_level(patch.mesh, build_topology(patch.mesh, Tags::OfAPart), level, open);
            patch = sub_patch(patch, number_cells(open), 2);
        }
    }

    [[nodiscard]] const LimitReport& report() const { return report_; }

private:
    /// What is settled at this level is written and leaves `open`.
    void evaluate_level(const HexMesh& mesh, const Topology& topology, int level, std::vector<Descent>& open) {
        report_.deepest_level = std::max(report_.deepest_level, level);
        const double scale = std::ldexp(1.0, level);
        GridEvaluator grid(mesh, scales_.size(), options_.scheme);
        Index loaded = kNone;
        bool regular = false, wide = false;
        GridPoints points;
        WideGridPoints wide_points;
        Jet jet;
        std::erase_if(open, [&](Descent& at) {
            if (at.cell != loaded) {
                loaded = at.cell;
                regular = options_.scheme != Scheme::Linear && regular_grid(topology, at.cell, points);
                if (regular) grid.load(points);
                wide = regular && options_.scheme == Scheme::Mcq && wide_grid(topology, at.cell, wide_points);
                if (wide) load(mesh, wide_points);
            }
            if (wide) {
                descend_in_grid(at, level);
                return true;
            }
            if (regular) {
                grid.evaluate(at.uvw, scale, jet);
            } else {
                evaluate_linear(mesh, scales_.size(), at.cell, at.uvw, scale, jet);
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

    void load(const HexMesh& mesh, const WideGridPoints& points) {
        wide_data_.resize(points.size() * scales_.size());
        for (std::size_t n = 0; n < points.size(); ++n) Channels::read(mesh, points[n], &wide_data_[n * scales_.size()]);
    }

    /// Goes on where all about is a grid, so that children need no topology.
    void descend_in_grid(Descent& at, int level) {
        constexpr std::size_t kSide = McqGrid::kSide;
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

    /// The cells that have queries; in `open` they are numbered anew.
    static std::vector<Index> number_cells(std::vector<Descent>& open) {
        std::stable_sort(open.begin(), open.end(), [](const Descent& a, const Descent& b) { return a.cell < b.cell; });
        std::vector<Index> cells;
        for (const Descent& at : open) {
            if (cells.empty() || cells.back() != at.cell) cells.push_back(at.cell);
        }
        for (std::size_t i = 0, k = 0; i < open.size(); ++i) {
            if (open[i].cell != cells[k]) ++k;
            open[i].cell = static_cast<Index>(k);
        }
        return cells;
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
    McqGrid grid_rule_;
    std::vector<double> wide_data_;
};

}  // namespace subvol::detail
