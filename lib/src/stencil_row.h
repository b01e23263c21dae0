#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Collects the terms of one stencil. Terms at the same point are added up in an order that does not depend on the order in
/// which they came, so that a row does not depend on how its neighbourhood was walked.
class StencilBuilder {
public:
    void clear() { terms_.clear(); }
    void add(Index point, double weight) { terms_.emplace_back(point, weight); }

    /// The terms by ascending point, one a point, zeros left out.
    const std::vector<std::pair<Index, double>>& finish() {
        std::sort(terms_.begin(), terms_.end());
        std::size_t count = 0;
        for (std::size_t i = 0; i < terms_.size();) {
            auto sum = terms_[i];
            while (++i < terms_.size() && terms_[i].first == sum.first) sum.second += terms_[i].second;
            if (sum.second != 0) terms_[count++] = sum;
        }
        terms_.resize(count);
        return terms_;
    }

private:
    std::vector<std::pair<Index, double>> terms_;
};

}  // namespace subvol::detail
