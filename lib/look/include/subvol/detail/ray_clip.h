// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "subvol/camera.h"
#include "subvol/clip.h"

namespace subvol::detail {

/// A slice and a face of the volume at the same place are rounded differently. So a slice belongs to what its plane comes as
/// near to as this, in parts of the volume's diagonal: single precision with room, and far less than a pixel.
inline constexpr double kSliceTolerance = 2e-6;

/// Where a ray meets a slice: the depth, and the tolerance along the ray.
struct RaySlice {
    double depth = 0, tolerance = 0;

    /// The one rule for what a slice belongs to, by which every renderer decides (projected_clip.glsl is its twin). It also
    /// holds for stretches without length, or turned round by rounding, as where a clip leaves no more than a face.
    [[nodiscard]] bool meets(double from, double to) const { return depth >= from - tolerance && depth <= to + tolerance; }

    /// The place of that stretch at which the slice is seen.
    [[nodiscard]] double within(double from, double to) const { return std::min(std::max(depth, from), to); }
};

/// What a clip, and the end of the ray, leave of a ray; depths are the parameter of Ray.
struct RayCut {
    static constexpr std::size_t kNoFace = static_cast<std::size_t>(-1);
    double near = 0, far = std::numeric_limits<double>::infinity();
    std::size_t near_face = kNoFace;  ///< the face at `near` in RayClip::faces(); kNoFace at the ray's origin
    /// Slices that belong to what lies between `near` and `far`, ascending. Empty too if slices are drawn alone and there are
    /// none
    std::vector<RaySlice> slices{};

    [[nodiscard]] bool empty() const { return !(near < far) && slices.empty(); }
    [[nodiscard]] bool whole() const { return near <= 0 && far == std::numeric_limits<double>::infinity() && slices.empty(); }
};

/// Cuts rays.
class RayClip {
public:
    RayClip() = default;
    /// diagonal: of the volume that is cut
    RayClip(const Clip& clip, double diagonal);

    [[nodiscard]] bool empty() const { return faces_.empty() && slices_.empty(); }
    [[nodiscard]] bool slices_alone() const { return slices_alone_; }
    [[nodiscard]] bool has_slices() const { return !slices_.empty(); }

    /// The planes, then those of the box; normals of unit length point to what is removed.
    [[nodiscard]] const std::vector<CutPlane>& faces() const { return faces_; }
    [[nodiscard]] const std::vector<CutPlane>& slices() const { return slices_; }

    [[nodiscard]] RayClip without_slices() const {
        RayClip faces = *this;
        faces.slices_.clear();
        faces.slices_alone_ = false;
        return faces;
    }

    /// A slice that goes through the ray's origin, or along the ray, is not seen. Uses the memory of `result` again.
    void cut(const Ray& ray, RayCut& result) const;

private:
    std::vector<CutPlane> faces_, slices_;
    bool slices_alone_ = false;
    double tolerance_world_ = 0;
};

}  // namespace subvol::detail
