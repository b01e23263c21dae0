// SPDX-License-Identifier: Apache-2.0
#include "subvol/brick_slice.h"

#include <utility>

#include "slice_part.h"
#include "subvol/brick_probe.h"

namespace subvol {

LimitSlice slice_limit(const Bricks& bricks, const Vec3& point, const Vec3& normal, const SliceOptions& options,
                       const BrickFields& fields) {
    LimitSlice slice = detail::empty_slice(bricks.bounds, point, normal, options);
    const auto first_alone = [&](HexMesh brick) {
        if (fields) brick = fields(std::move(brick));
        brick = with_scalar_field(brick, {});
        slice.field = brick.attributes.front().name;
        return brick;
    };
    LimitOptions quiet = options.limit;
    quiet.progress = nullptr;
    const std::vector<Vec3> places = detail::places_of(slice);
    detail::take_found(slice, probe_bricks(bricks, places, {.limit = quiet}, first_alone, options.progress));
    return slice;
}

}  // namespace subvol
