// SPDX-License-Identifier: Apache-2.0
// The module subvol_window.so: the window, by GLFW and Dear ImGui. The picture fills it up to the panel at the right, one pixel
// of the screen for each of its own; a worker draws it, so the window itself never waits.
#include <epoxy/gl.h>

// epoxy before GLFW, which otherwise brings its own OpenGL
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "panel.h"
#include "subvol/raster.h"
#include "subvol/version.h"

namespace subvol::detail {

namespace {

/// A texture of OpenGL for ImDrawList::AddImage: a pointer until 1.91.3, a number from 1.91.4 on.
[[nodiscard]] inline ImTextureID texture_id(unsigned texture) {
#if IMGUI_VERSION_NUM >= 19140
    return static_cast<ImTextureID>(texture);
#else
    return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture));
#endif
}

constexpr float kPanel = 340;                     // width, in units of the screen
constexpr float kOrbit_deg = 0.35F;               // for each pixel of a drag
constexpr double kBusy_s = 0.01, kIdle_s = 0.25;  // between frames without events
constexpr double kStep_s = 0.5;                   // between steps that play
constexpr int kSettled = 3;                       // frames after which a window looks as it will

std::string g_why;

struct Window {
    WindowHost& host;
    WindowMemory memory{};
    GLFWwindow* window = nullptr;
    GLuint texture = 0;
    ScreenPicture picture{};
    std::uint64_t uploaded = 0;
    int settled = 0;
    bool dark = true;
    bool dragged = false;
};

void on_key(GLFWwindow* window, int key, int, int action, int mods) {
    if (action == GLFW_RELEASE || ImGui::GetIO().WantTextInput) return;
    auto& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
    take_key(self.host, self.memory, 0, key, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_SHIFT) != 0);
}

void on_character(GLFWwindow* window, unsigned character) {
    if (ImGui::GetIO().WantTextInput) return;
    auto& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
    take_key(self.host, self.memory, character, 0, false, false);
}

void upload(Window& self) {
    if (!self.host.take_picture(self.picture)) return;
    glBindTexture(GL_TEXTURE_2D, self.texture);
    const int filter = self.picture.scale > 1 ? GL_LINEAR : GL_NEAREST;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, self.picture.width, self.picture.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 self.picture.rgba.data());
    self.settled = 0;
}

/// The mouse on the picture.
void take_mouse(Window& self, float height) {
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemHovered() && io.MouseWheel != 0)
        run(self.host, self.memory, "zoom", json_text(std::pow(1.1, double{io.MouseWheel})));
    if (take_cut(self.host, self.memory)) return;
    if (take_tool(self.host, self.memory, height)) return;
    if (ImGui::IsItemActivated()) self.dragged = false;
    if (ImGui::IsItemActive()) {
        const ImVec2 by = io.MouseDelta;
        if (ImGui::IsMouseDragging(ImGuiMouseButton_Left, 3) || ImGui::IsMouseDragging(ImGuiMouseButton_Middle, 3) ||
            ImGui::IsMouseDragging(ImGuiMouseButton_Right, 3)) {
            self.dragged = true;
        }
        if (self.dragged && (by.x != 0 || by.y != 0)) {
            const bool moves = ImGui::IsMouseDown(ImGuiMouseButton_Middle) || io.KeyShift;
            if (ImGui::IsMouseDown(ImGuiMouseButton_Right)) {
                run(self.host, self.memory, "zoom", json_text(std::exp(-0.008 * double{by.y})));
            } else if (moves) {
                run(self.host, self.memory, "pan", json_text(double{by.x} / double{height}, -double{by.y} / double{height}));
            } else {
                run(self.host, self.memory, "orbit", json_text(double{-kOrbit_deg * by.x}, double{kOrbit_deg * by.y}));
            }
        }
    }
    if (ImGui::IsItemDeactivated() && !self.dragged && ImGui::IsMouseReleased(ImGuiMouseButton_Left)) {
        const double fine = double{io.DisplayFramebufferScale.x};
        run(self.host, self.memory, "pick", json_text(double{io.MousePos.x} * fine, double{io.MousePos.y} * fine));
    }
}

/// The line below the picture: figures, or what is wrong.
void draw_line(Window& self, float width, float height) {
    const std::string problem = self.memory.problem.empty() ? self.host.problem() : self.memory.problem;
    const bool told = ImGui::GetTime() < self.memory.message_until;
    const std::string text = !problem.empty() ? problem : told ? self.memory.message : self.host.figures();
    const float pad = 8 * self.memory.scale, line = ImGui::GetTextLineHeight();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 from{0, height - line - 2 * pad};
    list->AddRectFilled(from, {width, height}, ImGui::GetColorU32(ImGuiCol_WindowBg));
    list->PushClipRect(from, {width - pad, height});
    const ImU32 ink = problem.empty() ? ImGui::GetColorU32(ImGuiCol_Text) : IM_COL32(230, 90, 70, 255);
    list->AddText({pad, from.y + pad}, ink, text.c_str());
    list->PopClipRect();
}

void draw_picture(Window& self, float width, float height) {
    const ImGuiIO& io = ImGui::GetIO();
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({width, height});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::Begin("picture", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar();
    const float foot = ImGui::GetTextLineHeight() + 16 * self.memory.scale, shown = height - foot;
    const int columns = std::max(16, static_cast<int>(width * io.DisplayFramebufferScale.x));
    const int rows = std::max(16, static_cast<int>(shown * io.DisplayFramebufferScale.y));
    const ViewState& state = self.host.state();
    if (state.width != columns || state.height != rows)
        run(self.host, self.memory, "size", "[" + std::to_string(columns) + ", " + std::to_string(rows) + "]");
    upload(self);
    if (self.picture.number > 0)
        ImGui::GetWindowDrawList()->AddImage(texture_id(self.texture), {0, 0},
                                             {static_cast<float>(columns) / io.DisplayFramebufferScale.x,
                                              static_cast<float>(rows) / io.DisplayFramebufferScale.y});
    ImGui::SetCursorPos({0, 0});
    ImGui::InvisibleButton(
        "mouse", {width, shown},
        ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
    take_mouse(self, shown);
    draw_selection(self.host, self.memory);
    draw_cut_handles(self.host, self.memory);
    draw_line(self, width, height);
    ImGui::End();
}

void play_steps(Window& self) {
    if (!self.host.look().play || self.host.busy() || self.host.times().size() < 2) return;
    if (ImGui::GetTime() < self.memory.next_step_at) return;
    self.memory.next_step_at = ImGui::GetTime() + kStep_s;
    run(self.host, self.memory, "step", std::to_string((self.host.state().step + 1) % self.host.times().size()));
}

void draw_frame(Window& self) {
    if (self.dark != self.host.look().dark) {
        self.dark = self.host.look().dark;
        set_style(self.dark, self.memory.scale);
    }
    if (const std::string wrong = self.host.settle(); !wrong.empty()) self.memory.problem = wrong;
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float panel = std::min(kPanel * self.memory.scale, 0.6F * size.x);
    draw_picture(self, size.x - panel, size.y);
    draw_panel(self.host, self.memory, size.x - panel, panel, size.y);
    if (self.host.look().help) draw_help(self.host, self.memory);
    play_steps(self);
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(self.window, &width, &height);
    glViewport(0, 0, width, height);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void save(Window& self) {
    int width = 0, height = 0;
    glfwGetFramebufferSize(self.window, &width, &height);
    const auto row = 3 * static_cast<std::size_t>(width);
    std::vector<std::uint8_t> upwards(row * static_cast<std::size_t>(height)), pixels(upwards.size());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, upwards.data());
    for (int y = 0; y < height; ++y)
        std::copy_n(upwards.data() + pixel_index(row, 0, height - 1 - y), row, pixels.data() + pixel_index(row, 0, y));
    self.host.save_window(width, height, pixels);
}

void loop(Window& self) {
    while (glfwWindowShouldClose(self.window) == 0 && !self.memory.quit) {
        glfwWaitEventsTimeout(self.host.busy() || self.settled < kSettled ? kBusy_s : kIdle_s);
        const bool ended = self.settled >= kSettled && self.host.play_script();
        draw_frame(self);
        ++self.settled;
        if (ended) {
            save(self);
            return;
        }
        glfwSwapBuffers(self.window);
    }
}

/// Ends GLFW, whatever happens.
struct Glfw {
    bool on = glfwInit() == GLFW_TRUE;
    ~Glfw() {
        if (on) glfwTerminate();
    }
};

struct Gui {
    explicit Gui(GLFWwindow* window, float scale) {
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;
        load_letters(scale);
        set_style(true, scale);
        ImGui_ImplGlfw_InitForOpenGL(window, true);
        ImGui_ImplOpenGL3_Init("#version 150");
    }
    ~Gui() {
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }
};

std::optional<std::string> run_window(WindowHost& host, const WindowStart& start) {
    glfwSetErrorCallback([](int, const char* why) { g_why = why; });
    const Glfw glfw;
    if (!glfw.on) return "there is no display (" + g_why + ")";
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 2);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    GLFWwindow* window = glfwCreateWindow(start.width, start.height, start.title, nullptr, nullptr);
    if (window == nullptr) return "a window cannot be opened (" + g_why + ")";
    glfwMakeContextCurrent(window);
    Window self{.host = host};
    self.window = window;
    glfwGetWindowContentScale(window, &self.memory.scale, nullptr);
    self.memory.scale = std::clamp(self.memory.scale, 1.0F, 4.0F);
    glfwSetWindowUserPointer(window, &self);
    glfwSetKeyCallback(window, on_key);  // before those of ImGui, which call them
    glfwSetCharCallback(window, on_character);
    const Gui gui(window, self.memory.scale);
    glGenTextures(1, &self.texture);
    loop(self);
    glDeleteTextures(1, &self.texture);
    return std::nullopt;
}

}  // namespace

}  // namespace subvol::detail

extern "C" {
extern const char subvol_module_version[];
const char subvol_module_version[] = SUBVOL_VERSION;

const subvol::detail::WindowFunctions* subvol_window() {
    static constexpr subvol::detail::WindowFunctions kFunctions{&subvol::detail::run_window};
    return &kFunctions;
}
}
