// SPDX-License-Identifier: Apache-2.0
#include "subvol/vtk_grid.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "assemble.h"
#include "join_pieces.h"
#include "mesh_arrays.h"
#include "mesh_file.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "vtk_cells.h"

namespace subvol {

using namespace detail;

namespace {

constexpr std::string_view kGridName = "VTK grid";  // in the place of a file's name, in messages

[[noreturn]] void fail(const std::string& what, std::string allowed = {}) {
    throw Error(ErrorCode::InvalidInput, what, std::string(kGridName), std::move(allowed));
}

/// Refuses ends that fall or leave the list that they belong to.
void check_ends(const std::vector<std::int64_t>& ends, std::size_t cells, std::size_t list, const char* name) {
    if (ends.size() != cells)
        fail("there are " + std::to_string(ends.size()) + " " + name + " for " + std::to_string(cells) + " cells");
    if (!std::ranges::is_sorted(ends) || (cells > 0 && (ends.front() < 0 || ends.back() != static_cast<std::int64_t>(list))))
        fail(std::string("the ") + name + " do not divide the list of " + std::to_string(list) + " numbers",
             "never falling, up to its end");
}

void check_arrays(const VtkUnstructuredGrid& grid) {
    for (const VtkGridArray& array : grid.arrays) {
        const std::size_t tuples = array.at_cells ? grid.types.size() : grid.points.size();
        if (array.components < 1 || array.values.size() != tuples * static_cast<std::size_t>(array.components))
            fail("array '" + printable(array.name) + "' has " + std::to_string(array.values.size()) + " values",
                 std::to_string(std::max(array.components, 1)) + " for each of the " + std::to_string(tuples) +
                     (array.at_cells ? " cells" : " points"));
    }
}

void take_cells(const VtkUnstructuredGrid& grid, VtkCellSorter& sorter) {
    const auto points = static_cast<std::int64_t>(grid.points.size());
    VtkFaces faces;
    faces.stream = grid.faces;
    faces.ends = grid.face_ends;
    std::vector<Index> corners;
    std::int64_t begin = 0;
    for (std::size_t c = 0; c < grid.types.size(); begin = grid.ends[c++]) {
        if (grid.types[c] == kVtkPolyhedron) {
            auto of_cell = grid.face_ends.empty() ? std::nullopt : faces.of_cell(c, 0, grid.points.size());
            if (!of_cell) fail(kVtkNames.cell(c) + ": its faces are not those of a polyhedron");
            sorter.take_polyhedron(std::move(*of_cell));
            continue;
        }
        corners.clear();
        for (std::int64_t k = begin; k < grid.ends[c]; ++k) {
            const std::int64_t corner = grid.connectivity[static_cast<std::size_t>(k)];
            if (corner < 0 || corner >= points) {
                fail(kVtkNames.cell(c) + ": there is no point with index " + std::to_string(corner),
                     "there are " + std::to_string(points) + " points, counted from 0");
            }
            corners.push_back(static_cast<Index>(corner));
        }
        sorter.take(grid.types[c], corners, 0);
    }
}

/// What a file with this grid has.
///
/// alone: false: a part of a mesh, which may have no cells
MeshFile contents_of(VtkUnstructuredGrid grid, bool alone, const TextScanner& nowhere, const ReadOptions& options) {
    if (grid.points.size() >= kNone || grid.types.size() >= kNone) fail("too many points or cells");
    check_ends(grid.ends, grid.types.size(), grid.connectivity.size(), "ends of cells");
    if (!grid.face_ends.empty()) check_ends(grid.face_ends, grid.types.size(), grid.faces.size(), "ends of faces");
    check_arrays(grid);
    MeshFile found;
    for (const Vec3& point : grid.points) add_point(found, point, 0);
    VtkCellSorter sorter(nowhere, found, options);
    take_cells(grid, sorter);
    for (VtkGridArray& array : grid.arrays) {
        found.arrays.push_back({std::move(array.name), array.components, array.at_cells, std::move(array.values)});
        found.arrays.back().integers = array.integers;
    }
    take_set_arrays(found);
    if (alone) {
        std::vector<NamedNumbers> arrays;
        for (VtkFieldArray& array : grid.field_arrays) {
            if (is_field_array(array.name)) arrays.push_back({std::move(array.name), std::move(array.numbers)});
        }
        take_field_arrays(arrays, found);
    }
    sorter.report(alone ? std::optional(kGridName) : std::nullopt);
    return found;
}

TextScanner no_text() {
    TextScanner nowhere({}, kGridName, TextScanner::Comments::None);
    nowhere.name_no_place();
    return nowhere;
}

}  // namespace

bool is_vtk_field_array(std::string_view name) {
    return is_field_array(name);
}

std::vector<VtkFieldArray> vtk_field_arrays(const HexMesh& mesh, const MeshSets& sets) {
    std::vector<VtkFieldArray> arrays;
    for (NamedNumbers& array : field_arrays(mesh, sets)) arrays.push_back({std::move(array.name), std::move(array.numbers)});
    return arrays;
}

std::string vtk_node_array(const NodeSet& set) {
    return detail::node_array_name(set);
}

std::string vtk_set_array(const CellSet& set) {
    return set_array_name(set);
}

ReadResult mesh_of_vtk(VtkUnstructuredGrid grid, const ReadOptions& options) {
    const TextScanner nowhere = no_text();
    return assemble(contents_of(std::move(grid), true, nowhere, options), nowhere, kGridName, kVtkNames, options);
}

ReadResult mesh_of_vtk(std::vector<VtkUnstructuredGrid> blocks, const ReadOptions& options) {
    const TextScanner nowhere = no_text();
    std::vector<MeshFile> parts;
    for (VtkUnstructuredGrid& block : blocks) {
        if (block.points.empty()) continue;
        MeshFile part = contents_of(std::move(block), false, nowhere, options);
        refuse_not_finite(part, nowhere, kVtkNames);
        parts.push_back(std::move(part));
    }
    if (parts.empty()) fail("no block has points");
    MeshFile found = join_pieces(std::move(parts), "block", kGridName);
    std::size_t cells = 0;
    each_kind(found, [&](const auto& kind) { cells += kind.corners.size(); });
    if (cells == 0) fail("no block has cells with a volume");
    return assemble(std::move(found), kGridName, kVtkNames, options);
}

}  // namespace subvol
