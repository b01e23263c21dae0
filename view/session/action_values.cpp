// SPDX-License-Identifier: Apache-2.0
#include "action_values.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/near_name.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

[[noreturn]] void refuse(const Json& value, const std::string& right) {
    throw Error(ErrorCode::InvalidInput,
                shortened(value.dump(-1, ' ', false, Json::error_handler_t::replace)) + " is not right", {}, right);
}

}  // namespace

double number(const Json& value, double least, double most) {
    const std::string right = "a number from " + number_text(least) + " to " + number_text(most);
    if (!value.is_number()) refuse(value, right);
    const double read = value.get<double>();
    if (!(read >= least && read <= most)) refuse(value, right);
    return read;
}

int whole_number(const Json& value, int least, int most) {
    const double read = number(value, least, most);
    if (read != std::floor(read)) refuse(value, "a whole number");
    return static_cast<int>(read);
}

std::vector<double> numbers(const Json& value, std::size_t count) {
    const std::string right = "an array of " + std::to_string(count) + " numbers";
    if (!value.is_array() || value.size() != count) refuse(value, right);
    std::vector<double> read;
    for (const Json& one : value) {
        if (!one.is_number()) refuse(value, right);
        read.push_back(one.get<double>());
        if (!std::isfinite(read.back()) || std::abs(read.back()) > 1e18) refuse(value, "numbers of at most 1e18");
    }
    return read;
}

Vec3 vector(const Json& value) {
    const std::vector<double> n = numbers(value, 3);
    return {n[0], n[1], n[2]};
}

bool flag(const Json& value) {
    if (!value.is_boolean()) refuse(value, "true or false");
    return value.get<bool>();
}

std::string word(const Json& value) {
    if (!value.is_string()) refuse(value, "a text in quotes");
    return value.get<std::string>();
}

std::string readable_word(const Json& value) {
    std::string read = word(value);
    constexpr std::string_view kEnd = ".json";  // after it a colour map of the file may be named
    const std::size_t end = read.find(kEnd);
    if (end == std::string::npos) return read;  // the name of a preset
    const std::string file = read.substr(0, end + kEnd.size());
    if (!not_regular(file).empty()) throw Error(ErrorCode::InvalidInput, "is not a regular file", file);
    return read;
}

std::string word_of(const Json& value, const std::vector<std::string>& words) {
    const std::string read = word(value);
    if (std::ranges::find(words, read) != words.end()) return read;
    std::string all;
    for (const std::string& one : words) all += (all.empty() ? "" : ", ") + one;
    throw Error(ErrorCode::InvalidInput, in_quotes(read) + " is not known" + did_you_mean(read, words), {}, all);
}

const Json& member(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) throw Error(ErrorCode::InvalidInput, std::string("the key '") + key + "' is missing");
    return *found;
}

void check_keys(const Json& value, std::initializer_list<const char*> keys) {
    std::vector<std::string> known(keys.begin(), keys.end());
    std::string all;
    for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
    if (!value.is_object()) refuse(value, "an object with " + all);
    for (const auto& [key, ignored] : value.items()) {
        if (std::ranges::find(known, key) != known.end()) continue;
        throw Error(ErrorCode::InvalidInput, "the key " + in_quotes(key) + " is not known" + did_you_mean(key, known), {}, all);
    }
}

}  // namespace subvol::detail
