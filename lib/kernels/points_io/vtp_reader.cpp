// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "points_file.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/detail/surface_io.h"
#include "subvol/detail/vtk_xml.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

/// The one piece of a PolyData file, and its tuples.
class VtpReader {
public:
    VtpReader(std::string_view text, std::string_view file, const std::string& needed)
        : xml_(text, file, "PolyData", needed), file_(file) {
        const auto pieces = xml_.data_set().children("Piece");
        if (pieces.begin() == pieces.end()) xml_.fail_at(xml_.data_set(), "there is no Piece element");
        piece_ = *pieces.begin();
        if (std::next(pieces.begin()) != pieces.end()) xml_.fail_at(xml_.data_set(), "there is more than one piece");
    }

    [[nodiscard]] std::vector<Vec3> points() const {
        const std::size_t count = xml_.count(piece_, "NumberOfPoints");
        if (count == 0) return {};
        const auto values = xml_.arrays().reals(xml_.coordinates(piece_, count));
        std::vector<Vec3> points(count);
        for (std::size_t i = 0; i < count; ++i) points[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
        return points;
    }

    [[nodiscard]] RbfVolume volume() const {
        const pugi::xml_node kernel = xml_.data_set().child("FieldData").find_child_by_attribute("Name", kVtpKernel);
        if (!kernel && piece_.attribute("NumberOfPolys").as_ullong() > 0) refuse_surface(file_);
        RbfVolume volume;
        volume.kernel = kernel_from_json(strings(kVtpKernel).at(0));
        volume.centers = points();
        const std::size_t count = volume.size();
        volume.frames = tensors(kVtpFrame, count);
        for (const std::string& name : strings(kVtpChannels)) {
            RbfChannel channel{.name = name, .gradients = tuples<3>(name + kVtpGradient, count)};
            for (const auto& value : tuples<1>(name, count)) channel.values.push_back(value[0]);
            for (const auto& moment : tuples<1>(name + kVtpMoment, count)) channel.moments.push_back(moment[0]);
            if (has(name + kVtpHessian)) channel.hessians = tensors(name + kVtpHessian, count);
            volume.channels.push_back(std::move(channel));
        }
        return volume;
    }

    /// The number of triangles in the file of the boundary.
    [[nodiscard]] std::size_t boundary_triangles() const {
        const auto values = xml_.arrays().integers(xml_.array(xml_.data_set().child("FieldData"), kVtpTriangles));
        return values.empty() ? 0 : static_cast<std::size_t>(std::max<std::int64_t>(values.front(), 0));
    }

    [[nodiscard]] Surface surface() const {
        Surface surface{points(), {}};
        const std::size_t count = xml_.count(piece_, "NumberOfPolys");
        if (count == 0) return surface;
        const auto array = xml_.array(piece_.child("Polys"), "connectivity");
        const auto corners = xml_.arrays().integers(array);
        xml_.expect_size(array, corners.size(), 3 * count, "3 corners of " + std::to_string(count) + " triangles");
        const auto points = static_cast<std::int64_t>(surface.points.size());
        surface.triangles.resize(count);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if (corners[i] < 0 || corners[i] >= points) {
                xml_.arrays().fail(array, "there is no point with index " + std::to_string(corners[i]));
            }
            surface.triangles[i / 3][i % 3] = static_cast<Index>(corners[i]);
        }
        return surface;
    }

private:
    [[nodiscard]] bool has(const std::string& name) const {
        return !piece_.child("PointData").find_child_by_attribute("Name", without_controls(name).c_str()).empty();
    }

    template <std::size_t N>
    [[nodiscard]] std::vector<std::array<float, N>> tuples(const std::string& name, std::size_t count) const {
        if (count == 0) return {};
        const auto array = xml_.array(piece_.child("PointData"), without_controls(name).c_str());
        const auto values = xml_.arrays().reals(array);
        xml_.expect_size(array, values.size(), N * count, std::to_string(N) + " a point");
        std::vector<std::array<float, N>> tuples(count);
        for (std::size_t i = 0; i < values.size(); ++i) tuples[i / N][i % N] = static_cast<float>(values[i]);
        return tuples;
    }

    // Symmetric tensors, in our order of components.
    [[nodiscard]] std::vector<Symmetric3> tensors(const std::string& name, std::size_t count) const {
        auto tensors = tuples<6>(name, count);
        for (auto& tensor : tensors) {
            const auto theirs = tensor;
            for (std::size_t k = 0; k < 6; ++k) tensor[kVtpTensorOrder[k]] = theirs[k];
        }
        return tensors;
    }

    // At least one string; the array has character codes, with a 0 after each string.
    [[nodiscard]] std::vector<std::string> strings(const char* name) const {
        const auto array = xml_.array(xml_.data_set().child("FieldData"), name);
        std::vector<std::string> strings;
        std::string text;
        for (const std::int64_t c : xml_.arrays().integers(array)) {
            if (c != 0) {
                text += static_cast<char>(c);
            } else {
                strings.push_back(std::move(text));
                text.clear();
            }
        }
        if (strings.empty()) xml_.arrays().fail(array, "it has no string");
        return strings;
    }

    VtkXml xml_;
    std::string_view file_;
    pugi::xml_node piece_;
};

}  // namespace

RbfVolume read_vtp(std::string_view text, const std::filesystem::path& path) {
    const std::string file = path.string();
    const VtpReader reader(text, file, "points of that type are needed");
    RbfVolume volume = reader.volume();
    volume.boundary = read_boundary(path, reader.boundary_triangles());
    return volume;
}

Surface read_boundary(const std::filesystem::path& points, std::size_t triangles) {
    const std::filesystem::path path = boundary_path(points);
    if (triangles == 0 || !std::filesystem::exists(path)) return {};
    const std::string file = path.string(), text = read_regular(path);
    Surface surface = VtpReader(text, file, "a surface of that type is needed").surface();
    if (surface.triangles.size() != triangles) {
        throw Error(ErrorCode::InvalidInput, "has " + counted(surface.triangles.size(), "triangle", "triangles"), file,
                    "the boundary of " + points.string() + " has " + std::to_string(triangles));
    }
    return surface;
}

}  // namespace subvol::detail
