// SPDX-License-Identifier: Apache-2.0
// A quantity is read from left to right. Names, calls of functions of vectors and tensors, and components of both are terms:
// each is computed at all points first, and stands as a variable in what remains for muParser:
//
//     2*mises(S) + grad(T).x > `p 0`        →        2*v0 + v1 > v2
//
// A quantity that is one term keeps the channels of the term.
#include "subvol/quantity.h"
#include "subvol/detail/small_letters.h"
#include "subvol/detail/text_scanner.h"

#include <muParser.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "arithmetic.h"
#include "cell_quality.h"
#include "field_functions.h"
#include "limit_gradient.h"
#include "quantity_source.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/scalar_groups.h"
#include "subvol/error.h"
#include "tensor_functions.h"

namespace subvol {

using detail::applied;
using detail::channel_of;
using detail::joined;
using detail::Rule;

namespace {

constexpr std::array<std::string_view, 8> kDerivatives{"grad", "gradient", "div",       "divergence",
                                                       "curl", "rot",      "vorticity", "qcriterion"};

/// Functions that make a field of scalars.
constexpr std::array<std::string_view, 2> kMakers{"vector", "tensor"};

/// Words of other programs for functions of ours.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kOtherWords{{{"mag", "norm"},
                                                                                    {"magnitude", "norm"},
                                                                                    {"vonmises", "mises"},
                                                                                    {"von_mises", "mises"},
                                                                                    {"gradient", "grad"},
                                                                                    {"divergence", "div"},
                                                                                    {"rot", "curl"},
                                                                                    {"vorticity", "curl"}}};

/// Our word for a function, and for one of another program, in any case of letters.
std::string_view our_word(std::string_view word) {
    const auto* const other =
        std::ranges::find(kOtherWords, detail::small_letters(word), &std::pair<std::string_view, std::string_view>::first);
    return other == kOtherWords.end() ? word : other->second;
}

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/// Names that are not words stand in backquotes, or in single quotation marks.
bool is_quote(char c) {
    return c == '`' || c == '\'';
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

bool is_word(std::string_view text) {
    return !text.empty() && is_letter(text[0]) && std::ranges::all_of(text, [](char c) { return is_letter(c) || is_digit(c); });
}

std::vector<std::string> names_of(const HexMesh& mesh) {
    std::vector<std::string> names;
    for (const Attribute& attribute : mesh.attributes) names.push_back(attribute.name);
    return names;
}

bool is_ours(std::string_view word) {
    return detail::find_tensor_function(our_word(word)) != nullptr ||
           std::ranges::find(kDerivatives, word) != kDerivatives.end() || std::ranges::find(kMakers, word) != kMakers.end();
}

[[noreturn]] void refuse_name(const HexMesh& mesh, const std::string& name) {
    if (is_ours(name)) {
        throw Error(ErrorCode::InvalidInput, "'" + name + "' is a function, of a field in parentheses", {},
                    name + "(NAME); the mesh has " + (mesh.attributes.empty() ? "no fields" : detail::list_of(mesh)));
    }
    throw Error(ErrorCode::InvalidInput, "there is no field \"" + name + "\"" + detail::did_you_mean(name, names_of(mesh)), {},
                mesh.attributes.empty() ? "the mesh has no fields" : "the mesh has: " + detail::list_of(mesh));
}

/// The channel that a component's name or number means.
std::optional<std::size_t> channel_named(int channels, std::string_view component) {
    std::size_t number = 0;
    const char* const end = component.data() + component.size();
    const auto read = std::from_chars(component.data(), end, number);
    if (read.ec == std::errc() && read.ptr == end && number < static_cast<std::size_t>(channels)) return number;
    std::string name = detail::small_letters(component);
    const std::vector<std::string> names = component_names(channels);
    auto found = std::ranges::find(names, name);
    if (found == names.end() && channels == 6) {
        std::ranges::reverse(name);  // yx is xy
        found = std::ranges::find(names, name);
    }
    if (found == names.end()) return std::nullopt;
    return static_cast<std::size_t>(found - names.begin());
}

using Channels = std::span<const double>;

/// The sum of the derivatives of each component by its own direction, of the gradient of a vector.
Attribute divergence(const Attribute& gradient) {
    return applied(gradient, gradient.name, 1, Rule::Linear,
                   [](Channels g, std::span<double> to) { to[0] = g[0] + g[4] + g[8]; });
}

/// Half of what the squared rotation has beyond the squared strain: −tr(G²)/2 of the gradient G.
Attribute q_criterion(const Attribute& gradient) {
    return applied(gradient, gradient.name, 1, Rule::Nonlinear, [](Channels g, std::span<double> to) {
        to[0] = -(g[0] * g[0] + g[4] * g[4] + g[8] * g[8]) / 2 - (g[1] * g[3] + g[2] * g[6] + g[5] * g[7]);
    });
}

Attribute curl(const Attribute& gradient) {
    return applied(gradient, gradient.name, 3, Rule::Linear, [](Channels g, std::span<double> to) {
        to[0] = g[7] - g[5];
        to[1] = g[2] - g[6];
        to[2] = g[3] - g[1];
    });
}

/// Reads one quantity.
class Evaluation {
public:
    Evaluation(const HexMesh& mesh, const std::string& source, Progress* progress)
        : mesh_(mesh), source_(source), progress_(progress) {}

    /// The value of a part of the source.
    ///
    /// begin: where the part begins, for errors
    /// depth: of calls around it
    [[nodiscard]] Attribute value(std::string_view text, std::size_t begin, int depth = 0) const {
        constexpr int kDeepest = 64;
        if (depth > kDeepest) refuse("has more than " + std::to_string(kDeepest) + " calls in each other", begin);
        const std::string_view inner = detail::trimmed(text);
        if (!inner.empty()) begin += static_cast<std::size_t>(inner.data() - text.data());
        text = inner;
        if (text.empty()) refuse("is empty", begin);
        if (auto named = name(text)) return std::move(*named);
        std::size_t at = 0;
        if (is_quote(text[0]) || is_letter(text[0])) {
            auto whole = term(text, at, begin, depth);
            if (whole && at == text.size()) return std::move(*whole);
        }
        return arithmetic(text, begin, depth);
    }

    /// What a name alone means: a field, a component of a field, a measure of the cells, or a function of tensors where it has
    /// one that it can be of.
    [[nodiscard]] std::optional<Attribute> name(std::string_view text) const {
        if (auto field = detail::named_field(mesh_, text)) return field;
        if (auto component = component_of_field(text)) return component;
        if (auto quality = detail::cell_quality(mesh_, text)) return quality;
        const detail::TensorFunction* function = detail::find_tensor_function(our_word(text));
        const Attribute* tensor = function != nullptr && !function->sizes.empty() ? only_tensor() : nullptr;
        return tensor == nullptr ? std::nullopt : std::optional(applied(*tensor, *function));
    }

private:
    /// The stress of the mesh, or its tensor, if there is one alone; else null.
    [[nodiscard]] const Attribute* only_tensor() const {
        const auto only = [&](const auto& is_one) -> const Attribute* {
            if (std::ranges::count_if(mesh_.attributes, is_one) != 1) return nullptr;
            return &*std::ranges::find_if(mesh_.attributes, is_one);
        };
        if (const Attribute* stress = only(detail::is_stress)) return stress;
        return only([](const Attribute& field) { return field.channels == 6 || field.channels == 9; });
    }

    [[noreturn]] void refuse(const std::string& message, std::size_t position) const {
        std::string allowed = "numbers, functions and x, y, z";
        if (!mesh_.attributes.empty()) allowed += ", " + detail::list_of(mesh_);
        throw Error(ErrorCode::InvalidInput, message,
                    "expression '" + detail::shortened(source_) + "', position " + std::to_string(position), allowed);
    }

    /// NAME.x of any field, whatever its name; NAME_x, as files without vectors call it; U.magnitude, S.Mises, as other
    /// programs do.
    [[nodiscard]] std::optional<Attribute> component_of_field(std::string_view text) const {
        const std::size_t separator = text.find_last_of("._");
        if (separator == std::string_view::npos) return std::nullopt;
        const auto field = detail::named_field(mesh_, text.substr(0, separator));
        if (!field) return std::nullopt;
        if (const auto channel = channel_named(field->channels, text.substr(separator + 1))) {
            return channel_of(*field, *channel, std::string(text));
        }
        const auto* function = detail::find_tensor_function(our_word(detail::small_letters(text.substr(separator + 1))));
        if (function == nullptr || field->channels == 1 || !function->takes_channels(field->channels)) return std::nullopt;
        return applied(*field, *function);
    }

    /// The term at a place of the text, which moves behind it; nothing, and the place stays, if there is none.
    [[nodiscard]] std::optional<Attribute> term(std::string_view text, std::size_t& at, std::size_t begin, int depth) const {
        std::size_t end = at;
        if (is_quote(text[at])) {
            end = text.find(text[at], at + 1);
            if (end == std::string_view::npos) refuse(std::string("has no second ") + text[at], begin + at);
            const std::string name(text.substr(at + 1, end - at - 1));
            auto field = detail::named_field(mesh_, name);
            if (!field) refuse("there is no field \"" + name + "\"" + detail::did_you_mean(name, names_of(mesh_)), begin + at);
            at = end + 1;
            return with_component(std::move(*field), text, at, begin);
        }
        while (end < text.size() && (is_letter(text[end]) || is_digit(text[end]) || text[end] == '.')) ++end;
        const std::string_view word = text.substr(at, end - at);
        if (end < text.size() && text[end] == '(') {
            if (!is_ours(word)) return std::nullopt;
            const std::size_t close = closing(text, end, begin);
            const std::string_view inside = text.substr(end + 1, close - end - 1);
            Attribute result = std::ranges::find(kMakers, word) != kMakers.end()
                                   ? made(word, inside, begin + at, begin + end + 1, depth + 1)
                                   : call(our_word(word), value(inside, begin + end + 1, depth + 1), begin + at);
            at = close + 1;
            return with_component(std::move(result), text, at, begin);
        }
        if (word == "time") {
            if (!mesh_.time) refuse("the mesh has no time", begin + at);
            at = end;
            return Attribute{"time", 1, std::vector<double>(mesh_.points.size(), *mesh_.time)};
        }
        if (word == "x" || word == "y" || word == "z") {
            at = end;
            return coordinate(word[0] - 'x');
        }
        auto named = name(word);
        if (named) at = end;
        return named;
    }

    /// `.x` behind a term is its component.
    [[nodiscard]] Attribute with_component(Attribute field, std::string_view text, std::size_t& at, std::size_t begin) const {
        if (at + 1 >= text.size() || text[at] != '.') return field;
        std::size_t end = at + 1;
        while (end < text.size() && (is_letter(text[end]) || is_digit(text[end]))) ++end;
        const std::string_view component = text.substr(at + 1, end - at - 1);
        const auto channel = channel_named(field.channels, component);
        if (!channel) {
            std::string names;
            for (const std::string& name : component_names(field.channels)) names += (names.empty() ? "" : ", ") + name;
            const std::string kind =
                names.empty() ? "a scalar has no component ." : "its components are " + names + "; there is none called .";
            refuse(kind + std::string(component), begin + at);
        }
        at = end;
        return channel_of(field, *channel, field.name);
    }

    /// The first sign that is wanted, in no quotes; npos if there is none.
    ///
    /// wanted: of a sign and the number of parentheses that are open behind it
    template <class Wanted>
    [[nodiscard]] static std::size_t find_sign(std::string_view text, std::size_t from, const Wanted& wanted) {
        int depth = 0;
        char quote = 0;
        for (std::size_t at = from; at < text.size(); ++at) {
            if (quote == 0 ? is_quote(text[at]) : text[at] == quote) quote = quote == 0 ? text[at] : '\0';
            if (quote != 0) continue;
            depth += text[at] == '(' ? 1 : text[at] == ')' ? -1 : 0;
            if (wanted(text[at], depth)) return at;
        }
        return std::string_view::npos;
    }

    [[nodiscard]] std::size_t closing(std::string_view text, std::size_t open, std::size_t begin) const {
        const std::size_t close = find_sign(text, open, [](char, int depth) { return depth == 0; });
        if (close == std::string_view::npos) refuse("has no closing parenthesis", begin + open);
        return close;
    }

    /// The vector or the tensor of scalars.
    ///
    /// inside: the scalars, with commas between
    [[nodiscard]] Attribute made(std::string_view word, std::string_view inside, std::size_t position, std::size_t begin,
                                 int depth) const {
        std::vector<std::size_t> ends;
        for (std::size_t from = 0; from <= inside.size(); from = ends.back() + 1) {
            ends.push_back(
                std::min(inside.size(), find_sign(inside, from, [](char c, int open) { return c == ',' && open == 0; })));
        }
        const bool right = word == "vector" ? ends.size() == 3 : ends.size() == 6 || ends.size() == 9;
        if (!right) {
            refuse(std::string(word) + " takes " +
                       (word == "vector" ? "x, y, z" : "xx, yy, zz, xy, yz, xz, or all nine: xx, xy, xz, yx, …") + ", not " +
                       std::to_string(ends.size()) + (ends.size() == 1 ? " scalar" : " scalars"),
                   position);
        }
        std::vector<Attribute> scalars;
        for (std::size_t from = 0; const std::size_t end : ends) {
            scalars.push_back(value(inside.substr(from, end - from), begin + from, depth));
            if (scalars.back().channels != 1) {
                refuse(std::string(word) + " takes scalars, not one with " + std::to_string(scalars.back().channels) +
                           " components",
                       begin + from);
            }
            from = end + 1;
        }
        std::vector<const Attribute*> members;
        for (const Attribute& scalar : scalars) members.push_back(&scalar);
        return joined(members, std::string(word));
    }

    [[nodiscard]] Attribute call(std::string_view word, const Attribute& argument, std::size_t position) const {
        const auto needs = [&](bool right, const std::string& kind) {
            if (right) return;
            refuse(std::string(word) + " takes " + kind + ", not one with " + std::to_string(argument.channels), position);
        };
        if (const detail::TensorFunction* function = detail::find_tensor_function(word)) {
            needs(function->takes_channels(argument.channels), std::string(function->takes));
            return applied(argument, *function);
        }
        if (mesh_.cells.empty()) refuse("there are no cells to take derivatives in", position);
        if (word == "grad") {
            needs(argument.channels == 1 || argument.channels == 3, "a scalar or a vector with 3 components");
            return detail::limit_gradient(mesh_, argument, progress_);
        }
        needs(argument.channels == 3, "a vector with 3 components");
        const Attribute gradient = detail::limit_gradient(mesh_, argument, progress_);
        if (word == "div") return divergence(gradient);
        return word == "qcriterion" ? q_criterion(gradient) : curl(gradient);
    }

    [[nodiscard]] Attribute coordinate(int axis) const {
        Attribute result{std::string(1, static_cast<char>('x' + axis)), 1, std::vector<double>(mesh_.points.size())};
        for (std::size_t p = 0; p < result.values.size(); ++p) result.values[p] = mesh_.points[p][axis];
        return result;
    }

    /// What remains for the parser: its text, its variables, and where each of its letters was.
    struct Rest {
        std::string text;
        std::vector<Attribute> variables;
        std::vector<std::size_t> places;
    };

    [[nodiscard]] Rest without_terms(std::string_view text, std::size_t begin, int depth) const {
        Rest rest;
        const auto put = [&](std::string_view part, std::size_t place) {
            rest.text += part;
            rest.places.resize(rest.text.size(), begin + place);
        };
        for (std::size_t at = 0; at < text.size();) {
            const std::size_t from = at;
            if (is_digit(text[at])) {  // 1e5 holds no name
                while (at < text.size() && (is_digit(text[at]) || text[at] == '.')) ++at;
                const bool exponent = at + 1 < text.size() && (text[at] == 'e' || text[at] == 'E');
                if (exponent && (is_digit(text[at + 1]) || text[at + 1] == '-' || text[at + 1] == '+')) at += 2;
                while (at < text.size() && is_digit(text[at])) ++at;
                put(text.substr(from, at - from), from);
            } else if (is_quote(text[at]) || is_letter(text[at])) {
                if (auto found = term(text, at, begin, depth)) {
                    put("v" + std::to_string(rest.variables.size()), from);
                    rest.variables.push_back(found->channels == 1 ? std::move(*found) : detail::length_of(*found));
                    continue;
                }
                while (at < text.size() && (is_letter(text[at]) || is_digit(text[at]) || text[at] == '.')) ++at;
                const std::string word(text.substr(from, at - from));
                const bool constant = word == "pi" || word == "_pi" || word == "_e";
                const bool function = at < text.size() && text[at] == '(';
                if (!constant && !function) {
                    refuse("there is no field \"" + word + "\"" + detail::did_you_mean(word, names_of(mesh_)), begin + from);
                }
                if (function && !mu::Parser().GetFunDef().contains(word)) {
                    refuse("there is no function " + word + detail::did_you_mean(word, functions()), begin + from);
                }
                put(word, from);
            } else {
                const bool two = at + 1 < text.size() && text[at + 1] == '=' &&
                                 std::string_view("=<>!").find(text[at]) != std::string_view::npos;
                if (text[at] == '=' && !two) refuse("assigns a value; to compare, write ==", begin + at);
                if (text[at] == ',' && std::ranges::count(rest.text, '(') == std::ranges::count(rest.text, ')')) {
                    refuse("gives several values", begin + at);
                }
                at += two ? 2 : 1;
                put(text.substr(from, at - from), from);
            }
        }
        return rest;
    }

    /// The names of all functions.
    [[nodiscard]] static std::vector<std::string> functions() {
        std::vector<std::string> names(kDerivatives.begin(), kDerivatives.end());
        names.insert(names.end(), kMakers.begin(), kMakers.end());
        for (const auto& [word, ours] : kOtherWords) names.emplace_back(word);
        for (const std::string_view name : detail::tensor_functions()) names.emplace_back(name);
        const mu::Parser parser;
        for (const auto& [name, definition] : parser.GetFunDef()) names.push_back(name);
        return names;
    }

    [[nodiscard]] Attribute arithmetic(std::string_view text, std::size_t begin, int depth) const {
        const Rest rest = without_terms(text, begin, depth);
        try {
            return detail::computed(rest.text, rest.variables, std::string(text), mesh_.points.size());
        } catch (const mu::ParserError& error) {
            const auto position = static_cast<std::size_t>(std::max(0, error.GetPos()));
            refuse(error.GetMsg(), position < rest.places.size() ? rest.places[position] : begin + text.size());
        }
    }

    const HexMesh& mesh_;
    const std::string& source_;
    Progress* progress_;
};

/// Whether a text would be a name, if there were a field of that name: then the error is about fields, not about signs.
bool may_be_name(std::string_view source) {
    return std::ranges::all_of(source, [](char c) { return is_letter(c) || is_digit(c) || c == '.' || c == ' '; });
}

}  // namespace

std::optional<Attribute> detail::named_field(const HexMesh& mesh, std::string_view name) {
    if (const Attribute* field = mesh.find_attribute(name)) return *field;
    std::vector<std::string> scalars;
    std::vector<const Attribute*> fields;
    for (const Attribute& attribute : mesh.attributes) {
        if (attribute.channels != 1 || !attribute.name.starts_with(name)) continue;
        scalars.push_back(attribute.name);
        fields.push_back(&attribute);
    }
    for (const detail::ScalarGroup& group : detail::scalar_groups(scalars)) {
        if (group.name != name) continue;
        std::vector<const Attribute*> members;
        for (const std::size_t member : group.members) members.push_back(fields[member]);
        return joined(members, std::string(name));
    }
    return std::nullopt;
}

std::string detail::list_of(const HexMesh& mesh) {
    std::vector<std::string> names;
    for (const Attribute& attribute : mesh.attributes) names.push_back(attribute.name);
    return listed(names);
}

Attribute detail::length_of(const Attribute& attribute) {
    return applied(attribute, *find_tensor_function("length"));
}

std::string detail::quoted_name(const std::string& name) {
    return is_word(name) ? name : "`" + name + "`";
}

std::vector<std::string> component_names(int channels) {
    if (channels == 2) return {"x", "y"};
    if (channels == 3) return {"x", "y", "z"};
    if (channels == 6) return {"xx", "yy", "zz", "xy", "yz", "xz"};
    if (channels == 9) return {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
    std::vector<std::string> names;
    for (int c = 0; channels > 1 && c < channels; ++c) names.push_back(std::to_string(c));
    return names;
}

bool has_derivatives(std::string_view source) {
    return std::ranges::any_of(kDerivatives, [&](std::string_view word) {
        for (std::size_t at = source.find(word); at != std::string_view::npos; at = source.find(word, at + 1)) {
            const bool begins = at == 0 || !(is_letter(source[at - 1]) || is_digit(source[at - 1]));
            if (begins && source.substr(at + word.size()).starts_with('(')) return true;
        }
        return false;
    });
}

Attribute field_of(const HexMesh& mesh, const std::string& name, const std::string& source, Progress* progress) {
    const std::string_view text = detail::trimmed(source);
    const bool coordinate = text == "x" || text == "y" || text == "z" || text == "time";
    const Evaluation evaluation(mesh, source, progress);
    if (may_be_name(text) && !text.empty() && is_letter(text[0]) && !coordinate && mesh.find_attribute(source) == nullptr &&
        !evaluation.name(text)) {
        refuse_name(mesh, source);
    }
    const Attribute* plain = mesh.find_attribute(source);
    Attribute result = plain != nullptr ? *plain : evaluation.value(source, 0);
    result.name = name;
    const auto check = [&](const std::vector<double>& numbers, std::size_t of_place, const char* place) {
        const auto wrong = std::ranges::find_if_not(numbers, [](double number) { return std::isfinite(number); });
        if (wrong == numbers.end()) return;
        throw Error(ErrorCode::InvalidInput,
                    std::string("is not finite ") + place +
                        std::to_string(static_cast<std::size_t>(wrong - numbers.begin()) / of_place),
                    "expression '" + detail::shortened(source) + "'");
    };
    check(result.cells, static_cast<std::size_t>(result.channels), "in cell ");
    check(result.values, static_cast<std::size_t>(result.channels), "at point ");
    if (result.function != nullptr) check(result.arguments, result.function->arguments, "at point ");
    return result;
}

Attribute vector_field_of(const HexMesh& mesh, const std::string& source, Progress* progress) {
    Attribute field = field_of(mesh, source, source, progress);
    if (field.channels == 3) return field;
    throw Error(ErrorCode::InvalidInput,
                "'" + source + "' has " + std::to_string(field.channels) + (field.channels == 1 ? " component" : " components"),
                {}, "a vector, such as U or grad(T)");
}

std::vector<double> vectors_of(const HexMesh& mesh, const std::string& source, Progress* progress) {
    return vector_field_of(mesh, source, progress).values;
}

}  // namespace subvol
