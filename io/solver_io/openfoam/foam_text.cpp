// SPDX-License-Identifier: Apache-2.0
// Reads the words, lists and dictionaries of one OpenFOAM file, which may be compressed, binary, or one block of a file for
// several processors. The header says the class, the byte order and the widths of numbers.
//
//     list        count ( values ), or count { value } for equal ones; in a binary file the values are bytes
//     dictionary  name { key value; … }
//     field       entries up to internalField, which is uniform or nonuniform; units are powers of kg, m, s, K, mol, A, cd
//
// Entries before a field are kept by name, also those of included files, because $name stands for the text of an entry. How
// much a compressed file may grow to follows from the counts in its beginning and from what other files say; counts are limited
// by the bytes that are left, and included and inserted text by a depth and a size.
#include "foam_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "subvol/detail/gzip.h"
#include "subvol/detail/number_text.h"

namespace subvol::detail {

namespace {

constexpr std::string_view kMarks = "(){}[];";
constexpr std::size_t kMostExpanded = 1 << 16;  // bytes

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}

/// What a file can have in bytes, by the largest count of a list in its beginning, and by what others say.
std::size_t most_bytes(std::string_view beginning, std::size_t most_entries) {
    constexpr std::size_t kBytesOfEntry = 512;  // nine numbers as text, or a face of 40 points
    std::size_t largest = 0;
    for (std::size_t open = beginning.find('('); open != std::string_view::npos; open = beginning.find('(', open + 1)) {
        std::size_t end = open;
        while (end > 0 && is_space(beginning[end - 1])) --end;
        std::size_t begin = end;
        while (begin > 0 && beginning[begin - 1] >= '0' && beginning[begin - 1] <= '9') --begin;
        std::size_t count = 0;
        if (std::from_chars(beginning.data() + begin, beginning.data() + end, count).ec == std::errc()) {
            largest = std::max(largest, std::min(count, std::numeric_limits<std::size_t>::max() / kBytesOfEntry));
        }
    }
    return kBytesOfEntry * std::min(largest, most_entries);
}

}  // namespace

FoamText::FoamText(const std::filesystem::path& path, std::size_t most_entries, std::optional<std::size_t> block)
    : file_(path.string()),
      text_(read_maybe_gzipped(path, [=](std::string_view beginning) { return most_bytes(beginning, most_entries); })) {
    read_header();
    if (block) take_block(*block);
}

// Each block is a count of bytes and these in parentheses; the first one begins with the header of all.
void FoamText::take_block(std::size_t block) {
    if (type_ != "decomposedBlockData") fail("it does not have the blocks of several processors");
    std::string found;
    for (std::size_t k = 0; k <= block; ++k) {
        const std::size_t size = count(1);
        expect("(");
        const std::string_view contents = bytes(size);
        if (k == 0 || k == block) found += k == 0 ? contents : std::string_view();
        if (k > 0 && k == block) {
            // Only the header of the first block counts.
            const std::size_t begin = found.find("FoamFile"), end = found.find('}', begin);
            if (end == std::string::npos) fail("the header of the first block does not end");
            found = found.substr(0, end + 1) + std::string(contents);
        }
        expect(")");
    }
    text_ = std::move(found);
    next_ = 0;
    read_header();
}

std::size_t FoamText::blocks() {
    if (type_ != "decomposedBlockData") return 0;
    std::size_t found = 0;
    for (skip_space(); next_ < text_.size(); skip_space()) {
        const std::size_t size = count(1);
        expect("(");
        std::ignore = bytes(size);
        expect(")");
        ++found;
    }
    return found;
}

void FoamText::fail(const std::string& message, const std::string& allowed) const {
    TextScanner place(text_, file_, TextScanner::Comments::None);
    if (binary_) place.name_bytes();
    place.fail_at(std::min(next_, text_.size()), message, allowed);
}

void FoamText::skip_space() {
    const std::string_view all = text_;
    while (next_ < all.size()) {
        const std::string_view rest = all.substr(next_);
        if (is_space(rest.front())) {
            ++next_;
        } else if (rest.starts_with("//")) {
            next_ = std::min(all.find('\n', next_), all.size());
        } else if (rest.starts_with("/*")) {
            const std::size_t end = all.find("*/", next_ + 2);
            next_ = end == std::string_view::npos ? all.size() : end + 2;
        } else {
            return;
        }
    }
}

std::string_view FoamText::token() {
    skip_space();
    if (next_ == text_.size()) return {};
    const std::size_t begin = next_;
    if (kMarks.find(text_[begin]) != std::string_view::npos) {
        ++next_;
    } else if (text_[begin] == '"') {
        const std::size_t end = text_.find('"', begin + 1);
        next_ = end == std::string::npos ? text_.size() : end + 1;
    } else {
        while (next_ < text_.size() && !is_space(text_[next_]) && kMarks.find(text_[next_]) == std::string_view::npos) ++next_;
    }
    return std::string_view(text_).substr(begin, next_ - begin);
}

void FoamText::expect(std::string_view mark) {
    const std::string_view found = token();
    if (found != mark) {
        fail(in_quotes(std::string(mark)) + " is expected" +
             (found.empty() ? ", not the end of the file" : ", not " + in_quotes(std::string(found))));
    }
}

double FoamText::number() {
    const std::string_view word = token();
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || end != word.data() + word.size() || error == std::errc::invalid_argument) {
        fail("a number is expected, not " + (word.empty() ? "the end of the file" : in_quotes(std::string(word))));
    }
    return value;
}

std::int64_t FoamText::label() {
    const std::string_view word = token();
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || end != word.data() + word.size() || error != std::errc()) {
        fail("an integer is expected, not " + (word.empty() ? "the end of the file" : in_quotes(std::string(word))));
    }
    return value;
}

std::size_t FoamText::count(std::size_t width, std::size_t expected) {
    const std::int64_t count = label();
    const std::size_t room = std::max(expected, (text_.size() - next_) / width);
    if (count < 0 || static_cast<std::uint64_t>(count) > room) {
        fail("count out of range: " + std::to_string(count), "the file has " + counted(text_.size(), "byte", "bytes"));
    }
    return static_cast<std::size_t>(count);
}

std::string_view FoamText::bytes(std::size_t size) {
    if (size > text_.size() - next_) fail("unexpected end of file");
    next_ += size;
    return std::string_view(text_).substr(next_ - size, size);
}

void FoamText::read_header() {
    if (text_.empty()) fail("the file is empty");
    if (token() != "FoamFile") fail("not a file of OpenFOAM: it does not begin with FoamFile");
    expect("{");
    for (std::string_view key = token(); key != "}"; key = token()) {
        if (key.empty()) fail("the header does not end");
        const std::string_view value = token();
        if (key == "format") binary_ = value == "binary";
        if (key == "class") type_ = std::string(value);
        if (key == "arch") {
            if (value.find("MSB") != std::string_view::npos) order_ = std::endian::big;
            wide_labels_ = value.find("label=64") != std::string_view::npos;
            wide_reals_ = value.find("scalar=32") == std::string_view::npos;
        }
        for (std::string_view rest = value; rest != ";"; rest = token()) {
            if (rest.empty()) fail("the header does not end");
        }
    }
}

std::vector<std::int64_t> FoamText::labels() {
    const std::size_t width = size_of(label_type()), entries = count(binary_ ? width : 2);
    std::vector<std::int64_t> list;
    const std::string_view mark = token();
    if (mark == "{") {
        list.assign(entries, label());
        expect("}");
        return list;
    }
    if (mark != "(") fail("a list is expected");
    if (binary_) {
        list = integers_from(bytes(entries * width), label_type(), order_);
    } else {
        for (std::size_t i = 0; i < entries; ++i) list.push_back(label());
    }
    expect(")");
    return list;
}

void FoamText::read_tuple(std::size_t components, std::vector<double>& values) {
    if (components > 1) expect("(");
    for (std::size_t c = 0; c < components; ++c) values.push_back(number());
    if (components > 1) expect(")");
}

std::vector<double> FoamText::reals(std::size_t components, std::size_t expected) {
    const std::size_t width = components * size_of(real_type()), entries = count(binary_ ? width : 2 * components, expected);
    std::vector<double> list;
    const std::string_view mark = token();
    if (mark == "{") {
        std::vector<double> one;
        read_tuple(components, one);
        for (std::size_t i = 0; i < entries; ++i) list.insert(list.end(), one.begin(), one.end());
        expect("}");
        return list;
    }
    if (mark != "(") fail("a list is expected");
    if (binary_) {
        list = reals_from(bytes(entries * width), real_type(), order_);
    } else {
        list.reserve(entries * components);
        for (std::size_t i = 0; i < entries; ++i) read_tuple(components, list);
    }
    expect(")");
    return list;
}

FoamFaces FoamText::faces() {
    FoamFaces faces;
    if (type_ == "faceCompactList") {
        const auto starts = labels();
        faces.points = labels();
        for (std::size_t f = 0; f < starts.size(); ++f) {
            const std::int64_t last = f == 0 ? 0 : starts[f - 1];
            if (starts[f] < last || static_cast<std::size_t>(starts[f]) > faces.points.size() || (f == 0 && starts[f] != 0)) {
                fail("the start of face " + std::to_string(f) + " is " + std::to_string(starts[f]),
                     "from 0 to " + std::to_string(faces.points.size()) + ", never falling");
            }
            if (f > 0) faces.ends.push_back(static_cast<std::size_t>(starts[f]));
        }
        return faces;
    }
    if (binary_) fail("faces in binary of the class " + in_quotes(type_) + " are not supported", "faceCompactList is");
    const std::size_t entries = count(4);
    expect("(");
    for (std::size_t f = 0; f < entries; ++f) {
        const auto points = labels();
        faces.points.insert(faces.points.end(), points.begin(), points.end());
        faces.ends.push_back(faces.points.size());
    }
    expect(")");
    return faces;
}

template <class Entry>
void FoamText::each_entry(const Entry& entry) {
    const std::size_t dictionaries = count(2);
    expect("(");
    for (std::size_t k = 0; k < dictionaries; ++k) {
        const std::string name(token());
        expect("{");
        for (std::string key(token()); key != "}"; key = token()) {
            entry(name, key);
            int open = 0;
            for (std::string_view word = token(); word != ";" || open > 0; word = token()) {
                if (word.empty()) fail("the entry " + in_quotes(key) + " does not end");
                if (word == "{" || word == "(" || word == "[") ++open;
                if (word == "}" || word == ")" || word == "]") --open;
                if (word == "}" && open == 0) break;
            }
        }
    }
    expect(")");
}

std::vector<FoamPatch> FoamText::patches() {
    std::vector<FoamPatch> patches;
    each_entry([&](const std::string& name, std::string_view key) {
        if (patches.empty() || patches.back().name != name) patches.push_back({name});
        if (key == "nFaces") patches.back().count = label();
        if (key == "startFace") patches.back().first = label();
        if (key == "type") patches.back().type = token();
        if (key == "neighbProcNo") patches.back().neighbour = label();
        if (key == "inGroups") {
            const std::size_t begin = next_;  // read again as an entry
            for (std::string_view word = token(); word != ")" && word != ";" && !word.empty(); word = token()) {
                if (kMarks.find(word.front()) == std::string_view::npos) patches.back().groups.emplace_back(word);
            }
            next_ = begin;
        }
    });
    return patches;
}

std::vector<FoamZone> FoamText::zones(std::string_view wanted) {
    std::vector<FoamZone> zones;
    each_entry([&](const std::string& name, std::string_view key) {
        if (key != wanted) return;
        skip_space();
        if (next_ < text_.size() && (text_[next_] < '0' || text_[next_] > '9')) std::ignore = token();  // List<label>
        zones.push_back({name, labels()});
    });
    return zones;
}

// An entry is a word and what follows up to a semicolon, or a dictionary.
void FoamText::find_internal_field(int depth) {
    for (std::string_view word = token(); word != "internalField"; word = token()) {
        if (word.empty() && depth > 0) return;
        if (word.empty()) fail("there is no internalField");
        if (word == "#include" || word == "#includeIfPresent") {
            const std::string name(token());
            const std::size_t quotes = name.size() >= 2 && name.front() == '"' ? 1 : 0;
            include(std::filesystem::path(file_).parent_path() / name.substr(quotes, name.size() - 2 * quotes), depth);
            continue;
        }
        const std::string key(word);
        if (key.size() == 1 && kMarks.find(key[0]) != std::string_view::npos) continue;
        skip_space();
        const std::size_t begin = next_;
        int open = 0;
        for (word = token(); !word.empty(); word = token()) {
            if (word == "{" || word == "(") ++open;
            if (word == "}" || word == ")") --open;
            if (open <= 0 && (word == ";" || word == "}")) break;
        }
        if (!word.empty()) entries_[key] = text_.substr(begin, next_ - begin - 1);
    }
}

void FoamText::include(const std::filesystem::path& path, int depth) {
    constexpr int kDeepest = 16;
    constexpr std::uintmax_t kMostBytes = 1 << 20;
    std::error_code none;
    if (depth == kDeepest || !std::filesystem::is_regular_file(path, none)) return;
    if (std::filesystem::file_size(path, none) > kMostBytes) return;
    // What is included may be any list of entries, without a header.
    std::string outer_text = std::exchange(text_, read_text(path)), outer_file = std::exchange(file_, path.string());
    const std::size_t outer_next = std::exchange(next_, 0);
    find_internal_field(depth + 1);
    text_ = std::move(outer_text);
    file_ = std::move(outer_file);
    next_ = outer_next;
}

// The text with what its $names stand for.
std::string FoamText::expanded(std::string_view text) const {
    std::size_t left = kMostExpanded;
    return expanded(text, 0, left);
}

std::string FoamText::expanded(std::string_view text, int depth, std::size_t& left) const {
    constexpr int kDeepest = 16;
    std::string result;
    while (!text.empty()) {
        const std::size_t dollar = text.find('$');
        result += text.substr(0, dollar);
        if (dollar == std::string_view::npos) break;
        text.remove_prefix(dollar + 1);
        const bool braces = text.starts_with('{');
        if (braces || text.starts_with(':')) text.remove_prefix(1);
        const std::size_t end = std::min(text.find_first_of(" \t\r\n;(){}"), text.size());
        const auto entry = entries_.find(text.substr(0, end));
        if (entry == entries_.end() || depth == kDeepest)
            fail("there is no entry " + in_quotes("$" + std::string(text.substr(0, end))));
        if (left == 0) fail("its entries stand for too much");
        --left;
        result += expanded(entry->second, depth + 1, left);
        text.remove_prefix(std::min(text.size(), end + braces));
        if (result.size() > kMostExpanded) fail("its entries stand for too much");
    }
    return result;
}

std::vector<double> FoamText::uniform_value(std::size_t components) {
    skip_space();
    const std::size_t begin = next_;
    const std::size_t end = std::min(text_.find(';', begin), text_.size());
    std::string value = expanded(std::string_view(text_).substr(begin, end - begin));
    next_ = end;
    std::ranges::replace_if(
        value, [](char c) { return c == '(' || c == ')'; }, ' ');
    TextScanner words(value, file_, TextScanner::Comments::None);
    std::vector<double> one;
    while (!words.at_end()) {
        const std::string_view word = words.word();
        double number = 0;
        const auto [last, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        if (last != word.data() + word.size() || error == std::errc::invalid_argument) {
            fail("a number is expected, not " + in_quotes(word));
        }
        one.push_back(number);
    }
    if (one.size() != components)
        fail("the uniform value has " + counted(one.size(), "number", "numbers"), std::to_string(components));
    return one;
}

namespace {

/// "m²", "s^-0.5"; the sign is left out where the power is below a fraction bar.
std::string power_text(std::string_view name, double power) {
    constexpr std::array<std::string_view, 5> kRaised{"", "", "²", "³", "⁴"};
    std::string text(name);
    if (power == 1) return text;
    if (power >= 2 && power <= 4 && power == std::floor(power))
        return text + std::string(kRaised[static_cast<std::size_t>(power)]);
    return text + "^" + number_text(power, 3);
}

}  // namespace

// Powers of kg, m, s, K, mol, A, cd.
std::string FoamText::unit() const {
    constexpr std::array<std::string_view, 7> kNames{"kg", "m", "s", "K", "mol", "A", "cd"};
    const auto entry = entries_.find("dimensions");
    if (entry == entries_.end()) return {};
    std::string words = entry->second;
    std::ranges::replace_if(
        words, [](char c) { return c == '[' || c == ']'; }, ' ');
    TextScanner in(words, file_, TextScanner::Comments::None);
    std::array<double, 7> powers{};
    for (std::size_t k = 0; k < powers.size() && !in.at_end(); ++k) {
        const std::string_view word = in.word();
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), powers[k]);
        if (end != word.data() + word.size() || error != std::errc() || !std::isfinite(powers[k])) return {};
    }
    if (powers == std::array<double, 7>{1, -1, -2}) return "Pa";
    std::string above, below;
    std::size_t of_below = 0;
    for (std::size_t k = 0; k < powers.size(); ++k) {
        if (powers[k] > 0) above += (above.empty() ? "" : " ") + power_text(kNames[k], powers[k]);
        if (powers[k] < 0) below += (below.empty() ? "" : " ") + power_text(kNames[k], -powers[k]);
        of_below += powers[k] < 0;
    }
    if (below.empty()) return above;
    return (above.empty() ? "1" : above) + "/" + (of_below > 1 ? "(" + below + ")" : below);
}

std::vector<double> FoamText::internal_field(std::size_t components, std::size_t cells) {
    find_internal_field(0);
    std::string_view kind = token();
    if (kind.starts_with('$')) {
        const std::size_t end = std::min(text_.find(';', next_), text_.size());
        text_ = expanded(std::string(kind) + text_.substr(next_, end - next_)) + text_.substr(end) + ";";
        next_ = 0;
        kind = token();
    }
    std::vector<double> values;
    if (kind == "uniform") {
        entries_["internalField"] = "uniform " + text_.substr(next_, std::min(text_.find(';', next_), text_.size()) - next_);
        const std::vector<double> one = uniform_value(components);
        for (std::size_t c = 0; c < cells; ++c) values.insert(values.end(), one.begin(), one.end());
        return values;
    }
    if (kind != "nonuniform") fail("the internalField is " + in_quotes(std::string(kind)), "uniform or nonuniform");
    skip_space();
    if (next_ < text_.size() && (text_[next_] < '0' || text_[next_] > '9')) std::ignore = token();  // List<vector>
    values = reals(components, cells);
    if (values.size() != cells * components) {
        fail("the internalField has " + counted(values.size() / components, "value", "values"),
             "the mesh has " + counted(cells, "cell", "cells"));
    }
    return values;
}

}  // namespace subvol::detail
