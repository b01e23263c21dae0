// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "subvol/camera.h"
#include "subvol/gl_device.h"
#include "subvol/hex_mesh.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"

namespace subvol {

/// How tetrahedra come into their order. Centroid: by eye depth, which is not always right. Topological: what is behind a
/// shared face comes first, and the farther centroid where no face decides; right for every convex mesh without a cycle. Lists:
/// every pixel sorts its own segments, which is always right, and takes memory. Havs: faces by the depth of their centroids,
/// and what each pixel meets of them once more in a k-buffer; right where no face is late by more than its entries. What is
/// between the parts of a volume that is not convex stays empty in every order.
enum class ProjectedOrder { Centroid, Topological, Lists, Havs };

/// device:           of OpenGL, its number in gl_devices(); none: the first hardware, else software. A ProjectedRenderer keeps
/// its own kbuffer:          Havs: entries of the k-buffer, 1..65536 lod:              Havs: the fraction of the faces inside
/// that is drawn, 0..1; the boundary's always are samples:          n × n pictures, moved by parts of a pixel, of which the
/// mean is taken, 1..16 count_violations: draws a second time with lists, to find where the order is wrong. Lists are compared
/// with the order by
///                   centroids; Havs counts without it
/// list_bytes:       the most memory of lists, those of Havs too; what needs more is drawn in parts of the picture
struct ProjectedOptions {
    ProjectedOrder order = ProjectedOrder::Topological;
    std::optional<int> device{};
    int kbuffer = 6;
    double lod = 1;
    int samples = 1;
    bool count_violations = false;
    std::size_t list_bytes = std::size_t{1} << 28;
    Progress* progress = nullptr;
};

struct ProjectedReport {
    std::string device;
    std::size_t tets = 0;
    std::size_t degenerate_tets = 0;  // of zero volume: not drawn
    std::size_t inverted_tets = 0;    // where they lie over others both count; lists and Havs count every depth once
    std::size_t cycles = 0;           // times that a topological order did not go on and the farthest centroid was taken
    std::size_t faces = 0;            // shared ones once, where there was Havs
    std::size_t faces_drawn = 0;
    std::size_t fragments = 0;                // pairs of a pixel and a tetrahedron, or a face, where there were lists
    std::size_t parts = 0;                    // of the picture, that lists were made for one after the other
    std::size_t late_faces = 0;               // fragments of Havs that came when the k-buffer had let go what is behind them
    std::optional<std::size_t> violations{};  // pixels (of all samples) with a segment drawn before one that is behind it
    double seconds_build = 0;                 // of the renderer, the same in all its pictures
    double seconds_prepare = 0, seconds_sort = 0, seconds_draw = 0;
};

struct ProjectedResult {
    Image image;
    ProjectedReport report;
};

/// Projected tetrahedra: the same 6 tetrahedra a cell as render_tets, their silhouettes drawn by OpenGL over each other, from
/// back to front. Each pixel cuts its ray with the planes of the faces and integrates the segment exactly, with the value
/// linear in the tetrahedron. With Havs the faces are drawn instead, and segments are between neighbours of a pixel's faces.
///
/// Keeps the tetrahedra, on the device too, from picture to picture; the mesh need not stay. Pictures are bitwise the
/// same every time. One picture at a time.
/// cost:   16 bytes a point and 20 a tetrahedron on the device, Havs: 20 a face; lists: 20 bytes a fragment, Havs: 12, up to
///         list_bytes
/// source: docs/science.md (st1990; mhc1990 for the topological order; cics2005 for Havs, ccss2005 for its faces left out)
class ProjectedRenderer {
public:
    /// field:  the attribute that is shown, as in scalar_field
    /// throws: Error(InvalidInput) as validate(mesh) and scalar_field;
    ///         Error(MissingCapability) if there is no OpenGL 4.5, or it has no room
    explicit ProjectedRenderer(const HexMesh& mesh, std::string_view field = {}, std::optional<int> device = {},
                               Progress* progress = nullptr);
    ~ProjectedRenderer();
    ProjectedRenderer(ProjectedRenderer&&) noexcept;
    ProjectedRenderer& operator=(ProjectedRenderer&&) noexcept;

    /// throws: Error(InvalidInput) if an option is out of range, or values and extinctions are beyond 32-bit floats
    [[nodiscard]] ProjectedResult draw(const View& view, const Optics& optics, const ProjectedOptions& options = {});
    [[nodiscard]] double seconds_build() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// One picture of a ProjectedRenderer.
[[nodiscard]] ProjectedResult render_projected(const HexMesh& mesh, std::string_view field, const View& view,
                                               const Optics& optics, const ProjectedOptions& options = {});

}  // namespace subvol
