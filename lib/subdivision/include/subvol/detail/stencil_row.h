// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "subvol/detail/sort_network.h"
#include "subvol/stencil_table.h"

namespace subvol::detail {

/// A finished stencil: runs of points of one weight, ascending within a run.
struct StencilRuns {
    std::span<const Index> points;
    std::span<const StencilTable::Run> runs;
};

/// Collects the terms of one stencil in any order: the finished row does not depend on the order of its neighbours.
///
/// A row is given either term by term or, where the mesh is regular, as whole runs.
class StencilBuilder {
public:
    void clear() {
        terms_.clear();
        points_.clear();
        runs_.clear();
    }

    void add(Index point, double weight) { terms_.emplace_back(point, weight); }

    /// Adds points of the same weight. Rows of one kind must add their runs in the same order.
    template <std::size_t N>
    void add_run(std::array<Index, N> points, double weight) {
        if (weight == 0) return;
        sort_network(points);
        points_.insert(points_.end(), points.begin(), points.end());
        runs_.push_back({weight, static_cast<std::uint32_t>(N)});
    }

    /// Valid until the next call of `clear`.
    StencilRuns finish() {
        if (!terms_.empty()) make_runs();
        return {points_, runs_};
    }

private:
    using Term = std::pair<Index, double>;

    /// The terms of one point are added up in ascending order, then all terms are sorted by weight.
    void make_runs() {
        std::sort(terms_.begin(), terms_.end());
        std::size_t count = 0;
        for (std::size_t i = 0; i < terms_.size();) {
            Term sum = terms_[i];
            while (++i < terms_.size() && terms_[i].first == sum.first) sum.second += terms_[i].second;
            if (sum.second != 0) terms_[count++] = sum;
        }
        terms_.resize(count);
        std::sort(terms_.begin(), terms_.end(),
                  [](const Term& a, const Term& b) { return std::pair(a.second, a.first) < std::pair(b.second, b.first); });
        for (const auto& [point, weight] : terms_) {
            if (runs_.empty() || runs_.back().weight != weight) runs_.push_back({weight, 0});
            ++runs_.back().count;
            points_.push_back(point);
        }
    }

    std::vector<Term> terms_;
    std::vector<Index> points_;
    std::vector<StencilTable::Run> runs_;
};

}  // namespace subvol::detail
