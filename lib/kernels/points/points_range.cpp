// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/points_range.h"

#include <algorithm>
#include <array>

#include "subvol/detail/byte_lists.h"
#include "subvol/error.h"
#include "subvol/kernel.h"

namespace subvol::detail {

std::string bytes_of_kernels(const RbfVolume& volume, bool with_boundary) {
    BytePacker out;
    out.put(to_json(volume.kernel));
    out.put(std::array{volume.bounds.lower, volume.bounds.upper});
    out.put(volume.centers);
    out.put(volume.frames);
    out.put(std::array{volume.channels.size()});
    for (const RbfChannel& channel : volume.channels) {
        out.put(channel.name);
        out.put(channel.values);
        out.put(channel.gradients);
        out.put(channel.moments);
        out.put(channel.hessians);
    }
    out.put(with_boundary ? volume.boundary.points : std::vector<Vec3>());
    out.put(with_boundary ? volume.boundary.triangles : std::vector<std::array<Index, 3>>());
    return out.take();
}

RbfVolume kernels_from_bytes(std::string_view bytes) {
    ByteUnpacker in(bytes, "these bytes are not kernels");
    RbfVolume volume;
    std::string kernel;
    in.take(kernel);
    volume.kernel = kernel_from_json(kernel);
    std::vector<Vec3> corners;
    in.take(corners);
    if (corners.size() == 2) volume.bounds = {corners[0], corners[1]};
    in.take(volume.centers);
    in.take(volume.frames);
    std::vector<std::size_t> channels;
    in.take(channels);
    volume.channels.resize(channels.size() == 1 ? std::min<std::size_t>(channels[0], bytes.size()) : 0);
    for (RbfChannel& channel : volume.channels) {
        in.take(channel.name);
        in.take(channel.values);
        in.take(channel.gradients);
        in.take(channel.moments);
        in.take(channel.hessians);
    }
    in.take(volume.boundary.points);
    in.take(volume.boundary.triangles);
    return volume;
}

namespace {

/// The same channels and kernel, without kernels.
RbfVolume emptied(const RbfVolume& volume) {
    RbfVolume result;
    for (const RbfChannel& channel : volume.channels) result.channels.push_back({.name = channel.name});
    result.kernel = volume.kernel;
    result.bounds = volume.bounds;
    return result;
}

template <class T>
std::vector<T> between(const std::vector<T>& list, std::size_t begin, std::size_t end) {
    if (list.empty()) return {};  // Hessians that there are not
    return {list.data() + begin, list.data() + end};
}

template <class T>
std::vector<T> chosen(const std::vector<T>& list, std::span<const std::size_t> numbers) {
    std::vector<T> result;
    if (list.empty()) return result;
    result.reserve(numbers.size());
    for (const std::size_t i : numbers) result.push_back(list[i]);
    return result;
}

template <class T>
void keep(std::vector<T>& list, const std::vector<std::size_t>& places) {
    if (list.empty()) return;
    for (std::size_t i = 0; i < places.size(); ++i) list[i] = list[places[i]];
    list.resize(places.size());
    list.shrink_to_fit();
}

template <class T>
void append(std::vector<T>& list, const std::vector<T>& next) {
    list.insert(list.end(), next.begin(), next.end());
}

}  // namespace

RbfVolume kernels_between(const RbfVolume& volume, std::size_t begin, std::size_t end) {
    RbfVolume result = emptied(volume);
    result.centers = between(volume.centers, begin, end);
    result.frames = between(volume.frames, begin, end);
    for (std::size_t c = 0; c < volume.channels.size(); ++c) {
        const RbfChannel& from = volume.channels[c];
        RbfChannel& to = result.channels[c];
        to.values = between(from.values, begin, end);
        to.gradients = between(from.gradients, begin, end);
        to.moments = between(from.moments, begin, end);
        to.hessians = between(from.hessians, begin, end);
    }
    if (begin == 0) result.boundary = volume.boundary;
    return result;
}

RbfVolume chosen_kernels(const RbfVolume& volume, std::span<const std::size_t> numbers) {
    RbfVolume result = emptied(volume);
    result.centers = chosen(volume.centers, numbers);
    result.frames = chosen(volume.frames, numbers);
    for (std::size_t c = 0; c < volume.channels.size(); ++c) {
        const RbfChannel& from = volume.channels[c];
        RbfChannel& to = result.channels[c];
        to.values = chosen(from.values, numbers);
        to.gradients = chosen(from.gradients, numbers);
        to.moments = chosen(from.moments, numbers);
        to.hessians = chosen(from.hessians, numbers);
    }
    return result;
}

void keep_kernels(RbfVolume& volume, const std::vector<std::size_t>& places) {
    keep(volume.centers, places);
    keep(volume.frames, places);
    for (RbfChannel& channel : volume.channels) {
        keep(channel.values, places);
        keep(channel.gradients, places);
        keep(channel.moments, places);
        keep(channel.hessians, places);
    }
}

void append_kernels(RbfVolume& volume, const RbfVolume& next) {
    if (volume.channels.size() != next.channels.size() || to_json(volume.kernel) != to_json(next.kernel)) {
        throw Error(ErrorCode::InvalidInput, "shares of points have other channels or another kernel");
    }
    append(volume.centers, next.centers);
    append(volume.frames, next.frames);
    for (std::size_t c = 0; c < volume.channels.size(); ++c) {
        RbfChannel& to = volume.channels[c];
        const RbfChannel& from = next.channels[c];
        if (to.name != from.name) {
            throw Error(ErrorCode::InvalidInput,
                        "shares of points have channels of other names: \"" + to.name + "\" and \"" + from.name + "\"");
        }
        append(to.values, from.values);
        append(to.gradients, from.gradients);
        append(to.moments, from.moments);
        append(to.hessians, from.hessians);
    }
    if (volume.boundary.triangles.empty()) volume.boundary = next.boundary;
    volume.bounds.add(next.bounds);
}

}  // namespace subvol::detail
