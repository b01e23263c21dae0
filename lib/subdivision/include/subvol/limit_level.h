// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "subvol/detail/flat_array.h"
#include "subvol/hex_mesh.h"
#include "subvol/refine.h"

namespace subvol {

/// position_world:        how far a new point may lie from the mean of the parent's points around it
/// value_of_range:        the same for a new value, as a part of its attribute's range
/// max_levels, max_cells: the search goes no further
struct LimitLevelOptions {
    double position_world = 0;
    double value_of_range = 1e-3;
    int max_levels = 4;
    double max_cells = 3e7;
};

/// level:          the level whose trilinear cells approximate the limit
/// position_world: how far the last new points lay from the cells of the level before
/// value_of_range: the same for values
/// converged:      both are within tolerance; otherwise `level` is the finest one within max_levels and max_cells
struct LimitLevel {
    int level = 0;
    double position_world = 0;
    double value_of_range = 0;
    bool converged = false;
};

/// Finds the lowest level for which all new points and values of the next level lie within the tolerances of its trilinear
/// cells. The error to the limit is about a third more: where the field is smooth, each further level adds a quarter of the
/// step before. At each level only the control cells that have not converged yet are refined.
///
/// options.levels is not used.
/// throws: Error(InvalidInput) as `for_each_dense_cell`
[[nodiscard]] LimitLevel find_limit_level(const HexMesh& mesh, RefineOptions refinement, const LimitLevelOptions& options);

/// position_world: how far a piece may lie from the limit
/// value_of_range: the same for values, as a part of their attribute's range
/// max_levels:     nodes are of no finer level; with 0 the cells stay as they are
/// max_bytes:      of pieces that are kept
struct LimitCellsOptions {
    double position_world = 0;
    double value_of_range = 1e-3;
    int max_levels = 6;
    std::size_t max_bytes = std::size_t{1} << 30;
};

/// The limit as pieces of 27 nodes, triquadratic between them: control cells, or their children where these are too coarse, or
/// their children's children. Where the limit is smooth a piece approximates it as well as trilinear cells of two more levels.
///
/// cells:  the control cell of each piece, in ascending order
/// levels: of each piece: 0 for a whole cell; its nodes are vertices of the next level on the limit
/// lowest: its lowest corner in the cell, in steps of 1/2^level along u, v, w
/// hull_sides: of each piece: those on the hull of the mesh, bit i for side i of `kCellFaces`
/// origins: the first node of each piece
/// nodes:  27 for each piece, u fastest, then v, then w: the position relative to the origin, then the channels of all
///         attributes, each relative to its origin in its unit (`value`)
/// names, channels: of the attributes
/// value_origins: of each channel, `value_origin` of its attribute's range: usually 0
/// value_units:   of each channel, a power of two: 1 unless values would leave the range of floats
struct LimitPieces {
    std::vector<Index> cells;
    std::vector<std::uint8_t> levels;
    std::vector<std::array<std::uint8_t, 3>> lowest;
    std::vector<std::uint8_t> hull_sides;
    std::vector<Vec3> origins;
    FlatArray<float> nodes;
    std::vector<std::string> names;
    std::vector<int> channels;
    std::vector<double> value_origins, value_units;
    std::size_t node_size = 3;    // numbers per node
    std::uint64_t mesh_hash = 0;  // of the mesh without attributes
    std::vector<std::uint64_t> attribute_hashes;

    static constexpr std::size_t kNodes = 27;
    /// The numbers of a node.
    [[nodiscard]] const float* node(std::size_t piece, std::size_t n) const { return &nodes[(kNodes * piece + n) * node_size]; }
    /// The value of a channel at a node.
    [[nodiscard]] double value(std::size_t piece, std::size_t n, std::size_t channel) const {
        const auto stored = static_cast<double>(node(piece, n)[3 + channel]);
        const double origin = value_origins[channel], unit = value_units[channel];
        return origin == 0 && unit == 1 ? stored : origin + unit * stored;
    }
    [[nodiscard]] Vec3 position(std::size_t piece, std::size_t n) const {
        const float* x = node(piece, n);
        return origins[piece] + Vec3(x[0], x[1], x[2]);
    }
};

/// The limit's pieces, or how fine they are.
///
/// level:          the level whose trilinear cells approximate positions as well; surfaces are made of their faces
/// cell_levels:    the level of the finest nodes in each control cell, at least 1. Empty if options.max_levels is 0: the cells
///                 stay as they are
/// pieces:         null if there were more than options.max_bytes; then cells are refined to their cell_levels
/// piece_count:    how many there are
/// position_world: how far the pieces are from the limit, as far as the last level that was looked at shows
/// value_of_range: the same for values
/// converged:      both are within tolerance
struct LimitCells {
    int level = 0;
    std::vector<std::uint8_t> cell_levels;
    std::shared_ptr<const LimitPieces> pieces{};
    std::size_t piece_count = 0;
    double position_world = 0;
    double value_of_range = 0;
    bool converged = false;
};

/// Cuts each cell into pieces that are fine enough. A piece is fine enough if the nodes of its children lie within tolerance of
/// it, or if a quarter of the distance of its own nodes from its parent does: where the limit is smooth, no more is left (up to
/// three times as much at its kinks).
///
/// options.levels is not used. Positions and values have the same bits for any number of threads; they are those of `refine`
/// and `on_limit` up to some roundings. throws: Error(InvalidInput) as `for_each_dense_cell`; Error(Cancelled)
[[nodiscard]] LimitCells find_limit_cells(const HexMesh& mesh, RefineOptions refinement, const LimitCellsOptions& options);

/// The same without pieces that are kept: `take` gets them, those of some thousand cells at a time, in the order of the cells,
/// without hashes. They are valid during the call only. options.max_bytes is not used.
///
/// cost: memory: the mesh, some 90 bytes a cell, and the pieces of a sixteenth of the cells, or of 65536 if these are more
[[nodiscard]] LimitCells visit_limit_pieces(const HexMesh& mesh, RefineOptions refinement, const LimitCellsOptions& options,
                                            const std::function<void(const LimitPieces&)>& take);

/// Whether pieces were cut from the cells of this mesh, at the same places.
[[nodiscard]] bool are_pieces_of(const LimitPieces& pieces, const HexMesh& mesh);
/// Where the channels of an attribute begin among the numbers of a node; none if the pieces have no attribute of its name and
/// values.
[[nodiscard]] std::optional<std::size_t> place_in(const LimitPieces& pieces, const Attribute& attribute);

/// The finest level of all nodes and of the trilinear cells.
[[nodiscard]] int finest_level(const LimitCells& limit);

/// The tolerance of positions where the limit is sampled at voxels.
inline constexpr double kLimitTolerance_voxels = 0.1;

/// `find_limit_cells` for a grid with voxels of this size: positions within kLimitTolerance_voxels, values within the default
/// tolerance.
[[nodiscard]] LimitCells limit_for_voxels(const HexMesh& mesh, const RefineOptions& refinement, double voxel_world);

}  // namespace subvol
