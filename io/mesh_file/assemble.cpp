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
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "array_conversion.h"
#include "file_sets.h"
#include "mesh_arrays.h"
#include "sharp_groups.h"
#include "subvol/cell.h"
#include "subvol/detail/cell_splits.h"
#include "subvol/detail/facets.h"
#include "subvol/error.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

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

void split_all(ReadResult& result, MixedCells&& others, bool cut, MeshOrigin& origin) {
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
/// cell_numbers: as in MeshOrigin; cells: how many there are
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
void take_shells(MeshFile& found, ReadResult& result, const MeshOrigin& origin, bool moved) {
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

std::array<Vec3, 8> corners_of(const HexMesh& mesh, const std::array<Index, 8>& cell) {
    std::array<Vec3, 8> corners;
    for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[cell[k]];
    return corners;
}

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
    MeshOrigin origin{used_points(found), {}, {}};
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
