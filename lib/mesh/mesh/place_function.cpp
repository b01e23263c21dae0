// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/place_function.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace subvol::detail {

bool has_functions(const HexMesh& mesh) {
    return std::ranges::any_of(mesh.attributes, [](const Attribute& field) { return field.function != nullptr; });
}

HexMesh with_arguments(HexMesh mesh) {
    for (Attribute& field : mesh.attributes) {
        if (field.function == nullptr) continue;
        field = {std::move(field.name), static_cast<int>(field.function->arguments), std::move(field.arguments)};
    }
    return mesh;
}

void restore_functions(HexMesh& mesh, std::span<const Attribute> fields) {
    for (std::size_t a = 0; a < fields.size(); ++a) {
        if (fields[a].function == nullptr) continue;
        Attribute& field = mesh.attributes[a];
        field.arguments = std::move(field.values);
        field.channels = fields[a].channels;
        field.bounds = fields[a].bounds;
        field.function = fields[a].function;
        evaluate_at_points(field);
    }
}

Attribute without_values(const Attribute& field) {
    Attribute empty{field.name, field.channels, {}, field.bounds, field.function};
    empty.derived = field.derived;
    return empty;
}

void add_point(const Attribute& from, std::size_t point, Attribute& to) {
    const auto channels = static_cast<std::size_t>(from.channels);
    const auto first = from.values.begin() + static_cast<std::ptrdiff_t>(point * channels);
    to.values.insert(to.values.end(), first, first + from.channels);
    if (from.function == nullptr) return;
    const std::size_t count = from.function->arguments;
    const auto argument = from.arguments.begin() + static_cast<std::ptrdiff_t>(point * count);
    to.arguments.insert(to.arguments.end(), argument, argument + static_cast<std::ptrdiff_t>(count));
}

void copy_point(const Attribute& from, std::size_t point, Attribute& to, std::size_t to_point) {
    const auto channels = static_cast<std::size_t>(from.channels);
    std::copy_n(&from.values[point * channels], channels, &to.values[to_point * channels]);
    if (from.function == nullptr) return;
    const std::size_t count = from.function->arguments;
    std::copy_n(&from.arguments[point * count], count, &to.arguments[to_point * count]);
}

void evaluate_at_points(Attribute& field) {
    if (field.function == nullptr) return;
    const PlaceFunction& function = *field.function;
    const std::size_t points = field.arguments.size() / function.arguments;
    field.values.resize(points * function.channels);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points, 1024), [&](const auto& range) {
        const std::size_t first = range.begin(), count = range.end() - first;
        function.evaluate(std::span(field.arguments).subspan(first * function.arguments, count * function.arguments),
                          std::span(field.values).subspan(first * function.channels, count * function.channels));
    });
}

std::vector<Attribute> without_functions(std::vector<Attribute> fields) {
    for (Attribute& field : fields) {
        if (field.function != nullptr) field = {std::move(field.name), field.channels, std::move(field.values)};
    }
    return fields;
}

void change_places(Attribute& field, const std::function<void(std::span<double> values)>& change) {
    change(field.values);
    if (field.function == nullptr) return;
    PlaceFunction changed = *field.function;
    changed.evaluate = [before = field.function, change](std::span<const double> arguments, std::span<double> values) {
        before->evaluate(arguments, values);
        change(values);
    };
    field.function = std::make_shared<const PlaceFunction>(std::move(changed));
}

void change_values(Attribute& field, const std::function<double(double)>& change) {
    change_places(field, [change](std::span<double> values) {
        for (double& value : values) value = change(value);
    });
    for (auto& [low, high] : field.bounds) std::tie(low, high) = std::minmax({change(low), change(high)});
}

bool changes_at_places(const Attribute& field) {
    return field.function != nullptr || !field.bounds.empty();
}

std::span<const double> values_at_places(const Attribute& field, std::span<const double> refined, std::vector<double>& memory) {
    if (!changes_at_places(field)) return refined;
    if (field.function != nullptr) {
        memory.resize(refined.size() / field.function->arguments * field.function->channels);
        field.function->evaluate(refined, memory);
    } else {
        memory.assign(refined.begin(), refined.end());
    }
    const std::size_t channels = field.bounds.size();
    for (std::size_t i = 0; channels > 0 && i < memory.size(); ++i) {
        const auto& [low, high] = field.bounds[i % channels];
        memory[i] = std::min(std::max(memory[i], low), high);
    }
    return memory;
}

}  // namespace subvol::detail
