// SPDX-License-Identifier: Apache-2.0
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>

#include "direction_sums.h"
#include "sample_ways.h"
#include "value_rules.h"

namespace subvol::detail {

namespace {

/// A derivative as weights over a few points of a line.
struct LineStencil {
    std::array<Index, 5> points;
    std::array<double, 5> weights;
    std::size_t count = 0;

    void set(std::initializer_list<std::pair<Index, double>> terms, double unit) {
        count = 0;
        for (const auto& [point, weight] : terms) {
            points[count] = point;
            weights[count++] = weight * unit;
        }
    }
};

/// The derivative at `p`, per interval, towards `ahead` on the line … back2, back, p, ahead, ahead2 …: exact for polynomials of
/// as high a degree as the points allow, up to the fourth.
void derive(const PointLines& lines, Index p, Index ahead, Index back, LineStencil& d) {
    const Index ahead2 = lines.after(ahead, p);
    if (back == kNone) {
        const Index ahead3 = ahead2 == kNone ? kNone : lines.after(ahead2, ahead);
        if (ahead3 != kNone) return d.set({{p, -11}, {ahead, 18}, {ahead2, -9}, {ahead3, 2}}, 1. / 6);
        if (ahead2 != kNone) return d.set({{p, -3}, {ahead, 4}, {ahead2, -1}}, 1. / 2);
        return d.set({{p, -1}, {ahead, 1}}, 1);
    }
    const Index back2 = lines.after(back, p);
    if (ahead2 != kNone && back2 != kNone) return d.set({{back2, 1}, {back, -8}, {ahead, 8}, {ahead2, -1}}, 1. / 12);
    if (ahead2 != kNone) return d.set({{back, -2}, {p, -3}, {ahead, 6}, {ahead2, -1}}, 1. / 6);
    if (back2 != kNone) return d.set({{ahead, 2}, {p, 3}, {back, -6}, {back2, 1}}, 1. / 6);
    d.set({{back, -1}, {ahead, 1}}, 1. / 2);
}

class PointSampler {
public:
    /// diagonal: of the mesh's bounding box
    PointSampler(const HexMesh& mesh, double diagonal, const PointLines& lines, bool across_points,
                 const SampleOptions& options, RbfVolume& volume)
        : mesh_(mesh),
          lines_(lines),
          across_(across_points),
          sums_(options, diagonal, volume),
          volume_(volume),
          sources_(channels_of(mesh)) {
        d_.resize(sources_.size());
        dd_.resize(sources_.size());
    }

    /// Returns whether the point's frame was flat.
    bool sample(Index p) {
        for (std::size_t c = 0; c < sources_.size(); ++c) volume_.channels[c].values[p] = static_cast<float>(sources_[c].at(p));
        sums_.begin(p);
        double cells = 0;
        for (std::size_t i = lines_.starts[p]; i < lines_.end(p); i += 2) {
            const Index a = lines_.neighbours[i], b = lines_.neighbours[i + 1];
            const double cells_a = lines_.cells[i], cells_b = lines_.cells[i + 1];
            cells += (cells_a + cells_b) / 3;
            if (!across_) {
                add_straight(p, a, cells_a);
                if (b != kNone) add_straight(p, b, cells_b);
            } else {
                add_line(p, a, b, cells_a, cells_b);
            }
        }
        return cells > 0 && sums_.finish(cells);
    }

private:
    /// The second difference is that of the two neighbours of p; with one neighbour it is 2 (f(1) − f(0) − f′(0)).
    void add_line(Index p, Index a, Index b, double cells_a, double cells_b) {
        derive(lines_, p, a, b, stencil_);
        Vec3 step(0.0);
        for (std::size_t k = 0; k < stencil_.count; ++k) step += stencil_.weights[k] * mesh_.points[stencil_.points[k]];
        const double weight = cells_a + cells_b, share_a = 2 * cells_a / weight, share_b = 2 * cells_b / weight;
        const Vec3& x = mesh_.points[p];
        Vec3 bend = share_a * (mesh_.points[a] - x - step);
        if (b != kNone) bend += share_b * (mesh_.points[b] - x + step);
        for (std::size_t c = 0; c < sources_.size(); ++c) {
            const ChannelView& f = sources_[c];
            double d = 0;
            for (std::size_t k = 0; k < stencil_.count; ++k) d += stencil_.weights[k] * f.at(stencil_.points[k]);
            d_[c] = d;
            dd_[c] = share_a * (f.at(a) - f.at(p) - d);
            if (b != kNone) dd_[c] += share_b * (f.at(b) - f.at(p) + d);
        }
        sums_.add(weight, step, bend, d_.data(), dd_.data());
    }

    void add_straight(Index p, Index a, double cells) {
        for (std::size_t c = 0; c < sources_.size(); ++c) {
            d_[c] = sources_[c].at(a) - sources_[c].at(p);
            dd_[c] = 0;
        }
        sums_.add(cells, mesh_.points[a] - mesh_.points[p], Vec3(0.0), d_.data(), dd_.data());
    }

    const HexMesh& mesh_;
    const PointLines& lines_;
    bool across_;
    DirectionSums sums_;
    RbfVolume& volume_;
    std::vector<ChannelView> sources_;
    std::vector<double> d_, dd_;
    LineStencil stencil_;
};

}  // namespace

SampleResult sample_at_points(HexMesh on_limit, const PointLines& lines, bool across_points, const SampleOptions& options,
                              std::optional<double> diagonal) {
    constexpr std::size_t kTurn = std::size_t{1} << 20;  // points between two reports of progress
    SampleResult result;
    result.volume = empty_volume(on_limit, lines.size(), options);
    Box box;
    for (const Vec3& p : on_limit.points) box.add(p);
    const double size = diagonal.value_or(box.diagonal());
    std::atomic<std::size_t> flat{0};
    for (std::size_t turn = 0; turn < lines.size(); turn += kTurn) {
        report_progress(options.progress, "sample", turn, lines.size());
        const tbb::blocked_range<std::size_t> points(turn, std::min(lines.size(), turn + kTurn), 256);
        tbb::parallel_for(points, [&](const auto& range) {
            if (options.progress && options.progress->cancelled()) return;  // the next report throws
            PointSampler sampler(on_limit, size, lines, across_points, options, result.volume);
            std::size_t flat_here = 0;
            for (std::size_t p = range.begin(); p != range.end(); ++p) flat_here += sampler.sample(static_cast<Index>(p));
            flat += flat_here;
        });
    }
    report_progress(options.progress, "sample", lines.size(), lines.size());
    result.volume.centers = std::move(on_limit.points);
    if (options.correction == Correction::Full) fit_hessians(lines, result.volume);
    report_progress(options.progress, "sample", 1);
    result.report.points = lines.size();
    result.report.flat_frames = flat;
    return result;
}

}  // namespace subvol::detail
