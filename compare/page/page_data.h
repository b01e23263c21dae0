// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "page_arrays.h"
#include "subvol/page.h"

namespace subvol::detail {

/// How the data of a page are made smaller.
///
/// kept: the part of the kernels that is left after merging
struct PageRounding {
    int place_bits = 21, value_bits = 16;  // cells at walls may be a millionth of the body
    double kept = 1;
};

/// The data of a page: a description, with the places of the arrays, and their bytes.
struct PageData {
    PageJson json;
    std::string compressed;
    std::size_t kernels = 0, kept = 0, triangles = 0;
    std::vector<PageError> errors{};  // of each field
};

/// with_errors: they take longer than all else
[[nodiscard]] PageData page_data(std::span<const PageStep> steps, std::size_t fields, const PageRounding& rounding,
                                 bool with_errors);

}  // namespace subvol::detail
