// SPDX-License-Identifier: Apache-2.0
#include "subvol/bricks.h"

#include <algorithm>
#include <span>

#include "boundary_level.h"
#include "brick_file.h"
#include "brick_index.h"
#include "mesh_pieces.h"
#include "subvol/detail/gather_cells.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"
#include "text_scanner.h"
#include "topology_parts.h"

// Bricks as a mesh: the index is open, a brick is read when it is needed. What is worked out brick by brick takes
// `source_of(bricks)`; here is only what needs more of bricks than that, the whole mesh and the cells at its hull.

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

MeshPiece read_brick(const Bricks& bricks, std::size_t brick) {
    const Brick& about = bricks.bricks.at(brick);
    const std::filesystem::path file = bricks.path / about.file;
    MeshPiece read = read_brick_file(file, about.hash, bricks.id);
    // The hash shows that the file is the one that was written; the contents are compared with the index in addition, because
    // the index itself has no hash.
    check_contents(bricks, about, read, file.string());
    return read;
}

Bricks::operator MeshSource() const {
    return source_of(*this);
}

MeshSource source_of(const Bricks& bricks, const BrickFields& fields) {
    MeshSource::Stored stored{.name = bricks.path.string(),
                              .cells = bricks.cells,
                              .points = bricks.points,
                              .bounds = bricks.bounds,
                              .halo_layers = bricks.halo_layers};
    for (const Brick& brick : bricks.bricks) stored.pieces.push_back({brick.cells, brick.bounds, brick.reach});
    for (const BrickField& field : bricks.fields) {
        stored.fields.push_back({field.name, field.channels, std::ranges::min(field.min), std::ranges::max(field.max)});
    }
    stored.read = [&bricks, fields](std::size_t number) {
        MeshPiece piece = read_brick(bricks, number);
        if (fields) piece.mesh = fields(std::move(piece.mesh));
        return piece;
    };
    return MeshSource(std::move(stored));
}

BrickHull gather_hull(const Bricks& bricks, const BrickFields& fields, Progress* progress) {
    std::vector<MeshPiece> parts;
    for_each_piece(source_of(bricks).stored(), "hull", progress, [&](std::size_t, MeshPiece brick) {
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
        // The cells at the hull are few in a large mesh, so they fit into memory although the mesh does not.
        if (std::ranges::find(kept, 1) != kept.end()) parts.push_back(subset(brick, kept));
    });
    MeshPiece all = merged(std::move(parts));
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
                                    .chooses = [](const MeshPiece& brick) { return brick.owned_cells; },
                                    .layers = 0,
                                    .progress = progress};
    return std::move(detail::gather_cells(source_of(bricks).stored(), all)->mesh);
}

}  // namespace subvol
