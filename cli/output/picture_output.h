// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "picture_arguments.h"
#include "report.h"
#include "subvol/image.h"
#include "video_file.h"

namespace subvol::cli {

/// What drawing yields.
///
/// depth: one a pixel for .exr, as `write_image` takes it; none: not known
struct Picture {
    Image image;
    std::vector<float> depth{};
};

/// Where the pictures of a run go: one file, numbered files NAME_0000.png and so on, or a video.
class PictureOutput {
public:
    /// Refuses before any work is done what cannot be written.
    ///
    /// frames: of a turntable; none: a single picture
    /// throws: Error(InvalidInput), Error(Io), Error(MissingCapability)
    PictureOutput(const std::string& path, std::optional<int> frames, const PictureArguments& arguments);

    /// Draws and writes one picture a view; tells the report how far it is and the names of the files.
    void write(const std::vector<View>& views, const std::function<Picture(const View&, Progress*)>& draw, Report& report);

private:
    [[nodiscard]] std::filesystem::path frame_path(std::size_t frame) const;
    void write_frame(std::size_t frame, const Picture& picture);

    std::filesystem::path path_;
    std::optional<int> frames_;
    Vec3 background_;
    std::optional<VideoFile> video_;
};

}  // namespace subvol::cli
