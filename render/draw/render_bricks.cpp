// SPDX-License-Identifier: Apache-2.0
#include "subvol/render_bricks.h"

#include <algorithm>
#include <cmath>

#include "kernel_regions.h"
#include "sheet_count.h"
#include "splat_scene.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

// The memory of a kernel while it is drawn: its record, the kernel in eye space, and its entries in the lists of some tiles.
constexpr std::uint64_t kBytesOfKernel = 320;

void check(const BrickSplatOptions& options) {
    const SplatOptions& splat = options.splat;
    if (splat.shadows || splat.ambient_occlusion > 0 || splat.color_channel) {
        throw Error(ErrorCode::InvalidInput, "bricks are drawn without shadows, ambient occlusion and a second field");
    }
    if (splat.method != SplatMethod::Cpu && splat.method != SplatMethod::Auto) {
        throw Error(ErrorCode::InvalidInput, "bricks are drawn by the CPU", {}, "--backend cpu");
    }
}

void copy(const SplatResult& from, const KernelRegions::Region& region, SplatResult& to) {
    for (int y = region.y0; y < region.y1; ++y) {
        for (int x = region.x0; x < region.x1; ++x) {
            const auto pixel = from.image.pixel(x, y);
            std::copy(pixel.begin(), pixel.end(), to.image.pixel(x, y).begin());
            const auto at =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(from.image.width) + static_cast<std::size_t>(x);
            to.depth[at] = from.depth[at];
        }
    }
}

}  // namespace

struct BrickPicture::State {
    State(RbfVolume of_boundary, const View& seen, const Optics& lit, const BrickSplatOptions& options)
        : drawn(std::move(of_boundary)),
          view(seen),
          optics(lit),
          splat(options.splat),
          memory_bytes(options.memory_bytes),
          empty(make_scene(drawn,
                           [&] {
                               SplatOptions bare = options.splat;
                               bare.method = SplatMethod::Cpu;
                               bare.shading.reset();
                               return bare;
                           }())),
          regions(view, options.rows, 2e-4 * empty.diagonal, empty.form == KernelForm::Separable ? 3 : 1, options.scratch) {
        splat.method = SplatMethod::Cpu;
    }

    RbfVolume drawn;  // the boundary, and the kernels of some regions
    View view;
    Optics optics;
    SplatOptions splat;
    std::uint64_t memory_bytes;
    SplatScene empty;  // without kernels
    KernelRegions regions;
    SheetCounts counts{};  // of all kernels of this process
};

BrickPicture::BrickPicture(Surface boundary, const View& view, const Optics& optics, const BrickSplatOptions& options) {
    check(options);
    if (boundary.triangles.empty()) throw Error(ErrorCode::InvalidInput, "there is no boundary");
    RbfVolume drawn;
    drawn.kernel = options.sample.kernel;
    drawn.channels.emplace_back();
    drawn.boundary = std::move(boundary);
    drawn.bounds = box_of(drawn);
    state_ = std::make_unique<State>(std::move(drawn), view, optics, options);
}

BrickPicture::~BrickPicture() = default;

std::vector<PixelRows> BrickPicture::rows_of(const RbfVolume& kernels) const {
    return state_->regions.rows_of(kernels);
}

void BrickPicture::count(const RbfVolume& kernels) {
    count_reaches(state_->empty, state_->view, kernels, state_->counts.reaches);
    count_bends(state_->empty, kernels, state_->counts.bends);
}

void BrickPicture::add(const RbfVolume& kernels, std::span<const std::uint64_t> numbers) {
    if (numbers.empty()) return;
    if (kernels.channels.size() != 1) throw Error(ErrorCode::InvalidInput, "bricks are drawn by one field");
    state_->drawn.channels.front().name = kernels.channels.front().name;
    state_->regions.add(kernels, numbers);
}

SplatResult BrickPicture::draw(const SumCounts& sum) {
    auto& [drawn, view, optics, splat, memory_bytes, empty, regions, counted] = *state_;
    SheetCounts counts = counted;
    counts.add_up(sum);
    if (splat.sheets == 0) splat.needed_sheets = sheets_needed(empty, depth_range_of(empty, view), counts);
    SplatResult result{Image(view.width(), view.height()), {}, {}};
    result.depth.resize(result.image.rgba.size() / 4);
    const auto most = std::max<std::uint64_t>(memory_bytes / kBytesOfKernel, 1);
    std::vector<std::size_t> wanted;
    for (std::size_t k = 0; k < regions.size(); ++k) {
        if (regions.is_drawn(k)) wanted.push_back(k);
    }
    std::vector<std::size_t> group;
    bool first = true;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        group.push_back(wanted[i]);
        std::uint64_t waiting = 0;
        for (const std::size_t g : group) waiting += regions.kernels_in(g);
        const bool last = i + 1 == wanted.size();
        if (!last && waiting + regions.kernels_in(wanted[i + 1]) <= most) continue;
        report_progress(splat.progress, "splat", static_cast<double>(i) / static_cast<double>(wanted.size()));
        if (waiting > 0 || first) {
            regions.take(group, drawn);
            SplatOptions quiet = splat;
            quiet.progress = nullptr;
            SplatResult some = Splatter(drawn, quiet).draw(view, optics);
            result.report.seconds_prepare += some.report.seconds_prepare;
            result.report.seconds_draw += some.report.seconds_draw;
            result.report.bin_entries += some.report.bin_entries;
            if (first) {  // where no kernel is, all of them have the same
                result.image = some.image;
                result.depth = some.depth;
                result.report.backend = some.report.backend;
                result.report.device = some.report.device;
                result.report.sheets = some.report.sheets;
                result.report.boundary_hits = some.report.boundary_hits;
            }
            first = false;
            result.report.sheets_finest = std::max(result.report.sheets_finest, some.report.sheets_finest);
            for (const std::size_t g : group) copy(some, regions.region(g), result);
        }
        group.clear();
    }
    report_progress(splat.progress, "splat", 1);
    result.report.points = static_cast<std::size_t>(counts.reaches.kernels());
    return result;
}

SplatResult render_bricks(const MeshSource& source, Surface boundary, const View& view, const Optics& optics,
                          const BrickSplatOptions& options) {
    BrickPicture picture(std::move(boundary), view, optics, options);
    SampleOptions quiet = options.sample;
    quiet.progress = nullptr;
    for_each_piece(source.in_pieces(), "sample", options.splat.progress, [&](std::size_t, MeshPiece piece) {
        const PieceKernels kernels = sample_piece(source, std::move(piece), quiet);
        picture.add(kernels.volume, kernels.numbers);
        picture.count(kernels.volume);
    });
    return picture.draw();
}

}  // namespace subvol
