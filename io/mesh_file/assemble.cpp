// SPDX-License-Identifier: Apache-2.0
// From what a reader has found in a file to the mesh of hexahedra that everything else works on, in this order:
//
//     points     ghosts are dropped, coordinates are checked, points at one place are joined if asked for
//     cells      curved cells are split into grids of straight ones, collapsed cells are taken as what they are
//     turned     left-handed hexahedra are turned round
//     sharp      edges that bend and faces between parts, of the cells as the file has them, unless options or groups say them
//     split      tetrahedra, prisms and pyramids become hexahedra, and all hexahedra with them so that they fit together
//     sets       sets of cells, patches, and values on their faces, with the numbers of the new cells
//     fields     at points as they are, or means over the points that a new one lies between; at cells kept for a fit,
//                constant in each cell if they are labels, else means over the cells at a point by volume
//     shells     quads and lines beside hexahedra that were not split
//
// A field with a value that is not finite, at a cell or its points, is left out; it is an error if no other field is left.
#include "assemble.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "file_sets.h"
#include "mesh_arrays.h"
#include "sharp_groups.h"
#include "subvol/cell.h"
#include "subvol/detail/cell_splits.h"
#include "subvol/detail/facets.h"
#include "subvol/detail/small_letters.h"
#include "subvol/error.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

std::array<Vec3, 8> corners_of(const HexMesh& mesh, const std::array<Index, 8>& cell) {
    std::array<Vec3, 8> corners;
    for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[cell[k]];
    return corners;
}

void turn_hexes(ReadResult& result) {
    const std::size_t count = result.mesh.cells.size();
    const std::size_t turned = orient_cells(result.mesh);
    if (turned == 0) return;
    result.warnings.push_back(cells_turned(turned, count));
}

void warn_of_folded(ReadResult& result) {
    const auto& cells = result.mesh.cells;
    const auto folded =
        std::count_if(cells.begin(), cells.end(), [&](const auto& cell) { return is_folded(corners_of(result.mesh, cell)); });
    if (folded == 0) return;
    result.warnings.push_back(cells_folded(static_cast<std::size_t>(folded), cells.size()));
}

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

// How the mesh's points and cells relate to the file's.
//
// used:         a flag for each point of the file
// cell_numbers: the number in the file of each cell of the mesh; empty if it is the same
// shell_numbers: those of the shells and beams that are read beside cells
// sources:      the points of the file whose mean each point of the mesh is; nothing if they are the same
struct Origin {
    std::vector<std::uint8_t> used;
    std::vector<Index> cell_numbers;
    std::optional<IndexRows> sources;
    std::vector<Index> shell_numbers{};
};

/// The array with the range of its values at what is read: not at points that no cell uses, or elements that are left out.
FieldInfo describe(const FileArray& array, const Origin& origin) {
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

class ArrayConversion {
public:
    ArrayConversion(ReadResult& result, const Origin& origin, const EntityNames& names, CellValues cell_values)
        : result_(result), origin_(origin), names_(names), cell_values_(cell_values) {}

    /// Returns whether the mesh has got the array as its next attribute.
    bool take(FileArray&& array) {
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

    /// After the last array: one warning for all fields that are left out, one for those that have gaps, one for all arrays of
    /// cells, and one for each name that several arrays have. unread: by the reader
    void finish(std::vector<UnreadField>&& unread) {
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
            result_.warnings.push_back(
                (labels_.size() == 1 ? "cell array " + listed(labels_) + " has"
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

private:
    /// The first few of some names.
    [[nodiscard]] static std::string listed(const std::vector<std::string>& all) {
        constexpr std::size_t kMostNamed = 6;
        std::string names;
        for (std::size_t i = 0; i < std::min(all.size(), kMostNamed); ++i) names += (i > 0 ? ", " : "") + all[i];
        if (all.size() > kMostNamed) names += " and " + std::to_string(all.size() - kMostNamed) + " more";
        return names;
    }

    /// Whether an array numbers materials, blocks or cells: no mean of such numbers means anything. Some formats have nothing
    /// but reals; there the name has to say so, too.
    [[nodiscard]] static bool is_label(const FileArray& array, const std::vector<double>& of_hexes) {
        const auto differs = [&](double value) { return value != of_hexes.front(); };
        return array.components == 1 && (array.integers || names_label(array.name)) && are_whole(of_hexes) &&
               std::ranges::any_of(of_hexes, differs);
    }

    /// The same at points, where many integers are measured, as grey values are: the name has to say so. What numbers the
    /// points themselves, as "GlobalNodeId", is no label of cells.
    [[nodiscard]] static bool is_label_at_points(const FileArray& array) {
        constexpr std::array<std::string_view, 5> kOfPoints{"node", "point", "vert", "pedigree", "global"};
        const std::string name = small_letters(array.name);
        const auto differs = [&](double value) { return value != array.values.front(); };
        const auto is_in_name = [&](std::string_view word) { return name.find(word) != std::string::npos; };
        return array.components == 1 && names_label(array.name) && name != "id" && name != "ids" &&
               std::ranges::none_of(kOfPoints, is_in_name) && are_whole(array.values) &&
               std::ranges::any_of(array.values, differs);
    }

    [[nodiscard]] static bool names_label(const std::string& given) {
        constexpr std::array<std::string_view, 8> kNumbered{"material", "block", "region", "zone",
                                                            "domain",   "group", "part_",  "label"};
        const std::string name = small_letters(given);
        return std::ranges::any_of(kNumbered, [&](std::string_view word) { return name.starts_with(word); }) || name == "mat" ||
               name == "part" || name == "id" || name.ends_with("_id") || name.ends_with("ids") || given.ends_with("Id") ||
               given.ends_with("ID");
    }

    /// Gives each cell the label that most of its points have, of as many the least. Points that splitting has made have none
    /// of their own, and in `values` that of the first point that they lie between.
    void take_labels(const FileArray& array, Attribute& attribute) {
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

    /// Keeps a field with gaps, unless it has no value at all.
    bool take_incomplete(const FileArray& array) {
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

    [[nodiscard]] static bool has_all(const std::vector<double>& values, std::size_t tuple, std::size_t components) {
        return std::ranges::none_of(std::span(values).subspan(tuple * components, components),
                                    [](double value) { return std::isnan(value); });
    }

    /// Makes values at points of those at cells.
    void take_cells(const FileArray& array, Attribute& attribute) {
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

    // The first point that a cell uses, or the first cell, with a value that is not finite; empty if there is none.
    [[nodiscard]] std::string gap_at_points(const FileArray& array) const {
        const auto components = static_cast<std::size_t>(array.components);
        for (std::size_t i = 0; i < array.values.size(); ++i) {
            const std::size_t p = i / components;
            if (!std::isfinite(array.values[i]) && origin_.used[p]) return names_.point(p);
        }
        return {};
    }

    [[nodiscard]] std::string gap_at_cells(const FileArray& array) const {
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

    std::vector<double> from_points(FileArray&& array) const {
        const auto components = static_cast<std::size_t>(array.components);
        return origin_.sources ? means(*origin_.sources, array.values, components) : std::move(array.values);
    }

    std::vector<double> of_cells(const FileArray& array) const {
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

    void take_on_patches(const std::string& name, const FileArray& array) {
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

    ReadResult& result_;
    const Origin& origin_;
    const EntityNames& names_;
    CellValues cell_values_;
    NamesApart distinct_{"array"};
    std::vector<std::string> averaged_, labels_, point_labels_, incomplete_, unfitted_;
    std::string gaps_;  // of the first of these
    std::vector<UnreadField> unread_;
};

/// The faces of all patches, if an array has values there.
void take_faces(const MeshFile& found, std::vector<ValuesOnPatches::Side>&& sides, ValuesOnPatches& faces) {
    if (std::ranges::all_of(found.arrays, [](const FileArray& array) { return array.on_patches.empty(); })) return;
    faces.sides = std::move(sides);
    for (std::size_t k = 0; k < found.patches.size(); ++k) {
        faces.patches.insert(faces.patches.end(), found.patches[k].size(), static_cast<Index>(k));
        faces.roles.insert(faces.roles.end(), found.patches[k].size(), found.patches[k].role);
    }
}

MixedCells take_others(MeshFile& found) {
    return {std::move(found.tets.corners), std::move(found.prisms.corners), std::move(found.pyramids.corners)};
}

std::vector<Index> take_numbers(MeshFile& found) {
    std::vector<Index> numbers = std::move(found.hexes.numbers);
    for (const auto* more : {&found.tets.numbers, &found.prisms.numbers, &found.pyramids.numbers}) {
        numbers.insert(numbers.end(), more->begin(), more->end());
    }
    return numbers;
}

std::string list_of(const CellCounts& counts) {
    std::string list;
    const auto add = [&](std::size_t count, std::string_view one, std::string_view many) {
        if (count > 0) list += (list.empty() ? "" : ", ") + counted(count, one, many);
    };
    add(counts.hexes, "hexahedron", "hexahedra");
    add(counts.tets, "tetrahedron", "tetrahedra");
    add(counts.prisms, "prism", "prisms");
    add(counts.pyramids, "pyramid", "pyramids");
    const std::size_t last = list.rfind(", ");
    return last == std::string::npos ? list : list.replace(last, 2, " and ");
}

CellCounts counts_of(std::size_t hexes, const MixedCells& others) {
    return {hexes, others.tets.size(), others.prisms.size(), others.pyramids.size()};
}

void split_all(ReadResult& result, MixedCells&& others, bool cut, Origin& origin) {
    HexMesh& mesh = result.mesh;
    const CellCounts counts = counts_of(mesh.cells.size(), others);
    HexSplit split = plan_split(mesh.points, std::move(mesh.cells), std::move(others), cut);
    mesh.points = means(split.sources, mesh.points);
    mesh.cells = std::move(split.cells);
    if (!origin.cell_numbers.empty()) {
        std::vector<Index> numbers;
        numbers.reserve(mesh.cells.size());
        for (const Index parent : split.parents) numbers.push_back(origin.cell_numbers[parent]);
        origin.cell_numbers = std::move(numbers);
    }
    origin.sources = std::move(split.sources);
    result.warnings.push_back(split_report(counts, split.tets_cut, mesh.cells.size()));
}

/// A number for each cell: the place of its block or set among them, from 1, 0 for a cell in none. Empty if a cell is in two of
/// them, since such sets are no parts of a body, or if there is one part alone.
///
/// cell_numbers: as in Origin; cells: how many there are
std::vector<Index> parts_of_cells(const MeshFile& found, const std::vector<Index>& cell_numbers, std::size_t cells) {
    std::unordered_map<Index, Index> part_of_number;
    Index part = 0;
    for (const FileSet& set : found.sets) {
        const bool is_block = std::ranges::find(found.blocks, set.name, &MeshBlock::name) != found.blocks.end();
        if (!found.blocks.empty() && !is_block) continue;
        ++part;
        for (const Index number : set.numbers) {
            const auto [at, added] = part_of_number.try_emplace(number, part);
            if (!added && at->second != part) return {};
        }
    }
    std::vector<Index> parts(part == 0 ? 0 : cells, 0);
    for (std::size_t c = 0; c < parts.size(); ++c) {
        const auto at = part_of_number.find(cell_numbers.empty() ? static_cast<Index>(c) : cell_numbers[c]);
        if (at != part_of_number.end()) parts[c] = at->second;
    }
    if (std::ranges::all_of(parts, [&](Index number) { return number == parts.front(); })) parts.clear();
    return parts;
}

/// The halves of edges in a mesh whose cells were split. edges: ascending
std::vector<std::array<Index, 2>> halves_of(const std::vector<std::array<Index, 2>>& edges, const IndexRows& sources) {
    std::unordered_map<Index, Index> corners;
    for (const auto& edge : edges) {
        for (const Index p : edge) corners.emplace(p, kNone);
    }
    std::vector<std::array<Index, 2>> halves;
    for (Index p = 0; p < sources.size(); ++p) {  // corners come before the middles of edges
        const auto row = sources[p];
        if (row.size() == 1) {
            if (const auto corner = corners.find(row[0]); corner != corners.end()) corner->second = p;
        } else if (row.size() == 2 && std::ranges::binary_search(edges, std::array{row[0], row[1]})) {
            for (const Index end : row) halves.push_back({corners[end], p});
        }
    }
    return halves;
}

/// Leaves out the quads or lines that repeat a point, or have one whose place or values are not finite.
template <std::size_t N>
std::size_t drop_unusable(FileCells<N>& cells, const HexMesh& mesh) {
    const auto usable = [&](const std::array<Index, N>& corners) {
        for (std::size_t k = 0; k < N; ++k) {
            const Vec3& point = mesh.points[corners[k]];
            if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) return false;
            if (std::count(corners.begin(), corners.end(), corners[k]) > 1) return false;
            for (const Attribute& attribute : mesh.attributes) {
                const auto channels = static_cast<std::size_t>(attribute.channels);
                for (std::size_t c = 0; c < channels; ++c) {
                    if (!std::isfinite(attribute.values[corners[k] * channels + c])) return false;
                }
            }
        }
        return true;
    };
    return drop_where(cells, [&](std::size_t c) { return !usable(cells.corners[c]); });
}

/// Values of an array of cells at the points of shells that no cell uses: the mean over the quads and lines there.
void set_means(HexMesh& mesh, std::size_t attribute, const FileArray& array, const MeshFile& found,
               std::span<const std::uint8_t> used) {
    const auto components = static_cast<std::size_t>(array.components);
    std::vector<double>& values = mesh.attributes[attribute].values;
    std::vector<std::size_t> counts(mesh.points.size() * components, 0);
    const auto add = [&](const auto& cells) {
        for (std::size_t i = 0; i < cells.corners.size(); ++i) {
            for (std::size_t k = 0; k < components; ++k) {
                const double value = array.values[cells.numbers[i] * components + k];
                for (const Index p : cells.corners[i]) {
                    if (used[p] || !std::isfinite(value)) continue;
                    values[p * components + k] += value;
                    ++counts[p * components + k];
                }
            }
        }
    };
    add(found.quads);
    add(found.lines);
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] > 1) values[i] /= static_cast<double>(counts[i]);
    }
}

std::string list_of_shells(std::size_t quads, std::size_t lines) {
    const std::string of_quads = quads > 0 ? counted(quads, "quad", "quads") : "";
    const std::string of_lines = lines > 0 ? counted(lines, "line", "lines") : "";
    return of_quads + (of_quads.empty() || of_lines.empty() ? "" : " and ") + of_lines;
}

/// Notes the quads and lines that are not taken. into: a MeshFile or ReadResult
template <class Contents>
void ignore_shells(std::size_t quads, std::size_t lines, const std::string& reason, Contents& into) {
    if (quads + lines == 0) return;
    into.warnings.push_back(list_of_shells(quads, lines) + " ignored: " + reason);
    if (quads > 0) into.ignored.push_back({"shells", "quads", quads, reason});
    if (lines > 0) into.ignored.push_back({"shells", "lines", lines, reason});
}

/// After the mesh is complete. moved: whether its points are not those of the file
void take_shells(MeshFile& found, ReadResult& result, const Origin& origin, bool moved) {
    std::size_t quads = found.quads.corners.size(), lines = found.lines.corners.size();
    if (quads + lines == 0) return;
    if (moved || origin.sources || !result.cell_means.empty())
        return ignore_shells(quads, lines, "shells and beams are read beside hexahedra that are not split", result);
    HexMesh with = result.mesh;
    quads = drop_unusable(found.quads, with);
    lines = drop_unusable(found.lines, with);
    ignore_shells(quads, lines, "they repeat a point, or its values are not finite", result);
    for (std::size_t a = 0; a < found.arrays.size(); ++a) {
        if (found.arrays[a].at_cells) set_means(with, a, found.arrays[a], found, origin.used);
    }
    result.shells = make_shells(with, found.quads.corners, found.lines.corners);
}

}  // namespace

bool is_folded(const std::array<Vec3, 8>& x) {
    for (std::size_t k = 0; k < 8; ++k) {
        const auto edge = [&](std::size_t e) { return x[kCornerNeighbors[k][e]] - x[k]; };
        if (glm::dot(edge(0), glm::cross(edge(1), edge(2))) < 0) return true;
    }
    return false;
}

std::string cells_turned(std::size_t turned, std::size_t cells) {
    return std::to_string(turned) + " of " + counted(cells, "hexahedron", "hexahedra") + (turned == 1 ? " was" : " were") +
           " left-handed (negative Jacobian) and turned round";
}

std::string split_report(const CellCounts& counts, std::size_t tets_cut, std::size_t children) {
    return list_of(counts) + (tets_cut > 0 ? " cut into " + counted(tets_cut, "tetrahedron", "tetrahedra") + " and" : "") +
           " split into " + counted(children, "hexahedron", "hexahedra") +
           (counts.hexes > 0 ? ", the hexahedra too so that all fit together" : "");
}

std::string cells_folded(std::size_t folded, std::size_t cells) {
    return std::to_string(folded) + " of " + counted(cells, "hexahedron", "hexahedra") + (folded == 1 ? " has" : " have") +
           " a negative Jacobian at a corner";
}

void refuse_not_finite(const MeshFile& found, const TextScanner& in, const EntityNames& names) {
    if (found.not_finite.empty()) return;
    const auto used = used_points(found);
    for (const auto& [point, position] : found.not_finite) {
        if (used[point]) in.fail_at(position, "non-finite coordinate at " + names.point(point));
    }
}

ReadResult assemble(MeshFile&& found, const TextScanner& in, std::string_view file, const EntityNames& names,
                    const ReadOptions& options) {
    drop_ghosts(found);
    refuse_not_finite(found, in, names);
    return assemble(std::move(found), file, names, options);
}

ReadResult assemble(MeshFile&& found, std::string_view file, const EntityNames& names_in_file, const ReadOptions& options) {
    drop_ghosts(found);
    if (!options.weld) {
        say_points_of_their_own(found);
        say_hanging_points(found);
    } else {
        weld_points(found, *options.weld, file, names_in_file);
        if (options.other_cells == OtherCells::Split && found.curved.size() == 0) join_hanging_points(found);
        const auto [quads, lines] = drop_parts_of_cells(found, options.shells_alone);
        ignore_shells(quads, lines, "parts of cells", found);
    }
    EntityNames names = names_in_file;
    std::optional<CurvedReport> curved;
    if (options.curved_tolerance) curved = split_curved(found, *options.curved_tolerance, file, names);
    const bool moved = curved && curved->split();
    if (moved) names.point_numbers = {};
    found.curved = {};
    const bool turned = found.turned;
    const bool cut = take_collapsed(found, options.other_cells, file, names) || found.cut;
    Origin origin{used_points(found), {}, {}};
    ReadResult result;
    result.mesh.points = std::move(found.points);
    result.mesh.cells = std::move(found.hexes.corners);
    result.warnings = std::move(found.warnings);
    result.ignored = std::move(found.ignored);
    result.mesh.time = found.time;
    result.blocks = std::move(found.blocks);
    result.curved = curved;
    MixedCells others = take_others(found);
    if (!others.empty() && options.other_cells == OtherCells::Refuse) {
        throw Error(ErrorCode::InvalidInput, "the mesh has " + list_of(counts_of(result.mesh.cells.size(), others)),
                    std::string(file), "only hexahedra are allowed");
    }
    origin.cell_numbers = take_numbers(found);
    if (!turned) turn_hexes(result);
    FoundSharpEdges sharp;
    const bool finds_sharp = !options.crease_angle_deg && found.sharp.empty() && !found.sharp.settled;
    // Of the cells as the file has them: where they are split, all quads of a triangle lie in its plane.
    if (finds_sharp) {
        const std::size_t cells = result.mesh.cells.size() + others.tets.size() + others.prisms.size() + others.pyramids.size();
        sharp =
            find_sharp_edges(result.mesh.points, result.mesh.cells, others, parts_of_cells(found, origin.cell_numbers, cells),
                             cut || !others.pyramids.empty() ? SingleCells::Tag : SingleCells::Leave);
        found.sharp = {std::move(sharp.faces_between), std::move(sharp.edges_between)};
    }
    const std::size_t edges_between = finds_sharp ? found.sharp.edges.size() : 0;
    try {
        if (!others.empty()) split_all(result, std::move(others), cut, origin);
        warn_of_folded(result);
        FileSetsOfMesh sets =
            sets_of_mesh(result.mesh, found, origin.cell_numbers, origin.sources ? &*origin.sources : nullptr, result);
        result.sets = std::move(sets.sets);
        take_faces(found, std::move(sets.sides), result.on_patches);
        if (!moved && !origin.sources) {
            origin.shell_numbers = found.quads.numbers;
            origin.shell_numbers.insert(origin.shell_numbers.end(), found.lines.numbers.begin(), found.lines.numbers.end());
        }
        ArrayConversion conversion(result, origin, names, options.cell_values);
        std::erase_if(found.arrays, [&](FileArray& array) { return !conversion.take(std::move(array)); });
        conversion.finish(std::move(found.unread));
        if (!result.cell_means.empty() || !result.on_patches.fields.empty()) result.cell_parts = std::move(origin.cell_numbers);
        take_shells(found, result, origin, moved);
        const bool alone = options.shells_alone && result.mesh.cells.empty() && !result.shells.empty();
        if (!alone) validate(result.mesh);
        if (!found.sharp.empty()) {
            add_sharp_tags(result.mesh, std::move(found.sharp), origin.sources ? &*origin.sources : nullptr, file, names);
        }
        if (finds_sharp) {
            result.sharp_edges = {sharp.edges.size() + edges_between, sharp.steps};
            if (origin.sources) sharp.edges = halves_of(sharp.edges, *origin.sources);
            result.mesh.creases.insert(result.mesh.creases.end(), sharp.edges.begin(), sharp.edges.end());
        } else if (options.crease_angle_deg.value_or(0) > 0) {
            const std::size_t before = result.mesh.creases.size();
            tag_creases(result.mesh, *options.crease_angle_deg);
            result.sharp_edges = {result.mesh.creases.size() - before, false};
        }
    } catch (const Error& error) {
        const bool names_file = std::string_view(error.what()).starts_with(file);
        if (names_file) throw;
        throw Error(error.code(), error.what(), std::string(file));
    }
    return result;
}

}  // namespace subvol::detail
