// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>

#include "picture_arguments.h"
#include "subvol/detail/atomic_file.h"

namespace subvol::cli {

/// Whether the file name has the extension of a video: .mp4, .webm, .gif.
[[nodiscard]] bool is_video(const std::filesystem::path& path);

/// A video that the program `ffmpeg` makes from frames sent through a pipe. It is written beside its place, then renamed.
class VideoFile {
public:
    /// Starts ffmpeg at once, so that a missing ffmpeg is noticed before any work is done.
    ///
    /// throws: Error(MissingCapability) if there is no ffmpeg
    VideoFile(const std::filesystem::path& path, const PictureSize& size, double frames_per_second);
    ~VideoFile();
    VideoFile(const VideoFile&) = delete;
    VideoFile& operator=(const VideoFile&) = delete;

    /// rgb: 8-bit sRGB, 3 · width · height, rows from the top
    ///
    /// throws: Error(Io) with the last line of ffmpeg's messages
    void write(std::span<const std::uint8_t> rgb);

    /// Waits for ffmpeg and gives the file its name.
    ///
    /// throws: Error(Io) as above
    void finish();

private:
    void start(const PictureSize& size, double frames_per_second);
    /// returns: whether ffmpeg succeeded
    bool wait();
    [[noreturn]] void fail();
    void close_pipe();

    std::filesystem::path path_;
    detail::AtomicFile file_;
    std::FILE* words_;  // ffmpeg's messages
    pid_t process_ = -1;
    int pipe_ = -1;
};

}  // namespace subvol::cli
