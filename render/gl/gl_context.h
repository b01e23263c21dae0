// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "gl_display.h"

namespace subvol::detail {

/// An OpenGL 4.5 core context without a window. It begins as the current one of the thread that made it; a GlScope makes it
/// that of a piece of code. A process may have several; each is current on one thread at a time.
class GlContext {
public:
    /// device: its index in gl_devices(); without one, the first: hardware if there is any
    /// throws: Error(MissingCapability) if it is not there
    explicit GlContext(std::optional<int> device = {});
    ~GlContext() { opened_.context.destroy(); }
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

    [[nodiscard]] const GlDevice& device() const { return opened_.device; }
    [[nodiscard]] const std::string& renderer() const { return opened_.device.renderer; }
    [[nodiscard]] bool hardware() const { return opened_.device.hardware; }

    /// Leaves this thread without it, so that another may use it. Nothing happens if it is not current here.
    void release() const;

private:
    friend class GlScope;
    OpenedGl opened_;
};

/// A context is the current one of this thread as long as this lives; then that from before is again.
class GlScope {
public:
    /// throws: Error(MissingCapability) if the context is current on another thread
    explicit GlScope(const GlContext& context);

private:
    KeepCurrent keep_;
};

/// throws: Error(MissingCapability) with the hint `allowed` if the current context cannot draw a picture of that size
void check_picture_size(int width, int height, const char* allowed);

/// Asks the current context whether something failed since it was last asked: a call, memory, the device itself.
///
/// where:  what was done, for the message: "splat", a shader's file
/// throws: Error(MissingCapability)
/// cost:   waits for nothing: failures of work that is still under way are seen later
void check_gl(const std::string& where);

}  // namespace subvol::detail
