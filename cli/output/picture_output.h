// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "part_note.h"
#include "picture_arguments.h"
#include "picture_notes.h"
#include "share.h"
#include "video_file.h"

namespace subvol::cli {

/// Where the pictures of a run go: one file, numbered files NAME_0000.png and so on, or a video.
class PictureOutput {
public:
    /// Checks before any work is done that the output can be written.
    ///
    /// frames: of a turntable or the steps of a series; none: a single picture
    /// first:  the number of the first frame in the names
    /// throws: Error(InvalidInput), Error(Io), Error(MissingCapability)
    PictureOutput(const std::string& path, std::optional<int> frames, const PictureArguments& arguments, int first = 0);

    /// Only a share is to be drawn and written: of frames those of the share, of a single picture its rows, as a part (.exr).
    ///
    /// note:   of a single picture; it gets the rows and the background
    /// throws: Error(InvalidInput) if the output is a video or, for a single picture, not .exr
    void set_share(const Share& share, PartNote note);

    /// Writes nothing, as another rank does it.
    void set_silent() { silent_ = true; }

    /// Whether the next frame is one of the share's.
    [[nodiscard]] bool wants_next() const;
    /// Passes over the next frame.
    void skip() { ++written_; }
    /// Passes over the next frame, of which there is no picture.
    void leave_out() { left_out_.insert(written_++); }

    /// What is drawn over every picture from now on.
    void set_notes(PictureNotes notes) { notes_ = std::move(notes); }
    /// Whether edges lie in the depth of the body, whose boundary is needed.
    [[nodiscard]] bool draws_within() const { return notes_.within; }
    void set_boundary(const Surface& boundary) { notes_.boundary = &boundary; }

    /// Draws and writes one picture for each view, after those of earlier calls.
    ///
    /// returns: the facts of all pictures
    Facts write(const std::vector<View>& views, const DrawPicture& draw, Progress* progress);

    /// To be called after the last picture.
    ///
    /// returns: the names of the files
    Facts finish(Progress* progress);

private:
    [[nodiscard]] std::filesystem::path frame_path(std::size_t frame) const;
    Facts write_sheet(const std::vector<View>& views, const DrawPicture& draw, Progress* progress);
    void write_frame(std::size_t frame, const Picture& picture, int body_rows, const std::string& camera);
    void write_rows(const Picture& picture, int body_rows, const std::string& camera);

    std::filesystem::path path_;
    std::optional<int> frames_;
    int first_;
    std::vector<std::string> sheet_;  // the names of several views in one picture
    int columns_;                     // of the sheet
    Vec3 background_;
    bool transparent_;
    PictureNotes notes_{};
    std::size_t written_ = 0;
    std::set<std::size_t> left_out_{};
    FactValue::List cameras_{};  // of what was drawn
    float opacity_ = 0;          // the largest of a pixel
    std::optional<Share> share_;
    PartNote note_{};
    bool silent_ = false;
    std::optional<VideoFile> video_;
};

}  // namespace subvol::cli
