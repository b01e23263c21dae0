// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "numbers.h"
#include "share.h"
#include "subvol/hex_mesh.h"

namespace subvol::cli {

/// The frames of a share; `last` is before `first` if there are none.
[[nodiscard]] FrameRange frames_of(const Share& share, const FrameRange& all);

/// Whether a file's name has a place for the number of a frame: one or more #.
[[nodiscard]] bool has_number(const std::string& pattern);

/// Refuses a file's name without it. of: what has the number, "frame" or "step"; example: such a name
void check_numbered(const std::string& pattern, const char* of, const std::string& example);

/// Checks before any work is done that all files of a sequence are there.
///
/// throws: Error(Io) that names those that are missing
void check_frames(const std::string& pattern, const FrameRange& range);

/// The name with the number in place of its last row of #, padded with zeros to that many digits.
[[nodiscard]] std::string with_number(const std::string& pattern, int number);

/// The meshes of a sequence: files with numbers in their names, or two meshes with points and values interpolated linearly
/// between them.
class MeshFrames {
public:
    /// Reads a mesh by the name of its file.
    using Load = std::function<HexMesh(const std::string&)>;

    /// to:     the mesh of the last frame; none: `input` has # for the number
    /// throws: Error(InvalidInput) if the two do not have the same cells and fields
    MeshFrames(std::string input, const std::optional<std::string>& to, FrameRange range, Load load);

    /// The steps of a series, which `load` reads by their number. times: of all of them, from 0
    MeshFrames(FrameRange range, std::vector<double> times, std::function<HexMesh(int)> load);

    /// Keeps the mesh until it is two frames old.
    [[nodiscard]] const HexMesh& mesh(int frame);

    /// `velocity_between` the frames before and after, in world units a frame, or of a series' steps a unit of time; one-sided
    /// at the first and the last one.
    ///
    /// throws: Error(InvalidInput) if the frames beside it have other cells, or if there is only one frame
    [[nodiscard]] Attribute velocity(int frame);

private:
    FrameRange range_;
    std::function<HexMesh(int)> load_;
    std::vector<double> times_;
    std::optional<HexMesh> from_, to_;  // with `to`
    std::map<int, HexMesh> meshes_;
};

}  // namespace subvol::cli
