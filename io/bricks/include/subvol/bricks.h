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
struct BrickField {
    std::string name;
    int channels = 1;
    std::vector<double> min, max;                 ///< range of each channel
    double shortest = 0, longest = 0;             ///< range of the lengths of vectors; for one channel, as min and max
    std::vector<std::array<double, 2>> bounds{};  ///< `Attribute::bounds`
};

/// A brick, as the index has it.
struct Brick {
    std::string file;                     ///< name of the file in the folder
    std::uint64_t cells = 0, points = 0;  ///< what it owns: every cell and every point of the mesh is owned by one brick
    std::uint64_t stored_cells = 0, stored_points = 0;  ///< what it owns, with the halo
    Box bounds;                                         ///< box of the owned cells
    Box reach;  ///< box of the limit of the owned cells and more: no value of the limit in an owned cell lies outside
    std::uint64_t bytes = 0, hash = 0;  ///< size and hash of the file
    std::vector<BrickField> fields;
};

/// A mesh in a folder of bricks, of which only the index is in memory.
struct Bricks {
    std::filesystem::path path;
    std::uint64_t id = 0;                 ///< identifies the mesh and how it was cut: each brick has it too
    std::uint64_t cells = 0, points = 0;  ///< cells and points of the whole mesh; no point is unused
    Box bounds;
    int halo_layers = 0;  ///< layers around the owned cells: cells that share a point with a cell of the layer before
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
