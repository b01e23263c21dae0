// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mesh_source.h"
#include "subvol/progress.h"

namespace subvol {

/// A field of a mesh in bricks, over the points that cells use.
///
/// min, max:       of each channel
/// shortest, longest: of vectors, their lengths; of one channel, as min and max
/// bounds:         `Attribute::bounds`
struct BrickField {
    std::string name;
    int channels = 1;
    std::vector<double> min, max;
    double shortest = 0, longest = 0;
    std::vector<std::array<double, 2>> bounds{};
};

/// A brick, as the index has it.
///
/// file:          its name in the folder
/// cells, points: that it owns: every cell and every point of the mesh is owned by one brick
/// stored_cells, stored_points: with the halo
/// bounds:        of the owned cells; reach: of their limit and more: no value of the limit in an owned cell lies outside
/// bytes, hash:   of the file
struct Brick {
    std::string file;
    std::uint64_t cells = 0, points = 0;
    std::uint64_t stored_cells = 0, stored_points = 0;
    Box bounds, reach;
    std::uint64_t bytes = 0, hash = 0;
    std::vector<BrickField> fields;
};

/// A mesh in a folder of bricks, of which only the index is in memory.
///
/// id:            of the mesh and of how it was cut: each brick has it too
/// cells, points: of the whole mesh; no point is unused
/// halo_layers:   about the owned cells: cells that share a point with a cell of the layer before
struct Bricks {
    std::filesystem::path path;
    std::uint64_t id = 0;
    std::uint64_t cells = 0, points = 0;
    Box bounds;
    int halo_layers = 0;
    std::vector<BrickField> fields;
    std::vector<Brick> bricks;

    /// `source_of` with the fields as they are; refers to these bricks.
    operator MeshSource() const;
};

/// What is done with the attributes of a brick before it is used: the field that is wanted is left, for example.
using BrickFields = std::function<HexMesh(HexMesh)>;

/// Whether this is a folder of bricks: it has an index.
[[nodiscard]] bool is_bricks(const std::filesystem::path& path);

/// Reads the index of a folder of bricks, and looks for the files that it names.
///
/// throws: Error(Io); Error(InvalidInput) if the index is malformed or of a later version, or a brick is missing or truncated
[[nodiscard]] Bricks open_bricks(const std::filesystem::path& path);

/// Reads a brick with its halo.
///
/// throws: Error(Io); Error(InvalidInput) if the file is not the one that the index describes: changed, or of another mesh
/// cost:   memory: about twice the file while it is read
[[nodiscard]] MeshPiece read_brick(const Bricks& bricks, std::size_t brick);

/// The mesh of all bricks, for what cannot be done brick by brick: points, cells, fields and tags as they were when it was
/// split, without unused points.
///
/// throws: as `read_brick`; Error(Cancelled)
/// cost:   memory: the result twice, and one brick
[[nodiscard]] HexMesh whole_mesh(const Bricks& bricks, Progress* progress = nullptr);

/// The mesh in the bricks, for all that takes a `MeshSource`.
///
/// bricks: is referred to
/// fields: changes the attributes of each brick when it is read; none: they stay
[[nodiscard]] MeshSource source_of(const Bricks& bricks, const BrickFields& fields = {});

}  // namespace subvol
