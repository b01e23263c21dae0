// SPDX-License-Identifier: Apache-2.0
#include "spilled_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "subvol/detail/median_tree.h"

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

std::size_t bytes_of_rest(const RbfVolume& like) {
    std::size_t bytes = 0;
    each_array(like, [&](const auto& array) { bytes += sizeof array[0]; });
    return bytes;
}

class SpilledCenters : public ItemCenters {
public:
    SpilledCenters(const SpillFile& file, std::size_t count) : file_(file), count_(count) {}
    [[nodiscard]] std::size_t size() const override { return count_; }
    void read(std::span<const Index> items, std::span<Vec3> centers) const override {
        file_.read_some(items, {reinterpret_cast<char*>(centers.data()), centers.size_bytes()});
    }

private:
    const SpillFile& file_;
    std::size_t count_;
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
    return median_order(SpilledCenters(centers_, contents_.kernels), leaves, kSortedAtOnce);
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

}  // namespace subvol::detail
