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

CubeGrid grid_about(const Box& box, const ControlMeshOptions& options, double side) {
    const Vec3 counts = box.size() / side + 3.0;
    constexpr double kEmpty = 64;  // cubes of the grid for each of the mesh
    if (counts.x * counts.y * counts.z > kEmpty * static_cast<double>(options.max_cells)) {
        throw Error(ErrorCode::InvalidInput, "the grid would have too many cubes", option_name("cells", options.names),
                    "fewer cells");
    }
    return {box, side};
}

}  // namespace

CellsInside::CellsInside(const MaterialBodies& bodies, const ControlMeshOptions& options, double side)
    : options_(options), bodies_(bodies), grid_(grid_about(bodies.box(), options, side)), cubes_(grid_) {
    for (Index m = 0; m < bodies.size(); ++m) {
        // Cubes fill about the volume, and layers come on top.
        const double least = bodies[m].least_volume() / (side * side * side);
        if (least > static_cast<double>(options.max_cells)) check_count(static_cast<std::size_t>(std::round(least)));
        if (bodies[m].is_sheet()) refuse_sheet();
    }
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
    for (Index m = 0; m < bodies.size(); ++m) {
        const auto clearly_inside = [&](std::size_t cube) {
            constexpr float kClear = 0.75F;
            return inside_[cube] != 0 && bodies[m].likeness(grid_.center(cube)) > kClear;
        };
        bool clear = !bodies[m].is_open();
        for (std::size_t cube = 0; cube < inside_.size() && !clear; ++cube) clear = clearly_inside(cube);
        if (!clear) refuse_sheet();
    }
}

SizedMesh CellsInside::cells(std::size_t& added) const {
    constexpr std::size_t kParts = 27;
    check_count(cubes_.count() * kParts);
    SizedMesh all = cubes_.cells(near());
    const std::vector<Index> materials = materials_of(all, added);
    SizedMesh made;
    for (std::size_t c = 0; c < materials.size(); ++c) {
        if (materials[c] == kNone) continue;
        made.mesh.cells.push_back(all.mesh.cells[c]);
        made.sides.push_back(all.sides[c]);
        if (bodies_.size() > 1) made.materials.push_back(materials[c]);
    }
    check_count(made.sides.size());
    if (made.sides.empty()) refuse_sheet();
    for (Index m = 0; m < bodies_.size() && bodies_.size() > 1; ++m) {
        if (std::ranges::count(made.materials, m) > 0) continue;
        throw Error(ErrorCode::InvalidInput,
                    "no cell has its middle inside the part of the surface that no smaller one encloses", bodies_.name(m),
                    "a body of its own, and more cells if it is small or thin");
    }
    made.mesh.points = std::move(all.mesh.points);
    made.mesh = without_unused_points(std::move(made.mesh));
    return made;
}

/// The materials of cells, kNone outside of all. Cells are added to materials, by their likeness, until the walls of each and
/// of all together are surfaces.
std::vector<Index> CellsInside::materials_of(const SizedMesh& all, std::size_t& added) const {
    const std::size_t count = all.sides.size();
    const auto kinds = static_cast<Index>(bodies_.size());
    std::vector<std::vector<float>> likenesses(kinds, std::vector<float>(count));
    std::vector<Index> materials(count, kNone);
    parallel_each(count, [&](std::size_t c) {
        const Vec3 middle = middle_of(all.mesh, static_cast<Index>(c));
        for (Index m = kinds; m-- > 0 && !is_cancelled(options_.progress);) {
            likenesses[m][c] = bodies_[m].likeness(middle);
            if (likenesses[m][c] > kHalf) materials[c] = m;
        }
        if (materials[c] == kNone && kinds > 1) materials[c] = bodies_.beside_gap(middle);
    });
    if (is_cancelled(options_.progress)) throw Error(ErrorCode::Cancelled, "stopped in shape");
    added = 0;
    const auto add = [&](const std::vector<float>& likeness, const auto& is_chosen, const auto& is_fixed,
                         const auto& material) {
        std::vector<std::uint8_t> chosen(count), fixed(count);
        for (std::size_t c = 0; c < count; ++c) {
            chosen[c] = is_chosen(materials[c]) ? 1 : 0;
            fixed[c] = is_fixed(materials[c]) ? 1 : 0;
        }
        const std::size_t more = make_manifold(all.mesh, likeness, chosen, fixed);
        for (std::size_t c = 0; c < count; ++c) {
            if (chosen[c] != 0 && !is_chosen(materials[c])) materials[c] = material(c);
        }
        added += more;
        return more;
    };
    const auto likest = [&](std::size_t c) {
        Index most = 0;
        for (Index m = 1; m < kinds; ++m) most = likenesses[m][c] > likenesses[most][c] ? m : most;
        return most;
    };
    std::vector<float> largest(count);
    for (std::size_t c = 0; c < count; ++c) largest[c] = likenesses[likest(c)][c];
    constexpr int kTimes = 8;  // where materials meet one may take from another what that needs
    for (int k = 0; k < kTimes; ++k) {
        std::size_t more = add(
            largest, [](Index m) { return m != kNone; }, [](Index) { return false; }, likest);
        for (Index m = 0; m < kinds && kinds > 1; ++m) {
            more += add(
                likenesses[m], [m](Index own) { return own == m; }, [m](Index own) { return own < m; },
                [m](std::size_t) { return m; });
        }
        if (more == 0 || kinds == 1) break;
    }
    return materials;
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
