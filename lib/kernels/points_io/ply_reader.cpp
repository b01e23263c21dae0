// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "points_file.h"
#include "subvol/detail/ply_table.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/detail/surface_io.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

using Names = std::set<std::string, std::less<>>;
constexpr std::array<const char*, 6> kFrame{"sxx", "sxy", "sxz", "syy", "syz", "szz"};
constexpr std::array<const char*, 3> kGradient{"gx", "gy", "gz"};
constexpr std::array<const char*, 1> kMoment{"moment"};
constexpr std::array<const char*, 6> kHessian{"hxx", "hxy", "hxz", "hyy", "hyz", "hzz"};

std::string suffix_of(std::size_t channel) {
    return channel == 0 ? "" : "_" + std::to_string(channel);
}

class PlyReader {
public:
    PlyReader(std::string_view text, const std::filesystem::path& path, std::vector<double>* numbers)
        : path_(path), name_(path.string()), in_(text, name_, TextScanner::Comments::None), numbers_(numbers) {}

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
                std::ignore = read_ply_element(in_, header_, element, {});
            }
        }
        expect_ply_end(in_);
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
                volume_.kernel = kernel_from_json(value);
                has_kernel = true;
            } else if (key == "channel") {
                volume_.channels.push_back({.name = value});
            } else if (key == "boundary_triangles") {
                std::from_chars(value.data(), value.data() + value.size(), triangles_beside_);
            }
        }
        if (!has_kernel && std::ranges::find(header_.elements, "face", &PlyElement::name) != header_.elements.end())
            refuse_surface(path_);
        if (!has_kernel) in_.fail("the header has no comment with the kernel", "write points with subvol");
        if (volume_.channels.empty()) volume_.channels.push_back({.name = "value"});
    }

    [[nodiscard]] Names wanted() const {
        Names names{"x", "y", "z", "cx", "cy", "cz"};
        names.insert(kFrame.begin(), kFrame.end());
        if (numbers_ != nullptr) names.insert(kNumber);
        for (std::size_t c = 0; c < volume_.channels.size(); ++c) {
            names.insert("value" + suffix_of(c));
            for (const char* name : kGradient) names.insert(name + suffix_of(c));
            for (const char* name : kMoment) names.insert(name + suffix_of(c));
            for (const char* name : kHessian) names.insert(name + suffix_of(c));
        }
        return names;
    }

    const std::vector<double>& column(const PlyTable& table, const PlyElement& element, const std::string& name) const {
        const auto found = table.find(name);
        if (found == table.end()) {
            in_.fail("element " + in_quotes(element.name) + " has no property " + in_quotes(name));
        }
        // A list, or a name that occurs twice, has another number of values.
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

    // One tuple for each row. Missing numbers are 0; if all are missing, there are no tuples.
    template <std::size_t N>
    [[nodiscard]] std::vector<std::array<float, N>> tuples(const PlyTable& table, const PlyElement& element,
                                                           const std::array<const char*, N>& names,
                                                           const std::string& suffix) const {
        std::vector<std::array<float, N>> tuples;
        for (std::size_t k = 0; k < N; ++k) {
            if (!table.contains(names[k] + suffix)) continue;
            const auto& values = column(table, element, names[k] + suffix);
            tuples.resize(values.size());
            for (std::size_t i = 0; i < values.size(); ++i) tuples[i][k] = static_cast<float>(values[i]);
        }
        return tuples;
    }

    void take_vertices(const PlyElement& element) {
        const PlyTable table = read_ply_element(in_, header_, element, wanted());
        volume_.centers = points(table, element, table.contains("cx") ? "c" : "");
        for (const char* name : kFrame) std::ignore = column(table, element, name);  // all are needed
        volume_.frames = tuples(table, element, kFrame, "");
        for (std::size_t c = 0; c < volume_.channels.size(); ++c) {
            take_channel(table, element, suffix_of(c), volume_.channels[c]);
        }
        if (numbers_ != nullptr) *numbers_ = column(table, element, kNumber);
    }

    // Missing gradients and moments are 0: a kernel then represents a constant.
    void take_channel(const PlyTable& table, const PlyElement& element, const std::string& suffix, RbfChannel& channel) const {
        for (const double value : column(table, element, "value" + suffix)) channel.values.push_back(static_cast<float>(value));
        channel.gradients = tuples(table, element, kGradient, suffix);
        channel.gradients.resize(element.count);
        for (const auto& moment : tuples(table, element, kMoment, suffix)) channel.moments.push_back(moment[0]);
        channel.moments.resize(element.count);
        channel.hessians = tuples(table, element, kHessian, suffix);
    }

    void take_boundary_points(const PlyTable& table, const PlyElement& element) {
        volume_.boundary.points = points(table, element, "");
    }

    void take_triangles(const PlyTable& table, const PlyElement& element) {
        const auto found = table.find("vertex_indices");
        if (found == table.end()) in_.fail("element \"boundary_triangle\" has no property \"vertex_indices\"");
        const auto& [corners, lengths] = found->second;
        const bool all_three = std::all_of(lengths.begin(), lengths.end(), [](std::size_t length) { return length == 3; });
        if (!all_three || corners.size() != 3 * element.count) in_.fail("a boundary triangle does not have 3 corners");
        volume_.boundary.triangles.resize(element.count);
        const std::size_t points = volume_.boundary.points.empty() ? kNone : volume_.boundary.points.size();
        for (std::size_t i = 0; i < corners.size(); ++i) {
            volume_.boundary.triangles[i / 3][i % 3] = ply_corner(in_, corners[i], points, "boundary triangle", i / 3);
        }
    }

    const std::filesystem::path& path_;
    std::string name_;
    TextScanner in_;
    std::vector<double>* numbers_;
    PlyHeader header_;
    RbfVolume volume_;
    std::size_t triangles_beside_ = 0;
};

}  // namespace

RbfVolume read_ply(std::string_view text, const std::filesystem::path& path, std::vector<double>* numbers) {
    return PlyReader(text, path, numbers).read();
}

}  // namespace subvol::detail
