// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "subvol/detail/boundary_rings.h"
#include "subvol/mixed_mesh.h"
#include "subvol/refine_mixed.h"

namespace subvol::detail {

/// The points of the next level: those of the parent, then one for each edge, quad, octahedron and hexahedron.
class SplitNumbers {
public:
    /// points: of the parent
    SplitNumbers(const MixedMesh& parent, std::size_t points);

    [[nodiscard]] Index edge(Index a, Index b) const;
    /// corners: in any order
    [[nodiscard]] Index quad(std::array<Index, 4> corners) const;
    [[nodiscard]] Index center_of_octahedron(std::size_t cell) const { return first_octahedron_ + octahedron_rank_[cell]; }
    [[nodiscard]] Index center_of_hex(std::size_t cell) const { return first_hex_ + hex_rank_[cell]; }
    [[nodiscard]] bool has_edge(Index a, Index b) const;

    [[nodiscard]] std::size_t size() const { return first_hex_ + hex_rank_.size(); }

    /// Calls add(point of the parent, weight) for the linear split.
    ///
    /// diagonal: the middle of an octahedron is that of its diagonal 0–1; else the mean of its corners
    template <class Add>
    void linear(const MixedMesh& parent, Index point, bool diagonal, const Add& add) const {
        if (point < parent_points_) return add(point, 1.0);
        if (point < first_quad_) return all(edges_[point - parent_points_], add);
        if (point < first_octahedron_) return all(quads_[point - first_quad_], add);
        if (point >= first_hex_) return all(parent.hexes[hex_of_rank_[point - first_hex_]], add);
        const auto& corners = parent.octahedra[octahedron_of_rank_[point - first_octahedron_]];
        if (!diagonal) return all(corners, add);
        add(corners[0], 0.5);
        add(corners[1], 0.5);
    }

private:
    template <class Points, class Add>
    static void all(const Points& points, const Add& add) {
        for (const Index p : points) add(p, 1.0 / static_cast<double>(points.size()));
    }

    std::size_t parent_points_;
    std::vector<std::array<Index, 2>> edges_;  // sorted, as the others
    std::vector<std::size_t> edge_offsets_;    // by the smaller end
    std::vector<std::array<Index, 4>> quads_;
    std::vector<Index> octahedron_rank_, octahedron_of_rank_, hex_rank_, hex_of_rank_;
    std::size_t first_quad_ = 0;
    Index first_octahedron_ = 0, first_hex_ = 0;
};

/// The cells of the next level, in the order of their parents; right-handed if these are.
[[nodiscard]] MixedMesh split_cells(const MixedMesh& parent, const SplitNumbers& numbers);

/// The boundary of a mixed mesh, as the rules need it.
struct MixedBoundary {
    std::vector<std::array<Index, 4>> faces;    ///< oriented outward; the fourth corner of a triangle is kNone
    std::vector<std::array<Index, 2>> creases;  ///< sharp edges, sorted; smaller end first
    std::vector<PointKind> kinds;               ///< kind of each point
};

/// Creases are the boundary edges that mesh.creases names, that belong to one cell only, that have more than two boundary
/// faces, or that are bent by more than the angle. A point with two creases moves along them; one with another number of
/// creases, or where several fans of boundary faces meet, stays.
///
/// throws: Error(InvalidInput) if a face has more than two cells, or a crease of the mesh is not on the boundary
[[nodiscard]] MixedBoundary find_boundary(const MixedMesh& mesh, std::optional<double> crease_angle_deg);

/// The boundary of the next level.
[[nodiscard]] MixedBoundary split_boundary(const MixedBoundary& parent, const SplitNumbers& numbers);

/// A level with its boundary. The mesh has cells and creases alone.
struct MixedLevel {
    MixedMesh cells;
    MixedBoundary boundary;
    std::size_t points = 0;
};

struct MixedStep {
    MixedLevel child;
    StencilTable table;
};

/// The next level and the weights of its points.
[[nodiscard]] MixedStep refine_level(const MixedLevel& parent, const SplitNumbers& numbers, TetScheme scheme);

/// The level of a mesh, checked.
[[nodiscard]] MixedLevel level_of(const MixedMesh& mesh, TetScheme scheme, std::optional<double> crease_angle_deg);

/// The refinement of the cells at one point: the new points around it as weights of the old ones, which correspond to each
/// other.
struct StarMatrix {
    std::vector<Index> points;    ///< points of the cells at the point; the first is the point itself
    std::vector<double> weights;  ///< row r has those of the new point that corresponds to points[r], row-major
};
[[nodiscard]] StarMatrix star_matrix(const MixedMesh& mesh, TetScheme scheme, Index point);

}  // namespace subvol::detail
