// SPDX-License-Identifier: Apache-2.0
// Reads by descent: a sum consists of products, a product of factors.
#include "xdmf_function.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <utility>

#include "subvol/detail/text_scanner.h"

namespace subvol::detail {

namespace {

using Values = std::vector<double>;

class XdmfFunction {
public:
    XdmfFunction(std::string_view text, const std::vector<Values>& arguments,
                 const std::function<void(const std::string&)>& fail)
        : text_(text), arguments_(arguments), fail_(fail) {}

    Values run() {
        Values result = sum();
        if (next() != '\0') refuse();
        return result;
    }

private:
    void refuse() const {
        fail_("the function " + in_quotes(std::string(text_)) + " is not supported from character " + std::to_string(at_));
    }

    char next() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
            ++at_;
        return at_ < text_.size() ? text_[at_] : '\0';
    }

    bool take(char c) {
        if (next() != c) return false;
        ++at_;
        return true;
    }

    // A single number stands for as many as the other side has.
    template <class Operation>
    Values combined(const Values& a, const Values& b, const Operation& operation) {
        if (a.size() != b.size() && a.size() != 1 && b.size() != 1) {
            fail_("the arguments of its function have " + std::to_string(a.size()) + " and " + std::to_string(b.size()) +
                  " values");
        }
        Values result(std::max(a.size(), b.size()));
        for (std::size_t i = 0; i < result.size(); ++i) {
            result[i] = operation(a[a.size() == 1 ? 0 : i], b[b.size() == 1 ? 0 : i]);
        }
        return result;
    }

    Values sum() {
        Values left = product();
        for (char c = next(); c == '+' || c == '-'; c = next()) {
            ++at_;
            const Values right = product();
            left = c == '+' ? combined(left, right, std::plus<>()) : combined(left, right, std::minus<>());
        }
        return left;
    }

    Values product() {
        Values left = factor();
        for (char c = next(); c == '*' || c == '/'; c = next()) {
            ++at_;
            const Values right = factor();
            left = c == '*' ? combined(left, right, std::multiplies<>()) : combined(left, right, std::divides<>());
        }
        return left;
    }

    Values factor() {
        constexpr int kDeepest = 64;
        if (++depth_ > kDeepest) refuse();
        Values result;
        const char c = next();
        if (take('-')) {
            result = factor();
            for (double& value : result) value = -value;
        } else if (take('(')) {
            result = sum();
            if (!take(')')) refuse();
        } else if (take('$')) {
            const double number = unsigned_number();
            if (!(number < static_cast<double>(arguments_.size()))) {
                fail_("its function has " + counted(arguments_.size(), "argument", "arguments"));
            }
            result = arguments_[static_cast<std::size_t>(number)];
        } else if ((c >= '0' && c <= '9') || c == '.') {
            result = {unsigned_number()};
        } else {
            result = call();
        }
        --depth_;
        return result;
    }

    double unsigned_number() {
        double value = 0;
        const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
        if (error != std::errc() || value < 0) refuse();
        at_ = static_cast<std::size_t>(end - text_.data());
        return value;
    }

    Values call() {
        const std::size_t begin = at_;
        while (at_ < text_.size() && (std::isalpha(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_')) ++at_;
        const std::string name = upper_case(text_.substr(begin, at_ - begin));
        if (!take('(')) refuse();
        std::vector<Values> given{sum()};
        while (take(';') || take(',')) given.push_back(sum());
        if (!take(')')) refuse();
        if (name == "JOIN") return joined(given);
        using Function = double (*)(double);
        const std::pair<std::string_view, Function> functions[] = {
            {"SQRT", [](double x) { return std::sqrt(x); }}, {"ABS", [](double x) { return std::abs(x); }},
            {"SIN", [](double x) { return std::sin(x); }},   {"COS", [](double x) { return std::cos(x); }},
            {"TAN", [](double x) { return std::tan(x); }},   {"EXP", [](double x) { return std::exp(x); }},
            {"LOG", [](double x) { return std::log(x); }},   {"ABS_TOKEN", [](double x) { return std::abs(x); }}};
        const auto* const known = std::ranges::find(functions, name, &std::pair<std::string_view, Function>::first);
        if (known == std::end(functions) || given.size() != 1) refuse();
        for (double& value : given[0]) value = known->second(value);
        return given[0];
    }

    Values joined(const std::vector<Values>& given) {
        Values result;
        for (const Values& one : given) {
            if (one.size() != given[0].size()) fail_("the arguments of JOIN have different lengths");
        }
        result.reserve(given.size() * given[0].size());
        for (std::size_t i = 0; i < given[0].size(); ++i) {
            for (const Values& one : given) result.push_back(one[i]);
        }
        return result;
    }

    std::string_view text_;
    const std::vector<Values>& arguments_;
    const std::function<void(const std::string&)>& fail_;
    std::size_t at_ = 0;
    int depth_ = 0;
};

}  // namespace

std::vector<double> value_of_xdmf_function(std::string_view function, const std::vector<std::vector<double>>& arguments,
                                           const std::function<void(const std::string&)>& fail) {
    return XdmfFunction(function, arguments, fail).run();
}

}  // namespace subvol::detail
