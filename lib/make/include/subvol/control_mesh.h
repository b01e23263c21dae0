// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/fit_shape.h"
#include "subvol/label_grid.h"
#include "subvol/mesh_sets.h"

namespace subvol {

struct ControlMeshOptions {
    SchemeOptions scheme{};             ///< as in `FitShapeOptions`, without an angle of creases
    int cells = 24;                     ///< cells along the longest side of the surface's box
    std::size_t max_cells = 2'000'000;  ///< the most cells that may be made
    /// Searches for nearest places; distances count 1.5 times as much in each. Up to 20 more where cells stay flat or fold
    int rounds = 15;
    /// How often cubes may be divided into 27, where the boundary or a sharp edge is not met within `tolerance`
    int refine = 0;
    double tolerance = 0.25;      ///< a distance that is near enough, as a part of the side of a cube that is not divided
    double sharp_angle_deg = 40;  ///< edges of the surface that are bent by more become creases of the mesh; 180: none
    ShapeFolds folds{};           ///< as in `FitShapeOptions`
    OptionNames names = OptionNames::Keywords;  ///< as in `FitShapeOptions`
    Progress* progress = nullptr;               ///< as in `FitShapeOptions`
};

/// The options without those of the scheme.
[[nodiscard]] std::vector<Option> options_of(ControlMeshOptions& options);

/// The sharp edges of a surface, as chains, and the creases of a mesh that follow them.
struct SharpEdgeReport {
    std::size_t corners = 0;         ///< where chains meet, end or turn sharply
    std::size_t missed_corners = 0;  ///< those at which no crease ends or turns
    std::size_t curves = 0;
    std::size_t missed = 0;  ///< chains without creases, as others are too near or the mesh does not reach them
    double length_world = 0, missed_length_world = 0;
    std::size_t creases = 0;
    double rms = 0, max = 0;  ///< distances of the creases from the chains
};

/// What a surface of triangles encloses, and what is odd about it.
struct EnclosureReport {
    std::size_t walls = 0;           ///< closed parts of the surface that are not joined by edges
    std::size_t united = 0;          ///< walls that cross others before them; the mesh is that of their union
    std::size_t cavities = 0;        ///< walls within another wall that bound a cavity
    std::size_t cavities_alike = 0;  ///< cavities with the orientation of the wall around them
    std::size_t copies = 0;          ///< triangles that are there twice, which are left out
    std::size_t sheets = 0;          ///< triangles of sheets that enclose nothing, which are left out
    std::size_t turned = 0;          ///< triangles with another orientation than most of those that they are joined with
    std::size_t one_sided = 0;       ///< edges at which no orientation of the triangles agrees
    std::size_t many_edges = 0;      ///< edges of more than two triangles
};

/// Parts of a body that are thinner than 1.5 sides of a cell.
struct ThinParts {
    double part = 0;             ///< of the surface's area that bounds them
    double thickness_world = 0;  ///< nine tenths of this area bound parts as thick as this or thicker
    Vec3 at{0.0};                ///< where they are about so thick
};

/// A surface, and the name of the material that it encloses.
struct MaterialSurface {
    std::string name;
    Surface surface;
};

struct MaterialReport {
    std::string name;
    std::size_t cells = 0;
    double volume_world = 0;  ///< what the limit of its cells fills
    /// What its surface encloses without the materials within; nothing where the surface is open or crosses a smaller one
    std::optional<double> enclosed_world{};
};

struct ControlMeshReport {
    FitShapeReport shape;  ///< how far the limit's boundary is from the surface; `before`: as cubes with a layer around them
    SharpEdgeReport sharp;
    EnclosureReport surface;                  ///< of all surfaces
    std::vector<MaterialReport> materials{};  ///< in their order; none if there is one surface alone
    std::optional<ThinParts> thin{};          ///< looked for if the mesh is not as it should be
    std::size_t parts = 0;                    ///< parts of the mesh that are not joined
    std::size_t added = 0;                    ///< cubes that were needed to make the boundary of the cubes a surface
    int refined = 0;                          ///< how often cubes were divided
    std::size_t divided = 0;                  ///< how many cubes were divided in all
    double side_world = 0;                    ///< side of a cube that is not divided
    std::size_t lid_sides = 0;  ///< sides of cells that are over holes of the surface, most of them: the patch `lid`
    /// What the surface encloses, to compare with `shape.volume_world`; nothing where it has holes or parts cross
    std::optional<double> enclosed_world{};
    /// Least of the control cells: 1 for cubes, negative if one is turned inside out at a corner
    double min_scaled_jacobian = 0;
};

/// The report under its members' names.
[[nodiscard]] Facts facts_of(const ControlMeshReport& report);

struct ControlMesh {
    HexMesh mesh;
    /// A set of cells of each material, if there are several; the patch `lid`, if some sides of cells are over holes
    MeshSets sets;
    ControlMeshReport report;
};

/// A mesh of hexahedra whose limit fills a closed surface.
///
/// Cubes of a grid whose middles lie inside become cells, with a layer of cells around them, so that none has two sides at the
/// boundary. Then the distortion of the cells' children is made as small as it can be, while the boundary of the limit is drawn
/// to the surface, more and more. Cells that stay flat or fold count more then, and rather leave the surface; and points are
/// moved where the limit folds still (`mend_folds`). Where the boundary is still
/// too far away, cubes are divided and all is done again. Chains of sharp edges become creases, with a layer of cells on both
/// sides. Where that cannot be, as in chains nearer to each other than a cell, edges become round, by a part of a cell.
///
/// surface: closed; holes are spanned where most of the surface winds about a place, with a warning. Either side may be out.
///          A wall within another is that of a cavity, whatever its orientation; walls that cross are united
/// throws:  Error(InvalidInput) if the surface is not valid, if it is a sheet without volume, if no cube has its middle inside,
///          if it is more than 1e9 cubes away from the origin, if there would be too many cells, or if an option is out of
///          range; Error(Cancelled)
/// cost:    some 1 to 5 ms and 10 kB a cell, up to ten times as long where cells stay flat or fold; parallel, the same bits for
/// any number of threads source:  [marechal2009] for layers over cubes, [barill2018] for what is inside, [garanzha2021] for
/// distortions
[[nodiscard]] ControlMesh control_mesh_of(const Surface& surface, const ControlMeshOptions& options = {});

/// One mesh of several materials, each with a surface of its own. A place that several surfaces enclose has the material of the
/// one that encloses least: a body within another is cut out of it, whatever their order. The cells of a material are a set.
/// Faces between materials are drawn to the surfaces as the boundary is; they are sharp, so that the limit of each material
/// ends there, and materials meet without gaps.
///
/// throws: Error(InvalidInput) as for one surface; if two materials have the same name, or if one has no cell
[[nodiscard]] ControlMesh control_mesh_of(std::span<const MaterialSurface> materials, const ControlMeshOptions& options = {});

struct LabelOptions {
    /// The labels that become materials, as "3" or "3=bone"; all others are outside. None: all labels. Without a name a label
    /// is called label_3
    std::vector<std::string> labels{};
    int smooth = 40;                            ///< rounds of smoothing; 0: the steps of the voxels
    OptionNames names = OptionNames::Keywords;  ///< of options in errors
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(LabelOptions& options);

struct LabelReport {
    std::string name;
    std::int32_t label = 0;
    std::size_t voxels = 0;
    double voxels_world = 0;    ///< their volume
    double enclosed_world = 0;  ///< what the surface of the label encloses
};

/// The report under its members' names.
[[nodiscard]] Facts facts_of(const std::vector<LabelReport>& labels);

struct LabelSurfaces {
    std::vector<MaterialSurface> materials;  ///< closed, with the same points and triangles where two labels touch
    std::vector<LabelReport> report;         ///< of each
};

/// The closed surfaces of the labels of a grid, for `control_mesh_of`. Neighbours share their walls.
///
/// There is one point between eight voxels that do not have one label, and a quad between each two neighbours with different
/// ones. Points are smoothed without leaving the place between their eight voxels; those where three labels meet, and those of
/// sharp edges along the axes of the voxels, along the line of these points alone. Other sharp edges are rounded by half a
/// voxel. Then walls move along their normals until each label has the volume of its voxels.
///
/// throws: Error(InvalidInput) if no voxel has a label, if a label of the options is not there or is twice, or if there would
///         be more than 1000 materials; Error(Cancelled)
/// cost:   8 visits a voxel of blocks with several labels, 200 bytes and some 20 ns a round for a point; points are 1.5 to 2
///         for each voxel face between labels. Parallel; the same bits for any number of threads
/// source: [frisken2022]; we differ: smoothing by [taubin1995], and volumes are kept
[[nodiscard]] LabelSurfaces label_surfaces(const LabelGrid& grid, const LabelOptions& options = {});

}  // namespace subvol
