// SPDX-License-Identifier: Apache-2.0
#include "subvol/clip.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "camera_axes.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

using detail::finite;

namespace {

void check(const CutPlane& plane, const char* kind, std::size_t number) {
    const std::string where = std::string(kind) + " " + std::to_string(number);
    if (!finite(plane.point) || !finite(plane.normal)) {
        throw Error(ErrorCode::InvalidInput, "a plane has a number that is not finite", where, "a point and a normal");
    }
    if (plane.normal == Vec3(0.0)) {
        throw Error(ErrorCode::InvalidInput, "the normal of a plane has no length", where, "a direction such as 0,0,1");
    }
}

CutPlane with_unit_normal(const CutPlane& plane) {
    const Vec3 size = glm::abs(plane.normal);
    return {plane.point, glm::normalize(plane.normal / std::max({size.x, size.y, size.z}))};
}

/// The planes of a box, with the normals outwards.
std::vector<CutPlane> faces_of(const Box& box) {
    std::vector<CutPlane> faces;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
            Vec3 normal(0.0);
            normal[axis] = sign;
            faces.push_back({sign < 0 ? box.lower : box.upper, normal});
        }
    }
    return faces;
}

/// Whether no corner of the box is on the normal's side.
bool keeps(const CutPlane& plane, const Box& box) {
    for (unsigned k = 0; k < 8; ++k) {
        const Vec3 corner(k & 1 ? box.upper.x : box.lower.x, k & 2 ? box.upper.y : box.lower.y,
                          k & 4 ? box.upper.z : box.lower.z);
        if (glm::dot(plane.normal, corner - plane.point) > 0) return false;
    }
    return true;
}

/// Planes as users write them.
NumbersValue planes_value(std::vector<CutPlane>& planes) {
    const auto add = [&planes](std::span<const double> row, const std::string& where) {
        const CutPlane plane{{row[0], row[1], row[2]}, {row[3], row[4], row[5]}};
        if (plane.normal == Vec3(0.0)) {
            throw Error(ErrorCode::InvalidInput, "the normal of the plane has no length", where,
                        "the last three numbers are a direction such as 0,0,1");
        }
        planes.push_back(plane);
    };
    return {.count = 6, .example = "0,0,0,0,0,1: a point of the plane and its normal", .repeatable = true, .add = add};
}

NumbersValue box_value(std::optional<Box>& box) {
    const auto set = [&box](std::span<const double> row, const std::string& where) {
        box = Box{{row[0], row[1], row[2]}, {row[3], row[4], row[5]}};
        for (int axis = 0; axis < 3; ++axis) {
            if (box->lower[axis] < box->upper[axis]) continue;
            throw Error(ErrorCode::InvalidInput, std::string("the box is empty along ") + "xyz"[axis], where,
                        "the lower corner first, then the upper one");
        }
    };
    return {.count = 6, .example = "0,0,0,1,1,1: the lower corner, then the upper one", .add = set};
}

}  // namespace

std::vector<Option> options_of(Clip& clip) {
    return {
        Option("clip", planes_value(clip.planes))
            .help("PX,PY,PZ,NX,NY,NZ",
                  "cut away what lies on the side of this plane to which its normal points: a point and the normal "
                  "(repeatable)"),
        Option("clip-box", box_value(clip.box))
            .help("X0,Y0,Z0,X1,Y1,Z1", "cut away what lies outside this box: its lower and its upper corner"),
        Option("slice", planes_value(clip.slices))
            .help("PX,PY,PZ,NX,NY,NZ",
                  "draw the volume on this plane alone, opaque and in the colours of its values: a point and the normal "
                  "(repeatable)"),
        Option("around", clip.around_slices).help("draw the volume around the slices too, as --look says").only_with("slice")};
}

bool Clip::removes(const Vec3& place) const {
    for (const CutPlane& plane : planes) {
        if (glm::dot(place - plane.point, plane.normal) > 0) return true;
    }
    return box && glm::min(glm::max(place, box->lower), box->upper) != place;
}

void validate(const Clip& clip) {
    for (std::size_t i = 0; i < clip.planes.size(); ++i) check(clip.planes[i], "clip plane", i);
    for (std::size_t i = 0; i < clip.slices.size(); ++i) check(clip.slices[i], "slice", i);
    if (!clip.box) return;
    const auto& [lower, upper] = *clip.box;
    if (!finite(lower) || !finite(upper) || !(lower.x < upper.x && lower.y < upper.y && lower.z < upper.z)) {
        throw Error(ErrorCode::InvalidInput, "the clip box is empty", {}, "the lower corner first, then the upper one");
    }
}

Clip without_far_faces(const Clip& clip, const Box& box) {
    Clip near = clip;
    std::erase_if(near.planes, [&](const CutPlane& plane) { return keeps(plane, box); });
    if (near.box) {
        const auto faces = faces_of(*near.box);
        if (std::ranges::all_of(faces, [&](const CutPlane& face) { return keeps(face, box); })) near.box.reset();
    }
    return near;
}

namespace detail {

RayClip::RayClip(const Clip& clip, double diagonal)
    : slices_alone_(clip.slices_alone()), tolerance_world_(diagonal > 0 ? kSliceTolerance * diagonal : 0) {
    validate(clip);
    for (const CutPlane& plane : clip.planes) faces_.push_back(with_unit_normal(plane));
    if (clip.box) {
        const auto faces = faces_of(*clip.box);
        faces_.insert(faces_.end(), faces.begin(), faces.end());
    }
    for (const CutPlane& plane : clip.slices) slices_.push_back(with_unit_normal(plane));
}

void RayClip::cut(const Ray& ray, RayCut& result) const {
    result.near = 0;
    result.far = ray.end;
    result.near_face = RayCut::kNoFace;
    result.slices.clear();
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        const double height = glm::dot(faces_[i].normal, faces_[i].point - ray.origin);  // above the ray's origin
        const double speed = glm::dot(faces_[i].normal, ray.direction);
        if (speed == 0) {
            if (height < 0) result.far = -1;
            continue;
        }
        const double depth = height / speed;
        if (speed > 0) {
            result.far = std::min(result.far, depth);
        } else if (depth > result.near) {
            result.near = depth;
            result.near_face = i;
        }
    }
    for (const CutPlane& slice : slices_) {
        const double speed = glm::dot(slice.normal, ray.direction);
        if (!(std::abs(speed) > kSliceTolerance)) continue;
        const RaySlice met{glm::dot(slice.normal, slice.point - ray.origin) / speed, tolerance_world_ / std::abs(speed)};
        if (met.depth > met.tolerance && met.meets(result.near, result.far)) result.slices.push_back(met);
    }
    std::ranges::sort(result.slices, {}, &RaySlice::depth);
    if (slices_alone_ && result.slices.empty()) result.far = -1;
}

}  // namespace detail

}  // namespace subvol
