#pragma once

#include <epoxy/gl.h>

#include <memory>
#include <string>

namespace subvol::detail {

/// An OpenGL 4.3 core context without a window, current on the thread that made it: a hardware device if there is one, else
/// Mesa's software.
///
/// throws: Error(MissingCapability) if there is neither
class GlContext {
public:
    GlContext();
    ~GlContext();
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

    [[nodiscard]] const std::string& renderer() const { return renderer_; }
    [[nodiscard]] bool hardware() const { return hardware_; }

private:
    void* display_ = nullptr;
    void* context_ = nullptr;
    std::string renderer_;
    bool hardware_ = false;
};

/// A shader storage buffer.
class GlBuffer {
public:
    /// data may be null: uninitialised; throws Error(MissingCapability) if the device has no room for it
    GlBuffer(GLuint binding, std::size_t bytes, const void* data);
    ~GlBuffer();
    GlBuffer(const GlBuffer&) = delete;
    GlBuffer& operator=(const GlBuffer&) = delete;

    void read(std::size_t bytes, void* to) const;

private:
    GLuint id_ = 0;
};

/// A compute program. Errors of the compiler name the shader's file and line.
class GlProgram {
public:
    /// defines: text put after the version line
    GlProgram(const std::string& file, const std::string& source, const std::string& defines);
    ~GlProgram();
    GlProgram(const GlProgram&) = delete;
    GlProgram& operator=(const GlProgram&) = delete;

    [[nodiscard]] GLuint id() const { return id_; }
    [[nodiscard]] GLint uniform(const char* name) const { return glGetUniformLocation(id_, name); }

private:
    GLuint id_ = 0;
};

}  // namespace subvol::detail
