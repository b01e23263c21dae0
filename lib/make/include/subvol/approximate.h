// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/limit.h"
#include "subvol/mesh_sets.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"

namespace subvol {

struct ApproximateOptions {
    SchemeOptions scheme{};
    /// The limit at a sample is interpolated between its points on this level: 27 about each cell of the level before
    int levels = 2;
    /// Samples outside the volume, at most this part of the box's diagonal from it, count at the nearest place
    double reach = 0.01;
    /// The weight of the differences along edges, in the usual weight of the samples about a control point
    double smoothing = 0;
    /// The most steps of the search, for each channel; it ends when it cannot make the sum of squares much smaller
    int iterations = 200;
    /// Control values beyond the range of the samples become its nearer end, as for densities that are not below 0
    bool clamp = false;
    /// Where no sample of a field is below 0, as in fog, control values below 0 become 0
    bool keep_sign = false;
    /// The control mesh is refined up to so often where the samples are not met within `tolerance`: whole sheets of its cells
    /// are split, across the directions in which the fields bend there
    int refine = 0;
    double tolerance = 1e-3;  ///< the largest error that is good enough, as a part of the range of the samples
    OptionNames names = OptionNames::Keywords;  ///< how errors call the options
    Progress* progress = nullptr;
};

/// The options without those of the scheme.
[[nodiscard]] std::vector<Option> options_of(ApproximateOptions& options);

/// How far the limit is from the samples of a field.
struct FieldError {
    std::string name;
    double rms = 0;  ///< over all samples and channels
    /// Over the samples in cells at the boundary; not a number if there are none
    double rms_boundary = std::numeric_limits<double>::quiet_NaN();
    double max = 0;                                         ///< over all samples and channels
    double range = 0;                                       ///< range of the samples
    Vec3 max_at{std::numeric_limits<double>::quiet_NaN()};  ///< the sample where the limit is farthest
    /// At some thousand places between the samples, evenly spread: how far the limit is from the data's own field there, where
    /// the data is a mesh; for other data, from the value of the nearest sample, in which case it also has what the field
    /// changes on the way there
    double rms_between = 0, max_between = 0;
    Vec3 max_between_at{std::numeric_limits<double>::quiet_NaN()};  ///< the place of `max_between`
    double beyond = 0;                                              ///< how far the limit leaves the range of the samples
};

struct ApproximateReport {
    std::size_t samples = 0;  ///< samples that were used
    /// Places between the points of a mesh of data, where these are too few, at which its field is sampled too
    std::size_t between = 0;
    std::size_t outside = 0;  ///< samples that lie beyond the reach
    std::size_t snapped = 0;  ///< used samples that lie outside
    std::size_t unseen = 0;   ///< control points without a sample in their cells: they continue what is around them
    /// Control points that samples hardly decide, the unseen ones included: no error is known there
    std::size_t undecided = 0;
    int iterations = 0;       ///< iterations of the channel that took most
    int refined = 0;          ///< how often the control mesh was refined
    bool continuous = false;  ///< the data is a mesh, whose fields are known between its points
    std::vector<FieldError> fields;
};

/// The report under its members' names; "fields" is a group with a group for each field.
[[nodiscard]] Facts facts_of(const ApproximateReport& report);

struct Approximation {
    HexMesh mesh;  ///< the control mesh with the fitted fields as its attributes
    ApproximateReport report;
    /// Where each cell of the mesh lies in the cells of `onto`; empty if the mesh was not refined
    std::vector<PartOfCell> parts = {};
};

/// Fits control values so that the limit is as near to samples as it can be: in the least squares sense, by conjugate gradients
/// with the tables that make the limit and their transposes, from a start that continues the samples. A field that is a limit
/// of the mesh already is found again. Values that samples leave open follow second differences, a continuation of those around
/// them; those that samples hardly decide stay within a quarter of the range of what the nearest linear function leaves of the
/// samples. Without smoothing a linear function of places is met everywhere.
///
/// onto:    the control mesh; its attributes are not used
/// samples: places and their fields, as points and attributes. With cells the fields are known between the points too: where
///          these are too few for the control mesh, more places are sampled
/// throws:  Error(InvalidInput) as `refine`, of both meshes, if no sample lies in the volume, if there is no field, or if an
/// option is
///          out of range
/// cost:    time and memory grow with the samples and the cells that have any: 10⁵ control points and 8·10⁵ samples take some
///          15 CPU seconds and 0.8 GB, where most cells have neighbourhoods that are alike. Others take about 20 kB each with
///          `levels` of 2, eight times as much with each level more. Parallel, the same bits for any number of threads
[[nodiscard]] Approximation approximate(const HexMesh& onto, const HexMesh& samples, const ApproximateOptions& options = {});

/// How the points of a mesh lie in the data whose fields they were given.
struct MapReport {
    std::size_t outside =
        0;  ///< points outside of the cells of the data, which have the values of the nearest place of its boundary
    double farthest_world = 0;                                   ///< the largest distance from there
    Vec3 farthest_at{std::numeric_limits<double>::quiet_NaN()};  ///< the point of that distance
};

/// The report under its members' names.
[[nodiscard]] Facts facts_of(const MapReport& report);

struct MappedFields {
    HexMesh mesh;
    MapReport report;
};

/// The fields of a mesh at the points of another one: trilinear in the cells of the data as they are, without a limit and
/// without a fit. A linear function of places is met, and so are the data's own values where the points are its own.
/// A field that is constant in each cell has the value of the cell.
///
/// onto:   its attributes are left out
/// data:   with attributes
/// throws: Error(InvalidInput) if the data has no cells or no attributes, or no point lies in it; Error(Cancelled)
/// cost:   some µs a point, and 1.5 kB for each cell of the data; parallel, the same bits for any number of threads
[[nodiscard]] MappedFields map_fields(HexMesh onto, const HexMesh& data, Progress* progress = nullptr);

/// Places of the limit in each cell, per_edge³ of them at the middles of equal parts: where a function of the world can be
/// sampled.
[[nodiscard]] std::vector<Vec3> places_in_cells(const HexMesh& mesh, int per_edge, const LimitOptions& options = {});

/// A mesh of a box for data that has none: cells as near to cubes as they can be. Edges of one cell are sharp by themselves.
///
/// cells:  along the longest side, 1 to 1000
/// throws: Error(InvalidInput) if cells is out of range, or the box is empty or flat
[[nodiscard]] HexMesh mesh_of_box(const Box& box, int cells);

}  // namespace subvol
