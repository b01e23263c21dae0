// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "structured_grid.h"
#include "vtk_values.h"

namespace subvol::detail {

/// The block of hexahedra of a structured data set of legacy VTK. Its points are listed (STRUCTURED_GRID), or given by the
/// coordinates of its planes on each axis (RECTILINEAR_GRID), or evenly spaced (STRUCTURED_POINTS).
class VtkBlock {
public:
    /// Nothing if the data set is not structured. type: its name in capitals
    [[nodiscard]] static std::optional<VtkBlock> of(const std::string& type);

    /// Reads the section whose keyword (in capitals) was the last word, if it belongs to this data set.
    ///
    /// returns: whether it does
    bool read_section(const std::string& keyword, TextScanner& in, VtkValues& values);

    /// Appends the points unless they are listed in a section POINTS; further calls do nothing.
    void add_points(const TextScanner& in, MeshFile& into);
    /// Appends the hexahedra; fails if the number of points is wrong, or if there are no cells.
    void add_cells(const TextScanner& in, MeshFile& into) const;

    [[nodiscard]] bool lists_points() const { return kind_ == Kind::Points; }
    [[nodiscard]] const StructuredGrid& grid() const { return grid_; }

private:
    enum class Kind { Points, Cuts, Even } kind_ = Kind::Points;
    void expect_cells(const TextScanner& in) const;
    void read_cuts(std::size_t axis, const std::string& keyword, TextScanner& in, VtkValues& values);

    StructuredGrid grid_;
    std::array<std::vector<double>, 3> cuts_;
    std::array<double, 3> origin_{0, 0, 0}, spacing_{1, 1, 1};
    bool has_points_ = false;
};

}  // namespace subvol::detail
