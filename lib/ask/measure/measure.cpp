// SPDX-License-Identifier: Apache-2.0
// A mesh in memory is measured at once. Of a mesh in pieces each is measured by itself, and what they sum up to is added; their
// histograms are made in a second run, when the range of the whole is known.
#include "subvol/measure.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "given_figures.h"
#include "measurer.h"
#include "overlapping_sets.h"
#include "subvol/cell.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

namespace {

using detail::Measurer;

LimitMeasure measure(const HexMesh& mesh, const MeasureOptions& options) {
    if (!options.groups.empty() && options.groups.size() != mesh.cells.size()) {
        throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(options.groups.size()) + " groups of cells",
                    "measure", "one for each of the cells");
    }
    const detail::LimitExtent extent = detail::limit_extent(mesh);
    Measurer measurer(mesh, options.cells, extent, options);
    std::vector<PartMeasure> found = measurer.measure();
    measurer.add_histograms(found);
    for (PartMeasure& part : found) Measurer::scale_histograms(part);
    LimitMeasure result{std::move(found.front()), {}, measurer.pieces(), measurer.folds()};
    result.parts.assign(std::make_move_iterator(found.begin() + 1), std::make_move_iterator(found.end()));
    return result;
}

/// Of trilinear cells, with the points or cells where the extremes are.
LimitMeasure measure_given(const HexMesh& mesh, const MeasureOptions& options) {
    LimitMeasure result = measure(mesh, options);
    const auto move = [&](PartMeasure& part) {
        std::size_t next = 0;
        for (const Attribute& attribute : mesh.attributes) {
            for (int c = 0; c < attribute.channels; ++c, ++next)
                detail::move_to_own_places(mesh, attribute, part.fields[next].min, part.fields[next].max);
        }
    };
    move(result.whole);
    std::ranges::for_each(result.parts, move);
    return result;
}

LimitExtreme in_whole(LimitExtreme extreme, const MeshPiece& piece) {
    const std::uint64_t number = extreme.cell == kNone ? kNone : piece.cell_numbers[extreme.cell];
    extreme.cell = number < kNone ? static_cast<Index>(number) : kNone;
    return extreme;
}

void add(SeenFolds measured, const MeshPiece& piece, SeenFolds& all) {
    if (measured.cells == 0) return;
    const std::uint64_t number = piece.cell_numbers[measured.first];
    if (number < all.first) {  // kNone if there are none before it
        all.first = static_cast<Index>(number);
        all.place = measured.place;
    }
    all.cells += measured.cells;
}

/// Adds the measure of a piece to those before it. first: there are none
void add(const PartMeasure& measured, const MeshPiece& piece, bool first, PartMeasure& all) {
    all.cells += measured.cells;
    all.volume += measured.volume;
    all.error += measured.error * std::abs(measured.volume);  // divided by the volume of all when that is known
    all.fields.resize(measured.fields.size());
    for (std::size_t f = 0; f < measured.fields.size(); ++f) {
        const FieldMeasure& from = measured.fields[f];
        FieldMeasure& to = all.fields[f];
        to.name = from.name;
        to.derived = from.derived;
        to.integral += from.integral;
        to.extreme_error = std::max(to.extreme_error, from.extreme_error);
        if (first || from.min.value < to.min.value) to.min = in_whole(from.min, piece);
        if (first || from.max.value > to.max.value) to.max = in_whole(from.max, piece);
    }
}

/// Adds the volumes of a piece to the histograms of the whole.
void add_to_histograms(Measurer& measurer, PartMeasure& whole) {
    std::vector<PartMeasure> piece(1, whole);
    measurer.add_histograms(piece);
    for (std::size_t f = 0; f < whole.fields.size(); ++f) {
        for (std::size_t b = 0; b < whole.fields[f].histogram.size(); ++b) {
            whole.fields[f].histogram[b] += piece[0].fields[f].histogram[b];
        }
    }
}

/// The extent of a mesh in pieces, whose fields may not be known.
detail::LimitExtent extent_of(const MeshSource::Stored& stored, const HexMesh& piece) {
    detail::LimitExtent extent = detail::limit_extent(piece);
    extent.box = stored.bounds;
    if (stored.fields.size() != extent.ranges.size()) return extent;
    for (std::size_t f = 0; f < stored.fields.size(); ++f) extent.ranges[f] = {stored.fields[f].min, stored.fields[f].max};
    return extent;
}

LimitMeasure measure_pieces(const MeshSource& source, const MeasureOptions& options) {
    source.check_halo(detail::kHaloOfLimit, "values of the limit");
    if (!options.groups.empty()) throw Error(ErrorCode::InvalidInput, "bricks have no groups of cells", "measure");
    MeasureOptions quiet = options;
    quiet.progress = nullptr;
    LimitMeasure all;
    const auto each_piece = [&](const char* stage, const auto& visit) {
        for_each_piece(source.stored(), stage, options.progress, [&](std::size_t number, const MeshPiece& piece) {
            const detail::LimitExtent extent = extent_of(source.stored(), piece.mesh);
            Measurer measurer(piece.mesh, piece.owned_cells, extent, quiet);
            visit(number, piece, measurer);
        });
    };
    each_piece("measure", [&](std::size_t number, const MeshPiece& piece, Measurer& measurer) {
        add(measurer.measure().front(), piece, number == 0, all.whole);
        add(measurer.folds(), piece, all.folds);
        all.pieces += measurer.pieces();
    });
    if (all.whole.volume != 0) all.whole.error /= std::abs(all.whole.volume);
    for (FieldMeasure& field : all.whole.fields) {
        if (all.whole.volume != 0) field.mean = field.integral / all.whole.volume;
        field.histogram.assign(static_cast<std::size_t>(options.bins), 0);
    }
    each_piece("histogram", [&](std::size_t, const MeshPiece&, Measurer& measurer) { add_to_histograms(measurer, all.whole); });
    Measurer::scale_histograms(all.whole);
    return all;
}

}  // namespace

std::optional<std::size_t> LimitExtreme::corner() const {
    std::size_t octant = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (uvw[axis] != 0 && uvw[axis] != 1) return {};
        octant += uvw[axis] == 1 ? std::size_t{1} << axis : 0;
    }
    return kCornerOctants[octant];
}

namespace {

LimitMeasure measured(const MeshSource& source, const MeasureOptions& options) {
    if (!options.sets.empty()) {
        return detail::measured_by_sets(options, source.mesh()->cells.size(),
                                        [&](const MeasureOptions& by) { return measured(source, by); });
    }
    return *detail::with_given_figures(options, [&](const MeasureOptions& by, bool given) -> std::optional<LimitMeasure> {
        if (source.mesh() == nullptr) return measure_pieces(source, by);
        return given ? measure_given(detail::as_given(*source.mesh()), by) : measure(*source.mesh(), by);
    });
}

}  // namespace

LimitMeasure measure_limit(const MeshSource& source, const MeasureOptions& options) {
    check_options(options);
    if (source.mesh() == nullptr && !(options.sets.empty() && options.cells.empty()))
        throw Error(ErrorCode::InvalidInput, "bricks have no sets of cells", "measure");
    return detail::measured_in_cells(source, options, measured);
}

std::vector<Option> options_of(MeasureOptions& options) {
    constexpr double kLeast = 1e-100;
    return {Option("tolerance", options.tolerance)
                .between(kLeast, 1)
                .help("E", "of the volume as a part of it, of means and extremes as parts of each field's range"),
            Option("bins", options.bins).between(1, 100000).help("N", "intervals of the histogram")};
}

}  // namespace subvol
