// SPDX-License-Identifier: Apache-2.0
#include "output_file.h"

#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "subvol/error.h"

namespace subvol::detail {

namespace fs = std::filesystem;

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(folder, error)) {
        throw Error(ErrorCode::Io, "the folder \"" + folder.string() + "\" does not exist", target_.string());
    }
    if (fs::is_directory(target_, error)) throw Error(ErrorCode::Io, "is a folder; a file name is needed", target_.string());
    temporary_ = folder / ("." + target_.stem().string() + "." + std::to_string(::getpid()) + target_.extension().string());
}

AtomicFile::~AtomicFile() {
    if (committed_) return;
    std::error_code ignored;
    fs::remove(temporary_, ignored);
}

void AtomicFile::commit() {
    std::error_code error;
    fs::rename(temporary_, target_, error);
    if (error) throw Error(ErrorCode::Io, "cannot be written: " + error.message(), target_.string());
    committed_ = true;
}

OutputFile::OutputFile(const std::filesystem::path& target)
    : target_(target), file_(target), stream_(std::fopen(file_.path().c_str(), "wb")) {
    if (!stream_) fail(errno);
}

OutputFile::~OutputFile() {
    if (stream_) std::fclose(stream_);
}

void OutputFile::write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stream_) != text.size()) fail(errno);
}

std::uint64_t OutputFile::position() const {
    const auto position = ::ftello(stream_);
    if (position < 0) fail(errno);
    return static_cast<std::uint64_t>(position);
}

void OutputFile::overwrite(std::uint64_t position, std::string_view text) {
    if (::fseeko(stream_, static_cast<off_t>(position), SEEK_SET) != 0) fail(errno);
    write(text);
    if (::fseeko(stream_, 0, SEEK_END) != 0) fail(errno);
}

void OutputFile::close() {
    if (stream_ && std::fclose(std::exchange(stream_, nullptr)) != 0) fail(errno);
}

void OutputFile::commit() {
    close();
    file_.commit();
}

void OutputFile::fail(int error) const {
    throw Error(ErrorCode::Io, "cannot be written: " + std::generic_category().message(error), target_.string());
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
    OutputFile out(file);
    out.write(text);
    out.commit();
}

}  // namespace subvol::detail
