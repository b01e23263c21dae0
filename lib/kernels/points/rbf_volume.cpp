// SPDX-License-Identifier: Apache-2.0
#include "subvol/rbf_volume.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "subvol/error.h"

namespace subvol {

namespace {

template <class Numbers>
bool all_finite(const Numbers& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](float number) { return std::isfinite(number); });
}

[[noreturn]] void refuse_point(std::size_t point, const std::string& what) {
    throw Error(ErrorCode::InvalidInput, "point " + std::to_string(point) + ": " + what);
}

bool is_finite(const Vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// Whether the frame is positive definite, or so nearly that rounding to floats may have made it indefinite. Its extents along
/// the axes are made 1 first, so that this does not depend on how they differ.
bool is_positive(const Symmetric3& s) {
    constexpr double kRounding =
        1e-6;  // each entry may be wrong by 2⁻²⁴ of itself, a root of the unit matrix by three of these
    const auto cosine = [&](std::size_t entry, std::size_t a, std::size_t b) {
        return double(s[entry]) / (std::sqrt(double(s[a])) * std::sqrt(double(s[b])));
    };
    if (!(s[0] > 0 && s[3] > 0 && s[5] > 0)) return false;
    // The pivots of Cholesky's decomposition.
    const double xy = cosine(1, 0, 3), xz = cosine(2, 0, 5), yz = cosine(4, 3, 5), one = 1 + kRounding;
    const double second = one - xy * xy / one;
    if (!(second > 0)) return false;
    const double mixed = yz - xy * xz / one;
    return one - xz * xz / one - mixed * mixed / second > 0;
}

void check_names(const std::vector<RbfChannel>& channels) {
    if (channels.empty()) throw Error(ErrorCode::InvalidInput, "the points have no channel", {}, "at least one");
    std::set<std::string> names;
    for (const auto& channel : channels) {
        if (!names.insert(channel.name).second) {
            throw Error(ErrorCode::InvalidInput, "two channels are named \"" + channel.name + "\"");
        }
    }
}

void check_channel(const RbfChannel& channel, std::size_t points) {
    const std::string name = "channel \"" + channel.name + "\"";
    if (channel.values.size() != points || channel.gradients.size() != points || channel.moments.size() != points) {
        throw Error(ErrorCode::InvalidInput, name + " does not have one value, gradient and moment per point");
    }
    if (!channel.hessians.empty() && channel.hessians.size() != points) {
        throw Error(ErrorCode::InvalidInput, name + " does not have one Hessian per point", {}, "as many as points, or none");
    }
    for (std::size_t i = 0; i < points; ++i) {
        if (!std::isfinite(channel.values[i])) refuse_point(i, "the value of " + name + " is not finite");
        if (!all_finite(channel.gradients[i])) refuse_point(i, "the gradient of " + name + " is not finite");
        if (!std::isfinite(channel.moments[i])) refuse_point(i, "the moment of " + name + " is not finite");
    }
    for (std::size_t i = 0; i < channel.hessians.size(); ++i) {
        if (!all_finite(channel.hessians[i])) refuse_point(i, "the Hessian of " + name + " is not finite");
    }
}

void check_surface(const Surface& surface) {
    for (const Vec3& p : surface.points) {
        if (!is_finite(p)) throw Error(ErrorCode::InvalidInput, "a coordinate of the boundary surface is not finite");
    }
    for (const auto& triangle : surface.triangles) {
        for (const Index p : triangle) {
            if (p < surface.points.size()) continue;
            throw Error(ErrorCode::InvalidInput, "the boundary surface has no point " + std::to_string(p), {},
                        "it has " + std::to_string(surface.points.size()) + ", counted from 0");
        }
    }
}

}  // namespace

Box box_of(const RbfVolume& volume) {
    Box box;
    for (const Vec3& p : volume.boundary.points.empty() ? volume.centers : volume.boundary.points) box.add(p);
    return box;
}

void validate(const RbfVolume& volume) {
    validate(volume.kernel);
    if (volume.frames.size() != volume.size())
        throw Error(ErrorCode::InvalidInput, "the number of frames is not that of the points");
    for (std::size_t i = 0; i < volume.size(); ++i) {
        if (!is_finite(volume.centers[i])) refuse_point(i, "a coordinate is not finite");
        const auto& s = volume.frames[i];
        if (!all_finite(s)) refuse_point(i, "the frame is not finite");
        if (!is_positive(s)) {
            throw Error(ErrorCode::InvalidInput, "point " + std::to_string(i) + ": the frame is not positive definite", {},
                        "a covariance: dᵀSd > 0 for every direction d");
        }
    }
    check_names(volume.channels);
    for (const auto& channel : volume.channels) check_channel(channel, volume.size());
    check_surface(volume.boundary);
}

}  // namespace subvol
