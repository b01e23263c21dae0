// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/dense_cells.h"
#include "subvol/detail/mesh_subset.h"

namespace subvol::detail {

/// The fields of a control mesh that are constant in its cells: refined grids have the cell's own values in their place.
class ConstantFields {
public:
    /// control: is kept by reference
    explicit ConstantFields(const HexMesh& control) : control_(control) {
        for (std::size_t a = 0; a < control.attributes.size(); ++a) {
            if (is_constant_in_cells(control, control.attributes[a])) fields_.push_back(a);
        }
    }

    [[nodiscard]] std::span<const std::size_t> fields() const { return fields_; }

    [[nodiscard]] std::span<const double> values(std::size_t field, Index cell) const {
        const auto channels = static_cast<std::size_t>(control_.attributes[field].channels);
        return std::span(control_.attributes[field].cells).subspan(cell * channels, channels);
    }

    /// What visit(grid) returns for the grid of a control cell with its own values.
    template <class Visit>
    decltype(auto) with_own_values(const DenseCell& grid, const Visit& visit) const {
        if (fields_.empty()) return visit(grid);
        DenseCell own = grid;
        std::vector<std::vector<double>> memory(fields_.size());
        for (std::size_t i = 0; i < fields_.size(); ++i) {
            const std::span<const double> of_cell = values(fields_[i], grid.cell);
            memory[i].reserve(grid.points.size() * of_cell.size());
            for (std::size_t n = 0; n < grid.points.size(); ++n)
                memory[i].insert(memory[i].end(), of_cell.begin(), of_cell.end());
            own.values[fields_[i]] = memory[i];
        }
        return visit(static_cast<const DenseCell&>(own));
    }

private:
    const HexMesh& control_;
    std::vector<std::size_t> fields_;
};

}  // namespace subvol::detail
