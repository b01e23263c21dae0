// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace subvol::detail {

using PageJson = nlohmann::ordered_json;

/// Arrays of a page as bytes that compress well: numbers are rounded to steps between their least and their largest, the
/// differences of neighbours are taken, and low and high bytes are stored apart. page_data.js reads them.
class PageArrays {
public:
    /// values: `components` numbers for each item, which are replaced by what the page will read
    /// bits:   of each number, at most 24
    /// returns: the number of the array
    int add(std::span<double> values, std::size_t components, int bits);

    /// Whole numbers, `components` for each item.
    int add_integers(std::span<const std::uint32_t> values, std::size_t components);

    /// Where each array is in the bytes, and what its numbers mean.
    [[nodiscard]] const PageJson& directory() const { return directory_; }

    /// All bytes, deflated.
    [[nodiscard]] std::string compressed() const;

private:
    void append(std::span<const std::uint32_t> numbers, int bytes_each);

    PageJson directory_ = PageJson::array();
    std::string bytes_;
};

/// Deflated bytes with zlib's header. throws: std::bad_alloc
[[nodiscard]] std::string deflated(std::string_view bytes);

}  // namespace subvol::detail
