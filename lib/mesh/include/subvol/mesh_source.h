// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"

namespace subvol {

/// A part of a mesh. Points and cells have the order that they have in the whole mesh, so that sums have their terms in the
/// same order, and results the same bits.
struct MeshPiece {
    HexMesh mesh;
    std::vector<std::uint64_t> point_numbers, cell_numbers;  ///< numbers in the whole mesh, ascending
    std::vector<std::uint8_t> owned_points, owned_cells;     ///< a flag for each; the others are the halo
};

/// What is known about a piece before it is read.
struct PieceExtent {
    std::uint64_t cells = 0, points = 0;  ///< what it owns
    Box bounds{};                         ///< box of the owned cells
    Box reach{};  ///< box of the limit of the owned cells and more: no value of the limit in an owned cell lies outside
};

/// A field of a whole mesh.
struct SourceField {
    std::string name;
    int channels = 1;
    double min = 0, max = 0;  ///< over the points that cells use, of all channels together
};

/// A mesh in memory, or a mesh in pieces that are read one at a time:
///
///      mesh in memory            a folder of bricks
///      ┌─────────────┐           ┌────┐ ┌────┐ ┌────┐    each with its halo, the layers of cells
///      │ one piece,  │           │ 0  │ │ 1  │ │ 2  │    about it that its limit depends on
///      │ never copied│           └────┘ └────┘ └────┘
///      └─────────────┘
///
/// What measures, cuts and samples the limit takes a source, and gives the same bits for any number of pieces, but for sums,
/// which are added up in the order of the pieces.
class MeshSource {
public:
    /// A mesh in memory, which is referred to.
    MeshSource(const HexMesh& mesh) : mesh_(&mesh) {}

    /// A mesh that is stored in pieces.
    struct Stored {
        std::string name;                     ///< name of the folder, for errors
        std::uint64_t cells = 0, points = 0;  ///< cells and points of the whole mesh
        Box bounds{};
        int halo_layers = 0;  ///< layers of cells around the owned ones
        std::vector<SourceField> fields{};
        std::vector<PieceExtent> pieces{};
        std::function<MeshPiece(std::size_t)> read{};  ///< reads the piece of a number with its halo
    };
    explicit MeshSource(Stored stored) : stored_(std::move(stored)) {}

    /// The mesh, if it is in memory; else null.
    [[nodiscard]] const HexMesh* mesh() const { return mesh_; }
    [[nodiscard]] std::uint64_t cells() const { return mesh_ != nullptr ? mesh_->cells.size() : stored_.cells; }
    /// The box of the points that cells use.
    [[nodiscard]] Box bounds() const { return mesh_ != nullptr ? subvol::bounds(*mesh_) : stored_.bounds; }

    /// The pieces that are read one at a time; none if the mesh is in memory.
    [[nodiscard]] const Stored& stored() const { return stored_; }
    /// The same, where a mesh in memory is one piece, which is copied when it is read. Refers to the mesh.
    [[nodiscard]] Stored in_pieces() const;

    /// The same mesh in pieces with other attributes: `change` gets each piece's mesh when it is read.
    ///
    /// fields: that the pieces then have; may be left out where nobody asks for them
    [[nodiscard]] MeshSource changed(std::function<HexMesh(HexMesh)> change, std::vector<SourceField> fields = {}) const;

    /// throws: Error(InvalidInput) if the pieces have fewer layers of halo than `what` ("values of the limit") depends on
    void check_halo(int layers, const std::string& what) const;

private:
    const HexMesh* mesh_ = nullptr;
    Stored stored_;
};

/// Reads the pieces of a mesh that is not in memory one after the other, in their order, so that the memory is that of one
/// piece, and sums have their terms in one order.
///
/// stage:  for the progress
/// visit:  gets the number of a piece, and the piece
/// throws: what reading throws; Error(Cancelled)
template <class Visit>
void for_each_piece(const MeshSource::Stored& stored, const char* stage, Progress* progress, const Visit& visit) {
    const std::size_t count = stored.pieces.size();
    for (std::size_t piece = 0; piece < count; ++piece) {
        report_progress(progress, stage, piece, count);
        visit(piece, stored.read(piece));
    }
}

/// All cells whose limit may touch a box, as owned cells, with their halo. Pieces that are far from the box are not read.
///
/// source: in pieces
/// cost:   memory: the result twice, and one piece at a time
[[nodiscard]] MeshPiece gather(const MeshSource& source, const Box& box);

/// The cells with a point on the hull of a mesh: all that the boundary of the limit depends on.
struct MeshHull {
    HexMesh mesh;
    std::vector<std::uint8_t> on_hull;  ///< a flag for each point
};

/// Reads all pieces once.
///
/// throws: what reading throws; Error(Cancelled)
/// cost:   memory: the result twice, and one piece
[[nodiscard]] MeshHull gather_hull(const MeshSource& source, Progress* progress = nullptr);

}  // namespace subvol
