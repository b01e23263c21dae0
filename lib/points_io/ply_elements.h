// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "number_type.h"
#include "text_scanner.h"

namespace subvol::detail {

/// counts: the type of the lengths if it is a list of numbers, else nothing
struct PlyProperty {
    std::string name;
    NumberType type;
    std::optional<NumberType> counts;
};

struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    bool ascii = true;
    std::endian order = std::endian::little;
    std::vector<std::string> comments;
    std::vector<PlyElement> elements;
};

/// Reads to the end of the header's last line. in: at the start of the file
///
/// throws: Error(InvalidInput), as all of this file
[[nodiscard]] PlyHeader read_ply_header(TextScanner& in);

/// The values of a property, in the order of the rows. lengths: of a list, a row each
struct PlyColumn {
    std::vector<double> values;
    std::vector<std::size_t> lengths;
};

using PlyTable = std::map<std::string, PlyColumn, std::less<>>;

/// Reads the rows of the element that comes next, keeping the properties whose names are `wanted`.
[[nodiscard]] PlyTable read_ply_element(TextScanner& in, const PlyHeader& header, const PlyElement& element,
                                        const std::set<std::string, std::less<>>& wanted);

}  // namespace subvol::detail
