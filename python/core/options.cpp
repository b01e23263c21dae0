// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <iterator>
#include <set>
#include <type_traits>

#include "bind.h"
#include "subvol/detail/number_text.h"
#include "subvol/option.h"

namespace subvol::python {
namespace {

/// A value as C++ has it. throws: TypeError for another type
template <class T>
T value_as(const py::handle& given, const std::string& key, const char* needed) {
    try {
        // Python takes True for 1, which a distance or a count was not meant to be.
        if (!std::is_same_v<T, bool> && py::isinstance<py::bool_>(given)) throw py::cast_error();
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
    /// A dictionary is the definition of a kernel.
    void operator()(const WordValue& word) const {
        if (word.numbers && !py::isinstance<py::str>(given)) {
            return word.set(detail::exact_text(value_as<double>(given, key, "a number or text")), key);
        }
        const bool defines = py::hasattr(given, "keys");
        const py::object text = defines ? py::module_::import("json").attr("dumps")(py::dict(given.attr("items")()))
                                        : py::reinterpret_borrow<py::object>(given);
        word.set(value_as<std::string>(text, key, "text"), key);
    }
    /// A row, or several.
    void operator()(const NumbersValue& rows) const {
        const Error otherwise(ErrorCode::InvalidInput, "is not a row of " + std::to_string(rows.count) + " numbers", key,
                              rows.example);
        py::array array = array_from(given, otherwise);
        const auto columns = py::ssize_t(rows.count);
        if (array.ndim() == 1 && array.size() == columns) array = array.reshape({py::ssize_t(1), columns});
        if (array.ndim() != 2 || array.shape(1) != columns || (array.shape(0) > 1 && !rows.repeatable)) throw otherwise;
        const auto numbers = rows_of<double>(array, columns, key);
        for (py::ssize_t row = 0; row < numbers.shape(0); ++row)
            rows.add(std::span(numbers.data() + row * columns, rows.count), key);
    }
    template <class Number>
    void operator()(Number*) const {
        option.set(value_as<double>(given, key, "a number"), key);
    }
};

/// The type of a value, as the stubs name it.
struct TypeName {
    const Option& option;

    std::string operator()(const bool*) const { return "bool"; }
    std::string operator()(const std::string*) const { return "str"; }
    std::string operator()(const std::vector<std::string>*) const { return "Sequence[str]"; }
    std::string operator()(const std::optional<std::string>*) const { return "Optional[str]"; }
    std::string operator()(const WordValue& word) const {
        if (word.numbers) return option.text().empty() ? "Optional[Union[float, str]]" : "Union[float, str]";
        return option.words.empty() ? "Kernel" : "str";
    }
    std::string operator()(const NumbersValue&) const { return "Optional[npt.ArrayLike]"; }
    template <class Number>
    std::string operator()(const Number*) const {
        const std::string name = option.is_whole() ? "int" : "float";
        return option.is_optional() ? "Optional[" + name + "]" : name;
    }
};

py::object default_of(const Option& option) {
    if (std::holds_alternative<bool*>(option.value)) return py::bool_(!option.text().empty());
    if (std::holds_alternative<std::vector<std::string>*>(option.value)) return py::tuple();
    if (option.is_optional() || std::holds_alternative<NumbersValue>(option.value)) return py::none();
    if (option.is_whole()) return py::int_(py::str(option.text()));
    if (option.is_number()) return py::float_(py::str(option.text()));
    const auto* const word = std::get_if<WordValue>(&option.value);
    if (word != nullptr && word->numbers && option.text().empty()) return py::none();
    return py::str(option.text());
}

/// What an option may be besides its type, and when it has an effect.
///
/// has: whether the call has an option; others are of the command
py::list conditions_of(const Option& option, const std::function<bool(const std::string&)>& has) {
    py::list all;
    if (const std::string range = option.range_text(); !range.empty()) all.append(range);
    std::string words, others;
    for (const std::string& word : option.words) words += (words.empty() ? "" : ", ") + word;
    if (!words.empty()) all.append(words);
    for (const OptionNeed& need : option.needs) {
        if (has(need.option)) all.append(need_text(need, OptionNames::Keywords));
    }
    for (const std::string& other : option.excludes) {
        if (has(other)) others += (others.empty() ? "not with " : ", ") + option_name(other, OptionNames::Keywords);
    }
    if (!others.empty()) all.append(others);
    return all;
}

}  // namespace

void set_options(const std::vector<Option>& options, const py::dict& given, const std::vector<std::string>& besides) {
    std::set<std::string> changed;  // a default has no effect to be refused
    for (const auto& [name, value] : given) {
        const auto key = py::str(name).cast<std::string>();
        const auto option = std::ranges::find(options, key, &Option::key);
        if (option == options.end()) throw py::type_error("'" + key + "' is an unexpected keyword");
        if (value.is_none()) continue;  // the default
        const std::string before = option->text();
        std::visit(SetValue{*option, value, key}, option->value);
        if (option->text() != before || std::holds_alternative<NumbersValue>(option->value)) changed.insert(option->name);
    }
    const auto text_of = [&](std::string_view name) -> std::optional<std::string> {
        if (std::ranges::find(besides, name) != besides.end()) return std::string();
        if (!changed.contains(std::string(name))) return std::nullopt;
        return std::ranges::find(options, name, &Option::name)->text();
    };
    check_needs(options, text_of, OptionNames::Keywords);
}

void describe(py::module_& module, const char* call, const std::vector<Option>& options,
              const std::vector<std::string>& besides) {
    if (!py::hasattr(module, "keywords")) module.attr("keywords") = py::dict();
    const auto has = [&](const std::string& name) {
        return std::ranges::find(besides, name) != besides.end() ||
               std::ranges::find(options, name, &Option::name) != options.end();
    };
    py::list all;
    for (const Option& option : options) {
        all.append(py::make_tuple(option.key(), std::visit(TypeName{option}, option.value), default_of(option),
                                  option.meaning(OptionNames::Keywords), conditions_of(option, has)));
    }
    module.attr("keywords")[call] = all;
}

Scheme scheme_named(const std::string& name) {
    if (!find_named<Scheme>(name) && find_named<TetScheme>(name)) {
        throw Error(ErrorCode::InvalidInput, "'" + name + "' refines tetrahedra, and this call has hexahedra only", "scheme",
                    "scheme='linear' of subdivide(mesh, 2, '" + name + "', on_limit=True)");
    }
    return named<Scheme>(name, "scheme");
}

std::vector<Option> scheme_and(SchemeOptions& scheme, std::vector<Option> others) {
    std::vector<Option> all = options_of(scheme);
    all.front().value = WordValue{[&scheme] { return std::string(name_of(scheme.kind)); },
                                  [&scheme](const std::string& name, const std::string&) { scheme.kind = scheme_named(name); }};
    std::ranges::move(others, std::back_inserter(all));
    return all;
}

std::vector<Option> options_of(GivenScheme& scheme) {
    std::vector<Option> all = options_of(scheme.rules);
    all.front().value = &scheme.name;
    all.front().sentence += "; of tetrahedra as tetrahedra: tetoct, boxspline";
    for (const std::string& name : names_of<TetScheme>()) {
        if (!find_named<Scheme>(name)) all.front().words.push_back(name);
    }
    return all;
}

std::optional<TetScheme> GivenScheme::tets() const {
    return find_named<Scheme>(name) ? std::nullopt : find_named<TetScheme>(name);
}

SchemeOptions GivenScheme::hexes() const {
    SchemeOptions scheme = rules;
    scheme.kind = named<Scheme>(name, "scheme");
    return scheme;
}

}  // namespace subvol::python
