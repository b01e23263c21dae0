#include "vtk_cells.h"

#include <algorithm>

namespace subvol {

namespace {

enum CellType : std::int64_t { kTetrahedron = 10, kVoxel = 11, kHexahedron = 12, kWedge = 13, kPyramid = 14 };

const std::map<std::int64_t, std::array<std::string_view, 2>> kCellNames{
    {1, {"vertex", "vertices"}},
    {2, {"vertex cell", "vertex cells"}},
    {3, {"line", "lines"}},
    {4, {"polyline", "polylines"}},
    {5, {"triangle", "triangles"}},
    {7, {"polygon", "polygons"}},
    {8, {"pixel", "pixels"}},
    {9, {"quad", "quads"}},
    {10, {"tetrahedron", "tetrahedra"}},
    {13, {"wedge", "wedges"}},
    {14, {"pyramid", "pyramids"}},
    {24, {"quadratic tetrahedron", "quadratic tetrahedra"}},
    {25, {"quadratic hexahedron", "quadratic hexahedra"}},
    {42, {"polyhedron", "polyhedra"}}};

// Points in the middle of edges, of faces and of the cell come behind the corners.
constexpr std::array<std::size_t, 2> kCurvedHexes{20, 27};

}  // namespace

void VtkCellSorter::take(const VtkCells& cells) {
    for (std::size_t c = 0; c < cells.size(); ++c) take_cell(cells, c);
    taken_ += cells.size();
}

void VtkCellSorter::take_cell(const VtkCells& cells, std::size_t cell) {
    const std::int64_t type = cells.types[cell];
    const bool others = options_.other_cells != OtherCells::Ignore;
    // Files exist whose hexahedra are called tetrahedra: eight corners say more than the type.
    const bool mislabelled = type == kTetrahedron && cells.offsets[cell + 1] - cells.offsets[cell] == 8;
    if (mislabelled) ++mislabelled_;
    if (type == kHexahedron || type == kVoxel || mislabelled) {
        take_as(found_.hexes, cells, cell, "a hexahedron", kCurvedHexes);
        if (type != kVoxel) return;
        auto& hex = found_.hexes.corners.back();
        std::swap(hex[2], hex[3]);
        std::swap(hex[6], hex[7]);
    } else if (type == kTetrahedron && others) {
        take_as(found_.tets, cells, cell, "a tetrahedron");
    } else if (type == kWedge && others) {
        take_as(found_.prisms, cells, cell, "a wedge");
    } else if (type == kPyramid && others) {
        take_as(found_.pyramids, cells, cell, "a pyramid");
    } else {
        ++left_out_[type];
    }
}

template <std::size_t N>
void VtkCellSorter::take_as(FileCells<N>& into, const VtkCells& cells, std::size_t cell, std::string_view kind,
                            std::span<const std::size_t> also) {
    const std::size_t corners = cells.offsets[cell + 1] - cells.offsets[cell];
    const std::size_t number = taken_ + cell;
    const auto& positions = cells.positions;
    const std::size_t position = positions.empty() ? in_.position() : positions[std::min(cell, positions.size() - 1)];
    const bool curved = std::find(also.begin(), also.end(), corners) != also.end();
    if (curved) ++curved_;
    if (corners != N && !curved) {
        in_.fail_at(position, kVtkWording.name_cell(number) + " has " + std::to_string(corners) + " corners",
                    std::string(kind) + " has " + std::to_string(N));
    }
    auto& taken = into.corners.emplace_back();
    std::copy_n(cells.connectivity.begin() + static_cast<std::ptrdiff_t>(cells.offsets[cell]), N, taken.begin());
    into.numbers.push_back(number);
    check_corners(in_, position, taken, number, kVtkWording, kind);
}

void VtkCellSorter::report(std::string_view file) {
    if (mislabelled_ > 0) {
        found_.warnings.push_back(counted(mislabelled_, "cell", "cells") +
                                  " with 8 corners but the type of a tetrahedron (10) taken as hexahedra");
    }
    if (curved_ > 0) {
        found_.warnings.push_back(counted(curved_, "hexahedron has", "hexahedra have") +
                                  " more points than corners: the first 8 are taken");
    }
    std::string list;
    for (const auto& [type, count] : left_out_) {
        const auto names = kCellNames.find(type);
        const bool known = names != kCellNames.end();
        list += (list.empty() ? "" : ", ") +
                counted(count, known ? names->second[0] : "cell", known ? names->second[1] : "cells") + " (VTK type " +
                std::to_string(type) + ")";
    }
    report_left_out(found_, list, file);
}

}  // namespace subvol
