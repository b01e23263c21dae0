// SPDX-License-Identifier: Apache-2.0
#include "overlapping_sets.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>

#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

/// Figures that are not known, since no cell lies in the region, are not a number.
void take_least(const LimitExtreme& from, LimitExtreme& to) {
    if (!(from.value >= to.value)) to = std::isnan(from.value) ? to : from;
}

void take_largest(const LimitExtreme& from, LimitExtreme& to) {
    if (!(from.value <= to.value)) to = std::isnan(from.value) ? to : from;
}

/// Adds a class that has a volume. Means are made of the integrals when all classes are there.
void add(const PartMeasure& from, bool first, PartMeasure& to) {
    if (first) {
        const std::string name = to.name;
        to = from;
        to.name = name;
        to.error *= std::abs(from.volume);
        for (FieldMeasure& field : to.fields) {
            if (std::isnan(field.given.integral)) field.given.integral = 0;
        }
        return;
    }
    to.cells += from.cells;
    to.volume += from.volume;
    to.given_volume += from.given_volume;
    to.error += from.error * std::abs(from.volume);
    for (std::size_t f = 0; f < to.fields.size(); ++f) {
        const FieldMeasure& more = from.fields[f];
        FieldMeasure& field = to.fields[f];
        field.integral += more.integral;
        take_least(more.min, field.min);
        take_largest(more.max, field.max);
        field.extreme_error = std::max(field.extreme_error, more.extreme_error);
        for (std::size_t b = 0; b < std::min(field.histogram.size(), more.histogram.size()); ++b)
            field.histogram[b] += more.histogram[b];
        if (!std::isnan(more.given.integral)) field.given.integral += more.given.integral;
        take_least(more.given.min, field.given.min);
        take_largest(more.given.max, field.given.max);
    }
}

}  // namespace

CellClasses classes_of(std::span<const CellSet> sets, std::size_t cells) {
    CellClasses classes;
    classes.groups.assign(cells, 0);
    Index next = 1;
    std::unordered_map<Index, Index> inside;  // of a class, its cells that the set has
    for (const CellSet& set : sets) {
        inside.clear();
        for (const Index cell : set.cells) {
            if (cell >= cells)
                throw Error(ErrorCode::InvalidInput, "set \"" + set.name + "\" has cell " + std::to_string(cell), "measure",
                            "less than " + std::to_string(cells));
            Index& group = classes.groups[cell];
            const auto [at, is_new] = inside.try_emplace(group, next);
            if (is_new) ++next;
            group = at->second;
        }
    }
    // Classes that later sets have taken all cells of are left out.
    std::unordered_map<Index, Index> numbers;
    for (Index& group : classes.groups) group = numbers.try_emplace(group, static_cast<Index>(numbers.size())).first->second;
    for (const CellSet& set : sets) {
        std::vector<Index>& of_set = classes.of_sets.emplace_back();
        for (const Index cell : set.cells) of_set.push_back(classes.groups[cell]);
        std::ranges::sort(of_set);
        of_set.erase(std::unique(of_set.begin(), of_set.end()), of_set.end());
    }
    return classes;
}

std::vector<PartMeasure> figures_of_sets(std::span<const CellSet> sets, const CellClasses& classes,
                                         std::span<const PartMeasure> found) {
    std::vector<PartMeasure> figures;
    for (std::size_t s = 0; s < sets.size(); ++s) {
        PartMeasure& part = figures.emplace_back();
        part.name = sets[s].name;
        bool first = true;
        for (const Index k : classes.of_sets[s]) {
            if (found[k].volume == 0) continue;  // it lies outside the region
            add(found[k], first, part);
            first = false;
        }
        if (first && !found.empty()) {
            for (const FieldMeasure& field : found.front().fields) {
                FieldMeasure& none = part.fields.emplace_back();
                none.name = field.name;
                none.histogram.assign(field.histogram.size(), 0);
            }
            continue;
        }
        if (part.volume != 0) part.error /= std::abs(part.volume);
        for (FieldMeasure& field : part.fields) {
            if (part.volume != 0) field.mean = field.integral / part.volume;
            if (part.given_volume != 0) field.given.mean = field.given.integral / part.given_volume;
        }
    }
    return figures;
}

LimitMeasure measured_in_cells(
    const MeshSource& source, const MeasureOptions& options,
    const std::function<LimitMeasure(const MeshSource& source, const MeasureOptions& options)>& measured) {
    if (options.cells.empty()) return measured(source, options);
    const HexMesh& whole = *source.mesh();
    if (options.cells.size() != whole.cells.size() || !options.groups.empty()) {
        throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(options.cells.size()) + " flags of cells", "measure",
                    "one for each of the cells, and no groups");
    }
    validate(whole);
    std::vector<std::uint8_t> kept(options.cells.begin(), options.cells.end());
    grow(whole, kept, kHaloOfLimit);
    const MeshSubset near = subset(whole, kept);
    std::vector<std::uint8_t> chosen;
    for (const Index cell : near.cells) chosen.push_back(options.cells[cell]);
    MeshSets sets = sets_of_cells({{}, {options.sets.begin(), options.sets.end()}}, kept);
    for (CellSet& set : sets.sets) std::erase_if(set.cells, [&](Index cell) { return chosen[cell] == 0; });
    MeasureOptions of_near = options;
    of_near.cells = chosen;
    of_near.sets = sets.sets;
    LimitMeasure found = measured(near.mesh, of_near);
    const auto rename = [&](LimitExtreme& extreme) {
        if (extreme.cell != kNone) extreme.cell = near.cells[extreme.cell];
    };
    const auto rename_all = [&](PartMeasure& part) {
        for (FieldMeasure& field : part.fields) {
            for (LimitExtreme* extreme : {&field.min, &field.max, &field.given.min, &field.given.max}) rename(*extreme);
        }
    };
    if (found.folds.cells > 0) found.folds.first = near.cells[found.folds.first];
    rename_all(found.whole);
    std::ranges::for_each(found.parts, rename_all);
    return found;
}

std::shared_ptr<const LimitPieces> pieces_of(const LimitPieces& all, std::span<const std::uint8_t> cells) {
    auto result = std::make_shared<LimitPieces>(all);
    LimitPieces& pieces = *result;
    std::size_t kept = 0;
    const std::size_t row = pieces.cells.empty() ? 0 : pieces.nodes.size() / pieces.cells.size();
    const auto each_array = [&](const auto& call) {
        call(pieces.cells);
        call(pieces.levels);
        call(pieces.lowest);
        call(pieces.hull_sides);
        call(pieces.origins);
    };
    for (std::size_t p = 0; p < pieces.cells.size(); ++p) {
        if (cells[pieces.cells[p]] == 0) continue;
        std::copy_n(&pieces.nodes[p * row], row, &pieces.nodes[kept * row]);
        each_array([&](auto& array) {
            if (!array.empty()) array[kept] = array[p];
        });
        ++kept;
    }
    each_array([&](auto& array) {
        if (!array.empty()) array.resize(kept);
    });
    pieces.nodes.resize(kept * row);
    return result;
}

LimitMeasure measured_by_sets(const MeasureOptions& options, std::size_t cells,
                              const std::function<LimitMeasure(const MeasureOptions& options)>& measured) {
    if (!options.groups.empty())
        throw Error(ErrorCode::InvalidInput, "there are groups and sets of cells", "measure", "one of them");
    const CellClasses classes = classes_of(options.sets, cells);
    MeasureOptions by_class = options;
    by_class.sets = {};
    by_class.groups = classes.groups;
    by_class.names.assign(classes.groups.empty() ? 0 : std::size_t{std::ranges::max(classes.groups)} + 1, "");
    LimitMeasure found = measured(by_class);
    found.parts = figures_of_sets(options.sets, classes, found.parts);
    return found;
}

}  // namespace subvol::detail
