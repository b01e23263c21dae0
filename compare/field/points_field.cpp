// SPDX-License-Identifier: Apache-2.0
#include "subvol/points_field.h"

#include "closed_surface.h"
#include "subvol/rbf_field.h"

namespace subvol {

struct PointsField::Parts {
    RbfField field;
    detail::ClosedSurface boundary;
    Box box;

    Parts(const RbfVolume& volume, std::size_t channel)
        : field(volume, {.channel = channel}), boundary(volume.boundary), box(volume.bounds) {}

    [[nodiscard]] bool holds(const Vec3& x) const { return boundary.empty() || boundary.holds(x); }
};

PointsField::PointsField(const RbfVolume& volume, std::size_t channel)
    : parts_(std::make_unique<const Parts>(volume, channel)) {
}
PointsField::~PointsField() = default;
PointsField::PointsField(PointsField&&) noexcept = default;
PointsField& PointsField::operator=(PointsField&&) noexcept = default;

std::optional<double> PointsField::value(const Vec3& x) const {
    return parts_->holds(x) ? parts_->field.value(x) : std::nullopt;
}

std::optional<Vec3> PointsField::gradient(const Vec3& x) const {
    if (!parts_->holds(x)) return std::nullopt;
    const auto jet = parts_->field.value_and_gradient(x);
    return jet ? std::optional(jet->gradient) : std::nullopt;
}

Box PointsField::box() const {
    return parts_->box;
}

FieldView PointsField::view() const {
    return {.value = [this](const Vec3& x) { return value(x); },
            .gradient = [this](const Vec3& x) { return gradient(x); },
            .box = box()};
}

}  // namespace subvol
