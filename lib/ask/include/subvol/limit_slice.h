// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/option_names.h"
#include "subvol/probe.h"

namespace subvol {

struct SliceOptions {
    int resolution = 512;  ///< places along the longer side of the part of the plane that is in the mesh's box, 2 to 20,000
    /// A flag for each cell of a mesh in memory: those that are cut, where they lie in the limit of the whole mesh; the frame
    /// is the box of their control points. Empty: all
    std::span<const std::uint8_t> cells{};
    LimitOptions limit{};
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(SliceOptions& options);

/// A field of the limit at a grid of places on a plane.
struct LimitSlice {
    std::string field;
    int width = 0, height = 0;
    Vec3 origin{0.0};  ///< the place of column 0 in row 0
    /// From a place to the next one in its row, and to the one in the next row; they are of the same length, and right × down
    /// points away from where the plane's normal points: the picture is seen from there
    Vec3 right{0.0}, down{0.0};
    std::vector<double> values;     ///< row by row; NaN outside the volume
    std::vector<Vec3> gradients;    ///< gradients by world position, 0 outside
    std::vector<Index> cells;       ///< the control cells, kNone outside
    double min = 0, max = 0;        ///< least and largest of the values. `find_slice_extremes` finds those of the plane
    Vec3 min_at{0.0}, max_at{0.0};  ///< places of the least and the largest value
    std::size_t inside = 0;

    [[nodiscard]] Vec3 place(double column, double row) const { return origin + column * right + row * down; }
};

/// Samples a field where a plane cuts the volume. The picture's upper edge is where z is greater, or y for a plane z =
/// constant.
///
/// The frame of a mesh in memory is the box of its limit; that of a mesh in pieces, or of more than kMostCellsOfAProbe cells,
/// the box of its control points, as the limit is known only where the plane is. Pieces that the plane misses are not read.
///
/// field:  name of an attribute with one channel; empty: the first
/// throws: Error(InvalidInput) as `scalar_field` and `LimitProbe`, if the normal has no length, an option is out of range, or
///         the plane misses the volume
/// cost:   as `probe_limit` for all places
[[nodiscard]] LimitSlice slice_limit(const MeshSource& source, std::string_view field, const Vec3& point, const Vec3& normal,
                                     const SliceOptions& options = {});

/// A line along which the field of a slice has one value.
struct ContourLine {
    double value = 0;
    std::vector<Vec2> places;  ///< in columns and rows of the slice
};

/// Contour lines of a slice, by linear interpolation between its places. Closed lines end where they begin.
[[nodiscard]] std::vector<ContourLine> contour_lines(const LimitSlice& slice, std::span<const double> values);

/// Writes a slice: .csv has a row for each place inside; .vtp has these as squares, with the contour lines.
///
/// throws: Error(InvalidInput) for an unknown extension, Error(Io)
void write_slice(const std::filesystem::path& path, const LimitSlice& slice, std::span<const ContourLine> lines = {});

}  // namespace subvol
