// SPDX-License-Identifier: Apache-2.0
#include "subvol/bricks.h"

#include <algorithm>
#include <span>

#include "brick_file.h"
#include "brick_index.h"
#include "subvol/detail/gather_cells.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

// Bricks as a mesh: the index is open, a brick is read when it is needed. What is worked out brick by brick takes
// `source_of(bricks)`.

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
    for (std::size_t f = 0; f < about.fields.size(); ++f) read.mesh.attributes[f].bounds = about.fields[f].bounds;
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
    for (const Brick& brick : bricks.bricks) stored.pieces.push_back({brick.cells, brick.points, brick.bounds, brick.reach});
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

HexMesh whole_mesh(const Bricks& bricks, Progress* progress) {
    const detail::GatherOptions all{.reads = [](std::size_t) { return true; },
                                    .chooses = [](const MeshPiece& brick) { return brick.owned_cells; },
                                    .layers = 0,
                                    .progress = progress};
    return std::move(detail::gather_cells(source_of(bricks).stored(), all)->mesh);
}

}  // namespace subvol
