// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "number_type.h"
#include "subvol/hex_mesh.h"
#include "text_scanner.h"

namespace subvol::detail {

/// Reads the numbers of a Gmsh file: words of the text or, in a binary file, bytes between its lines.
class GmshValues {
public:
    explicit GmshValues(TextScanner& in) : in_(in) {}

    void set_binary(std::endian order) {
        order_ = order;
        in_.name_bytes();
    }
    [[nodiscard]] bool binary() const { return order_.has_value(); }

    /// To be called before the numbers of a section: in a binary file they begin after the end of the line.
    void begin() {
        if (order_) in_.line();
    }

    /// type: of the number in a binary file, Int32 or UInt64
    std::int64_t integer(const Place& place, NumberType type = NumberType::Int32) {
        return order_ ? integer_from(in_.bytes(size_of(type), place), type, *order_) : in_.integer(place);
    }
    std::size_t count(const Place& place, NumberType type = NumberType::Int32) {
        return in_.as_count(integer(place, type), place);
    }
    double real(const Place& place) {
        constexpr NumberType kType = NumberType::Float64;
        return order_ ? real_from(in_.bytes(size_of(kType), place), kType, *order_) : in_.real(place);
    }

    /// An upper bound for how many numbers are left in the file.
    [[nodiscard]] std::size_t room() const { return order_ ? in_.bytes_left() / size_of(NumberType::Int32) : in_.room_for(1); }
    [[nodiscard]] std::size_t position() const { return in_.position(); }

private:
    TextScanner& in_;
    std::optional<std::endian> order_;  // set if the file is binary
};

/// The numbers of the nodes, or of the elements, of a file: arbitrary but unique. Most often they are 1, 2, 3…
class GmshNumbers {
public:
    void add(std::int64_t number) { numbers_.push_back(number); }
    void reserve(std::size_t count) { numbers_.reserve(count); }
    [[nodiscard]] std::size_t size() const { return numbers_.size(); }
    /// In the order of `add`.
    [[nodiscard]] std::span<const std::int64_t> all() const { return numbers_; }

    /// To be called after the last `add` and before `find`. returns: a number that occurs twice
    std::optional<std::int64_t> sort() {
        places_.reserve(numbers_.size());
        for (Index n = 0; n < numbers_.size(); ++n) places_.emplace_back(numbers_[n], n);
        std::sort(places_.begin(), places_.end());
        const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
        const auto twice = std::adjacent_find(places_.begin(), places_.end(), same);
        return twice == places_.end() ? std::nullopt : std::optional(twice->first);
    }

    /// The place of a number in the order of `add`; kNone if it does not occur.
    [[nodiscard]] Index find(std::int64_t number) const {
        const auto guess = static_cast<std::uint64_t>(number) - 1;
        if (guess < places_.size() && places_[guess].first == number) return places_[guess].second;
        const auto found = std::lower_bound(places_.begin(), places_.end(), std::pair{number, Index{0}});
        return found == places_.end() || found->first != number ? kNone : found->second;
    }

private:
    std::vector<std::int64_t> numbers_;
    std::vector<std::pair<std::int64_t, Index>> places_;  // sorted by number
};

}  // namespace subvol::detail
