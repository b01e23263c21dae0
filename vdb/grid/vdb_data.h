// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openvdb_grids.h"

#include <string>
#include <utility>

#include "subvol/vdb_grid.h"

namespace subvol::detail {

/// What a VdbGrid holds.
class VdbData : public GridData {
public:
    explicit VdbData(const openvdb::GridBase::Ptr& from);

    [[nodiscard]] static const VdbData& of(const VdbGrid& grid) { return static_cast<const VdbData&>(*grid.data_); }

    [[nodiscard]] const GridReport& report() const override { return report_; }
    [[nodiscard]] std::optional<double> value(const Vec3& x) const override;
    [[nodiscard]] std::unique_ptr<Voxels> voxels() const override;

    openvdb::GridBase::Ptr grid;
    openvdb::FloatGrid::Ptr floats;  ///< the same grid if it is one of floats, else null
    bool is_level_set;               ///< whether inactive voxels with values below 0 lie inside and have values, too

private:
    GridReport report_;
};

/// Wraps a grid and fills its report.
[[nodiscard]] VdbGrid make_vdb_grid(const openvdb::GridBase::Ptr& grid);

constexpr double kLeastVoxel_world = 1.45e-5;  // OpenVDB treats a transform as singular if its determinant is below 3e-15

/// The edges of a voxel of a grid, in the columns, and the centre of its voxel 0, 0, 0.
///
/// throws: Error(InvalidInput) if the transform is not linear
[[nodiscard]] std::pair<Mat3, Vec3> axes_of(const openvdb::GridBase& grid);

/// Refuses voxels that have no volume, or that no grid has.
///
/// name: of the grid, for the message
void check_axes(const Mat3& to_world, const Vec3& origin, const std::string& name);

/// Stores the box that named views show in the metadata of a grid, which its report gets it from.
void set_frame(openvdb::GridBase& grid, const Box& frame);

}  // namespace subvol::detail
