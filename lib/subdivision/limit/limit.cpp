// SPDX-License-Identifier: Apache-2.0
// The limit at arbitrary places of a mesh, a place being a cell and its parameters (u, v, w).
//
// A place is found by bisection. Refinement cuts a cell into eight children; the place lies in one of them, at twice its
// parameters, and that child is cut again:
//
//     level 0            level 1            level 2
//     ┌───────────┐      ┌─────┬─────┐      ┌──┬──┬─────┐
//     │           │      │     │     │      │  │  │     │     u ← 2u or 2u − 1 at each step, likewise v and w;
//     │  x        │      ├─────┼─────┤      ├──┼──┤─────┤     the cell that has x has an edge of 2⁻ˡ in the
//     │           │      │  x  │     │      │ x│  │     │     parameters of the control cell
//     └───────────┘      └─────┴─────┘      └──┴──┴─────┘
//
// At each level the points around that cell give an approximation of the limit there, position, values and derivatives (a
// *jet*, jets.h). It is exact at once where the scheme is a spline and the cell lies in a grid. Elsewhere the place is done
// when the jets of consecutive levels agree within the tolerance.
//
// What has to be refined on the way is shared between places. LimitDescents answers nearly all queries by tables of the
// neighbourhood's class. Those that are left, next to points where very many cells meet or where cells meet in an edge or a
// point alone, are refined as patches by PatchTree, until the descendant that has the place has surroundings of a class: of a
// cell's eight children all but those at the contact have one.
#include "subvol/limit.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "constant_fields.h"
#include "jets.h"
#include "limit_descents.h"
#include "patch_tree.h"
#include "subvol/cell.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/detail/tolerance_length.h"
#include "subvol/detail/topology_parts.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

using namespace detail;

namespace {

void check(const LimitOptions& options) {
    if (!(options.tolerance >= 0 && std::isfinite(options.tolerance)) || options.max_levels < 2 || options.max_levels > 20) {
        throw Error(ErrorCode::InvalidInput, "the tolerance or the number of levels is out of range", "limit",
                    "tolerance >= 0, 2 to 20 levels");
    }
}

void check(const HexMesh& mesh, std::span<const LimitQuery> queries) {
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const auto& [cell, uvw] = queries[i];
        const bool inside = uvw.x >= 0 && uvw.x <= 1 && uvw.y >= 0 && uvw.y <= 1 && uvw.z >= 0 && uvw.z <= 1;
        if (cell < mesh.cells.size() && inside) continue;
        throw Error(ErrorCode::InvalidInput,
                    cell < mesh.cells.size() ? "the parameters are outside [0,1]" : "there is no cell " + std::to_string(cell),
                    "limit query " + std::to_string(i));
    }
}

/// The scale of each channel that tolerances are relative to. It is not 0 for a constant field, whose values differ by
/// rounding.
std::vector<double> channel_scales(const HexMesh& mesh, const LimitExtent& extent) {
    std::vector<double> scales(3, std::max(extent.length(), 1e-6 * glm::length(extent.box.center())));
    for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
        if (const PlaceFunction* function = mesh.attributes[a].function.get()) {
            scales.insert(scales.end(), function->scales.begin(), function->scales.end());
            continue;
        }
        const auto& [low, high] = extent.ranges[a];
        const double scale = std::max(high - low, 1e-6 * std::max(std::abs(low), std::abs(high)));
        scales.insert(scales.end(), static_cast<std::size_t>(mesh.attributes[a].channels), scale);
    }
    return scales;
}

LimitSamples make_samples(const HexMesh& mesh, std::size_t count) {
    LimitSamples samples;
    samples.positions.resize(count);
    samples.jacobians.resize(count);
    for (const auto& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        samples.attributes.push_back(
            {attribute.name, channels, std::vector<double>(count * channels), std::vector<Vec3>(count * channels)});
    }
    return samples;
}

/// The values of a function, and by the chain rule its derivatives: differences of the function along those of its arguments.
/// Steps are so small that a square is exact to rounding, and the roundings of a difference are 1e-11 of the value.
void evaluate(const PlaceFunction& function, std::size_t first, std::size_t count, const LimitAttribute& arguments,
              LimitAttribute& samples) {
    constexpr double kStep = 1e-5;  // as a part of the range of the argument that changes most
    const std::size_t width = function.arguments, channels = function.channels;
    function.evaluate(std::span(arguments.values).subspan(first * width, count * width),
                      std::span(samples.values).subspan(first * channels, count * channels));
    std::vector<double> beside(6 * count * width), found(6 * count * channels), steps(3 * count, 0);
    for (std::size_t q = 0; q < count; ++q) {
        const double* const at = &arguments.values[(first + q) * width];
        const Vec3* const slopes = &arguments.derivatives[(first + q) * width];
        for (int d = 0; d < 3; ++d) {
            const std::size_t k = 3 * q + static_cast<std::size_t>(d);
            double most = 0;
            for (std::size_t c = 0; c < width; ++c) most = std::max(most, std::abs(slopes[c][d]) / function.scales[c]);
            steps[k] = most > 0 ? kStep / most : 0;
            for (std::size_t c = 0; c < width; ++c) {
                beside[2 * k * width + c] = at[c] - steps[k] * slopes[c][d];
                beside[(2 * k + 1) * width + c] = at[c] + steps[k] * slopes[c][d];
            }
        }
    }
    function.evaluate(beside, found);
    for (std::size_t q = 0; q < count; ++q) {
        for (int d = 0; d < 3; ++d) {
            const std::size_t k = 3 * q + static_cast<std::size_t>(d);
            for (std::size_t c = 0; steps[k] > 0 && c < channels; ++c) {
                samples.derivatives[(first + q) * channels + c][d] =
                    (found[(2 * k + 1) * channels + c] - found[2 * k * channels + c]) / (2 * steps[k]);
            }
        }
    }
}

/// From the samples of the arguments to those of the fields.
void evaluate(std::span<const Attribute> fields, LimitSamples& samples) {
    constexpr std::size_t kGrain = 64;
    for (std::size_t a = 0; a < fields.size(); ++a) {
        if (fields[a].function == nullptr) continue;
        const PlaceFunction& function = *fields[a].function;
        const LimitAttribute arguments = std::move(samples.attributes[a]);
        const std::size_t count = samples.positions.size(), channels = function.channels;
        samples.attributes[a] = {arguments.name, channels, std::vector<double>(count * channels),
                                 std::vector<Vec3>(count * channels, Vec3(0.0))};
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
            evaluate(function, range.begin(), range.end() - range.begin(), arguments, samples.attributes[a]);
        });
    }
}

/// Moves values beyond their bounds to these; there the field is constant.
void keep_within(std::span<const std::array<double, 2>> bounds, LimitAttribute& samples) {
    if (bounds.empty()) return;
    for (std::size_t i = 0; i < samples.values.size(); ++i) {
        const auto& [low, high] = bounds[i % bounds.size()];
        const double within = std::min(std::max(samples.values[i], low), high);
        if (within != samples.values[i]) samples.derivatives[i] = Vec3(0.0);
        samples.values[i] = within;
    }
}

/// The numbers of the queries, sorted by cells. A counting sort: it keeps the order of the queries in a cell, so that results
/// do not depend on the threads.
std::vector<std::size_t> sorted_by_cells(std::span<const LimitQuery> queries, std::size_t cells) {
    std::vector<std::size_t> next(cells + 1, 0), order(queries.size());
    for (const LimitQuery& query : queries) ++next[query.cell + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (std::size_t q = 0; q < queries.size(); ++q) order[next[queries[q].cell]++] = q;
    return order;
}

/// The queries of each cell, by their places in `order`.
std::vector<CellPlaces> places_of_cells(std::span<const LimitQuery> queries, std::span<const std::size_t> order) {
    std::vector<CellPlaces> cells;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Index cell = queries[order[i]].cell;
        if (cells.empty() || cells.back().cell != cell) cells.push_back({cell, i, i});
        cells.back().last = i + 1;
    }
    return cells;
}

/// The fields of a mesh without their values; in the mesh the arguments of functions take their place.
std::vector<Attribute> take_fields(HexMesh& mesh) {
    std::vector<Attribute> fields;
    for (const Attribute& field : mesh.attributes) fields.push_back(without_values(field));
    mesh = with_arguments(std::move(mesh));
    return fields;
}

/// What all calls for one mesh share: the control mesh with its automatic creases, the scales of the tolerances, the classes.
struct Evaluation {
    /// whole: the extent of the mesh that this is a part of, or none
    Evaluation(const HexMesh& mesh, const LimitOptions& with, const LimitExtent* whole = nullptr)
        : options((check(with), with)),
          control(detail::control_mesh(mesh, options.scheme)),
          scales(channel_scales(control, whole != nullptr ? *whole : detail::limit_extent(control))),
          fields(take_fields(control)),
          descents(control, options.scheme, /*by_frequency=*/whole == nullptr),
          patches(control, options.scheme) {}

    /// keep:    what had to be refined, for the next call
    /// targets: if not empty, positions that the queries approach; moved: by how much they have
    [[nodiscard]] LimitSamples at(std::span<const LimitQuery> queries, bool keep, std::span<const Vec3> targets = {},
                                  std::span<Vec3> moved = {}) const {
        check(control, queries);
        LimitSamples samples = make_samples(control, queries.size());
        const auto order = sorted_by_cells(queries, control.cells.size());
        const auto cells = places_of_cells(queries, order);
        auto rest = descents.run({control, queries, order, options, scales, samples, targets, moved}, cells, keep);
        const DescentTask task{control, queries, order, options, scales, samples};
        while (!rest.empty()) rest = patches.run(task, rest, *descents.classes());
        evaluate(fields, samples);
        for (std::size_t a = 0; a < fields.size(); ++a) keep_within(fields[a].bounds, samples.attributes[a]);
        for (const std::size_t a : constants.fields()) {
            LimitAttribute& field = samples.attributes[a];
            for (std::size_t q = 0; q < queries.size(); ++q)
                std::ranges::copy(constants.values(a, queries[q].cell), &field.values[q * field.channels]);
            std::ranges::fill(field.derivatives, Vec3(0.0));
        }
        return samples;
    }

    LimitOptions options;
    HexMesh control;  // with the arguments of its functions
    ConstantFields constants{control};
    std::vector<double> scales;     // of the channels
    std::vector<Attribute> fields;  // of the mesh that was given, without values
    detail::LimitDescents descents;
    mutable detail::PatchTree patches;  // has a lock of its own
};

}  // namespace

double detail::LimitExtent::length() const {
    return tolerance_length(box, cell);
}

void detail::LimitExtent::add(const LimitExtent& more) {
    box.add(more.box);
    cell = std::max(cell, more.cell);
    if (ranges.empty()) ranges = more.ranges;
    for (std::size_t a = 0; a < more.ranges.size(); ++a) {
        ranges[a] = {std::min(ranges[a][0], more.ranges[a][0]), std::max(ranges[a][1], more.ranges[a][1])};
    }
}

namespace {

double largest_cell(const HexMesh& mesh) {
    double largest = 0;
    for (const auto& cell : mesh.cells) {
        Box box;
        for (const Index p : cell) box.add(mesh.points[p]);
        largest = std::max(largest, box.diagonal());
    }
    return largest;
}

}  // namespace

double detail::tolerance_length(const HexMesh& mesh) {
    return LimitExtent{.box = bounds(mesh), .cell = largest_cell(mesh)}.length();
}

LimitExtent detail::limit_extent(const HexMesh& mesh) {
    const std::vector<std::uint8_t> used = used_points(mesh);
    LimitExtent extent{.box = bounds(mesh), .cell = largest_cell(mesh)};
    for (const Attribute& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        auto& [low, high] = extent.ranges.emplace_back(std::array{HUGE_VAL, -HUGE_VAL});
        if (is_constant_in_cells(mesh, attribute)) {
            for (const double value : attribute.cells) low = std::min(low, value), high = std::max(high, value);
            continue;
        }
        for (std::size_t i = 0; i < attribute.values.size(); ++i) {
            if (used[i / channels] == 0) continue;
            low = std::min(low, attribute.values[i]);
            high = std::max(high, attribute.values[i]);
        }
    }
    return extent;
}

struct LimitEvaluator::State {
    Evaluation evaluation;
};

LimitEvaluator::LimitEvaluator(const HexMesh& mesh, const LimitOptions& options) : state_(new State{{mesh, options}}) {
}
LimitEvaluator::LimitEvaluator(const HexMesh& mesh, const LimitOptions& options, const LimitExtent& whole)
    : state_(new State{{mesh, options, &whole}}) {
}
LimitEvaluator::~LimitEvaluator() = default;
LimitEvaluator::LimitEvaluator(LimitEvaluator&&) noexcept = default;
LimitEvaluator& LimitEvaluator::operator=(LimitEvaluator&&) noexcept = default;

LimitSamples LimitEvaluator::at(std::span<const LimitQuery> queries) const {
    return state_->evaluation.at(queries, true);
}

LimitSamples LimitEvaluator::approach(std::span<LimitQuery> queries, std::span<const Vec3> positions) const {
    if (positions.size() != queries.size()) {
        throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(positions.size()) + " positions", "limit",
                    "as many as queries, " + std::to_string(queries.size()));
    }
    std::vector<Vec3> moved(queries.size(), Vec3(0.0));
    const Evaluation& evaluation = state_->evaluation;
    LimitSamples samples = evaluation.at(queries, true, positions, moved);
    for (std::size_t q = 0; q < queries.size(); ++q) {
        queries[q].uvw = glm::clamp(queries[q].uvw + moved[q], Vec3(0.0), Vec3(1.0));
    }
    return samples;
}

LimitSamples evaluate_limit(const HexMesh& mesh, std::span<const LimitQuery> queries, const LimitOptions& options) {
    return Evaluation(mesh, options).at(queries, false);
}

std::vector<Option> options_of(LimitOptions& options) {
    return {
        Option("tolerance", options.tolerance)
            .not_negative()
            .help("E",
                  "what is not exact is refined until two levels differ by less: of the diagonal and of each field's range"),
        Option("max-levels", options.max_levels).between(2, 20).help("N", "refinement ends there in any case")};
}

}  // namespace subvol
