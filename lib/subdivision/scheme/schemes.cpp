// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/schemes.h"

#include <cmath>
#include <utility>

#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

bool interpolates(Scheme scheme) {
    return scheme == Scheme::Mcq || scheme == Scheme::Linear;
}

namespace detail {

std::unique_ptr<SchemeRules> make_rules(const Topology& topology, const SchemeOptions& scheme) {
    return make_rules(topology, scheme, scheme.kind == Scheme::Linear ? std::vector<PointKind>{} : classify_points(topology));
}

std::unique_ptr<SchemeRules> make_rules(const Topology& topology, const SchemeOptions& scheme, std::vector<PointKind> kinds) {
    switch (scheme.kind) {
        case Scheme::Linear:
            return make_linear_rules(topology);
        case Scheme::Mcq:
            if (!std::isfinite(scheme.tension)) throw Error(ErrorCode::InvalidInput, "the tension is not a finite number");
            return make_mcq_rules(topology, scheme.tension, std::move(kinds));
        case Scheme::CatmullClark:
            return make_catmull_clark_rules(topology, std::move(kinds));
        case Scheme::Bsxw:
            return make_bsxw_rules(topology, std::move(kinds));
    }
    throw Error(ErrorCode::InvalidInput, "unknown subdivision scheme");
}

}  // namespace detail

namespace {

constexpr const char* kNoCreases = "none";

/// The word "none" stands for 180 degrees: no edge bends by more.
WordValue crease_value(std::optional<double>& angle) {
    return {.get = [&angle] { return !angle          ? std::string()
                                     : *angle == 180 ? kNoCreases
                                                     : detail::exact_text(*angle); },
            .set =
                [&angle](const std::string& text, const std::string& where) {
                    double degrees = 180;
                    if (text != kNoCreases) {
                        try {
                            Option("crease-angle", degrees).between(0, 180).read(text, where);
                        } catch (const Error& error) {
                            throw Error(error.code(), error.message(), error.where(), error.allowed() + ", or none");
                        }
                    }
                    angle = degrees;
                },
            .numbers = true};
}

}  // namespace

std::vector<Option> options_of(SchemeOptions& options) {
    return {
        Option("scheme", options.kind)
            .help("NAME",
                  "mcq (smooth, through the control points), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), linear"),
        Option("tension", options.tension)
            .between(0, 0.125)
            .help("W", "of mcq: 0 is linear; 1/16 reproduces cubics")
            .only_with("scheme", {"mcq"}),
        Option("crease-angle", crease_value(options.crease_angle_deg))
            .offer({kNoCreases})
            .help("DEG|none",
                  "keep boundary edges sharp that bend by more than this, in degrees; none: none (default: of a file without "
                  "creases 40, on round bodies of few cells 60; of tetoct and boxspline always 60)")};
}

}  // namespace subvol
