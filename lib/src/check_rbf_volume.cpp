#include "check_rbf_volume.h"

#include <algorithm>
#include <cmath>

#include "subvol/error.h"
#include "subvol/hex_mesh.h"

namespace subvol::detail {
namespace {

template <std::size_t N>
bool finite(const std::array<float, N>& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); });
}

void check_lengths(const RbfVolume& volume) {
    const std::size_t count = volume.size();
    if (count >= kNone)
        throw Error(ErrorCode::InvalidInput, std::to_string(count) + " kernels are too many", {}, "fewer than 2³²");
    bool same = volume.frames.size() == count;
    for (const auto& c : volume.channels)
        same = same && c.values.size() == count && c.gradients.size() == count && c.moments.size() == count;
    if (!same) {
        throw Error(ErrorCode::InvalidInput, "the arrays of an RBF volume differ in length", {},
                    std::to_string(count) + " entries, one a center");
    }
}

}  // namespace

void check_rbf_volume(const RbfVolume& volume) {
    if (!is_radial(volume.kernel)) {
        throw Error(ErrorCode::InvalidInput, "the kernel is not radial, frames have no axes for it", {}, "a radial kernel");
    }
    check_lengths(volume);
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const Vec3& p = volume.centers[i];
        bool good = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && finite(volume.frames[i]);
        for (const auto& c : volume.channels)
            good = good && std::isfinite(c.values[i]) && finite(c.gradients[i]) && std::isfinite(c.moments[i]);
        if (!good) throw Error(ErrorCode::InvalidInput, "kernel " + std::to_string(i) + " has a number that is not finite");
    }
}

}  // namespace subvol::detail
