// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "subvol/field_metrics.h"
#include "subvol/hex_mesh.h"

namespace subvol {

/// A scalar field of a mesh (`scalar_field`): trilinear in the cells as they are, found by the tetrahedra of `split_cell`.
/// Satisfies `Field`. For the limit give it a refined mesh (`refine`, `on_limit`). Where cells overlap, the one with the
/// smallest number counts.
///
/// throws: Error(InvalidInput) as `validate` and `scalar_field`
/// cost:   a tree of boxes over the cells, about 60 bytes a cell beside the mesh; some µs a value; thread-safe
class MeshField {
public:
    MeshField(HexMesh mesh, std::string_view field);
    ~MeshField();
    MeshField(MeshField&&) noexcept;
    MeshField& operator=(MeshField&&) noexcept;

    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
    /// Exact within cells; between them it jumps.
    [[nodiscard]] std::optional<Vec3> gradient(const Vec3& x) const;
    [[nodiscard]] Box box() const;

    /// Refers to this field.
    [[nodiscard]] FieldView view() const;

private:
    struct Cells;
    std::unique_ptr<const Cells> cells_;
};

}  // namespace subvol
