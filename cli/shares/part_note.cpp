// SPDX-License-Identifier: Apache-2.0
#include "part_note.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>

#include "subvol/detail/byte_hash.h"
#include "subvol/detail/json_depth.h"
#include "subvol/error.h"
#include "subvol/version.h"
#include "text.h"

namespace subvol::cli {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Options that change how a share is made or told, not what it is.
constexpr std::array<const char*, 8> kNotOfTheTask{"--part",  "--output",   "--threads", "--json",
                                                   "--quiet", "--progress", "--memory",  "--help"};
constexpr std::size_t kLooked = 1 << 16;  // bytes at a file's start and end that its identity depends on

/// Adds the size and the two ends of a file: the whole of it may be larger than what a share reads.
void add_file(const fs::path& path, detail::ByteHash& hash) {
    std::error_code none;
    const auto size = fs::file_size(path, none);
    if (none) return;
    hash.add_text(std::to_string(size));
    std::ifstream file(path, std::ios::binary);
    std::string bytes(std::min<std::uintmax_t>(size, kLooked), '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    hash.add_text(bytes);
    if (size <= kLooked) return;
    file.seekg(static_cast<std::streamoff>(size - bytes.size()));
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    hash.add_text(bytes);
}

void add_input(const std::string& input, detail::ByteHash& hash) {
    std::error_code none;
    hash.add_text(fs::path(input).filename().string());
    if (fs::is_regular_file(input, none)) add_file(input, hash);
    const fs::path index = fs::path(input) / "index.json";  // of bricks
    if (fs::is_regular_file(index, none)) add_file(index, hash);
}

std::string task_of(const CLI::App& app, const std::string& input) {
    detail::ByteHash hash;
    hash.add_text(app.get_name());
    hash.add_text(SUBVOL_VERSION);
    add_input(input, hash);
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_name();
        const auto same = [&](const char* other) { return name == other; };
        if (option->count() == 0 || option->get_positional() || std::ranges::any_of(kNotOfTheTask, same)) continue;
        hash.add_text(name);
        for (const std::string& value : option->results()) hash.add_text(value);
    }
    return detail::hex_digits(hash.value());
}

}  // namespace

PartNote make_note(const CLI::App& app, const std::string& input, const Share& share, std::optional<ShareRange> range,
                   Json how) {
    return {.share = share,
            .verb = app.get_name(),
            .input = input,
            .task = task_of(app, input),
            .range = range,
            .how = std::move(how)};
}

std::string text_of(const PartNote& note) {
    Json json{
        {"part", note.share.number}, {"of", note.share.count}, {"verb", note.verb}, {"input", note.input}, {"task", note.task}};
    if (note.range) json["range"] = {note.range->begin, note.range->end, note.range->count};
    json["how"] = note.how;
    // Only ASCII, so that it can be a comment in any format of files.
    return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

namespace {

/// Nothing if the note is of an earlier version, which did not say it.
std::optional<ShareRange> range_from(const Json& note, const std::string& file) {
    if (!note.contains("range")) return {};
    const Json& range = note["range"];
    const auto is_count = [](const Json& number) { return number.is_number_unsigned(); };
    if (!range.is_array() || range.size() != 3 || !std::ranges::all_of(range, is_count)) fail_note(file);
    return ShareRange{range[0].get<std::uint64_t>(), range[1].get<std::uint64_t>(), range[2].get<std::uint64_t>()};
}

}  // namespace

PartNote note_from(const std::string& text, const std::string& file) {
    const Json json = Json::parse(detail::of_limited_depth(text, file), nullptr, false);
    const auto is_text = [&](const char* key) { return json.contains(key) && json[key].is_string(); };
    const auto is_number = [&](const char* key) { return json.contains(key) && json[key].is_number_integer(); };
    const bool proper = json.is_object() && is_number("part") && is_number("of") && is_text("verb") && is_text("input") &&
                        is_text("task") && json.contains("how") && json["how"].is_object();
    if (!proper) fail_note(file);
    const auto part = json["part"].get<std::int64_t>(), of = json["of"].get<std::int64_t>();
    if (of < 1 || part < 1 || part > of || of > std::numeric_limits<int>::max()) {
        throw Error(ErrorCode::InvalidInput,
                    "says to be part " + std::to_string(part) + "/" + std::to_string(of) + ", which cannot be", file);
    }
    return {.share = {static_cast<int>(part), static_cast<int>(of)},
            .verb = json["verb"].get<std::string>(),
            .input = json["input"].get<std::string>(),
            .task = json["task"].get<std::string>(),
            .range = range_from(json, file),
            .how = json["how"]};
}

namespace {

void check_same_work(const FoundPart& part, const FoundPart& first) {
    if (part.note.verb != first.note.verb || part.note.task != first.note.task) {
        throw Error(ErrorCode::InvalidInput,
                    "belongs to other work than " + first.file + ": the verb, the input, an option or the version differs",
                    part.file);
    }
    if (part.note.share.count != first.note.share.count) {
        throw Error(
            ErrorCode::InvalidInput,
            text("is one of ", part.note.share.count, " parts, but ", first.file, " is one of ", first.note.share.count),
            part.file);
    }
}

/// order: of all parts
void check_ranges(std::span<const FoundPart> parts, std::span<const std::size_t> order) {
    const FoundPart& first = parts[order.front()];
    std::uint64_t next = 0;
    for (const std::size_t i : order) {
        const FoundPart& part = parts[i];
        bool fits = part.note.range.has_value() == first.note.range.has_value();
        if (const auto& range = part.note.range; fits && range) {
            fits = range->begin == next && range->end >= next && range->count == first.note.range->count &&
                   (i != order.back() || range->end == range->count);
            next = range->end;
        }
        if (fits) continue;
        throw Error(ErrorCode::InvalidInput,
                    "does not continue the parts before it: another build has divided the work differently", part.file,
                    "all parts of one build");
    }
}

/// numbers: of the parts that are there, ascending
[[noreturn]] void fail_missing(const std::vector<int>& numbers, int of) {
    constexpr std::size_t kNamed = 8;
    const std::size_t count = static_cast<std::size_t>(of) - numbers.size();
    std::vector<std::string> missing;
    auto next = numbers.begin();
    for (int p = 1; missing.size() < std::min(kNamed, count); ++p) {
        if (next != numbers.end() && *next == p) {
            ++next;
        } else {
            missing.push_back(text(p, "/", of));
        }
    }
    if (count > kNamed) missing.push_back(text("and ", count - kNamed, " more"));
    throw Error(ErrorCode::InvalidInput,
                text(count == 1 ? "part " : "parts ", join(missing), " of this work ", count == 1 ? "is" : "are", " missing"),
                "join", "all parts, as --part made them");
}

}  // namespace

std::vector<std::size_t> order_of(std::span<const FoundPart> parts) {
    for (const FoundPart& part : parts) check_same_work(part, parts.front());
    std::vector<std::size_t> order(parts.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto number = [&](std::size_t i) { return parts[i].note.share.number; };
    std::ranges::stable_sort(order, {}, number);
    if (const auto twice = std::ranges::adjacent_find(order, {}, number); twice != order.end()) {
        const FoundPart &one = parts[twice[0]], &other = parts[twice[1]];
        throw Error(ErrorCode::InvalidInput,
                    text("is part ", other.note.share.name(), ", and so is ", one.file, ": each is needed once"), other.file);
    }
    const int of = parts.front().note.share.count;
    if (order.size() == static_cast<std::size_t>(of)) {
        check_ranges(parts, order);
        return order;
    }
    std::vector<int> numbers;
    for (const std::size_t i : order) numbers.push_back(number(i));
    fail_missing(numbers, of);
}

void fail_note(const std::string& file) {
    throw Error(ErrorCode::InvalidInput, "its note of the part that it is cannot be read", file);
}

void refuse_whole(const std::string& file) {
    throw Error(ErrorCode::InvalidInput, "is not a part: it was not written with --part", file);
}

}  // namespace subvol::cli
