// SPDX-License-Identifier: Apache-2.0
#include "clip_arguments.h"

#include <CLI/CLI.hpp>

#include "numbers.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

CutPlane parse_plane(const std::string& option, const std::string& value) {
    const auto numbers = parse_numbers(option, value, 6, "0,0,0,0,0,1 (a point of the plane and its normal)");
    const CutPlane plane{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
    if (glm::length(plane.normal) == 0) {
        throw Error(ErrorCode::InvalidInput, "the normal of '" + value + "' has no length", option,
                    "the last three numbers are a direction such as 0,0,1");
    }
    return plane;
}

}  // namespace

void ClipArguments::add_to(CLI::App& app) {
    app.add_option("--clip", planes,
                   "cut away what lies on the side of this plane to which its normal points: a point and the normal "
                   "(repeatable)")
        ->type_name("PX,PY,PZ,NX,NY,NZ")
        ->transform(number_list(6, "0,0,0,0,0,1: a point of the plane and its normal"))
        ->allow_extra_args(false);
    app.add_option("--clip-box", box, "cut away what lies outside this box: its lower and its upper corner")
        ->type_name("X0,Y0,Z0,X1,Y1,Z1")
        ->transform(number_list(6, "0,0,0,1,1,1: the lower corner, then the upper one"));
    app.add_option("--slice", slices,
                   "draw the volume on this plane alone, opaque and in the colours of its values: a point and the normal "
                   "(repeatable)")
        ->type_name("PX,PY,PZ,NX,NY,NZ")
        ->transform(number_list(6, "0,0,0,0,0,1: a point of the plane and its normal"))
        ->allow_extra_args(false);
    app.add_flag("--around", around_slices, "draw the volume around the slices too, as --look says")->needs("--slice");
}

Clip ClipArguments::clip() const {
    Clip clip{.around_slices = around_slices};
    for (const std::string& plane : planes) clip.planes.push_back(parse_plane("--clip", plane));
    for (const std::string& plane : slices) clip.slices.push_back(parse_plane("--slice", plane));
    if (box.empty()) return clip;
    const auto n = parse_numbers("--clip-box", box, 6, "0,0,0,1,1,1 (the lower corner, then the upper one)");
    clip.box = Box{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    for (int axis = 0; axis < 3; ++axis) {
        if (clip.box->lower[axis] < clip.box->upper[axis]) continue;
        throw Error(ErrorCode::InvalidInput, text("the box '", box, "' is empty along ", "xyz"[axis]), "--clip-box",
                    "the lower corner first, then the upper one");
    }
    return clip;
}

}  // namespace subvol::cli
