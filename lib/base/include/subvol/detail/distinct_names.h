// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>

namespace subvol::detail {

/// Names that differ from each other, made of any names. cost: constant for each name, on average
class DistinctNames {
public:
    /// The name itself, or with the first number from 2 on that makes it a name of no other one: "p_2".
    [[nodiscard]] std::string take(const std::string& name) {
        const auto [at, is_new] = next_.try_emplace(name, 2);
        if (is_new) return name;
        std::size_t& next = at->second;  // elements stay where they are
        std::string other;
        do {
            other = name + "_" + std::to_string(next++);
        } while (!next_.try_emplace(other, 2).second);
        return other;
    }

private:
    std::unordered_map<std::string, std::size_t> next_;  // of each name that is taken, the number to try next
};

}  // namespace subvol::detail
