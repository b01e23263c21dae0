// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "subvol/measure.h"

namespace subvol::detail {

/// The mesh as the file has it: fields that it has at cells are constant in them.
[[nodiscard]] HexMesh as_given(HexMesh mesh);

/// Moves extremes of trilinear cells to the corner where they are, even if they are the same all over a cell; those of a field
/// at cells to the middle of their cell. Those of a function of other fields stay.
void move_to_own_places(const HexMesh& mesh, const Attribute& attribute, LimitExtreme& min, LimitExtreme& max);

/// What is measured of the limit, with the figures of the cells as they were given beside it: these are measured in the same
/// way by the trilinear scheme.
///
/// measured: of the limit, or of `as_given`; nothing if there is no volume to be measured
[[nodiscard]] std::optional<LimitMeasure> with_given_figures(
    const MeasureOptions& options,
    const std::function<std::optional<LimitMeasure>(const MeasureOptions& options, bool given)>& measured);

}  // namespace subvol::detail
