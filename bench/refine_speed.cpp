// SPDX-License-Identifier: Apache-2.0
// Refinement of a twisted block: computing and applying tables, applying stored tables repeatedly, the trilinear split compared
// with MCQ, one thread compared with all, and the fraction of the machine's memory bandwidth that is reached. All ratios are
// from one run. Arguments: cells per side, levels, repeats.
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "measure.h"
#include "subvol/model.h"
#include "subvol/refine.h"

namespace {

using namespace subvol;
using bench::peak_bytes;
using bench::seconds_of;

constexpr std::size_t kChannels = 4;  // position and density

/// Bytes per second that all cores together copy (reads and writes counted).
double copy_bandwidth() {
    constexpr std::size_t kCount = std::size_t{1} << 26, kPart = 65536;
    const std::vector<double> from(kCount, 1.0);
    std::vector<double> to(kCount);
    const double seconds = seconds_of(
        [&] {
            tbb::parallel_for(std::size_t{0}, kCount / kPart,
                              [&](std::size_t i) { std::copy_n(from.data() + i * kPart, kPart, to.data() + i * kPart); });
        },
        5);
    return 2.0 * sizeof(double) * static_cast<double>(kCount) / seconds;
}

std::vector<double> channels_of(const HexMesh& mesh) {
    std::vector<double> data;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        const Vec3& x = mesh.points[p];
        data.insert(data.end(), {x.x, x.y, x.z, mesh.attributes[0].values[p]});
    }
    return data;
}

/// Times: of everything from the control mesh on, and of the application alone.
struct Timing {
    double tables = 0, streamed = 0, apply = 0, apply_float = 0;
    double peak = 0;  // bytes, of tables and their application
};

Timing measure(const HexMesh& mesh, std::span<const double> data, const RefineOptions& options, int repeats) {
    Timing timing;
    const double before = peak_bytes();
    timing.tables = seconds_of(
        [&] {
            const RefinementTables tables = refinement_tables(build_topology(mesh), options);
            FlatArray<double> fine(tables.points() * kChannels);
            tables.apply(data, kChannels, std::span<double>(fine));
        },
        repeats);
    timing.peak = peak_bytes() - before;
    timing.streamed = seconds_of([&] { (void)refine(mesh, options); }, repeats);
    const RefinementTables tables = refinement_tables(build_topology(mesh), options);
    const std::vector<float> copy(data.begin(), data.end());
    const std::span<const float> single(copy);
    FlatArray<double> fine(tables.points() * kChannels);
    FlatArray<float> fine_float(fine.size());
    timing.apply = seconds_of([&] { tables.apply(data, kChannels, std::span<double>(fine)); }, 2 * repeats);
    timing.apply_float = seconds_of([&] { tables.apply(single, kChannels, std::span<float>(fine_float)); }, 2 * repeats);
    return timing;
}

}  // namespace

int main(int argc, char** argv) {
    const int side = argc > 1 ? std::atoi(argv[1]) : 64, levels = argc > 2 ? std::atoi(argv[2]) : 2;
    const int repeats = argc > 3 ? std::atoi(argv[3]) : 3;
    const HexMesh mesh = make_model("twist", side);
    const auto data = channels_of(mesh);
    const RefineOptions mcq_options{.levels = levels}, linear_options{.scheme = {Scheme::Linear}, .levels = levels};

    const Timing mcq = measure(mesh, data, mcq_options, repeats);
    const Timing linear = measure(mesh, data, linear_options, repeats);
    Timing one;
    {
        const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
        one = measure(mesh, data, mcq_options, repeats);
    }

    double bytes = 0, terms = 0, touched = 0, points = 0;
    for (const RefinementTables tables = refinement_tables(build_topology(mesh), mcq_options);
         const auto& level : tables.levels) {
        bytes += static_cast<double>(level.bytes());
        terms += static_cast<double>(level.terms());
        points = static_cast<double>(level.rows());
        touched += static_cast<double>(level.bytes() + sizeof(double) * kChannels * (level.rows() + level.columns()));
    }
    const double bandwidth = copy_bandwidth();
    const double million_points = points / 1e6, million_values = kChannels * million_points;

    std::printf("%.1f M output points: %d levels of a %d^3 block; %d threads\n", million_points, levels, side,
                tbb::info::default_concurrency());
    std::printf("tables and application  %6.2f s  %6.2f M points/s   peak %.0f bytes a point\n", mcq.tables,
                million_points / mcq.tables, mcq.peak / points);
    std::printf("  of the trilinear split%6.2f s  MCQ takes %.2f times as long\n", linear.tables, mcq.tables / linear.tables);
    std::printf("refine, nothing stored  %6.2f s  %6.2f M points/s   %.2f times the trilinear split\n", mcq.streamed,
                million_points / mcq.streamed, mcq.streamed / linear.streamed);
    std::printf("stored tables           %.1f bytes and %.1f terms a point\n", bytes / points, terms / points);
    std::printf("application, double     %6.2f s  %6.1f M point-channels/s   %.0f %% of the copy bandwidth, %.1f GB/s\n",
                mcq.apply, million_values / mcq.apply, 100 * touched / mcq.apply / bandwidth, bandwidth / 1e9);
    std::printf("application, float      %6.2f s  %6.1f M point-channels/s\n", mcq.apply_float,
                million_values / mcq.apply_float);
    std::printf("speed-up over 1 thread  tables and application %.2f, nothing stored %.2f, application %.2f\n",
                one.tables / mcq.tables, one.streamed / mcq.streamed, one.apply / mcq.apply);
}
