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

struct LimitLevelOptions {
    double position_world = 0;     ///< how far a new point may lie from the mean of the parent's points around it
    double value_of_range = 1e-3;  ///< the same for a new value, as a part of its attribute's range
    int max_levels = 4;            ///< the search goes to no finer level
    double max_cells = 3e7;        ///< the search goes no further
};

struct LimitLevel {
    int level = 0;              ///< the level whose trilinear cells approximate the limit
    double position_world = 0;  ///< how far the last new points lay from the cells of the level before
    double value_of_range = 0;  ///< the same for values
    /// `position_world` and `value_of_range` are within tolerance; otherwise `level` is the finest one within max_levels and
    /// max_cells
    bool converged = false;
};

/// Finds the lowest level for which all new points and values of the next level lie within the tolerances of its trilinear
/// cells. The error to the limit is about a third more: where the field is smooth, each further level adds a quarter of the
/// step before. At each level only the control cells that have not converged yet are refined.
///
/// options.levels is not used.
/// throws: Error(InvalidInput) as `for_each_dense_cell`
[[nodiscard]] LimitLevel find_limit_level(const HexMesh& mesh, RefineOptions refinement, const LimitLevelOptions& options);

struct LimitCellsOptions {
    double position_world = 0;                     ///< how far a piece may lie from the limit
    double value_of_range = 1e-3;                  ///< the same for values, as a part of their attribute's range
    int max_levels = 6;                            ///< nodes are of no finer level; with 0 the cells stay as they are
    std::size_t max_bytes = std::size_t{1} << 30;  ///< the most bytes of pieces that are kept
};

/// The limit as pieces of 27 nodes, triquadratic between them: control cells, or their children where these are too coarse, or
/// their children's children. Where the limit is smooth a piece approximates it as well as trilinear cells of two more levels.
struct LimitPieces {
    std::vector<Index> cells;  ///< the control cell of each piece, in ascending order
    /// Level of each piece: 0 for a whole cell; its nodes are vertices of the next level on the limit
    std::vector<std::uint8_t> levels;
    /// Lowest corner of each piece in the cell, in steps of 1/2^level along u, v, w
    std::vector<std::array<std::uint8_t, 3>> lowest;
    std::vector<std::uint8_t> hull_sides;  ///< sides of each piece on the hull of the mesh, bit i for side i of `kCellFaces`
    std::vector<Vec3> origins;             ///< first node of each piece
    /// 27 for each piece, u fastest, then v, then w: the position relative to the origin, then the channels of all attributes,
    /// each relative to its origin in its unit (`value`)
    FlatArray<float> nodes;
    std::vector<std::string> names;     ///< names of the attributes
    std::vector<int> channels;          ///< channels of the attributes
    std::vector<double> value_origins;  ///< for each channel, `value_origin` of its attribute's range: usually 0
    std::vector<double> value_units;    ///< for each channel, a power of two: 1 unless values would leave the range of floats
    std::size_t node_size = 3;          ///< numbers per node
    std::uint64_t mesh_hash = 0;        ///< of the mesh without attributes
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
struct LimitCells {
    int level = 0;  ///< the level whose trilinear cells approximate positions as well; surfaces are made of their faces
    /// The level of the finest nodes in each control cell, at least 1. Empty if options.max_levels is 0: the cells stay as they
    /// are
    std::vector<std::uint8_t> cell_levels;
    /// Null if there were more than options.max_bytes; then cells are refined to their cell_levels
    std::shared_ptr<const LimitPieces> pieces{};
    std::size_t piece_count = 0;  ///< how many pieces there are
    double position_world = 0;    ///< how far the pieces are from the limit, as far as the last level that was looked at shows
    double value_of_range = 0;    ///< the same for values
    bool converged = false;       ///< `position_world` and `value_of_range` are within tolerance
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
