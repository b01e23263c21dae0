// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "subvol/approximate.h"
#include "subvol/probe.h"

namespace subvol::detail {

/// The control mesh with the creases that the options ask for, which no longer do, and without attributes.
///
/// throws: Error(InvalidInput) if an option is out of range, or as `validate`
[[nodiscard]] HexMesh prepared(HexMesh onto, ApproximateOptions& options);

/// throws: Error(InvalidInput) if there is no field, if one has not a value for each point, or a value is not finite
void check_samples(const HexMesh& samples);

/// Finds samples in the limit of one mesh. What it knows of the limit is kept between calls, and changes no result.
class SampleFinder {
public:
    /// The mesh is kept by reference.
    SampleFinder(const HexMesh& mesh, const ApproximateOptions& options);

    /// Samples inside are found first: only the others need candidates as far away as the reach, which may be many cells.
    [[nodiscard]] ProbeResult at(std::span<const Vec3> positions, Progress* progress);

private:
    const HexMesh& mesh_;
    ProbeOptions options_;
    std::optional<LimitProbe> inside_, near_;
};

class DataField;

/// Fits fields that are sampled at the same positions onto one control mesh. What does not depend on values is found once: the
/// places of the samples in the limit, its matrix, the weights of differences, how a start continues samples, and the places at
/// which the result is compared with the data between the samples.
class Fitter {
public:
    /// mesh, options: as `prepared` made them; refine and tolerance are not used
    /// data:          the samples without their fields
    /// finder:        of the same mesh
    /// throws: Error(InvalidInput) if no position lies in the volume, or the memory is not enough
    Fitter(HexMesh mesh, DataField data, const ApproximateOptions& options, SampleFinder& finder);
    ~Fitter();
    Fitter(const Fitter&) = delete;
    Fitter& operator=(const Fitter&) = delete;

    /// Whether these have the points and cells that it was made for.
    [[nodiscard]] bool is_for(const HexMesh& samples) const;

    /// fields: with a value for each position
    [[nodiscard]] Approximation fit(std::span<const Attribute> fields, Progress* progress) const;

    /// A flag for each cell: whether a sample in it is farther from the limit than `tolerance`, a part of the field's range.
    [[nodiscard]] std::vector<std::uint8_t> cells_beyond(double tolerance, std::span<const Attribute> fields,
                                                         const Approximation& fit) const;

private:
    /// The values at all samples, channel by channel. between: at those between the data's points
    [[nodiscard]] std::vector<std::vector<double>> wanted(const Attribute& field, const std::vector<double>& between) const;

    struct Parts;
    std::unique_ptr<const Parts> parts_;
};

}  // namespace subvol::detail
