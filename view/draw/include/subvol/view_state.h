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
struct ViewFlow {
    FlowChoices chosen{};
    std::vector<std::string> seeds{};  ///< where streamlines start, as for `ViewSource::seeds`; none: middles of cells

    /// The options that are not as by default, and their values, as users write them.
    [[nodiscard]] std::vector<std::pair<std::string, std::string>> words() const;
};

/// What is shown, as a plain value: the same state gives the same picture.
struct ViewState {
    Camera camera{};
    UpAxis up = UpAxis::Z;          ///< the axis of the world that is up in named views
    int width = 512, height = 512;  ///< size of the picture in pixels, with its legend
    std::string field{};            ///< the field that is shown, as for `select_field`; empty: the most sensible one
    std::size_t step = 0;           ///< the step of a series, from 0
    Method method = Method::Splat;  ///< one of `kViewMethods`
    LookOptions look{};
    std::optional<Vec3> background{};                  ///< in linear light; none: that of the look
    bool axes = false, edges = false, legend = false;  ///< what is drawn over the picture
    bool inverted = true;                              ///< marks the cells of an edited mesh that are inverted
    ViewFlow flow{};                                   ///< streamlines and arrows in the body
    Clip clip{};                                       ///< how the volume is cut open
    /// The method of a second picture, which is shown right of `slider` (0 to 1 of the width); none: no other.
    std::optional<Method> compare{};
    double slider = 0.5;
    bool difference = false;  ///< shows the difference of the two pictures instead
};

[[nodiscard]] inline Vec3 background_of(const ViewState& state) {
    return state.background.value_or(background_of(state.look.look));
}

/// What is shown instead of a mesh: kernels, or voxels and the kernels that were made of them.
struct ViewPoints {
    std::shared_ptr<const RbfVolume> volume{};
    std::shared_ptr<const Voxels> voxels{};
    Box box{};                          ///< the box that named views frame
    std::optional<ValueRange> range{};  ///< the range of the values; none: that of the kernels' values
};

/// A mesh with one field, which is its only attribute, and what the picture needs to know about both.
struct ViewBody {
    HexMesh mesh;  ///< for points, their centres without cells (`mesh_of_points`)
    Box box;
    ValueRange range;
    std::uint64_t shape = 0;  ///< bodies with the same number have the same cells; 0: no other body has them
    bool moved = false;       ///< the mesh is being moved, so that tables for its cells pay
    ViewPoints points{};      ///< shown instead of cells; without a volume: there are cells
    std::size_t channel = 0;  ///< the channel of the points
    /// The mesh is a level of a scheme of tetrahedra on its limit, in hexahedra. It is drawn as tetrahedra and octahedra, or
    /// with one kernel at each point.
    bool tets = false;
    std::shared_ptr<const Flow> flow{};  ///< vectors at the points of the mesh that are drawn, with seeds; null: none
    /// The numbers of the cells with a negative Jacobian at a corner, ascending; null: the mesh has not been edited.
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
