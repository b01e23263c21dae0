// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "subvol/limit.h"
#include "subvol/refine.h"

namespace subvol::detail {

/// Places that are nearer than `near_world` to a point of the finest level are moved onto it, where the limit's matrix is
/// exact.
struct Settling {
    std::span<const Vec3> positions{};  ///< positions of the places, in the world; none: nothing is moved
    double near_world = 0;
};

// Rows of the limit's matrix for places in any control cells. They are never formed:
//
//     A = T · S_L ⋯ S_1        S_l: the stencils of level l (and those that move its points to the limit)
//                              T:   27 weights a place, between the points of level L
//
//     •───•───•   a cell of level L−1 and the points of level L about it, which lie on the limit of MCQ. Between them the limit
//     •   •   •   is interpolated by quadratics, so that T is exact at the points themselves.
//     •───•───•

/// Of so many places a cell the rows are formed.
inline constexpr std::size_t kFormedPlaces = 8;

/// The rows of places in some cells of a mesh, by the stencils of these cells and those around them. Where places are few,
/// their rows are formed after all: about 170 terms each, which take no more memory than the stencils, and a fifth of the time.
class TableRows {
public:
    TableRows() = default;
    /// options: of at least one level
    /// cells:   a flag for each cell of the mesh; rows are made for the places in these
    /// where:   who is named if the memory is not enough
    TableRows(const HexMesh& mesh, const RefineOptions& options, std::span<const std::uint8_t> cells,
              std::span<const LimitQuery> places, const Settling& settling, const std::string& where);

    /// Writes its rows of A x.
    void apply(std::span<const double> control, std::span<double> values) const;
    /// Adds what its rows give to Aᵀ y.
    void add_transposed(std::span<const double> values, std::vector<double>& sums) const;

private:
    struct Place {
        std::size_t cell;  ///< cell of level L−1
        Vec3 at;           ///< place in the cell
        std::size_t row;   ///< row of the matrix
    };

    [[nodiscard]] Index node(const Place& place, std::size_t i, std::size_t j, std::size_t k) const;
    [[nodiscard]] std::vector<double> finest(std::vector<double> level, std::size_t channels) const;
    void settle(std::span<const Vec3> control, const Settling& settling);
    void form();
    template <class Visit>
    void each_term(const Place& place, const Visit& visit) const;

    std::vector<Index> points_;  // of the mesh, that the stencils begin with
    std::vector<StencilTable> tables_;
    std::vector<std::array<Index, 8>> cells_;  // of level L
    std::vector<Place> places_;
    CsrMatrix formed_;  // over points_, a row for each place; then there are no stencils
};

}  // namespace subvol::detail
