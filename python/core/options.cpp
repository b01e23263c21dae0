// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>

#include "bind.h"
#include "subvol/option.h"

namespace subvol::python {
namespace {

/// A value as C++ has it. throws: TypeError for another type
template <class T>
T value_as(const py::handle& given, const std::string& key, const char* needed) {
    try {
        return given.cast<T>();
    } catch (const py::cast_error&) {
        throw py::type_error(key + ": " + needed + " is needed, not " +
                             std::string(py::str(py::type::of(given).attr("__name__"))));
    }
}

struct SetValue {
    const Option& option;
    const py::handle& given;
    const std::string& key;

    void operator()(bool* on) const { *on = value_as<bool>(given, key, "a truth value"); }
    void operator()(std::string* words) const { *words = value_as<std::string>(given, key, "text"); }
    void operator()(std::vector<std::string>* list) const {
        *list = value_as<std::vector<std::string>>(given, key, "a list of texts");
    }
    void operator()(std::optional<std::string>* words) const { *words = value_as<std::string>(given, key, "text"); }
    void operator()(const WordValue& word) const { word.set(value_as<std::string>(given, key, "text"), key); }
    template <class Number>
    void operator()(Number*) const {
        option.set(value_as<double>(given, key, "a number"), key);
    }
};

}  // namespace

void set_option(const Option& option, const py::handle& value, const std::string& key) {
    if (!value.is_none()) std::visit(SetValue{option, value, key}, option.value);  // None is the default
}

void set_options(const std::vector<Option>& options, const py::kwargs& given) {
    for (const auto& [name, value] : given) {
        const auto key = py::str(name).cast<std::string>();
        const auto option = std::ranges::find(options, key, &Option::key);
        if (option == options.end()) throw py::type_error("'" + key + "' is an unexpected keyword");
        set_option(*option, value, key);
    }
}

std::vector<Option> scheme_and(SchemeOptions& scheme, std::vector<Option> others) {
    std::vector<Option> all = options_of(scheme);
    all.front().value = WordValue{[&scheme] { return std::string(name_of(scheme.kind)); },
                                  [&scheme](const std::string& name, const std::string&) { scheme.kind = scheme_named(name); }};
    std::ranges::move(others, std::back_inserter(all));
    return all;
}

}  // namespace subvol::python
