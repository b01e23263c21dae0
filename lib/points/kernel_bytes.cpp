// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/kernel_bytes.h"

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

/// Appends lists, each after its number of items.
class Packer {
public:
    template <class Items>
    void put(const Items& items) {
        using Item = typename Items::value_type;
        static_assert(std::is_trivially_copyable_v<Item>);
        const std::uint64_t count = items.size();
        bytes_.append(reinterpret_cast<const char*>(&count), sizeof count);
        bytes_.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item));
    }
    [[nodiscard]] std::string take() { return std::move(bytes_); }

private:
    std::string bytes_;
};

class Unpacker {
public:
    explicit Unpacker(std::string_view bytes) : left_(bytes) {}

    template <class Items>
    void take(Items& items) {
        using Item = typename Items::value_type;
        std::uint64_t count = 0;
        std::memcpy(&count, bytes(sizeof count), sizeof count);
        if (count > left_.size() / sizeof(Item)) refuse();
        items.resize(count);
        if (count > 0) std::memcpy(static_cast<void*>(items.data()), bytes(count * sizeof(Item)), count * sizeof(Item));
    }

private:
    [[noreturn]] static void refuse() { throw Error(ErrorCode::InvalidInput, "these bytes are no kernels"); }

    const char* bytes(std::size_t count) {
        if (count > left_.size()) refuse();
        const char* first = left_.data();
        left_.remove_prefix(count);
        return first;
    }

    std::string_view left_;
};

}  // namespace

std::string bytes_of_kernels(const RbfVolume& volume, bool with_boundary) {
    Packer out;
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
    Unpacker in(bytes);
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
