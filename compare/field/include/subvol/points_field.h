// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "subvol/field.h"
#include "subvol/rbf_volume.h"

namespace subvol {

/// The field of points (`RbfField`); nothing outside their boundary, if they have one.
///
/// throws: Error(InvalidInput) as `RbfField`
/// cost:   as `RbfField`, and a visit of the boundary's triangles above the place
class PointsField {
public:
    explicit PointsField(const RbfVolume& volume, std::size_t channel = 0);
    ~PointsField();
    PointsField(PointsField&&) noexcept;
    PointsField& operator=(PointsField&&) noexcept;

    [[nodiscard]] std::optional<double> value(const Vec3& x) const;
    [[nodiscard]] std::optional<Vec3> gradient(const Vec3& x) const;
    [[nodiscard]] Box box() const;

    /// A view that refers to this object.
    [[nodiscard]] FieldView view() const;

private:
    struct Parts;
    std::unique_ptr<const Parts> parts_;
};

}  // namespace subvol
