// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "subvol/measure.h"
#include "subvol/mixed_mesh.h"
#include "subvol/probe.h"

namespace subvol {

/// The volume of a mesh of tetrahedra as a function of places in the world: that of `in_hexahedra`, which grids, slices and
/// surfaces show.
///
/// At the points of the mesh the values are its own: those of the limit, if it was put there (`volume_through`, `on_limit`).
/// Between them they are linear, and their error falls by a factor of four a level. A gradient is linear between the gradients
/// at the points, which are those of the quadratic that fits the values around each of them best. So it converges as the values
/// do, and is exact for quadratics.
class MixedProbe {
public:
    /// numbers:     what the cells of the mesh are called in results, as by `control_cells`; none: by their own numbers,
    ///              counted through the tetrahedra, octahedra, prisms, pyramids and hexahedra
    /// reach_world: as of ProbeOptions
    /// throws:      Error(InvalidInput) as `validate`, or if there is not a number for each cell
    /// cost:        parallel; a quadratic for each point, and about 1.5 kB for each of the hexahedra
    explicit MixedProbe(const MixedMesh& mesh, std::vector<Index> numbers = {}, double reach_world = 0,
                        Progress* progress = nullptr);
    ~MixedProbe();
    MixedProbe(MixedProbe&&) noexcept;
    MixedProbe& operator=(MixedProbe&&) noexcept;

    /// As `LimitProbe::at`. There are no `parameters`: the array is empty.
    [[nodiscard]] ProbeResult at(std::span<const Vec3> places, Progress* progress = nullptr) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// `measure_limit` of the same volume.
///
/// numbers: as of MixedProbe
/// options: without a scheme and groups
/// throws:  as MixedProbe and `measure_limit`
[[nodiscard]] LimitMeasure measure_limit(const MixedMesh& mesh, const std::vector<Index>& numbers,
                                         const MeasureOptions& options = {});

}  // namespace subvol
