// SPDX-License-Identifier: Apache-2.0
#include "subvol/bricks.h"

#include <algorithm>
#include <span>

#include "boundary_level.h"
#include "brick_file.h"
#include "brick_index.h"
#include "brick_layers.h"
#include "subvol/detail/bricks_share.h"
#include "subvol/detail/gather_cells.h"
#include "subvol/detail/mesh_share.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"
#include "text_scanner.h"
#include "topology_parts.h"

namespace subvol {

using namespace detail;

bool is_bricks(const std::filesystem::path& path) {
    std::error_code error;
    return std::filesystem::is_regular_file(path / kBricksIndex, error);
}

Bricks open_bricks(const std::filesystem::path& path) {
    const std::filesystem::path index = path / kBricksIndex;
    Bricks bricks = bricks_from_json(read_regular(index), index.string());
    bricks.path = path;
    check_files(bricks);
    return bricks;
}

BrickMesh read_brick(const Bricks& bricks, std::size_t brick) {
    const Brick& about = bricks.bricks.at(brick);
    const std::filesystem::path file = bricks.path / about.file;
    BrickMesh read = read_brick_file(file, about.hash, bricks.id);
    check_contents(bricks, about, read, file.string());
    return read;
}

BrickMesh gather(const Bricks& bricks, const Box& box) {
    const auto reads = [&](std::size_t b) { return touch(bricks.bricks[b].reach, box); };
    const auto chooses = [&](const BrickMesh& brick) {
        const CellReaches reaches(brick.mesh);
        std::vector<std::uint8_t> chosen = brick.owned_cells;
        for (std::size_t c = 0; c < chosen.size(); ++c) chosen[c] = chosen[c] && touch(reaches(c), box);
        return chosen;
    };
    return *gather_cells(bricks, {.reads = reads, .chooses = chooses, .layers = bricks.halo_layers});
}

MeshShare detail::inspect_share(const Bricks& bricks, std::size_t begin, std::size_t end, std::size_t inverted_at_most,
                                Progress* progress) {
    MeshShare share;
    MeshReport& counts = share.counts;
    for (std::size_t b = begin; b < end; ++b) {
        report_progress(progress, "inspect", static_cast<double>(b - begin) / static_cast<double>(end - begin));
        const BrickMesh brick = read_brick(bricks, b);
        counts.volume = 0;
        const std::size_t inverted_before = counts.inverted_cells;
        add_part(brick.mesh, brick.owned_points, brick.owned_cells, counts);
        share.volumes.push_back(counts.volume);
        if (counts.inverted_cells == inverted_before) continue;
        for (const std::size_t cell : inverted_cells(brick.mesh, brick.mesh.cells.size())) {
            if (brick.owned_cells[cell]) share.inverted.push_back(static_cast<std::size_t>(brick.cell_numbers[cell]));
        }
        std::ranges::sort(share.inverted);
        share.inverted.resize(std::min(share.inverted.size(), inverted_at_most));
    }
    if (begin == end) counts.min_scaled_jacobian = 1;
    counts.volume = 0;
    counts.points = bricks.points;
    counts.cells = bricks.cells;
    counts.bounds = bricks.bounds;
    return share;
}

MeshReport inspect(const Bricks& bricks, Progress* progress) {
    const MeshShare all = inspect_share(bricks, 0, bricks.bricks.size(), 0, progress);
    return join_shares(std::span(&all, 1), 0).counts;
}

BrickHull gather_hull(const Bricks& bricks, const BrickFields& fields, Progress* progress) {
    std::vector<BrickMesh> parts;
    for (std::size_t b = 0; b < bricks.bricks.size(); ++b) {
        report_progress(progress, "hull", static_cast<double>(b) / static_cast<double>(bricks.bricks.size()));
        BrickMesh brick = read_brick(bricks, b);
        const std::vector<std::uint8_t> on_hull = hull_points_of_owned(brick);
        if (fields) {
            brick.mesh = fields(std::move(brick.mesh));
        } else {
            brick.mesh.attributes.clear();
        }
        brick.owned_points = on_hull;  // so that merging puts the flags together
        std::vector<std::uint8_t> kept(brick.owned_cells.size());
        for (std::size_t c = 0; c < kept.size(); ++c) {
            kept[c] =
                brick.owned_cells[c] && std::ranges::any_of(brick.mesh.cells[c], [&](Index p) { return on_hull[p] != 0; });
        }
        if (std::ranges::find(kept, 1) == kept.end()) continue;
        parts.push_back(subset(brick, kept));
    }
    BrickMesh all = merged(std::move(parts));
    const auto at_hull = [&](const auto& tag) {
        return std::ranges::any_of(tag, [&](Index p) { return all.owned_points[p] != 0; });
    };
    std::erase_if(all.mesh.creases, [&](const auto& crease) { return !at_hull(crease); });
    std::erase_if(all.mesh.sharp_faces, [&](const auto& face) { return !at_hull(face); });
    return {std::move(all.mesh), std::move(all.owned_points)};
}

BoundaryValues boundary_values(const BrickHull& hull, const SchemeOptions& scheme, std::optional<int> levels) {
    const auto at_hull = [&](const auto& face) {
        return std::ranges::all_of(face, [&](Index p) { return hull.on_hull[p] != 0; });
    };
    const int sensible = picture_levels(2 * hull_quads(hull.mesh, at_hull).size(), levels);
    return boundary_values_of_hull(hull.mesh, hull.on_hull, {.scheme = scheme, .levels = sensible});
}

HexMesh whole_mesh(const Bricks& bricks, Progress* progress) {
    const detail::GatherOptions all{.reads = [](std::size_t) { return true; },
                                    .chooses = [](const BrickMesh& brick) { return brick.owned_cells; },
                                    .layers = 0,
                                    .progress = progress};
    return std::move(detail::gather_cells(bricks, all)->mesh);
}

}  // namespace subvol
