// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "subvol/error.h"

namespace subvol::detail {

// Lists of numbers as bytes, for another process of this program on a computer of the same kind.

/// Appends lists, each after its number of items.
class BytePacker {
public:
    template <class Items>
    void put(const Items& items) {
        using Item = typename Items::value_type;
        static_assert(std::is_trivially_copyable_v<Item>);
        const std::uint64_t count = items.size();
        bytes_.append(reinterpret_cast<const char*>(&count), sizeof count);
        bytes_.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item));
    }
    [[nodiscard]] std::string take() { return std::move(bytes_); }

private:
    std::string bytes_;
};

/// Takes the lists in the order in which they were put.
///
/// refusal: what the error says if the bytes do not have them
class ByteUnpacker {
public:
    ByteUnpacker(std::string_view bytes, const char* refusal) : left_(bytes), refusal_(refusal) {}

    template <class Items>
    void take(Items& items) {
        using Item = typename Items::value_type;
        std::uint64_t count = 0;
        std::memcpy(&count, bytes(sizeof count), sizeof count);
        if (count > left_.size() / sizeof(Item)) refuse();
        items.resize(count);
        if (count > 0) std::memcpy(static_cast<void*>(items.data()), bytes(count * sizeof(Item)), count * sizeof(Item));
    }

    [[nodiscard]] std::size_t left() const { return left_.size(); }
    /// What has not been taken.
    [[nodiscard]] std::string_view rest() const { return left_; }
    [[noreturn]] void refuse() const { throw Error(ErrorCode::InvalidInput, refusal_); }

private:
    const char* bytes(std::size_t count) {
        if (count > left_.size()) refuse();
        const char* first = left_.data();
        left_.remove_prefix(count);
        return first;
    }

    std::string_view left_;
    const char* refusal_;
};

}  // namespace subvol::detail
