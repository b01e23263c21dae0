// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace subvol::detail {

/// Adds up counts, number by number, over all processes that draw a picture together. Empty: this process is alone.
using SumCounts = std::function<void(std::vector<std::int64_t>&)>;

/// Which part of a volume is taken by kernels of each reach in depth. Volumes are counted as whole numbers, so that their sum
/// is the same in any order and for any number of processes; reaches are told apart by 1/64 of an octave.
class ReachCounts {
public:
    /// reach:  not negative
    /// volume: in parts of some volume that is the same for all kernels
    void add(float reach, double volume) {
        counts_[std::bit_cast<std::uint32_t>(reach) >> kShift] += static_cast<std::int64_t>(std::min(volume, 1.0) * kUnit);
        ++kernels_;
    }
    void add(const ReachCounts& others) {
        for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += others.counts_[i];
        kernels_ += others.kernels_;
    }
    /// Two sums: which octaves have counts in any process, and then the counts in these, which are few.
    void add_up(const SumCounts& sum) {
        if (!sum) return;
        std::vector<std::int64_t> used(counts_.size() / kOctave + 1, 0);
        used.back() = kernels_;
        for (std::size_t i = 0; i < counts_.size(); ++i) used[i / kOctave] |= counts_[i] != 0 ? 1 : 0;
        sum(used);
        kernels_ = used.back();
        std::vector<std::int64_t> counts;
        const auto each_used = [&](const auto& act) {
            for (std::size_t i = 0; i < counts_.size(); ++i) {
                if (used[i / kOctave] != 0) act(counts_[i]);
            }
        };
        each_used([&](std::int64_t count) { counts.push_back(count); });
        sum(counts);
        auto next = counts.begin();
        each_used([&](std::int64_t& count) { count = *next++; });
    }

    [[nodiscard]] std::int64_t kernels() const { return kernels_; }

    /// The reach below which kernels take a part of the volume of all, or a little less; 0 if there are no volumes.
    [[nodiscard]] float finest(double part) const {
        std::int64_t all = 0, finer = 0;
        for (const std::int64_t count : counts_) all += count;
        std::size_t i = 0;
        while (i + 1 < counts_.size() && static_cast<double>(finer += counts_[i]) <= part * static_cast<double>(all)) ++i;
        return all > 0 ? std::bit_cast<float>(static_cast<std::uint32_t>(i) << kShift) : 0;
    }

private:
    static constexpr unsigned kShift = 17;
    static constexpr std::size_t kOctave = 64;
    static constexpr double kUnit = 1LL << 40;

    std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(std::size_t{1} << (31 - kShift));
    std::int64_t kernels_ = 0;
};

}  // namespace subvol::detail
