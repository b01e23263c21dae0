// SPDX-License-Identifier: Apache-2.0
#include "subvol/names.h"

#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::detail {

void throw_unknown_name(const std::string& given, const std::string& where, const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    throw Error(ErrorCode::InvalidInput, "'" + shortened(given) + "' is unknown" + did_you_mean(given, names), where,
                "supported: " + all);
}

}  // namespace subvol::detail
