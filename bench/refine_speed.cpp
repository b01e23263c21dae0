// Refinement of a twisted block: tables and their application, stored tables again and again, the trilinear split beside MCQ,
// and what part of the machine's memory bandwidth that is. All ratios from one run. Arguments: cells per side, levels, repeats.
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "subvol/model.h"
#include "subvol/refine.h"

namespace {

using namespace subvol;

double seconds_of(const auto& work, int repeats) {
    double best = 1e30;
    for (int i = 0; i < repeats; ++i) {
        const auto start = std::chrono::steady_clock::now();
        work();
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
}

double peak_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// Bytes a second that all cores together copy (read and write counted).
double copy_bandwidth() {
    const std::size_t count = std::size_t{1} << 26;
    std::vector<double> from(count, 1.0), to(count);
    const double seconds = seconds_of(
        [&] {
            tbb::parallel_for(std::size_t{0}, count / 65536,
                              [&](std::size_t i) { std::copy_n(from.data() + i * 65536, 65536, to.data() + i * 65536); });
        },
        5);
    return 2.0 * 8.0 * static_cast<double>(count) / seconds;
}

}  // namespace

int main(int argc, char** argv) {
    const int side = argc > 1 ? std::atoi(argv[1]) : 64, levels = argc > 2 ? std::atoi(argv[2]) : 2;
    const int repeats = argc > 3 ? std::atoi(argv[3]) : 3;
    const std::size_t threads = argc > 4 ? std::strtoul(argv[4], nullptr, 10) : 0;
    const tbb::global_control limit(
        tbb::global_control::max_allowed_parallelism,
        threads ? threads : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    const HexMesh mesh = make_model("twist", side);
    std::vector<double> data;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        for (int a = 0; a < 3; ++a) data.push_back(mesh.points[p][a]);
        data.push_back(mesh.attributes[0].values[p]);
    }
    const double before = peak_bytes();

    std::size_t bytes = 0, terms = 0;
    double points = 0, touched = 0;
    const auto tables_and_application = [&](Scheme scheme) {
        return seconds_of(
            [&] {
                const RefinementTables tables = refinement_tables(build_topology(mesh), {.scheme = scheme, .levels = levels});
                const auto fine = tables.apply(std::span<const double>(data), 4);
                points = static_cast<double>(fine.size()) / 4;
            },
            repeats);
    };
    const double mcq = tables_and_application(Scheme::Mcq);
    const double peak = peak_bytes() - before;
    const double linear = tables_and_application(Scheme::Linear);
    const double streamed = seconds_of([&] { (void)refine(mesh, {.levels = levels}); }, repeats);

    const RefinementTables tables = refinement_tables(build_topology(mesh), {.levels = levels});
    for (const auto& level : tables.levels) {
        bytes += level.bytes();
        terms += level.terms();
        touched += static_cast<double>(level.bytes()) + 32.0 * static_cast<double>(level.rows() + level.columns());
    }
    const double apply = seconds_of([&] { (void)tables.apply(std::span<const double>(data), 4); }, repeats);
    const std::vector<float> single(data.begin(), data.end());
    const double apply_float = seconds_of([&] { (void)tables.apply(std::span<const float>(single), 4); }, repeats);
    const double bandwidth = copy_bandwidth();

    std::printf("%.1f M output points, %d levels of a %d^3 block\n", points / 1e6, levels, side);
    std::printf("tables and application   %.2f s   %.2f M points/s   peak %.0f bytes a point\n", mcq, points / mcq / 1e6,
                peak / points);
    std::printf("  of the trilinear split %.2f s   MCQ takes %.2f times as long\n", linear, mcq / linear);
    std::printf("refine, nothing stored   %.2f s   %.2f M points/s\n", streamed, points / streamed / 1e6);
    std::printf("stored tables            %.1f bytes and %.1f terms a point\n", static_cast<double>(bytes) / points,
                static_cast<double>(terms) / points);
    std::printf("application, double      %.2f s   %.1f M point-channels/s   %.0f %% of the copy bandwidth of %.1f GB/s\n",
                apply, 4 * points / apply / 1e6, 100 * touched / apply / bandwidth, bandwidth / 1e9);
    std::printf("application, float       %.2f s   %.1f M point-channels/s\n", apply_float, 4 * points / apply_float / 1e6);
}
