// SPDX-License-Identifier: Apache-2.0
#include "figures.h"

#include <algorithm>

#include "numbers.h"
#include "subvol/error.h"
#include "subvol/picture_metrics.h"
#include "text.h"

namespace subvol::cli {

double Figures::at(const std::string& name) const {
    const auto found = std::ranges::find(all_, name, &std::pair<std::string, double>::first);
    if (found == all_.end()) throw Error(ErrorCode::InvalidInput, "'" + name + "' was not measured", "--fail-under");
    return found->second;
}

void Figures::into(Report& report) const {
    for (const auto& [name, value] : all_) {
        const std::size_t dot = name.find('.');
        if (dot == std::string::npos) {
            report[name.c_str()] = value;
        } else {
            report[name.substr(0, dot).c_str()][name.substr(dot + 1)] = value;
        }
    }
}

bool Demand::met_by(const Figures& figures) const {
    const double measured = figures.at(metric);
    const PictureMetric* const known = find_metric(metric);
    const bool more_is_better = known != nullptr && known->more_is_better;
    return more_is_better ? measured >= value : measured <= value;
}

Demand parse_demand(const std::string& argument, const std::vector<std::string>& known) {
    const std::size_t equals = argument.find('=');
    const std::string metric = argument.substr(0, equals);
    check_choice("--fail-under", metric, known);
    if (equals == std::string::npos) {
        throw Error(ErrorCode::InvalidInput, "'" + argument + "' has no value", "--fail-under",
                    "write it as " + metric + "=40");
    }
    return {metric, parse_number("--fail-under", argument.substr(equals + 1))};
}

}  // namespace subvol::cli
