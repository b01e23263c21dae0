// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "subvol/gl_device.h"

namespace subvol::detail {

/// Handles of an EGL context and its display. They are not owned: whoever opened the context destroys it.
struct EglContext {
    void* display = nullptr;
    void* context = nullptr;

    /// The context of this thread; null if there is none.
    [[nodiscard]] static EglContext current();

    /// Makes it current on this thread; a null context releases the current one.
    ///
    /// returns: false if EGL refuses, for example because the context is current on another thread
    [[nodiscard]] bool make_current() const;

    void destroy() const;

    bool operator==(const EglContext&) const = default;
};

/// Makes the context of this thread current again at the end of a scope that opens, uses or closes others.
class KeepCurrent {
public:
    KeepCurrent() = default;
    ~KeepCurrent() { (void)before_.make_current(); }
    KeepCurrent(const KeepCurrent&) = delete;
    KeepCurrent& operator=(const KeepCurrent&) = delete;

private:
    EglContext before_ = EglContext::current();
};

struct OpenedGl {
    EglContext context;
    GlDevice device;
};

/// Opens the devices one by one, in the order of gl_devices(). Each context is current when it is returned, and the caller
/// destroys it.
class GlFinder {
public:
    GlFinder();
    ~GlFinder();
    GlFinder(const GlFinder&) = delete;
    GlFinder& operator=(const GlFinder&) = delete;

    /// The next device that works; nothing after the last one.
    [[nodiscard]] std::optional<OpenedGl> next();

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// throws: Error(MissingCapability): there is no OpenGL at all, or no device with that index; lists the devices
[[noreturn]] void throw_no_gl(std::optional<int> index);

}  // namespace subvol::detail
