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

/// isos:          values of the field whose isosurfaces are wanted
/// boundary:      also the boundary of the volume
/// cap:           each isosurface becomes the closed surface of the part where the field is at least its value: the boundary
///                of the volume closes it
/// tolerance:     how far triangles may lie from the limit, as a part of the longest side of the box; > 0
/// max_level:     cells are refined no further, 1 to 8
/// max_triangles: the search for a finer level ends before there would be more
/// sides:         those of cells to which the boundary is restricted, as of a patch; empty: the whole boundary. Isosurfaces are
///                left out then, and triangles are not improved
/// cells:         a flag for each cell of a mesh in memory: the boundary of these is made, where they lie in the limit of the
///                whole mesh. Isosurfaces are those of these cells as a mesh of its own. Empty: all
/// improve:       edges of triangles with small angles are collapsed or flipped, so that fewer of them are slivers
struct SurfaceOptions {
    SchemeOptions scheme{};
    std::vector<double> isos{};
    bool boundary = false;
    bool cap = false;
    double tolerance = 1e-3;
    int max_level = 6;
    std::size_t max_triangles = 40'000'000;
    std::span<const CellSide> sides{};
    std::span<const std::uint8_t> cells{};
    bool improve = true;
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(SurfaceOptions& options);

/// level:           of the refinement whose cells were cut
/// deviation_world: the estimated largest distance of triangles from the limit
/// converged:       the deviation is within the tolerance
/// cells:           control cells that were refined
/// area, volume:    of the surface; the volume is that which it encloses, if it is watertight
/// watertight:      every edge has two triangles, which run along it in opposite directions
/// euler:           points − edges + triangles
/// components:      parts that are not joined
/// min_angle_deg:   the least angle of a triangle; small_angles: the part of triangles with one below 10°
/// mended:          edges collapsed or flipped
struct SurfaceReport {
    int level = 0;
    double deviation_world = 0;
    bool converged = false;
    std::size_t cells = 0;
    double area = 0, volume = 0;
    bool watertight = false;
    long euler = 0;
    std::size_t components = 0;
    double min_angle_deg = 0, small_angles = 0;
    std::size_t mended = 0;
};

/// Triangles on the limit, counter-clockwise seen from where the field is below the isovalue, or from outside the volume.
///
/// normals: one for each point, to the same side: from the exact gradient of the field, or the exact Jacobian at the boundary.
///          On creases of the boundary, and where a cap meets its isosurface, the mean of those of its sides
/// places:  of the points in the limit
/// fields:  all attributes of the mesh at the points, with their gradients
struct LimitSurface {
    Surface surface;
    std::vector<Vec3> normals;
    std::vector<LimitQuery> places;
    std::vector<ProbedField> fields;
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
///
/// color:    an index into fields: points get colours by the function (.ply, .glb, .obj), or its values first (.vtp)
/// function: of the colours
/// origin:   points are written relative to it: the 32-bit floats of .stl keep 7 digits, too few for map coordinates
struct SurfaceFileOptions {
    std::optional<std::size_t> color{};
    TransferFunction function{};
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
