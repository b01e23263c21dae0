#include "gl_context.h"

#include <epoxy/egl.h>

#include <array>
#include <cstring>
#include <vector>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

struct Made {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
};

/// A current core context on a display, or nothing. A display that does not work is simply passed over.
Made make_context(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return {};
    if (!eglBindAPI(EGL_OPENGL_API)) return {};
    const std::array<EGLint, 7> attributes{
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) return {};
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        eglDestroyContext(display, context);
        return {};
    }
    return {display, context};
}

bool has_extension(const char* list, const char* name) {
    return list && std::strstr(list, name);
}

std::vector<EGLDeviceEXT> hardware_devices() {
    if (!has_extension(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_EXT_device_enumeration") &&
        !has_extension(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_EXT_device_base")) {
        return {};
    }
    std::array<EGLDeviceEXT, 32> devices;
    EGLint count = 0;
    if (!eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count)) return {};
    std::vector<EGLDeviceEXT> result;
    for (EGLint i = 0; i < count; ++i) {
        const EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
        if (!has_extension(eglQueryDeviceStringEXT(device, EGL_EXTENSIONS), "EGL_MESA_device_software"))
            result.push_back(device);
    }
    return result;
}

Made find_context() {
    for (const EGLDeviceEXT device : hardware_devices()) {
        const Made made = make_context(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr));
        if (made.context != EGL_NO_CONTEXT) return made;
    }
    if (has_extension(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless")) {
        return make_context(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    }
    return {};
}

bool is_software(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader"}) {
        if (renderer.find(name) != std::string::npos) return true;
    }
    return false;
}

std::string shader_log(GLuint shader) {
    std::array<char, 4096> log{};
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    return log.data();
}

}  // namespace

GlContext::GlContext() {
    const Made made = find_context();
    if (made.context == EGL_NO_CONTEXT) {
        throw Error(ErrorCode::MissingCapability, "no OpenGL 4.3 was found through EGL", {}, "use the CPU backend");
    }
    display_ = made.display;
    context_ = made.context;
    renderer_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    hardware_ = !is_software(renderer_);
}

GlContext::~GlContext() {
    // The display stays: other contexts of the process may use it, and eglTerminate leaks in Mesa.
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
}

GlBuffer::GlBuffer(GLuint binding, std::size_t bytes, const void* data) {
    const std::size_t room = bytes > 0 ? bytes : 16;  // an empty buffer cannot be bound
    GLint64 most = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    if (room > static_cast<std::size_t>(most)) {
        throw Error(
            ErrorCode::MissingCapability,
            "the GL device takes buffers of " + std::to_string(most) + " bytes, this picture needs " + std::to_string(room), {},
            "use the CPU backend");
    }
    while (glGetError() != GL_NO_ERROR) {
    }
    glGenBuffers(1, &id_);
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, id_);
    glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(room), bytes > 0 ? data : nullptr, GL_DYNAMIC_COPY);
    if (glGetError() != GL_NO_ERROR) {
        glDeleteBuffers(1, &id_);
        throw Error(ErrorCode::MissingCapability, "the GL device has no room for " + std::to_string(room) + " bytes", {},
                    "use the CPU backend");
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, id_);
}

GlBuffer::~GlBuffer() {
    glDeleteBuffers(1, &id_);
}

void GlBuffer::read(std::size_t bytes, void* to) const {
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, id_);
    glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(bytes), to);
}

GlProgram::GlProgram(const std::string& file, const std::string& source, const std::string& defines) {
    const auto after_version = source.find('\n') + 1;
    const std::string text = source.substr(0, after_version) + defines + "#line 2\n" + source.substr(after_version);
    const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
    const char* pointer = text.c_str();
    glShaderSource(shader, 1, &pointer, nullptr);
    glCompileShader(shader);
    GLint ok = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (!ok) {
        const std::string log = shader_log(shader);
        glDeleteShader(shader);
        throw Error(ErrorCode::MissingCapability, "the GL driver refuses the shader: " + log, file);
    }
    id_ = glCreateProgram();
    glAttachShader(id_, shader);
    glLinkProgram(id_);
    glDeleteShader(shader);
    glGetProgramiv(id_, GL_LINK_STATUS, &ok);
    if (!ok) {
        glDeleteProgram(id_);
        throw Error(ErrorCode::MissingCapability, "the GL driver cannot link the shader", file);
    }
}

GlProgram::~GlProgram() {
    glDeleteProgram(id_);
}

}  // namespace subvol::detail
