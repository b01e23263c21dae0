// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "kernel_fields.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol {

namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& message, const std::string& allowed = {}) {
    throw Error(ErrorCode::InvalidInput, detail::printable(message), "kernel", allowed);
}

double number(const std::string& name, const json& item) {
    if (!item.is_number()) refuse("'" + name + "' is not a number");
    return item.get<double>();
}

void read(const std::string& name, const json& item, double& value) {
    value = number(name, item);
}

void read(const std::string& name, const json& item, std::size_t& value) {
    if (!item.is_number_unsigned()) refuse("'" + name + "' is not a non-negative integer");
    value = item.get<std::size_t>();
}

void read(const std::string& name, const json& item, std::vector<double>& values) {
    if (!item.is_array()) refuse("'" + name + "' is not an array of numbers");
    values.clear();
    for (const json& one : item) values.push_back(number(name, one));
}

json parse_object(std::string_view text) {
    json object;
    try {
        object = json::parse(detail::of_limited_depth(text));
    } catch (const json::exception& e) {
        refuse("not JSON: " + detail::parser_message(e.what()));
    }
    if (!object.is_object()) refuse("not an object", "{\"type\": \"gaussian\", \"sigma\": 0.43, …}");
    return object;
}

std::string all_types() {
    std::string all;
    for (const char* type : detail::kKernelTypes) all += (all.empty() ? "" : ", ") + std::string(type);
    return all;
}

/// A kernel of the named type with its defaults.
template <std::size_t I = 0>
Kernel default_kernel(const std::string& type) {
    if constexpr (I == std::variant_size_v<Kernel>) {
        refuse("there is no type '" + detail::shortened(type) + "'", all_types());
    } else {
        if (type == detail::kKernelTypes[I]) return Kernel(std::in_place_index<I>);
        return default_kernel<I + 1>(type);
    }
}

}  // namespace

std::string to_json(const Kernel& kernel) {
    validate(kernel);
    json object{{"type", detail::kKernelTypes[kernel.index()]}};
    Kernel copy = kernel;
    std::visit([&](auto& k) { detail::each_field(k, [&](const char* name, const auto& value) { object[name] = value; }); },
               copy);
    return object.dump();
}

Kernel kernel_from_json(std::string_view text) {
    json object = parse_object(text);
    const auto type = object.find("type");
    if (type == object.end() || !type->is_string()) refuse("it has no 'type'", all_types());
    Kernel kernel = default_kernel(type->get<std::string>());
    object.erase("type");
    const auto take = [&](const char* name, auto& value) {
        const auto found = object.find(name);
        if (found == object.end()) return;
        read(name, *found, value);
        object.erase(found);
    };
    std::visit([&](auto& k) { detail::each_field(k, take); }, kernel);
    if (!object.empty()) refuse("it has no field '" + object.begin().key() + "'");
    validate(kernel);
    return kernel;
}

}  // namespace subvol
