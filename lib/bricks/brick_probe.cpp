// SPDX-License-Identifier: Apache-2.0
#include "subvol/brick_probe.h"

#include <algorithm>
#include <atomic>
#include <limits>

#include "brick_layers.h"
#include "slice_part.h"
#include "subvol/detail/median_tree.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

bool contains(const Box& box, const Vec3& x) {
    return touch(box, {x, x});
}

/// The owned cells of a brick that a place may lie in, with the halo that their limit needs.
BrickMesh about_places(BrickMesh brick, const std::vector<Vec3>& places, int layers) {
    const CellReaches reaches(brick.mesh);
    const MedianTree<Box> tree(places, 16, [&](Index p) { return Box{places[p], places[p]}; });
    const auto has_place = [&](const Box& box) {
        bool found = false;
        tree.visit_leaves([&](const Box& of_node) { return touch(box, of_node); },
                          [&](std::size_t first, std::size_t last) {
                              for (; first < last && !found; ++first) found = contains(box, places[tree.item(first)]);
                              return found;
                          });
        return found;
    };
    parallel_each(brick.owned_cells.size(), [&](std::size_t c) {
        auto& wanted = brick.owned_cells[c];
        wanted = wanted && !places.empty() && has_place(reaches(c));
    });
    std::vector<std::uint8_t> kept = brick.owned_cells;
    grow(brick.mesh, kept, layers);
    return subset(brick, kept);
}

/// Takes one place of a result.
void take(const ProbeResult& from, std::size_t i, ProbeResult& to, std::size_t place) {
    to.parameters[place] = from.parameters[i];
    for (std::size_t f = 0; f < to.fields.size(); ++f) {
        const std::size_t channels = to.fields[f].channels;
        for (std::size_t c = 0; c < channels; ++c) {
            to.fields[f].values[place * channels + c] = from.fields[f].values[i * channels + c];
            to.fields[f].gradients[place * channels + c] = from.fields[f].gradients[i * channels + c];
        }
    }
}

}  // namespace

ProbeResult probe_bricks(const Bricks& bricks, std::span<const Vec3> places, const ProbeOptions& options,
                         const BrickFields& fields, Progress* progress) {
    if (options.reach_world > 0) throw Error(ErrorCode::InvalidInput, "distances to bricks are not found");
    ProbeResult result;
    result.cells.assign(places.size(), kNone);
    result.parameters.resize(places.size());
    result.distances.assign(places.size(), 0);
    for (std::size_t b = 0; b < bricks.bricks.size(); ++b) {
        report_progress(progress, "probe", static_cast<double>(b) / static_cast<double>(bricks.bricks.size()));
        std::vector<std::size_t> numbers;
        std::vector<Vec3> here;
        for (std::size_t p = 0; p < places.size(); ++p) {
            if (!contains(bricks.bricks[b].reach, places[p])) continue;
            numbers.push_back(p);
            here.push_back(places[p]);
        }
        if (here.empty() && !(b == 0 && result.fields.empty())) continue;
        BrickMesh part = about_places(read_brick(bricks, b), here, bricks.halo_layers);
        if (fields) part.mesh = fields(std::move(part.mesh));
        if (result.fields.empty()) {
            for (const Attribute& field : part.mesh.attributes) {
                const auto channels = static_cast<std::size_t>(field.channels);
                result.fields.push_back({field.name, channels, std::vector<double>(places.size() * channels),
                                         std::vector<Vec3>(places.size() * channels, Vec3(0.0))});
            }
        }
        if (part.mesh.cells.empty()) continue;
        const ProbeResult found = LimitProbe(part.mesh, options).at(here);
        result.rounds = std::max(result.rounds, found.rounds);
        for (std::size_t i = 0; i < here.size(); ++i) {
            if (!found.inside(i) || !part.owned_cells[found.cells[i]]) continue;
            const std::uint64_t cell = part.cell_numbers[found.cells[i]];
            if (cell >= kNone || (result.cells[numbers[i]] != kNone && result.cells[numbers[i]] < cell)) continue;
            result.cells[numbers[i]] = static_cast<Index>(cell);
            take(found, i, result, numbers[i]);
        }
    }
    return result;
}

LimitSlice slice_limit(const Bricks& bricks, const Vec3& point, const Vec3& normal, const SliceOptions& options,
                       const BrickFields& fields) {
    LimitSlice slice = detail::empty_slice(bricks.bounds, point, normal, options);
    const auto first_alone = [&](HexMesh brick) {
        if (fields) brick = fields(std::move(brick));
        brick = with_scalar_field(brick, {});
        slice.field = brick.attributes.front().name;
        return brick;
    };
    LimitOptions quiet = options.limit;
    quiet.progress = nullptr;
    const std::vector<Vec3> places = detail::places_of(slice);
    detail::take_found(slice, probe_bricks(bricks, places, {.limit = quiet}, first_alone, options.progress));
    return slice;
}

}  // namespace subvol
