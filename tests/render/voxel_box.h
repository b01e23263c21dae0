// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "subvol/voxels.h"

namespace subvol::test {

/// n³ voxels that fill a box, with the values of a field at their centres; inactive where it has none.
class VoxelBox : public Voxels {
public:
    VoxelBox(const Box& box, int n, const std::function<std::optional<double>(const Vec3&)>& field)
        : n_(n), step_(box.size() / double(n)), lower_(box.lower) {
        for (int k = 0; k < n; ++k) {
            for (int j = 0; j < n; ++j) {
                for (int i = 0; i < n; ++i) values_.push_back(field(origin() + step_ * Vec3(i, j, k)));
            }
        }
    }
    Mat3 to_world() const override { return {Vec3(step_.x, 0, 0), Vec3(0, step_.y, 0), Vec3(0, 0, step_.z)}; }
    Vec3 origin() const override { return lower_ + 0.5 * step_; }
    std::array<Voxel, 2> range() const override { return {Voxel{0, 0, 0}, Voxel{n_ - 1, n_ - 1, n_ - 1}}; }
    std::unique_ptr<VoxelCursor> cursor() const override { return std::make_unique<Cursor>(*this); }

    [[nodiscard]] std::optional<double> at(const Voxel& v) const {
        for (const int x : v) {
            if (x < 0 || x >= n_) return std::nullopt;
        }
        return values_[static_cast<std::size_t>(v[0] + n_ * (v[1] + n_ * v[2]))];
    }
    [[nodiscard]] Voxel voxel_at(const Vec3& x) const { return Voxel(floor_of((x - lower_) / step_)); }
    [[nodiscard]] const Vec3& lower() const { return lower_; }
    [[nodiscard]] const Vec3& step() const { return step_; }
    [[nodiscard]] int count() const { return n_; }

private:
    static Voxel floor_of(const Vec3& x) { return {int(std::floor(x.x)), int(std::floor(x.y)), int(std::floor(x.z))}; }
    class Cursor : public VoxelCursor {
    public:
        explicit Cursor(const VoxelBox& grid) : grid_(grid) {}
        VoxelBlock block(const Voxel& voxel) override { return {VoxelBlock::Kind::Mixed, voxel, 1, 0}; }
        VoxelCorners corners(const Voxel& lower) override {
            VoxelCorners corners;
            for (unsigned k = 0; k < 8; ++k) {
                const auto v = grid_.at({lower[0] + int(k & 1), lower[1] + int(k >> 1 & 1), lower[2] + int(k >> 2)});
                if (v) corners.active |= 1u << k;
                corners.values[k] = v.value_or(1e9);  // must never be used
            }
            return corners;
        }

    private:
        const VoxelBox& grid_;
    };

    int n_;
    Vec3 step_, lower_;
    std::vector<std::optional<double>> values_;
};

}  // namespace subvol::test
