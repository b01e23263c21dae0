// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <set>

#include "points_file.h"
#include "subvol/detail/principal_axes.h"
#include "subvol/detail/surface_io.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/detail/vtk_xml_writer.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");

template <class T, std::size_t N>
std::span<const T> flat(const std::vector<std::array<T, N>>& tuples) {
    return {reinterpret_cast<const T*>(tuples.data()), N * tuples.size()};
}

std::span<const double> flat(const std::vector<Vec3>& points) {
    return {reinterpret_cast<const double*>(points.data()), 3 * points.size()};
}

void write_piece(VtkXmlWriter& out, const std::vector<Vec3>& points, std::size_t verts, std::size_t polys) {
    out.line("<Piece NumberOfPoints=\"" + std::to_string(points.size()) + "\" NumberOfVerts=\"" + std::to_string(verts) +
             "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" + std::to_string(polys) + "\">\n<Points>");
    out.array("Points", 3, flat(points));
    out.line("</Points>");
}

/// Writes cells that all have the same number of corners.
void write_cells(VtkXmlWriter& out, const std::string& kind, std::span<const std::int64_t> connectivity, std::size_t corners) {
    std::vector<std::int64_t> offsets(connectivity.size() / corners);
    for (std::size_t c = 0; c < offsets.size(); ++c) offsets[c] = static_cast<std::int64_t>(corners * (c + 1));
    out.line("<" + kind + ">");
    out.array("connectivity", 1, connectivity);
    out.array<std::int64_t>("offsets", 1, offsets);
    out.line("</" + kind + ">");
}

void write_field_data(VtkXmlWriter& out, const RbfVolume& volume) {
    std::vector<std::string> names;
    for (const auto& channel : volume.channels) names.push_back(channel.name);
    const auto triangles = static_cast<std::int64_t>(volume.boundary.triangles.size());
    out.line("<FieldData>");
    out.strings(kVtpKernel, std::array{to_json(volume.kernel)});
    out.strings(kVtpChannels, names);
    out.line("<DataArray type=\"Int64\" Name=\"" + std::string(kVtpTriangles) + "\" NumberOfTuples=\"1\" format=\"ascii\">" +
             std::to_string(triangles) + "</DataArray>\n</FieldData>");
}

void write_tensors(VtkXmlWriter& out, const std::string& name, const std::vector<Symmetric3>& tensors) {
    std::vector<Symmetric3> in_order(tensors.size());
    for (std::size_t i = 0; i < tensors.size(); ++i) {
        for (std::size_t k = 0; k < 6; ++k) in_order[i][k] = tensors[i][kVtpTensorOrder[k]];
    }
    out.array(name, 6, flat(in_order));
}

/// Writes the ellipsoids for display: √S as nine components, and the radius of the ball with the same volume.
void write_shapes(VtkXmlWriter& out, const RbfVolume& volume) {
    std::vector<std::array<float, 9>> roots(volume.size());
    std::vector<float> sizes(volume.size());
    tbb::parallel_for(std::size_t{0}, volume.size(), [&](std::size_t i) {
        const auto [half_axes, directions] = principal_axes(volume.frames[i]);
        Mat3 root(0.0);
        for (int k = 0; k < 3; ++k) root += half_axes[k] * glm::outerProduct(directions[k], directions[k]);
        for (int k = 0; k < 9; ++k) roots[i][static_cast<std::size_t>(k)] = static_cast<float>(root[k / 3][k % 3]);
        sizes[i] = static_cast<float>(std::cbrt(half_axes.x * half_axes.y * half_axes.z));
    });
    write_tensors(out, kVtpFrame, volume.frames);
    out.array(kVtpEllipsoid, 9, flat(roots));
    out.array<float>(kVtpSize, 1, sizes);
}

// The name for Hessians must be free even in a channel without them: an array of that name would be read as its Hessians.
void check_names(const RbfVolume& volume) {
    std::set<std::string> names{kVtpFrame, kVtpEllipsoid, kVtpSize};
    for (const auto& channel : volume.channels) {
        for (const char* suffix : {"", kVtpGradient, kVtpMoment, kVtpHessian}) {
            if (names.insert(without_controls(channel.name + suffix)).second) continue;
            throw Error(ErrorCode::InvalidInput, "two arrays would be named \"" + channel.name + suffix + "\"");
        }
    }
}

void write_point_data(VtkXmlWriter& out, const RbfVolume& volume) {
    out.line("<PointData Scalars=\"" + attribute_value(volume.channels.front().name) + "\">");
    for (const auto& channel : volume.channels) {
        out.array<float>(channel.name, 1, channel.values);
        out.array(channel.name + kVtpGradient, 3, flat(channel.gradients));
        out.array<float>(channel.name + kVtpMoment, 1, channel.moments);
        if (!channel.hessians.empty()) write_tensors(out, channel.name + kVtpHessian, channel.hessians);
    }
    write_shapes(out, volume);
    out.line("</PointData>");
}

/// Two hyphens would end a comment of XML; the notes are JSON, which has another way to write them.
std::string without_hyphens(std::string note) {
    for (std::size_t at = note.find("--"); at != std::string::npos; at = note.find("--", at)) {
        note.replace(at, 2, "\\u002d\\u002d");
    }
    return note;
}

void write_points(OutputFile& out, const RbfVolume& volume, const std::string& note) {
    std::vector<std::int64_t> vertices(volume.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = static_cast<std::int64_t>(i);
    VtkXmlWriter xml(out, "PolyData");
    if (!note.empty()) xml.line("<!--" + (kNoteMark + without_hyphens(without_controls(note))) + kNoteEnd);
    write_field_data(xml, volume);
    write_piece(xml, volume.centers, volume.size(), 0);
    write_cells(xml, "Verts", vertices, 1);
    write_point_data(xml, volume);
    xml.line("</Piece>");
    xml.end();
}

void write_surface(OutputFile& out, const Surface& surface) {
    std::vector<std::int64_t> corners;
    corners.reserve(3 * surface.triangles.size());
    for (const auto& triangle : surface.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    VtkXmlWriter xml(out, "PolyData");
    write_piece(xml, surface.points, 0, surface.triangles.size());
    write_cells(xml, "Polys", corners, 3);
    xml.line("</Piece>");
    xml.end();
}

}  // namespace

void write_vtp(const std::filesystem::path& path, const RbfVolume& volume, const std::string& note) {
    check_names(volume);
    OutputFile out(path);
    write_points(out, volume, note);
    out.close();
    BoundaryFile(path, volume.boundary).commit();
    out.commit();
}

std::filesystem::path boundary_path(const std::filesystem::path& points) {
    std::filesystem::path path = points;
    return path.replace_extension(".boundary.vtp");
}

BoundaryFile::BoundaryFile(const std::filesystem::path& points, const Surface& boundary) {
    if (boundary.triangles.empty()) return;
    file_ = std::make_unique<OutputFile>(boundary_path(points));
    write_surface(*file_, boundary);
}

BoundaryFile::~BoundaryFile() = default;

void BoundaryFile::commit() {
    if (file_) file_->commit();
}

}  // namespace subvol::detail
