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
#include <cstdlib>
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

constexpr float kPanel = 340, kSlimPanel = 236;   // width, in units of the screen: the most and the least
constexpr float kPanelShare = 0.36F;              // of a narrow window
constexpr double kSlow_s = 0.3;                   // work is shown that takes longer
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
    bool dragged = false, grabs = false;
    double clicked_at = -1;
    int clicked_frame = 0;
    std::string title{};
};

void on_key(GLFWwindow* window, int key, int, int action, int mods) {
    if (action == GLFW_RELEASE || ImGui::GetIO().WantTextInput) return;
    auto& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
    take_key(self.host, self.memory, 0, key, (mods & GLFW_MOD_CONTROL) != 0, (mods & GLFW_MOD_SHIFT) != 0);
}

void on_drop(GLFWwindow* window, int count, const char** paths) {
    auto& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
    if (count > 0) open_path(self.host, self.memory, paths[0]);
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

/// The pixel of the picture under the pointer, as the numbers of an action.
std::string pixel_text() {
    const ImGuiIO& io = ImGui::GetIO();
    return json_text(double{io.MousePos.x * io.DisplayFramebufferScale.x}) + ", " +
           json_text(double{io.MousePos.y * io.DisplayFramebufferScale.y});
}

/// The border between the pictures that are compared, which can be dragged. returns: whether it took the mouse
bool take_border(Window& self, float width, float height) {
    const ViewState& state = self.host.state();
    if (!state.compare || state.difference) return false;
    const float x = static_cast<float>(state.slider) * width, reach = 7 * self.memory.scale;
    const bool near = ImGui::IsItemHovered() && std::abs(ImGui::GetIO().MousePos.x - x) < reach;
    if (ImGui::IsItemActivated() && near && ImGui::IsMouseDown(ImGuiMouseButton_Left)) self.memory.holds_border = true;
    const bool held = self.memory.holds_border;
    if (near || held) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (held && ImGui::IsItemActive() && ImGui::GetIO().MouseDelta.x != 0)
        run(self.host, self.memory, "slider", json_text(std::clamp(double{ImGui::GetIO().MousePos.x / width}, 0.0, 1.0)));
    if (ImGui::IsItemDeactivated()) self.memory.holds_border = false;
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 at{x, 0.5F * height};
    const float size = (near || held ? 9.0F : 7.0F) * self.memory.scale;
    const auto label = [&](const std::string& method, bool left) {
        const ImVec2 letters = ImGui::CalcTextSize(method.c_str());
        const float pad = 5 * self.memory.scale;
        const ImVec2 from{left ? x - letters.x - 3 * pad : x + pad, pad};
        list->AddRectFilled(from, {from.x + letters.x + 2 * pad, from.y + letters.y + pad},
                            ImGui::GetColorU32(ImGuiCol_WindowBg, 0.8F), 3);
        list->AddText({from.x + pad, from.y + 0.5F * pad}, ImGui::GetColorU32(ImGuiCol_Text), method.c_str());
    };
    label(std::string(name_of(state.method)), true);
    label(std::string(name_of(*state.compare)) + (self.host.shows_reference() ? "" : ": not drawn yet"), false);
    list->AddCircleFilled(at, size, IM_COL32(255, 255, 255, 235));
    list->AddCircle(at, size, IM_COL32(40, 60, 90, 255), 0, 1.5F * self.memory.scale);
    return held;
}

/// The mouse on the picture.
void take_mouse(Window& self, float width, float height) {
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemHovered() && io.MouseWheel != 0) {
        run(self.host, self.memory, "zoom", "[" + json_text(std::pow(1.1, double{io.MouseWheel})) + ", " + pixel_text() + "]");
    }
    if (take_border(self, width, height)) return;
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
    if (!ImGui::IsItemDeactivated() || self.dragged) return;
    if (ImGui::IsMouseReleased(ImGuiMouseButton_Right)) self.memory.asks_menu = true;
    if (!ImGui::IsMouseReleased(ImGuiMouseButton_Left)) return;
    // Where frames are slow, each press and release waits for a frame of its own.
    constexpr int kFramesOfClick = 3;
    constexpr double kSlowest_s = 1;
    const double passed = ImGui::GetTime() - self.clicked_at;
    const bool slow = ImGui::GetFrameCount() - self.clicked_frame <= kFramesOfClick && passed < kSlowest_s;
    const bool twice = self.clicked_at >= 0 && (passed < double{io.MouseDoubleClickTime} || slow);
    self.clicked_at = twice ? -1 : ImGui::GetTime();
    self.clicked_frame = ImGui::GetFrameCount();
    run(self.host, self.memory, twice ? "focus" : "pick", "[" + pixel_text() + "]");
}

/// What is at work, at the right end of the line below the picture, with a button that stops it. returns: where it begins
float draw_work(Window& self, float width, float top, float screen_top) {
    const WindowWork work = self.host.work();
    if (work.stage.empty() || work.seconds < kSlow_s) return width;
    constexpr std::size_t kLongest = 40;
    std::string text = work.stage.size() > kLongest ? "..." + work.stage.substr(work.stage.size() - kLongest) : work.stage;
    if (work.fraction > 0) text += "  " + std::to_string(static_cast<int>(100 * work.fraction)) + " %";
    const float pad = 8 * self.memory.scale, line = ImGui::GetTextLineHeight();
    const float stop = ImGui::CalcTextSize("stop").x + 2 * pad, letters = ImGui::CalcTextSize(text.c_str()).x;
    const float left = std::max(0.0F, width - letters - stop - line - 4 * pad);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImU32 ink = ImGui::GetColorU32(ImGuiCol_SliderGrab);
    const ImVec2 middle{left + 0.5F * line + pad, screen_top + top + pad + 0.5F * line};
    const auto turn = static_cast<float>(4 * ImGui::GetTime());  // a sign that nothing hangs
    list->PathArcTo(middle, 0.38F * line, turn, turn + 4.4F);
    list->PathStroke(ink, 0, 2 * self.memory.scale);
    list->AddText({middle.x + 0.5F * line + pad, screen_top + top + pad}, ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
    ImGui::SetCursorPos({width - stop - pad, top + 0.5F * pad});
    if (ImGui::Button("stop", {stop, line + pad})) self.host.stop();
    tip(self.memory, "gives up what is at work", "Esc");
    return left;
}

/// The line below the picture: figures, or what is wrong.
///
/// screen_top: of the part of the window that is drawn to
void draw_line(Window& self, float width, float height, float screen_top = 0) {
    const std::string problem = self.memory.problem.empty() ? self.host.problem() : self.memory.problem;
    const bool told = ImGui::GetTime() < self.memory.message_until;
    const std::string figures = self.host.has_session() ? self.host.figures() : std::string();
    const std::string text = !problem.empty() ? problem : told ? self.memory.message : figures;
    const float pad = 8 * self.memory.scale, line = ImGui::GetTextLineHeight();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float top = height - line - 2 * pad;
    const ImVec2 from{0, screen_top + top};
    list->AddRectFilled(from, {width, screen_top + height}, ImGui::GetColorU32(ImGuiCol_WindowBg));
    const float right = draw_work(self, width, top, screen_top);
    list->PushClipRect(from, {right - pad, screen_top + height});
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
    take_mouse(self, width, shown);
    draw_selection(self.host, self.memory);
    draw_cut_handles(self.host, self.memory);
    draw_line(self, width, height);
    draw_menu(self.host, self.memory);
    ImGui::End();
}

/// While a button of the mouse is held, all that it changes is one motion for undo.
void group_motions(Window& self) {
    const bool held = ImGui::IsAnyItemActive() && ImGui::IsAnyMouseDown();
    if (held == self.grabs) return;
    self.grabs = held;
    (void)self.host.run(held ? "{\"grab\": true}" : "{\"grab\": false}");
}

/// The page without a file, and the line below it.
void draw_start(Window& self, const ImVec2& size) {
    draw_start_page(self.host, self.memory, size.x, size.y - ImGui::GetTextLineHeight() - 16 * self.memory.scale);
    const float top = size.y - ImGui::GetTextLineHeight() - 16 * self.memory.scale;
    ImGui::SetNextWindowPos({0, top});
    ImGui::SetNextWindowSize({size.x, size.y - top});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::Begin("line", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::PopStyleVar();
    draw_line(self, size.x, size.y - top, top);
    ImGui::End();
}

void set_title(Window& self) {
    const std::string& name = self.host.opened().name;
    const std::string title = name.empty() ? "subvol" : "subvol - " + name;
    if (title == self.title) return;
    self.title = title;
    glfwSetWindowTitle(self.window, title.c_str());
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
    set_title(self);
    if (self.host.has_session()) {
        const float scale = self.memory.scale;
        const bool shown = self.host.look().panel;
        const float panel =
            shown ? std::clamp(kPanelShare * size.x, std::min(kSlimPanel * scale, 0.6F * size.x), kPanel * scale) : 0;
        draw_picture(self, size.x - panel, size.y);
        if (shown) draw_panel(self.host, self.memory, size.x - panel, panel, size.y);
        play_steps(self);
    } else {
        draw_start(self, size);
    }
    if (self.host.look().help) draw_help(self.host, self.memory);
    draw_notes(self.host, self.memory);
    draw_file_dialog(self.host, self.memory);
    group_motions(self);
    self.memory.close_popup = false;
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

bool is_closing(Window& self) {
    if (glfwWindowShouldClose(self.window) != 0) {
        self.memory.quit = may_drop_edits(self.host, self.memory);
        glfwSetWindowShouldClose(self.window, GLFW_FALSE);
    }
    return self.memory.quit;
}

void loop(Window& self) {
    while (!is_closing(self)) {
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

/// Whether the environment names no display. GLFW asks libraries that print messages of their own where there is none.
bool has_no_display() {
#ifdef __linux__
    return std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr;
#else
    return false;
#endif
}

std::optional<std::string> run_window(WindowHost& host, const WindowStart& start) {
    if (has_no_display()) return "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)";
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
    glfwSetDropCallback(window, on_drop);
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
