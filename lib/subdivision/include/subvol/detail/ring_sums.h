// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "subvol/detail/stencil_row.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// The sums over long rings that rows use in place of all members of a ring. Extrapolation to the side opposite member i has
/// the weights c_j = δ_ij − (4/m) cos(φ_j − φ_i), φ_j = 2πj/m (antipode.h), and by the addition theorem
///
///     Σ c_j p_j = p_i − (4/m) (cos φ_i Σ p_j cos φ_j + sin φ_i Σ p_j sin φ_j).
///
/// Both sums are the same for all members, so that the rows of a ring have a few terms each and cost grows with m, not with its
/// square. They are columns behind those of the points.
///
/// Members are counted from the one whose point has the smallest number, towards the smaller of its two neighbours: the sums
/// have the same bits in every patch whose points are in the order of the mesh.
class RingSums {
public:
    /// Rings of so many members have sums; the rows of shorter ones have all members.
    static constexpr std::size_t kLong = 32;

    /// What a ring goes around.
    struct Center {
        enum Kind : std::uint8_t { Edge, Point } kind;
        Index number;  ///< number of the edge, or of the point of the boundary
        [[nodiscard]] std::uint64_t key() const { return 2 * std::uint64_t{number} + kind; }
    };

    /// point_count: of the mesh
    explicit RingSums(std::size_t point_count) : columns_(point_count) {}

    [[nodiscard]] bool empty() const { return rings_.empty(); }
    [[nodiscard]] bool has(Center center) const { return numbers_.contains(center.key()); }

    /// members: faces about an edge, edges about a point, in the order of the ring
    /// points:  of the members, for each end of the edge; one list if it goes around a point
    void add(Center center, std::span<const Index> members, std::span<const std::vector<Index>> points);

    /// The terms of weight · Σ c_j p_j without the first, p_i, for member i.
    ///
    /// end: of the edge
    void add_terms(Center center, Index member, std::size_t end, double weight, StencilBuilder& row) const;

    /// The place of a member in the order of the ring.
    [[nodiscard]] std::size_t slot(Center center, Index member) const;

    /// The values of the points with those of the sums behind them.
    [[nodiscard]] std::vector<double> with_sums(const double* values, std::size_t channels) const;

private:
    struct Ring {
        std::size_t column;  // of the first sum: cosines, then sines, for each end
        std::size_t first;   // the place from which members are counted
        bool reversed;
        std::vector<std::pair<Index, std::size_t>> slots;  // of the members, sorted
        std::vector<std::vector<Index>> points;            // as they are counted

        [[nodiscard]] std::size_t size() const { return slots.size(); }
    };
    [[nodiscard]] const Ring& ring(Center center) const { return rings_[numbers_.at(center.key())]; }

    std::size_t columns_;
    std::vector<Ring> rings_;
    std::unordered_map<std::uint64_t, std::size_t> numbers_;
};

}  // namespace subvol::detail
