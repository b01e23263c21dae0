// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// throws: Error(InvalidInput) as `validate`, if the kernel is not radial, or there are 2³² points or more
void check_rbf_volume(const RbfVolume& volume);

}  // namespace subvol::detail
