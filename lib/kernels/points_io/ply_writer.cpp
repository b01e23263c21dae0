// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

#include "points_file.h"
#include "splat_gaussians.h"
#include "subvol/detail/knot_values.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/ply_rows.h"
#include "subvol/detail/surface_io.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/points_io.h"
#include "subvol/rbf_volume.h"
#include "subvol/transfer_function.h"

namespace subvol::detail {

namespace {

/// The properties of a Gaussian splat, in the order of `PlySplat`.
inline constexpr std::array<std::string_view, 11> kSplatProperties{"scale_0", "scale_1", "scale_2", "rot_0",  "rot_1", "rot_2",
                                                                   "rot_3",   "opacity", "f_dc_0",  "f_dc_1", "f_dc_2"};

using PlySplat = std::array<float, kSplatProperties.size()>;

/// The rotation that takes the axis to -y, which viewers of splats have at the top.
Mat3 turn_to_viewers(UpAxis up) {
    // By columns: where x, y and z go.
    if (up == UpAxis::X) return {Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 0, 1)};
    if (up == UpAxis::Y) return {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)};
    return {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, -1, 0)};
}

/// For each kernel the Gaussian that viewers of splats draw: the logarithms of its axes, its rotation as a quaternion w x y z,
/// the logit of its opacity and the constant term of its colour, both of the first channel.
///
/// turn: the rotation of the world into the viewers' space
std::vector<PlySplat> ply_splats(const RbfVolume& volume, const Mat3& turn) {
    std::vector<PlySplat> splats(volume.size());
    const std::vector<SplatGaussian> gaussians = viewer_gaussians(volume, turn);
    tbb::parallel_for(std::size_t{0}, splats.size(), [&](std::size_t i) {
        const SplatGaussian& gaussian = gaussians[i];
        PlySplat& splat = splats[i];
        for (std::size_t k = 0; k < 3; ++k) {
            splat[k] = static_cast<float>(std::log(gaussian.half_axes[k]));
            splat[8 + k] = static_cast<float>(gaussian.harmonic[k]);
        }
        for (std::size_t k = 0; k < 4; ++k) splat[3 + k] = static_cast<float>(gaussian.rotation[k]);
        splat[7] = static_cast<float>(std::log(gaussian.opacity / (1 - gaussian.opacity)));
    });
    return splats;
}

const char* const kBinary = std::endian::native == std::endian::little ? "binary_little_endian" : "binary_big_endian";

/// The vertices: the properties in the header and in the rows have the same order.
class VertexElement {
public:
    VertexElement(const RbfVolume& volume, const PointsWriteOptions& options)
        : volume_(volume), with_splats_(options.splats), turn_(turn_to_viewers(options.up)) {
        if (with_splats_) splats_ = ply_splats(volume, turn_);
    }

    [[nodiscard]] std::string header(std::uint64_t count) const {
        std::string text = "element vertex " + std::to_string(count) + "\n";
        const auto properties = [&](const char* type, const auto& names, const std::string& suffix = {}) {
            for (const auto name : names) text += std::string("property ") + type + " " + std::string(name) + suffix + "\n";
        };
        using List = std::initializer_list<const char*>;
        properties(with_splats_ ? "float" : "double", List{"x", "y", "z"});
        if (with_splats_) {
            properties("float", kSplatProperties);
            properties("double", List{"cx", "cy", "cz"});
        }
        for (std::size_t c = 0; c < volume_.channels.size(); ++c) {
            const std::string suffix = c == 0 ? "" : "_" + std::to_string(c);
            properties("float", List{"value", "gx", "gy", "gz", "moment"}, suffix);
            if (volume_.channels[c].hessians.empty()) continue;
            properties("float", List{"hxx", "hxy", "hxz", "hyy", "hyz", "hzz"}, suffix);
        }
        properties("float", List{"sxx", "sxy", "sxz", "syy", "syz", "szz"});
        return text;
    }

    /// numbers: none, or one that ends each row
    void write(NumberWriter& out, std::span<const std::uint64_t> numbers = {}) const {
        for (std::size_t i = 0; i < volume_.size(); ++i) {
            if (with_splats_) {
                out.put_point<float>(turn_ * volume_.centers[i]);
                out.put_all(splats_[i]);
            }
            out.put_point<double>(volume_.centers[i]);
            for (const RbfChannel& channel : volume_.channels) {
                out.put(channel.values[i]);
                out.put_all(channel.gradients[i]);
                out.put(channel.moments[i]);
                if (!channel.hessians.empty()) out.put_all(channel.hessians[i]);
            }
            out.put_all(volume_.frames[i]);
            if (!numbers.empty()) out.put(static_cast<double>(numbers[i]));
            out.end_row();
        }
    }

private:
    const RbfVolume& volume_;
    bool with_splats_;
    Mat3 turn_;
    std::vector<PlySplat> splats_;
};

std::string comments(const RbfVolume& volume, const Surface& boundary, const std::string& note) {
    std::string text = note.empty() ? "" : "comment" + (kNoteMark + without_controls(note)) + "\n";
    text +=
        "comment OpenSubVol points: with d = x - centre and e = d.inverse(S).d a point stands for value + g.d + moment*e\n"
        "comment + d.H.d/2, H being 0 where it is left out;\n"
        "comment the field is their mean inside the boundary, weighted by the kernel at (its support radius)*sqrt(e)\n"
        "comment kernel " +
        to_json(volume.kernel) + "\n";
    for (const RbfChannel& channel : volume.channels) {
        text += "comment channel " + without_controls(channel.name) + "\n";
    }
    return text + "comment boundary_triangles " + std::to_string(boundary.triangles.size()) + "\n";
}

std::string boundary_header(const Surface& boundary) {
    return "element boundary_vertex " + std::to_string(boundary.points.size()) +
           "\nproperty double x\nproperty double y\nproperty double z\nelement boundary_triangle " +
           std::to_string(boundary.triangles.size()) + "\nproperty list uchar uint vertex_indices\n";
}

void write_boundary(NumberWriter& out, const Surface& boundary) {
    for (const Vec3& p : boundary.points) {
        out.put_point<double>(p);
        out.end_row();
    }
    for (const auto& triangle : boundary.triangles) {
        out.put(std::uint8_t{3});
        for (const Index p : triangle) out.put(static_cast<std::uint32_t>(p));
        out.end_row();
    }
}

}  // namespace

void write_ply(const std::filesystem::path& path, const RbfVolume& volume, const PointsWriteOptions& options) {
    const VertexElement vertices(volume, options);
    OutputFile out(path);
    out.write(std::string("ply\nformat ") + (options.ascii ? "ascii" : kBinary) + " 1.0\n" +
              comments(volume, volume.boundary, options.note) + vertices.header(volume.size()) +
              (options.splats ? "" : boundary_header(volume.boundary)) + "end_header\n");
    NumberWriter numbers(out, options.ascii);
    vertices.write(numbers);
    if (!options.splats) write_boundary(numbers, volume.boundary);
    numbers.flush();
    out.close();
    if (options.splats) BoundaryFile(path, volume.boundary).commit();
    out.commit();
}

struct PlyRows::State {
    std::filesystem::path path;
    OutputFile out;
    std::uint64_t points;
    bool numbered;
    std::uint64_t first = 0, row = 0, written = 0;
};

PlyRows::PlyRows(const std::filesystem::path& path, const RbfVolume& like, std::uint64_t points, const Surface& boundary,
                 const std::string& note)
    : state_(new State{path, OutputFile(path), points, !note.empty()}) {
    const PointsWriteOptions options;
    const std::string number = state_->numbered ? std::string("property double ") + kNumber + "\n" : "";
    state_->out.write(std::string("ply\nformat ") + kBinary + " 1.0\n" + comments(like, boundary, note) +
                      VertexElement(like, options).header(points) + number + boundary_header(boundary) + "end_header\n");
    state_->first = state_->out.position();
}

PlyRows::~PlyRows() = default;

void PlyRows::write(std::span<const std::uint64_t> numbers, const RbfVolume& points) {
    if (numbers.empty()) return;
    if (!state_->numbered && numbers.back() >= state_->points) {
        throw Error(ErrorCode::InvalidInput,
                    "point " + std::to_string(numbers.back()) + " was found, there are " + std::to_string(state_->points),
                    state_->path.string());
    }
    NumberWriter rows;
    const VertexElement vertices(points, {});
    state_->numbered ? vertices.write(rows, numbers) : vertices.write(rows);
    const std::uint64_t row = rows.bytes().size() / numbers.size();
    assert(state_->row == 0 || state_->row == row);
    state_->row = row;
    if (state_->numbered) {
        state_->out.write(rows.bytes());
        state_->written += numbers.size();
        return;
    }
    for (std::size_t begin = 0, end = 0; begin < numbers.size(); begin = end) {
        for (end = begin + 1; end < numbers.size() && numbers[end] == numbers[begin] + (end - begin);) ++end;
        state_->out.write_at(state_->first + row * numbers[begin],
                             std::string_view(rows.bytes()).substr(row * begin, row * (end - begin)));
    }
    state_->written += numbers.size();
}

void PlyRows::finish(const Surface& boundary) {
    if (state_->written != state_->points) {
        throw Error(ErrorCode::InvalidInput,
                    std::to_string(state_->written) + " of " + std::to_string(state_->points) + " points were found",
                    state_->path.string());
    }
    if (!state_->numbered) state_->out.seek(state_->first + state_->row * state_->points);
    NumberWriter numbers(state_->out);
    write_boundary(numbers, boundary);
    numbers.flush();
    state_->out.commit();
}

}  // namespace subvol::detail
