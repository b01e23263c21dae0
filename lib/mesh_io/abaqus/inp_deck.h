// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/vec.h"

namespace subvol::detail {

/// An element of a deck. type: in capitals, such as C3D8R
struct InpElement {
    std::int64_t number;
    std::string_view type;
    std::vector<std::int64_t> nodes;
    std::string_view place;  // for messages
};

/// The nodes and elements of a part. sets: the numbers of the elements of each set, by the set's name
struct InpPart {
    std::vector<std::int64_t> numbers;
    std::vector<Vec3> points;
    std::vector<InpElement> elements;
    std::map<std::string, std::vector<std::int64_t>> sets;
};

/// A part where the assembly puts it: turned about an axis, after it was moved.
struct InpInstance {
    std::string part;
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
    std::vector<InpInstance> instances;
    std::map<std::string, std::string> types;  // owns the names of types
    std::set<std::string> files;               // owns the names of files
    std::size_t made = 0;                      // nodes and elements that are not in the text, those of instances among them
};

/// Whether a type is one of shells and membranes with four nodes, or of beams and trusses with two.
[[nodiscard]] bool is_shell(std::string_view type);

/// throws: Error(InvalidInput) that names the file and the line
[[nodiscard]] InpDeck read_inp_deck(const std::filesystem::path& path);

}  // namespace subvol::detail
