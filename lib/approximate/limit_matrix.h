// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/limit.h"
#include "subvol/refine.h"
#include "subvol/topology.h"

namespace subvol::detail {

// The values of the limit at n places as a matrix over the control values, which is never formed:
//
//     A = T · S_L ⋯ S_1        S_l: the stencils of level l (and those that move its points to the limit)
//                              T:   27 weights a place, between the points of level L
//
//     •───•───•   a cell of level L−1 and the points of level L about it, which lie on the limit of MCQ. Between them the limit
//     •   •   •   is interpolated by quadratics, so that T is exact at the points themselves.
//     •───•───•

/// A and its transpose, for places in control cells.
class LimitMatrix {
public:
    /// options: of at least one level
    LimitMatrix(const Topology& topology, const RefineOptions& options, std::span<const LimitQuery> places);

    /// Moves places that are nearer than `near_world` to a point of level L onto it, where T is exact.
    ///
    /// positions: in the world, of the control points and of the places
    void settle(std::span<const Vec3> control, std::span<const Vec3> positions, double near_world);

    [[nodiscard]] std::size_t rows() const { return places_.size(); }
    [[nodiscard]] std::size_t columns() const { return columns_; }

    /// A x
    [[nodiscard]] std::vector<double> apply(std::span<const double> control) const;
    /// Aᵀ y: the same bits for any number of threads
    [[nodiscard]] std::vector<double> transposed(std::span<const double> values) const;

private:
    /// cell: of level L−1; at: in it
    struct Place {
        std::size_t cell;
        Vec3 at;
    };

    [[nodiscard]] Index node(const Place& place, std::size_t i, std::size_t j, std::size_t k) const;
    [[nodiscard]] std::vector<double> finest(std::span<const double> control, std::size_t channels) const;
    template <class Visit>
    void each_term(const Place& place, const Visit& visit) const;

    std::size_t columns_ = 0;
    std::vector<StencilTable> tables_;
    std::vector<std::array<Index, 8>> cells_;  // of level L
    std::vector<Place> places_;
};

}  // namespace subvol::detail
