// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/gl_device.h"
#include "subvol/hex_mesh.h"
#include "subvol/image.h"
#include "subvol/mixed_mesh.h"
#include "subvol/names.h"
#include "subvol/optics.h"
#include "subvol/progress.h"

namespace subvol {

/// The order in which tetrahedra are composited.
///
/// Centroid:    by the eye depth of their centroids, which is not always right
/// Topological: what lies behind a shared face comes first, and the farther centroid where no face decides; right for every
///              convex mesh without cycles
/// Lists:       every pixel sorts its own segments; always right, but takes memory
/// Havs:        faces by the depth of their centroids, then sorted again in a k-buffer for each pixel; right unless a face
///              comes later than the k-buffer has entries
///
/// Gaps between the parts of a volume that is not convex stay empty in every order.
enum class ProjectedOrder { Centroid, Topological, Lists, Havs };

template <>
struct NameTable<ProjectedOrder> {
    static constexpr Name<ProjectedOrder> rows[] = {
        {ProjectedOrder::Topological, "topological", "by shared faces"},
        {ProjectedOrder::Centroid, "centroid"},
        {ProjectedOrder::Lists, "lists", "one per pixel"},
        {ProjectedOrder::Havs, "havs", "faces by centroid, then a k-buffer per pixel"}};
};

struct ProjectedOptions {
    ProjectedOrder order = ProjectedOrder::Topological;
    /// The OpenGL device's number in gl_devices(); none: the first hardware, else software. A ProjectedRenderer keeps the
    /// device that it was made for.
    std::optional<int> device{};
    int kbuffer = 6;  ///< Havs: entries of the k-buffer, 1..65536
    double lod = 1;   ///< Havs: the fraction of the inner faces that is drawn, 0..1; those of the boundary always are
    int samples = 1;  ///< the mean of n × n pictures, moved by parts of a pixel, is taken, 1..16
    /// Draws a second time with lists, to find where the order is wrong. Lists compare themselves with the order by centroids;
    /// Havs counts without a second picture.
    bool count_violations = false;
    Clip clip{};  ///< how the volume is cut open
    /// The most memory of lists, those of Havs too; a picture that needs more is drawn in parts.
    std::size_t list_bytes = std::size_t{1} << 28;
    Progress* progress = nullptr;
};

struct ProjectedReport {
    std::string device;
    std::size_t tets = 0;
    std::size_t degenerate_tets = 0;  // of zero volume: not drawn
    std::size_t inverted_tets = 0;    // where they overlap others, both are drawn; Lists and Havs count every depth once
    std::size_t cycles = 0;           // how often the topological order was stuck and the farthest centroid was taken
    std::size_t faces = 0;            // with Havs; shared ones once
    std::size_t faces_drawn = 0;
    std::size_t fragments = 0;                // with lists: pairs of a pixel and a tetrahedron or a face
    std::size_t parts = 0;                    // of the picture, which were drawn one after the other for the memory of lists
    std::size_t late_faces = 0;               // with Havs: fragments that came after the k-buffer had released one behind them
    std::optional<std::size_t> violations{};  // pixels (of all samples) with a segment drawn before one that is behind it
    double seconds_build = 0;                 // of the renderer, the same for all its pictures
    double seconds_prepare = 0, seconds_sort = 0, seconds_draw = 0;
};

struct ProjectedResult {
    Image image;
    ProjectedReport report;
};

/// Projected tetrahedra: OpenGL draws the silhouettes of the same 6 tetrahedra for each cell as render_tets over each other,
/// from back to front. In each pixel the ray is cut by the faces, and the segment is integrated exactly, with the value linear
/// in the tetrahedron. With Havs the faces are drawn instead, and the segments lie between consecutive faces of a pixel.
///
/// Keeps the tetrahedra, on the device too, from picture to picture; the mesh is not needed any more. Pictures are bitwise
/// reproducible. Not for several threads at once.
/// cost:   on the device 16 bytes for each point and 20 for each tetrahedron (Havs: 20 for each face); lists: 20 bytes for each
///         fragment (Havs: 12), up to list_bytes
/// source: docs/science.md (st1990; mhc1990 for the topological order; cics2005 for Havs, ccss2005 for its lod)
class ProjectedRenderer {
public:
    /// field:  the attribute that is shown, as in scalar_field
    /// throws: Error(InvalidInput) as validate(mesh) and scalar_field;
    ///         Error(MissingCapability) if there is no OpenGL 4.5, or the device has no room
    explicit ProjectedRenderer(const HexMesh& mesh, std::string_view field = {}, std::optional<int> device = {},
                               Progress* progress = nullptr);
    /// Tetrahedra as they are; all other cells are cut into tetrahedra (`in_tetrahedra`).
    explicit ProjectedRenderer(const MixedMesh& mesh, std::string_view field = {}, std::optional<int> device = {},
                               Progress* progress = nullptr);
    ~ProjectedRenderer();
    ProjectedRenderer(ProjectedRenderer&&) noexcept;
    ProjectedRenderer& operator=(ProjectedRenderer&&) noexcept;

    /// throws: Error(InvalidInput) if an option is out of range, or values or extinctions are beyond 32-bit floats;
    ///         Error(MissingCapability) if the device has no room
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
