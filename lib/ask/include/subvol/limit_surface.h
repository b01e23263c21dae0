// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/limit.h"
#include "subvol/mesh_sets.h"
#include "subvol/mesh_source.h"
#include "subvol/option_names.h"
#include "subvol/probe.h"
#include "subvol/surface.h"
#include "subvol/transfer_function.h"

namespace subvol {

struct SurfaceOptions {
    SchemeOptions scheme{};
    std::vector<double> isos{};  ///< values of the field whose isosurfaces are wanted
    bool boundary = false;       ///< also the boundary of the volume
    /// Each isosurface becomes the closed surface of the part where the field is at least its value: the boundary of the volume
    /// closes it
    bool cap = false;
    double tolerance = 1e-3;  ///< how far triangles may lie from the limit, as a part of the longest side of the box; > 0
    int max_level = 6;        ///< cells are refined no further, 1 to 8
    std::size_t max_triangles = 40'000'000;  ///< the search for a finer level ends before there would be more
    /// Sides of cells to which the boundary is restricted, as of a patch; empty: the whole boundary. Isosurfaces are left out
    /// then, and triangles are not improved
    std::span<const CellSide> sides{};
    /// A flag for each cell of a mesh in memory: the boundary of these is made, where they lie in the limit of the whole mesh.
    /// Isosurfaces are those of these cells as a mesh of its own. Empty: all
    std::span<const std::uint8_t> cells{};
    bool improve = true;  ///< edges of triangles with small angles are collapsed or flipped, so that fewer of them are slivers
    bool fields = true;   ///< the fields are evaluated at the points, which takes most of the time for a boundary
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(SurfaceOptions& options);

struct SurfaceReport {
    int level = 0;               ///< level of the refinement whose cells were cut; of a boundary alone the finest one
    double deviation_world = 0;  ///< the estimated largest distance of triangles from the limit
    bool converged = false;      ///< the deviation is within the tolerance
    std::size_t cells = 0;       ///< control cells that were refined
    double area = 0;             ///< area of the surface
    double volume = 0;           ///< volume that the surface encloses, if it is watertight
    bool watertight = false;     ///< every edge has two triangles, which run along it in opposite directions
    long euler = 0;              ///< points − edges + triangles
    std::size_t components = 0;  ///< parts that are not joined
    double min_angle_deg = 0;    ///< least angle of a triangle
    double small_angles = 0;     ///< part of the triangles with an angle below 10°
    std::size_t mended = 0;      ///< edges collapsed or flipped
};

/// Triangles on the limit, counter-clockwise seen from where the field is below the isovalue, or from outside the volume.
struct LimitSurface {
    Surface surface;
    /// One for each point, to the same side: from the exact gradient of the field, or the exact Jacobian at the boundary; of
    /// the boundary alone from the vertices about the point. On creases of the boundary, and where a cap meets its isosurface,
    /// the mean of those of its sides
    std::vector<Vec3> normals;
    std::vector<LimitQuery> places;   ///< places of the points in the limit
    std::vector<ProbedField> fields;  ///< all attributes of the mesh at the points, with their gradients; none if not asked for
    SurfaceReport report;
};

/// Isosurfaces of a field of the limit, and the boundary.
///
/// The control cells that a surface passes through are refined, all to the same level, and each of their children is cut into
/// six tetrahedra, which fit together from cell to cell: a surface between the signs of their corners is closed (but for the
/// volume's boundary) and manifold, whatever the mesh. Its points are then moved along the edges of the tetrahedra on to the
/// limit, by Newton's method. The level is raised until the triangles are within tolerance; of more than 2048 cells some stand
/// for all.
///
/// The boundary alone, of a scheme that interpolates, is refined without its cells, each face only where the limit bends, and
/// to level 2 where fields that are wanted bend by more than four tolerances of their range; its normals are those of the
/// vertices about each point.
///
/// The pieces of a mesh that is not in memory are searched for cells that a surface may pass through; these are then gathered
/// with their halos, and the surface is cut from them alone: with the same bits. The places of the result have the cells'
/// numbers in the whole mesh; kNone if an Index cannot hold them.
///
/// field:  name of an attribute with one channel; empty: the first
/// throws: Error(InvalidInput) as `evaluate_limit` and `scalar_field`, if neither an isovalue nor the boundary is asked for, if
///         an option is out of range, or if pieces have fewer than three layers of halo; what reading throws; Error(Cancelled)
/// cost:   parallel; the same bits for any number of threads. Memory: some 300 bytes for each triangle, and the topology of the
///         mesh; of a mesh in pieces that of one piece, then some 2 kB for each cell that the surface passes
[[nodiscard]] LimitSurface limit_surface(const MeshSource& source, std::string_view field, const SurfaceOptions& options);

/// What else a file of a surface holds.
struct SurfaceFileOptions {
    /// An index into fields: points get colours by the function (.ply, .glb, .obj), or its values first (.vtp)
    std::optional<std::size_t> color{};
    TransferFunction function{};  ///< function of the colours
    /// Points are written relative to it: the 32-bit floats of .stl keep 7 digits, too few for map coordinates
    Vec3 origin{0.0};
};

/// How many triangles lose a side or more if their corners, relative to an origin, are rounded to 32-bit floats.
[[nodiscard]] std::size_t collapsed_by_floats(const Surface& surface, const Vec3& origin);

/// Writes a surface; the extension decides: .ply (binary, with normals, fields and colours), .stl (binary), .vtp (normals and
/// fields), .obj (normals, colours), .glb (normals, colours; the unit is taken to be that of glTF, and z stays up by a
/// rotation).
///
/// throws: Error(InvalidInput) for an unknown extension or a surface without triangles, Error(Io)
void write_limit_surface(const std::filesystem::path& path, const LimitSurface& surface,
                         const SurfaceFileOptions& options = {});

}  // namespace subvol
