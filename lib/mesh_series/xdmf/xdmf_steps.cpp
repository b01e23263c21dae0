// SPDX-License-Identifier: Apache-2.0
#include "xdmf_steps.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "subvol/detail/number_text.h"
#include "text_scanner.h"
#include "trimmed.h"

namespace subvol::detail {

namespace {

bool is_temporal(const pugi::xml_node& grid) {
    return kind_of(grid, {"GridType"}) == "COLLECTION" && kind_of(grid, {"CollectionType"}) == "TEMPORAL";
}

class StepFinder {
public:
    explicit StepFinder(XdmfFile& file) : file_(file) {}

    XdmfSteps find() {
        const auto grids = file_.children(file_.domain(), "Grid");
        if (grids.empty()) file_.fail_at(file_.domain(), "it has no grids");
        const auto temporal = std::ranges::find_if(grids, is_temporal);
        if (temporal == grids.end()) return {{}, {file_.domain()}};
        XdmfSteps steps;
        steps.grids = file_.children(*temporal, "Grid");
        if (steps.grids.empty()) file_.fail_at(*temporal, "it has no steps");
        if (steps.grids.size() > kMostGrids) file_.fail_at(*temporal, "it has too many steps");
        const auto listed = listed_times(*temporal, steps.grids.size());
        for (std::size_t k = 0; k < steps.grids.size(); ++k) {
            steps.times.push_back(listed.empty() ? time_of(steps.grids[k], static_cast<double>(k), 0) : listed[k]);
        }
        std::vector<std::size_t> order(steps.times.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t k) { return steps.times[k]; });
        XdmfSteps sorted;
        for (const std::size_t k : order) {
            sorted.times.push_back(steps.times[k]);
            sorted.grids.push_back(steps.grids[k]);
        }
        return sorted;
    }

private:
    // The times of a collection that has them in one place.
    std::vector<double> listed_times(const pugi::xml_node& collection, std::size_t count) {
        const pugi::xml_node time = file_.child(collection, "Time");
        const std::string kind = kind_of(time, {"TimeType", "Type"});
        if (!time || kind.empty() || kind == "SINGLE") return {};
        auto values = file_.items(time, 1).front();
        if (kind == "HYPERSLAB" && values.size() >= 2) {
            std::vector<double> times;
            for (std::size_t k = 0; k < count; ++k) times.push_back(values[0] + static_cast<double>(k) * values[1]);
            values = std::move(times);
        }
        if (values.size() != count || !std::ranges::all_of(values, [](double t) { return std::isfinite(t); })) {
            file_.fail_at(time, "it does not give a time for each of the " + counted(count, "step", "steps"));
        }
        return values;
    }

    double time_of(const pugi::xml_node& grid, double otherwise, int depth) {
        if (const pugi::xml_node time = file_.child(grid, "Time")) {
            const auto text = time.attribute("Value");
            const auto value = text ? number_from(trimmed(text.as_string())) : otherwise;
            if (!value || !std::isfinite(*value)) file_.fail_at(time, "its value is not a number");
            return *value;
        }
        const pugi::xml_node first = file_.child(grid, "Grid");
        return first && depth < kMostNested ? time_of(first, otherwise, depth + 1) : otherwise;
    }

    XdmfFile& file_;
};

}  // namespace

XdmfSteps xdmf_steps(XdmfFile& file) {
    return StepFinder(file).find();
}

}  // namespace subvol::detail
