// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/limit.h"
#include "subvol/measure.h"
#include "subvol/mesh_sets.h"

namespace subvol {

/// flux:      a vector at each point of the mesh (x, y, z, x, …), whose flow through the patches is wanted; empty: none
/// flux_field: the same as a field of three channels, which may be a function of others
/// tolerance: of areas, as a part of them, of means, as a part of their attribute's range, and of flows, as a part of the area
///            times the longest vector
struct PatchOptions {
    SchemeOptions scheme{};
    std::span<const double> flux{};
    std::optional<Attribute> flux_field{};
    double tolerance = 1e-5;
    Progress* progress = nullptr;
};

/// One channel of an attribute over a patch.
///
/// integral: over the area (value × world²); mean: divided by the area, NaN where there is none
/// extreme_error: how far beyond min and max the limit may go on the patch, as of `FieldMeasure`
/// given:         the same of the sides of cells as they were given, bilinear between their corners; NaN of what is made of
///                derivatives
struct PatchField {
    std::string name;
    double integral = 0, mean = std::numeric_limits<double>::quiet_NaN();
    LimitExtreme min{}, max{};
    double extreme_error = 0;
    GivenFigures given{};
};

/// A patch of the limit's boundary. area: world²
///
/// normal:    the integral of the outward unit normal (world²); of a closed surface 0
/// error:     an estimate of how far off the area is, as a part of it, the means, as parts of their attributes' ranges, and the
///            flow, as a part of the area times the longest vector
/// flux:      the integral of the field's component along the outward normal (value × world²)
/// throughput: the integral of that component's absolute value
/// fields:    one for each channel, with ".k" after the name where an attribute has several
/// given_:    the same of the sides of cells as they were given. The flow of the gradient of a scalar is that of the trilinear
///            cells; that of other derivatives is left out
struct PatchMeasure {
    std::string name;
    std::size_t sides = 0;
    double area = 0, error = 0, given_area = 0;
    Vec3 normal{0.0};
    std::optional<double> flux, throughput;
    std::optional<double> given_flux{}, given_throughput{};
    std::vector<PatchField> fields;
};

/// Areas, means and flows of patches of the limit's boundary.
///
/// A side of a cell is cut into n × n parts, each with 3 × 3 Gauss points, at which position, Jacobian and values are those of
/// `evaluate_limit`. n is doubled until no integral changes by more than the tolerance, to 8 at most. An attribute that varies
/// by roundings alone is a constant, whose mean is not in doubt. Least and largest values are searched for as by
/// `measure_limit`.
///
/// throws: Error(InvalidInput) as `evaluate_limit`, if a patch has no sides, or if the vectors are not three numbers for each
/// point cost:   that of the limit at some hundred places of each side; only cells near the patches are copied
[[nodiscard]] std::vector<PatchMeasure> measure_patches(const HexMesh& mesh, std::span<const Patch> patches,
                                                        const PatchOptions& options = {});

}  // namespace subvol
