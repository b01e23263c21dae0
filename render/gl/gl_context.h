// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "gl_display.h"

namespace subvol::detail {

/// An OpenGL 4.5 core context without a window. At first it is current on the thread that made it; a GlScope makes it current
/// for a piece of code. A process may have several; each is current on one thread at a time.
class GlContext {
public:
    /// device: its index in gl_devices(); none: the first, which is hardware if there is any
    /// throws: Error(MissingCapability) if there is no such device
    explicit GlContext(std::optional<int> device = {});
    ~GlContext() { opened_.context.destroy(); }
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

    [[nodiscard]] const GlDevice& device() const { return opened_.device; }
    [[nodiscard]] const std::string& renderer() const { return opened_.device.renderer; }
    [[nodiscard]] bool hardware() const { return opened_.device.hardware; }

    /// Makes it current on this thread; false if another thread uses it.
    [[nodiscard]] bool make_current() const { return opened_.context.make_current(); }

    /// Releases it from this thread, so that another thread can use it. Does nothing if it is not current here.
    void release() const { opened_.context.release(); }

private:
    OpenedGl opened_;
};

/// Makes a context current on this thread; at the end of the scope EGL is as it was before.
class GlScope {
public:
    /// throws: Error(MissingCapability) if the context is current on another thread
    explicit GlScope(const GlContext& context);

private:
    KeepCurrent keep_;
};

/// Frees what lives in a context, for destructors: throws nothing. If another thread uses the context, it cannot be freed and
/// is given up.
template <class T>
void free_in(const GlContext& context, std::unique_ptr<T>& owned) {
    const KeepCurrent keep;
    if (context.make_current())
        owned.reset();
    else
        (void)owned.release();
}

/// throws: Error(MissingCapability) with the hint `allowed` if the current context cannot draw a picture of that size
void check_picture_size(int width, int height, const char* allowed);

/// The bytes that work on the current context should take: three quarters of what is free on the device, or 2 GiB if the driver
/// does not say, or is software, whose answers mean nothing.
[[nodiscard]] std::size_t memory_budget(bool hardware);

/// What shaders need beyond the least that OpenGL 4.5 guarantees, and what a device has: storage buffers in each kind of
/// shader. The standard guarantees 8 of them, and none in vertex shaders.
struct GlStorage {
    int vertex = 0, fragment = 0, compute = 0;
    int bindings = 0;  // the highest binding is one less

    /// Of the current context.
    [[nodiscard]] static GlStorage available();
};

/// throws: Error(MissingCapability) with the hint `allowed` if a device has fewer than needed
void check_storage(const GlStorage& needed, const GlStorage& available, const char* allowed);

/// Checks whether a call, memory or the device of the current context has failed since the last check.
///
/// where:  what was done, for the message: "splat", a shader's file
/// throws: Error(MissingCapability) if something has failed
/// cost:   does not wait: failures of work that is still under way are seen by a later check
void check_gl(const std::string& where);

}  // namespace subvol::detail
