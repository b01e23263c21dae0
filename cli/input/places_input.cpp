// SPDX-License-Identifier: Apache-2.0
#include "places_input.h"

#include <algorithm>
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

/// The lines of a table, cut into words. names: of its columns, empty without a header
struct Table {
    std::vector<std::string> names;
    std::vector<std::vector<std::string>> rows;
    std::vector<std::size_t> lines;  // of the rows, counted from 1
};

Table read_table(const std::string& path) {
    std::istringstream in(detail::read_text(path));
    Table table;
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
        if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
        if (line.find_first_not_of(" \t\r") == std::string::npos || line.starts_with('#')) continue;
        auto words = words_of(line);
        if (table.rows.empty() && table.names.empty() && !words.empty() && !detail::number_from(words[0])) {
            table.names = std::move(words);
            continue;
        }
        if (!table.names.empty() && words.size() > table.names.size()) {
            throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(words.size()) + " words here",
                        path + ":" + std::to_string(number),
                        "as many as columns are named: " + std::to_string(table.names.size()));
        }
        table.rows.push_back(std::move(words));
        table.lines.push_back(number);
    }
    return table;
}

std::vector<Vec3> places_of(const Table& table, const std::array<std::size_t, 3>& columns, const std::string& path) {
    std::vector<Vec3> places;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const auto& words = table.rows[row];
        Vec3 place(NAN);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (columns[axis] < words.size()) {
                place[static_cast<int>(axis)] = detail::number_from(words[columns[axis]]).value_or(NAN);
            }
        }
        if (!std::isfinite(place.x + place.y + place.z)) {
            throw Error(ErrorCode::InvalidInput, "'" + detail::printable(join(words).substr(0, 60)) + "' is not a place",
                        path + ":" + std::to_string(table.lines[row]), "three finite numbers, as in 1,2,3");
        }
        places.push_back(place);
    }
    if (places.empty()) throw Error(ErrorCode::InvalidInput, "has no places", path, "lines of three numbers, as in 1,2,3");
    return places;
}

std::vector<double> values_of(const Table& table, std::size_t column, const std::string& path) {
    std::vector<double> values;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const auto& words = table.rows[row];
        const auto value = column < words.size() ? detail::number_from(words[column]) : std::nullopt;
        if (!value || !std::isfinite(*value)) {
            throw Error(ErrorCode::InvalidInput, "column " + std::to_string(column + 1) + " has no number here",
                        path + ":" + std::to_string(table.lines[row]), "finite numbers in all columns");
        }
        values.push_back(*value);
    }
    return values;
}

constexpr std::array<std::size_t, 3> kFirst{0, 1, 2};

}  // namespace

std::vector<Vec3> read_places(const std::string& path) {
    const Table table = read_table(path);
    return places_of(table, columns_of(table.names).value_or(kFirst), path);
}

HexMesh read_samples(const std::string& path) {
    const Table table = read_table(path);
    const auto columns = columns_of(table.names).value_or(kFirst);
    HexMesh samples;
    samples.points = places_of(table, columns, path);
    const std::size_t all = table.names.empty() ? table.rows.front().size() : table.names.size();
    for (std::size_t column = 0; column < all; ++column) {
        if (std::ranges::find(columns, column) != columns.end()) continue;
        const std::string name = table.names.empty() ? "v" + std::to_string(column - 2) : table.names[column];
        samples.attributes.push_back({.name = name, .channels = 1, .values = values_of(table, column, path)});
    }
    if (samples.attributes.empty()) {
        throw Error(ErrorCode::InvalidInput, "has no column of values", path, "a fourth column, as in x,y,z,T");
    }
    return samples;
}

}  // namespace subvol::cli
