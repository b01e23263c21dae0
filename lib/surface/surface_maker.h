// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "settled_cut.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/surface_share.h"

namespace subvol::detail {

/// The mesh with one of its attributes, or with none.
[[nodiscard]] HexMesh with_field_only(const HexMesh& mesh, std::optional<std::size_t> field);

/// The number of the field that isosurfaces are of; nothing if there are none.
[[nodiscard]] std::optional<std::size_t> number_of_field(const HexMesh& mesh, std::string_view name,
                                                         const SurfaceOptions& options);

/// What is to be cut out, one after the other.
[[nodiscard]] std::vector<Cut> cuts_of(const SurfaceOptions& options);

/// How far triangles may lie from the limit.
[[nodiscard]] double tolerance_world(const SurfaceOptions& options, const LimitExtent& whole);

/// Makes the surfaces of a mesh, or shares of them: at the level that their tolerance asks for, their points on the limit.
class SurfaceMaker {
public:
    /// mesh:  may be a part of another one, whose extent is `whole`. It, its flags and the options are kept by reference
    /// owned: a flag for each cell that may be cut; empty: all
    SurfaceMaker(const HexMesh& mesh, std::span<const std::uint8_t> owned, const LimitExtent& whole, std::string_view field,
                 const SurfaceOptions& options);

    /// One share of a surface: a range of the cells that it passes. All shares find the same level. Nothing if the surface
    /// leads into a cell that is not owned.
    [[nodiscard]] std::optional<SettledCut> make(const Cut& cut, const Share& share) const;

    /// All fields of the mesh at places.
    [[nodiscard]] std::vector<ProbedField> fields_at(std::span<const LimitQuery> places) const;

private:
    [[nodiscard]] LimitExtent extent_of_field() const;
    [[nodiscard]] int next_level(int level, double deviation, double triangles) const;

    const HexMesh& mesh_;
    const SurfaceOptions& options_;
    LimitExtent whole_;
    std::optional<std::size_t> field_;
    Topology topology_;
    HexMesh scalar_;
    SoupCutter cutter_;
    PointSettler settler_;
    double tolerance_world_;
};

}  // namespace subvol::detail
