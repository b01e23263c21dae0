// SPDX-License-Identifier: Apache-2.0
#include "part_note.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

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

/// FNV-1a
class Hash {
public:
    void add(std::string_view text) {
        for (const char c : text) value_ = (value_ ^ static_cast<unsigned char>(c)) * 1099511628211U;
        value_ = (value_ ^ 0xffU) * 1099511628211U;  // so that "ab", "c" differs from "a", "bc"
    }
    [[nodiscard]] std::string digits() const { return text(std::hex, std::setw(16), std::setfill('0'), value_); }

private:
    std::uint64_t value_ = 14695981039346656037U;
};

/// Adds the size and the two ends of a file: the whole of it may be larger than what a share reads.
void add_file(const fs::path& path, Hash& hash) {
    std::error_code none;
    const auto size = fs::file_size(path, none);
    if (none) return;
    hash.add(std::to_string(size));
    std::ifstream file(path, std::ios::binary);
    std::string bytes(std::min<std::uintmax_t>(size, kLooked), '\0');
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    hash.add(bytes);
    if (size <= kLooked) return;
    file.seekg(static_cast<std::streamoff>(size - bytes.size()));
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    hash.add(bytes);
}

void add_input(const std::string& input, Hash& hash) {
    std::error_code none;
    hash.add(fs::path(input).filename().string());
    if (fs::is_regular_file(input, none)) add_file(input, hash);
    const fs::path index = fs::path(input) / "index.json";  // of bricks
    if (fs::is_regular_file(index, none)) add_file(index, hash);
}

std::string task_of(const CLI::App& app, const std::string& input) {
    Hash hash;
    hash.add(app.get_name());
    hash.add(SUBVOL_VERSION);
    add_input(input, hash);
    for (const CLI::Option* option : app.get_options()) {
        const std::string name = option->get_name();
        const auto same = [&](const char* other) { return name == other; };
        if (option->count() == 0 || option->get_positional() || std::ranges::any_of(kNotOfTheTask, same)) continue;
        hash.add(name);
        for (const std::string& value : option->results()) hash.add(value);
    }
    return hash.digits();
}

}  // namespace

PartNote make_note(const CLI::App& app, const std::string& input, const Share& share, Json how) {
    return {.share = share, .verb = app.get_name(), .input = input, .task = task_of(app, input), .how = std::move(how)};
}

std::string text_of(const PartNote& note) {
    const Json json{{"part", note.share.part}, {"of", note.share.of}, {"verb", note.verb},
                    {"input", note.input},     {"task", note.task},   {"how", note.how}};
    // Only ASCII, so that it can be a comment in any format of files.
    return json.dump(-1, ' ', true, Json::error_handler_t::replace);
}

PartNote note_from(const std::string& text, const std::string& file) {
    const Json json = Json::parse(text, nullptr, false);
    const auto is_text = [&](const char* key) { return json.contains(key) && json[key].is_string(); };
    const auto is_number = [&](const char* key) { return json.contains(key) && json[key].is_number_integer(); };
    const bool proper = json.is_object() && is_number("part") && is_number("of") && is_text("verb") && is_text("input") &&
                        is_text("task") && json.contains("how") && json["how"].is_object();
    if (!proper) throw Error(ErrorCode::InvalidInput, "its note of the part that it is cannot be read", file);
    PartNote note{.share = {json["part"].get<int>(), json["of"].get<int>()},
                  .verb = json["verb"].get<std::string>(),
                  .input = json["input"].get<std::string>(),
                  .task = json["task"].get<std::string>(),
                  .how = json["how"]};
    const Share& share = note.share;
    if (share.of < 1 || share.part < 1 || share.part > share.of) {
        throw Error(ErrorCode::InvalidInput, "says to be part " + share.name() + ", which cannot be", file);
    }
    return note;
}

std::vector<std::size_t> order_of(std::span<const FoundPart> parts) {
    const FoundPart& first = parts.front();
    std::vector<std::size_t> order(static_cast<std::size_t>(first.note.share.of), parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto& [file, note] = parts[i];
        if (note.verb != first.note.verb || note.task != first.note.task) {
            throw Error(ErrorCode::InvalidInput,
                        "belongs to other work than " + first.file + ": the verb, the input, an option or the version differs",
                        file);
        }
        if (note.share.of != first.note.share.of) {
            throw Error(ErrorCode::InvalidInput,
                        text("is one of ", note.share.of, " parts, but ", first.file, " is one of ", first.note.share.of),
                        file);
        }
        std::size_t& place = order[static_cast<std::size_t>(note.share.part - 1)];
        if (place != parts.size()) {
            throw Error(ErrorCode::InvalidInput,
                        text("is part ", note.share.name(), ", and so is ", parts[place].file, ": each is needed once"), file);
        }
        place = i;
    }
    std::vector<std::string> missing;
    for (std::size_t p = 0; p < order.size(); ++p) {
        if (order[p] == parts.size()) missing.push_back(text(p + 1, "/", order.size()));
    }
    if (missing.empty()) return order;
    constexpr std::size_t kNamed = 8;
    const std::size_t count = missing.size();
    if (count > kNamed) {
        missing.resize(kNamed);
        missing.push_back(text("and ", count - kNamed, " more"));
    }
    throw Error(ErrorCode::InvalidInput,
                text(count == 1 ? "part " : "parts ", join(missing), " of this work ", count == 1 ? "is" : "are", " missing"),
                "join", "all parts, as --part made them");
}

void refuse_whole(const std::string& file) {
    throw Error(ErrorCode::InvalidInput, "is not a part: it was not written with --part", file);
}

}  // namespace subvol::cli
