// SPDX-License-Identifier: Apache-2.0
#include "ray_ends.h"

#include <algorithm>

namespace subvol::detail {

void RayEnds::add(const RayPlane& plane, TetFace face) {
    if (std::any_of(ends_.begin(), ends_.end(), [&](const End& end) { return end.face == face; })) return;
    if (const auto crossed = cross_face(*mesh_, plane, face)) ends_.push_back({face, crossed->crossing().t, false});
}

void RayEnds::add_near(const RayPlane& plane, TetFace face) {
    for (const Index point : mesh_->corners(face)) {
        for (const TetFace other : scene_->faces_at(point)) add(plane, other);
    }
}

void RayEnds::find(const RayPlane& plane, const Ray& ray) {
    hits_.clear();
    ends_.clear();
    scene_->find_crossed(ray, hits_);
    std::ranges::sort(hits_);  // so that what is found does not depend on Embree's tree, which other faces change
    hits_.erase(std::unique(hits_.begin(), hits_.end()), hits_.end());
    for (const TetFace face : hits_) {
        const auto before = ends_.size();
        add(plane, face);
        // In single precision the ray was on the wrong side of an edge: it crosses a neighbour of the face.
        if (ends_.size() == before) add_near(plane, face);
    }
}

TetFace RayEnds::first_unwalked() const {
    const End* first = nullptr;
    for (const End& end : ends_) {
        if (end.walked) continue;
        if (!first || end.t < first->t || (end.t == first->t && end.face < first->face)) first = &end;
    }
    return first ? first->face : kNone;
}

void RayEnds::mark_walked(const RayPlane& plane, TetFace start, TetFace end) {
    const auto find = [&](TetFace face) {
        return std::find_if(ends_.begin(), ends_.end(), [&](const End& e) { return e.face == face; });
    };
    find(start)->walked = true;
    if (find(end) == ends_.end()) {  // missed in single precision, and maybe others beside it too
        add(plane, end);
        add_near(plane, start);
        add_near(plane, end);
    }
    if (const auto found = find(end); found != ends_.end()) found->walked = true;
}

}  // namespace subvol::detail
