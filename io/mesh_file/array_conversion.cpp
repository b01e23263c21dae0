// SPDX-License-Identifier: Apache-2.0
// Arrays of a file as fields of the mesh. A field with a value that is not finite, at a cell or its points, is kept aside as
// one that is not everywhere, unless it has no value at all. Labels, which number things, are constant in each cell. Warnings
// say in one line each what was done to all arrays of a kind.
#include "array_conversion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <span>
#include <utility>

#include "assemble.h"
#include "subvol/cell.h"
#include "subvol/detail/cell_splits.h"
#include "subvol/detail/small_letters.h"

namespace subvol::detail {

namespace {

// The mean at each point over its cells, weighted by volume; where all of them have no volume, the plain mean. Splitting may
// make folded cells, whose signed volume is negative: their size counts, so that the mean stays between the values. Cells
// without a value do not count; NaN at points that have no other cells.
std::vector<double> mean_over_cells(const HexMesh& mesh, const std::vector<double>& values, std::size_t components) {
    std::vector<double> sums(mesh.points.size() * components);
    std::vector<double> plain_sums(sums.size());
    std::vector<double> weights(mesh.points.size());
    std::vector<double> counts(mesh.points.size());
    std::vector<std::uint8_t> in_cell(mesh.points.size());
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (const Index p : mesh.cells[c]) in_cell[p] = 1;
        const double volume = std::abs(cell_volume(corners_of(mesh, mesh.cells[c])));
        const auto tuple = std::span(values).subspan(c * components, components);
        if (!std::ranges::all_of(tuple, [](double value) { return std::isfinite(value); })) continue;
        for (const Index p : mesh.cells[c]) {
            weights[p] += volume;
            counts[p] += 1;
            for (std::size_t k = 0; k < components; ++k) {
                sums[p * components + k] += volume * values[c * components + k];
                plain_sums[p * components + k] += values[c * components + k];
            }
        }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const std::size_t p = i / components;
        if (counts[p] == 0) {
            if (in_cell[p] != 0) sums[i] = std::numeric_limits<double>::quiet_NaN();
            continue;
        }
        sums[i] = weights[p] > 0 ? sums[i] / weights[p] : plain_sums[i] / counts[p];
    }
    return sums;
}

/// The array with the range of its values at what is read: not at points that no cell uses, or elements that are left out.
FieldInfo describe(const FileArray& array, const MeshOrigin& origin) {
    FieldInfo info{array.name, array.at_cells ? "cell" : "point", array.components, 0, 0, printable(array.unit)};
    const auto components = static_cast<std::size_t>(array.components);
    bool first = true;
    const auto add = [&](std::size_t tuple) {
        const std::size_t i = tuple * components;
        if (i + components > array.values.size()) return;
        double value = array.values[i];
        if (components > 1) {
            double sum = 0;
            for (std::size_t c = 0; c < components; ++c) sum += array.values[i + c] * array.values[i + c];
            value = std::sqrt(sum);
        }
        if (!std::isfinite(value)) return;
        info.min = first ? value : std::min(info.min, value);
        info.max = first ? value : std::max(info.max, value);
        first = false;
    };
    if (array.at_cells && !origin.cell_numbers.empty()) {
        for (const Index cell : origin.cell_numbers) add(cell);
        for (const Index shell : origin.shell_numbers) add(shell);
        return info;
    }
    for (std::size_t tuple = 0; tuple * components < array.values.size(); ++tuple) {
        if (array.at_cells || tuple >= origin.used.size() || origin.used[tuple] != 0) add(tuple);
    }
    return info;
}
}  // namespace

bool ArrayConversion::take(FileArray&& array) {
    // The names of all formats pass here: they appear in messages, JSON and files, and users write them to choose the
    // field.
    array.name = array.name.empty() ? "unnamed" : printable(array.name);
    if (const std::string place = array.at_cells ? gap_at_cells(array) : gap_at_points(array); !place.empty()) {
        if (!take_incomplete(array)) unread_.push_back({array.name, "the value at " + place + " is not finite"});
        return false;
    }
    result_.fields.push_back(describe(array, origin_));
    const FieldInfo& info = result_.fields.back();
    if (array.components == 1 && upper_case(array.name) == "DENSITY" && info.min < 0) {
        result_.warnings.push_back(in_quotes(array.name) + " has negative values");
    }
    Attribute attribute{distinct_.take(array.name), array.components, {}};
    if (array.at_cells && !array.on_patches.empty()) take_on_patches(attribute.name, array);
    if (array.at_cells) {
        attribute.cells = of_cells(array);
        take_cells(array, attribute);
    } else if (cell_values_ != CellValues::Mean && is_label_at_points(array)) {
        take_labels(array, attribute);
    } else {
        attribute.values = from_points(std::move(array));
    }
    result_.mesh.attributes.push_back(std::move(attribute));
    return true;
}

void ArrayConversion::finish(std::vector<UnreadField>&& unread) {
    LeftOut left_out;
    for (std::vector<UnreadField>* some : {&unread, &unread_}) {
        for (UnreadField& field : *some) {
            field.name = printable(field.name);
            left_out.add(field.name, field.why);
            result_.unread.push_back(std::move(field));
        }
    }
    left_out.report("field", "fields", result_.warnings, result_.ignored);
    if (!incomplete_.empty()) {
        result_.warnings.push_back((incomplete_.size() == 1
                                        ? "field " + listed(incomplete_) + " has no value at "
                                        : std::to_string(incomplete_.size()) + " fields (" + listed(incomplete_) +
                                              ") are not everywhere; the first has no value at ") +
                                   gaps_);
    }
    if (!unfitted_.empty())
        result_.warnings.push_back(listed(unfitted_) +
                                   (unfitted_.size() == 1 ? " has gaps, so it is" : " have gaps, so they are") +
                                   " not fitted to the means over the cells, but the mean of these at each point");
    distinct_.report(result_.warnings);
    if (!labels_.empty()) {
        result_.warnings.push_back((labels_.size() == 1
                                        ? "cell array " + listed(labels_) + " has"
                                        : std::to_string(labels_.size()) + " cell arrays (" + listed(labels_) + ") have") +
                                   " whole numbers, constant in each cell (--cell-values mean makes values at points of them)");
    }
    if (!point_labels_.empty()) {
        result_.warnings.push_back((point_labels_.size() == 1
                                        ? "point array " + listed(point_labels_) + " numbers things: each cell has"
                                        : std::to_string(point_labels_.size()) + " point arrays (" + listed(point_labels_) +
                                              ") number things: each cell has") +
                                   " the number of most of its points (--cell-values mean makes smooth values of them)");
    }
    if (averaged_.empty()) return;
    result_.warnings.push_back((averaged_.size() == 1
                                    ? "cell array " + listed(averaged_) + " became a point array: the volume-weighted mean"
                                    : std::to_string(averaged_.size()) + " cell arrays became point arrays (" +
                                          listed(averaged_) + "): volume-weighted means") +
                               " over the cells at each point");
}

std::string ArrayConversion::listed(const std::vector<std::string>& all) {
    constexpr std::size_t kMostNamed = 6;
    std::string names;
    for (std::size_t i = 0; i < std::min(all.size(), kMostNamed); ++i) names += (i > 0 ? ", " : "") + all[i];
    if (all.size() > kMostNamed) names += " and " + std::to_string(all.size() - kMostNamed) + " more";
    return names;
}

bool ArrayConversion::is_label(const FileArray& array, const std::vector<double>& of_hexes) {
    const auto differs = [&](double value) { return value != of_hexes.front(); };
    return array.components == 1 && (array.integers || names_label(array.name)) && are_whole(of_hexes) &&
           std::ranges::any_of(of_hexes, differs);
}

bool ArrayConversion::is_label_at_points(const FileArray& array) {
    constexpr std::array<std::string_view, 5> kOfPoints{"node", "point", "vert", "pedigree", "global"};
    const std::string name = small_letters(array.name);
    const auto differs = [&](double value) { return value != array.values.front(); };
    const auto is_in_name = [&](std::string_view word) { return name.find(word) != std::string::npos; };
    return array.components == 1 && names_label(array.name) && name != "id" && name != "ids" &&
           std::ranges::none_of(kOfPoints, is_in_name) && are_whole(array.values) && std::ranges::any_of(array.values, differs);
}

bool ArrayConversion::names_label(const std::string& given) {
    constexpr std::array<std::string_view, 8> kNumbered{"material", "block", "region", "zone",
                                                        "domain",   "group", "part_",  "label"};
    const std::string name = small_letters(given);
    return std::ranges::any_of(kNumbered, [&](std::string_view word) { return name.starts_with(word); }) || name == "mat" ||
           name == "part" || name == "id" || name.ends_with("_id") || name.ends_with("ids") || given.ends_with("Id") ||
           given.ends_with("ID");
}

void ArrayConversion::take_labels(const FileArray& array, Attribute& attribute) {
    const auto& sources = origin_.sources;
    const std::size_t count = result_.mesh.points.size();
    for (std::size_t p = 0; p < count; ++p) attribute.values.push_back(array.values[sources ? (*sources)[p].front() : p]);
    attribute.constant = true;
    for (const auto& cell : result_.mesh.cells) {
        std::map<double, int> votes;
        bool everywhere = true;
        for (const Index p : cell) {
            everywhere = everywhere && !std::isnan(attribute.values[p]);
            if (everywhere && (!sources || (*sources)[p].size() == 1)) ++votes[attribute.values[p]];
        }
        if (!everywhere) {
            attribute.cells.push_back(std::numeric_limits<double>::quiet_NaN());
            continue;
        }
        const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
        attribute.cells.push_back(std::ranges::max_element(votes, fewer)->first);  // the first of those with as many
    }
    point_labels_.push_back(in_quotes(array.name));
}

bool ArrayConversion::take_incomplete(const FileArray& array) {
    FileArray kept = array;
    for (double& value : kept.values) {
        if (!std::isfinite(value)) value = std::numeric_limits<double>::quiet_NaN();
    }
    const auto components = static_cast<std::size_t>(array.components);
    const HexMesh& mesh = result_.mesh;
    FieldInfo info = describe(kept, origin_);
    Attribute field{array.name, array.components, {}};
    std::size_t all = 0;
    if (array.at_cells) {
        field.cells = of_cells(kept);
        field.values = mean_over_cells(mesh, field.cells, components);
        std::vector<double> there;
        std::ranges::copy_if(field.cells, std::back_inserter(there), [](double value) { return !std::isnan(value); });
        field.constant = cell_values_ == CellValues::Constant ||
                         (cell_values_ == CellValues::Auto && !there.empty() && is_label(array, there));
        if (!field.constant && are_means(cell_values_)) unfitted_.push_back(in_quotes(array.name));
        all = mesh.cells.size();
        for (std::size_t c = 0; c < all; ++c) info.missing += has_all(field.cells, c, components) ? 0 : 1;
    } else {
        for (std::size_t p = 0; p < origin_.used.size(); ++p) {
            all += origin_.used[p];
            if (origin_.used[p]) info.missing += has_all(kept.values, p, components) ? 0 : 1;
        }
        FileArray there = kept;
        std::erase_if(there.values, [](double value) { return std::isnan(value); });
        if (cell_values_ != CellValues::Mean && !there.values.empty() && is_label_at_points(there)) {
            take_labels(kept, field);
        } else {
            field.values = from_points(std::move(kept));
        }
    }
    const auto complete = static_cast<std::size_t>(std::ranges::count_if(mesh.cells, [&](const auto& cell) {
        return std::ranges::all_of(cell, [&](Index p) { return has_all(field.values, p, components); });
    }));
    const std::size_t cells = array.at_cells ? all - info.missing : complete;
    if (info.missing == all) return false;
    field.name = distinct_.take(array.name);
    if (incomplete_.empty()) {
        gaps_ = std::to_string(info.missing) + " of " + std::to_string(all) + " " +
                (array.at_cells ? "cells" : std::string(names_.point_word) + "s") +
                (cells == 0 ? ", and no cell has it at all of its points"
                            : ": asked for by its name, it is that of the " + std::to_string(cells) + " of " +
                                  counted(mesh.cells.size(), "cell", "cells") + " that have it; otherwise it is left out");
    }
    incomplete_.push_back(in_quotes(field.name));
    info.name = field.name;
    result_.fields.push_back(std::move(info));
    result_.incomplete.push_back(std::move(field));
    return true;
}

bool ArrayConversion::has_all(const std::vector<double>& values, std::size_t tuple, std::size_t components) {
    return std::ranges::none_of(std::span(values).subspan(tuple * components, components),
                                [](double value) { return std::isnan(value); });
}

void ArrayConversion::take_cells(const FileArray& array, Attribute& attribute) {
    if (are_means(cell_values_)) {  // fitted later
        attribute.values.assign(result_.mesh.points.size() * static_cast<std::size_t>(array.components), 0);
        result_.cell_means.push_back({attribute.name, array.components, attribute.cells});
        return;
    }
    const bool label = cell_values_ == CellValues::Auto && is_label(array, attribute.cells);
    attribute.constant = label || cell_values_ == CellValues::Constant;
    attribute.values = mean_over_cells(result_.mesh, attribute.cells, static_cast<std::size_t>(array.components));
    if (attribute.constant && !label) return;
    (label ? labels_ : averaged_).push_back(in_quotes(array.name));
}

std::string ArrayConversion::gap_at_points(const FileArray& array) const {
    const auto components = static_cast<std::size_t>(array.components);
    for (std::size_t i = 0; i < array.values.size(); ++i) {
        const std::size_t p = i / components;
        if (!std::isfinite(array.values[i]) && origin_.used[p]) return names_.point(p);
    }
    return {};
}

std::string ArrayConversion::gap_at_cells(const FileArray& array) const {
    const auto components = static_cast<std::size_t>(array.components);
    const auto& numbers = origin_.cell_numbers;
    for (std::size_t c = 0; c < result_.mesh.cells.size(); ++c) {
        const std::size_t number = numbers.empty() ? c : numbers[c];
        for (std::size_t k = 0; k < components; ++k) {
            if (!std::isfinite(array.values[number * components + k])) return names_.cell(number);
        }
    }
    return {};
}

std::vector<double> ArrayConversion::from_points(FileArray&& array) const {
    const auto components = static_cast<std::size_t>(array.components);
    return origin_.sources ? means(*origin_.sources, array.values, components) : std::move(array.values);
}

std::vector<double> ArrayConversion::of_cells(const FileArray& array) const {
    const auto components = static_cast<std::size_t>(array.components);
    const auto& numbers = origin_.cell_numbers;
    std::vector<double> of_hexes;
    of_hexes.reserve(result_.mesh.cells.size() * components);
    for (std::size_t c = 0; c < result_.mesh.cells.size(); ++c) {
        const std::size_t number = numbers.empty() ? c : numbers[c];
        for (std::size_t k = 0; k < components; ++k) {
            of_hexes.push_back(array.values[number * components + k]);
        }
    }
    return of_hexes;
}

void ArrayConversion::take_on_patches(const std::string& name, const FileArray& array) {
    ValuesOnPatches& faces = result_.on_patches;
    const auto components = static_cast<std::size_t>(array.components);
    FieldOnPatches& field = faces.fields.emplace_back(FieldOnPatches{name, array.components, {}, {}});
    field.values.assign(faces.patches.size() * components, std::nan(""));
    field.along.assign(faces.patches.size(), 0);
    field.level.assign(faces.patches.size(), 0);
    for (const FileOnPatch& patch : array.on_patches) {
        const auto first = std::ranges::lower_bound(faces.patches, static_cast<Index>(patch.patch));
        const auto last = std::ranges::upper_bound(faces.patches, static_cast<Index>(patch.patch));
        const auto begin = static_cast<std::size_t>(first - faces.patches.begin());
        const auto count = static_cast<std::size_t>(last - first);
        if (patch.values.size() > count * components) continue;  // the patches are of another file
        std::ranges::copy(patch.values, field.values.data() + begin * components);
        std::fill_n(field.along.data() + begin, count, patch.along);
        std::fill_n(field.level.data() + begin, count, patch.level);
    }
}
}  // namespace subvol::detail
