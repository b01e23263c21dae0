// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/kernel_rows.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>

#include "subvol/detail/kernel_source.h"
#include "subvol/detail/median_tree.h"
#include "subvol/detail/ply_rows.h"
#include "subvol/detail/spill_file.h"
#include "subvol/error.h"

// Kernels come brick by brick, but their numbers in the whole are mixed. Rows of a .ply have one length, so each is written at
// its place at once. A .svk file orders kernels by place and merges them into levels: the kernels therefore wait in two files
// of records, their centres, which the order needs, and all else of them.

namespace subvol::detail {

namespace {

constexpr std::size_t kSortedAtOnce = std::size_t{1} << 22;  // kernels whose centres are in memory

/// Calls call(array, i-th of it) for all that a kernel has besides its centre.
template <class Volume, class Call>
void each_array(Volume& volume, const Call& call) {
    call(volume.frames);
    for (auto& channel : volume.channels) {
        call(channel.values);
        call(channel.gradients);
        call(channel.moments);
        if (!channel.hessians.empty()) call(channel.hessians);
    }
}

/// All kernels have the same channels, so their records have one length, and a kernel is found by its number.
std::size_t bytes_of_rest(const RbfVolume& like) {
    std::size_t bytes = 0;
    each_array(like, [&](const auto& array) { bytes += sizeof array[0]; });
    return bytes;
}

class KernelCenters : public ItemCenters {
public:
    KernelCenters(const SpillFile& file, std::size_t count) : file_(file), count_(count) {}
    [[nodiscard]] std::size_t size() const override { return count_; }
    void read(std::span<const Index> items, std::span<Vec3> centers) const override {
        file_.read_some(items, {reinterpret_cast<char*>(centers.data()), centers.size_bytes()});
    }

private:
    const SpillFile& file_;
    std::size_t count_;
};

/// The kernels of a whole in files, for a `.svk` file of more than fits into memory.
class SpilledKernels : public KernelSource {
public:
    /// folder: of the files. like: of the kernel and the channels of all. count: of kernels, less than 2³²
    SpilledKernels(const std::filesystem::path& folder, const RbfVolume& like, std::uint64_t count, const Surface& boundary);

    /// numbers: the places of the kernels in the whole, ascending
    void write(std::span<const std::uint64_t> numbers, const RbfVolume& kernels);

    [[nodiscard]] SvkContents contents() const override { return contents_; }
    [[nodiscard]] const Surface& boundary() const override { return boundary_; }
    [[nodiscard]] std::vector<Index> order(std::size_t leaves) const override;
    [[nodiscard]] RbfVolume kernels(std::span<const Index> numbers) const override;

    [[nodiscard]] std::uint64_t written() const { return written_; }

private:
    const Surface& boundary_;
    SvkContents contents_;
    std::uint64_t written_ = 0;
    SpillFile centers_, rest_;
};

}  // namespace

SpilledKernels::SpilledKernels(const std::filesystem::path& folder, const RbfVolume& like, std::uint64_t count,
                               const Surface& boundary)
    : boundary_(boundary), centers_(folder, sizeof(Vec3)), rest_(folder, bytes_of_rest(like)) {
    contents_ = {.kernel = like.kernel,
                 .kernels = count,
                 .channels = {},
                 .bounds = {},
                 .boundary_points = boundary.points.size(),
                 .boundary_triangles = boundary.triangles.size()};
    for (const RbfChannel& channel : like.channels) {
        contents_.channels.push_back({channel.name, !channel.hessians.empty(), HUGE_VALF, -HUGE_VALF});
    }
    for (const Vec3& p : boundary.points) contents_.bounds.add(p);
}

void SpilledKernels::write(std::span<const std::uint64_t> numbers, const RbfVolume& kernels) {
    validate(kernels);
    // A boundary encloses the volume; without one, the centres are all that is known of its extent.
    if (boundary_.points.empty()) {
        for (const Vec3& x : kernels.centers) contents_.bounds.add(x);
    }
    for (std::size_t c = 0; c < contents_.channels.size(); ++c) {
        SvkChannel& channel = contents_.channels[c];
        for (const float value : kernels.channels[c].values) {
            channel.min = std::min(channel.min, value);
            channel.max = std::max(channel.max, value);
        }
    }
    const std::vector<Index> places(numbers.begin(), numbers.end());
    centers_.write_some(places, records_of(kernels.centers));
    const std::size_t length = rest_.record_bytes();
    // The arrays of a volume are columns, records are rows: each array fills its column of all records.
    std::vector<char> records(kernels.size() * length);
    std::size_t column = 0;
    each_array(kernels, [&](const auto& array) {
        for (std::size_t i = 0; i < array.size(); ++i) std::memcpy(&records[i * length + column], &array[i], sizeof array[i]);
        column += sizeof array[0];
    });
    rest_.write_some(places, records);
    written_ += numbers.size();
}

std::vector<Index> SpilledKernels::order(std::size_t leaves) const {
    // The order needs the centres alone, which are read back in parts that fit into memory.
    return median_order(KernelCenters(centers_, contents_.kernels), leaves, kSortedAtOnce);
}

RbfVolume SpilledKernels::kernels(std::span<const Index> numbers) const {
    std::vector<std::size_t> all(contents_.channels.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    RbfVolume volume = svk_volume(contents_, numbers.size(), all);
    // Read in the order of the files, then put where they belong.
    std::vector<std::size_t> places(numbers.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::ranges::sort(places, {}, [&](std::size_t i) { return numbers[i]; });
    std::vector<Index> ascending;
    ascending.reserve(numbers.size());
    for (const std::size_t i : places) ascending.push_back(numbers[i]);
    std::vector<Vec3> centers(numbers.size());
    centers_.read_some(ascending, records_of(centers));
    for (std::size_t i = 0; i < places.size(); ++i) volume.centers[places[i]] = centers[i];
    const std::size_t length = rest_.record_bytes();
    std::vector<char> records(numbers.size() * length);
    rest_.read_some(ascending, records);
    std::size_t column = 0;
    each_array(volume, [&](auto& array) {
        for (std::size_t i = 0; i < places.size(); ++i) {
            std::memcpy(&array[places[i]], &records[i * length + column], sizeof array[0]);
        }
        column += sizeof array[0];
    });
    return volume;
}

struct KernelRows::State {
    std::filesystem::path path;
    std::uint64_t kernels;
    const Surface& boundary;
    Progress* progress;
    std::optional<PlyRows> ply = {};
    std::optional<SpilledKernels> spilled = {};
};

KernelRows::KernelRows(const std::filesystem::path& path, const RbfVolume& like, std::uint64_t kernels, const Surface& boundary,
                       const std::string& note, Progress* progress)
    : state_(new State{path, kernels, boundary, progress}) {
    if (path.extension() != ".svk") {
        state_->ply.emplace(path, like, kernels, boundary, note);
        return;
    }
    if (kernels >= kNone) {
        throw Error(ErrorCode::InvalidInput, std::to_string(kernels) + " kernels are too many", path.string(),
                    "fewer than 2³²");
    }
    state_->spilled.emplace(std::filesystem::absolute(path).parent_path(), like, kernels, boundary);
}

KernelRows::~KernelRows() = default;

void KernelRows::write(std::span<const std::uint64_t> numbers, const RbfVolume& kernels) {
    if (state_->ply) {
        state_->ply->write(numbers, kernels);
    } else {
        state_->spilled->write(numbers, kernels);
    }
}

void KernelRows::finish() {
    if (state_->ply) {
        state_->ply->finish(state_->boundary);
        return;
    }
    // A kernel that was never written would read as zeros, so the kernels are counted.
    if (state_->spilled->written() != state_->kernels) {
        throw Error(ErrorCode::InvalidInput,
                    std::to_string(state_->kernels - state_->spilled->written()) + " kernels have not been written",
                    state_->path.string());
    }
    write_kernel_file(state_->path, *state_->spilled, state_->progress);
}

}  // namespace subvol::detail
