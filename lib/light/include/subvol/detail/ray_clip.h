// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "subvol/camera.h"
#include "subvol/clip.h"

namespace subvol::detail {

/// What a clip leaves of a ray; depths are the parameter of Ray. near_face: the face at `near` in RayClip::faces(); kNoFace at
/// the ray's origin. slices: depths of the slices that lie between both, ascending. Empty too if slices are drawn alone and
/// there are none
struct RayCut {
    static constexpr std::size_t kNoFace = static_cast<std::size_t>(-1);
    double near = 0, far = std::numeric_limits<double>::infinity();
    std::size_t near_face = kNoFace;
    std::vector<double> slices{};

    [[nodiscard]] bool empty() const { return !(near < far) && slices.empty(); }
    [[nodiscard]] bool whole() const { return near <= 0 && far == std::numeric_limits<double>::infinity() && slices.empty(); }
};

/// Cuts rays.
class RayClip {
public:
    RayClip() = default;
    explicit RayClip(const Clip& clip);

    [[nodiscard]] bool empty() const { return faces_.empty() && slices_.empty(); }
    [[nodiscard]] bool slices_alone() const { return slices_alone_; }
    [[nodiscard]] bool has_slices() const { return !slices_.empty(); }

    /// The planes, then those of the box; normals of unit length point to what is removed.
    [[nodiscard]] const std::vector<CutPlane>& faces() const { return faces_; }
    [[nodiscard]] const std::vector<CutPlane>& slices() const { return slices_; }

    /// Uses the memory of `result` again.
    void cut(const Ray& ray, RayCut& result) const;

private:
    std::vector<CutPlane> faces_, slices_;
    bool slices_alone_ = false;
};

}  // namespace subvol::detail
