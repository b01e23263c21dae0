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

/// The type of a key's value. Whole: a whole number in [least, most]. Number: in (least, most]. KernelShape: a kernel's name or
/// JSON. Described: a number that the option's description allows, or one of
/// its words
enum class KeyKind { Switch, Whole, Number, Text, KernelShape, Described };

struct Key {
    std::string name;
    KeyKind kind = KeyKind::Text;
    double least = 0, most = 0;
    std::optional<StudyValue> fallback{};  ///< the value where the key is missing; none: the key stays absent
    std::vector<std::string> choices{};    ///< the values that a text may have; empty: any text
    std::optional<Option> option{};  ///< the description from which the key was made; it refers to a value that reading changes
};

/// The key of an option. fallback: as of Key
[[nodiscard]] Key key_of(const Option& option, std::optional<StudyValue> fallback = {});

/// A method of a case and its options.
struct StudyMethod {
    std::string name;
    StudyKind kind;
    std::vector<Key> keys;

    [[nodiscard]] bool needs_mesh() const { return kind != StudyKind::Kernels; }
    [[nodiscard]] bool needs_view() const { return kind == StudyKind::Pictures; }
};

[[nodiscard]] StudyMethod find_method(const std::string& name, const std::string& path,
                                      std::span<const PictureMethod> pictures);

/// All methods: those of pictures, then the others.
[[nodiscard]] std::vector<StudyMethod> all_methods(std::span<const PictureMethod> pictures);

/// Refuses keys of a case that have no effect with its others. given: the object from which the case was read
void check_needs(const StudyMethod& method, const StudyValues& values, const Json& given, const std::string& path);

/// throws: Error(InvalidInput) "PATH: MESSAGE"
[[noreturn]] void refuse(const std::string& path, const std::string& message, const std::string& allowed = {});

/// "must be TYPE, not …" with the type of the value.
[[nodiscard]] std::string must_be(const std::string& type, const Json& json);

/// The path of a member or an element.
[[nodiscard]] std::string in(const std::string& path, const std::string& key);
[[nodiscard]] std::string at(const std::string& path, std::size_t index);

/// throws: Error(InvalidInput) if it is not an object, or has a key that is not among `known`
void check_object(const Json& json, const std::string& path, std::span<const std::string> known);

[[nodiscard]] std::string read_text(const Json& json, const std::string& path);
[[nodiscard]] StudyValue read_value(const Json& json, const Key& key, const std::string& path);

/// Reads an object of `keys` (others, named in `besides`, are ignored); lists among its values are expanded into their product,
/// in which the last key changes fastest.
[[nodiscard]] std::vector<StudyValues> read_values(const Json& json, std::span<const Key> keys,
                                                   std::span<const std::string> besides, const std::string& path);

/// Reads the parts of a study that describe the report.
void read_presentation(const Json& json, const std::string& path, Study& study);

/// Refuses tables, plots and demands of keys that no case has, and those that would merge different cases.
///
/// unread:     methods of cases that are not in the study because of other mistakes: their keys are known, too
/// keys_alone: nothing else is checked, as there are other mistakes
void check_presentation(const Study& study, const std::string& root, const std::vector<StudyMethod>& unread, bool keys_alone);

/// The id of a case: a hash of its values, without those that are only shown.
[[nodiscard]] std::string case_id(const StudyValues& values);
[[nodiscard]] std::string hash_text(std::string_view bytes);

}  // namespace subvol::detail
