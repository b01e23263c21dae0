// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "coverage.h"
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

class EdgeDrawer {
public:
    EdgeDrawer(Image& image, std::span<const float> depth, const View& view, const LineOptions& options)
        : image_(image), depth_(depth), view_(view), options_(options) {}

    void draw(const Vec3& from, const Vec3& to, bool faces_eye) {
        Vec3 a = view_.to_eye(from), b = view_.to_eye(to);
        // What is behind the eye is cut off.
        const double near = view_.perspective() ? 1e-6 * (std::abs(a.z) + std::abs(b.z)) : 0;
        if (a.z <= near && b.z <= near) return;
        if (a.z < near) a = b + (a - b) * ((b.z - near) / (b.z - a.z));
        if (b.z < near) b = a + (b - a) * ((a.z - near) / (a.z - b.z));
        const double slack = kOnSurface * glm::length(b - a);
        const auto take = [&](int x, int y, double cover, double t) {
            const double z = view_.perspective() ? 1 / ((1 - t) / a.z + t / b.z) : (1 - t) * a.z + t * b.z;
            const bool seen =
                faces_eye && z - slack <= static_cast<double>(depth_about(depth_, image_.width, image_.height, x, y));
            (seen ? put_over : put_under)(image_, x, y, options_.color, options_.alpha * cover);
        };
        for_each_pixel_of_line(image_, view_.to_pixels(a), view_.to_pixels(b), options_.width_px, take);
    }

private:
    Image& image_;
    std::span<const float> depth_;
    const View& view_;
    const LineOptions& options_;
};

}  // namespace

namespace {

void check_sizes(const Image& image, std::span<const float> depth, const View& view) {
    if (depth.size() != image.rgba.size() / 4 || view.width() != image.width || view.height() != image.height)
        throw Error(ErrorCode::InvalidInput, "the picture, its depths and the view are not of one size", "edges");
}

}  // namespace

void draw_edges(Image& image, std::span<const float> depth, const View& view, const Shells& shells,
                const LineOptions& options) {
    check_sizes(image, depth, view);
    std::vector<std::array<Index, 2>> edges;
    const auto add = [&](Index a, Index b) { edges.push_back({std::min(a, b), std::max(a, b)}); };
    for (const auto& quad : shells.quads) {
        for (std::size_t k = 0; k < 4; ++k) add(quad[k], quad[(k + 1) % 4]);
    }
    for (const auto& [a, b] : shells.lines) add(a, b);
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    EdgeDrawer drawer(image, depth, view, options);
    for (const auto& [a, b] : edges) drawer.draw(shells.points[a], shells.points[b], true);
}

void draw_edges(Image& image, std::span<const float> depth, const View& view, const HexMesh& mesh, const LineOptions& options) {
    check_sizes(image, depth, view);
    const Topology topology = build_topology(mesh);
    EdgeDrawer drawer(image, depth, view, options);
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

}  // namespace subvol
