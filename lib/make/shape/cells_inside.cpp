// SPDX-License-Identifier: Apache-2.0
#include "cells_inside.h"

#include <algorithm>
#include <cmath>

#include "castle.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "surface_distances.h"

namespace subvol::detail {
namespace {

constexpr float kHalf = 0.5F;

[[noreturn]] void refuse_sheet() {
    throw Error(ErrorCode::InvalidInput,
                "no cell has its middle inside the surface, as it is a sheet, which encloses no volume", "surface",
                "a closed surface");
}

CubeGrid grid_about(const Surface& surface, const ControlMeshOptions& options, double side) {
    const Box box = bounds(surface);
    const Vec3 counts = box.size() / side + 3.0;
    constexpr double kEmpty = 64;  // cubes of the grid for each of the mesh
    if (counts.x * counts.y * counts.z > kEmpty * static_cast<double>(options.max_cells)) {
        throw Error(ErrorCode::InvalidInput, "the grid would have too many cubes", option_name("cells", options.names),
                    "fewer cells");
    }
    return {box, side};
}

}  // namespace

CellsInside::CellsInside(const SurfaceBodies& bodies, const ControlMeshOptions& options, double side)
    : options_(options), bodies_(bodies), grid_(grid_about(bodies.surface(), options, side)), cubes_(grid_) {
    // Cubes fill about the volume, and layers come on top.
    const double least = bodies.least_volume() / (side * side * side);
    if (least > static_cast<double>(options.max_cells)) check_count(static_cast<std::size_t>(std::round(least)));
    if (bodies.is_sheet()) refuse_sheet();
    inside_.resize(grid_.size());
    std::size_t found = 0;
    constexpr std::size_t kTogether = std::size_t{1} << 18;
    for (std::size_t begin = 0; begin < inside_.size(); begin += kTogether) {
        const std::size_t count = std::min(kTogether, inside_.size() - begin);
        parallel_each(count, [&](std::size_t k) {
            if (!is_cancelled(options.progress)) inside_[begin + k] = bodies.likeness(grid_.center(begin + k)) > kHalf ? 1 : 0;
        });
        report_progress(options.progress, "fill", begin + count, inside_.size());  // ends what was cancelled
        for (std::size_t k = begin; k < begin + count; ++k) found += inside_[k];
        check_count(found);
    }
    if (found == 0) {
        throw Error(ErrorCode::InvalidInput, "no cell has its middle inside the surface", "surface",
                    "a closed surface, and more cells if it is thin");
    }
    // Beside a bent sheet the surface winds by a half and a little more, somewhere inside of what it encloses by nearly
    // one.
    const auto clearly_inside = [&](std::size_t cube) {
        constexpr float kClear = 0.75F;
        return inside_[cube] != 0 && bodies.likeness(grid_.center(cube)) > kClear;
    };
    bool clear = !bodies.is_open();
    for (std::size_t cube = 0; cube < inside_.size() && !clear; ++cube) clear = clearly_inside(cube);
    if (!clear) refuse_sheet();
}

SizedMesh CellsInside::cells(std::size_t& added) const {
    constexpr std::size_t kParts = 27;
    check_count(cubes_.count() * kParts);
    SizedMesh all = cubes_.cells(near());
    std::vector<float> likenesses(all.sides.size());
    std::vector<std::uint8_t> chosen(all.sides.size());
    parallel_each(chosen.size(), [&](std::size_t c) {
        if (is_cancelled(options_.progress)) return;
        likenesses[c] = bodies_.likeness(middle_of(all.mesh, static_cast<Index>(c)));
        chosen[c] = likenesses[c] > kHalf ? 1 : 0;
    });
    if (is_cancelled(options_.progress)) throw Error(ErrorCode::Cancelled, "stopped in shape");
    added = make_manifold(all.mesh, likenesses, chosen);
    SizedMesh made;
    for (std::size_t c = 0; c < chosen.size(); ++c) {
        if (chosen[c] == 0) continue;
        made.mesh.cells.push_back(all.mesh.cells[c]);
        made.sides.push_back(all.sides[c]);
    }
    check_count(made.sides.size());
    if (made.sides.empty()) refuse_sheet();
    made.mesh.points = std::move(all.mesh.points);
    made.mesh = without_unused_points(std::move(made.mesh));
    return made;
}

void CellsInside::check_count(std::size_t cells) const {
    if (cells <= options_.max_cells) return;
    throw Error(
        ErrorCode::InvalidInput,
        "there would be " + std::to_string(cells) + " or more" + (cubes_.count() > 0 ? " cells with divided cubes" : " cells"),
        option_name("cells", options_.names),
        std::string("fewer cells, ") + (cubes_.count() > 0 ? "a larger tolerance, " : "") + "or more with --max-cells");
}

/// Cubes inside and divided ones, and those that may be needed around them.
std::vector<std::uint8_t> CellsInside::near() const {
    std::vector<std::uint8_t> chosen(grid_.size(), 0);
    for (std::size_t cube = 0; cube < chosen.size(); ++cube) {
        const bool divided = cubes_.divided(cube);
        if (!divided && inside_[cube] == 0) continue;
        for (const std::size_t next : grid_.around(cube, divided ? 1 : 2)) chosen[next] = 1;
    }
    return chosen;
}

}  // namespace subvol::detail
