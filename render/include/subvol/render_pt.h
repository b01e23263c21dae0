#pragma once

#include <optional>
#include <span>
#include <string>

#include "subvol/camera.h"
#include "subvol/hex_mesh.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"

namespace subvol {

/// How tetrahedra come into their order. Centroid: by eye depth, which is not always right. Topological: what is behind a
/// shared face comes first, and the farther centroid where no face decides; right for every convex mesh without a cycle. Lists:
/// every pixel sorts its own segments, which is always right, and takes memory.
enum class PtOrder { Centroid, Topological, Lists };

/// device:           of OpenGL, its number in gl_devices(); none: the first hardware, else software
/// count_violations: draws a second time with lists, to find where the order is wrong. Lists are compared with the order by
///                   centroids
/// list_bytes:       the most memory of lists; what needs more is drawn in parts of the picture
struct PtOptions {
    PtOrder order = PtOrder::Topological;
    std::optional<int> device{};
    bool count_violations = false;
    std::size_t list_bytes = std::size_t{1} << 28;
    Progress* progress = nullptr;
};

struct PtReport {
    std::string device;
    std::size_t tets = 0;
    std::size_t degenerate_tets = 0;  // of zero volume: not drawn
    std::size_t inverted_tets = 0;    // where they lie over others both count; lists count every depth once
    std::size_t cycles = 0;           // times that a topological order did not go on and the farthest centroid was taken
    std::size_t fragments = 0;        // pairs of a pixel and a tetrahedron, where there were lists
    std::size_t parts = 0;            // of the picture, that lists were made for one after the other
    std::optional<std::size_t> violations{};  // pixels with a segment drawn before one that is behind it
    double seconds_build = 0, seconds_sort = 0, seconds_draw = 0;
};

struct PtResult {
    Image image;
    PtReport report;
};

/// Projected tetrahedra: the same 6 tetrahedra a cell as render_tets, their silhouettes drawn by OpenGL over each other, from
/// back to front. Each pixel cuts its ray with the planes of the faces and integrates the segment exactly, with the value
/// linear in the tetrahedron. Pictures are bitwise the same every time.
///
/// scalar: one value a point of the mesh
/// throws: Error(InvalidInput) if scalar.size() != mesh.points.size(), or values and extinctions are beyond 32-bit floats;
///         Error(MissingCapability) if there is no OpenGL 4.5, or it has no room
/// cost:   16 bytes a point and 20 a tetrahedron on the device; lists: 20 bytes a fragment, up to list_bytes
/// source: docs/science.md (ST90; max1990 for the topological order)
[[nodiscard]] PtResult render_projected_tets(const HexMesh& mesh, std::span<const double> scalar, const View& view,
                                             const Optics& optics, const PtOptions& options = {});

}  // namespace subvol
