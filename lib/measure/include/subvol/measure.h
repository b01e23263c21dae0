// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "subvol/limit.h"
#include "subvol/mesh_source.h"
#include "subvol/option.h"
#include "subvol/region.h"

namespace subvol {

/// tolerance: of the volume as a part of it, of means and extremes as parts of each field's range
/// bins:      of the histograms, 1 to 100,000
/// groups:    the number of the part to which each cell belongs, e.g. its block; empty: all cells are of part 0
/// names:     of the parts
struct MeasureOptions {
    SchemeOptions scheme{};
    double tolerance = 1e-4;
    int bins = 32;
    std::span<const Index> groups{};
    std::vector<std::string> names{};
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(MeasureOptions& options);

/// An extreme value of the limit. uvw: in the cell
struct LimitExtreme {
    double value = 0;
    Vec3 place{0.0};
    Index cell = kNone;
    Vec3 uvw{0.0};
};

/// One channel of an attribute over a volume.
///
/// integral:  over the volume (value × world³); mean: divided by the volume
/// extreme_error: how far beyond min and max the limit may go, an estimate
/// histogram: the volume (world³) where the value is in each of equal intervals from the limit's minimum to its maximum
struct FieldMeasure {
    std::string name;
    double integral = 0;
    double mean = 0;
    LimitExtreme min, max;
    double extreme_error = 0;
    std::vector<double> histogram;
};

/// cells: control cells; fields: one for each channel, with ".k" after the name where an attribute has several
/// error: an estimate of how far off the volume is, as a part of it, and each mean, as a part of its attribute's range
struct PartMeasure {
    std::string name;
    std::size_t cells = 0;
    double volume = 0;
    double error = 0;
    std::vector<FieldMeasure> fields;
};

/// parts:  of the groups, in their order; empty without groups
/// pieces: that were integrated
struct LimitMeasure {
    PartMeasure whole;
    std::vector<PartMeasure> parts;
    std::size_t pieces = 0;
};

/// Integrals, means, extremes and histograms of the limit.
///
/// Every cell is refined once and integrated as a triquadratic piece, by 27 Gauss points (exact for volumes). Each cell has an
/// estimate of what is left; those in which most is left are refined further, until the rest is within the tolerance. What a
/// sample of cells shows to follow is added. So are refined cells whose nodes lie so near the best value that the limit may go
/// beyond it. Both end at level 6, or when they have taken several times as long as the first level:
/// `error` and `extreme_error` say how far the figures may be off.
///
/// A mesh that is stored in pieces is measured piece by piece: each is read and refined twice, the second time for the
/// histograms, whose bins lie between the extremes of the whole. Sums are those of the pieces in their order. The cells of
/// extremes have their numbers in the whole mesh; kNone if an Index cannot hold them.
///
/// throws: Error(InvalidInput) as `evaluate_limit`, if an option is out of range, if there are groups of a mesh in pieces, or
///         if these have fewer than three layers of halo
/// cost:   parallel; the same bits for any number of threads. Memory: a copy of the mesh, what refines it, and a block of
///         cells; of a mesh in pieces for one of them
[[nodiscard]] LimitMeasure measure_limit(const MeshSource& source, const MeasureOptions& options = {});

/// The same of the part of the limit that lies in all of several parts of space, cut exactly along their faces.
///
/// The limit is taken as pieces within `tolerance` (`find_limit_cells`). What lies in the region is boxed in each piece that
/// its faces cut, however small it is, and the boxes are halved until the volume and the means change by less than the
/// tolerance. Extremes are those of what was cut. extreme_error is their distance from a bound that is proved for the pieces,
/// and an estimate of what these leave; cells of a part are those with a part in the region.
///
/// Where regions choose cells, the limit of these cells alone is measured.
///
/// throws: Error(InvalidInput) as `measure_limit`, if no volume lies in the region, or for groups with a region of cells
/// cost:   parallel; that of the pieces, and some milliseconds for each that is cut; less than a second for each extreme
[[nodiscard]] LimitMeasure measure_limit_in(const HexMesh& mesh, std::span<const Region> regions,
                                            const MeasureOptions& options = {});

}  // namespace subvol
