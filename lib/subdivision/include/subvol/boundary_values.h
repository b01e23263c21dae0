// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "subvol/mesh_source.h"
#include "subvol/refine.h"
#include "subvol/surface.h"

namespace subvol {

/// The boundary of a volume with the values of its fields there.
struct BoundaryValues {
    Surface surface;
    std::vector<std::vector<double>> values;  ///< for each attribute of the mesh, one number for each point of the surface
};

/// The boundary of the mesh refined options.levels times, on the limit, with the limit's values. Only the cells at the boundary
/// are refined. Bodies that touch keep their own values.
///
/// throws: Error(InvalidInput) as `refine`, or if an attribute has more than one channel
/// cost:   about 20 points for each point of the boundary of the last level
[[nodiscard]] BoundaryValues boundary_values(HexMesh mesh, const RefineOptions& options);
/// The same from the cells at the hull.
[[nodiscard]] BoundaryValues boundary_values(MeshHull hull, const RefineOptions& options);

/// `boundary_values` for a mesh that moves, or whose values change: what depends on its cells alone is computed once.
class BoundaryTables {
public:
    /// throws: as `boundary_values`
    /// cost:   as `boundary_values`, and memory for the weights of the levels at the boundary
    BoundaryTables(const HexMesh& mesh, const RefineOptions& options);
    ~BoundaryTables();
    BoundaryTables(BoundaryTables&&) noexcept;
    BoundaryTables& operator=(BoundaryTables&&) noexcept;

    /// What `boundary_values` returns for a mesh with the same cells, creases and number of attributes; no crease by angle is
    /// found anew.
    ///
    /// throws: Error(InvalidInput) if its number of points is another one, or an attribute has more than one channel
    [[nodiscard]] BoundaryValues apply(const HexMesh& mesh) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The levels of boundary_values that a picture of the body needs: 2, but 1 for a boundary of more than 8,000 triangles, and
/// 0 for one of more than two million.
///
/// most: no more than these, if given
[[nodiscard]] int picture_levels(const HexMesh& mesh, std::optional<int> most = {});
[[nodiscard]] int picture_levels(const MeshHull& hull, std::optional<int> most = {});

}  // namespace subvol
