// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/hex_mesh.h"
#include "subvol/picture_look.h"

namespace subvol {

/// What is shown, as a plain value: the same state gives the same picture.
///
/// width, height: of the picture in pixels, with its legend
/// field:         the field that is shown, as for `select_field`; empty: the most sensible one
/// step:          of a series, from 0
/// method:        splat, sheets, tets or dense, as of `subvol render --method`
/// background:    in linear light; none: that of the look
/// axes, edges, legend: what is drawn over the picture
/// clip:          how the volume is cut open
/// compare:       the method of a second picture, which is shown right of `slider` (0 to 1 of the width); empty: none
/// difference:    shows the difference of the two instead
struct ViewState {
    Camera camera{};
    int width = 512, height = 512;
    std::string field{};
    std::size_t step = 0;
    std::string method = "splat";
    LookOptions look{};
    std::optional<Vec3> background{};
    bool axes = false, edges = false, legend = false;
    Clip clip{};
    std::string compare{};
    double slider = 0.5;
    bool difference = false;
};

[[nodiscard]] inline Vec3 background_of(const ViewState& state) {
    return state.background.value_or(background_of(state.look.look));
}

/// A mesh with one field, which is its only attribute, and what the picture needs to know about both.
///
/// shape: bodies with the same number have the same cells; 0: of its own
/// moved: it is being moved, so that tables for its cells pay
struct ViewBody {
    HexMesh mesh;
    Box box;
    ValueRange range;
    std::uint64_t shape = 0;
    bool moved = false;

    [[nodiscard]] const std::string& field() const { return mesh.attributes.front().name; }
};

/// throws: Error(InvalidInput) as `select_field`
[[nodiscard]] ViewBody view_body(HexMesh mesh, const std::optional<std::string>& field);

/// The optics of a state.
[[nodiscard]] Optics optics_of(const ViewState& state, const ViewBody& body);

}  // namespace subvol
