// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/limit.h"
#include "subvol/mesh_sets.h"

namespace subvol {

/// flux:      a vector at each point of the mesh (x, y, z, x, …), whose flow through the patches is wanted; empty: none
/// tolerance: of areas, as a part of them, of means, as a part of their attribute's range, and of flows, as a part of the area
///            times the longest vector
struct PatchOptions {
    SchemeOptions scheme{};
    std::span<const double> flux{};
    double tolerance = 1e-5;
    Progress* progress = nullptr;
};

/// One channel of an attribute over a patch.
///
/// integral: over the area (value × world²); mean: divided by the area
/// extreme_error: how far beyond min and max the limit may go on the patch, as of `FieldMeasure`
struct PatchField {
    std::string name;
    double integral = 0, mean = 0, min = 0, max = 0, extreme_error = 0;
};

/// A patch of the limit's boundary. area: world²
///
/// normal:    the integral of the outward unit normal (world²); of a closed surface 0
/// error:     an estimate of how far off the area is, as a part of it, the means, as parts of their attributes' ranges, and the
///            flow, as a part of the area times the longest vector
/// flux:      the integral of the field's component along the outward normal (value × world²)
/// throughput: the integral of that component's absolute value
/// fields:    one for each channel, with ".k" after the name where an attribute has several
struct PatchMeasure {
    std::string name;
    std::size_t sides = 0;
    double area = 0, error = 0;
    Vec3 normal{0.0};
    std::optional<double> flux, throughput;
    std::vector<PatchField> fields;
};

/// Areas, means and flows of patches of the limit's boundary.
///
/// A side of a cell is cut into n × n parts, each with 3 × 3 Gauss points, at which position, Jacobian and values are those of
/// `evaluate_limit`. n is doubled until no integral changes by more than the tolerance, to 8 at most. An attribute that varies
/// by roundings alone is a constant, whose mean is not in doubt. Least and largest values are searched for as by
/// `measure_limit`.
///
/// throws: Error(InvalidInput) as `evaluate_limit`, if a patch has no sides, or if `flux` is of another length
/// cost:   that of the limit at some hundred places of each side; only cells near the patches are copied
[[nodiscard]] std::vector<PatchMeasure> measure_patches(const HexMesh& mesh, std::span<const Patch> patches,
                                                        const PatchOptions& options = {});

}  // namespace subvol
