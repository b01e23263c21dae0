// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "subvol/option_names.h"
#include "subvol/vec.h"

namespace subvol {

/// A plane through `point`.
struct CutPlane {
    Vec3 point{0.0};
    Vec3 normal{0, 0, 1};  ///< of any length but 0
};

/// How a volume is cut open in a picture. What is left of a ray is one interval, as half spaces and a box are convex; every
/// renderer cuts its rays exactly there. Where a ray enters through a cut inside the volume it meets the field's value at that
/// place, and light shines on a surface with the plane's normal.
struct Clip {
    std::vector<CutPlane> planes{};  ///< each removes what lies on the side to which its normal points
    std::optional<Box> box{};        ///< removes what lies outside
    /// Planes that are drawn where they are inside the (cut) volume or on its faces (to 2e-6 of its diagonal): opaque, without
    /// light, in the colours of the values there
    std::vector<CutPlane> slices{};
    bool around_slices = false;  ///< whether the volume is drawn too where there are slices; if not, the slices are drawn alone

    [[nodiscard]] bool empty() const { return planes.empty() && !box && slices.empty(); }
    [[nodiscard]] bool slices_alone() const { return !slices.empty() && !around_slices; }
    /// Whether the planes and the box remove a place.
    [[nodiscard]] bool removes(const Vec3& place) const;
};

[[nodiscard]] std::vector<Option> options_of(Clip& clip);

/// throws: Error(InvalidInput) if a number is not finite, a normal has no length or the box is empty
void validate(const Clip& clip);

/// Returns the clip without planes and box faces that remove nothing from `box`.
[[nodiscard]] Clip without_far_faces(const Clip& clip, const Box& box);

}  // namespace subvol
