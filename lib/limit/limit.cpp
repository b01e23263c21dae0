// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "limit_batch.h"
#include "refine_steps.h"
#include "run_nested.h"
#include "subvol/error.h"

namespace subvol {

using detail::BatchEvaluator;
using detail::OpenQuery;

namespace {

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

/// The scale of each channel that tolerances are relative to. It is not 0 for a constant field, whose values differ by
/// rounding.
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

constexpr std::size_t kBatch = 64;  // queries

std::size_t batch_count(std::size_t queries) {
    return (queries + kBatch - 1) / kBatch;
}

/// Calls run(number, queries) for every batch, in parallel, and adds up the reports.
template <class Run>
void run_batches(const std::vector<OpenQuery>& open, Progress* progress, LimitReport& total, const Run& run) {
    const std::size_t batches = batch_count(open.size());
    std::vector<LimitReport> reports(batches);
    constexpr std::size_t kTurn = 256;  // batches between two reports of progress
    for (std::size_t turn = 0; turn < batches; turn += kTurn) {
        report_progress(progress, "limit", static_cast<double>(turn) / static_cast<double>(batches));
        tbb::parallel_for(turn, std::min(batches, turn + kTurn), [&](std::size_t b) {
            const auto begin = open.begin() + static_cast<std::ptrdiff_t>(b * kBatch);
            const auto end = open.begin() + static_cast<std::ptrdiff_t>(std::min(open.size(), (b + 1) * kBatch));
            detail::run_nested([&] { reports[b] = run(b, std::vector<OpenQuery>(begin, end)); });
        });
    }
    report_progress(progress, "limit", 1);
    for (const LimitReport& report : reports) {
        total.exact += report.exact;
        total.refined += report.refined;
        total.unconverged += report.unconverged;
        total.deepest_level = std::max(total.deepest_level, report.deepest_level);
    }
}

}  // namespace

LimitSamples evaluate_limit(const HexMesh& mesh, std::span<const LimitQuery> queries, const LimitOptions& options) {
    const HexMesh control = detail::control_mesh(mesh, options.scheme);
    check(control, queries, options);
    const auto scales = channel_scales(control);
    LimitSamples samples = make_samples(control, queries.size());

    // First the queries that can be answered with the topology of the whole mesh, then those that need refined patches.
    std::vector<OpenQuery> open;
    for (std::size_t i = 0; i < queries.size(); ++i) open.push_back({i, queries[i].cell, queries[i].uvw, {}});
    std::stable_sort(open.begin(), open.end(), [](const OpenQuery& a, const OpenQuery& b) { return a.cell < b.cell; });
    {
        const Topology topology = build_topology(control);
        std::vector<std::vector<OpenQuery>> left(batch_count(open.size()));
        run_batches(open, options.progress, samples.report, [&](std::size_t b, std::vector<OpenQuery> batch) {
            BatchEvaluator evaluator(options, scales, samples);
            evaluator.begin(control, topology, batch);
            left[b] = std::move(batch);
            return evaluator.report();
        });
        open.clear();
        for (auto& batch : left) std::move(batch.begin(), batch.end(), std::back_inserter(open));
    }
    if (open.empty()) return samples;
    const detail::PatchSource source(control);
    run_batches(open, options.progress, samples.report, [&](std::size_t, std::vector<OpenQuery> batch) {
        BatchEvaluator evaluator(options, scales, samples);
        evaluator.finish(source, std::move(batch));
        return evaluator.report();
    });
    return samples;
}

}  // namespace subvol
