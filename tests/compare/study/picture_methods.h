// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/picture_maker.h"
#include "subvol/study.h"

namespace subvol {

/// The methods of pictures with the options that each reads, as the command passes them to studies.
inline std::vector<PictureMethod> picture_methods() {
    static PictureSettings any;
    std::vector<PictureMethod> methods;
    for (const auto& row : NameTable<Method>::rows) methods.push_back({std::string(row.name), options_of(any, row.value)});
    return methods;
}

}  // namespace subvol
