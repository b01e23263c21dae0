// SPDX-License-Identifier: Apache-2.0
// What the elements of a Gmsh file become: cells by their shape, sheets and curves, sharp faces and edges of the groups that
// the user names, and patches, sets of cells and sets of nodes of all groups. Elements that are none of these are counted for
// a warning, as are faces and edges of cells in no group.
#include "gmsh_elements.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <limits>
#include <tuple>

namespace subvol::detail {

namespace {

/// The next integer, which ends at a blank or at the quotation mark of a name.
std::int64_t leading_integer(TextScanner& in, const Place& place) {
    const std::string_view word = in.peek();
    const std::size_t mark = word.find('"');
    std::int64_t value = 0;
    const auto digits = mark == std::string_view::npos ? std::string_view() : word.substr(0, mark);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) return in.integer(place);
    std::ignore = in.at_end();  // goes to the word
    std::ignore = in.bytes(mark, place);
    return value;
}

}  // namespace

std::string unquoted(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t\"");
    if (begin == std::string_view::npos) return "unnamed";
    return as_utf8(text.substr(begin, text.find_last_not_of(" \t\"") + 1 - begin));
}

// The names of groups are text even in a binary file. Since version 2.1 a dimension comes before the number; without one, a
// name is that of the group of all dimensions. Some writers leave no blank before the name.
void GmshGroups::read_names(TextScanner& in) {
    const std::size_t count = in.count({"$PhysicalNames"});
    for (std::size_t n = 0; n < count; ++n) {
        const Place place{"physical name", static_cast<std::int64_t>(n + 1), count};
        const std::int64_t first = leading_integer(in, place);
        const std::size_t next = in.rest().find_first_not_of(" \t");
        if (next == std::string_view::npos || in.rest()[next] == '"') {
            const std::string name = unquoted(in.line());
            for (std::int64_t dimension = 0; dimension <= 3; ++dimension) names_[{dimension, first}] = name;
        } else {
            const std::int64_t number = leading_integer(in, place);
            names_[{first, number}] = unquoted(in.line());
        }
    }
}

// An entity: number, bounding box, physical groups, and the entities that bound it.
void GmshGroups::read_entities(GmshValues& values, bool places) {
    values.begin();
    std::array<std::size_t, 4> counts;
    for (std::size_t& count : counts) count = values.count({"$Entities"}, NumberType::UInt64);
    for (std::size_t dimension = 0; dimension < counts.size(); ++dimension) {
        for (std::size_t e = 0; e < counts[dimension]; ++e) {
            const Place place{"entity", static_cast<std::int64_t>(e + 1), counts[dimension]};
            auto& groups = groups_of_[{static_cast<std::int64_t>(dimension), values.integer(place)}];
            for (int k = 0; k < (dimension == 0 && places ? 3 : 6); ++k) values.real(place);
            const std::size_t of_groups = values.count(place, NumberType::UInt64);
            for (std::size_t g = 0; g < of_groups; ++g) groups.push_back(values.integer(place));
            const std::size_t bounds = dimension == 0 ? 0 : values.count(place, NumberType::UInt64);
            for (std::size_t b = 0; b < bounds; ++b) values.integer(place);
        }
    }
}

bool GmshGroups::is_sharp(std::int64_t dimension, std::int64_t group) {
    constexpr std::int64_t kMostGroup = std::numeric_limits<std::int64_t>::max();
    if (!any() || (dimension != 1 && dimension != 2) || group == 0 || group < -kMostGroup) return false;
    const auto [known, is_new] = sharp_.try_emplace({dimension, group}, false);
    if (!is_new) return known->second;
    const std::string number = std::to_string(std::abs(group));
    const auto named = names_.find({dimension, std::abs(group)});
    return known->second = wanted_.takes(named == names_.end() ? number : named->second, number);
}

bool GmshGroups::has_sharp(std::int64_t dimension, std::int64_t entity) {
    const auto groups = groups_of_.find({dimension, entity});
    if (groups == groups_of_.end()) return false;
    bool sharp = false;
    for (const std::int64_t group : groups->second) sharp = is_sharp(dimension, group) || sharp;
    return sharp;
}

std::string GmshGroups::name_of(std::int64_t dimension, std::int64_t group) const {
    const auto named = names_.find({dimension, group});
    return named == names_.end() ? "group " + std::to_string(group) : named->second;
}

std::vector<std::string> GmshGroups::names_of_entity(std::int64_t dimension, std::int64_t entity) const {
    std::vector<std::string> names;
    const auto groups = groups_of_.find({dimension, entity});
    if (groups == groups_of_.end()) return names;
    constexpr std::int64_t kMostGroup = std::numeric_limits<std::int64_t>::max();
    for (const std::int64_t group : groups->second) {
        if (group != 0 && group >= -kMostGroup) names.push_back(name_of(dimension, std::abs(group)));
    }
    return names;
}

std::int64_t dimension_of(const GmshElement& element) {
    if (element.nodes == 1) return 0;
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
    } else if (!groups_.empty() && dimension_of(element) < 2) {
        take_nodes(element, number, type, place);
    } else if (!groups_.empty() && dimension_of(element) == 2) {
        take_surface(element, number, type, place);
    } else if (element.shape == GmshShape::Quad && element.nodes == 4) {
        take_shell(found_.quads, element, number, type, place);
    } else if (element.shape == GmshShape::Line && element.nodes == 2) {
        take_shell(found_.lines, element, number, type, place);
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
void GmshCells::take_shell(FileCells<N>& into, const GmshElement& element, std::size_t number, NumberType type,
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

// A point or a line of a group. Plain lines may be beams as well.
void GmshCells::take_nodes(const GmshElement& element, std::size_t number, NumberType type, const Place& place) {
    std::vector<Index> nodes;
    for (std::size_t k = 0; k < element.nodes; ++k) nodes.push_back(nodes_.find(values_.integer(place, type)));
    const bool known = std::ranges::find(nodes, kNone) == nodes.end();
    for (const std::string& group : groups_) {
        if (known) node_sets_[group].numbers.insert(node_sets_[group].numbers.end(), nodes.begin(), nodes.end());
    }
    if (known && element.nodes == 2) {
        found_.lines.corners.push_back({nodes[0], nodes[1]});
        found_.lines.numbers.push_back(static_cast<Index>(number));
        if (!groups_.empty()) grouped_.push_back(static_cast<Index>(number));
    } else if (!known || element.nodes > 1) {
        leave_out(element, 1);
    }
}

// A triangle or quad of a group. Plain quads may be shells as well.
void GmshCells::take_surface(const GmshElement& element, std::size_t number, NumberType type, const Place& place) {
    const std::size_t corners = element.shape == GmshShape::Triangle ? 3 : 4;
    std::vector<Index> nodes;
    for (std::size_t k = 0; k < element.nodes; ++k) {
        const Index node = nodes_.find(values_.integer(place, type));
        if (k < corners) nodes.push_back(node);
    }
    const bool known = std::ranges::find(nodes, kNone) == nodes.end();
    for (const std::string& group : groups_) {
        if (known) patches_[group].add(nodes);
    }
    if (!known || element.nodes != 4 || corners != 4) return leave_out(element, 1);
    found_.quads.corners.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
    found_.quads.numbers.push_back(static_cast<Index>(number));
    grouped_.push_back(static_cast<Index>(number));
}

template <std::size_t N>
bool GmshCells::take_as(FileCells<N>& into, const GmshElement& element, std::size_t number, NumberType type,
                        const Place& place) {
    auto& corners = into.corners.emplace_back();
    for (Index& corner : corners) corner = read_corner(place, type);
    into.numbers.push_back(static_cast<Index>(number));
    for (const std::string& group : groups_) sets_[group].numbers.push_back(static_cast<Index>(number));
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
    // Faces and edges of cells that are in groups are patches and sets of nodes.
    const auto in_no_group = [&](const std::vector<Index>& numbers) {
        const auto is_grouped = [&](Index n) { return std::ranges::binary_search(grouped_, n); };
        return numbers.size() - static_cast<std::size_t>(std::ranges::count_if(numbers, is_grouped));
    };
    const std::size_t quads = in_no_group(found_.quads.numbers), lines = in_no_group(found_.lines.numbers);
    drop_parts_of_cells(found_, options_.shells_alone);
    leave_out(kGmshElements.at(3), quads - in_no_group(found_.quads.numbers));
    leave_out(kGmshElements.at(1), lines - in_no_group(found_.lines.numbers));
    std::vector<IgnoredPart> types;
    for (const auto& [one, rest] : left_out_) types.push_back({"element type", std::string(one), rest.first});
    add_left_out_warning(found_, types, file, [&](const IgnoredPart& type) {
        return counted(type.count, type.name, left_out_.at(type.name).second);
    });
}

}  // namespace subvol::detail
