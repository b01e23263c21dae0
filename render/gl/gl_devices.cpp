// SPDX-License-Identifier: Apache-2.0
#include "gl_display.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

std::vector<GlDevice> gl_devices() {
    std::vector<GlDevice> devices;
    GlFinder finder;
    const KeepCurrent keep;
    while (const auto opened = finder.next()) {
        devices.push_back(opened->device);
        opened->context.destroy();
    }
    return devices;
}

std::optional<GlDevice> find_gl_device(std::optional<int> index) {
    GlFinder finder;
    const KeepCurrent keep;
    while (const auto opened = finder.next()) {
        opened->context.destroy();
        if (!index || opened->device.index == *index) return opened->device;
    }
    if (index) throw_no_gl(index);
    return std::nullopt;
}

void detail::throw_no_gl(std::optional<int> index) {
    std::string list;
    for (const GlDevice& device : gl_devices()) {
        list += (list.empty() ? "there are: " : ", ") + std::to_string(device.index) + " " + device.renderer;
    }
    if (list.empty())
        throw Error(ErrorCode::MissingCapability, "no OpenGL 4.5 was found through EGL", {}, "use the CPU backend");
    throw Error(ErrorCode::MissingCapability, "no GL device has the number " + std::to_string(index.value_or(0)), {}, list);
}

}  // namespace subvol
