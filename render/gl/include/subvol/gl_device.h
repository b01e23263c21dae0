// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace subvol {

/// A device that runs OpenGL 4.5 without a display.
struct GlDevice {
    std::string renderer;            // what it calls itself
    bool hardware = false;           // false: software, which `SplatMethod::Auto` passes over
    int index = 0;                   // its place in gl_devices()
    std::string version;             // of OpenGL, and the driver's
    std::size_t max_ssbo_bytes = 0;  // the largest storage buffer that a shader sees
    std::size_t memory_bytes = 0;    // of the device; 0 if it does not tell
};

/// Time that a device spent on a part of the work.
struct StageTime {
    std::string stage;
    double seconds = 0;
};

/// Every device of EGL's device platform, hardware first, each once; then the software of Mesa, if there is any.
///
/// cost: makes a context on each: up to some tenths of a second a device
[[nodiscard]] std::vector<GlDevice> gl_devices();

/// The device of that index; without one, the first: hardware if there is any. Nothing if there is no OpenGL 4.5 at all.
///
/// throws: Error(MissingCapability) if there is no device of that index; it lists those that there are
[[nodiscard]] std::optional<GlDevice> find_gl_device(std::optional<int> index = {});

}  // namespace subvol
