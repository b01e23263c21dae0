// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "subvol/color_scale.h"
#include "subvol/mesh_source.h"
#include "subvol/names.h"
#include "subvol/optics.h"
#include "subvol/option_names.h"
#include "subvol/transfer_function.h"

namespace subvol {

/// The range of a field's values.
struct ValueRange {
    double min = 0, max = 0;
    bool bounded = false;  ///< values of the limit beyond it are shown as its ends (`Attribute::bounds`)
};

/// The kinds of pictures. Solid: opaque and lit. Volume: transparent as the colour map says, black behind. Xray: dark where
/// there is much, on white. Isosurface: five lit surfaces.
enum class Look { Solid, Volume, Xray, Isosurface };

template <>
struct NameTable<Look> {
    static constexpr Name<Look> rows[] = {
        {Look::Solid, "solid"}, {Look::Volume, "volume"}, {Look::Xray, "xray"}, {Look::Isosurface, "isosurface"}};
};

/// Colours and opacities of a picture.
struct LookOptions {
    Look look = Look::Volume;
    /// A preset, or a ParaView colour-map file (FILE.json:NAME for one of several in it); empty: that of the look
    std::string colors{};
    std::optional<ValueRange> range{};  ///< what the colour map covers; none: the field's range
    bool stretch = false;               ///< spreads the map of a file over the range; otherwise it keeps its own values
    std::vector<TransferFunction::OpacityKnot> opacity{};  ///< knots instead of those of the map; empty: those of the map
    ColorShape shape{};  ///< the scale of the map, its bands, and the colours beyond the range
    /// The distance that opacities are for; none: 1/100 of the box's diagonal, of a solid 1/1,000,000
    std::optional<double> opacity_unit_world{};
    bool clamp = false;  ///< values beyond the field's range look like its ends
};

/// What users choose of it, before the body and the range of its field are known.
struct LookChoices {
    std::optional<std::string> look{};  ///< none: solid for bodies with a boundary, unless opacities are chosen; else volume
    std::optional<std::string> colors{};
    std::optional<std::string> range{};    ///< "MIN,MAX", parts of the field's range such as "10%,90%", or "field"
    std::optional<std::string> opacity{};  ///< as `parse_opacity` reads it
    std::string iso{};  ///< values, or parts of the field's range, of lit surfaces: "300,60%"; the look is that of isosurfaces
    std::optional<double> opacity_unit_world{};
    bool clamp = false;
    bool log = false;                ///< a logarithmic scale
    std::optional<double> symlog{};  ///< a scale that is logarithmic on both sides of 0, and linear within this value
    std::optional<int> bands{};      ///< the number of colours
    std::optional<std::string> below{}, above{};  ///< colours of values beyond the range, as `parse_color` reads them
};

/// look, tf, opacity-unit, clamp, range, opacity, iso, log, symlog, bands, below, above
[[nodiscard]] std::vector<Option> options_of(LookChoices& choices);

/// throws: Error(InvalidInput) for an unknown look, or for another one than isosurfaces with their values
[[nodiscard]] Look chosen_look(const LookChoices& choices, bool has_boundary, OptionNames names = OptionNames::Keywords);

/// A value of a field, or a part of its range: "293", "20%".
///
/// where:  is named in the error
/// throws: Error(InvalidInput) if it is neither
[[nodiscard]] double parse_value(const std::string& text, const ValueRange& whole, const std::string& where);

/// Opacities that show narrow layers around values, as those of isosurfaces: 0 beside them, in between a hundredth of the range
/// to either side.
///
/// values: any order; equal ones are taken once
[[nodiscard]] std::vector<TransferFunction::OpacityKnot> opacity_of_isosurfaces(std::vector<double> values,
                                                                                const ValueRange& range);

/// "293,913" or "10%,90%". throws: Error(InvalidInput) if it is not two ascending values
[[nodiscard]] ValueRange parse_range(const std::string& text, const ValueRange& whole, const std::string& where);

/// The range that the colours cover: the one that is chosen, else the field's.
[[nodiscard]] ValueRange shown_range(const LookChoices& choices, const ValueRange& field,
                                     OptionNames names = OptionNames::Keywords);

/// throws: Error(InvalidInput) that names the option
[[nodiscard]] ColorShape color_shape(const LookChoices& choices, OptionNames names = OptionNames::Keywords);

/// field:  the range of the field that gives the opacities
/// throws: Error(InvalidInput) that names the option
[[nodiscard]] LookOptions look_options(const LookChoices& choices, Look look, const ValueRange& field,
                                       OptionNames names = OptionNames::Keywords);

/// Whether pictures of this look are lit.
[[nodiscard]] inline bool is_lit(Look look) {
    return look == Look::Solid || look == Look::Isosurface;
}

/// The colour behind pictures of this look, in linear light.
[[nodiscard]] Vec3 background_of(Look look);

/// The world distance that opacities of pictures of this look are for, unless another one is given.
[[nodiscard]] double opacity_unit_of(Look look, const Box& box);

/// Makes a colour map that of a solid: opaque everywhere.
///
/// plain: all values are the same, so that a colour of the map would mean nothing: the colour of a body without a field
void make_solid(TransferFunction& function, bool plain);

/// Reads a colour map's file, or makes a preset over the range.
///
/// stretch: spreads a file's map over the range, too
/// throws:  as `transfer_function_preset` and `read_transfer_function`
[[nodiscard]] TransferFunction find_transfer_function(const std::string& name, const ValueRange& range, bool stretch = false);

/// The name of the colour map that a picture has.
[[nodiscard]] std::string colors_of(const LookOptions& options);

/// Colours and opacities of a picture as `Optics`.
///
/// field:  the range of the field that gives the opacities
/// colors: that of the field that gives the colours, often the same
/// throws: as `find_transfer_function` and `Optics`
[[nodiscard]] Optics picture_optics(const LookOptions& options, const Box& box, const ValueRange& field,
                                    const ValueRange& colors);
/// The same with this colour map instead of `options.colors` and its range. plain: the map was not chosen
[[nodiscard]] Optics picture_optics(TransferFunction map, const LookOptions& options, const Box& box, const ValueRange& field,
                                    const ValueRange& colors, bool plain = false);

/// The points to which a camera is fitted: those of a solid, and those of a mesh without cells; of other bodies those of the
/// cells that can be seen, or nothing if these are most of the body.
///
/// source:  its first attribute is the field
/// returns: of a mesh in pieces the same as of the whole, but nothing for a solid, whose hull frames it (`gather_hull`)
/// cost:    reads all pieces once, but for a solid; memory: one piece and the points
[[nodiscard]] std::vector<Vec3> framed_points(const MeshSource& source, Look look, const Optics& optics,
                                              Progress* progress = nullptr);

}  // namespace subvol
