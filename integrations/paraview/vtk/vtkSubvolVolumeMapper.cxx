// SPDX-License-Identifier: Apache-2.0
#include "vtkSubvolVolumeMapper.h"

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkLight.h>
#include <vtkLightCollection.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLQuadHelper.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLShaderCache.h>
#include <vtkOpenGLState.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPlane.h>
#include <vtkPlaneCollection.h>
#include <vtkRenderer.h>
#include <vtkShaderProgram.h>
#include <vtkTextureObject.h>
#include <vtkUnstructuredGridBase.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtk_glew.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <limits>
#include <mutex>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "grids.h"
#include "option_words.h"
#include "subvol/error.h"
#include "subvol/picture_maker.h"
#include "subvol/shading.h"

using namespace subvol;

namespace {

constexpr int kReductionWhileTurning = 3;
constexpr double kManyFrames = 1;  // a second: VTK asks for 15 while one turns the view, for .0001 or .002 else

constexpr const char* kFragments = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec2 texCoord;
uniform sampler2D picture;
void main() { gl_FragData[0] = texture(picture, texCoord); }
)";

/// The picture of a renderer in the window, and where it lies in the whole one, from the lower left. These are the same unless
/// the camera is off the middle of its window, as in each tile of a large screenshot: then the whole picture is the smallest
/// one about the line of sight that contains it.
struct Tile {
    int whole_width = 0, whole_height = 0;
    int x = 0, y = 0, width = 0, height = 0;
    int window_x = 0, window_y = 0;

    /// The height of the whole picture in those that the camera's angle is for.
    [[nodiscard]] double taller() const { return static_cast<double>(whole_height) / height; }
    [[nodiscard]] bool is_whole() const { return width == whole_width && height == whole_height; }
    bool operator==(const Tile&) const = default;
};

/// Where a camera stands and looks to, in its own axes (right, up) as VTK's matrix says.
///
/// moved:      in stereo, to the right, world units
/// off_middle: of the window, in its halves: the line of sight is so far to the left of the window's middle, and below
struct Aim {
    double moved = 0;
    std::array<double, 2> off_middle{};
};

Aim aim_of(vtkRenderer& renderer) {
    vtkMatrix4x4& matrix = *renderer.GetActiveCamera()->GetProjectionTransformMatrix(renderer.GetTiledAspectRatio(), -1, 1);
    vtkCamera& camera = *renderer.GetActiveCamera();
    const double* const center = camera.GetWindowCenter();
    if (!camera.GetStereo()) return {0, {center[0], center[1]}};
    // Stereo is a shear: x + s z + t in place of x, with z from the eye against the view.
    const double right = matrix.GetElement(0, 0);
    return {-matrix.GetElement(0, 3) / right, {matrix.GetElement(0, 2), matrix.GetElement(1, 2)}};
}

/// exact: the window may not be off the middle by parts of a pixel. Else it is moved by at most a quarter of one
Tile tile_of(vtkRenderer& renderer, const Aim& aim, bool exact) {
    Tile tile;
    renderer.GetTiledSizeAndOrigin(&tile.width, &tile.height, &tile.window_x, &tile.window_y);
    const auto place = [&](double off_middle, int size, int& whole, int& first) {
        const double shift = off_middle * size;
        constexpr double kRounding = 1e-3;
        if (exact && std::abs(shift - std::round(shift)) > kRounding)
            throw Error(ErrorCode::InvalidInput, "the window is off the middle by parts of a pixel", "Camera");
        const auto pixels = static_cast<int>(std::lround(shift));
        whole = size + std::abs(pixels);
        first = std::max(0, pixels);
    };
    place(aim.off_middle[0], tile.width, tile.whole_width, tile.x);
    place(aim.off_middle[1], tile.height, tile.whole_height, tile.y);
    return tile;
}

/// Turns, moves and resizes alike along all axes: world = scale · rotation · mesh + offset.
struct Placement {
    double scale = 1;
    Mat3 rotation{1.0};
    Vec3 offset{0.0};

    [[nodiscard]] Vec3 direction_in_mesh(const Vec3& world) const { return glm::transpose(rotation) * world; }
    [[nodiscard]] Vec3 in_mesh(const Vec3& world) const { return direction_in_mesh(world - offset) / scale; }
};

Placement placement_of(vtkVolume& volume) {
    vtkNew<vtkMatrix4x4> matrix;
    volume.GetMatrix(matrix);
    Placement placement;
    for (int column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row) placement.rotation[column][row] = matrix->GetElement(row, column);
        placement.offset[column] = matrix->GetElement(column, 3);
    }
    placement.scale = glm::length(placement.rotation[0]);
    placement.rotation /= placement.scale;
    const Mat3 square = glm::transpose(placement.rotation) * placement.rotation;
    constexpr double kRounding = 1e-6;
    for (int k = 0; k < 9; ++k) {
        if (std::abs(square[k / 3][k % 3] - (k % 4 == 0 ? 1.0 : 0.0)) > kRounding) {
            throw Error(ErrorCode::InvalidInput, "the volume is scaled otherwise along one axis than along the others", "Scale",
                        "the same number three times");
        }
    }
    return placement;
}

Vec3 vec(const double* x) {
    return {x[0], x[1], x[2]};
}

/// moved: to the right
Camera camera_of(vtkCamera& camera, const Placement& placement, double taller, double moved) {
    constexpr double kDegree = std::numbers::pi / 180;
    const double half_angle = camera.GetViewAngle() / 2 * kDegree;
    const Vec3 eye = vec(camera.GetPosition()), target = vec(camera.GetFocalPoint());
    const Vec3 by = moved * glm::normalize(glm::cross(target - eye, vec(camera.GetViewUp())));
    return {.eye = placement.in_mesh(eye + by),
            .target = placement.in_mesh(target + by),
            .up = placement.direction_in_mesh(vec(camera.GetViewUp())),
            .fovy_deg = 2 * std::atan(taller * std::tan(half_angle)) / kDegree,
            .ortho_height = camera.GetParallelProjection() ? 2 * taller * camera.GetParallelScale() / placement.scale : 0};
}

/// Refuses cameras that a View does not have.
void check_camera(vtkCamera& camera) {
    const double* const shear = camera.GetViewShear();
    if (shear[0] == 0 && shear[1] == 0 && !camera.GetUseHorizontalViewAngle() && !camera.GetUseOffAxisProjection() &&
        !(camera.GetStereo() && camera.GetParallelProjection()))
        return;
    throw Error(ErrorCode::InvalidInput,
                "the camera is sheared, in stereo without perspective, or its angle is that of the width", "Camera");
}

/// Light from the direction of the brightest light that is not at the eye; without one, all of it comes from the eye.
Shading shading_of(vtkRenderer& renderer) {
    Shading shading;
    shading.key = {0, 0, -1};
    vtkCamera& camera = *renderer.GetActiveCamera();
    const Vec3 forward = glm::normalize(vec(camera.GetDirectionOfProjection()));
    const Vec3 right = glm::normalize(glm::cross(forward, vec(camera.GetViewUp()))), up = glm::cross(right, forward);
    double brightest = 0;
    vtkLightCollection& lights = *renderer.GetLights();
    vtkCollectionSimpleIterator at;
    lights.InitTraversal(at);
    while (vtkLight* const light = lights.GetNextLight(at)) {
        const Vec3 color = light->GetIntensity() * vec(light->GetDiffuseColor());
        const double bright = glm::dot(color, Vec3(0.2126, 0.7152, 0.0722));
        double from[3], to[3];
        light->GetTransformedPosition(from);
        light->GetTransformedFocalPoint(to);
        const Vec3 towards = vec(from) - vec(to);
        if (!light->GetSwitch() || light->LightTypeIsHeadlight() || !(bright > brightest) || !(glm::length(towards) > 0))
            continue;
        brightest = bright;
        const Vec3 unit = glm::normalize(towards);
        shading.key = {glm::dot(unit, right), glm::dot(unit, up), glm::dot(unit, forward)};
    }
    return shading;
}

/// The eye depths of what has been drawn in a tile, in the mesh's units, rows from the top; those of the rest of the picture
/// are 0, so that nothing is drawn there. None if nothing has been drawn and the tile is the whole picture.
std::vector<float> opaque_depths(vtkRenderer& renderer, const Tile& tile, double scale) {
    auto& window = *vtkOpenGLRenderWindow::SafeDownCast(renderer.GetRenderWindow());
    std::vector<float> buffer(static_cast<std::size_t>(tile.width) * static_cast<std::size_t>(tile.height));
    window.GetZbufferData(tile.window_x, tile.window_y, tile.window_x + tile.width - 1, tile.window_y + tile.height - 1,
                          buffer.data());
    if (tile.is_whole() && std::ranges::all_of(buffer, [](float z) { return z >= 1; })) return {};
    vtkCamera& camera = *renderer.GetActiveCamera();
    const double near = camera.GetClippingRange()[0], far = camera.GetClippingRange()[1];
    const bool parallel = camera.GetParallelProjection() != 0;
    std::vector<float> depths(static_cast<std::size_t>(tile.whole_width) * static_cast<std::size_t>(tile.whole_height), 0.0F);
    for (int y = 0; y < tile.height; ++y) {
        const auto row = static_cast<std::size_t>(tile.whole_height - 1 - tile.y - y);
        for (int x = 0; x < tile.width; ++x) {
            const double z =
                buffer[static_cast<std::size_t>(y) * static_cast<std::size_t>(tile.width) + static_cast<std::size_t>(x)];
            const double depth = parallel ? near + z * (far - near) : near * far / (far - z * (far - near));
            depths[row * static_cast<std::size_t>(tile.whole_width) + static_cast<std::size_t>(tile.x + x)] =
                z < 1 ? static_cast<float>(depth / scale) : std::numeric_limits<float>::infinity();
        }
    }
    return depths;
}

/// VTK's two functions at the values where either has a knot, and at as many more as curved ones need.
TransferFunction function_of(vtkVolumeProperty& property) {
    constexpr int kSteps = 256;
    TransferFunction function;
    vtkColorTransferFunction& colors = *property.GetRGBTransferFunction();
    vtkPiecewiseFunction& opacities = *property.GetScalarOpacity();
    const auto places = [](const double* range, int knots, const auto& knot) {
        std::vector<double> all;
        for (int i = 0; i <= kSteps; ++i) all.push_back(range[0] + (range[1] - range[0]) * i / kSteps);
        for (int i = 0; i < knots; ++i) all.push_back(knot(i));
        std::ranges::sort(all);
        all.erase(std::unique(all.begin(), all.end()), all.end());
        return all;
    };
    double node[6];
    const auto color_knot = [&](int i) { return colors.GetNodeValue(i, node), node[0]; };
    for (const double value : places(colors.GetRange(), colors.GetSize(), color_knot)) {
        double rgb[3];
        colors.GetColor(value, rgb);
        function.color.push_back({value, glm::clamp(vec(rgb), 0.0, 1.0)});
    }
    const auto opacity_knot = [&](int i) { return opacities.GetNodeValue(i, node), node[0]; };
    for (const double value : places(opacities.GetRange(), opacities.GetSize(), opacity_knot))
        function.opacity.push_back({value, std::clamp(opacities.GetValue(value), 0.0, 1.0)});
    return function;
}

/// The number of each tuple that the colours ask for; -1: its length.
int component_of(vtkVolumeProperty& property, vtkDataArray& array) {
    vtkColorTransferFunction& colors = *property.GetRGBTransferFunction();
    if (array.GetNumberOfComponents() == 1) return 0;
    if (colors.GetVectorMode() != vtkScalarsToColors::COMPONENT) return -1;
    return std::clamp(colors.GetVectorComponent(), 0, array.GetNumberOfComponents() - 1);
}

/// A picture as a texture: rows from the bottom, those of the tile alone.
std::vector<float> texels_of(const Image& image, int left, int bottom, int width, int height) {
    std::vector<float> texels;
    texels.reserve(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = bottom; y < bottom + height; ++y) {
        const float* const row = image.pixel(left, image.height - 1 - y).data();
        texels.insert(texels.end(), row, row + 4 * width);
    }
    return texels;
}

/// A thread that runs one function after the other; whoever asks waits, and gets its error.
class Thread {
public:
    Thread() : thread_([this] { work(); }) {}
    ~Thread() {
        give(nullptr);
        thread_.join();
    }
    Thread(const Thread&) = delete;
    Thread& operator=(const Thread&) = delete;

    void run(const std::function<void()>& task) {
        std::exception_ptr wrong;
        std::promise<void> done;
        const std::function<void()> guarded = [&] {
            try {
                task();
            } catch (...) {
                wrong = std::current_exception();
            }
            done.set_value();
        };
        give(&guarded);
        done.get_future().wait();
        if (wrong) std::rethrow_exception(wrong);
    }

private:
    /// task: null: the last one
    void give(const std::function<void()>* task) {
        {
            const std::scoped_lock lock(mutex_);
            tasks_.push_back(task);
        }
        given_.notify_one();
    }

    void work() {
        for (;;) {
            const std::function<void()>* task = nullptr;
            {
                std::unique_lock lock(mutex_);
                given_.wait(lock, [this] { return !tasks_.empty(); });
                task = tasks_.front();
                tasks_.pop_front();
            }
            if (task == nullptr) return;
            (*task)();
        }
    }

    std::mutex mutex_;
    std::condition_variable given_;
    std::deque<const std::function<void()>*> tasks_;
    std::thread thread_;  // the last member: it uses the others
};

}  // namespace

/// What is kept between pictures. Each part has the key that it was made for.
struct vtkSubvolVolumeMapper::State {
    std::string method = "splat";
    OptionWords options, more;  // set one by one, and in one text

    struct MeshKey {
        vtkUnstructuredGridBase* grid = nullptr;
        vtkMTimeType changed = 0;
        ShownArray shown;

        bool operator==(const MeshKey&) const = default;
    };
    MeshKey mesh_key;
    ReadResult read;
    vtkMTimeType maker_made = 0;  // the mapper's options at that time
    Vec3 maker_light{0.0};        // to the key light, where surfaces are lit
    std::string renderer = "auto", backend;
    Thread thread;                        // of our OpenGL; others draw there too
    std::unique_ptr<PictureMaker> maker;  // made, used and destroyed there

    ~State() {
        thread.run([this] { maker.reset(); });
    }

    struct PictureKey {
        vtkMTimeType mapper = 0, property = 0, colors = 0, opacities = 0, planes = 0;
        Tile tile;
        int reduction = 0;
        std::vector<double> camera;
        std::vector<float> depths;

        bool operator==(const PictureKey&) const = default;
    };
    PictureKey picture_key;
    std::unique_ptr<vtkOpenGLQuadHelper> quad;
    vtkNew<vtkTextureObject> texture;
    vtkMTimeType changed = 0;  // by a call that sets an option

    [[nodiscard]] MethodOptions method_options() const {
        PictureSettings settings;
        settings.options.style.method = named<Method>(method, "Method");
        set_options(options_of(settings), all_options());
        const auto given = all_options();
        subvol::check_options(
            bit(settings.options.style.method), BodyKind::Mesh,
            [&](std::string_view option) {
                const auto at = given.find(option_name(option, OptionNames::Keywords));
                return at == given.end() ? std::nullopt : std::optional(at->second);
            },
            OptionNames::Keywords);
        MethodOptions made = settings.chosen();
        made.style.look.look = Look::Volume;
        if (renderer != "auto" && made.style.method == Method::Splat)
            made.splat.method = named<SplatMethod>(renderer, "Renderer");
        return made;
    }

    [[nodiscard]] OptionWords all_options() const {
        OptionWords all = options;
        for (const auto& [name, text] : more) all[name] = text;
        return all;
    }

    /// Makes what does not depend on the view, unless it is there.
    void prepare(const MeshKey& key, vtkMTimeType options_changed, const Shading& light) {
        if (!(mesh_key == key)) {
            maker.reset();
            mesh_key = {};
            read = mesh_of_data(*key.grid, key.shown);
            mesh_key = key;
        }
        constexpr double kSame = 1e-6;  // lights that turn with the camera are the same but for rounding
        MethodOptions made = method_options();
        const bool lit = made.splat.shading.has_value();
        if (maker && maker_made == options_changed && (!lit || glm::length(light.key - maker_light) < kSame)) return;
        maker.reset();
        if (lit) made.splat.shading = light;
        maker = std::make_unique<PictureMaker>(PictureBody{.mesh = read.mesh}, made);
        maker_made = options_changed;
        maker_light = light.key;
    }

    void draw_kept(vtkRenderer& renderer) {
        auto& window = *vtkOpenGLRenderWindow::SafeDownCast(renderer.GetRenderWindow());
        vtkOpenGLState& state = *window.GetState();
        const vtkOpenGLState::ScopedglEnableDisable depth(&state, GL_DEPTH_TEST), blend(&state, GL_BLEND);
        const vtkOpenGLState::ScopedglDepthMask mask(&state);
        const vtkOpenGLState::ScopedglBlendFuncSeparate function(&state);
        state.vtkglDisable(GL_DEPTH_TEST);  // rays have ended at what is opaque
        state.vtkglEnable(GL_BLEND);
        state.vtkglDepthMask(GL_FALSE);
        state.vtkglBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        if (!quad) quad = std::make_unique<vtkOpenGLQuadHelper>(&window, nullptr, kFragments, nullptr);
        window.GetShaderCache()->ReadyShaderProgram(quad->Program);
        texture->Activate();
        quad->Program->SetUniformi("picture", texture->GetTextureUnit());
        quad->Render();
        texture->Deactivate();
    }
};

vtkStandardNewMacro(vtkSubvolVolumeMapper);

vtkSubvolVolumeMapper::vtkSubvolVolumeMapper() : Internals(std::make_unique<State>()) {
}

vtkSubvolVolumeMapper::~vtkSubvolVolumeMapper() = default;

void vtkSubvolVolumeMapper::PrintSelf(ostream& os, vtkIndent indent) {
    Superclass::PrintSelf(os, indent);
    os << indent << "Method: " << Internals->method << '\n'
       << indent << "Renderer: " << Internals->renderer << '\n'
       << indent << "Reduction: " << Reduction << '\n';
    for (const auto& [name, text] : Internals->all_options()) os << indent << name << ": " << text << '\n';
}

void vtkSubvolVolumeMapper::SetMethod(const char* name) {
    const std::string method = name != nullptr ? name : "splat";
    if (method == Internals->method) return;
    Internals->method = method;
    Modified();
    Internals->changed = GetMTime();
}

void vtkSubvolVolumeMapper::SetRenderer(const char* name) {
    const std::string renderer = name != nullptr ? name : "auto";
    if (renderer == Internals->renderer) return;
    Internals->renderer = renderer;
    Modified();
    Internals->changed = GetMTime();
}

const char* vtkSubvolVolumeMapper::GetBackend() {
    return Internals->backend.c_str();
}

void vtkSubvolVolumeMapper::SetOption(const char* name, const char* text) {
    if (name == nullptr) return;
    auto& options = Internals->options;
    const std::string value = text != nullptr ? text : "";
    const auto found = options.find(name);
    if ((found == options.end() ? "" : found->second) == value) return;
    if (value.empty())
        options.erase(found);
    else
        options[name] = value;
    Modified();
    Internals->changed = GetMTime();
}

void vtkSubvolVolumeMapper::SetOptions(const char* text) {
    OptionWords more = words_of(text);
    if (more == Internals->more) return;
    Internals->more = std::move(more);
    Modified();
    Internals->changed = GetMTime();
}

void vtkSubvolVolumeMapper::ReleaseGraphicsResources(vtkWindow* window) {
    if (Internals->quad) Internals->quad->ReleaseGraphicsResources(window);
    Internals->quad.reset();
    Internals->texture->ReleaseGraphicsResources(window);
    Internals->picture_key = {};
}

void vtkSubvolVolumeMapper::Render(vtkRenderer* renderer, vtkVolume* volume) {
    State& state = *Internals;
    const auto start = std::chrono::steady_clock::now();
    Kept = false;
    vtkUnstructuredGridBase* const grid = GetInput();
    if (grid == nullptr || grid->GetNumberOfCells() == 0) return;
    int at_cells = 0;
    vtkDataArray* const array = GetScalars(grid, ScalarMode, ArrayAccessMode, ArrayId, ArrayName, at_cells);
    if (array == nullptr) return;
    try {
        vtkVolumeProperty& property = *volume->GetProperty();
        vtkCamera& camera = *renderer->GetActiveCamera();
        check_camera(camera);
        const Placement placement = placement_of(*volume);
        const Aim aim = aim_of(*renderer);
        const Tile tile = tile_of(*renderer, aim, !camera.GetStereo());
        const Camera eye = camera_of(camera, placement, tile.taller(), aim.moved);
        const bool turning = renderer->GetRenderWindow()->GetDesiredUpdateRate() > kManyFrames;
        const int reduction = !tile.is_whole() ? 1 : Reduction > 0 ? Reduction : turning ? kReductionWhileTurning : 1;
        const Shading light = shading_of(*renderer);
        State::PictureKey key{
            .mapper = GetMTime(),
            .property = property.GetMTime(),
            .colors = property.GetRGBTransferFunction()->GetMTime(),
            .opacities = property.GetScalarOpacity()->GetMTime(),
            .planes = ClippingPlanes != nullptr ? ClippingPlanes->GetMTime() : 0,
            .tile = tile,
            .reduction = reduction,
            .camera = {eye.eye.x, eye.eye.y, eye.eye.z, eye.target.x, eye.target.y, eye.target.z, eye.up.x, eye.up.y, eye.up.z,
                       eye.fovy_deg, eye.ortho_height, placement.scale, light.key.x, light.key.y, light.key.z},
            .depths = opaque_depths(*renderer, tile, placement.scale)};
        const State::MeshKey mesh_key{
            grid, std::max(grid->GetMTime(), array->GetMTime()),
            ShownArray{array->GetName() != nullptr ? array->GetName() : "", at_cells != 0, component_of(property, *array)}};
        if (state.quad && state.picture_key == key && state.mesh_key == mesh_key) {
            Kept = true;
            state.draw_kept(*renderer);
            return;
        }
        state.picture_key = {};
        PictureStyle style = state.method_options().style;
        for (int i = 0; ClippingPlanes != nullptr && i < ClippingPlanes->GetNumberOfItems(); ++i) {
            vtkPlane& plane = *ClippingPlanes->GetItem(i);  // its normal points to what is left
            style.clip.planes.push_back(
                {placement.in_mesh(vec(plane.GetOrigin())), -placement.direction_in_mesh(vec(plane.GetNormal()))});
        }
        View view(eye, tile.whole_width, tile.whole_height);
        if (!key.depths.empty()) view.end_rays(key.depths);
        if (reduction > 1)
            view = view.resized((tile.width + reduction - 1) / reduction, (tile.height + reduction - 1) / reduction);
        const Optics optics(function_of(property), property.GetScalarOpacityUnitDistance() / placement.scale);
        Picture picture;
        state.thread.run([&] {
            state.prepare(mesh_key, state.changed, light);
            state.maker->set_style(style);
            picture = state.maker->draw(view, optics);
        });
        const FactValue* const backend = picture.facts.find("backend");
        state.backend = backend != nullptr ? std::get<std::string>(backend->value) : "cpu";
        const int width = reduction > 1 ? view.width() : tile.width, height = reduction > 1 ? view.height() : tile.height;
        std::vector<float> texels =
            texels_of(picture.image, reduction > 1 ? 0 : tile.x, reduction > 1 ? 0 : tile.y, width, height);
        state.texture->SetContext(vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()));
        state.texture->SetMinificationFilter(reduction > 1 ? vtkTextureObject::Linear : vtkTextureObject::Nearest);
        state.texture->SetMagnificationFilter(reduction > 1 ? vtkTextureObject::Linear : vtkTextureObject::Nearest);
        state.texture->SetWrapS(vtkTextureObject::ClampToEdge);
        state.texture->SetWrapT(vtkTextureObject::ClampToEdge);
        state.texture->Create2DFromRaw(static_cast<unsigned>(width), static_cast<unsigned>(height), 4, VTK_FLOAT,
                                       texels.data());
        state.picture_key = std::move(key);
        state.draw_kept(*renderer);
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what());
    }
    Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}
