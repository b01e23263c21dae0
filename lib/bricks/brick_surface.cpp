// SPDX-License-Identifier: Apache-2.0
#include "subvol/brick_surface.h"

#include <algorithm>

#include "brick_layers.h"
#include "subvol/error.h"
#include "surface_part.h"

namespace subvol {

using namespace detail;

namespace {

/// The numbers of the cells that a surface may pass through, and of `layers` of cells about them. whole: becomes the extent of
/// all bricks
std::vector<std::uint64_t> wanted_cells(const Bricks& bricks, std::string_view field, const SurfaceOptions& options,
                                        const BrickFields& fields, int layers, LimitExtent& whole) {
    SurfaceOptions quiet = options;
    quiet.progress = nullptr;
    std::vector<std::uint64_t> wanted;
    for (std::size_t b = 0; b < bricks.bricks.size(); ++b) {
        report_progress(options.progress, "look", static_cast<double>(b) / static_cast<double>(bricks.bricks.size()));
        BrickMesh brick = read_brick(bricks, b);
        if (fields) brick.mesh = fields(std::move(brick.mesh));
        whole.add(limit_extent(brick.mesh));
        std::vector<std::uint8_t> here = surface_candidates(brick.mesh, field, quiet);
        for (std::size_t c = 0; c < here.size(); ++c) here[c] = here[c] && brick.owned_cells[c];
        grow(brick.mesh, here, layers);
        for (std::size_t c = 0; c < here.size(); ++c) {
            if (here[c]) wanted.push_back(brick.cell_numbers[c]);
        }
    }
    std::ranges::sort(wanted);
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    return wanted;
}

/// The cells that a surface may pass through, with `layers` of cells about them, their halos, and the extent of the whole.
struct AboutSurface {
    BrickMesh part;
    LimitExtent whole;
};
std::optional<AboutSurface> about_surface(const Bricks& bricks, std::string_view field, const SurfaceOptions& options,
                                          const BrickFields& fields, int layers) {
    AboutSurface about;
    const std::vector<std::uint64_t> wanted = wanted_cells(bricks, field, options, fields, layers, about.whole);
    if (wanted.empty()) return {};
    const auto chosen = [&](const BrickMesh& brick) {
        std::vector<std::uint8_t> flags = brick.owned_cells;
        for (std::size_t c = 0; c < flags.size(); ++c) {
            flags[c] = flags[c] && std::ranges::binary_search(wanted, brick.cell_numbers[c]);
        }
        return flags;
    };
    about.part = *gather_cells(
        bricks, {.reads = [](std::size_t) { return true; }, .chooses = chosen, .fields = fields, .progress = options.progress});
    return about;
}

/// From cells of a part to those of the whole.
void rename(LimitQuery& place, const BrickMesh& part) {
    const std::uint64_t number = part.cell_numbers[place.cell];
    place.cell = number < kNone ? static_cast<Index>(number) : kNone;
}

}  // namespace

LimitSurface limit_surface(const Bricks& bricks, std::string_view field, const SurfaceOptions& options,
                           const BrickFields& fields) {
    check_surface_options(options);
    check_halo_of_limit(bricks);
    // The boundary leads nowhere; an isosurface may lead out of the cells that the first look finds.
    for (int layers = options.isos.empty() ? 0 : 1; layers <= bricks.halo_layers; ++layers) {
        const auto about = about_surface(bricks, field, options, fields, layers);
        if (!about) return {};
        const BrickMesh& part = about->part;
        auto surface = limit_surface_of_part(part.mesh, part.owned_cells, about->whole, field, options);
        if (!surface) continue;
        for (LimitQuery& place : surface->places) rename(place, part);
        return std::move(*surface);
    }
    throw Error(ErrorCode::InvalidInput, "an isosurface leads farther than the halo of its bricks", bricks.path.string(),
                "split with a larger --halo");
}

std::string detail::share_of_surface(const Bricks& bricks, std::string_view field, const SurfaceOptions& options,
                                     const Share& share, const BrickFields& fields) {
    check_surface_options(options);
    check_halo_of_limit(bricks);
    const auto about = about_surface(bricks, field, options, fields, layers_of_shares(options));
    if (!about) return empty_surface_share();
    const BrickMesh& part = about->part;
    auto bytes = share_of_part(part.mesh, part.owned_cells, about->whole, field, options, share,
                               [&](LimitQuery& place) { rename(place, part); });
    if (!bytes) fail_far_share(bricks.path.string());
    return std::move(*bytes);
}

}  // namespace subvol
