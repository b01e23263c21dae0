// SPDX-License-Identifier: Apache-2.0
#include "subvol/expression.h"

#include <muParser.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol {
namespace {

[[noreturn]] void refuse(const std::string& expression, const std::string& message, int position = -1) {
    const std::string at = position < 0 ? "" : ", position " + std::to_string(position);
    throw Error(ErrorCode::InvalidInput, message, "expression '" + expression + "'" + at);
}

/// A parser and the variables that it is bound to: it can be neither copied nor shared between threads.
class Evaluator {
public:
    explicit Evaluator(const std::string& expression) {
        parser_.DefineVar("x", &at_.x);
        parser_.DefineVar("y", &at_.y);
        parser_.DefineVar("z", &at_.z);
        parser_.DefineConst("pi", std::numbers::pi);
        parser_.SetExpr(expression);
    }
    Evaluator(const Evaluator&) = delete;
    Evaluator& operator=(const Evaluator&) = delete;

    [[nodiscard]] double operator()(const Vec3& point) {
        at_ = point;
        return parser_.Eval();
    }

    /// Refuses what the parser lets through: several values, and "x=1", which assigns where a comparison was meant.
    void check(const std::string& expression) {
        const Vec3 probe(0.3819, 0.6180, 0.7236);
        (void)(*this)(probe);
        if (parser_.GetNumResults() != 1) refuse(expression, "gives several values");
        if (at_ != probe) refuse(expression, "assigns to x, y or z; to compare, write ==");
    }

private:
    Vec3 at_{0.0};
    mu::Parser parser_;
};

void check_finite(const std::string& expression, std::span<const Vec3> points, std::span<const double> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) continue;
        const Vec3& p = points[i];
        const auto text = [](double x) { return detail::number_text(x); };
        refuse(expression,
               "is not finite at point " + std::to_string(i) + " (" + text(p.x) + ", " + text(p.y) + ", " + text(p.z) + ")");
    }
}

}  // namespace

std::vector<double> evaluate_expression(const std::string& expression, std::span<const Vec3> points) {
    constexpr std::size_t kGrain = 16384;  // points per parser: enough to make the cost of building it negligible
    std::vector<double> values(points.size());
    try {
        Evaluator(expression).check(expression);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), kGrain), [&](const auto& range) {
            Evaluator evaluate(expression);
            for (std::size_t i = range.begin(); i < range.end(); ++i) values[i] = evaluate(points[i]);
        });
    } catch (const mu::ParserError& e) {
        refuse(expression, e.GetMsg(), static_cast<int>(e.GetPos()));
    }
    check_finite(expression, points, values);
    return values;
}

}  // namespace subvol
