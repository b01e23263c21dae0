// SPDX-License-Identifier: Apache-2.0
#include "projected_frame.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr double kMostUnits = 1e30;       // fits into a float, with room
constexpr double kFarValue = 1e12;        // values further out are taken as this one
constexpr std::size_t kMostKnots = 2048;  // that a fragment goes through

/// The range of the knots, in parts of which values are counted.
struct Values {
    double first, range;

    [[nodiscard]] float parts(double value) const {
        return static_cast<float>(std::clamp((value - first) / range, -kFarValue, kFarValue));
    }
};

Values set_knots(GlTetFrame& frame, const Optics& optics) {
    const auto knots = optics.knots();
    if (knots.size() > kMostKnots) {
        throw Error(ErrorCode::MissingCapability,
                    std::to_string(knots.size()) + " values of colours and opacities are too many", {},
                    "at most " + std::to_string(kMostKnots) + " for projected tetrahedra, or the method tets");
    }
    const double range = knots.back() - knots.front();
    const Values values{knots.front(), range > 0 ? range : 1};
    frame.opacity_units = frame.scale / optics.opacity_unit();
    if (!(frame.opacity_units < kMostUnits)) {
        throw Error(ErrorCode::InvalidInput, "the opacity unit is " + number_text(optics.opacity_unit()), {},
                    "more than 1e-30 of the volume");
    }
    for (const double knot : knots) {
        const Vec3 color = optics.color(knot);
        const double opacity = -std::expm1(-optics.extinction(knot) * optics.opacity_unit());
        const auto to_float = [](double v) { return static_cast<float>(v); };
        frame.knots.push_back({{to_float(color.x), to_float(color.y), to_float(color.z), to_float(opacity)},
                               {to_float((knot - values.first) / values.range), 0, 0, 0}});
    }
    return values;
}

void set_points(GlTetFrame& frame, const TetMesh& mesh, const View& view, double middle_depth, const Values& values) {
    frame.points.resize(mesh.points.size());
    parallel_each(mesh.points.size(), [&](std::size_t p) {
        const Vec3 eye = (view.to_eye(mesh.points[p].position) - Vec3(0, 0, middle_depth)) / frame.scale;
        frame.points[p] = {static_cast<float>(eye.x), static_cast<float>(eye.y), static_cast<float>(eye.z),
                           values.parts(mesh.points[p].value)};
    });
}

void set_planes(GlTetFrame& frame, const View& view, double middle_depth, const RayClip& clip) {
    const auto add = [&](const CutPlane& plane) {
        const Vec3 place = (view.to_eye(plane.point) - Vec3(0, 0, middle_depth)) / frame.scale;
        Vec3 normal;
        for (int k = 0; k < 3; ++k) normal[k] = glm::dot(view.axes()[static_cast<std::size_t>(k)], plane.normal);
        frame.planes.push_back({static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z),
                                static_cast<float>(-glm::dot(normal, place))});
    };
    for (const CutPlane& face : clip.faces()) add(face);
    for (const CutPlane& slice : clip.slices()) add(slice);
    frame.faces = clip.faces().size();
    frame.slices_alone = clip.slices_alone();
}

bool contains(const Box& box, const Vec3& p) {
    return glm::all(glm::lessThanEqual(box.lower, p)) && glm::all(glm::lessThanEqual(p, box.upper));
}

}  // namespace

GlTetFrame make_tet_frame(const TetMesh& mesh, const Box& box, const View& view, const Optics& optics, const RayClip& clip,
                          bool eye_value) {
    GlTetFrame frame;
    const double diagonal = glm::length(box.upper - box.lower);
    if (diagonal > 0) frame.scale = diagonal;
    const double middle_depth = view.to_eye(0.5 * (box.lower + box.upper)).z;
    frame.middle_depth = middle_depth / frame.scale;
    const Values values = set_knots(frame, optics);
    set_points(frame, mesh, view, middle_depth, values);
    set_planes(frame, view, middle_depth, clip);
    if (eye_value && view.perspective() && contains(box, view.eye()))
        frame.eye_value = values.parts(value_at(mesh, view.eye()));
    return frame;
}

}  // namespace subvol::detail
