// SPDX-License-Identifier: Apache-2.0
#include "gmsh_cells.h"

#include <string>
#include <vector>

namespace subvol::detail {

std::int64_t dimension_of(const GmshElement& element) {
    if (element.shape == GmshShape::Line) return 1;
    return element.shape == GmshShape::Triangle || element.shape == GmshShape::Quad ? 2 : 3;
}

bool GmshCells::take(const GmshElement& element, std::size_t number, bool sharp, NumberType type, const Place& place) {
    const bool others = options_.other_cells != OtherCells::Ignore;
    if (element.shape == GmshShape::Hexahedron) return take_as(found_.hexes, element, number, type, place);
    if (element.shape == GmshShape::Tetrahedron && others) return take_as(found_.tets, element, number, type, place);
    if (element.shape == GmshShape::Prism && others) return take_as(found_.prisms, element, number, type, place);
    if (element.shape == GmshShape::Pyramid && others) return take_as(found_.pyramids, element, number, type, place);
    if (sharp && dimension_of(element) < 3) {
        take_tag(element, type, place);
    } else if (element.shape == GmshShape::Quad && element.nodes == 4) {
        take_sheet(found_.quads, element, number, type, place);
    } else if (element.shape == GmshShape::Line && element.nodes == 2) {
        take_sheet(found_.lines, element, number, type, place);
    } else {
        for (std::size_t k = 0; k < element.nodes; ++k) values_.integer(place, type);
        leave_out(element, 1);
    }
    return false;
}

Index GmshCells::read_corner(const Place& place, NumberType type) {
    const std::int64_t number = values_.integer(place, type);
    const Index node = nodes_.find(number);
    if (node == kNone) {
        in_.fail(std::string(place.what) + " " + std::to_string(place.number) + ": there is no node " + std::to_string(number));
    }
    return node;
}

void GmshCells::leave_out(const GmshElement& element, std::size_t how_many) {
    if (how_many == 0) return;
    auto& [count, many] = left_out_[element.one];
    count += how_many;
    many = element.many;
}

// Reads a quad or a line; those with unknown nodes are left out, as they were never needed.
template <std::size_t N>
void GmshCells::take_sheet(FileCells<N>& into, const GmshElement& element, std::size_t number, NumberType type,
                           const Place& place) {
    std::array<Index, N> corners;
    bool known = true;
    for (Index& corner : corners) {
        corner = nodes_.find(values_.integer(place, type));
        known = known && corner != kNone;
    }
    if (!known) return leave_out(element, 1);
    into.corners.push_back(corners);
    into.numbers.push_back(static_cast<Index>(number));
}

void GmshCells::take_tag(const GmshElement& element, NumberType type, const Place& place) {
    const std::size_t corners = element.shape == GmshShape::Line ? 2 : element.shape == GmshShape::Triangle ? 3 : 4;
    std::array<Index, 4> tag;
    for (std::size_t k = 0; k < corners; ++k) tag[k] = read_corner(place, type);
    for (std::size_t k = corners; k < element.nodes; ++k) values_.integer(place, type);
    if (corners == 2) return found_.sharp.edges.push_back({tag[0], tag[1]});
    if (corners == 3) tag[3] = tag[2];
    found_.sharp.faces.push_back(tag);
}

template <std::size_t N>
bool GmshCells::take_as(FileCells<N>& into, const GmshElement& element, std::size_t number, NumberType type,
                        const Place& place) {
    auto& corners = into.corners.emplace_back();
    for (Index& corner : corners) corner = read_corner(place, type);
    into.numbers.push_back(static_cast<Index>(number));
    const bool whole = N == 8 && element.nodes > N && options_.curved_tolerance.has_value();
    curved_ += element.nodes > N && !whole;
    std::vector<Index> nodes(corners.begin(), corners.end());
    for (std::size_t k = N; k < element.nodes; ++k) {
        if (whole) {
            nodes.push_back(read_corner(place, type));
        } else {
            values_.integer(place, type);
        }
    }
    if (whole) found_.curved.add(number, CurvedOrder::Gmsh, nodes);
    return true;
}

void GmshCells::list_left_out(std::string_view file) {
    if (curved_ > 0) {
        found_.warnings.push_back(counted(curved_, "element has", "elements have") +
                                  " more nodes than corners: only the corners are used");
    }
    const auto [quads, lines] = drop_parts_of_cells(found_, options_.sheets_alone);
    leave_out(kGmshElements.at(3), quads);
    leave_out(kGmshElements.at(1), lines);
    std::string list;
    for (const auto& [one, rest] : left_out_) {
        list += (list.empty() ? "" : ", ") + counted(rest.first, one, rest.second);
    }
    add_left_out_warning(found_, list, file);
}

}  // namespace subvol::detail
