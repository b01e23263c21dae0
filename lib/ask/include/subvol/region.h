// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"

namespace subvol {

/// A part of space, the cells where a quantity is not 0, those of named sets, or those whose limit folds:
///
///     box:x0,y0,z0,x1,y1,z1    sphere:x,y,z,r    half:px,py,pz,nx,ny,nz    where:T>500    set:rotor,stator
///     fold:folded,open    nodes:fixed
///
/// half: the side of the plane through p that the normal n points to
/// where: a quantity as for `field_of`. A cell belongs to the region if it is not 0 at half of its corners or more
/// nodes: the cells that have a point of these sets of nodes
/// fold: the cells with one of these verdicts of `check_folds`, of the scheme MCQ
class Region {
public:
    enum class Kind { Box, Sphere, Half, Where, Set, Fold, Nodes };

    /// throws: Error(InvalidInput) if the text does not say a region, or one without volume
    Region(const std::string& text);

    [[nodiscard]] Kind kind() const { return kind_; }
    [[nodiscard]] const std::string& text() const { return text_; }
    /// Whether it consists of whole cells, not of a part of space.
    [[nodiscard]] bool chooses_cells() const { return kind_ != Kind::Box && kind_ != Kind::Sphere && kind_ != Kind::Half; }
    /// About how far inside a part of space a place lies (world), negative outside. It is exact near the faces, and changes
    /// by no more than the distance between two places.
    [[nodiscard]] double depth(const Vec3& place) const;
    /// The same behind each of its faces: a box has six, others one.
    [[nodiscard]] std::size_t faces() const { return kind_ == Kind::Box ? 6 : 1; }
    [[nodiscard]] double depth(const Vec3& place, std::size_t face) const;
    /// The centre of a sphere, or a point of the plane of a half.
    [[nodiscard]] const Vec3& point() const { return point_; }
    /// Of a sphere (world).
    [[nodiscard]] double radius() const { return radius_; }
    /// The quantity of `where`; the names of `set`, `nodes` and `fold`, with commas between.
    [[nodiscard]] const std::string& quantity() const { return quantity_; }

private:
    std::string text_;
    Kind kind_ = Kind::Box;
    Box box_{};
    Vec3 point_{0.0}, normal_{0.0};
    double radius_ = 0;
    std::string quantity_;
};

/// "half:" and "box:" of numbers. throws: Error(InvalidInput) as the constructor
[[nodiscard]] Region half_space(const Vec3& point, const Vec3& normal);
[[nodiscard]] Region box_region(const Box& box);

/// throws: Error(InvalidInput) as the constructor
[[nodiscard]] std::vector<Region> parse_regions(std::span<const std::string> texts);

/// Regions by what they choose: parts of space, which are cut where something is measured, and whole cells.
struct SpaceAndCells {
    std::vector<Region> space, cells;
};
[[nodiscard]] SpaceAndCells space_and_cells(std::span<const Region> regions);

/// How far inside all of several parts of space a place lies.
[[nodiscard]] double depth(std::span<const Region> regions, const Vec3& place);

/// The cells that belong to all regions: of parts of space those whose centre, the mean of the corners, lies inside.
///
/// sets:   those of the mesh that regions may name
/// throws: Error(InvalidInput) as `field_of` and `find_set`, or if there are none
[[nodiscard]] std::vector<std::uint8_t> cells_in(const HexMesh& mesh, std::span<const Region> regions,
                                                 const MeshSets& sets = {});

/// The mesh of some cells. Edges where it is cut out are creases, unless its boundary runs on smoothly there in the limit of
/// the whole mesh. Even so its limit is another one near the cut, as the cells that were beside it no longer shape it:
/// `part_of_limit` says how far it is from there, and refines it. cells: a flag for each cell
[[nodiscard]] HexMesh only_cells(const HexMesh& mesh, std::span<const std::uint8_t> cells);

/// The mesh of the cells that belong to all regions.
[[nodiscard]] HexMesh only_in(const HexMesh& mesh, std::span<const Region> regions, const MeshSets& sets = {});

}  // namespace subvol
