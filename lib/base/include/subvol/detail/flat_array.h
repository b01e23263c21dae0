// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "subvol/index.h"

namespace subvol {

/// A std::allocator that does not initialise new elements, so that memory is first touched by the threads that fill it.
template <class T>
struct UninitializedAllocator : std::allocator<T> {
    template <class U>
    struct rebind {
        using other = UninitializedAllocator<U>;
    };

    template <class U>
    void construct(U* place) noexcept(std::is_nothrow_default_constructible_v<U>) {
        ::new (static_cast<void*>(place)) U;
    }
    template <class U, class... Arguments>
    void construct(U* place, Arguments&&... arguments) {
        std::construct_at(place, std::forward<Arguments>(arguments)...);
    }
};

/// A vector whose `resize` does not initialise new elements: for large arrays that are then written in parallel.
template <class T>
using FlatArray = std::vector<T, UninitializedAllocator<T>>;

/// Rows of varying length in one flat array: row i is values[offsets[i] .. offsets[i+1]).
template <class T>
struct Rows {
    FlatArray<std::size_t> offsets{0};
    FlatArray<T> values;

    [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
    [[nodiscard]] std::span<const T> operator[](std::size_t row) const {
        return std::span(values).subspan(offsets[row], offsets[row + 1] - offsets[row]);
    }
};

using IndexRows = Rows<Index>;

}  // namespace subvol
