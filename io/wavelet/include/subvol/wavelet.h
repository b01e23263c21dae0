// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "subvol/progress.h"
#include "subvol/scheme.h"
#include "subvol/stencil_table.h"
#include "subvol/topology.h"

namespace subvol {

/// The step between two levels, c the coarser and f the finer one, with the new points' values f_new = S c + d.
///
/// The first points of the finer level are the old ones, numbered as in the coarser level; new point n is point columns() + n.
struct WaveletStep {
    StencilTable refine;  ///< S, all rows of the scheme
    IndexRows star;       ///< for each old point v the new points on its edges and faces and in its cells, ascending
    /// U, for each entry of `star`; empty for schemes that interpolate. S_v − Σ U S_new has no term but v's own
    std::vector<double> even;
    std::vector<double> own;  ///< D, v's own term; empty for schemes that interpolate, where it is 1
    /// A, for each entry of `star`: details change the coarser value so that means stay what they are
    std::vector<double> lift;
    /// For each point of the finer level the integral of its basis function over the finest level, in finest cells
    std::vector<double> measure;
    std::vector<std::array<Index, 3>> beside;  ///< for each new point three neighbours along the edges of one of its cells

    [[nodiscard]] std::size_t new_points() const { return refine.rows() - refine.columns(); }
};

/// The wavelets over the levels of a control mesh.
struct WaveletBasis {
    std::size_t control_points = 0;
    std::vector<WaveletStep> steps;                 ///< from coarse to fine
    std::vector<double> measure;                    ///< measure of the control points, as in WaveletStep
    std::vector<std::array<Index, 8>> cells;        ///< cells of the finest level
    std::vector<std::array<Index, 2>> creases;      ///< creases of the finest level
    std::vector<std::array<Index, 4>> sharp_faces;  ///< sharp faces of the finest level

    [[nodiscard]] std::size_t points() const { return steps.empty() ? control_points : steps.back().refine.rows(); }
};

struct WaveletOptions {
    SchemeOptions scheme{};  ///< its crease_angle_deg is not used: tag creases before
    int levels = 1;          ///< 0 to 10
    Progress* progress = nullptr;
};

/// The wavelets of a scheme over a control mesh, in the numbering of `refine`.
///
/// throws: Error(InvalidInput) as `refinement_tables`; if at some point the rule cannot be turned round: that of
///         Catmull-Clark solids next to edges with three cells
/// cost:   parallel; about 400 bytes for each point of the finest level; the same bits for any number of threads
/// source: lifting, [lgp2004] for B-splines over regular refinement; the weights from the scheme's own rows, and so the
///         irregular ones, are ours (docs/wavelets.md)
[[nodiscard]] WaveletBasis wavelet_basis(const Topology& control, const WaveletOptions& options = {});

/// Values of the finest level as control values and details.
struct WaveletField {
    std::size_t channels = 1;
    std::vector<double> coarse;                ///< control_points × channels
    std::vector<std::vector<double>> details;  ///< for each step, coarse to fine: new_points × channels
};

/// Takes values of the finest level apart. Of a refined field all details are 0 and `coarse` is the field before it was
/// refined, to rounding.
///
/// values: points × channels, point-major
/// throws: Error(InvalidInput) if there are not points × channels values
/// cost:   parallel, O(points)
[[nodiscard]] WaveletField analyze(const WaveletBasis& basis, std::span<const double> values, std::size_t channels = 1);

/// Puts a field together again: the inverse of `analyze`. With the details of the first steps only, the values of that level.
///
/// throws: Error(InvalidInput) if the field is not of this basis
[[nodiscard]] std::vector<double> synthesize(const WaveletBasis& basis, const WaveletField& field);

/// Turns the details of a shape (three channels: positions) from world axes to axes that are attached to the coarser level at
/// each new point, and back. In between the coarse points may be moved: the details then turn with their surroundings.
///
/// throws: Error(InvalidInput) if the field is not of this basis or has other than three channels
void turn_details_to_shape(const WaveletBasis& basis, WaveletField& shape);
void turn_details_to_world(const WaveletBasis& basis, WaveletField& shape);

/// How far values are from others: the root mean square and the most, of the lengths of the differences.
struct WaveletError {
    double rms = 0;
    double max = 0;
};

/// counted: a flag for each point; empty: all count
[[nodiscard]] WaveletError difference(std::span<const double> a, std::span<const double> b, std::size_t channels,
                                      std::span<const std::uint8_t> counted = {});

struct DroppedDetails {
    std::size_t details = 0;  ///< number of all details
    std::size_t kept = 0;     ///< number of details of which a channel is not 0
    WaveletError error;
};

/// Sets small details to 0, as many as the error allows: those whose length times the square root of the point's measure is
/// less than a threshold. The threshold is found by bisection, with the true error of each.
///
/// tolerance: most root mean square of the difference at the finest level, in units of the values; > 0
/// throws:    Error(InvalidInput) if the field is not of this basis or the tolerance is not positive and finite
DroppedDetails drop_details(const WaveletBasis& basis, WaveletField& field, double tolerance);

/// A field as whole numbers. A detail is its number times step / √measure of its point, a control value its number times a
/// quarter of step / √(mean measure).
struct QuantizedWavelets {
    std::size_t channels = 1;
    double step = 0;
    std::vector<std::int64_t> coarse;
    std::vector<std::vector<std::int64_t>> details;
};

/// throws: Error(InvalidInput) if a number is greater than 2⁵²: the step is too small for the values
[[nodiscard]] QuantizedWavelets quantize(const WaveletBasis& basis, const WaveletField& field, double step);
[[nodiscard]] WaveletField restore(const WaveletBasis& basis, const QuantizedWavelets& numbers);

/// The numbers with the largest step whose root mean square error is within the tolerance, found by bisection.
///
/// counted: as in `difference`
/// throws:  as `drop_details` and `quantize`; Error(Cancelled), which progress is asked for at each step
[[nodiscard]] QuantizedWavelets quantize_within(const WaveletBasis& basis, std::span<const double> values, std::size_t channels,
                                                double tolerance, std::span<const std::uint8_t> counted = {},
                                                const Progress* progress = nullptr);

}  // namespace subvol
