// SPDX-License-Identifier: Apache-2.0
#include "study_keys.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/near_name.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/several_errors.h"
#include "subvol/error.h"
#include "subvol/kernel.h"
#include "subvol/option.h"

namespace subvol::detail {

namespace {

std::string joined(std::span<const std::string> names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

const char* type_of(const Json& json) {
    if (json.is_string()) return "a string";
    if (json.is_number()) return "a number";
    if (json.is_boolean()) return "a boolean";
    if (json.is_array()) return "a list";
    return json.is_object() ? "an object" : "nothing";
}

double read_number(const Json& json, const Key& key, const std::string& path) {
    const bool whole = key.kind == KeyKind::Whole;
    const std::string allowed = whole ? as_text(key.least) + " to " + as_text(key.most)
                                      : "more than " + as_text(key.least) + ", at most " + as_text(key.most);
    if (!json.is_number()) refuse(path, must_be("a number", json), allowed);
    const double value = json.get<double>();
    if (whole && value != std::floor(value)) refuse(path, json.dump() + " is not a whole number", allowed);
    const bool in_range = value <= key.most && (whole ? value >= key.least : value > key.least);
    if (!in_range) refuse(path, json.dump() + " is out of range", allowed);
    return value;
}

/// A kernel given as JSON is normalised, so that equal definitions give one case.
std::string read_kernel(const Json& json, const std::string& path) {
    try {
        if (json.is_object()) return to_json(kernel_from_json(json.dump()));
        std::string name = read_text(json, path);
        (void)named_kernel(name);
        return name;
    } catch (const Error& error) {
        const std::string message = error.what();
        if (message.starts_with(path)) throw;
        refuse(path, message);
    }
}

}  // namespace

std::string must_be(const std::string& type, const Json& json) {
    return "must be " + type + ", not " + type_of(json);
}

void refuse(const std::string& path, const std::string& message, const std::string& allowed) {
    throw Error(ErrorCode::InvalidInput, printable(message), printable(path), allowed);
}

std::string in(const std::string& path, const std::string& key) {
    return path + (path.ends_with(": ") ? "" : ".") + key;
}

std::string at(const std::string& path, std::size_t index) {
    return path + "[" + std::to_string(index) + "]";
}

void check_object(const Json& json, const std::string& path, std::span<const std::string> known) {
    if (!json.is_object()) refuse(path, must_be("an object", json));
    Mistakes mistakes;
    for (const auto& item : json.items()) {
        const std::string& key = item.key();
        if (std::ranges::find(known, key) != known.end()) continue;
        mistakes.none_in([&] {
            refuse(in(path, shortened(key)), "this key is unknown" + did_you_mean(key, {known.begin(), known.end()}),
                   joined(known));
        });
    }
    mistakes.check();
}

std::string read_text(const Json& json, const std::string& path) {
    if (!json.is_string()) refuse(path, must_be("a string", json));
    auto text = json.get<std::string>();
    if (text.empty()) refuse(path, "the string is empty");
    return text;
}

StudyValue read_value(const Json& json, const Key& key, const std::string& path) {
    switch (key.kind) {
        case KeyKind::Switch:
            if (!json.is_boolean()) refuse(path, must_be("a boolean", json), "true or false");
            return json.get<bool>();
        case KeyKind::Whole:
        case KeyKind::Number:
            return read_number(json, key, path);
        case KeyKind::Described:
            if (const auto* word = std::get_if<WordValue>(&key.option->value)) {
                const bool is_text =
                    json.is_string() && std::ranges::find(key.choices, json.get<std::string>()) != key.choices.end();
                if (is_text) return json.get<std::string>();
                if (!json.is_number()) refuse(path, must_be("a number", json), "a number or " + joined(key.choices));
                word->set(exact_text(json.get<double>()), printable(path));
                return json.get<double>();
            }
            if (!json.is_number()) refuse(path, must_be("a number", json), key.option->range_text());
            key.option->set(json.get<double>(), printable(path));
            return json.get<double>();
        case KeyKind::KernelShape:
            return read_kernel(json, path);
        case KeyKind::Text:
            break;
    }
    const std::string text = read_text(json, path);
    if (!key.choices.empty() && std::ranges::find(key.choices, text) == key.choices.end()) {
        refuse(path, "'" + shortened(text) + "' is unknown" + did_you_mean(text, key.choices), joined(key.choices));
    }
    return text;
}

Key key_of(const Option& option, std::optional<StudyValue> fallback) {
    using enum KeyKind;
    const auto* const word = std::get_if<WordValue>(&option.value);
    const bool kernel = word != nullptr && option.words.empty();
    const KeyKind kind = std::holds_alternative<bool*>(option.value) ? Switch
                         : option.is_number()                        ? Described
                         : word != nullptr && word->numbers          ? Described
                         : kernel                                    ? KernelShape
                                                                     : Text;
    return {option.key(), kind, 0, 0, std::move(fallback), option.words, option};
}

void check_needs(const StudyMethod& method, const StudyValues& values, const Json& given, const std::string& path) {
    const auto key_named = [&](std::string_view option) {
        return std::ranges::find_if(method.keys, [&](const Key& key) { return key.option && key.option->name == option; });
    };
    const auto value_of = [&](std::string_view option) -> std::optional<std::string> {
        const auto key = key_named(option);
        if (key == method.keys.end() || !values.contains(key->name)) return std::nullopt;
        const StudyValue& value = values.at(key->name);
        return value == StudyValue(false) ? std::nullopt : std::optional(as_text(value));
    };
    const auto given_text = [&](std::string_view option) {
        const auto key = key_named(option);
        return key != method.keys.end() && given.contains(key->name) ? value_of(option) : std::nullopt;
    };
    const auto usual = [&](std::string_view option) {
        const auto value = value_of(option);
        const auto key = key_named(option);
        return value || key == method.keys.end() ? value : std::optional(key->option->text());
    };
    for (const Key& key : method.keys) {
        if (!key.option || !given_text(key.option->name)) continue;
        try {
            subvol::check_needs(*key.option, given_text, usual, OptionNames::Keywords);
        } catch (const Error& error) {
            refuse(in(path, error.where() == key.option->key() ? key.name : error.where()), error.message(), error.allowed());
        }
    }
}

std::vector<StudyValues> read_values(const Json& json, std::span<const Key> keys, std::span<const std::string> besides,
                                     const std::string& path) {
    std::vector<std::string> known(besides.begin(), besides.end());
    for (const Key& key : keys) known.emplace_back(key.name);
    if (!json.is_object()) refuse(path, must_be("an object", json));
    Mistakes mistakes;
    mistakes.none_in([&] { check_object(json, path, known); });
    std::vector<StudyValues> all(1);
    for (const Key& key : keys) {
        const auto found = json.find(key.name);
        if (found == json.end()) {
            if (!key.fallback) continue;
            for (StudyValues& values : all) values[key.name] = *key.fallback;
            continue;
        }
        const std::string place = in(path, key.name);
        std::vector<StudyValue> choices;
        if (found->is_array()) {
            mistakes.none_in([&] {
                if (found->empty()) refuse(place, "the list is empty");
            });
            for (std::size_t i = 0; i < found->size(); ++i)
                mistakes.none_in([&] { choices.push_back(read_value((*found)[i], key, at(place, i))); });
        } else {
            mistakes.none_in([&] { choices.push_back(read_value(*found, key, place)); });
        }
        if (!mistakes.empty()) continue;  // the rest is only checked
        if (all.size() * choices.size() > kMaxStudyCases) {
            refuse(place, "there are too many combinations", "at most " + std::to_string(kMaxStudyCases) + " cases");
        }
        std::vector<StudyValues> product;
        for (const StudyValues& values : all) {
            for (const StudyValue& choice : choices) product.emplace_back(values)[key.name] = choice;
        }
        all = std::move(product);
    }
    mistakes.check();
    return all;
}

}  // namespace subvol::detail
