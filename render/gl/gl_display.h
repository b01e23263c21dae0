// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "subvol/gl_device.h"

namespace subvol::detail {

/// A context as EGL knows it: its display, and itself. It has no owner: who opened it destroys it.
struct EglContext {
    void* display = nullptr;
    void* context = nullptr;

    /// That of this thread; null if there is none.
    [[nodiscard]] static EglContext current();

    /// On this thread; a null context releases the one that is current.
    ///
    /// returns: false if EGL refuses, as it does a context that is current on another thread
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

/// Walks through the devices in the order of gl_devices(). Each context that it opens is current and belongs to the caller.
class GlFinder {
public:
    GlFinder();
    ~GlFinder();
    GlFinder(const GlFinder&) = delete;
    GlFinder& operator=(const GlFinder&) = delete;

    /// The next device that works; nothing after the last.
    [[nodiscard]] std::optional<OpenedGl> next();

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// throws: Error(MissingCapability): there is no OpenGL at all, or no device of that index, with a list of those that there are
[[noreturn]] void throw_no_gl(std::optional<int> index);

}  // namespace subvol::detail
