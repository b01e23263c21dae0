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

struct PatchOptions {
    SchemeOptions scheme{};
    /// A vector at each point of the mesh (x, y, z, x, …), whose flow through the patches is wanted; empty: none
    std::span<const double> flux{};
    std::optional<Attribute> flux_field{};  ///< the same as a field of three channels, which may be a function of others
    /// Tolerance of areas, as a part of them, of means, as a part of their attribute's range, and of flows, as a part of the
    /// area times the longest vector
    double tolerance = 1e-5;
    Progress* progress = nullptr;
};

/// One channel of an attribute over a patch.
struct PatchField {
    std::string name;
    double integral = 0;                                     ///< integral over the area (value × world²)
    double mean = std::numeric_limits<double>::quiet_NaN();  ///< integral divided by the area, NaN where there is none
    LimitExtreme min{}, max{};
    double extreme_error = 0;  ///< how far beyond min and max the limit may go on the patch, as of `FieldMeasure`
    /// The same figures of the sides of cells as they were given, bilinear between their corners; NaN of what is made of
    /// derivatives
    GivenFigures given{};
};

/// A patch of the limit's boundary.
struct PatchMeasure {
    std::string name;
    std::size_t sides = 0;
    double area = 0;  ///< world²
    /// An estimate of how far off the area is, as a part of it, the means, as parts of their attributes' ranges, and the flow,
    /// as a part of the area times the longest vector
    double error = 0;
    double given_area = 0;             ///< area of the sides of cells as they were given
    Vec3 normal{0.0};                  ///< integral of the outward unit normal (world²); 0 for a closed surface
    std::optional<double> flux;        ///< the integral of the field's component along the outward normal (value × world²)
    std::optional<double> throughput;  ///< integral of the absolute value of that component
    /// Flux and throughput of the sides of cells as they were given. The flow of the gradient of a scalar is that of the
    /// trilinear cells; that of other derivatives is left out
    std::optional<double> given_flux{}, given_throughput{};
    std::vector<PatchField> fields;  ///< one for each channel, with ".k" after the name where an attribute has several
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
