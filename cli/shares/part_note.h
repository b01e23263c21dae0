// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "share.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The name of the note in metadata.
inline constexpr const char* kPartNote = "subvol_part";

/// What the file of a part says about itself, so that `join` takes only parts that belong together.
struct PartNote {
    Share share;
    std::string verb, input;
    std::string task;  ///< a hash of the verb, its options, the input and the version: the same for all shares
    /// What the part has of the work: parts of builds that divide it differently do not fit together.
    std::optional<ShareRange> range{};
    nlohmann::ordered_json how = nlohmann::ordered_json::object();  ///< what `join` must know to write the whole
};

/// The note of a share. app: the verb, whose options have been parsed; those that do not change the result do not count
[[nodiscard]] PartNote make_note(const CLI::App& app, const std::string& input, const Share& share,
                                 std::optional<ShareRange> range = {},
                                 nlohmann::ordered_json how = nlohmann::ordered_json::object());

/// One line of JSON.
[[nodiscard]] std::string text_of(const PartNote& note);

/// file:   named in the error
/// throws: Error(InvalidInput) if the text is not a note
[[nodiscard]] PartNote note_from(const std::string& text, const std::string& file);

/// The error of a note that `join` cannot use.
[[noreturn]] void fail_note(const std::string& file);

/// What a note says about how the whole is written, or `otherwise` if it does not say it.
///
/// throws: Error(InvalidInput) naming the file if it is of another type
template <class Value>
[[nodiscard]] Value how_of(const nlohmann::ordered_json& how, const char* key, Value otherwise, const std::string& file) {
    if (!how.contains(key)) return otherwise;
    try {
        return how[key].get<Value>();
    } catch (const nlohmann::json::exception&) {
        fail_note(file);
    }
}

/// A file, and the part that it says it is.
struct FoundPart {
    std::string file;
    PartNote note;
};

/// The order of parts: the indices of 1/N, 2/N and so on.
///
/// throws: Error(InvalidInput) if one belongs to other work, occurs twice or is missing, or if their ranges do not follow each
///         other
[[nodiscard]] std::vector<std::size_t> order_of(std::span<const FoundPart> parts);

/// The error of a file that is not a part.
[[noreturn]] void refuse_whole(const std::string& file);

}  // namespace subvol::cli
