// SPDX-License-Identifier: Apache-2.0
// Gaussian splats as a .glb file, with the extension KHR_gaussian_splatting of glTF: points with a rotation, half axes, an
// opacity and the constant term of a colour. Positions are relative to the centre of the box, so that floats are enough; the
// node has the centre, and turns the axis that is up to glTF's y.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "points_file.h"
#include "splat_gaussians.h"
#include "subvol/detail/output_file.h"
#include "subvol/error.h"
#include "subvol/srgb.h"

namespace subvol::detail {

namespace {

using GltfJson = nlohmann::ordered_json;

/// The node of a mesh whose coordinates are relative to a centre.
GltfJson upright_node(const Vec3& center, UpAxis up) {
    const double half = std::numbers::sqrt2 / 2;
    std::array<double, 4> rotation{0, 0, 0, 1};  // x y z w
    Vec3 place = center;
    if (up == UpAxis::Z) {
        rotation = {-half, 0, 0, half};
        place = {center.x, center.z, -center.y};
    } else if (up == UpAxis::X) {
        rotation = {0, 0, half, half};
        place = {-center.y, center.x, center.z};
    }
    return {{"mesh", 0}, {"rotation", rotation}, {"translation", {place.x, place.y, place.z}}};
}

}  // namespace

void write_glb(const std::filesystem::path& path, const RbfVolume& volume, const PointsWriteOptions& options) {
    const std::size_t count = volume.size();
    if (count == 0) throw Error(ErrorCode::InvalidInput, "there are no points, of which a .glb file needs one", path.string());
    const std::vector<SplatGaussian> gaussians = viewer_gaussians(volume, Mat3(1.0));
    const Vec3 center = box_of(volume).center();
    Vec3 least(0.0), largest(0.0);
    for (const Vec3& x : volume.centers) {
        least = glm::min(least, x - center);
        largest = glm::max(largest, x - center);
    }
    const auto floats = [](const Vec3& v) { return GltfJson{float(v.x), float(v.y), float(v.z)}; };
    GltfJson attributes, accessors = GltfJson::array(), views = GltfJson::array();
    std::size_t total = 0;
    const auto add = [&](const char* name, const char* type, std::size_t channels) {
        constexpr int kFloat = 5126, kVertices = 34962;
        attributes[name] = accessors.size();
        accessors.push_back({{"bufferView", views.size()}, {"componentType", kFloat}, {"count", count}, {"type", type}});
        const std::size_t bytes = sizeof(float) * channels * count;
        views.push_back({{"buffer", 0}, {"byteOffset", total}, {"byteLength", bytes}, {"target", kVertices}});
        total += bytes;
    };
    add("POSITION", "VEC3", 3);
    accessors.back()["min"] = floats(least);
    accessors.back()["max"] = floats(largest);
    add("KHR_gaussian_splatting:ROTATION", "VEC4", 4);
    add("KHR_gaussian_splatting:SCALE", "VEC3", 3);
    add("KHR_gaussian_splatting:OPACITY", "SCALAR", 1);
    add("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", "VEC3", 3);
    add("COLOR_0", "VEC3", 3);  // for viewers that draw points
    if (total > kMostGlbBytes) {
        throw Error(ErrorCode::InvalidInput,
                    "a .glb file has less than 4 GB, which is less than " + std::to_string(count) + " splats need",
                    path.string(), "fewer points, or .ply");
    }
    const GltfJson splatting{{"kernel", "ellipse"}, {"colorSpace", "srgb_rec709_display"}};
    const GltfJson primitive{{"mode", 0}, {"attributes", attributes}, {"extensions", {{"KHR_gaussian_splatting", splatting}}}};
    const GltfJson file{{"asset", {{"version", "2.0"}, {"generator", "OpenSubVol"}}},
                        {"extensionsUsed", GltfJson::array({"KHR_gaussian_splatting"})},
                        {"scene", 0},
                        {"scenes", GltfJson::array({{{"nodes", GltfJson::array({0})}}})},
                        {"nodes", GltfJson::array({upright_node(center, options.up)})},
                        {"meshes", GltfJson::array({{{"primitives", GltfJson::array({primitive})}}})},
                        {"accessors", accessors},
                        {"bufferViews", views},
                        {"buffers", GltfJson::array({{{"byteLength", total}}})}};
    OutputFile out(path);
    out.write(glb_head(file.dump(), total));
    NumberWriter numbers(out);
    const auto put = [&](double x) { numbers.put(static_cast<float>(x)); };
    for (const Vec3& x : volume.centers) numbers.put_point<float>(x - center);
    for (const SplatGaussian& g : gaussians) {
        const auto& [w, x, y, z] = g.rotation;
        for (const double component : {x, y, z, w}) put(component);
    }
    for (const SplatGaussian& g : gaussians) std::ranges::for_each(g.half_axes, put);
    for (const SplatGaussian& g : gaussians) put(std::min(1.0, g.opacity));
    for (const SplatGaussian& g : gaussians) std::ranges::for_each(g.harmonic, put);
    for (const SplatGaussian& g : gaussians) {
        for (const double term : g.harmonic) put(linear_from_srgb(std::clamp(0.5 + kConstantHarmonic * term, 0.0, 1.0)));
    }
    numbers.flush();
    out.commit();
}

}  // namespace subvol::detail
