// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "subvol/limit_level.h"
#include "subvol/refine.h"

namespace subvol {

/// A scalar field of a mesh (`scalar_field`) on its limit, as a function of places in the world: that of curved pieces,
/// triquadratic in place and value (`find_limit_cells`), which are finer where the limit needs it.
class LimitField {
public:
    /// refinement: the scheme; its levels are not used
    /// options:    of the pieces; where they would take more than max_bytes, both tolerances are enlarged until they do not.
    ///             None: places within 3e-4 of the mesh's diagonal, values within 5e-4 of their range, at most level 3, 256 MB
    ///
    /// throws: Error(InvalidInput) as `find_limit_cells` and `scalar_field`; Error(Cancelled)
    /// cost:   about 600 bytes a piece
    LimitField(const HexMesh& mesh, std::string_view field, const RefineOptions& refinement,
               std::optional<LimitCellsOptions> options = {});
    ~LimitField();
    LimitField(LimitField&&) noexcept;
    LimitField& operator=(LimitField&&) noexcept;

    /// Nothing outside the pieces. A place in a piece's box and within 1/1000 of a cell of the piece counts as inside, so
    /// that pieces of different levels leave no gap. Some µs; thread-safe
    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
    /// That of the piece, in world⁻¹; 0 where the piece has no volume.
    [[nodiscard]] std::optional<Vec3> gradient(const Vec3& x) const;
    /// Returns the bounding box of the pieces, slightly enlarged.
    [[nodiscard]] Box box() const;
    /// How near the pieces are to the limit, and how many.
    [[nodiscard]] const LimitCells& limit() const;

private:
    struct State;
    std::unique_ptr<const State> state_;
};

}  // namespace subvol
