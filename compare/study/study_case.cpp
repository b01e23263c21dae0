// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "study_keys.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol {

namespace {

template <class T>
const T& value_of(const StudyCase& study_case, const std::string& key, const T& otherwise) {
    const auto found = study_case.values.find(key);
    if (found == study_case.values.end()) return otherwise;
    if (const T* value = std::get_if<T>(&found->second)) return *value;
    throw Error(ErrorCode::InvalidInput, "the value has another type", key);
}

/// Names chosen by people and numbers known from elsewhere: they do not influence the result.
bool only_shown(const std::string& key) {
    return key == "study" || key == "input" || key == "view" || key == "tf" || key == "label" || key.starts_with("given.");
}

StudyValue value_from(const detail::Json& json) {
    if (json.is_boolean()) return json.get<bool>();
    if (json.is_number()) return json.get<double>();
    return json.get<std::string>();
}

}  // namespace

const std::string& StudyCase::text(const std::string& key) const {
    static const std::string kNone;
    return value_of(*this, key, kNone);
}

double StudyCase::number(const std::string& key) const {
    return value_of(*this, key, 0.0);
}

bool StudyCase::flag(const std::string& key) const {
    return value_of(*this, key, false);
}

std::string as_text(const StudyValue& value) {
    if (const auto* words = std::get_if<std::string>(&value)) return *words;
    if (const auto* on = std::get_if<bool>(&value)) return *on ? "yes" : "no";
    const double number = std::get<double>(value);
    if (std::isnan(number)) return "nan";
    if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
    const bool count = number == std::floor(number) && std::abs(number) < 1e15;
    return count ? std::to_string(static_cast<std::int64_t>(number)) : detail::exact_text(number);
}

std::string detail::hash_text(std::string_view bytes) {
    std::uint64_t hash = 14695981039346656037U;  // FNV-1a
    for (const char c : bytes) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 1099511628211U;
    }
    std::array<char, 16> digits;
    const std::string_view found(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), hash, 16).ptr);
    return std::string(digits.size() - found.size(), '0').append(found);
}

std::string detail::case_id(const StudyValues& values) {
    std::string canonical = "subvol case 1\n";
    for (const auto& [key, value] : values) {
        if (!only_shown(key)) canonical += key + '\t' + std::to_string(value.index()) + '\t' + as_text(value) + '\n';
    }
    return hash_text(canonical);
}

std::optional<StudyCase> reference_of(const StudyCase& study_case) {
    if (!study_case.has("reference.method")) return {};
    StudyCase reference;
    for (const auto& [key, value] : study_case.values) {
        const bool scene = key == "input" || key.starts_with("input.") || key == "view" || key.starts_with("camera") ||
                           key.starts_with("tf") || key == "width" || key == "height";
        if (scene) reference.values[key] = value;
        if (key.starts_with("reference.")) reference.values[key.substr(10)] = value;
    }
    reference.values["repeat"] = 1.0;
    reference.id = detail::case_id(reference.values);
    reference.name = "reference_" + reference.text("input") + "_" + reference.text("view") + "_" + reference.text("tf");
    return reference;
}

std::string to_json(const StudyCase& study_case) {
    detail::Json values = detail::Json::object();
    for (const auto& [key, value] : study_case.values) std::visit([&, &name = key](const auto& v) { values[name] = v; }, value);
    return detail::Json{{"id", study_case.id}, {"name", study_case.name}, {"values", values}}.dump();
}

StudyCase study_case_from_json(std::string_view text) {
    try {
        const auto json = detail::Json::parse(detail::of_limited_depth(text, "study"));
        StudyCase made{.id = json.at("id").get<std::string>(), .name = json.at("name").get<std::string>(), .values = {}};
        for (const auto& [key, value] : json.at("values").items()) made.values[key] = value_from(value);
        return made;
    } catch (const nlohmann::json::exception& error) {
        throw Error(ErrorCode::InvalidInput, std::string("is not a case: ") + error.what(), "study");
    }
}

}  // namespace subvol
