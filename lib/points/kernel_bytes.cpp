// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/kernel_bytes.h"

#include <algorithm>
#include <array>

#include "subvol/detail/byte_lists.h"

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

}  // namespace subvol::detail
