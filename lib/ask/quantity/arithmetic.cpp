// SPDX-License-Identifier: Apache-2.0
// Formulas are evaluated by muParser. What it does not say, whether a formula is linear and whether it can be negative, is
// read off by a descent through sums, products and powers:
//
//     (v0 - 293)/620          linear: computed at the points, as the limit is the same
//     v0^2 + abs(v1)          not linear, never negative: computed at each place, with 0 as its least value
#include "arithmetic.h"

#include <muParser.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "field_functions.h"

namespace subvol::detail {
namespace {

/// number: of a constant that is one number
struct Term {
    FormulaKind kind;
    std::optional<double> number = {};
};

class FormulaReader {
public:
    FormulaReader(std::string_view text, std::span<const bool> positive) : text_(text), positive_(positive) {}

    /// Nothing if the formula has a part that is not read.
    [[nodiscard]] std::optional<FormulaKind> read() {
        const auto found = comparison();
        return found && peek() == 0 ? std::optional(found->kind) : std::nullopt;
    }

private:
    static constexpr int kDeepest = 64;

    [[nodiscard]] char peek() {
        while (at_ < text_.size() && text_[at_] == ' ') ++at_;
        return at_ < text_.size() ? text_[at_] : 0;
    }
    [[nodiscard]] bool take(char wanted) {
        if (peek() != wanted) return false;
        ++at_;
        return true;
    }

    /// Also what is joined by && and ||, which are 0 or 1, too.
    [[nodiscard]] std::optional<Term> comparison() {
        constexpr std::string_view kSigns = "<>=!&|";
        const auto is_sign = [&] { return peek() != 0 && kSigns.find(peek()) != std::string_view::npos; };
        auto all = sum();
        while (all && is_sign()) {
            while (is_sign()) ++at_;
            const auto next = sum();
            if (!next) return std::nullopt;
            all = Term{{std::max(all->kind.degree, next->kind.degree) == 0 ? 0 : 2, true, true}};
        }
        return all;
    }

    [[nodiscard]] std::optional<Term> sum() {
        auto all = product();
        while (all) {
            const bool minus = peek() == '-';
            if (!minus && peek() != '+') break;
            ++at_;
            const auto next = product();
            if (!next) return std::nullopt;
            all = Term{{std::max(all->kind.degree, next->kind.degree), !minus && all->kind.positive && next->kind.positive}};
        }
        return all;
    }

    [[nodiscard]] std::optional<Term> product() {
        auto all = signed_power();
        while (all) {
            const bool divides = peek() == '/';
            if (!divides && peek() != '*') break;
            ++at_;
            const auto next = signed_power();
            if (!next) return std::nullopt;
            const int degree = divides && next->kind.degree > 0 ? 2 : std::min(2, all->kind.degree + next->kind.degree);
            all = Term{{degree, all->kind.positive && next->kind.positive}};
        }
        return all;
    }

    [[nodiscard]] std::optional<Term> signed_power() {
        if (take('-')) {
            const auto next = signed_power();
            return next ? std::optional(Term{{next->kind.degree, false}}) : std::nullopt;
        }
        if (take('+')) return signed_power();
        const auto base = factor();
        if (!base || !take('^')) return base;
        const auto power = signed_power();
        if (!power) return std::nullopt;
        const bool even = power->number && std::fmod(*power->number, 2) == 0;
        const int degree = base->kind.degree == 0 && power->kind.degree == 0 ? 0 : 2;
        return Term{{degree, base->kind.positive || even}};
    }

    [[nodiscard]] std::optional<Term> factor() {
        if (++depth_ > kDeepest) return std::nullopt;
        const auto found = bare_factor();
        --depth_;
        return found;
    }

    [[nodiscard]] std::optional<Term> bare_factor() {
        const char first = peek();
        if (take('(')) {
            auto inside = comparison();
            return inside && take(')') ? inside : std::nullopt;
        }
        if ((first >= '0' && first <= '9') || first == '.') {
            double number = 0;
            const auto read = std::from_chars(text_.data() + at_, text_.data() + text_.size(), number);
            if (read.ec != std::errc()) return std::nullopt;
            at_ = static_cast<std::size_t>(read.ptr - text_.data());
            return Term{{0, true}, number};
        }
        std::size_t end = at_;
        while (end < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[end])) != 0 || text_[end] == '_')) ++end;
        const std::string_view word = text_.substr(at_, end - at_);
        at_ = end;
        if (take('(')) return call(word);
        if (word == "pi" || word == "_pi" || word == "_e") return Term{{0, true}};
        std::size_t number = 0;
        if (!word.starts_with('v')) return std::nullopt;
        const auto read = std::from_chars(word.data() + 1, word.data() + word.size(), number);
        if (read.ec != std::errc() || read.ptr != word.data() + word.size() || number >= positive_.size()) return std::nullopt;
        return Term{{1, positive_[number]}};
    }

    [[nodiscard]] std::optional<Term> call(std::string_view word) {
        constexpr std::array<std::string_view, 4> kPositive{"abs", "sqrt", "exp", "cosh"};
        constexpr std::array<std::string_view, 4> kAsArguments{"min", "max", "sum", "avg"};
        bool all = true;
        int degree = 0;
        do {
            const auto argument = comparison();
            if (!argument) return std::nullopt;
            all = all && argument->kind.positive;
            degree = std::max(degree, argument->kind.degree);
        } while (take(','));
        if (!take(')')) return std::nullopt;
        const bool positive = std::ranges::find(kPositive, word) != kPositive.end() ||
                              (all && std::ranges::find(kAsArguments, word) != kAsArguments.end());
        return Term{{degree == 0 ? 0 : 2, positive}};
    }

    std::string_view text_;
    std::span<const bool> positive_;
    std::size_t at_ = 0;
    int depth_ = 0;
};

/// A formula for several threads, each of which has a parser.
class Formula {
public:
    Formula(std::string text, std::size_t variables)
        : text_(std::move(text)), variables_(variables), parsers_([this] { return std::make_unique<Parser>(*this); }) {}

    [[nodiscard]] double operator()(std::span<const double> variables) const {
        Parser& parser = *parsers_.local();
        std::ranges::copy(variables, parser.at.begin());
        return parser.parser.Eval();
    }

private:
    struct Parser {
        std::vector<double> at;
        mu::Parser parser;

        explicit Parser(const Formula& formula) : at(formula.variables_) {
            parser.DefineConst("pi", std::numbers::pi);
            for (std::size_t v = 0; v < at.size(); ++v) parser.DefineVar("v" + std::to_string(v), &at[v]);
            parser.SetExpr(formula.text_);
        }
    };

    std::string text_;
    std::size_t variables_;
    mutable tbb::enumerable_thread_specific<std::unique_ptr<Parser>> parsers_;
};

}  // namespace

FormulaKind kind_of_formula(std::string_view text, std::span<const bool> positive) {
    return FormulaReader(text, positive).read().value_or(FormulaKind{});
}

Attribute computed(const std::string& text, std::span<const Attribute> variables, std::string name, std::size_t points) {
    const auto formula = std::make_shared<const Formula>(text, variables.size());
    if (variables.empty()) {
        if (points == 0) (void)(*formula)({});
        return {std::move(name), 1, std::vector<double>(points, points > 0 ? (*formula)({}) : 0)};
    }
    std::vector<const Attribute*> members;
    const auto positive = std::make_unique<bool[]>(variables.size());
    for (std::size_t v = 0; v < variables.size(); ++v) {
        members.push_back(&variables[v]);
        positive[v] = !variables[v].bounds.empty() && variables[v].bounds[0][0] >= 0;
    }
    const FormulaKind kind = kind_of_formula(text, std::span(positive.get(), variables.size()));
    const Attribute all = joined(members, name);
    // What is wrong is refused before threads begin.
    (void)(*formula)(all.values.empty() ? std::vector<double>(variables.size())
                                        : std::vector<double>(all.values.begin(), all.values.begin() + all.channels));
    const auto value = [formula](std::span<const double> at, std::span<double> to) { to[0] = (*formula)(at); };
    Attribute result;
    if (kind.degree < 2 || all.constant) {
        result = applied(all, std::move(name), 1, Rule::Linear, value);
    } else {
        const Attribute at_points = applied(all, name, 1, Rule::Linear, value);
        Attribute plain{"", 1, at_points.values};
        members.push_back(&plain);
        result = applied(joined(members, name), std::move(name), 1, Rule::Nonlinear,
                         [formula](std::span<const double> at, std::span<double> to) {
                             const double found = (*formula)(at.first(at.size() - 1));
                             to[0] = std::isfinite(found) ? found : at.back();
                         });
        result.values = std::move(plain.values);  // not finite where the formula is not
        result.cells = at_points.cells;
    }
    if (kind.positive) result.bounds = {{0, kind.flag ? 1 : std::numeric_limits<double>::infinity()}};
    return result;
}

}  // namespace subvol::detail
