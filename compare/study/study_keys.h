// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/study.h"

namespace subvol::detail {

using Json = nlohmann::ordered_json;

/// What may stand under a key. Whole: in [least, most]. Number: in (least, most]. Kernel: a kernel's name or JSON.
enum class KeyKind { Switch, Whole, Number, Text, Kernel };

/// fallback: taken where the key is missing; none: the key stays out
/// choices:  of a text; empty: any
struct Key {
    const char* name;
    KeyKind kind = KeyKind::Text;
    double least = 0, most = 0;
    std::optional<StudyValue> fallback{};
    std::vector<std::string> choices{};
};

/// A method of a case and its options.
struct StudyMethod {
    const char* name;
    StudyKind kind;
    std::vector<Key> keys;

    [[nodiscard]] bool needs_mesh() const { return kind != StudyKind::Kernel; }
    [[nodiscard]] bool needs_view() const { return kind == StudyKind::Picture; }
};

[[nodiscard]] const std::vector<StudyMethod>& study_methods();
[[nodiscard]] const StudyMethod& find_method(const std::string& name, const std::string& path);

/// throws: Error(InvalidInput) "PATH: MESSAGE"
[[noreturn]] void refuse(const std::string& path, const std::string& message, const std::string& allowed = {});

/// The path of a member or an element.
[[nodiscard]] std::string in(const std::string& path, const std::string& key);
[[nodiscard]] std::string at(const std::string& path, std::size_t index);

/// throws: Error(InvalidInput) if it is no object, or has a key that is not among `known`
void check_object(const Json& json, const std::string& path, std::span<const std::string> known);

[[nodiscard]] std::string read_text(const Json& json, const std::string& path);
[[nodiscard]] StudyValue read_value(const Json& json, const Key& key, const std::string& path);

/// An object of `keys` (others, named in `besides`, are left alone); lists among its values are expanded into their product,
/// the last key changing fastest.
[[nodiscard]] std::vector<StudyValues> read_values(const Json& json, std::span<const Key> keys,
                                                   std::span<const std::string> besides, const std::string& path);

/// The parts of a study that are for the report.
void read_presentation(const Json& json, const std::string& path, Study& study);

/// The id of values: those that only name or compare are left out.
[[nodiscard]] std::string case_id(const StudyValues& values);
[[nodiscard]] std::string hash_text(std::string_view bytes);

}  // namespace subvol::detail
