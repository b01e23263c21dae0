// SPDX-License-Identifier: Apache-2.0
// OpenUSD as text. A stage is a tree of prims, each with typed attributes; an attribute has one value, or one for each time
// code:
//
//     def Xform "part" {
//         def Volume "volume" {
//             float3[] extent = [(0, 0, 0), (1, 1, 1)]
//             rel field:density = </part/volume/density>
//             def OpenVDBAsset "density" { asset filePath.timeSamples = { 0: @./a.vdb@, 1: @./b.vdb@, } … } } }
#include "subvol/usd_file.h"

#include <algorithm>
#include <cctype>
#include <functional>

#include "splat_gaussians.h"
#include "subvol/detail/distinct_names.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

constexpr int kDigits = 9;    // of a float
constexpr double kReach = 3;  // σ: what of a Gaussian is in the extent

std::string number(double value) {
    return number_text(value, kDigits);
}

template <class Numbers>
std::string tuple(const Numbers& numbers) {
    std::string text;
    for (const double value : numbers) text += (text.empty() ? "" : ", ") + number(value);
    return "(" + text + ")";
}

std::string tuple(const Vec3& v) {
    return tuple(std::array{v.x, v.y, v.z});
}

/// "[a, b, …]" of count items.
std::string list(std::size_t count, const std::function<std::string(std::size_t)>& item) {
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + item(i);
    return text + "]";
}

std::string box(const Box& extent) {
    return "[" + tuple(extent.lower) + ", " + tuple(extent.upper) + "]";
}

/// As a prim or an attribute may be called.
std::string identifier(const std::string& text) {
    std::string name = text.empty() ? "_" : text;
    for (char& c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0 || static_cast<unsigned char>(c) > 127) c = '_';
    }
    return std::isdigit(static_cast<unsigned char>(name[0])) != 0 ? "_" + name : name;
}

/// Identifiers of several names, each another one.
std::vector<std::string> identifiers(const std::vector<std::string>& names) {
    DistinctNames distinct;
    std::vector<std::string> made;
    for (const std::string& name : names) made.push_back(distinct.take(identifier(name)));
    return made;
}

std::string quoted(const std::string& text) {
    std::string made = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') made += '\\';
        made += c == '\n' ? std::string("\\n") : std::string(1, c);
    }
    return made + "\"";
}

std::string asset(const std::filesystem::path& file, const std::filesystem::path& stage) {
    const auto folder = std::filesystem::absolute(stage).parent_path().lexically_normal();
    const std::string name = std::filesystem::absolute(file).lexically_normal().lexically_relative(folder).generic_string();
    return name.find('@') == std::string::npos ? "@./" + name + "@" : "@@@./" + name + "@@@";
}

/// Writes the lines of a stage with one prim in its root.
class Stage {
public:
    Stage(const std::filesystem::path& path, std::vector<double> codes, UpAxis up)
        : out_(path), codes_(std::move(codes)), root_(identifier(path.stem().string())) {
        line("#usda 1.0\n(");
        line("    defaultPrim = \"" + root_ +
             "\"\n    doc = \"Written by OpenSubVol\"\n    metersPerUnit = 1\n    upAxis = \"" + (up == UpAxis::Y ? "Y" : "Z") +
             "\"");
        if (moves()) {
            line("    startTimeCode = " + number(codes_.front()) + "\n    endTimeCode = " + number(codes_.back()) +
                 "\n    timeCodesPerSecond = 24");
        }
        line(")\n");
        line("def Xform \"" + root_ + "\" (\n    kind = \"component\"\n)\n{");
    }

    [[nodiscard]] const std::string& root() const { return root_; }

    void begin(const std::string& type, const std::string& name) {
        depth_ += 4;
        line("def " + type + " \"" + name + "\"");
        line("{");
    }
    void end() {
        line("}");
        depth_ -= 4;
    }
    void put(const std::string& text) { line("    " + text); }
    /// An attribute with a value at each time code.
    void put(const std::string& declaration, const std::function<std::string(std::size_t)>& value) {
        if (!moves()) return put(declaration + " = " + value(0));
        put(declaration + ".timeSamples = {");
        for (std::size_t step = 0; step < codes_.size(); ++step) put("    " + number(codes_[step]) + ": " + value(step) + ",");
        put("}");
    }
    void commit() {
        line("}");
        out_.commit();
    }

private:
    [[nodiscard]] bool moves() const { return codes_.size() > 1; }
    void line(const std::string& text) { out_.write(std::string(depth_, ' ') + text + "\n"); }

    OutputFile out_;
    std::vector<double> codes_;
    std::string root_;
    std::size_t depth_ = 0;
};

/// Refuses a volume that cannot be written before its file is begun.
void check(const std::filesystem::path& path, std::size_t steps, std::span<const double> codes, UpAxis up) {
    if (up == UpAxis::X) throw Error(ErrorCode::InvalidInput, "OpenUSD has no stages whose x is up", "up", "y or z");
    if (path.extension() != ".usda") throw Error(ErrorCode::InvalidInput, "has an unknown extension", path.string(), ".usda");
    if (steps == 0 || steps != codes.size() || !std::ranges::is_sorted(codes, std::ranges::less_equal()))
        throw Error(ErrorCode::InvalidInput,
                    "there are " + std::to_string(codes.size()) + " time codes for " + std::to_string(steps) + " steps",
                    "codes", "one for each step, ascending");
}

}  // namespace

void write_usd(const std::filesystem::path& path, const UsdVolume& volume) {
    std::vector<double> codes;
    for (const UsdStep& step : volume.steps) codes.push_back(step.code);
    check(path, volume.steps.size(), codes, volume.up);
    if (volume.grids.empty()) throw Error(ErrorCode::InvalidInput, "there are no grids", path.string());
    validate(volume.colors);
    std::vector<std::string> names;
    for (const UsdGrid& grid : volume.grids) names.push_back(grid.name);
    names = identifiers(names);
    const TransferFunction& map = volume.colors;
    Stage stage(path, codes, volume.up);
    stage.begin("Volume", "volume");
    stage.put("float3[] extent", [&](std::size_t step) { return box(volume.steps[step].extent); });
    for (const std::string& name : names) stage.put("rel field:" + name + " = </" + stage.root() + "/volume/" + name + ">");
    stage.put("custom float[] subvol:colorValues = " +
              list(map.color.size(), [&](auto k) { return number(map.color[k].value); }));
    stage.put("custom color3f[] subvol:colors = " + list(map.color.size(), [&](auto k) { return tuple(map.color[k].rgb); }));
    stage.put("custom float[] subvol:opacityValues = " +
              list(map.opacity.size(), [&](auto k) { return number(map.opacity[k].value); }));
    stage.put("custom float[] subvol:opacities = " +
              list(map.opacity.size(), [&](auto k) { return number(map.opacity[k].alpha); }));
    stage.put("custom float subvol:opacityUnit = " + number(volume.opacity_unit_world));
    for (std::size_t k = 0; k < names.size(); ++k) {
        stage.begin("OpenVDBAsset", names[k]);
        stage.put(std::string("token fieldDataType = ") + (volume.grids[k].vectors ? "\"float3\"" : "\"float\""));
        stage.put("token fieldName = " + quoted(volume.grids[k].name));
        stage.put("asset filePath", [&](std::size_t step) { return asset(volume.steps[step].file, path); });
        stage.end();
    }
    stage.end();
    stage.commit();
}

void write_usd(const std::filesystem::path& path, std::span<const RbfVolume> steps, std::span<const double> codes,
               const TransferFunction& colors, UpAxis up) {
    check(path, steps.size(), codes, up);
    validate(colors);
    std::vector<std::string> channels;
    for (const RbfVolume& volume : steps) {
        validate(volume);
        std::vector<std::string> names;
        for (const RbfChannel& channel : volume.channels) names.push_back(channel.name);
        if (channels.empty()) channels = names;
        if (names != channels || volume.size() == 0)
            throw Error(ErrorCode::InvalidInput, "a step has no kernels, or other channels than the first", path.string());
    }
    std::vector<std::vector<SplatGaussian>> gaussians;
    for (const RbfVolume& volume : steps) gaussians.push_back(splat_gaussians(volume, colors));
    const auto each = [&](const auto& text_of) {
        return [&gaussians, text_of](std::size_t step) {
            return list(gaussians[step].size(), [&](std::size_t i) { return text_of(gaussians[step][i]); });
        };
    };
    Stage stage(path, {codes.begin(), codes.end()}, up);
    stage.begin("ParticleField3DGaussianSplat", "splats");
    stage.put("float3[] extent", [&](std::size_t step) {
        Box extent;
        for (std::size_t i = 0; i < steps[step].size(); ++i) {
            const Vec3 reach(kReach * std::ranges::max(gaussians[step][i].half_axes));
            extent.add(steps[step].centers[i] - reach);
            extent.add(steps[step].centers[i] + reach);
        }
        return box(extent);
    });
    stage.put("point3f[] positions", [&](std::size_t step) {
        return list(steps[step].size(), [&](std::size_t i) { return tuple(steps[step].centers[i]); });
    });
    stage.put("float3[] scales", each([](const SplatGaussian& g) { return tuple(g.half_axes); }));
    stage.put("quatf[] orientations", each([](const SplatGaussian& g) { return tuple(g.rotation); }));
    stage.put("float[] opacities", each([](const SplatGaussian& g) { return number(g.opacity); }));
    stage.put("uniform int radiance:sphericalHarmonicsDegree = 0");
    stage.put("float3[] radiance:sphericalHarmonicsCoefficients",
              each([](const SplatGaussian& g) { return tuple(g.harmonic); }));
    const std::vector<std::string> names = identifiers(channels);
    for (std::size_t c = 0; c < names.size(); ++c) {
        stage.put("custom float[] subvol:value:" + names[c], [&](std::size_t step) {
            const std::vector<float>& values = steps[step].channels[c].values;
            return list(values.size(), [&](std::size_t i) { return number(double{values[i]}); });
        });
    }
    stage.end();
    stage.commit();
}

}  // namespace subvol
