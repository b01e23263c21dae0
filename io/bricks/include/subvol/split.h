// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/bricks.h"
#include "subvol/mesh_io.h"
#include "subvol/names.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"

namespace subvol {

/// Which cells make a brick.
///
/// Blocks: compact ones: the longest side of the box of the cells' centres is halved, and the halves likewise
/// Slabs:  slices of the longest side
/// Random: any: for tests
enum class BrickShape { Blocks, Slabs, Random };

template <>
struct NameTable<BrickShape> {
    static constexpr Name<BrickShape> rows[] = {{BrickShape::Blocks, "blocks", "compact"},
                                                {BrickShape::Slabs, "slabs", "slices of the longest side"},
                                                {BrickShape::Random, "random", "for tests"}};
};

struct SplitOptions {
    std::size_t bricks = 0;  ///< number of bricks; 0: as many as `memory_bytes` asks for
    /// About the most that a command takes for one brick; some 1,000 bytes a cell
    std::uint64_t memory_bytes = std::uint64_t{1} << 30;
    BrickShape shape = BrickShape::Blocks;
    /// 1 to 16. Values and gradients of the limit need 3, and so do kernels of the schemes MCQ and linear; those of other
    /// schemes need 4. Kernels with the correction `Full` need one more
    int halo_layers = 3;
    std::uint64_t seed = 0;  ///< seed of random bricks
    Progress* progress = nullptr;
};

/// bricks, memory, halo, by
[[nodiscard]] std::vector<Option> options_of(SplitOptions& options);

struct SplitResult {
    Bricks bricks;            ///< the folder as `open_bricks` returns it
    std::size_t written = 0;  ///< bricks that were written
    std::size_t kept = 0;     ///< bricks that were kept of an interrupted run
    std::uint64_t bytes = 0;  ///< bytes written
};

/// The brick of each cell.
///
/// throws: Error(InvalidInput) if there are no bricks, or more than cells
[[nodiscard]] std::vector<std::uint32_t> bricks_of_cells(const HexMesh& mesh, const SplitOptions& options);

/// Cuts a mesh into bricks and writes them into a folder: an index, and a file for each brick that opens alone, in this program
/// and in ParaView, where vtkGhostType marks the halo.
///
/// The bricks are written beside the folder, which appears when all are there. A run that was interrupted is continued by the
/// same call: finished bricks with the right hash are kept. A folder of bricks is replaced if it holds nothing but the index
/// and what that lists, file by file; anything else is not. A link to a folder stays a link.
///
/// mesh:   valid; points that no cell uses are left out, and fields with the names GlobalNodeId and vtkGhostType
/// throws: Error(InvalidInput) for options out of range, or if `folder`, or NAME.unfinished beside it, exists and holds
///         anything else than bricks; Error(Io)
SplitResult split_mesh(const std::filesystem::path& folder, HexMesh mesh, const SplitOptions& options = {});

/// The same for given bricks. brick_of_cell: one number for each cell; numbers without cells make no brick
SplitResult split_mesh(const std::filesystem::path& folder, HexMesh mesh, std::span<const std::uint32_t> brick_of_cell,
                       const SplitOptions& options = {});

/// How to read a mesh in pieces.
struct PiecesOptions {
    ReadOptions read = {};
    BrickFields change = {};  ///< what is done with each brick's mesh before it is written: another field, for example
    /// What `change` does, in any words: a split that was interrupted goes on only if the words are the same
    std::string about_change = {};
};

struct PiecesSplit {
    std::optional<SplitResult> result;  ///< nothing if the mesh must be held whole: then nothing has been written
    /// Why the mesh must be held whole, such as "it has curved cells"; empty if the file is not a list of pieces
    std::string held_whole;
    std::vector<std::string> warnings;  ///< warnings of `read_mesh`
};

/// Cuts a mesh in pieces (.pvtu, .vtm and others that name several files) into bricks without holding it: the bricks are those
/// of `split_mesh` of the mesh that `read_mesh` makes of the pieces. The pieces are read one at a time, two or three times
/// each; their points and cells wait in files without names beside `folder`, some 100 bytes a cell.
///
/// returns: nothing as result if the file is not such a list, or the pieces are not hexahedra with plain corners, or
///          pieces.read asks for welded points or fitted values
/// throws:  as `read_mesh` and `split_mesh`; Error(InvalidInput) if a piece changes meanwhile
/// cost:    memory: a piece, or 16 bytes a cell, or 12 bytes a cell and a brick
PiecesSplit split_pieces(const std::filesystem::path& folder, const std::filesystem::path& mesh,
                         const PiecesOptions& pieces = {}, const SplitOptions& options = {});

/// Writes the model `twist` with resolution³ cells as bricks, brick by brick: the bits are those of `make_model`.
///
/// resolution: 2 to 4096. options.shape: Blocks or Slabs
/// cost:       memory: that of one brick
SplitResult split_twist(const std::filesystem::path& folder, int resolution, const SplitOptions& options = {});

}  // namespace subvol
