// SPDX-License-Identifier: Apache-2.0
#include "places_input.h"

#include <array>
#include <cmath>
#include <optional>
#include <sstream>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

std::vector<std::string> words_of(const std::string& line) {
    const bool marks = line.find_first_of(",;") != std::string::npos;
    std::vector<std::string> words(1);
    for (const char c : line) {
        if (c == ',' || c == ';' || (!marks && (c == ' ' || c == '\t') && !words.back().empty())) {
            words.emplace_back();
        } else if (c != ' ' && c != '\t' && c != '\r' && c != '"') {
            words.back() += c;
        }
    }
    if (!marks && words.back().empty()) words.pop_back();
    return words;
}

/// The columns of x, y and z by the names in a header; nothing if they are not there.
std::optional<std::array<std::size_t, 3>> columns_of(const std::vector<std::string>& names) {
    std::array<std::optional<std::size_t>, 3> found;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i].size() != 1) continue;
        const char c = static_cast<char>(names[i][0] | 0x20);
        if (c >= 'x' && c <= 'z') found[static_cast<std::size_t>(c - 'x')] = i;
    }
    if (!found[0] || !found[1] || !found[2]) return std::nullopt;
    return std::array{*found[0], *found[1], *found[2]};
}

}  // namespace

std::vector<Vec3> read_places(const std::string& path) {
    std::istringstream in(detail::read_text(path));
    std::vector<Vec3> places;
    std::array<std::size_t, 3> columns{0, 1, 2};
    std::string line;
    bool first = true;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
        if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
        if (line.find_first_not_of(" \t\r") == std::string::npos || line.starts_with('#')) continue;
        const auto words = words_of(line);
        const bool header = first && !words.empty() && !detail::number_from(words[0]);
        first = false;
        if (header) {
            columns = columns_of(words).value_or(columns);
            continue;
        }
        Vec3 place(NAN);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (columns[axis] < words.size()) {
                place[static_cast<int>(axis)] = detail::number_from(words[columns[axis]]).value_or(NAN);
            }
        }
        if (!std::isfinite(place.x + place.y + place.z)) {
            throw Error(ErrorCode::InvalidInput, "'" + detail::printable(line.substr(0, 60)) + "' is not a place",
                        path + ":" + std::to_string(number), "three finite numbers, as in 1,2,3");
        }
        places.push_back(place);
    }
    if (places.empty()) throw Error(ErrorCode::InvalidInput, "has no places", path, "lines of three numbers, as in 1,2,3");
    return places;
}

}  // namespace subvol::cli
