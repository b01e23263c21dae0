// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/facts.h"
#include "subvol/limit.h"
#include "subvol/names.h"
#include "subvol/option_names.h"
#include "subvol/probe.h"

namespace subvol {

/// Which way a streamline goes from its seed.
enum class StreamDirection { Both, Forward, Backward };

template <>
struct NameTable<StreamDirection> {
    static constexpr Name<StreamDirection> rows[] = {
        {StreamDirection::Both, "both"}, {StreamDirection::Forward, "forward"}, {StreamDirection::Backward, "backward"}};
};

/// Why a streamline ends: at the boundary of the volume, where the field is nearly 0, or because it is long enough.
enum class StreamEnd { Boundary, Still, Length, Time, Steps, Seed };

template <>
struct NameTable<StreamEnd> {
    static constexpr Name<StreamEnd> rows[] = {{StreamEnd::Boundary, "boundary"}, {StreamEnd::Still, "still"},
                                               {StreamEnd::Length, "length"},     {StreamEnd::Time, "time"},
                                               {StreamEnd::Steps, "steps"},       {StreamEnd::Seed, "seed"}};
};

struct StreamlineOptions {
    LimitOptions limit{};                               ///< the scheme, and how exact the limit is
    StreamDirection direction = StreamDirection::Both;  ///< direction from the seeds
    /// No line is longer to either side of its seed; none: two diagonals of the mesh's box
    std::optional<double> length_world{};
    std::optional<double> duration{};  ///< no line takes longer, in units of length by those of the field; none: any time
    double tolerance = 1e-6;           ///< the error of a step, as a part of the diagonal
    /// Steps are no longer than this part of the diagonal, so that lines between points look like the curve
    double longest_step = 0.01;
    Progress* progress = nullptr;
};

/// The options without those of the limit: stream-direction, stream-length, stream-time, stream-tolerance, stream-step.
[[nodiscard]] std::vector<Option> options_of(StreamlineOptions& options);

/// Streamlines one after the other, each along the field: a line has the points from firsts[i] to firsts[i + 1].
struct Streamlines {
    std::vector<Vec3> points;
    std::vector<double> times;        ///< time at each point, 0 at the seed and negative before it
    std::vector<ProbedField> fields;  ///< all attributes of the mesh at the points, with their gradients
    std::vector<std::size_t> firsts{0};
    std::vector<std::size_t> seeds;  ///< for each line, the number of its seed
    /// For each line, why its first and its last point are the ends; Seed: it was not followed to that side
    std::vector<std::array<StreamEnd, 2>> ends;
    std::vector<std::size_t> outside;  ///< numbers of the seeds that are outside the volume, which have no line

    [[nodiscard]] std::size_t count() const { return seeds.size(); }
    /// Returns the sum of the lengths of all lines (world).
    [[nodiscard]] double length() const;
    /// Returns how many lines end for this reason, counted at both ends.
    [[nodiscard]] std::size_t ends_by(StreamEnd reason) const;
};

/// Follows a vector field of the limit from seeds, by the method of Dormand and Prince with steps of the fifth order whose
/// error, the difference from the fourth order, is kept below the tolerance.
///
/// field:  an attribute with three channels, in world axes
/// throws: Error(InvalidInput) if there is no such field, a seed is not finite or an option is out of range, or as
/// `LimitProbe`;
///         Error(Cancelled)
/// cost:   parallel over the lines: some ten evaluations of the limit for each step. The same bits for any number of threads,
/// and
///         for each line whatever the others
/// source: [dopri1980]; docs/science.md says why steps are of places, not of parameters
[[nodiscard]] Streamlines trace_streamlines(const HexMesh& mesh, std::string_view field, std::span<const Vec3> seeds,
                                            const StreamlineOptions& options = {});

/// What a command says of them, in the group `streamlines`: count, points, length, outside, and in `ends` how many end for
/// which reason, counted at both ends. A warning says how many seeds are outside.
[[nodiscard]] Facts facts_of(const Streamlines& lines);

/// Places for seeds, by a text:
///
///     at:x,y,z    line:x0,y0,z0,x1,y1,z1    disk:x,y,z,nx,ny,nz,r    sphere:x,y,z,r    box:x0,y0,z0,x1,y1,z1
///
/// A line has both of its ends. Disks, spheres and boxes are filled evenly, always by the same places.
///
/// count:  of places, but for at
/// throws: Error(InvalidInput) if the text says nothing of these
[[nodiscard]] std::vector<Vec3> parse_seeds(const std::string& text, std::size_t count);

/// Middles of cells on the limit, so chosen that each stands for as much volume of the control mesh; of a mesh with fewer cells
/// the middles of all.
[[nodiscard]] std::vector<Vec3> middles_of_cells(const HexMesh& mesh, std::size_t count, const LimitOptions& options = {});

/// Writes streamlines: .vtp (lines; at their points the fields, times and the numbers of the seeds) or .csv (a row for each
/// point: line, seed, time, x, y, z and the fields).
///
/// throws: Error(InvalidInput) for another extension, Error(Io)
void write_streamlines(const std::filesystem::path& path, const Streamlines& lines);

}  // namespace subvol
