// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "subvol/detail/coverage.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/error.h"
#include "subvol/overlay.h"
#include "subvol/raster.h"
#include "subvol/topology.h"

namespace subvol {

using namespace detail;
namespace {

constexpr double kOnSurface = 0.1;  // of an edge's length: how far the limit may be from it

/// The largest depth about a pixel: a surface seen from aside changes its depth within the width of a line.
float depth_about(std::span<const float> depth, int width, int height, int x, int y) {
    float most = 0;
    for (int j = std::max(0, y - 1); j <= std::min(height - 1, y + 1); ++j) {
        for (int i = std::max(0, x - 1); i <= std::min(width - 1, x + 1); ++i)
            most = std::max(most, depth[pixel_index(width, i, j)]);
    }
    return most;
}

/// Whether a face of the hull, whose cell lies behind it, shows its outside to the eye.
bool faces_eye(const HexMesh& mesh, const Topology& topology, const View& view, Index face) {
    Vec3 inside(0.0);
    for (const Index corner : mesh.cells[topology.face_cells[face][0]]) inside += mesh.points[corner] / 8.0;
    const auto& f = topology.faces[face];
    const Vec3 &a = mesh.points[f[0]], &b = mesh.points[f[1]], &c = mesh.points[f[2]], &d = mesh.points[f[3]];
    const Vec3 middle = 0.25 * (a + b + c + d), normal = glm::cross(c - a, d - b);
    const Vec3 to_eye = view.perspective() ? view.eye() - middle : -view.axes()[2];
    return glm::dot(normal, middle - inside) * glm::dot(normal, to_eye) > 0;
}

/// The pixels of lines, each given to take(x, y, sample).
template <class Take>
class EdgeLines {
public:
    EdgeLines(const View& view, const LineOptions& options, std::span<const CutPlane> faces, const Take& take)
        : view_(view), options_(options), faces_(faces), take_(take) {}

    /// Gives what the faces of the clip leave of a line. on: the face that it lies on, which does not cut it; null: none
    void draw(Vec3 from, Vec3 to, bool faces_eye, const CutPlane* on = nullptr) {
        for (const CutPlane& face : faces_) {
            if (&face == on) continue;
            const double a = glm::dot(face.normal, from - face.point), b = glm::dot(face.normal, to - face.point);
            if (a > 0 && b > 0) return;
            const Vec3 between = from + (a / (a - b)) * (to - from);
            if (a > 0) from = between;
            if (b > 0) to = between;
        }
        draw_whole(from, to, faces_eye);
    }

private:
    void draw_whole(const Vec3& from, const Vec3& to, bool faces_eye) {
        Vec3 a = view_.to_eye(from), b = view_.to_eye(to);
        // What is behind the eye is cut off.
        const double near = view_.perspective() ? 1e-6 * (std::abs(a.z) + std::abs(b.z)) : 0;
        if (a.z <= near && b.z <= near) return;
        if (a.z < near) a = b + (a - b) * ((b.z - near) / (b.z - a.z));
        if (b.z < near) b = a + (b - a) * ((a.z - near) / (a.z - b.z));
        const double slack = kOnSurface * glm::length(b - a);
        const auto take = [&](int x, int y, double cover, double t) {
            const double z = view_.perspective() ? 1 / ((1 - t) / a.z + t / b.z) : (1 - t) * a.z + t * b.z;
            take_(x, y,
                  LineSample{static_cast<std::uint32_t>(pixel_index(view_.width(), x, y)), faces_eye, static_cast<float>(z),
                             static_cast<float>(slack), static_cast<float>(options_.alpha * cover)});
        };
        for_each_pixel_of_line(view_.width(), view_.height(), view_.to_pixels(a), view_.to_pixels(b), options_.width_px, take);
    }

    const View& view_;
    const LineOptions& options_;
    std::span<const CutPlane> faces_;
    const Take& take_;
};

/// Draws where a plane cuts the faces of cells: two crossings of a face's sides are an end each; a bent face may have four.
template <class Lines>
void draw_cut(Lines& drawer, const HexMesh& mesh, const Topology& topology, const CutPlane& plane, bool faces_eye,
              const CutPlane* on) {
    std::vector<double> heights(mesh.points.size());
    for (std::size_t p = 0; p < heights.size(); ++p) heights[p] = glm::dot(plane.normal, mesh.points[p] - plane.point);
    for (const auto& face : topology.faces) {
        std::array<Vec3, 4> crossings;
        std::size_t count = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const Index i = face[k], j = face[(k + 1) % 4];
            if ((heights[i] > 0) == (heights[j] > 0)) continue;
            const double t = heights[i] / (heights[i] - heights[j]);
            crossings[count++] = mesh.points[i] + t * (mesh.points[j] - mesh.points[i]);
        }
        for (std::size_t k = 0; k + 1 < count; k += 2) drawer.draw(crossings[k], crossings[k + 1], faces_eye, on);
    }
}

/// Whether a face of the clip, whose normal points to what is removed, is seen.
bool is_seen(const CutPlane& face, const View& view) {
    const Vec3 to_eye = view.perspective() ? view.eye() - face.point : -view.axes()[2];
    return glm::dot(face.normal, to_eye) > 0;
}

void check_sizes(const Image& image, std::span<const float> depth, const View& view) {
    if (depth.size() != image.rgba.size() / 4 || view.width() != image.width || view.height() != image.height)
        throw Error(ErrorCode::InvalidInput, "the picture, its depths and the view are not of one size", "edges");
}

template <class Take>
void each_edge_pixel(const View& view, const Shells& shells, const LineOptions& options, const Clip& clip, const Take& take) {
    std::vector<std::array<Index, 2>> edges;
    const auto add = [&](Index a, Index b) { edges.push_back({std::min(a, b), std::max(a, b)}); };
    for (const auto& quad : shells.quads) {
        for (std::size_t k = 0; k < 4; ++k) add(quad[k], quad[(k + 1) % 4]);
    }
    for (const auto& [a, b] : shells.lines) add(a, b);
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    Box box;
    for (const Vec3& p : shells.points) box.add(p);
    const RayClip cuts(clip, box.diagonal());
    EdgeLines drawer(view, options, cuts.faces(), take);
    for (const auto& [a, b] : edges) drawer.draw(shells.points[a], shells.points[b], true);
}

template <class Take>
void each_edge_pixel(const View& view, const HexMesh& mesh, const LineOptions& options, const Clip& clip, const Take& take) {
    const Topology topology = build_topology(mesh);
    const RayClip cuts(clip, bounds(mesh).diagonal());
    EdgeLines drawer(view, options, cuts.faces(), take);
    for (const CutPlane& slice : cuts.slices()) draw_cut(drawer, mesh, topology, slice, true, nullptr);
    if (cuts.slices_alone()) return;
    for (const CutPlane& face : cuts.faces()) draw_cut(drawer, mesh, topology, face, is_seen(face, view), &face);
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        bool on_hull = false, seen = false;
        for (const Index face : topology.edge_faces[e]) {
            if (!topology.face_on_hull(face)) continue;
            on_hull = true;
            seen = seen || faces_eye(mesh, topology, view, face);
        }
        const auto& [a, b] = topology.edges[e];
        if (on_hull) drawer.draw(mesh.points[a], mesh.points[b], seen);
    }
}

/// Lines one over the other, each before what the picture shows or behind it.
template <class Lines>
void draw_lines_of(Image& image, std::span<const float> depth, const View& view, const Lines& lines, const LineOptions& options,
                   const Clip& clip) {
    check_sizes(image, depth, view);
    each_edge_pixel(view, lines, options, clip, [&](int x, int y, const LineSample& line) {
        const bool seen = line.faces_eye && double{line.depth} - double{line.slack} <=
                                                static_cast<double>(depth_about(depth, image.width, image.height, x, y));
        (seen ? put_over : put_under)(image, x, y, options.color, double{line.cover});
    });
}

template <class Lines>
std::vector<LineSample> samples_of(const View& view, const Lines& lines, const LineOptions& options, const Clip& clip) {
    std::vector<LineSample> samples;
    each_edge_pixel(view, lines, options, clip, [&](int, int, const LineSample& line) { samples.push_back(line); });
    return samples;
}

}  // namespace

LineOptions edge_style(const View& view, const Vec3& ink) {
    return {.width_px = std::max(1.0, std::min(view.width(), view.height()) / 512.0), .color = ink, .alpha = 0.6};
}

void draw_edges(Image& image, std::span<const float> depth, const View& view, const Shells& shells, const LineOptions& options,
                const Clip& clip) {
    draw_lines_of(image, depth, view, shells, options, clip);
}

void draw_edges(Image& image, std::span<const float> depth, const View& view, const HexMesh& mesh, const LineOptions& options,
                const Clip& clip) {
    draw_lines_of(image, depth, view, mesh, options, clip);
}

std::vector<LineSample> edge_samples(const View& view, const HexMesh& mesh, const LineOptions& options, const Clip& clip) {
    return samples_of(view, mesh, options, clip);
}

std::vector<LineSample> edge_samples(const View& view, const Shells& shells, const LineOptions& options, const Clip& clip) {
    return samples_of(view, shells, options, clip);
}

}  // namespace subvol
