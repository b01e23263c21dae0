// SPDX-License-Identifier: Apache-2.0
#include "gmsh_data.h"

#include <limits>

namespace subvol::detail {

namespace {

struct DataHeader {
    std::string name = "unnamed";
    std::size_t components = 0;
    std::size_t lines = 0;
};

// Texts (the first is the name), real numbers (times) and integers (step, components, lines), which are words even in a binary
// file.
DataHeader read_header(TextScanner& in, const std::string& section) {
    DataHeader header;
    const std::size_t texts = in.count({"texts of " + section});
    in.line();
    for (std::size_t t = 0; t < texts && !in.at_end(); ++t) {
        const std::string_view text = in.line();
        if (t == 0) header.name = unquoted(text);
    }
    const std::string reals_of = "real numbers of " + section, integers_of = "integers of " + section;
    const std::size_t reals = in.count({reals_of});
    for (std::size_t r = 0; r < reals; ++r) in.real({reals_of});
    const std::size_t integers = in.count({integers_of});
    if (integers < 3) in.fail(section + " needs at least 3 integers");
    in.integer({integers_of});
    header.components = in.count({integers_of});
    if (header.components < 1 || header.components > 9) {
        in.fail(section + " has " + std::to_string(header.components) + " components", "1, 3 or 9");
    }
    header.lines = in.count({integers_of});
    for (std::size_t i = 3; i < integers; ++i) in.integer({integers_of});
    return header;
}

}  // namespace

std::string unquoted(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t\"");
    if (begin == std::string_view::npos) return "unnamed";
    return as_utf8(text.substr(begin, text.find_last_not_of(" \t\"") + 1 - begin));
}

void read_gmsh_data(TextScanner& in, GmshValues& values, const GmshEntities& entities, MeshFile& found) {
    const auto& [at_cells, numbers, needed] = entities;
    const std::string entity = at_cells ? "element" : "node";
    const DataHeader header = read_header(in, at_cells ? "$ElementData" : "$NodeData");
    const std::string what = "array " + in_quotes(header.name) + ": line";
    FileArray array{header.name, static_cast<int>(header.components), at_cells, {}};
    array.values.assign(numbers.size() * header.components, std::numeric_limits<double>::quiet_NaN());
    std::vector<std::uint8_t> missing(needed.begin(), needed.end());
    values.begin();
    for (std::size_t n = 0; n < header.lines; ++n) {
        const Place place{what, static_cast<std::int64_t>(n + 1), header.lines};
        const std::int64_t number = values.integer(place);
        const Index to = numbers.find(number);
        if (to == kNone) {
            // NOLINTNEXTLINE(performance-inefficient-string-concatenation): the loop ends here
            in.fail(what + " " + std::to_string(n + 1) + ": there is no " + entity + " " + std::to_string(number));
        }
        missing[to] = 0;
        for (std::size_t k = 0; k < header.components; ++k) array.values[to * header.components + k] = values.real(place);
    }
    const auto count = static_cast<std::size_t>(std::count(missing.begin(), missing.end(), std::uint8_t{1}));
    if (count == 0) {
        found.arrays.push_back(std::move(array));
    } else {
        found.warnings.push_back("array " + in_quotes(header.name) + " has no value at " +
                                 counted(count, entity, entity + "s") + ": ignored");
    }
}

}  // namespace subvol::detail
