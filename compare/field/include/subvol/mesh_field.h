// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "subvol/field.h"
#include "subvol/hex_mesh.h"
#include "subvol/limit_field.h"

namespace subvol {

/// A scalar field of a mesh (`scalar_field`): trilinear in the given cells; the tetrahedra of `split_cell` decide which cell
/// contains x. For the limit, pass a refined mesh (`refine`, `on_limit`). Where cells overlap, the first one that the search
/// finds counts.
///
/// throws: Error(InvalidInput) as `validate` and `scalar_field`
/// cost:   a tree of boxes over the cells, about 60 bytes per cell beside the mesh; some µs per value; thread-safe
class MeshField {
public:
    MeshField(HexMesh mesh, std::string_view field);
    ~MeshField();
    MeshField(MeshField&&) noexcept;
    MeshField& operator=(MeshField&&) noexcept;

    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
    /// Exact within cells; discontinuous between them.
    [[nodiscard]] std::optional<Vec3> gradient(const Vec3& x) const;
    [[nodiscard]] Box box() const;

    /// A view that refers to this object.
    [[nodiscard]] FieldView view() const;

private:
    struct Cells;
    std::unique_ptr<const Cells> cells_;
};

/// A view of a mesh's limit that refers to the object: what fields of meshes are compared by, unless a level is asked for.
[[nodiscard]] FieldView view_of(const LimitField& field);

}  // namespace subvol
