// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/flow_surface.h"
#include "subvol/hex_mesh.h"
#include "subvol/method.h"
#include "subvol/picture_look.h"
#include "subvol/quantity.h"
#include "subvol/rbf_volume.h"
#include "subvol/voxels.h"

namespace subvol {

/// Streamlines and arrows of a picture, as users choose them.
///
/// seeds: where streamlines start, as for `ViewSource::seeds`; none: middles of cells
struct ViewFlow {
    FlowChoices chosen{};
    std::vector<std::string> seeds{};

    /// The options that are not as by default, and their values, as users write them.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> words() const;
};

/// What is shown, as a plain value: the same state gives the same picture.
///
/// width, height: of the picture in pixels, with its legend
/// field:         the field that is shown, as for `select_field`; empty: the most sensible one
/// step:          of a series, from 0
/// method:        one of `kViewMethods`
/// background:    in linear light; none: that of the look
/// axes, edges, legend: what is drawn over the picture
/// inverted:      marks the cells of an edited mesh that are inverted
/// flow:          streamlines and arrows in the body
/// clip:          how the volume is cut open
/// compare:       the method of a second picture, which is shown right of `slider` (0 to 1 of the width); none: no other
/// difference:    shows the difference of the two instead
struct ViewState {
    Camera camera{};
    int width = 512, height = 512;
    std::string field{};
    std::size_t step = 0;
    Method method = Method::Splat;
    LookOptions look{};
    std::optional<Vec3> background{};
    bool axes = false, edges = false, legend = false;
    bool inverted = true;
    ViewFlow flow{};
    Clip clip{};
    std::optional<Method> compare{};
    double slider = 0.5;
    bool difference = false;
};

[[nodiscard]] inline Vec3 background_of(const ViewState& state) {
    return state.background.value_or(background_of(state.look.look));
}

/// What is shown instead of a mesh: kernels, or voxels and the kernels that were made of them.
///
/// box:   what named views frame
/// range: of the values; none: that of the kernels' values
struct ViewPoints {
    std::shared_ptr<const RbfVolume> volume{};
    std::shared_ptr<const Voxels> voxels{};
    Box box{};
    std::optional<ValueRange> range{};
};

/// A mesh with one field, which is its only attribute, and what the picture needs to know about both.
///
/// mesh:     of points, their centres without cells (`mesh_of_points`)
/// shape:    bodies with the same number have the same cells; 0: of its own
/// moved:    it is being moved, so that tables for its cells pay
/// points:   shown instead of cells; without a volume: there are cells
/// channel:  of the points
/// flow:     vectors at the points of the mesh that are drawn, with seeds; null: none
/// inverted: the numbers of the cells with a negative Jacobian at a corner, ascending; null: the mesh has not been edited
/// tets:     the mesh is a level of a scheme of tetrahedra on its limit, in hexahedra. It is drawn as tetrahedra and octahedra,
///           or with one kernel at each point
struct ViewBody {
    HexMesh mesh;
    Box box;
    ValueRange range;
    std::uint64_t shape = 0;
    bool moved = false;
    ViewPoints points{};
    std::size_t channel = 0;
    bool tets = false;
    std::shared_ptr<const Flow> flow{};
    std::shared_ptr<const std::vector<std::size_t>> inverted{};

    [[nodiscard]] const std::string& field() const { return mesh.attributes.front().name; }
};

/// throws: Error(InvalidInput) as `select_field`
[[nodiscard]] ViewBody view_body(HexMesh mesh, const std::optional<std::string>& field);

/// The same of one channel of points; mesh: of `mesh_of_points`.
[[nodiscard]] ViewBody view_body(HexMesh mesh, const ViewPoints& points, const std::optional<std::string>& field);

/// The centres of kernels as points without cells, with the values of all channels.
[[nodiscard]] HexMesh mesh_of_points(const RbfVolume& volume);

[[nodiscard]] BodyKind kind_of(const ViewBody& body);

/// All methods but footprints, which cannot be cut.
inline constexpr Methods kViewMethods = ((1U << std::size(NameTable<Method>::rows)) - 1) & ~bit(Method::Footprints);

/// The names of those of them that are in a set.
[[nodiscard]] std::vector<std::string> view_methods(Methods able = kViewMethods);
/// Those that can draw a body.
[[nodiscard]] std::vector<std::string> methods_of(const ViewBody& body);

/// The optics of a state.
[[nodiscard]] Optics optics_of(const ViewState& state, const ViewBody& body);

}  // namespace subvol
