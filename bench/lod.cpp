// SPDX-License-Identifier: Apache-2.0
// What merging kernels for distant views saves and costs: kernels drawn, seconds and PSNR against all kernels at three
// distances, over the pixels that the body covers; and whether pictures pop in a dolly, as the largest change from frame to
// frame.
//
//   lod MODEL|FILE [size = 512] [per_edge = 1] [frames = 72] [gl]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "lod_scene.h"
#include "subvol/image_metrics.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace {

using namespace subvol;
using namespace subvol::bench;

class Study {
public:
    Study(const std::string& name, int size, int per_edge)
        : name_(name),
          size_(size),
          options_{.method = SplatMethod::Cpu},
          mesh_(mesh_named(name)),
          volume_(sample_rbf_points(mesh_, {.per_edge = per_edge}).volume),
          splatter_(volume_, options_),
          optics_(optics_with_peak(mesh_)) {
        seconds_build_ = cpu_seconds_of([&] { hierarchy_ = build_kernel_hierarchy(volume_); }, 1);
        std::printf("%s: %zu cells, %zu kernels; hierarchy: %.2f s, %zu nodes\n", name_.c_str(), mesh_.cells.size(),
                    volume_.size(), seconds_build_, hierarchy_.nodes.size());
    }

    void distances() {
        for (const double distance : {1.0, 4.0, 16.0}) {
            const View view = view_at(volume_.bounds, distance, size_);
            RbfVolume few;
            SplatResult all;
            const double seconds_all = cpu_seconds_of(
                [&] {
                    splatter_.set_kernels(volume_);  // so that nothing is kept from the picture before
                    all = splatter_.draw(view, optics_);
                },
                2);
            PixelMask seen;
            for (std::size_t i = 3; i < all.image.rgba.size(); i += 4) seen.push_back(all.image.rgba[i] > 0 ? 1 : 0);
            std::printf("  distance %2.0f: all %8zu kernels %4d sheets %7.3f s\n", distance, volume_.size(), all.report.sheets,
                        seconds_all);
            for (const double pixels : {1.0, 2.0, 4.0}) {
                SplatResult drawn;
                const double choose =
                    cpu_seconds_of([&] { few = choose_level(hierarchy_, volume_, view, {.pixels = pixels}); }, 2);
                const double seconds = cpu_seconds_of(
                    [&] {
                        splatter_.set_kernels(few);
                        drawn = splatter_.draw(view, optics_);
                    },
                    2);
                const ImageMetrics off = compare_images(drawn.image, all.image, seen);
                std::printf("    lod %1.0f: %8zu kernels %4d sheets  choose %.3f s  draw %7.3f s  psnr %5.1f  max %.4f\n",
                            pixels, few.size(), drawn.report.sheets, choose, seconds, off.psnr, off.max);
                std::fflush(stdout);
            }
        }
    }

    /// Motion changes pictures much more than popping does, so the difference from the picture of all kernels is followed, too.
    void dolly(int frames) {
        std::vector<View> views;
        for (int i = 0; i < frames; ++i) {
            views.push_back(view_at(volume_.bounds, std::pow(16.0, double(i) / std::max(frames - 1, 1)), size_ / 2));
        }
        std::vector<Image> all;
        splatter_.set_kernels(volume_);
        const double seconds_all = cpu_seconds_of(
            [&] {
                for (const View& view : views) all.push_back(splatter_.draw(view, optics_).image);
            },
            1);
        print_changes(0, all, seconds_all);
        for (const double pixels : {1.0, 2.0}) {
            std::vector<Image> drawn, differences = all;
            RbfVolume few;
            const double seconds = cpu_seconds_of(
                [&] {
                    for (const View& view : views) {
                        few = choose_level(hierarchy_, volume_, view, {.pixels = pixels});
                        splatter_.set_kernels(few);
                        drawn.push_back(splatter_.draw(view, optics_).image);
                    }
                },
                1);
            splatter_.set_kernels(volume_);
            print_changes(pixels, drawn, seconds);
            for (std::size_t i = 0; i < drawn.size(); ++i) {
                for (std::size_t k = 0; k < drawn[i].rgba.size(); ++k) differences[i].rgba[k] -= drawn[i].rgba[k];
            }
            std::printf("    of the difference from all kernels:");
            print_changes(pixels, differences, 0);
        }
    }

private:
    static void print_changes(double pixels, const std::vector<Image>& frames, double seconds) {
        double mean_rmse = 0, most_rmse = 0, most = 0, jump = 0, before = -1;
        for (std::size_t i = 1; i < frames.size(); ++i) {
            const ImageMetrics change = compare_images(frames[i], frames[i - 1]);
            mean_rmse += change.rmse / static_cast<double>(frames.size() - 1);
            most_rmse = std::max(most_rmse, change.rmse);
            most = std::max(most, change.max);
            if (before >= 0) jump = std::max(jump, std::abs(change.rmse - before));
            before = change.rmse;
        }
        std::printf(
            "  dolly, lod %1.0f: rmse from frame to frame: mean %.5f  most %.5f  its largest jump %.5f  a pixel's largest "
            "%.4f  %6.1f s\n",
            pixels, mean_rmse, most_rmse, jump, most, seconds);
        std::fflush(stdout);
    }

    std::string name_;
    int size_;
    SplatOptions options_;
    HexMesh mesh_;
    RbfVolume volume_;
    Splatter splatter_;
    Optics optics_;
    KernelHierarchy hierarchy_;
    double seconds_build_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return std::puts("lod MODEL|FILE [size] [per_edge] [frames] [dolly-only]"), 2;
    const auto number = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
    Study study(argv[1], number(2, 512), number(3, 1));
    if (argc <= 5) study.distances();
    study.dolly(number(4, 72));
}
