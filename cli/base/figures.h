// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "report.h"

namespace subvol::cli {

/// Measured numbers by their names, "psnr" or "srgb8.psnr", in the order in which they were added.
class Figures {
public:
    void put(const std::string& name, double value) { all_.emplace_back(name, value); }
    [[nodiscard]] const std::vector<std::pair<std::string, double>>& all() const { return all_; }
    [[nodiscard]] double at(const std::string& name) const;

    /// "srgb8.psnr" becomes the key "psnr" of the object "srgb8".
    void into(Report& report) const;

private:
    std::vector<std::pair<std::string, double>> all_;
};

/// "psnr=40": the figure must not be worse than the value. Larger is better for psnr and ssim, smaller for all others.
struct Demand {
    std::string metric;
    double value = 0;

    [[nodiscard]] bool met_by(const Figures& figures) const;
};

/// known: the names that will be measured
///
/// throws: Error(InvalidInput) for another name, or if the value is missing or not a number
[[nodiscard]] Demand parse_demand(const std::string& argument, const std::vector<std::string>& known);

}  // namespace subvol::cli
