#include "subvol/vdb.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Count.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "leaf_voxels.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr std::size_t kBatch = 4096;  // leaves between two reports of progress; 8 MB a field
constexpr double kMaxHalf = 65504;
constexpr double kLeastVoxel_world = 1.45e-5;  // OpenVDB takes a transform for singular whose determinant is below 3e-15

void check_representable(double voxel_size) {
    if (voxel_size >= kLeastVoxel_world) return;
    std::ostringstream message;
    message << "voxel size " << voxel_size << ": OpenVDB takes a grid of such small voxels for flat";
    throw Error(ErrorCode::InvalidInput, message.str(), {}, "at least 1.45e-5; a mesh in smaller units has larger voxels");
}

double voxel_size_of(const Box& box, const RasterizeOptions& options) {
    if (!(options.voxel_size_world >= 0) || !std::isfinite(options.voxel_size_world)) {
        throw Error(ErrorCode::InvalidInput, "the voxel size is not positive");
    }
    if (options.voxel_size_world > 0) return options.voxel_size_world;
    if (options.resolution < 1) throw Error(ErrorCode::InvalidInput, "the resolution is below one voxel");
    const double side = std::max({box.size().x, box.size().y, box.size().z});
    if (!(side > 0)) throw Error(ErrorCode::InvalidInput, "the mesh is a single point");
    return side / options.resolution;
}

const Attribute& field_of(const HexMesh& mesh, const std::string& name, bool half) {
    const std::string where = "field \"" + name + "\"";
    const Attribute* field = mesh.find_attribute(name);
    if (!field) throw Error(ErrorCode::InvalidInput, "the mesh does not have it", where);
    if (field->channels != 1) {
        throw Error(ErrorCode::InvalidInput, "has " + std::to_string(field->channels) + " channels", where, "one");
    }
    const double largest = half ? kMaxHalf : static_cast<double>(std::numeric_limits<float>::max());
    if (std::any_of(field->values.begin(), field->values.end(), [=](double v) { return std::abs(v) > largest; })) {
        throw Error(ErrorCode::InvalidInput,
                    "has a value that does not fit into a " + std::string(half ? "16" : "32") + "-bit float", where);
    }
    return *field;
}

openvdb::FloatGrid::Ptr make_grid(const std::string& name, double voxel_size, const RasterizeOptions& options) {
    auto grid = openvdb::FloatGrid::create(0.0f);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_size));
    grid->setName(name);
    grid->setCreator(options.creator);
    grid->insertMeta("subvol_field", openvdb::StringMetadata(name));
    grid->setSaveFloatAsHalf(options.half);
    return grid;
}

std::unique_ptr<Leaf> make_leaf(const VoxelCoord& origin, const LeafVoxels& voxels, std::size_t field) {
    auto leaf = std::make_unique<Leaf>(openvdb::Coord(origin[0], origin[1], origin[2]), 0.0f, false);
    std::copy(voxels.values[field].begin(), voxels.values[field].end(), leaf->buffer().data());
    Leaf::NodeMaskType mask;
    for (std::size_t w = 0; w < voxels.active.size(); ++w) {
        mask.getWord<std::uint64_t>(static_cast<openvdb::Index>(w)) = voxels.active[w];
    }
    leaf->setValueMask(mask);
    return leaf;
}

// Leaves are made in parallel and hung into the trees one after the other: the trees' inner nodes are not thread-safe.
void fill_batch(const HexMesh& mesh, std::span<const Attribute* const> fields, const LeafBins& bins, std::size_t first,
                std::span<const openvdb::FloatGrid::Ptr> grids) {
    const std::size_t count = std::min(kBatch, bins.size() - first);
    std::vector<std::unique_ptr<Leaf>> leaves(count * fields.size());
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const LeafVoxels voxels = fill_leaf(mesh, fields, bins, first + i);
        if (voxels.empty()) return;
        for (std::size_t f = 0; f < fields.size(); ++f) {
            leaves[i * fields.size() + f] = make_leaf(bins.origin_of(first + i), voxels, f);
        }
    });
    for (std::size_t k = 0; k < leaves.size(); ++k) {
        if (leaves[k]) grids[k % fields.size()]->tree().addLeaf(leaves[k].release());
    }
}

}  // namespace

VdbGrid make_vdb_grid(openvdb::FloatGrid::Ptr grid) {
    const auto& tree = grid->constTree();
    GridReport report{.name = grid->getName(),
                      .active_voxels = tree.activeVoxelCount(),
                      .voxel_size_world = grid->voxelSize()[0],
                      .bytes = tree.memUsage()};
    if (report.active_voxels > 0) {
        const auto range = openvdb::tools::minMax(tree);
        report.min = static_cast<double>(range.min());
        report.max = static_cast<double>(range.max());
        const openvdb::CoordBBox voxels = grid->evalActiveVoxelBoundingBox();
        const auto box = grid->transform().indexToWorld(openvdb::BBoxd(voxels.min().asVec3d(), voxels.max().asVec3d()));
        report.bounds = {{box.min()[0], box.min()[1], box.min()[2]}, {box.max()[0], box.max()[1], box.max()[2]}};
    }
    return VdbGrid(std::make_unique<VdbGrid::Data>(VdbGrid::Data{std::move(grid), std::move(report)}));
}

VdbGrid::VdbGrid(std::unique_ptr<Data> data) : data_(std::move(data)) {
}
VdbGrid::~VdbGrid() = default;
VdbGrid::VdbGrid(VdbGrid&&) noexcept = default;
VdbGrid& VdbGrid::operator=(VdbGrid&&) noexcept = default;

const GridReport& VdbGrid::report() const {
    return data_->report;
}

std::optional<double> VdbGrid::value(const Vec3& x) const {
    const auto index = data_->grid->transform().worldToIndex({x.x, x.y, x.z});
    constexpr double kReach = 1 << 30;
    if (!(std::max({std::abs(index[0]), std::abs(index[1]), std::abs(index[2])}) < kReach)) return std::nullopt;

    // Not registered with the tree, hence cheap to make and safe in many threads, while nobody changes the tree.
    const openvdb::FloatGrid::ConstUnsafeAccessor accessor(data_->grid->constTree());
    if (!accessor.isValueOn(openvdb::Coord::round(index))) return std::nullopt;
    const auto lower = openvdb::Coord::floor(index);
    const auto beyond = index - lower.asVec3d();
    double sum = 0, weights = 0;
    for (int k = 0; k < 8; ++k) {
        const openvdb::Coord step(k & 1, k >> 1 & 1, k >> 2);
        float voxel = 0;
        if (!accessor.probeValue(lower + step, voxel)) continue;
        double weight = 1;
        for (int d = 0; d < 3; ++d) weight *= (k >> d & 1) ? beyond[d] : 1.0 - beyond[d];
        sum += weight * static_cast<double>(voxel);
        weights += weight;
    }
    return sum / weights;  // the voxel that holds x counts at least 1/8
}

std::vector<VdbGrid> rasterize(const HexMesh& mesh, std::span<const std::string> fields, const RasterizeOptions& options) {
    validate(mesh);
    if (fields.empty()) throw Error(ErrorCode::InvalidInput, "no field is named to be rasterized");
    std::vector<const Attribute*> attributes;
    for (const auto& name : fields) attributes.push_back(&field_of(mesh, name, options.half));
    const LeafBins bins = bin_cells(mesh, voxel_size_of(bounds(mesh), options), options.progress);
    check_representable(bins.voxel_size);

    openvdb::initialize();
    std::vector<openvdb::FloatGrid::Ptr> grids;
    for (const auto& name : fields) grids.push_back(make_grid(name, bins.voxel_size, options));
    grids.front()->setGridClass(openvdb::GRID_FOG_VOLUME);
    for (std::size_t first = 0; first < bins.size(); first += kBatch) {
        report_progress(options.progress, "rasterize", static_cast<double>(first) / static_cast<double>(bins.size()));
        fill_batch(mesh, attributes, bins, first, grids);
    }
    report_progress(options.progress, "rasterize", 1);

    std::vector<VdbGrid> result;
    for (auto& grid : grids) result.push_back(make_vdb_grid(std::move(grid)));
    return result;
}

}  // namespace subvol
