// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "inp_types.h"
#include "mesh_file.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// An element of a deck.
struct InpElement {
    std::int64_t number;
    const InpType* type;
    std::vector<std::int64_t> nodes;  ///< none if its type is not read
    std::string_view place;           ///< for messages
};

/// Elements or nodes by their numbers.
struct InpSet {
    std::string name;  ///< as it is written first
    std::vector<std::int64_t> numbers;
    std::vector<std::array<std::int64_t, 3>> ranges;  ///< from, to, and the step between
    bool left_out = false;                            ///< not all of it can be read
};

/// Sides of elements.
struct InpSide {
    std::string set;  ///< set of elements, or empty: `number` is an element
    std::int64_t number = 0;
    std::size_t side = 0;  ///< from 1, or 0 for all sides that are free
};

struct InpSurface {
    std::string name;
    std::string scope;  ///< the part that the surface is of, as in InpInstance; empty: it is of the assembly
    std::vector<InpSide> sides;
};

/// The nodes and elements of a part, or those that an instance adds to its part.
struct InpPart {
    std::vector<std::int64_t> numbers;
    std::vector<Vec3> points;
    std::vector<InpElement> elements;
    std::map<std::string, InpSet> sets;       ///< sets of elements, by names in capitals
    std::map<std::string, InpSet> node_sets;  ///< the same of nodes
};

/// A part where the assembly puts it: turned about an axis, after it was moved.
struct InpInstance {
    std::string part;
    std::string inside;  ///< the name of the part that has what the instance adds, which are nodes, elements and sets
    Vec3 move{0.0};
    std::array<Vec3, 2> axis{Vec3(0.0), Vec3(0.0)};
    double angle_deg = 0;
    struct Place {
        std::string_view file;
        std::size_t line = 0;
    } place;  // for messages

    [[nodiscard]] Vec3 operator()(const Vec3& x) const;
};

/// An Abaqus or CalculiX deck, with the files that it includes. A deck without instances has one of the part "".
struct InpDeck {
    std::map<std::string, InpPart> parts;  // by names in capitals
    std::size_t parts_alone = 0;           // parts that no instance places: they are where their nodes are
    std::vector<InpInstance> instances;
    std::map<std::string, InpType> types;  // owns the types, by their names
    std::set<std::string> files;           // owns the names of files
    std::vector<InpSurface> surfaces;
    std::size_t made = 0;    // nodes and elements that are not in the text, those of instances among them
    std::size_t longer = 0;  // elements with more numbers than their types have nodes
    std::map<std::string, std::size_t> other_keywords;  // those of which nothing is taken, in capitals, and how many there are
    LeftOut sets_left_out, node_sets_left_out, surfaces_left_out;
};

/// throws: Error(InvalidInput) that names the file and the line
[[nodiscard]] InpDeck read_inp_deck(const std::filesystem::path& path);

}  // namespace subvol::detail
