// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <queue>
#include <vector>

#include "subvol/camera.h"
#include "subvol/mixed_mesh.h"

namespace subvol::bench {

/// Multiresolution of a mesh of tetrahedra, for comparison with hierarchies of kernels: its points are taken away one by one by
/// half-edge collapses, the one with the least error of the field first. The vertex splits that undo them are partly ordered,
/// so that a view takes those that it needs, with those that these need. source: [cfm2004]
class CollapseHierarchy {
public:
    /// mesh: of tetrahedra alone; its first field is kept
    explicit CollapseHierarchy(const MixedMesh& mesh);

    /// The mesh for a view: a split is taken if an edge that it undoes is longer than so many pixels, and the field is off by
    /// more than `error` there, in parts of its range.
    [[nodiscard]] MixedMesh cut(const View& view, double pixels, double error) const;

    [[nodiscard]] std::size_t collapses() const { return nodes_.size(); }
    [[nodiscard]] std::size_t tets() const { return tets_.size(); }  // of all levels

private:
    static constexpr std::uint32_t kNever = ~std::uint32_t{0};

    /// made_by, undone_by: the collapses that made it and took it away
    struct Tet {
        std::array<Index, 4> corners{};
        std::uint32_t made_by = kNever, undone_by = kNever;
    };
    struct Node {
        Index point = 0;
        double error = 0;         // of the field at all points that were taken away about it
        double edge_world = 0;    // the longest that it made
        std::size_t end_tet = 0;  // its tetrahedra are those up to this one
    };
    struct Candidate {
        double cost = 0;
        Index from = 0, to = 0;
        std::uint32_t version = 0;
        bool operator<(const Candidate& other) const {
            return cost != other.cost ? cost > other.cost : from > other.from;  // the least cost is on top
        }
    };

    [[nodiscard]] double six_volumes(const std::array<Index, 4>& corners) const;
    [[nodiscard]] bool has(std::uint32_t tet, Index point) const;
    [[nodiscard]] std::vector<Index> neighbors(Index point) const;
    [[nodiscard]] std::vector<std::array<Index, 4>> after(Index from, Index to) const;
    [[nodiscard]] bool allowed(Index from, Index to, const std::vector<std::array<Index, 4>>& made) const;
    [[nodiscard]] bool keeps_boundary(Index from, Index to) const;
    [[nodiscard]] double value_in(const std::vector<std::array<Index, 4>>& cells, const Vec3& place, std::size_t& cell) const;
    void offer(Index point);
    void collapse(const Candidate& candidate);
    void find_boundary();

    std::vector<Vec3> points_;
    std::vector<double> values_;
    double range_ = 1, size_ = 1;
    std::vector<Tet> tets_;
    std::vector<Node> nodes_;
    std::size_t first_made_ = 0;
    std::vector<std::vector<std::uint32_t>> tets_at_;  // that are there
    std::vector<std::vector<Index>> dropped_in_;       // points that were taken away, by the tetrahedron that they lie in
    std::vector<std::uint8_t> on_boundary_;
    std::vector<std::uint32_t> version_;
    std::priority_queue<Candidate> queue_;
};

}  // namespace subvol::bench
