#include <algorithm>
#include <charconv>

#include "ply_elements.h"
#include "points_file.h"
#include "subvol/error.h"
#include "subvol/surface_io.h"

namespace subvol {

namespace {

using Names = std::set<std::string, std::less<>>;
constexpr std::array<const char*, 6> kFrame{"sxx", "sxy", "sxz", "syy", "syz", "szz"};
constexpr std::array<const char*, 3> kGradient{"gx", "gy", "gz"};

std::string suffix_of(std::size_t channel) {
    return channel == 0 ? "" : "_" + std::to_string(channel);
}

class PlyReader {
public:
    PlyReader(std::string_view text, const std::filesystem::path& path)
        : path_(path), name_(path.string()), in_(text, name_, TextScanner::Comments::None) {}

    RbfVolume read() {
        header_ = read_ply_header(in_);
        if (!header_.ascii) in_.name_bytes();
        read_comments();
        bool found = false;
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") {
                take_vertices(element);
                found = true;
            } else if (element.name == "boundary_vertex") {
                take_boundary_points(read_ply_element(in_, header_, element, Names{"x", "y", "z"}), element);
            } else if (element.name == "boundary_triangle") {
                take_triangles(read_ply_element(in_, header_, element, Names{"vertex_indices"}), element);
            } else {
                static_cast<void>(read_ply_element(in_, header_, element, {}));
            }
        }
        if (!found) in_.fail("there is no element vertex");
        if (volume_.boundary.triangles.empty()) volume_.boundary = read_boundary(path_, triangles_beside_);
        return std::move(volume_);
    }

private:
    void read_comments() {
        bool has_kernel = false;
        for (const std::string_view comment : header_.comments) {
            const std::size_t space = std::min(comment.find(' '), comment.size());
            const std::string_view key = comment.substr(0, space);
            const std::string value(comment.substr(std::min(space + 1, comment.size())));
            if (key == "kernel") {
                volume_.kernel = kernel_from_text(value);
                has_kernel = true;
            } else if (key == "channel") {
                volume_.channels.push_back({value, {}, {}, {}});
            } else if (key == "boundary_triangles") {
                std::from_chars(value.data(), value.data() + value.size(), triangles_beside_);
            }
        }
        if (!has_kernel) in_.fail("the header has no comment that says the kernel", "write points with subvol");
        if (volume_.channels.empty()) volume_.channels.push_back({"value", {}, {}, {}});
    }

    [[nodiscard]] Names wanted() const {
        Names names{"x", "y", "z", "cx", "cy", "cz"};
        names.insert(kFrame.begin(), kFrame.end());
        for (std::size_t c = 0; c < volume_.channels.size(); ++c) {
            for (const char* name : {"value", "gx", "gy", "gz", "moment"}) names.insert(name + suffix_of(c));
        }
        return names;
    }

    const std::vector<double>& column(const PlyTable& table, const PlyElement& element, const std::string& name) const {
        const auto found = table.find(name);
        if (found == table.end()) {
            in_.fail("element " + in_quotes(element.name) + " has no property " + in_quotes(name));
        }
        // A list, or the same name twice, would have another number of values.
        if (found->second.values.size() != element.count || !found->second.lengths.empty()) {
            in_.fail("element " + in_quotes(element.name) + ": property " + in_quotes(name) + " is not one number a row");
        }
        return found->second.values;
    }

    std::vector<Vec3> points(const PlyTable& table, const PlyElement& element, const std::string& prefix) const {
        const auto& xs = column(table, element, prefix + "x");
        const auto& ys = column(table, element, prefix + "y");
        const auto& zs = column(table, element, prefix + "z");
        std::vector<Vec3> points(element.count);
        for (std::size_t i = 0; i < points.size(); ++i) points[i] = {xs[i], ys[i], zs[i]};
        return points;
    }

    void take_vertices(const PlyElement& element) {
        const PlyTable table = read_ply_element(in_, header_, element, wanted());
        volume_.centers = points(table, element, table.contains("cx") ? "c" : "");
        volume_.frames.resize(element.count);
        for (std::size_t k = 0; k < kFrame.size(); ++k) {
            const auto& values = column(table, element, kFrame[k]);
            for (std::size_t i = 0; i < element.count; ++i) volume_.frames[i][k] = static_cast<float>(values[i]);
        }
        for (std::size_t c = 0; c < volume_.channels.size(); ++c) {
            take_channel(table, element, suffix_of(c), volume_.channels[c]);
        }
    }

    // Gradients and moments that are not there are 0: a kernel then stands for its value alone.
    void take_channel(const PlyTable& table, const PlyElement& element, const std::string& suffix, RbfChannel& channel) const {
        const auto& values = column(table, element, "value" + suffix);
        channel.values.assign(element.count, 0);
        std::transform(values.begin(), values.end(), channel.values.begin(), [](double v) { return static_cast<float>(v); });
        channel.gradients.assign(element.count, {});
        for (std::size_t k = 0; k < 3; ++k) {
            if (!table.contains(kGradient[k] + suffix)) continue;
            const auto& along = column(table, element, kGradient[k] + suffix);
            for (std::size_t i = 0; i < element.count; ++i) channel.gradients[i][k] = static_cast<float>(along[i]);
        }
        channel.moments.assign(element.count, 0);
        if (!table.contains("moment" + suffix)) return;
        const auto& moments = column(table, element, "moment" + suffix);
        std::transform(moments.begin(), moments.end(), channel.moments.begin(), [](double v) { return static_cast<float>(v); });
    }

    void take_boundary_points(const PlyTable& table, const PlyElement& element) {
        volume_.boundary.points = points(table, element, "");
    }

    void take_triangles(const PlyTable& table, const PlyElement& element) {
        const auto found = table.find("vertex_indices");
        if (found == table.end()) in_.fail("element \"boundary_triangle\" has no property \"vertex_indices\"");
        const auto& [corners, lengths] = found->second;
        const bool all_three = std::all_of(lengths.begin(), lengths.end(), [](std::size_t length) { return length == 3; });
        if (!all_three || corners.size() != 3 * element.count) in_.fail("a boundary triangle has not 3 corners");
        volume_.boundary.triangles.resize(element.count);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if (!(corners[i] >= 0 && corners[i] < static_cast<double>(kNone))) {
                in_.fail("boundary triangle " + std::to_string(i / 3) + ": a corner is out of range");
            }
            volume_.boundary.triangles[i / 3][i % 3] = static_cast<Index>(corners[i]);
        }
    }

    const std::filesystem::path& path_;
    std::string name_;
    TextScanner in_;
    PlyHeader header_;
    RbfVolume volume_;
    std::size_t triangles_beside_ = 0;
};

}  // namespace

RbfVolume read_ply(std::string_view text, const std::filesystem::path& path) {
    return PlyReader(text, path).read();
}

}  // namespace subvol
