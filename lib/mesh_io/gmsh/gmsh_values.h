// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "number_type.h"
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

}  // namespace subvol::detail
