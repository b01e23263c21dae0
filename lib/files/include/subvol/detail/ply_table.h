// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "subvol/detail/number_type.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/index.h"

namespace subvol::detail {

// PLY as a format of tables, whatever they mean.

struct PlyProperty {
    std::string name;
    NumberType type;
    std::optional<NumberType> counts;  ///< the type of the lengths if the property is a list; nothing if it is a single number
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

/// The values of a property, in the order of the rows.
struct PlyColumn {
    std::vector<double> values;
    std::vector<std::size_t> lengths;  ///< lengths of the lists, one for each row
};

using PlyTable = std::map<std::string, PlyColumn, std::less<>>;

/// Reads the header to the end of its last line. in: at the start of the file
///
/// throws: Error(InvalidInput)
[[nodiscard]] PlyHeader read_ply_header(TextScanner& in);

/// Reads the rows of the next element and keeps the properties with the names in `wanted`. In text each row is a line.
///
/// throws: Error(InvalidInput)
[[nodiscard]] PlyTable read_ply_element(TextScanner& in, const PlyHeader& header, const PlyElement& element,
                                        const std::set<std::string, std::less<>>& wanted);

/// Refuses what follows the last element, but for white space.
///
/// throws: Error(InvalidInput)
void expect_ply_end(TextScanner& in);

/// A number of a list as that of a vertex.
///
/// of, row: what the list belongs to, for messages
/// throws: Error(InvalidInput) if it is not a whole number below `points`
[[nodiscard]] Index ply_corner(const TextScanner& in, double number, std::size_t points, std::string_view of, std::size_t row);

}  // namespace subvol::detail
