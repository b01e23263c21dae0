// SPDX-License-Identifier: Apache-2.0
#include "check_rbf_volume.h"

#include "subvol/error.h"
#include "subvol/hex_mesh.h"

namespace subvol::detail {

void check_rbf_volume(const RbfVolume& volume) {
    if (!is_radial(volume.kernel)) {
        throw Error(ErrorCode::InvalidInput, "the kernel is not radial, frames have no axes for it", {}, "a radial kernel");
    }
    if (volume.size() >= kNone) {
        throw Error(ErrorCode::InvalidInput, std::to_string(volume.size()) + " kernels are too many", {}, "fewer than 2³²");
    }
    validate(volume);
}

}  // namespace subvol::detail
