// SPDX-License-Identifier: Apache-2.0
#include "subvol/brick_measure.h"

#include <algorithm>

#include "brick_layers.h"
#include "measure_part.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

LimitExtreme in_whole(LimitExtreme extreme, const BrickMesh& brick) {
    const std::uint64_t number = extreme.cell == kNone ? kNone : brick.cell_numbers[extreme.cell];
    extreme.cell = number < kNone ? static_cast<Index>(number) : kNone;
    return extreme;
}

/// Puts the measure of a brick to those before it. first: there are none
void add(const LimitMeasure& here, const BrickMesh& brick, bool first, LimitMeasure& all) {
    all.pieces += here.pieces;
    all.whole.cells += here.whole.cells;
    all.whole.volume += here.whole.volume;
    all.whole.fields.resize(here.whole.fields.size());
    for (std::size_t f = 0; f < here.whole.fields.size(); ++f) {
        const FieldMeasure& from = here.whole.fields[f];
        FieldMeasure& to = all.whole.fields[f];
        to.name = from.name;
        to.integral += from.integral;
        if (first || from.min.value < to.min.value) to.min = in_whole(from.min, brick);
        if (first || from.max.value > to.max.value) to.max = in_whole(from.max, brick);
    }
}

}  // namespace

LimitMeasure measure_limit(const Bricks& bricks, const MeasureOptions& options, const BrickFields& fields) {
    check_halo_of_limit(bricks);
    if (!options.groups.empty()) throw Error(ErrorCode::InvalidInput, "bricks have no groups of cells", "measure");
    MeasureOptions quiet = options;
    quiet.progress = nullptr;
    const Vec3 size = bricks.bounds.size();
    const double longest_side = std::max({size.x, size.y, size.z});
    const auto each = [&](const char* stage, const auto& call) {
        for (std::size_t b = 0; b < bricks.bricks.size(); ++b) {
            report_progress(options.progress, stage, static_cast<double>(b) / static_cast<double>(bricks.bricks.size()));
            BrickMesh brick = read_brick(bricks, b);
            if (fields) brick.mesh = fields(std::move(brick.mesh));
            call(b, brick, MeasuredCells{brick.owned_cells, longest_side});
        }
    };
    LimitMeasure all;
    each("measure", [&](std::size_t b, const BrickMesh& brick, const MeasuredCells& cells) {
        add(measure_part(brick.mesh, cells, quiet), brick, b == 0, all);
    });
    for (FieldMeasure& field : all.whole.fields) {
        field.mean = all.whole.volume != 0 ? field.integral / all.whole.volume : 0;
        field.histogram.assign(static_cast<std::size_t>(options.bins), 0);
    }
    each("histogram", [&](std::size_t, const BrickMesh& brick, const MeasuredCells& cells) {
        add_to_histograms(brick.mesh, cells, quiet, all.whole);
    });
    return all;
}

}  // namespace subvol
