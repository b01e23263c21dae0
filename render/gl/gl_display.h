// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "subvol/gl_device.h"

namespace subvol::detail {

/// Handles of an EGL context of ours, which has no surfaces, and its display. They are not owned: whoever opened the context
/// destroys it. No member changes the API that is bound on this thread.
struct EglContext {
    void* display = nullptr;
    void* context = nullptr;

    /// Makes it current on this thread.
    ///
    /// returns: false if EGL refuses, for example because the context is current on another thread
    [[nodiscard]] bool make_current() const;

    /// Releases it from this thread, if it is current here.
    void release() const;

    void destroy() const;
};

/// The context that is current in EGL on this thread, whoever made it so, with its surfaces.
class EglState {
public:
    [[nodiscard]] static EglState current();

    /// Makes it current again, in place of a context of ours.
    void restore() const;

private:
    unsigned int api_ = 0;  // under which the context was found
    EglContext context_;
    void* draw_ = nullptr;
    void* read_ = nullptr;
};

/// Leaves EGL on this thread as it was at the end of a scope that opens, uses or closes contexts: a caller may be drawing.
class KeepCurrent {
public:
    KeepCurrent() = default;
    ~KeepCurrent() { before_.restore(); }
    KeepCurrent(const KeepCurrent&) = delete;
    KeepCurrent& operator=(const KeepCurrent&) = delete;

private:
    EglState before_ = EglState::current();
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
