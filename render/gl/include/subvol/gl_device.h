// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace subvol {

/// A device that runs OpenGL 4.5 without a display.
struct GlDevice {
    std::string renderer;            // the name that the device reports
    bool hardware = false;           // false: software, which `SplatMethod::Auto` does not choose
    int index = 0;                   // position in gl_devices()
    std::string version;             // of OpenGL and of the driver
    std::size_t max_ssbo_bytes = 0;  // the largest storage buffer that a shader can use
    std::size_t memory_bytes = 0;    // of the device; 0 if unknown
};

/// Time that a device spent on a stage of the work.
struct StageTime {
    std::string stage;
    double seconds = 0;
};

/// Every device of EGL's device platform once, hardware first; then Mesa's software, if it is installed.
///
/// cost: makes a context on each device, which can take some tenths of a second
[[nodiscard]] std::vector<GlDevice> gl_devices();

/// The device with that index; without an index the first, which is hardware if there is any. Nothing if there is no
/// OpenGL 4.5 at all.
///
/// throws: Error(MissingCapability) if there is no device with that index; lists those that exist
[[nodiscard]] std::optional<GlDevice> find_gl_device(std::optional<int> index = {});

}  // namespace subvol
