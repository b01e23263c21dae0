// SPDX-License-Identifier: Apache-2.0
// How many sheets pictures need: CPU seconds of a later frame along a turntable and of the same view with other opacities, and
// the difference from very many sheets, for numbers of sheets and for tolerances on the picture.
//
//   splat_sheets [--frames N] [--numbers 64,200,0] [--tolerances 1e-2,1e-3] [--meshes FOLDER] MODEL|FILE[@FIELD]…
//
// FOLDER gets the meshes with the field f, for peers/vtk_turntable.py.
#include <ctime>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "subvol/error.h"
#include "subvol/image_metrics.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/optics.h"
#include "subvol/quantity.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace {

using namespace subvol;

constexpr int kSize_px = 512, kReferenceSheets = 8192, kTurn = 36;

struct Choice {
    std::string name;
    SplatOptions options;
};

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::vector<double> numbers_in(const std::string& text) {
    std::vector<double> numbers;
    std::istringstream in(text);
    for (std::string word; std::getline(in, word, ',');) numbers.push_back(std::atof(word.c_str()));
    return numbers;
}

HexMesh mesh_named(const std::string& name) {
    const std::size_t at = name.find('@'), colon = name.find(':');
    const std::string base = name.substr(0, std::min(at, colon));
    HexMesh mesh;
    const auto models = list_models();
    if (std::ranges::any_of(models, [&](const auto& model) { return model.name == base; })) {
        mesh = make_model(base, colon == std::string::npos ? 0 : std::atoi(name.c_str() + colon + 1));
    } else {
        mesh = read_mesh(name.substr(0, at)).mesh;
    }
    if (at != std::string::npos) mesh.attributes = {field_of(mesh, "f", name.substr(at + 1))};
    mesh.attributes.resize(1);
    mesh.attributes[0].name = "f";
    return mesh;
}

/// The number of pixels of which a colour is off by more than `most`.
std::size_t pixels_beyond(float most, const Image& image, const Image& reference) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < reference.rgba.size(); i += 4) {
        float off = 0;
        for (std::size_t c = 0; c < 3; ++c) off = std::max(off, std::abs(image.rgba[i + c] - reference.rgba[i + c]));
        if (off > most) ++count;
    }
    return count;
}

void measure(const std::string& name, const std::vector<Choice>& choices, int frames, const std::string& folder) {
    const HexMesh mesh = mesh_named(name);
    if (!folder.empty()) {
        std::string file = name.substr(name.find_last_of('/') + 1);
        file = file.substr(0, file.find_first_of(":@."));
        write_mesh(folder + "/" + file + ".vtu", mesh);
    }
    const auto [low, high] = std::ranges::minmax(mesh.attributes[0].values);
    const Box box = bounds(mesh);
    const Optics optics({.color = {{low, {.27, .0, .33}}, {.5 * (low + high), {.13, .57, .55}}, {high, {.99, .91, .14}}},
                         .opacity = {{low, 0}, {high, .5}}},
                        box.diagonal() / 100);
    const RbfVolume volume = sample_rbf_points(mesh).volume;
    const Camera first = fit_turntable(fit_camera(box, Vec3(-1, 1, -.6)), box, kTurn);
    const std::vector<Camera> cameras = turntable(first, box.center(), kTurn);
    const Image reference = render_splats(volume, View(cameras[1], kSize_px, kSize_px), optics,
                                          {.method = SplatMethod::Cpu, .sheets = kReferenceSheets})
                                .image;
    std::printf("%s: %zu kernels, values %g to %g, camera %g,%g,%g,%g,%g,%g,0,0,1,%g\n", name.c_str(), volume.size(), low, high,
                first.eye.x, first.eye.y, first.eye.z, first.target.x, first.target.y, first.target.z, first.fovy_deg);
    for (const Choice& choice : choices) {
        Splatter splatter(volume, choice.options);
        double best = 1e30, prepare = 0;
        SplatResult kept;
        for (int i = 0; i <= frames; ++i) {
            const View view(cameras[static_cast<std::size_t>(i)], kSize_px, kSize_px);
            const double before = cpu_seconds();
            SplatResult drawn = splatter.draw(view, optics);
            const double seconds = cpu_seconds() - before;
            if (i > 0 && seconds < best) best = seconds, prepare = drawn.report.seconds_prepare;
            if (i == 1) kept = std::move(drawn);
        }
        std::array<double, 2> recolored{};  // the second and the third picture of a view: the second keeps values on sheets
        for (std::size_t i = 0; i < 2; ++i) {
            const double alpha = i == 0 ? .45 : .4;
            const Optics other({.color = optics.function().color, .opacity = {{low, 0}, {high, alpha}}}, optics.opacity_unit());
            const double before = cpu_seconds();
            (void)splatter.draw(View(cameras[static_cast<std::size_t>(frames)], kSize_px, kSize_px), other);
            recolored[i] = cpu_seconds() - before;
        }
        const auto metrics = compare_images(kept.image, reference);
        std::printf(
            "  %-16s %5d to %5d sheets  %.3f CPU s (prepare %.3f wall, other opacities %.3f, %.3f)  %6.1f dB  most %.2e  "
            "beyond .001: "
            "%zu\n",
            choice.name.c_str(), kept.report.sheets, kept.report.sheets_finest, best, prepare, recolored[0], recolored[1],
            metrics.psnr, metrics.max, pixels_beyond(1e-3F, kept.image, reference));
        std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    std::vector<Choice> choices;
    std::vector<std::string> names;
    std::string folder;
    int frames = 3;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word.rfind("--", 0) != 0 || i + 1 == argc) {
            names.push_back(word);
            continue;
        }
        if (word == "--meshes") {
            folder = argv[++i];
            continue;
        }
        const std::vector<double> numbers = numbers_in(argv[++i]);
        if (word == "--frames") frames = static_cast<int>(numbers.at(0));
        for (const double number : numbers) {
            SplatOptions options{.method = SplatMethod::Cpu};
            char text[32];
            std::snprintf(text, sizeof text, "%g", number);
            if (word == "--numbers") {
                options.sheets = static_cast<int>(number);
                choices.push_back({std::string("sheets ") + text, options});
            } else if (word == "--tolerances") {
                options.image_tolerance = number;
                choices.push_back({std::string("tolerance ") + text, options});
            }
        }
    }
    for (const std::string& name : names) measure(name, choices, frames, folder);
} catch (const std::exception& error) {
    std::fprintf(stderr, "splat_sheets: %s\n", error.what());
    return 1;
}
