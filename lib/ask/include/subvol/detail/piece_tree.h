// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "subvol/detail/limit_place.h"
#include "subvol/detail/median_tree.h"
#include "subvol/limit_level.h"

namespace subvol::detail {

/// A place of the limit near a place in the world.
struct NearPlace {
    LimitPlace place;
    double excess = 0;  ///< how far outside the piece its parameters are, in sides of the cell
    std::size_t piece = 0;
    Vec3 at{0.0};  ///< the place's parameters in the piece, in [0,1]³
};

/// The pieces of a limit in a tree of their boxes.
class PieceTree {
public:
    /// mesh:  its attributes are not used
    /// reach: boxes are larger by this (world), besides the distance of the pieces from the limit
    PieceTree(const HexMesh& mesh, const SchemeOptions& scheme, double reach, Progress* progress);
    /// The same of pieces that are at most `distance` from the limit (world).
    PieceTree(std::shared_ptr<const LimitPieces> pieces, double distance, double reach);

    /// How far the pieces may be from the limit (world).
    [[nodiscard]] double distance() const { return distance_; }
    /// Returns the bounds of all pieces.
    [[nodiscard]] const Box& box() const { return tree_->box(0); }

    /// The pieces that may contain x, the likeliest first, at most a few.
    void find(const Vec3& x, std::vector<NearPlace>& found) const;

private:
    /// A parallelepiped around a piece that fills little of its box: |inverse (x - center)| is at most `half` in it.
    struct Frame {
        Mat3 inverse{1.0};
        Vec3 center{0.0}, half{0.0};
    };
    static constexpr std::size_t kControls = LimitPieces::kNodes;
    [[nodiscard]] std::array<Vec3, kControls> controls_of(std::size_t piece) const;
    [[nodiscard]] Box box_of(std::size_t piece) const;
    [[nodiscard]] std::optional<Frame> frame_of(std::size_t piece) const;
    void make_frames();
    [[nodiscard]] bool may_contain(std::size_t piece, const Vec3& x) const;
    [[nodiscard]] std::optional<NearPlace> invert(std::size_t piece, const Vec3& x) const;

    std::shared_ptr<const LimitPieces> pieces_;
    double distance_ = 0, reach_ = 0;
    std::vector<Box> boxes_;            // of the pieces
    std::vector<Index> frame_numbers_;  // of the pieces, kNone without one
    std::vector<Frame> frames_;
    std::optional<MedianTree<Box>> tree_;
};

/// The limit's pieces within cells.max_bytes: where they would be more, the tolerances are enlarged until they are not.
[[nodiscard]] LimitCells pieces_within(const HexMesh& mesh, const RefineOptions& refinement, LimitCellsOptions cells);

/// The weights of the three nodes at 0, ½ and 1 of a quadratic, and their derivatives.
struct QuadraticWeights {
    explicit QuadraticWeights(double t)
        : values{(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)}, slopes{4 * t - 3, 4 - 8 * t, 4 * t - 1} {}
    std::array<double, 3> values, slopes;
};

}  // namespace subvol::detail
