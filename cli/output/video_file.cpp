// SPDX-License-Identifier: Apache-2.0
#include "video_file.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

#include "subvol/error.h"
#include "text.h"

extern char** environ;  // NOLINT: POSIX declares it nowhere

namespace subvol::cli {
namespace {

[[noreturn]] void fail_with(int error, const std::filesystem::path& path) {
    throw Error(ErrorCode::Io, "cannot be written: " + std::generic_category().message(error), path.string());
}

std::vector<std::string> arguments_for(const std::filesystem::path& path, const PictureSize& size, double frames_per_second) {
    std::vector<std::string> arguments{"ffmpeg",
                                       "-v",
                                       "error",
                                       "-nostdin",
                                       "-y",
                                       "-f",
                                       "rawvideo",
                                       "-pix_fmt",
                                       "rgb24",
                                       "-s",
                                       text(size.width, "x", size.height),
                                       "-r",
                                       text(frames_per_second),
                                       "-i",
                                       "pipe:0"};
    const auto add = [&](std::initializer_list<const char*> more) {
        arguments.insert(arguments.end(), more.begin(), more.end());
    };
    if (path.extension() == ".gif") {
        add({"-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse"});
    } else {
        // Players want even sizes, and the matrix of HD that they assume.
        add({"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709,format=yuv420p", "-colorspace", "bt709",
             "-color_primaries", "bt709", "-color_trc", "bt709", "-crf", "18"});
        if (path.extension() == ".webm") add({"-b:v", "0"});
        if (path.extension() == ".mp4") add({"-movflags", "+faststart"});
    }
    arguments.push_back("file:" + path.string());  // otherwise a colon or a dash in the name would have a meaning
    return arguments;
}

std::string last_line(std::FILE* words) {
    std::string line, last;
    std::rewind(words);
    for (int c = std::fgetc(words); c != EOF; c = std::fgetc(words)) {
        if (c != '\n' && c != '\r') {
            line += static_cast<char>(c);
        } else if (!line.empty()) {
            last = std::exchange(line, {});
        }
    }
    return line.empty() ? last : line;
}

}  // namespace

bool is_video(const std::filesystem::path& path) {
    const std::string extension = path.extension().string();
    return extension == ".mp4" || extension == ".webm" || extension == ".gif";
}

VideoFile::VideoFile(const std::filesystem::path& path, const PictureSize& size, double frames_per_second)
    : path_(path), file_(path), words_(std::tmpfile()) {
    if (!words_) fail_with(errno, path_);
    try {
        start(size, frames_per_second);
    } catch (...) {
        std::fclose(words_);
        throw;
    }
}

VideoFile::~VideoFile() {
    if (process_ >= 0) {
        ::kill(process_, SIGKILL);
        wait();
    }
    close_pipe();
    std::fclose(words_);
}

void VideoFile::start(const PictureSize& size, double frames_per_second) {
    // A socket rather than a pipe: once nobody reads it, writing to it can be an error instead of a signal.
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) fail_with(errno, path_);
    pipe_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ::fileno(words_), STDERR_FILENO);
    // In its own process group, so that an interrupt reaches only us; we then end ffmpeg.
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);

    std::vector<std::string> arguments = arguments_for(file_.path(), size, frames_per_second);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    const int error = ::posix_spawnp(&process_, "ffmpeg", &actions, &attributes, pointers.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (error == 0) return;
    process_ = -1;
    close_pipe();
    throw Error(ErrorCode::MissingCapability, "a video needs the program ffmpeg, which cannot be started", path_.string(),
                "install it, or write numbered pictures: .png");
}

void VideoFile::write(std::span<const std::uint8_t> rgb) {
    while (!rgb.empty()) {
        const ssize_t sent = ::send(pipe_, rgb.data(), rgb.size(), MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0) fail();
        rgb = rgb.subspan(static_cast<std::size_t>(sent));
    }
}

void VideoFile::finish() {
    close_pipe();
    if (!wait()) fail();
    file_.commit();
}

bool VideoFile::wait() {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void VideoFile::fail() {
    close_pipe();
    if (process_ >= 0) wait();  // so that its messages are complete
    const std::string words = last_line(words_);
    throw Error(ErrorCode::Io, "ffmpeg failed" + (words.empty() ? std::string() : ": " + words), path_.string());
}

void VideoFile::close_pipe() {
    if (pipe_ >= 0) ::close(std::exchange(pipe_, -1));
}

}  // namespace subvol::cli
