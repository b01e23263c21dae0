// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace subvol::detail {

/// The order of a curved hexahedron's nodes. Vtk8, VtkBezier8: before VTK 9, where two edges were exchanged
enum class CurvedOrder : std::uint8_t { Vtk, Vtk8, VtkBezier, VtkBezier8, Exodus, Gmsh };

/// The nodes of a curved hexahedron as a grid of (p+1)(q+1)(r+1) places, the first direction fastest.
struct CurvedLayout {
    std::array<std::size_t, 3> degrees{1, 1, 1};  ///< p, q, r
    bool bezier = false;
    bool completed = false;  ///< the file has no nodes in the middle of some faces and of the cell; they follow from the others
    std::vector<std::size_t> slots;  ///< the place of each node of the file

    [[nodiscard]] std::size_t size() const { return (degrees[0] + 1) * (degrees[1] + 1) * (degrees[2] + 1); }
};

inline constexpr std::size_t kMostDegree = 16;

/// The degrees of a cell of so many nodes, the same in all directions: 2 for 20 and 24 nodes; nothing if there are none.
[[nodiscard]] std::optional<std::size_t> uniform_degree(CurvedOrder order, std::size_t nodes);

/// degrees: from 1 to kMostDegree; nodes: as many as the degrees need
[[nodiscard]] CurvedLayout curved_layout(CurvedOrder order, const std::array<std::size_t, 3>& degrees, std::size_t nodes);

/// A curved hexahedron with its values: channels of a polynomial in each direction, or with weights of a rational one.
class CurvedCell {
public:
    /// values:   `channels` numbers for each node, in the order of the file
    /// rational: the last channel is the weight of each node
    CurvedCell(const CurvedLayout& layout, std::span<const double> values, std::size_t channels, bool rational);

    /// The values at the points of a regular grid of n0 × n1 × n2 pieces, without the weights.
    [[nodiscard]] std::vector<double> at_grid(const std::array<std::size_t, 3>& pieces) const;

    /// The largest second derivative of each channel along a direction of the cell, measured by differences. Of channels first
    /// to first + count - 1 that is a vector's length.
    [[nodiscard]] double bend(std::size_t axis, std::span<const double> samples, std::size_t first, std::size_t count) const;

    /// The values that `bend` measures.
    [[nodiscard]] std::vector<double> samples(std::size_t axis) const;

    /// Whether all second derivatives along a direction are 0.
    [[nodiscard]] bool is_straight(std::size_t axis) const { return layout_->degrees[axis] == 1 && !rational_; }

private:
    [[nodiscard]] std::array<std::size_t, 3> sample_pieces(std::size_t axis) const;
    [[nodiscard]] std::size_t shown() const { return channels_ - (rational_ ? 1 : 0); }

    const CurvedLayout* layout_;
    std::size_t channels_;
    bool rational_;
    std::vector<double> values_;  // by slots; of rational cells times the weights
};

}  // namespace subvol::detail
