// SPDX-License-Identifier: Apache-2.0
// A quantity is built from the inside outwards, each step a function of the field before it:
//
//     U ── length ──► |U| ── v0^2 / 2 ──► |U|²/2          arguments: the three channels of U
//
// A linear step of a field that is no function itself is computed at the points, and that is all. Any other makes a function
// of the arguments that the steps before had, or of the field itself.
#include "field_functions.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "subvol/detail/place_function.h"

namespace subvol::detail {
namespace {

void keep_within(std::span<const std::array<double, 2>> bounds, std::span<double> values) {
    if (bounds.empty()) return;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto& [low, high] = bounds[i % bounds.size()];
        values[i] = std::min(std::max(values[i], low), high);
    }
}

/// The range of all channels, which is never 0.
double scale_of(const Attribute& field) {
    if (field.values.empty()) return 1;
    const auto [low, high] = std::ranges::minmax(field.values);
    const double size = std::max(std::abs(low), std::abs(high)), least = 1e-6 * size;
    return size > 0 ? std::max(high - low, least) : 1;
}

/// A field as a function: of itself, within its bounds, if it is none.
PlaceFunction function_of(const Attribute& field) {
    const auto channels = static_cast<std::size_t>(field.channels);
    if (field.function == nullptr) {
        return {channels, channels, std::vector<double>(channels, scale_of(field)),
                [bounds = field.bounds](std::span<const double> arguments, std::span<double> values) {
                    std::ranges::copy(arguments, values.begin());
                    keep_within(bounds, values);
                }};
    }
    if (field.bounds.empty()) return *field.function;
    PlaceFunction within = *field.function;
    within.evaluate = [of = field.function, bounds = field.bounds](std::span<const double> arguments,
                                                                   std::span<double> values) {
        of->evaluate(arguments, values);
        keep_within(bounds, values);
    };
    return within;
}

const std::vector<double>& arguments_of(const Attribute& field) {
    return field.function == nullptr ? field.values : field.arguments;
}

/// Calls the function for places one by one.
void at_each(const ChannelFunction& function, std::size_t channels, std::span<const double> from, std::size_t count,
             std::span<double> to) {
    for (std::size_t p = 0; p < to.size() / count; ++p) {
        function(from.subspan(p * channels, channels), to.subspan(p * count, count));
    }
}

/// Numbers at cells, if all scalars have such and all or none of them are constant there.
void put_cells(std::span<const Attribute* const> scalars, Attribute& result) {
    const Attribute& first = *scalars[0];
    const auto is_like_first = [&](const Attribute* scalar) {
        return scalar->cells.size() == first.cells.size() && scalar->constant == first.constant;
    };
    if (!std::ranges::all_of(scalars, is_like_first)) return;
    result.constant = first.constant;
    for (std::size_t i = 0; i < first.cells.size(); ++i) {
        for (const Attribute* scalar : scalars) result.cells.push_back(scalar->cells[i]);
    }
}

}  // namespace

Attribute applied(const Attribute& field, std::string name, int channels, Rule rule, const ChannelFunction& function) {
    const auto from = static_cast<std::size_t>(field.channels), count = static_cast<std::size_t>(channels);
    Attribute result{std::move(name), channels, std::vector<double>(field.values.size() / from * count)};
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, result.values.size() / count, 1024), [&](const auto& range) {
        const std::size_t places = range.end() - range.begin();
        at_each(function, from, std::span(field.values).subspan(range.begin() * from, places * from), count,
                std::span(result.values).subspan(range.begin() * count, places * count));
    });
    result.constant = field.constant;
    result.derived = field.derived;
    result.cells.resize(field.cells.size() / from * count);
    at_each(function, from, field.cells, count, result.cells);
    if (field.constant || (rule == Rule::Linear && field.function == nullptr)) return result;
    PlaceFunction inner = function_of(field);
    PlaceFunction outer{inner.arguments, count, inner.scales, {}};
    const bool direct = field.function == nullptr && field.bounds.empty();
    if (direct) {
        outer.evaluate = [function, from, count](std::span<const double> arguments, std::span<double> values) {
            at_each(function, from, arguments, count, values);
        };
    } else {
        outer.evaluate = [inner = std::move(inner), function, from, count](std::span<const double> arguments,
                                                                           std::span<double> values) {
            std::vector<double> between(values.size() / count * from);
            inner.evaluate(arguments, between);
            at_each(function, from, between, count, values);
        };
    }
    result.function = std::make_shared<const PlaceFunction>(std::move(outer));
    result.arguments = arguments_of(field);
    return result;
}

Attribute applied(const Attribute& field, const TensorFunction& function) {
    Attribute result =
        applied(field, field.name, 1, function.is_linear ? Rule::Linear : Rule::Nonlinear,
                [value = function.value](std::span<const double> channels, std::span<double> to) { to[0] = value(channels); });
    if (function.is_size) result.bounds = {{0, std::numeric_limits<double>::infinity()}};
    return result;
}

Attribute channel_of(const Attribute& field, std::size_t channel, std::string name) {
    Attribute result =
        applied(field, std::move(name), 1, Rule::Linear,
                [channel](std::span<const double> channels, std::span<double> value) { value[0] = channels[channel]; });
    if (!field.bounds.empty()) result.bounds = {field.bounds[channel]};
    result.walls.points = field.walls.points;
    for (std::size_t p = 0; p < field.walls.points.size(); ++p)
        result.walls.gradients.push_back(field.walls.gradients[p * static_cast<std::size_t>(field.channels) + channel]);
    return result;
}

Attribute joined(std::span<const Attribute* const> scalars, std::string name) {
    const std::size_t count = scalars.size(), points = scalars[0]->values.size();
    Attribute result{std::move(name), static_cast<int>(count), std::vector<double>(count * points)};
    for (std::size_t c = 0; c < count; ++c) {
        for (std::size_t p = 0; p < points; ++p) result.values[p * count + c] = scalars[c]->values[p];
    }
    if (std::ranges::any_of(scalars, [](const Attribute* scalar) { return !scalar->bounds.empty(); })) {
        constexpr double kFree = std::numeric_limits<double>::infinity();
        for (const Attribute* scalar : scalars) {
            result.bounds.push_back(scalar->bounds.empty() ? std::array{-kFree, kFree} : scalar->bounds[0]);
        }
    }
    put_cells(scalars, result);
    result.derived = std::ranges::any_of(scalars, &Attribute::derived);
    if (std::ranges::none_of(scalars, [](const Attribute* scalar) { return scalar->function != nullptr; })) return result;
    PlaceFunction function{0, count, {}, {}};
    std::vector<PlaceFunction> parts;
    for (const Attribute* scalar : scalars) {
        parts.push_back(function_of(*scalar));
        function.arguments += parts.back().arguments;
        function.scales.insert(function.scales.end(), parts.back().scales.begin(), parts.back().scales.end());
    }
    const std::size_t width = function.arguments;
    function.evaluate = [parts = std::move(parts), width](std::span<const double> arguments, std::span<double> values) {
        const std::size_t places = arguments.size() / width;
        std::vector<double> of_part, found(places);
        for (std::size_t c = 0, first = 0; c < parts.size(); first += parts[c++].arguments) {
            const std::size_t wide = parts[c].arguments;
            of_part.resize(places * wide);
            for (std::size_t i = 0; i < of_part.size(); ++i) of_part[i] = arguments[i / wide * width + first + i % wide];
            parts[c].evaluate(of_part, found);
            for (std::size_t p = 0; p < places; ++p) values[p * parts.size() + c] = found[p];
        }
    };
    result.function = std::make_shared<const PlaceFunction>(std::move(function));
    result.arguments.resize(width * points);
    for (std::size_t first = 0; const Attribute* scalar : scalars) {
        const std::vector<double>& of_part = arguments_of(*scalar);
        const std::size_t wide =
            scalar->function == nullptr ? static_cast<std::size_t>(scalar->channels) : scalar->function->arguments;
        for (std::size_t i = 0; i < of_part.size(); ++i) result.arguments[i / wide * width + first + i % wide] = of_part[i];
        first += wide;
    }
    return result;
}

}  // namespace subvol::detail
