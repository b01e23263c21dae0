// SPDX-License-Identifier: Apache-2.0
// Volumes of kernels as OpenVDB points, and back. The grid holds a point for each kernel; what is not of points is metadata:
//
//     attributes   P, id, frame (the symmetric matrix); orient, scale, pscale (its axes, for other programs);
//                  for each channel the value, and with a suffix its gradient, moment and, if there is one, Hessian
//     metadata     the kernel as JSON, names of channels, number of boundary triangles
//     beside it    the boundary, in a file of its own
//
// The voxel size is the cube root of the product of the mean volume of a point and the wanted points per voxel, within what
// transforms and 32-bit indices allow. Names of channels become names of attributes by replacing characters; the original names
// are in the metadata. OpenVDB orders points by leaf, so a reader sorts them by id again. Orient, scale and pscale are not
// read.
#include "subvol/vdb_points.h"

#include <openvdb/points/PointConversion.h>
#include <openvdb/tools/PointIndexGrid.h>
#include "openvdb_grids.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <set>

#include "subvol/detail/principal_axes.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/surface_io.h"
#include "subvol/error.h"
#include "subvol/points_io.h"
#include "vdb_stream.h"

namespace subvol {

using namespace detail;

namespace {

namespace points = openvdb::points;
using Grid = points::PointDataGrid;
using Leaf = Grid::TreeType::LeafNodeType;

constexpr const char* kGridName = "points";
constexpr const char* kKernel = "kernel";
constexpr const char* kTriangles = "boundary_triangles";
constexpr const char* kChannel = "channel_";
constexpr const char* kGradient = "_gradient";
constexpr const char* kMoment = "_moment";
constexpr const char* kHessian = "_hessian";
constexpr double kLeastVoxel_world = 1.45e-5;  // OpenVDB treats a transform as singular if its determinant is below 3e-15
constexpr double kMostVoxels = 1 << 30;        // from the origin along an axis, as indices have 32 bits

/// Unique attribute names for channels that OpenVDB and Houdini accept.
std::vector<std::string> attribute_names(const std::vector<std::string>& channels) {
    std::set<std::string> used{"P", "id", "frame", "orient", "scale", "pscale"};
    std::vector<std::string> names;
    for (std::string name : channels) {
        for (char& c : name) {
            if (!std::isalnum(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) > 127) c = '_';
        }
        if (name.empty() || std::isdigit(static_cast<unsigned char>(name.front()))) name.insert(0, 1, '_');
        const auto attributes = [&] { return std::array{name, name + kGradient, name + kMoment, name + kHessian}; };
        while (std::ranges::any_of(attributes(), [&](const std::string& one) { return used.contains(one); })) name += '_';
        for (const std::string& one : attributes()) used.insert(one);
        names.push_back(name);
    }
    return names;
}

/// The voxel size that gives this many points per voxel on average; det J is the volume per point.
double voxel_size(const RbfVolume& volume, double points_per_voxel) {
    const double radius = support_radius(volume.kernel);
    double room = 0, farthest = 0;
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const double determinant = glm::determinant(matrix(volume.frames[i]));
        room += std::sqrt(std::max(determinant, 0.0)) / (radius * radius * radius);
        const Vec3 p = glm::abs(volume.centers[i]);
        farthest = std::max({farthest, p.x, p.y, p.z});
    }
    const double mean = volume.size() > 0 ? room / static_cast<double>(volume.size()) : 1;
    return std::max({std::cbrt(mean * points_per_voxel), kLeastVoxel_world, farthest / kMostVoxels});
}

openvdb::Vec3f to_vdb(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

openvdb::Mat3s to_vdb(const Symmetric3& tensor) {
    const auto& [xx, xy, xz, yy, yz, zz] = tensor;
    return {xx, xy, xz, xy, yy, yz, xz, yz, zz};
}

Symmetric3 from_vdb(const openvdb::Mat3s& s) {
    return {s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2)};
}

/// A point grid, to which attributes are added one by one.
class PointsWriter {
public:
    explicit PointsWriter(const RbfVolume& volume, double points_per_voxel) : volume_(volume) {
        std::vector<openvdb::Vec3d> centers;
        for (const Vec3& p : volume.centers) centers.emplace_back(p.x, p.y, p.z);
        const points::PointAttributeVector<openvdb::Vec3d> positions(centers);
        const auto transform = openvdb::math::Transform::createLinearTransform(voxel_size(volume, points_per_voxel));
        order_ = openvdb::tools::createPointIndexGrid<openvdb::tools::PointIndexGrid>(positions, *transform);
        grid_ = points::createPointDataGrid<points::NullCodec, Grid>(*order_, positions, *transform);
        grid_->setName(kGridName);
    }

    /// value(i): the attribute of point i
    template <class T, class Value>
    void add(const std::string& name, const Value& value) {
        std::vector<T> values;
        values.reserve(volume_.size());
        for (std::size_t i = 0; i < volume_.size(); ++i) values.push_back(value(i));
        points::appendAttribute<T>(grid_->tree(), name);
        points::populateAttribute(grid_->tree(), order_->tree(), name, points::PointAttributeVector<T>(values));
    }

    [[nodiscard]] const Grid::Ptr& grid() const { return grid_; }

private:
    const RbfVolume& volume_;
    openvdb::tools::PointIndexGrid::Ptr order_;
    Grid::Ptr grid_;
};

void add_shapes(PointsWriter& writer, const RbfVolume& volume) {
    writer.add<openvdb::Mat3s>("frame", [&](std::size_t i) { return to_vdb(volume.frames[i]); });
    std::vector<PrincipalAxes> axes;
    std::vector<double> sizes;
    for (const auto& frame : volume.frames) {
        axes.push_back(principal_axes(frame));
        const Vec3& a = axes.back().half_axes;
        sizes.push_back(std::cbrt(a.x * a.y * a.z));
    }
    writer.add<openvdb::Quats>("orient", [&](std::size_t i) {
        const auto [w, x, y, z] = quaternion(axes[i].directions);
        return openvdb::Quats(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), static_cast<float>(w));
    });
    writer.add<openvdb::Vec3f>("scale", [&](std::size_t i) { return to_vdb(axes[i].half_axes / sizes[i]); });
    writer.add<float>("pscale", [&](std::size_t i) { return static_cast<float>(sizes[i]); });
}

void add_channels(PointsWriter& writer, const RbfVolume& volume) {
    std::vector<std::string> names;
    for (const auto& channel : volume.channels) {
        writer.grid()->insertMeta(kChannel + std::to_string(names.size()), openvdb::StringMetadata(channel.name));
        names.push_back(channel.name);
    }
    names = attribute_names(names);
    for (std::size_t c = 0; c < names.size(); ++c) {
        const RbfChannel& channel = volume.channels[c];
        writer.add<float>(names[c], [&](std::size_t i) { return channel.values[i]; });
        writer.add<openvdb::Vec3f>(names[c] + kGradient, [&](std::size_t i) {
            const auto& g = channel.gradients[i];
            return openvdb::Vec3f(g[0], g[1], g[2]);
        });
        writer.add<float>(names[c] + kMoment, [&](std::size_t i) { return channel.moments[i]; });
        if (channel.hessians.empty()) continue;
        writer.add<openvdb::Mat3s>(names[c] + kHessian, [&](std::size_t i) { return to_vdb(channel.hessians[i]); });
    }
}

Grid::Ptr make_grid(const RbfVolume& volume, const VdbPointsOptions& options) {
    openvdb::initialize();
    PointsWriter writer(volume, options.points_per_voxel);
    writer.add<std::int32_t>("id", [](std::size_t i) { return static_cast<std::int32_t>(i); });
    add_shapes(writer, volume);
    add_channels(writer, volume);
    Grid::Ptr grid = writer.grid();
    grid->setCreator(options.creator);
    grid->insertMeta(kKernel, openvdb::StringMetadata(to_json(volume.kernel)));
    grid->insertMeta(kTriangles, openvdb::Int64Metadata(static_cast<std::int64_t>(volume.boundary.triangles.size())));
    return grid;
}

template <class T>
using Handle = points::AttributeHandle<T, points::UnknownCodec>;

/// The attributes of a channel in one leaf.
struct ChannelHandles {
    Handle<float> values;
    Handle<openvdb::Vec3f> gradients;
    Handle<float> moments;
    std::optional<Handle<openvdb::Mat3s>> hessians;

    ChannelHandles(const Leaf& leaf, const std::string& name)
        : values(leaf.constAttributeArray(name)),
          gradients(leaf.constAttributeArray(name + kGradient)),
          moments(leaf.constAttributeArray(name + kMoment)) {
        if (leaf.hasAttribute(name + kHessian)) hessians.emplace(leaf.constAttributeArray(name + kHessian));
    }

    /// Appends the values of a point to a channel.
    void append_to(RbfChannel& channel, openvdb::Index point) const {
        const openvdb::Vec3f g = gradients.get(point);
        channel.values.push_back(values.get(point));
        channel.gradients.push_back({g.x(), g.y(), g.z()});
        channel.moments.push_back(moments.get(point));
        if (hessians) channel.hessians.push_back(from_vdb(hessians->get(point)));
    }
};

/// Reads the points of a grid, leaf by leaf.
class PointsReader {
public:
    explicit PointsReader(const Grid& grid) : grid_(grid) {
        volume_.kernel = kernel_from_json(grid.metaValue<std::string>(kKernel));
        std::vector<std::string> names;
        for (;;) {
            const auto name = grid.getMetadata<openvdb::StringMetadata>(kChannel + std::to_string(names.size()));
            if (!name) break;
            names.push_back(name->value());
            volume_.channels.push_back({.name = printable(name->value())});
        }
        attributes_ = attribute_names(names);
    }

    RbfVolume read() {
        for (auto leaf = grid_.tree().cbeginLeaf(); leaf; ++leaf) take(*leaf);
        return in_order();
    }

private:
    void take(const Leaf& leaf) {
        leaf.validateOffsets();
        const auto& ids = leaf.constAttributeArray("id");
        // An array of one value may claim any size; ids that differ prove that the file really has the points.
        if (ids.size() > 1 && ids.isUniform()) throw Error(ErrorCode::InvalidInput, "points have the same id");
        const Handle<std::int32_t> id(ids);
        const Handle<openvdb::Vec3f> position(leaf.constAttributeArray("P"));
        const Handle<openvdb::Mat3s> frame(leaf.constAttributeArray("frame"));
        std::vector<ChannelHandles> channels;
        channels.reserve(attributes_.size());
        for (const auto& name : attributes_) channels.emplace_back(leaf, name);
        for (auto i = leaf.beginIndexAll(); i; ++i) {
            const openvdb::Vec3d p = grid_.indexToWorld(i.getCoord().asVec3d() + openvdb::Vec3d(position.get(*i)));
            ids_.push_back(id.get(*i));
            volume_.centers.emplace_back(p.x(), p.y(), p.z());
            volume_.frames.push_back(from_vdb(frame.get(*i)));
            for (std::size_t c = 0; c < channels.size(); ++c) channels[c].append_to(volume_.channels[c], *i);
        }
    }

    /// Sorts by id; ids may have gaps if points were deleted.
    RbfVolume in_order() {
        std::vector<std::size_t> order(ids_.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return ids_[a] < ids_[b]; });
        const auto permute = [&](auto& list) {
            auto sorted = list;
            for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = list[order[i]];
            list = std::move(sorted);
        };
        permute(volume_.centers);
        permute(volume_.frames);
        for (auto& channel : volume_.channels) {
            permute(channel.values);
            permute(channel.gradients);
            permute(channel.moments);
            if (channel.hessians.size() == order.size())
                permute(channel.hessians);  // otherwise there are none, or `validate` refuses them
        }
        return std::move(volume_);
    }

    const Grid& grid_;
    std::vector<std::string> attributes_;
    std::vector<std::int32_t> ids_;
    RbfVolume volume_;
};

}  // namespace

void write_vdb_points(const std::filesystem::path& path, const RbfVolume& volume, const VdbPointsOptions& options) {
    validate(volume);
    if (volume.size() > std::size_t{1} << 31) {
        throw Error(ErrorCode::InvalidInput, std::to_string(volume.size()) + " points are too many for a .vdb file", {},
                    "at most 2³¹");
    }
    if (!(options.points_per_voxel > 0)) throw Error(ErrorCode::InvalidInput, "the number of points per voxel is not positive");
    AtomicFile file(path);
    write_grids(file, path, {make_grid(volume, options)});
    BoundaryFile(path, volume.boundary).commit();
    file.commit();
}

RbfVolume read_vdb_points(const std::filesystem::path& path) {
    const auto grid = openvdb::gridPtrCast<Grid>(read_grids(path, Grid::gridType(), "point grid").front());
    try {
        RbfVolume volume = PointsReader(*grid).read();
        const auto triangles = grid->metaValue<std::int64_t>(kTriangles);
        volume.boundary = read_boundary(path, static_cast<std::size_t>(std::max<std::int64_t>(triangles, 0)));
        validate(volume);
        volume.bounds = box_of(volume);
        return volume;
    } catch (const Error& error) {
        if (std::string_view(error.what()).starts_with(boundary_path(path).string())) throw;
        throw Error(error.code(), error.what(), path.string());
    } catch (const std::exception& error) {
        throw Error(ErrorCode::InvalidInput, "has no points in this library's layout: " + printable(error.what()),
                    path.string());
    }
}

bool holds_vdb_points(const std::filesystem::path& path) {
    const auto types = grid_types(path);
    return std::find(types.begin(), types.end(), Grid::gridType()) != types.end();
}

}  // namespace subvol
