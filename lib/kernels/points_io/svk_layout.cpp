// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/svk_layout.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

namespace subvol::detail {

namespace {

using Float3 = std::array<float, 3>;

constexpr std::uint64_t kPlainBytes = sizeof(float) + sizeof(Float3) + sizeof(float);  // value, gradient, moment

std::uint64_t channel_bytes(bool bent) {
    return kPlainBytes + (bent ? sizeof(Symmetric3) : 0);
}

template <class T>
void put(std::string& bytes, const std::vector<T>& values, std::span<const Index> numbers) {
    if (values.empty()) return;
    const std::size_t at = bytes.size();
    bytes.resize(at + numbers.size() * sizeof(T));
    for (std::size_t k = 0; k < numbers.size(); ++k) std::memcpy(&bytes[at + k * sizeof(T)], &values[numbers[k]], sizeof(T));
}

}  // namespace

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Symmetric3) == 6 * sizeof(float), "written as they lie in memory");

SvkContents svk_contents(const RbfVolume& volume) {
    SvkContents contents{.kernel = volume.kernel,
                         .kernels = volume.size(),
                         .channels = {},
                         .bounds = box_of(volume),
                         .boundary_points = volume.boundary.points.size(),
                         .boundary_triangles = volume.boundary.triangles.size()};
    for (const RbfChannel& channel : volume.channels) {
        const auto [min, max] = std::ranges::minmax(channel.values);
        contents.channels.push_back({channel.name, !channel.hessians.empty(), min, max});
    }
    return contents;
}

SvkLayout::SvkLayout(const SvkContents& contents, std::uint64_t data) : kernels_(contents.kernels) {
    while ((kLeafSize << levels_) < kernels_) ++levels_;
    below_ = std::min(levels_, kBlockLevels);
    kernel_bytes_ = sizeof(Vec3) + sizeof(Symmetric3);
    for (const SvkChannel& channel : contents.channels) kernel_bytes_ += channel_bytes(channel.bent);
    node_bytes_ = kernel_bytes_ + sizeof(float) * (1 + contents.channels.size());

    std::uint64_t end = data;
    const auto next = [&](std::uint64_t count, std::uint64_t bytes) {
        const SvkExtent extent{end, bytes, static_cast<std::size_t>(count)};
        end += bytes;
        return extent;
    };
    boundary_ = next(contents.boundary_triangles,
                     contents.boundary_points * sizeof(Vec3) + contents.boundary_triangles * 3 * sizeof(std::uint32_t));
    const std::uint64_t top_nodes = 2 * blocks() - 1;
    top_ = next(top_nodes, top_nodes * node_bytes_);
    for (std::size_t part = 0; part < node_parts(); ++part) {
        part_offsets_.push_back(end);
        end += blocks() * this->part(0, part).bytes;
    }
    part_offsets_.push_back(end);
    end += kernels_ * sizeof(std::uint32_t);
    part_offsets_.push_back(end);
    file_bytes_ = end + kernels_ * kernel_bytes_;
}

SvkExtent SvkLayout::part(std::size_t block, std::size_t part) const {
    if (part < node_parts()) {
        const std::size_t count = (std::size_t{2} << last_level(part)) - (std::size_t{1} << first_level(part));
        return {part_offsets_[part] + block * count * node_bytes_, count * node_bytes_, count};
    }
    const std::uint64_t each = part == kernels_part() ? kernel_bytes_ : sizeof(std::uint32_t);
    const std::uint64_t first = first_slot(block), count = first_slot(block + 1) - first;
    return {part_offsets_[part] + first * each, count * each, static_cast<std::size_t>(count)};
}

SvkArrays::SvkArrays(const SvkContents& contents, Kind kind, std::string_view bytes, std::size_t count)
    : contents_(contents), bytes_(bytes.data()), count_(count) {
    centers_ = kind == Kind::Nodes ? (1 + contents.channels.size()) * sizeof(float) * count : 0;
    frames_ = centers_ + count * sizeof(Vec3);
    std::size_t next = frames_ + count * sizeof(Symmetric3);
    for (const SvkChannel& channel : contents.channels) {
        channels_.push_back(next);
        next += count * channel_bytes(channel.bent);
    }
}

template <class T>
T SvkArrays::load(std::size_t array, std::size_t i) const {
    T value;
    std::memcpy(&value, bytes_ + array + i * sizeof(T), sizeof(T));
    return value;
}

float SvkArrays::width(std::size_t i) const {
    return load<float>(0, i);
}

float SvkArrays::error(std::size_t channel, std::size_t i) const {
    return load<float>((1 + channel) * count_ * sizeof(float), i);
}

Vec3 SvkArrays::center(std::size_t i) const {
    return load<Vec3>(centers_, i);
}

void SvkArrays::copy(std::size_t i, RbfVolume& to, std::size_t j, std::span<const std::size_t> channels) const {
    to.centers[j] = center(i);
    to.frames[j] = load<Symmetric3>(frames_, i);
    for (std::size_t k = 0; k < channels.size(); ++k) {
        const std::size_t array = channels_[channels[k]];
        RbfChannel& channel = to.channels[k];
        channel.values[j] = load<float>(array, i);
        channel.gradients[j] = load<Float3>(array + count_ * sizeof(float), i);
        channel.moments[j] = load<float>(array + count_ * (sizeof(float) + sizeof(Float3)), i);
        if (!channel.hessians.empty()) channel.hessians[j] = load<Symmetric3>(array + count_ * kPlainBytes, i);
    }
}

RbfVolume SvkArrays::volume() const {
    std::vector<std::size_t> all(contents_.channels.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    RbfVolume volume = svk_volume(contents_, count_, all);
    for (std::size_t i = 0; i < count_; ++i) copy(i, volume, i, all);
    return volume;
}

std::string svk_bytes(const RbfVolume& volume, std::span<const Index> numbers, std::span<const float> widths,
                      std::span<const std::vector<float>> errors) {
    std::string bytes;
    const auto put_floats = [&](std::span<const float> floats) {
        for (const Index i : numbers) bytes.append(reinterpret_cast<const char*>(&floats[i]), sizeof(float));
    };
    if (!widths.empty()) put_floats(widths);
    for (const auto& of_channel : errors) put_floats(of_channel);
    put(bytes, volume.centers, numbers);
    put(bytes, volume.frames, numbers);
    for (const RbfChannel& channel : volume.channels) {
        put(bytes, channel.values, numbers);
        put(bytes, channel.gradients, numbers);
        put(bytes, channel.moments, numbers);
        put(bytes, channel.hessians, numbers);
    }
    return bytes;
}

RbfVolume svk_volume(const SvkContents& contents, std::size_t size, std::span<const std::size_t> channels) {
    RbfVolume volume;
    volume.kernel = contents.kernel;
    volume.bounds = contents.bounds;
    volume.centers.resize(size);
    volume.frames.resize(size);
    for (const std::size_t c : channels) {
        RbfChannel& channel = volume.channels.emplace_back();
        channel.name = contents.channels[c].name;
        channel.values.resize(size);
        channel.gradients.resize(size);
        channel.moments.resize(size);
        if (contents.channels[c].bent) channel.hessians.resize(size);
    }
    return volume;
}

}  // namespace subvol::detail
