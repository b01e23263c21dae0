// SPDX-License-Identifier: Apache-2.0
// What a picture from a file with levels of detail reads and costs: kernels drawn, bytes read, CPU seconds, peak memory, and
// the PSNR against all kernels over the pixels that the body covers; then a dolly. From far to near, so that each peak is its
// own.
//
//   lod_file FILE.svk [size = 512] [frames = 72] [kept megabytes = 1024] [pixels of the dolly = 2] [dolly-only]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <string>
#include <vector>

#include "lod_scene.h"
#include "measure.h"
#include "subvol/image_metrics.h"
#include "subvol/kernel_file.h"
#include "subvol/points_io.h"
#include "subvol/splat.h"

namespace {

using namespace subvol;
using namespace subvol::bench;

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Optics optics_of(const KernelFileContents& contents) {
    return optics_with_peak(contents.channels[0].min, contents.channels[0].max, contents.bounds);
}

struct Drawn {
    double distance, pixels;
    Image image;
};

/// Each picture opens the file anew, as the command does.
Drawn draw(const std::string& path, double distance, double pixels, int size) {
    KernelFile file(path, 0);
    const KernelFileContents contents = file.contents();
    const double begin = cpu_seconds();
    StreamedKernels few = file.choose_level(view_at(contents.bounds, distance, size), {.pixels = pixels});
    const double read = cpu_seconds() - begin;
    const SplatResult drawn =
        render_splats(few.volume, view_at(contents.bounds, distance, size), optics_of(contents), {.method = SplatMethod::Cpu});
    std::printf("  distance %4.1f lod %1.0f: %9zu kernels  read %7.1f MB %6.2f s  draw %6.2f s  peak %5.0f MB\n", distance,
                pixels, few.volume.size(), 1e-6 * static_cast<double>(file.bytes_read()), read, cpu_seconds() - begin - read,
                1e-6 * bench::peak_bytes());
    std::fflush(stdout);
    return {distance, pixels, drawn.image};
}

void distances(const std::string& path, int size) {
    std::vector<Drawn> pictures;
    for (const double distance : {16.0, 4.0, 1.0}) {
        for (const double pixels : {2.0, 1.0}) pictures.push_back(draw(path, distance, pixels, size));
    }
    const KernelFileContents contents = KernelFile(path).contents();
    const double begin = cpu_seconds();
    const RbfVolume volume = read_points(path);
    std::printf("  all: %zu kernels, read %.2f s\n", volume.size(), cpu_seconds() - begin);
    Splatter splatter(volume, {.method = SplatMethod::Cpu});
    for (const double distance : {16.0, 4.0, 1.0}) {
        const double start = cpu_seconds();
        const Image all = splatter.draw(view_at(contents.bounds, distance, size), optics_of(contents)).image;
        std::printf("  distance %4.1f all: draw %6.2f s  peak %5.0f MB", distance, cpu_seconds() - start,
                    1e-6 * bench::peak_bytes());
        PixelMask seen;
        for (std::size_t i = 3; i < all.rgba.size(); i += 4) seen.push_back(all.rgba[i] > 0 ? 1 : 0);
        for (const Drawn& drawn : pictures) {
            if (drawn.distance != distance) continue;
            const bool same = drawn.image.rgba == all.rgba;
            std::printf("  lod %1.0f: psnr %5.1f%s", drawn.pixels, compare_images(drawn.image, all, seen).psnr,
                        same ? " (same bits)" : "");
        }
        std::puts("");
        std::fflush(stdout);
    }
}

void dolly(const std::string& path, int size, int frames, std::uint64_t kept_bytes, double pixels) {
    KernelFile file(path, kept_bytes);
    const KernelFileContents contents = file.contents();
    const Optics optics = optics_of(contents);
    std::optional<Splatter> splatter;
    RbfVolume shown;
    double read = 0, drawn = 0, most = 0, wall = 0;
    static_cast<void>(file.boundary());
    const std::uint64_t before = file.bytes_read();
    const detail::Stopwatch watch;
    for (int i = 0; i < frames; ++i) {
        const View view = view_at(contents.bounds, std::pow(16.0, double(i) / std::max(frames - 1, 1)), size);
        const double begin = cpu_seconds();
        shown = {};
        StreamedKernels few = file.choose_level(view, {.pixels = pixels});
        shown = std::move(few.volume);
        const double middle = cpu_seconds();
        if (splatter) {
            splatter->set_kernels(shown);
        } else {
            splatter.emplace(shown, SplatOptions{.method = SplatMethod::Cpu});
        }
        static_cast<void>(splatter->draw(view, optics));
        read += middle - begin;
        drawn += cpu_seconds() - middle;
        if (i > 0) most = std::max(most, static_cast<double>(few.bytes_read));
        if (i % 12 == 0 || i + 1 == frames) {
            std::printf("    frame %2d: %9zu kernels, %7.1f MB read, %6.2f s\n", i, shown.size(),
                        1e-6 * static_cast<double>(few.bytes_read), cpu_seconds() - begin);
            std::fflush(stdout);
        }
    }
    wall = watch.seconds();
    std::printf(
        "  dolly, lod %1.0f, %.0f MB kept: %d frames, %.3f s each to choose, %.3f s to draw (CPU); %.2f frames a second;\n"
        "    %.1f MB read in all, at most %.1f MB for a frame after the first; peak %.0f MB\n",
        pixels, 1e-6 * static_cast<double>(kept_bytes), frames, read / frames, drawn / frames, frames / wall,
        1e-6 * static_cast<double>(file.bytes_read() - before), 1e-6 * most, 1e-6 * bench::peak_bytes());
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return std::puts("lod_file FILE.svk [size] [frames] [megabytes] [pixels] [dolly-only]"), 2;
    const auto number = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
    const std::string path = argv[1];
    std::printf("%s: %zu kernels, %.1f MB\n", argv[1], KernelFile(path).contents().kernels,
                1e-6 * static_cast<double>(KernelFile(path).contents().bytes));
    if (argc <= 6) distances(path, number(2, 512));
    if (number(3, 72) > 0) {
        dolly(path, number(2, 512), number(3, 72), static_cast<std::uint64_t>(number(4, 1024)) << 20, number(5, 2));
    }
}
