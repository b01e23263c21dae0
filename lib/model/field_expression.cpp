// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_expression.h"

#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <list>
#include <numbers>

#include "subvol/detail/near_name.h"
#include "subvol/error.h"

namespace subvol {
namespace {

bool is_name(const std::string& text) {
    if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0]))) return false;
    for (const char c : text) {
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') return false;
    }
    return true;
}

/// Whether the parser takes a name as one word: alpha.water is one, "total pressure" and p-rgh are none.
bool is_word(const std::string& text) {
    return !text.empty() && !text.ends_with('.') && is_name(text.substr(0, 1)) && std::ranges::all_of(text, [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.';
    });
}

/// A variable of an expression: a channel of a field, or the length of its vectors (channel -1).
struct Variable {
    const Attribute* field;
    int channel;
    double value = 0;

    void read(std::size_t point) {
        const auto channels = static_cast<std::size_t>(field->channels);
        const double* values = field->values.data() + point * channels;
        if (channel >= 0) {
            value = values[channel];
            return;
        }
        double squares = 0;
        for (std::size_t c = 0; c < channels; ++c) squares += values[c] * values[c];
        value = std::sqrt(squares);
    }
};

double length(double x) {
    return std::abs(x);
}

class FieldEvaluator {
public:
    FieldEvaluator(const HexMesh& mesh, const std::string& expression) : mesh_(mesh), expression_(expression) {
        parser_.DefineNameChars("0123456789_.abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
        parser_.DefineVar("x", &at_.x);
        parser_.DefineVar("y", &at_.y);
        parser_.DefineVar("z", &at_.z);
        parser_.DefineConst("pi", std::numbers::pi);
        parser_.DefineFun("length", &length);
        std::string plain = expression;
        for (const Attribute& field : mesh.attributes) {
            // A name in quotation marks is that of a field, whatever it consists of.
            const std::string word = "field_" + std::to_string(variables_.size()) + "_", quoted = "'" + field.name + "'";
            bool found = false;
            for (std::size_t at = plain.find(quoted); at != std::string::npos; at = plain.find(quoted, at)) {
                plain.replace(at, quoted.size(), word);
                found = true;
            }
            if (found) define(word, field);
            if (is_word(field.name) && plain.find(field.name) != std::string::npos) define(field.name, field);
        }
        parser_.SetExpr(plain);
    }
    FieldEvaluator(const FieldEvaluator&) = delete;
    FieldEvaluator& operator=(const FieldEvaluator&) = delete;

    [[nodiscard]] std::vector<double> run() {
        std::vector<double> values(mesh_.points.size());
        for (std::size_t p = 0; p < values.size(); ++p) {
            for (Variable& variable : variables_) variable.read(p);
            at_ = mesh_.points[p];
            values[p] = parser_.Eval();
            if (p == 0 && parser_.GetNumResults() != 1) refuse("gives several values");
            if (at_ != mesh_.points[p]) refuse("assigns to x, y or z; to compare, write ==");
            if (!std::isfinite(values[p])) refuse("is not finite at point " + std::to_string(p));
        }
        return values;
    }

    [[noreturn]] void refuse(const std::string& what, int position = -1) const {
        std::string names = "x, y, z";
        for (const Attribute& field : mesh_.attributes)
            names += ", " + (is_word(field.name) ? field.name : "'" + field.name + "'");
        const std::string at = position < 0 ? "" : ", position " + std::to_string(position);
        throw Error(ErrorCode::InvalidInput, what, "expression '" + expression_ + "'" + at, "numbers, functions and " + names);
    }

    [[nodiscard]] std::string nearest(const std::string& token) const {
        std::vector<std::string> names;
        for (const Attribute& field : mesh_.attributes) names.push_back(field.name);
        return detail::did_you_mean(token, names);
    }

private:
    void define(const std::string& word, const Attribute& field) {
        if (word == "x" || word == "y" || word == "z") return;
        if (field.channels == 1) return bind(word, field, 0);
        bind(word, field, -1);
        for (int c = 0; c < field.channels; ++c) {
            bind(word + "." + std::to_string(c), field, c);
            if (field.channels <= 3) bind(word + "." + "xyz"[c], field, c);
        }
    }

    void bind(const std::string& name, const Attribute& field, int channel) {
        Variable& variable = variables_.emplace_back(Variable{&field, channel});
        parser_.DefineVar(name, &variable.value);
    }

    const HexMesh& mesh_;
    const std::string expression_;
    Vec3 at_{0.0};
    std::list<Variable> variables_;  // the parser keeps their addresses
    mu::Parser parser_;
};

bool is_channel(const std::string& source) {
    const std::size_t dot = source.rfind('.');
    return dot != std::string::npos && is_name(source.substr(0, dot)) && dot + 1 < source.size();
}

}  // namespace

Attribute field_of(const HexMesh& mesh, const std::string& name, const std::string& source) {
    if (const Attribute* found = mesh.find_attribute(source)) return {name, found->channels, found->values, found->bounds};
    std::string whole = source;
    if (is_channel(source) && !mesh.find_attribute(source.substr(0, source.rfind('.'))))
        whole = source.substr(0, source.rfind('.'));
    const bool coordinate = source == "x" || source == "y" || source == "z";
    if (is_name(whole) && !coordinate && !mesh.find_attribute(whole)) (void)select_field(mesh, whole);  // says what is meant
    try {
        FieldEvaluator evaluator(mesh, source);
        try {
            return {name, 1, evaluator.run()};
        } catch (const mu::ParserError& e) {
            evaluator.refuse(e.GetMsg() + evaluator.nearest(e.GetToken()), static_cast<int>(e.GetPos()));
        }
    } catch (const mu::ParserError& e) {
        throw Error(ErrorCode::InvalidInput, e.GetMsg(), "expression '" + source + "'");
    }
}

}  // namespace subvol
