// SPDX-License-Identifier: Apache-2.0
// Finds OpenGL through EGL without a window, and opens one device after the other. Candidates are listed first, hardware before
// software, after a check that libraries are installed and memory is left, since drivers and the loader would abort the
// program:
//
//     hardware, Mesa surfaceless, software devices ─► context, 4.5 core ─► described ─► known or deferred: the next candidate
//                                                                                  └─► else returned, current on this thread
//
// A device that turns out to be software when it is opened is put behind those that may be hardware. A card that two drivers
// offer, and software that is reached in several ways, count once. Displays are never closed, as others may use them. The API
// of EGL that is bound stays as it was, and a context that was current before can be made current again.
#include "gl_display.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <vector>

namespace subvol::detail {

namespace {

/// A display that may have OpenGL; it has not been opened yet.
struct Candidate {
    EGLDisplay display = EGL_NO_DISPLAY;
    bool surfaceless = false;  // Mesa's own choice among what it can run on
    bool software = false;     // as far as is known before it is opened
    std::string file;          // of the graphics card; empty if unknown
};

/// Whether a blank-separated list contains a name. A name may be the beginning of another one.
bool has_extension(const char* list, std::string_view name) {
    std::string_view rest = list ? list : "";
    while (!rest.empty()) {
        const std::string_view word = rest.substr(0, rest.find(' '));
        if (word == name) return true;
        rest.remove_prefix(std::min(rest.size(), word.size() + 1));
    }
    return false;
}

std::string card_file(EGLDeviceEXT device, const char* extensions) {
    if (!has_extension(extensions, "EGL_EXT_device_drm")) return {};
    const char* file = eglQueryDeviceStringEXT(device, EGL_DRM_DEVICE_FILE_EXT);
    return file ? file : "";
}

/// Epoxy aborts the program when it opens a library that is not installed, so this is checked first.
bool opengl_installed() {
    static const bool kInstalled =
        epoxy_has_egl() && (dlopen("libOpenGL.so.0", RTLD_LAZY) != nullptr || dlopen("libGL.so.1", RTLD_LAZY) != nullptr);
    return kInstalled;
}

/// Drivers abort the program when they get no memory, Mesa's software even with some hundred MB left. Where a limit is set,
/// this is checked first.
bool addresses_left() {
    constexpr std::size_t kOfADriver = std::size_t{1} << 30;
    void* const room = mmap(nullptr, kOfADriver, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    return room != MAP_FAILED && munmap(room, kOfADriver) == 0;
}

/// Hardware first, then Mesa's software through its own platform, then through that of devices: the former may be hardware.
std::vector<Candidate> find_candidates() {
    std::vector<Candidate> hardware, software;
    if (!opengl_installed() || !addresses_left()) return {};
    const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!has_extension(client, "EGL_EXT_platform_base")) return {};
    if (has_extension(client, "EGL_MESA_platform_surfaceless"))
        software.push_back(
            {eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr), true, true, {}});
    if (has_extension(client, "EGL_EXT_platform_device") &&
        (has_extension(client, "EGL_EXT_device_enumeration") || has_extension(client, "EGL_EXT_device_base"))) {
        std::array<EGLDeviceEXT, 64> devices{};
        EGLint count = 0;
        if (!eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count)) count = 0;
        for (const EGLDeviceEXT device : std::span(devices).first(static_cast<std::size_t>(count))) {
            const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
            const bool on_cpu = has_extension(extensions, "EGL_MESA_device_software");
            (on_cpu ? software : hardware)
                .push_back({eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr), false, on_cpu,
                            card_file(device, extensions)});
        }
    }
    hardware.insert(hardware.end(), software.begin(), software.end());
    return hardware;
}

/// Binds an API of EGL for the calls of a scope.
class BoundApi {
public:
    explicit BoundApi(EGLenum api) : before_(eglQueryAPI()), bound_(eglBindAPI(api) == EGL_TRUE) {}
    ~BoundApi() { eglBindAPI(before_); }
    BoundApi(const BoundApi&) = delete;
    BoundApi& operator=(const BoundApi&) = delete;

    [[nodiscard]] bool bound() const { return bound_; }

private:
    EGLenum before_;
    bool bound_;
};

/// A current context, which reports a lost device if the driver can; a null one if the display does not work.
EglContext make_context(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return {};
    const BoundApi api(EGL_OPENGL_API);
    if (!api.bound()) return {};
    constexpr std::array<EGLint, 11> kAttributes{
        EGL_CONTEXT_MAJOR_VERSION,
        4,
        EGL_CONTEXT_MINOR_VERSION,
        5,
        EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
        EGL_LOSE_CONTEXT_ON_RESET,
        EGL_CONTEXT_OPENGL_ROBUST_ACCESS,
        EGL_TRUE,
        EGL_NONE,
    };
    std::array<EGLint, 11> attributes = kAttributes;
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) {
        attributes[6] = EGL_NONE;  // a driver without robustness rejects the attribute
        context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    }
    if (context == EGL_NO_CONTEXT) return {};
    const EglContext made{display, context};
    if (made.make_current()) return made;
    made.destroy();
    return {};
}

std::string text_of(GLenum name) {
    const GLubyte* text = glGetString(name);
    return text ? reinterpret_cast<const char*>(text) : "";
}

bool is_software(const std::string& renderer) {
    constexpr std::array kNames{"llvmpipe", "lavapipe", "softpipe", "swrast", "SwiftShader", "Basic Render"};
    return std::ranges::any_of(kNames, [&](const char* name) { return renderer.find(name) != std::string::npos; });
}

std::size_t device_memory_bytes() {
    std::array<GLint, 4> kib{};  // ATI's query has four results; the first is the free memory
    if (epoxy_has_gl_extension("GL_NVX_gpu_memory_info")) {
        glGetIntegerv(GL_GPU_MEMORY_INFO_TOTAL_AVAILABLE_MEMORY_NVX, kib.data());
    } else if (epoxy_has_gl_extension("GL_ATI_meminfo")) {
        glGetIntegerv(GL_VBO_FREE_MEMORY_ATI, kib.data());
    }
    return static_cast<std::size_t>(std::max(kib[0], 0)) * 1024;
}

/// Describes the device of the current context; the index is set by the caller.
GlDevice describe() {
    GLint64 most = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    GlDevice device{.renderer = text_of(GL_RENDERER), .version = text_of(GL_VERSION)};
    device.hardware = !is_software(device.renderer);
    device.max_ssbo_bytes = static_cast<std::size_t>(std::max<GLint64>(most, 0));
    device.memory_bytes = device_memory_bytes();
    return device;
}

}  // namespace

bool EglContext::make_current() const {
    if (!context) return false;
    const BoundApi api(EGL_OPENGL_API);
    return eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
}

void EglContext::release() const {
    if (!context) return;
    const BoundApi api(EGL_OPENGL_API);
    if (eglGetCurrentContext() == context) eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

void EglContext::destroy() const {
    if (!context) return;
    release();
    eglDestroyContext(display, context);  // the display stays open: others may use it, and eglTerminate leaks in Mesa
}

EglState EglState::current() {
    EglState state;
    if (!opengl_installed()) return state;
    // The API that is bound need not be that of the context.
    for (const EGLenum api : {eglQueryAPI(), EGLenum{EGL_OPENGL_API}, EGLenum{EGL_OPENGL_ES_API}}) {
        const BoundApi bound(api);
        state.api_ = api;
        state.context_ = {eglGetCurrentDisplay(), eglGetCurrentContext()};
        state.draw_ = eglGetCurrentSurface(EGL_DRAW);
        state.read_ = eglGetCurrentSurface(EGL_READ);
        if (state.context_.context) break;
    }
    return state;
}

void EglState::restore() const {
    if (!opengl_installed()) return;  // none was made, so none is current
    if (context_.context) {
        const BoundApi bound(api_);
        eglMakeCurrent(context_.display, draw_, read_, context_.context);
    } else {
        const BoundApi bound(EGL_OPENGL_API);
        const EGLDisplay display = eglGetCurrentDisplay();
        if (display != EGL_NO_DISPLAY) eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
}

struct GlFinder::State {
    std::vector<Candidate> candidates = find_candidates();
    std::size_t next = 0;
    std::vector<std::string> files;
    int found = 0;
    bool software_found = false;

    /// Puts a device that turned out to be software behind those that may be hardware; false if there are none.
    bool defer(Candidate candidate) {
        const auto rest = candidates.begin() + static_cast<std::ptrdiff_t>(next);
        if (candidate.software || std::all_of(rest, candidates.end(), [](const Candidate& c) { return c.software; }))
            return false;
        candidate.software = true;
        candidates.push_back(candidate);
        return true;
    }

    /// Two drivers may offer the same card; software counts as one device, whichever way it is reached.
    [[nodiscard]] bool known(const Candidate& candidate, const GlDevice& device) const {
        if (!device.hardware) return software_found;
        if (candidate.surfaceless) return found > 0;
        return !candidate.file.empty() && std::ranges::find(files, candidate.file) != files.end();
    }
};

GlFinder::GlFinder() : state_(std::make_unique<State>()) {
}

GlFinder::~GlFinder() = default;

std::optional<OpenedGl> GlFinder::next() {
    State& s = *state_;
    while (s.next < s.candidates.size()) {
        const Candidate candidate = s.candidates[s.next++];
        const EglContext context = make_context(candidate.display);
        if (!context.context) continue;
        GlDevice device = describe();
        if (s.known(candidate, device) || (!device.hardware && s.defer(candidate))) {
            context.destroy();
            continue;
        }
        device.index = s.found++;
        s.files.push_back(candidate.file);
        s.software_found = s.software_found || !device.hardware;
        return OpenedGl{context, device};
    }
    return std::nullopt;
}

}  // namespace subvol::detail
