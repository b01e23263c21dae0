// SPDX-License-Identifier: Apache-2.0
// Arrays by which files of ours hold what VTK has no place for: field data with creases, sharp faces and patches as lists of
// points, arrays at cells and points that are 1 in a set and 0 elsewhere, and the time. Lists of points begin with a mark of
// the mesh (its counts and a hash of its cells), so that those of another mesh are not believed.
#include "mesh_arrays.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "subvol/cell.h"
#include "subvol/detail/byte_hash.h"

namespace subvol::detail {

namespace {

constexpr std::string_view kSharpArray = "SubvolSharp", kPatchArray = "patch:", kSetArray = "set:", kNodesArray = "nodes:";

constexpr std::size_t kMarkLength = 3;
using Mark = std::array<std::int64_t, kMarkLength>;

/// What a mesh is known by: the numbers of its points and cells, and a hash of the corners.
Mark mark_of(std::size_t points, std::span<const std::array<Index, 8>> cells) {
    ByteHash hash;
    for (const auto& cell : cells) hash.add({reinterpret_cast<const char*>(cell.data()), sizeof(cell)});
    return {static_cast<std::int64_t>(points), static_cast<std::int64_t>(cells.size()),
            std::bit_cast<std::int64_t>(hash.value())};
}

bool is_named(std::string_view name, std::string_view prefix) {
    return name.size() > prefix.size() && name.starts_with(prefix);
}

/// The four points of each face, ascending.
using FaceKey = std::array<Index, 4>;

/// The reason why an array is ignored; empty if there is none.
std::string fault_of(std::span<const std::int64_t> numbers, const Mark& mark, std::size_t head) {
    if (numbers.size() < head || !std::ranges::equal(numbers.first(kMarkLength), mark)) return "it is of another mesh";
    const auto exists = [&](std::int64_t p) { return p >= 0 && p < mark[0]; };
    return std::ranges::all_of(numbers.subspan(head), exists) ? "" : "it names a point that does not exist";
}

void take_sharp(const NamedNumbers& array, const Mark& mark, MeshFile& found) {
    constexpr std::size_t kHead = kMarkLength + 1;
    const std::span<const std::int64_t> numbers = array.numbers;
    const auto ignore = [&](const std::string& why) { found.ignore({"array of creases and sharp faces", array.name, 1, why}); };
    if (const std::string fault = fault_of(numbers, mark, kHead); !fault.empty()) {
        // Another mesh without creases: nothing is lost.
        return numbers.size() == kHead && numbers[kMarkLength] == 0 ? void() : ignore(fault);
    }
    const auto points = numbers.subspan(kHead);
    const std::int64_t creases = numbers[kMarkLength];
    if (creases < 0 || static_cast<std::size_t>(creases) > points.size() / 2 ||
        (points.size() - 2 * static_cast<std::size_t>(creases)) % 4 != 0) {
        return ignore("it has the wrong length");
    }
    found.sharp.settled = true;
    const auto point = [&](std::size_t k) { return static_cast<Index>(points[k]); };
    const std::size_t faces_at = 2 * static_cast<std::size_t>(creases);
    for (std::size_t k = 0; k < faces_at; k += 2) found.sharp.edges.push_back({point(k), point(k + 1)});
    for (std::size_t k = faces_at; k < points.size(); k += 4) {
        found.sharp.faces.push_back({point(k), point(k + 1), point(k + 2), point(k + 3)});
    }
}

FaceKey key_of(std::span<const Index> face) {
    FaceKey key{};
    std::ranges::copy(face, key.begin());
    std::ranges::sort(key);
    return key;
}

/// The faces of patches that are sides of hexahedra, ascending.
std::vector<FaceKey> faces_there(std::span<const FilePatch> patches, const MeshFile& found) {
    std::vector<std::uint8_t> on_patch(found.points.size(), 0);
    std::vector<FaceKey> keys;
    for (const FilePatch& patch : patches) {
        for (std::size_t f = 0; f < patch.size(); ++f) keys.push_back(key_of(patch.face(f)));
        for (const Index p : patch.corners) on_patch[p] = 1;
    }
    std::ranges::sort(keys);
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    std::vector<std::uint8_t> is_side(keys.size(), 0);
    for (const auto& cell : found.hexes.corners) {
        for (const auto& side : kCellFaces) {
            if (!std::ranges::all_of(side, [&](std::size_t k) { return on_patch[cell[k]] != 0; })) continue;
            FaceKey key{};
            for (std::size_t k = 0; k < 4; ++k) key[k] = cell[side[k]];
            std::ranges::sort(key);
            const auto at = std::ranges::lower_bound(keys, key);
            if (at != keys.end() && *at == key) is_side[static_cast<std::size_t>(at - keys.begin())] = 1;
        }
    }
    std::vector<FaceKey> sides;
    for (std::size_t k = 0; k < keys.size(); ++k) {
        if (is_side[k]) sides.push_back(keys[k]);
    }
    return sides;
}

void take_patches(std::span<const NamedNumbers> arrays, const Mark& mark, MeshFile& found) {
    LeftOut left_out;
    std::vector<FilePatch> patches;
    ByName<FilePatch> by_name(patches);
    for (const NamedNumbers& array : arrays) {
        if (!is_named(array.name, kPatchArray)) continue;
        const std::string name = array.name.substr(kPatchArray.size());
        const std::span<const std::int64_t> numbers = array.numbers;
        std::string fault = fault_of(numbers, mark, kMarkLength);
        if (fault.empty() && (numbers.size() - kMarkLength) % 4 != 0) fault = "it has the wrong length";
        if (!fault.empty()) {
            left_out.add(name, fault);
            continue;
        }
        FilePatch& patch = by_name[name];
        std::array<Index, 4> face{};
        for (std::size_t k = kMarkLength; k < numbers.size(); k += 4) {
            for (std::size_t i = 0; i < 4; ++i) face[i] = static_cast<Index>(numbers[k + i]);
            patch.add(face);
        }
    }
    const std::vector<FaceKey> sides = faces_there(patches, found);
    for (FilePatch& patch : patches) {
        bool there = true;
        for (std::size_t f = 0; f < patch.size() && there; ++f)
            there = std::ranges::binary_search(sides, key_of(patch.face(f)));
        if (there) {
            found.patches.push_back(std::move(patch));
        } else {
            left_out.add(patch.name, "four of its points are not those of a face of a cell");
        }
    }
    left_out.report("patch", "patches", found.warnings, found.ignored);
}

}  // namespace

bool is_field_array(std::string_view name) {
    return name == kSharpArray || is_named(name, kPatchArray);
}

std::vector<NamedNumbers> field_arrays(const HexMesh& mesh, const MeshSets& sets) {
    std::vector<NamedNumbers> arrays;
    if (mesh.creases.empty() && mesh.sharp_faces.empty() && sets.patches.empty()) return arrays;
    const Mark mark = mark_of(mesh.points.size(), mesh.cells);
    const auto begin = [&](std::string name) -> std::vector<std::int64_t>& {
        return arrays.emplace_back(NamedNumbers{std::move(name), {mark.begin(), mark.end()}}).numbers;
    };
    if (!mesh.creases.empty() || !mesh.sharp_faces.empty()) {
        std::vector<std::int64_t>& numbers = begin(std::string(kSharpArray));
        numbers.push_back(static_cast<std::int64_t>(mesh.creases.size()));
        for (const auto& crease : mesh.creases) numbers.insert(numbers.end(), crease.begin(), crease.end());
        for (const auto& face : mesh.sharp_faces) numbers.insert(numbers.end(), face.begin(), face.end());
    }
    for (const Patch& patch : sets.patches) {
        if (patch.sides.empty()) continue;
        std::vector<std::int64_t>& numbers = begin(std::string(kPatchArray) + patch.name);
        for (const CellSide& side : patch.sides) {
            for (const auto k : kCellFaces[side.side]) numbers.push_back(mesh.cells[side.cell][k]);
        }
    }
    return arrays;
}

std::vector<NamedNumbers> settled_arrays(const HexMesh& mesh, const MeshSets& sets) {
    std::vector<NamedNumbers> arrays = field_arrays(mesh, sets);
    if (!mesh.creases.empty() || !mesh.sharp_faces.empty()) return arrays;
    const Mark mark = mark_of(mesh.points.size(), mesh.cells);
    arrays.push_back({std::string(kSharpArray), {mark.begin(), mark.end()}});
    arrays.back().numbers.push_back(0);
    return arrays;
}

bool is_time_array(std::string_view name) {
    return name == "TimeValue" || name == "TIME";
}

IgnoredPart ignored_field_data(const std::string& name) {
    return {"array", name, 1, is_time_array(name) ? "it is not one finite time" : "it is at no points or cells"};
}

void take_time(std::string_view name, std::span<const double> values, MeshFile& found) {
    if (values.size() == 1 && std::isfinite(values[0])) {
        found.time = values[0];
    } else {
        found.ignored.push_back({"array", std::string(name), 1, "it is not one finite time"});
    }
}

void take_field_arrays(std::span<const NamedNumbers> arrays, MeshFile& found) {
    if (arrays.empty()) return;
    const Mark mark = mark_of(found.points.size(), found.hexes.corners);
    for (const NamedNumbers& array : arrays) {
        if (array.name == kSharpArray) take_sharp(array, mark, found);
    }
    take_patches(arrays, mark, found);
}

void ignore_field_arrays(std::span<const std::string> names, MeshFile& found) {
    LeftOut left_out;
    for (const std::string& name : names) left_out.add(name, "its numbers are not integers");
    left_out.report("array", "arrays", found.warnings, found.ignored);
}

bool is_set_array(std::string_view name, std::size_t components) {
    return components == 1 && is_named(name, kSetArray);
}

std::string set_array_name(const CellSet& set) {
    return std::string(kSetArray) + set.name;
}

void add_to_set(ByName<FileSet>& sets, std::string_view array, std::size_t first, std::span<const double> values) {
    FileSet& set = sets[std::string(array.substr(kSetArray.size()))];
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (values[k] != 0 && !std::isnan(values[k])) set.numbers.push_back(static_cast<Index>(first + k));
    }
}

bool is_node_set_array(std::string_view name, std::size_t components) {
    return components == 1 && is_named(name, kNodesArray);
}

std::string node_array_name(const NodeSet& set) {
    return std::string(kNodesArray) + set.name;
}

std::vector<std::uint8_t> flags_of(const HexMesh& mesh, const NodeSet& set, std::size_t points) {
    std::vector<std::uint8_t> flags(points, 0);
    for (const Index p : points_of(mesh, set)) flags[p] = 1;
    return flags;
}

void take_node_set_arrays(MeshFile& found) {
    const auto is_set = [](const FileArray& array) {
        return !array.at_cells && is_node_set_array(array.name, static_cast<std::size_t>(array.components));
    };
    ByName<FileSet> sets(found.node_sets);
    for (const FileArray& array : found.arrays) {
        if (!is_set(array)) continue;
        FileSet& set = sets[array.name.substr(kNodesArray.size())];
        for (Index p = 0; p < array.values.size(); ++p) {
            if (array.values[p] != 0 && !std::isnan(array.values[p])) set.numbers.push_back(p);
        }
    }
    std::erase_if(found.arrays, is_set);
}

void take_set_arrays(MeshFile& found) {
    take_node_set_arrays(found);
    const auto is_set = [](const FileArray& array) {
        return array.at_cells && is_set_array(array.name, static_cast<std::size_t>(array.components));
    };
    ByName<FileSet> sets(found.sets);
    for (const FileArray& array : found.arrays) {
        if (is_set(array)) add_to_set(sets, array.name, 0, array.values);
    }
    std::erase_if(found.arrays, is_set);
}

bool are_whole(std::span<const double> values) {
    constexpr double kMost = 0x1p53;
    return std::ranges::all_of(values, [](double value) { return std::abs(value) <= kMost && value == std::floor(value); });
}

}  // namespace subvol::detail
