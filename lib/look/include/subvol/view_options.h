// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/camera.h"
#include "subvol/facts.h"
#include "subvol/option_names.h"

namespace subvol {

/// In pixels.
struct PictureSize {
    int width = 512, height = 512;
};

/// "512x384", or "512" for a square.
///
/// where:  is named in the error
/// throws: Error(InvalidInput)
[[nodiscard]] PictureSize parse_size(const std::string& text, const std::string& where);

/// The size and the camera of a picture.
struct ViewOptions {
    PictureSize size{};
    std::optional<std::string> camera{};  ///< text as `parse_camera` reads it; nothing: the named view
    std::string view = "iso";             ///< the side to look from; the camera is fitted to what is visible
    UpAxis up = UpAxis::Z;                ///< the axis of the world that is up in named views
    bool fit = false;                     ///< moves the camera until the whole box is in the picture
    bool orthographic = false;            ///< makes a perspective camera an orthographic one, as high as the box needs
    std::optional<int> turntable{};       ///< the pictures of one turn, all of which see what is visible; nothing: one picture
};

/// size, camera, view, up, fit, ortho, turntable
[[nodiscard]] std::vector<Option> options_of(ViewOptions& options);

/// As `parse_camera`; the error names the option.
[[nodiscard]] Camera camera_of_option(const std::string& option, const std::string& text, const Box& box, double aspect = 1,
                                      UpAxis up = UpAxis::Z);

/// The numbers of a camera, as `parse_camera` reads them: exact.
[[nodiscard]] std::string camera_text(const Camera& camera);

/// The same as a file of a camera has it: eye, target, up, and fovy_deg or ortho_height.
[[nodiscard]] Facts facts_of(const Camera& camera);

/// The camera of the options; of a turntable its first one.
///
/// points: those that a named view is fitted to (`framed_points`); none: the box
/// aspect: width / height of the picture
/// throws: Error(InvalidInput) that names the option, Error(Io)
[[nodiscard]] Camera find_camera(const ViewOptions& options, const Box& box, std::span<const Vec3> points, double aspect,
                                 OptionNames names = OptionNames::Keywords);

}  // namespace subvol
