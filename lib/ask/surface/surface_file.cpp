// SPDX-License-Identifier: Apache-2.0
// Triangles on the limit, with normals, fields and colours, become a file of the format that the extension names. If an origin
// is given, the points are first moved relative to it; then the request is checked, colours are made as bytes of sRGB, and the
// format's writer runs. The file gets its name only when all of it is written.
//
//     .ply     binary: points and fields as doubles, normals as floats, colours of the points
//     .stl     binary: 32-bit floats, three corners for each triangle, with the triangle's own normal
//     .vtp     XML: points and fields as doubles, normals as floats; the field of the colours is the active one
//     .vtkhdf  the same arrays on an unstructured grid of triangles
//     .obj     text: points with all digits, colours as parts of 1, normals; corners count from 1
//     .glb     floats relative to the centre c of the box, colours in linear light; the node has c and turns z up into y up
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

#include "subvol/detail/number_text.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/vtk_xml_writer.h"
#include "subvol/detail/vtkhdf_writer.h"
#include "subvol/error.h"
#include "subvol/limit_surface.h"
#include "subvol/srgb.h"

namespace subvol {

namespace {

using detail::NumberWriter;
using detail::OutputFile;
using Bytes3 = std::array<std::uint8_t, 3>;

/// The colours of the points in sRGB; empty without.
std::vector<Bytes3> colors_of(const LimitSurface& surface, const SurfaceFileOptions& options) {
    std::vector<Bytes3> colors;
    if (!options.color) return colors;
    const ProbedField& field = surface.fields[*options.color];
    for (std::size_t p = 0; p < surface.surface.points.size(); ++p) {
        const Vec3 rgb = color_at(options.function, field.values[p * field.channels]);
        Bytes3 bytes;
        for (int k = 0; k < 3; ++k) {
            bytes[static_cast<std::size_t>(k)] =
                static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(std::clamp(rgb[k], 0.0, 1.0))));
        }
        colors.push_back(bytes);
    }
    return colors;
}

/// A field's name as one word.
std::string word(const std::string& name) {
    std::string made;
    for (const char c : name) made += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' ? c : '_';
    return made.empty() ? "field" : made;
}

void write_ply(OutputFile& out, const LimitSurface& surface, const std::vector<Bytes3>& colors) {
    static_assert(std::endian::native == std::endian::little);
    const std::size_t count = surface.surface.points.size();
    std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(count) +
                       "\nproperty double x\nproperty double y\nproperty double z\n"
                       "property float nx\nproperty float ny\nproperty float nz\n";
    if (!colors.empty()) head += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    for (const ProbedField& field : surface.fields) {
        for (std::size_t c = 0; c < field.channels; ++c) {
            head += "property double " + word(field.name) + (field.channels > 1 ? "_" + std::to_string(c) : "") + "\n";
        }
    }
    head += "element face " + std::to_string(surface.surface.triangles.size()) +
            "\nproperty list uchar int vertex_indices\nend_header\n";
    out.write(head);
    NumberWriter bytes(out);
    for (std::size_t p = 0; p < count; ++p) {
        bytes.put_point<double>(surface.surface.points[p]);
        bytes.put_point<float>(surface.normals[p]);
        if (!colors.empty()) {
            for (const std::uint8_t byte : colors[p]) bytes.put(byte);
        }
        for (const ProbedField& field : surface.fields) {
            for (std::size_t c = 0; c < field.channels; ++c) bytes.put(field.values[p * field.channels + c]);
        }
    }
    for (const auto& t : surface.surface.triangles) {
        bytes.put(std::uint8_t{3});
        for (const Index p : t) bytes.put(static_cast<std::int32_t>(p));
    }
    bytes.flush();
}

void write_stl(OutputFile& out, const LimitSurface& surface) {
    std::string head = "binary STL of OpenSubVol";
    head.resize(80, ' ');
    out.write(head);
    NumberWriter bytes(out);
    bytes.put(static_cast<std::uint32_t>(surface.surface.triangles.size()));
    for (const auto& t : surface.surface.triangles) {
        const Vec3 &a = surface.surface.points[t[0]], &b = surface.surface.points[t[1]], &c = surface.surface.points[t[2]];
        const Vec3 normal = glm::cross(b - a, c - a);
        const double length = glm::length(normal);
        bytes.put_point<float>(length > 0 ? normal / length : Vec3(0.0));
        for (const Vec3* p : {&a, &b, &c}) bytes.put_point<float>(*p);
        bytes.put(std::uint16_t{0});
    }
    bytes.flush();
}

void write_vtp(OutputFile& out, const LimitSurface& surface, const std::optional<std::size_t>& color) {
    const auto& points = surface.surface.points;
    const auto& triangles = surface.surface.triangles;
    detail::VtkXmlWriter xml(out, "PolyData");
    xml.line("<Piece NumberOfPoints=\"" + std::to_string(points.size()) +
             "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
             std::to_string(triangles.size()) + "\">\n<Points>");
    xml.made_array<double>("Points", 3, 3 * points.size(),
                           [&](std::size_t i) { return points[i / 3][static_cast<int>(i % 3)]; });
    xml.line("</Points>\n<Polys>");
    xml.made_array<std::int64_t>("connectivity", 1, 3 * triangles.size(),
                                 [&](std::size_t i) { return static_cast<std::int64_t>(triangles[i / 3][i % 3]); });
    xml.made_array<std::int64_t>("offsets", 1, triangles.size(),
                                 [](std::size_t t) { return static_cast<std::int64_t>(3 * t + 3); });
    xml.line("</Polys>");
    const std::string scalars = surface.fields.empty() ? "" : surface.fields[color.value_or(0)].name;
    xml.line(std::string("<PointData Normals=\"Normals\"") +
             (scalars.empty() ? "" : " Scalars=\"" + detail::attribute_value(scalars) + "\"") + ">");
    xml.made_array<float>("Normals", 3, 3 * points.size(),
                          [&](std::size_t i) { return static_cast<float>(surface.normals[i / 3][static_cast<int>(i % 3)]); });
    for (const ProbedField& field : surface.fields) xml.array<double>(field.name, field.channels, field.values);
    xml.line("</PointData>\n</Piece>");
    xml.end();
}

/// An unstructured grid of triangles: VTK reads surfaces of VTKHDF from version 9.2 on only.
void write_vtkhdf(const std::filesystem::path& path, const LimitSurface& surface) {
    constexpr std::uint8_t kTriangle = 5;
    detail::VtkHdfWriter out(path);
    std::vector<std::int64_t> corners;
    corners.reserve(3 * surface.surface.triangles.size());
    for (const auto& t : surface.surface.triangles) corners.insert(corners.end(), t.begin(), t.end());
    out.grid(surface.surface.points, corners, kTriangle, 3);
    std::vector<float> normals;
    normals.reserve(3 * surface.normals.size());
    for (const Vec3& n : surface.normals) {
        for (int k = 0; k < 3; ++k) normals.push_back(static_cast<float>(n[k]));
    }
    out.array("Normals", std::span<const float>(normals), 3);
    for (const ProbedField& field : surface.fields) {
        out.array(field.name, std::span<const double>(field.values), field.channels);
    }
    out.commit();
}

void write_obj(OutputFile& out, const LimitSurface& surface, const std::vector<Bytes3>& colors) {
    using detail::exact_text;
    using detail::number_text;
    std::string lines = "# OpenSubVol\n";
    const auto flush = [&](bool always) {
        if (!always && lines.size() < (1U << 16)) return;
        out.write(lines);
        lines.clear();
    };
    for (std::size_t p = 0; p < surface.surface.points.size(); ++p) {
        const Vec3& x = surface.surface.points[p];
        lines += "v " + exact_text(x.x) + " " + exact_text(x.y) + " " + exact_text(x.z);
        if (!colors.empty()) {
            for (const std::uint8_t byte : colors[p]) lines += " " + number_text(byte / 255.0, 4);
        }
        const Vec3& n = surface.normals[p];
        lines += "\nvn " + number_text(n.x) + " " + number_text(n.y) + " " + number_text(n.z) + "\n";
        flush(false);
    }
    for (const auto& t : surface.surface.triangles) {
        lines += "f";
        for (const Index p : t) {
            const std::string number = std::to_string(p + 1);
            lines += " " + number + "//" + number;
        }
        lines += "\n";
        flush(false);
    }
    flush(true);
}

/// Positions relative to the centre of the box, so that floats are enough; the node has the centre, and turns z up into y up.
void write_glb(OutputFile& out, const LimitSurface& surface, const std::vector<Bytes3>& colors) {
    const auto& [points, triangles] = surface.surface;
    Box box;
    for (const Vec3& p : points) box.add(p);
    const Vec3 center = box.center();
    Vec3 least(0.0), most(0.0);
    for (const Vec3& p : points) {
        const Vec3 at = p - center;
        least = glm::min(least, at);
        most = glm::max(most, at);
    }
    const std::size_t count = points.size(), vectors = 12 * count, color_bytes = colors.empty() ? 0 : 4 * count;
    const std::size_t corners = 3 * triangles.size(), total = 2 * vectors + color_bytes + 4 * corners;
    if (total > detail::kMostGlbBytes) {
        throw Error(ErrorCode::InvalidInput, "a .glb file has less than 4 GB", "surface", "a larger tolerance, or .ply");
    }
    using Json = nlohmann::ordered_json;
    enum Target { Vertices = 34962, Corners = 34963 };
    enum Component { Byte = 5121, Unsigned = 5125, Float = 5126 };
    const auto numbers = [](const Vec3& v) { return Json{float(v.x), float(v.y), float(v.z)}; };
    Json views, accessors;
    const auto add = [&](Target target, std::size_t bytes, Json accessor) {
        const std::size_t offset =
            views.empty() ? 0 : views.back()["byteOffset"].get<std::size_t>() + views.back()["byteLength"].get<std::size_t>();
        accessor["bufferView"] = views.size();
        accessors.push_back(std::move(accessor));
        views.push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}, {"target", target}});
    };
    Json attributes{{"POSITION", 0}, {"NORMAL", 1}};
    add(Vertices, vectors,
        {{"componentType", Float}, {"count", count}, {"type", "VEC3"}, {"min", numbers(least)}, {"max", numbers(most)}});
    add(Vertices, vectors, {{"componentType", Float}, {"count", count}, {"type", "VEC3"}});
    add(Corners, 4 * corners, {{"componentType", Unsigned}, {"count", corners}, {"type", "SCALAR"}});
    if (!colors.empty()) {
        attributes["COLOR_0"] = 3;
        add(Vertices, color_bytes, {{"componentType", Byte}, {"normalized", true}, {"count", count}, {"type", "VEC4"}});
    }
    const double half = std::numbers::sqrt2 / 2;
    const Json node{{"mesh", 0}, {"rotation", {-half, 0, 0, half}}, {"translation", numbers({center.x, center.z, -center.y})}};
    const Json material{{"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.6}}}};
    const Json primitive{{"material", 0}, {"attributes", attributes}, {"indices", 2}};
    const Json file{{"asset", {{"version", "2.0"}, {"generator", "OpenSubVol"}}},
                    {"scene", 0},
                    {"scenes", Json::array({{{"nodes", Json::array({0})}}})},
                    {"nodes", Json::array({node})},
                    {"materials", Json::array({material})},
                    {"meshes", Json::array({{{"primitives", Json::array({primitive})}}})},
                    {"accessors", accessors},
                    {"bufferViews", views},
                    {"buffers", Json::array({{{"byteLength", total}}})}};
    out.write(detail::glb_head(file.dump(), total));
    NumberWriter bytes(out);
    for (const Vec3& p : points) bytes.put_point<float>(p - center);
    for (const Vec3& n : surface.normals) bytes.put_point<float>(n);
    for (const auto& t : triangles) {
        for (const Index p : t) bytes.put(static_cast<std::uint32_t>(p));
    }
    // glTF's vertex colours are linear, and 8 bits are too few for that near black; they are what viewers expect of files of
    // this size.
    for (const Bytes3& color : colors) {
        for (const std::uint8_t byte : color) {
            bytes.put(static_cast<std::uint8_t>(std::lround(255 * linear_from_srgb(byte / 255.0))));
        }
        bytes.put(std::uint8_t{255});
    }
    bytes.flush();
}

}  // namespace

std::size_t collapsed_by_floats(const Surface& surface, const Vec3& origin) {
    return static_cast<std::size_t>(std::ranges::count_if(surface.triangles, [&](const auto& t) {
        std::array<glm::vec3, 3> x;
        for (std::size_t k = 0; k < 3; ++k) x[k] = glm::vec3(surface.points[t[k]] - origin);
        const bool lost = x[0] == x[1] || x[1] == x[2] || x[2] == x[0];
        return lost && surface.points[t[0]] != surface.points[t[1]] && surface.points[t[1]] != surface.points[t[2]] &&
               surface.points[t[2]] != surface.points[t[0]];
    }));
}

void write_limit_surface(const std::filesystem::path& path, const LimitSurface& surface, const SurfaceFileOptions& options) {
    if (options.origin != Vec3(0.0)) {
        LimitSurface moved = surface;
        for (Vec3& p : moved.surface.points) p -= options.origin;
        write_limit_surface(path, moved, {options.color, options.function, Vec3(0.0)});
        return;
    }
    const std::string extension = path.extension().string();
    constexpr std::array<std::string_view, 6> kExtensions{".ply", ".stl", ".vtp", ".obj", ".glb", ".vtkhdf"};
    if (std::ranges::find(kExtensions, extension) == kExtensions.end()) {
        throw Error(ErrorCode::InvalidInput, "'" + detail::printable(extension) + "' is not a format of surfaces",
                    path.string(), ".ply, .stl, .vtp, .obj, .glb, .vtkhdf");
    }
    if (surface.surface.triangles.empty()) {
        throw Error(ErrorCode::InvalidInput, "the surface has no triangles", path.string());
    }
    if (options.color && *options.color >= surface.fields.size()) {
        throw Error(ErrorCode::InvalidInput, "there is no field " + std::to_string(*options.color), path.string(),
                    "below " + std::to_string(surface.fields.size()));
    }
    const auto colors = colors_of(surface, options);
    if (extension == ".vtkhdf") {
        write_vtkhdf(path, surface);
        return;
    }
    OutputFile out(path);
    if (extension == ".ply") write_ply(out, surface, colors);
    if (extension == ".stl") write_stl(out, surface);
    if (extension == ".vtp") write_vtp(out, surface, options.color);
    if (extension == ".obj") write_obj(out, surface, colors);
    if (extension == ".glb") write_glb(out, surface, colors);
    out.commit();
}

}  // namespace subvol
