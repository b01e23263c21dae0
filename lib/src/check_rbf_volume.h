#pragma once

#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// throws: Error(InvalidInput) if array lengths differ, a number is not finite, or the kernel is not radial
void check_rbf_volume(const RbfVolume& volume);

}  // namespace subvol::detail
