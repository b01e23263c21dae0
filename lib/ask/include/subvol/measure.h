// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/limit.h"
#include "subvol/limit_slice.h"
#include "subvol/mesh_sets.h"
#include "subvol/mesh_source.h"
#include "subvol/option_names.h"
#include "subvol/region.h"

namespace subvol {

struct MeasureOptions {
    SchemeOptions scheme{};
    double tolerance = 1e-4;  ///< tolerance of the volume as a part of it, of means and extremes as parts of each field's range
    int bins = 32;            ///< bins of the histograms, 1 to 100,000
    /// The number of the part to which each cell belongs, e.g. its block; empty: all cells are of part 0
    std::span<const Index> groups{};
    std::vector<std::string> names{};  ///< names of the parts
    /// Sets of cells that are measured as parts, in place of groups: they may have cells in common
    std::span<const CellSet> sets{};
    /// A flag for each cell of a mesh in memory: those that are measured, where they lie in the limit of the whole mesh, and of
    /// sets those of them; empty: all
    std::span<const std::uint8_t> cells{};
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(MeasureOptions& options);

/// An extreme value of the limit, and where it is. Where there is none, value and place are not a number, and there is no cell.
struct LimitExtreme {
    double value = std::numeric_limits<double>::quiet_NaN();
    Vec3 place{std::numeric_limits<double>::quiet_NaN()};
    Index cell = kNone;
    Vec3 uvw{0.0};  ///< parameters in the cell

    /// The corner of the cell where it is, if it is at one.
    [[nodiscard]] std::optional<std::size_t> corner() const;
};

/// One channel of an attribute over the cells as they were given, trilinear between their corners. NaN, and no place and cell,
/// if none of them lies in the region.
struct GivenFigures {
    double integral = std::numeric_limits<double>::quiet_NaN();
    double mean = integral;
    LimitExtreme min{}, max{};
};

/// One channel of an attribute over a volume.
struct FieldMeasure {
    std::string name;
    double integral = 0;  ///< integral over the volume (value × world³)
    /// Integral divided by the volume, NaN (as min and max) where there is none
    double mean = std::numeric_limits<double>::quiet_NaN();
    LimitExtreme min, max;
    double extreme_error = 0;  ///< how far beyond min and max the limit may go, an estimate
    /// The volume (world³) where the value is in each of equal intervals from the limit's minimum to its maximum
    std::vector<double> histogram;
    GivenFigures given{};  ///< the same figures of the cells as they were given; NaN of what is made of derivatives
    bool derived = false;
};

struct PartMeasure {
    std::string name;
    std::size_t cells = 0;  ///< control cells
    double volume = 0;
    /// An estimate of how far off the volume is, as a part of it, and each mean, as a part of its attribute's range
    double error = 0;
    std::vector<FieldMeasure> fields;  ///< one for each channel, with ".k" after the name where an attribute has several
    double given_volume = 0;           ///< volume of the cells as they were given
};

/// Cells in which the limit folds, though the cell itself is not inverted, as far as an integration saw them: there may be more
/// (`check_folds` decides).
struct SeenFolds {
    std::size_t cells = 0;
    Index first = kNone;                                   ///< the cell with the smallest number
    Vec3 place{std::numeric_limits<double>::quiet_NaN()};  ///< where the determinant of its Jacobian is negative
};

struct LimitMeasure {
    PartMeasure whole;
    std::vector<PartMeasure> parts;  ///< measures of the groups or sets, in their order; empty without them
    std::size_t pieces = 0;          ///< pieces that were integrated
    SeenFolds folds{};               ///< folds of the whole
};

/// Integrals, means, extremes and histograms of the limit.
///
/// Every cell is refined once and integrated as a triquadratic piece, by 27 Gauss points (exact for volumes). Each cell has an
/// estimate of what is left; those in which most is left are refined further, until the rest is within the tolerance. What a
/// sample of cells shows to follow is added. So are refined cells whose nodes lie so near the best value that the limit may go
/// beyond it. Both end at level 6, or when they have taken several times as long as the first level:
/// `error` and `extreme_error` say how far the figures may be off. The cells as they were given are measured by the trilinear
/// scheme, in the same way.
///
/// A mesh that is stored in pieces is measured piece by piece: each is read and refined twice, the second time for the
/// histograms, whose bins lie between the extremes of the whole. Sums are those of the pieces in their order. The cells of
/// extremes have their numbers in the whole mesh; kNone if an Index cannot hold them.
///
/// throws: Error(InvalidInput) as `evaluate_limit`, if an option is out of range, if there are groups or sets of a mesh in
/// pieces, or
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
/// Where regions choose cells, these are measured where they lie in the limit of the whole mesh.
///
/// throws: Error(InvalidInput) as `measure_limit`, if no volume lies in the region, or for groups with a region of cells
/// cost:   parallel; that of the pieces, and some milliseconds for each that is cut; less than a second for each extreme
[[nodiscard]] LimitMeasure measure_limit_in(const HexMesh& mesh, std::span<const Region> regions,
                                            const MeasureOptions& options = {});

/// The least and the largest value of a field on a plane.
struct SliceExtremes {
    LimitExtreme min, max;
};

/// Finds the least and the largest value of a slice's field on its plane, between its places, too: by branch and bound in the
/// pieces that the plane cuts, and then along the plane in the limit itself. So they do not depend on the resolution.
///
/// slice:   of this mesh, with the same scheme
/// cells:   those of the slice's options
/// returns: those of the cells as they were given, on the same plane; NaN, and no cell, where it misses them, and of what is
/// made
///          of derivatives
/// throws:  Error(InvalidInput) as `slice_limit`; Error(Cancelled)
/// cost:    that of the pieces at the plane, and less than a second for each extreme
SliceExtremes find_slice_extremes(const HexMesh& mesh, LimitSlice& slice, const LimitOptions& options = {},
                                  std::span<const std::uint8_t> cells = {});

/// What a plane cuts.
///
/// Each place of a slice stands for its square; those at the rim are seen at 16 places each, so that the area is exact to some
/// hundredths of a square for each square at the rim.
struct SliceFigures {
    double area = 0;                                         ///< world²
    double mean = std::numeric_limits<double>::quiet_NaN();  ///< mean of the field over the area, NaN where nothing is cut
    LimitExtreme min{}, max{};                               ///< extremes at the places of the slice
};

/// source:  that of the slice, also in pieces
/// options: those with which the slice was made
/// cells:   those of the slice's options
/// throws:  Error(InvalidInput) as `probe_limit`; what reading throws; Error(Cancelled)
/// cost:    that of the limit at the places of the rim
[[nodiscard]] SliceFigures figures_of(const MeshSource& source, const LimitSlice& slice, const LimitOptions& options = {},
                                      std::span<const std::uint8_t> cells = {});

/// The same at the same places of the cells as they were given, trilinear or constant. Of what is made of derivatives there is
/// the area alone.
///
/// cost: that of the linear scheme at all places
[[nodiscard]] SliceFigures given_figures_of(const MeshSource& source, const LimitSlice& slice,
                                            std::span<const std::uint8_t> cells = {}, Progress* progress = nullptr);

}  // namespace subvol
