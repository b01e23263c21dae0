// SPDX-License-Identifier: Apache-2.0
#include "vtk_cells.h"

#include <algorithm>
#include <array>

#include "assemble.h"

namespace subvol::detail {

namespace {

enum CellType : std::int64_t {
    kLine = 3,
    kQuad = 9,
    kTetrahedron = 10,
    kVoxel = 11,
    kHexahedron = 12,
    kWedge = 13,
    kPyramid = 14,
    kPentagonalPrism = 15,
    kHexagonalPrism = 16,
    kConvexPointSet = 41,
    kLagrangeHexahedron = 72,
    kBezierHexahedron = 79
};

// The linear type of each type with points in the middle of edges, faces or the cell, which come after the corners.
const std::map<std::int64_t, std::int64_t> kLinear{
    {24, kTetrahedron}, {71, kTetrahedron}, {78, kTetrahedron}, {25, kHexahedron}, {29, kHexahedron}, {33, kHexahedron},
    {72, kHexahedron},  {79, kHexahedron},  {26, kWedge},       {31, kWedge},      {32, kWedge},      {73, kWedge},
    {80, kWedge},       {27, kPyramid},     {37, kPyramid},     {74, kPyramid},    {81, kPyramid}};

// The points of VTK's curved cells: some files have them with the type of the linear cell of their shape.
constexpr std::array<std::size_t, 3> kOfCurvedHexahedra{20, 24, 27};
constexpr std::array<std::size_t, 1> kOfCurvedTetrahedra{10};
constexpr std::array<std::size_t, 3> kOfCurvedWedges{12, 15, 18};
constexpr std::array<std::size_t, 3> kOfCurvedPyramids{13, 14, 19};

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
    {15, {"pentagonal prism", "pentagonal prisms"}},
    {16, {"hexagonal prism", "hexagonal prisms"}},
    {24, {"quadratic tetrahedron", "quadratic tetrahedra"}},
    {26, {"quadratic wedge", "quadratic wedges"}},
    {27, {"quadratic pyramid", "quadratic pyramids"}},
    {41, {"convex point set", "convex point sets"}},
    {42, {"polyhedron", "polyhedra"}}};

// The faces of a prism: its base, the same corners above it, and a quad on each side.
CellFaces prism_faces(std::span<const Index> corners) {
    const std::size_t sides = corners.size() / 2;
    CellFaces faces{{corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(sides)},
                    {corners.begin() + static_cast<std::ptrdiff_t>(sides), corners.end()}};
    for (std::size_t k = 0; k < sides; ++k) {
        const std::size_t next = (k + 1) % sides;
        faces.push_back({corners[k], corners[next], corners[sides + next], corners[sides + k]});
    }
    return faces;
}

}  // namespace

void VtkCellSorter::take(std::int64_t type_in_file, std::span<const Index> corners, std::size_t position) {
    const auto linear = kLinear.find(type_in_file);
    const bool curved = linear != kLinear.end();
    const std::int64_t type = curved ? linear->second : type_in_file;
    const bool others = options_.other_cells != OtherCells::Ignore;
    // Some files have hexahedra with the type of tetrahedra: the eight corners decide.
    const bool mislabelled = type_in_file == kTetrahedron && corners.size() == 8;
    if (mislabelled) ++mislabelled_;
    const auto is_curved = [&](const auto& numbers) {
        return curved || std::ranges::find(numbers, corners.size()) != numbers.end();
    };
    if (type == kHexahedron || type == kVoxel || mislabelled) {
        take_as(found_.hexes, corners, position, "a hexahedron", is_curved(kOfCurvedHexahedra));
        if (corners.size() > 8 && type != kVoxel && keep_curved(type_in_file, corners)) --curved_;
        if (type == kVoxel) {
            auto& hex = found_.hexes.corners.back();
            std::swap(hex[2], hex[3]);
            std::swap(hex[6], hex[7]);
        }
    } else if (type == kTetrahedron && others) {
        take_as(found_.tets, corners, position, "a tetrahedron", is_curved(kOfCurvedTetrahedra));
    } else if (type == kWedge && others) {
        take_as(found_.prisms, corners, position, "a wedge", is_curved(kOfCurvedWedges));
    } else if (type == kPyramid && others) {
        take_as(found_.pyramids, corners, position, "a pyramid", is_curved(kOfCurvedPyramids));
    } else if (type == kQuad && corners.size() == 4) {
        take_as(found_.quads, corners, position, "a quad", false);
    } else if (type == kLine && corners.size() == 2) {
        take_as(found_.lines, corners, position, "a line", false);
    } else if (const std::size_t sides = type == kPentagonalPrism  ? 5
                                         : type == kHexagonalPrism ? 6
                                                                   : 0;
               others && sides > 0 && corners.size() == 2 * sides) {
        polyhedra_.add(next_, prism_faces(corners));
    } else if (type == kConvexPointSet) {
        point_sets_.emplace_back(next_, std::vector<Index>(corners.begin(), corners.end()));
    } else {
        ++left_out_[type_in_file];
    }
    ++next_;
}

bool VtkCellSorter::keep_curved(std::int64_t type, std::span<const Index> nodes) {
    if (!options_.curved_tolerance) return false;
    const bool bezier = type == kBezierHexahedron, lagrange = type == kLagrangeHexahedron;
    const bool of_arrays = bezier || lagrange;  // their degrees may be in an array
    if (!of_arrays && std::ranges::find(kOfCurvedHexahedra, nodes.size()) == kOfCurvedHexahedra.end()) return false;
    const CurvedOrder order = bezier                   ? (old_order_ ? CurvedOrder::VtkBezier8 : CurvedOrder::VtkBezier)
                              : lagrange && old_order_ ? CurvedOrder::Vtk8
                                                       : CurvedOrder::Vtk;
    found_.curved.add(next_, order, nodes);
    return true;
}

template <std::size_t N>
void VtkCellSorter::take_as(FileCells<N>& into, std::span<const Index> corners, std::size_t position, std::string_view kind,
                            bool curved) {
    if (corners.size() > N && curved) ++curved_;
    if (corners.size() < N || (corners.size() > N && !curved)) {
        in_.fail_at(position, kVtkNames.cell(next_) + " has " + std::to_string(corners.size()) + " corners",
                    std::string(kind) + " has " + std::to_string(N));
    }
    auto& taken = into.corners.emplace_back();
    std::copy_n(corners.begin(), N, taken.begin());
    into.numbers.push_back(static_cast<Index>(next_));
}

void VtkCellSorter::take_point_sets() {
    for (auto& [number, corners] : point_sets_) {
        std::ranges::sort(corners);
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        CellFaces faces = hull_faces(corners, found_.points);
        if (is_closed(faces)) {
            polyhedra_.add(number, std::move(faces));
        } else {
            ++left_out_[kConvexPointSet];
        }
    }
    point_sets_.clear();
}

void VtkCellSorter::take_no_shells() {
    const std::size_t quads = found_.quads.corners.size(), lines = found_.lines.corners.size();
    if (quads > 0) left_out_[kQuad] += quads;
    if (lines > 0) left_out_[kLine] += lines;
    found_.quads = {};
    found_.lines = {};
}

std::optional<CellFaces> faces_of_stream(std::span<const std::int64_t> stream, std::size_t first_point, std::size_t points) {
    CellFaces faces;
    std::size_t at = 0;
    const auto count = [&]() -> std::size_t {
        const bool fits = at < stream.size() && stream[at] > 0 && static_cast<std::size_t>(stream[at]) < stream.size() - at;
        return fits ? static_cast<std::size_t>(stream[at++]) : 0;
    };
    const std::size_t of_cell = count();
    for (std::size_t f = 0; f < of_cell; ++f) {
        const std::size_t corners = count();
        if (corners == 0) return std::nullopt;
        auto& face = faces.emplace_back();
        for (const std::int64_t p : stream.subspan(at, corners)) {
            if (p < 0 || static_cast<std::size_t>(p) >= points) return std::nullopt;
            face.push_back(static_cast<Index>(first_point + static_cast<std::size_t>(p)));
        }
        at += corners;
    }
    return of_cell > 0 && at == stream.size() ? std::optional(std::move(faces)) : std::nullopt;
}

std::optional<CellFaces> VtkFaces::of_cell(std::size_t cell, std::size_t first_point, std::size_t point_count) const {
    const auto is_part = [](const std::vector<std::int64_t>& list, std::int64_t begin, std::int64_t end) {
        return begin >= 0 && begin <= end && static_cast<std::size_t>(end) <= list.size();
    };
    const auto before = [](const std::vector<std::int64_t>& list, std::size_t at) { return at == 0 ? 0 : list[at - 1]; };
    if (number_ends.empty()) {
        const std::int64_t begin = before(ends, cell);
        if (!is_part(stream, begin, ends[cell])) return std::nullopt;
        const auto length = static_cast<std::size_t>(ends[cell] - begin);
        return faces_of_stream(std::span(stream).subspan(static_cast<std::size_t>(begin), length), first_point, point_count);
    }
    const std::int64_t begin = before(number_ends, cell);
    if (!is_part(numbers, begin, number_ends[cell])) return std::nullopt;
    std::vector<std::int64_t> one{number_ends[cell] - begin};
    for (std::int64_t k = begin; k < number_ends[cell]; ++k) {
        const std::int64_t face = numbers[static_cast<std::size_t>(k)];
        if (face < 0 || static_cast<std::size_t>(face) >= point_ends.size()) return std::nullopt;
        const std::int64_t from = before(point_ends, static_cast<std::size_t>(face));
        const std::int64_t to = point_ends[static_cast<std::size_t>(face)];
        if (!is_part(points, from, to)) return std::nullopt;
        one.push_back(to - from);
        one.insert(one.end(), points.begin() + from, points.begin() + to);
    }
    return faces_of_stream(one, first_point, point_count);
}

void VtkCellSorter::take_polyhedron(CellFaces&& faces) {
    polyhedra_.add(next_++, std::move(faces));
}

void VtkCellSorter::report(std::optional<std::string_view> file) {
    take_ghost_levels(found_);
    take_point_sets();
    const std::size_t others = polyhedra_.take_into(found_, options_.other_cells == OtherCells::Ignore);
    if (others > 0) left_out_[kVtkPolyhedron] += others;
    if (mislabelled_ > 0) {
        found_.warnings.push_back(counted(mislabelled_, "cell", "cells") +
                                  " with 8 corners but the type of a tetrahedron (10) taken as hexahedra");
    }
    if (curved_ > 0) {
        found_.warnings.push_back(counted(curved_, "cell has", "cells have") +
                                  " more points than corners: only the corners are used");
    }
    if (!file) take_no_shells();
    const auto [quads, lines] = drop_parts_of_cells(found_, options_.shells_alone);
    if (quads > 0) left_out_[kQuad] += quads;
    if (lines > 0) left_out_[kLine] += lines;
    std::vector<IgnoredPart> types;
    for (const auto& [type, count] : left_out_) types.push_back({"cell type", std::to_string(type), count});
    add_left_out_warning(found_, types, file, [](const IgnoredPart& type) {
        const auto names = kCellNames.find(std::stoll(type.name));
        const bool known = names != kCellNames.end();
        return counted(type.count, known ? names->second[0] : "cell", known ? names->second[1] : "cells") + " (VTK type " +
               type.name + ")";
    });
}

}  // namespace subvol::detail
