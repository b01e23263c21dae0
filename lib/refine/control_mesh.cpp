// SPDX-License-Identifier: Apache-2.0
#include "control_mesh.h"

#include "subvol/error.h"

namespace subvol::detail {

void check_levels(int levels) {
    if (levels < 0 || levels > 10) {
        throw Error(ErrorCode::InvalidInput, "the number of levels is " + std::to_string(levels), {}, "0 to 10");
    }
}

HexMesh control_mesh(HexMesh mesh, const SchemeOptions& scheme, int levels) {
    check_levels(levels);
    validate(mesh);
    HexMesh control = without_unused_points(std::move(mesh));
    if (scheme.crease_angle_deg && levels > 0) tag_creases(control, *scheme.crease_angle_deg);
    return control;
}

}  // namespace subvol::detail
