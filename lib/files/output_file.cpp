// SPDX-License-Identifier: Apache-2.0
#include "output_file.h"

#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "subvol/error.h"

namespace subvol::detail {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail_to_write(const fs::path& target, const std::error_code& error) {
    throw Error(ErrorCode::Io, "cannot be written: " + error.message(), target.string());
}

/// Whether a link is one of the kernel's, whose text need not be the name of a file: /proc/self/fd/1 -> pipe:[4711].
bool is_of_the_kernel(const fs::path& link) {
    std::error_code error;
    const fs::path folder = fs::canonical(link.has_parent_path() ? link.parent_path() : fs::path("."), error);
    return !error && *std::next(folder.begin(), folder.has_relative_path() ? 1 : 0) == "proc";
}

/// A new folder that nobody else can write to.
fs::path make_private_folder(const fs::path& target) {
    std::error_code error;
    std::string folder = (fs::temp_directory_path(error) / "subvol_XXXXXX").string();
    if (error) fail_to_write(target, error);
    if (!::mkdtemp(folder.data())) fail_to_write(target, {errno, std::generic_category()});
    return folder;
}

/// Appends, so that nothing is lost where a stream turns out to be a file: >> results.
void append_bytes(const fs::path& from, const fs::path& to, const fs::path& target) {
    constexpr std::size_t kChunk = 1 << 20;
    const auto open = [&](const fs::path& path, const char* mode) {
        std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), mode), &std::fclose);
        if (!file) fail_to_write(target, {errno, std::generic_category()});
        return file;
    };
    const auto in = open(from, "rb");
    auto out = open(to, "ab");
    std::vector<char> chunk(kChunk);
    while (const std::size_t length = std::fread(chunk.data(), 1, chunk.size(), in.get())) {
        if (std::fwrite(chunk.data(), 1, length, out.get()) != length) fail_to_write(target, {errno, std::generic_category()});
    }
    if (std::ferror(in.get())) fail_to_write(target, std::make_error_code(std::errc::io_error));
    if (std::fclose(out.release()) != 0) fail_to_write(target, {errno, std::generic_category()});
}

}  // namespace

OutputPlace output_place(const fs::path& target) {
    constexpr int kMostLinks = 40;  // as Linux
    OutputPlace place{.file = target};
    std::error_code error;
    for (int links = 0; fs::is_symlink(place.file, error); ++links) {
        if (links == kMostLinks) fail_to_write(target, std::make_error_code(std::errc::too_many_symbolic_link_levels));
        if (is_of_the_kernel(place.file)) return {place.file, true};
        const fs::path next = fs::read_symlink(place.file, error);
        if (error) fail_to_write(target, error);
        place.file = place.file.parent_path() / next;  // next alone if it is absolute
    }
    const fs::file_type type = fs::status(place.file, error).type();
    place.stream = type == fs::file_type::character || type == fs::file_type::block || type == fs::file_type::fifo ||
                   type == fs::file_type::socket;
    return place;
}

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)), place_(output_place(target_)) {
    std::error_code error;
    const fs::path beside = place_.file.has_parent_path() ? place_.file.parent_path() : fs::path(".");
    const fs::path folder = place_.stream ? make_private_folder(target_) : beside;
    if (!fs::is_directory(folder, error)) {
        throw Error(ErrorCode::Io, "the folder \"" + folder.string() + "\" does not exist", target_.string());
    }
    if (fs::is_directory(place_.file, error)) {
        throw Error(ErrorCode::Io, "is a folder; a file name is needed", target_.string());
    }
    // The extension is that of the name that the user chose: it decides the format.
    temporary_ = folder / ("." + place_.file.stem().string() + "." + std::to_string(::getpid()) + target_.extension().string());
    unfinished_.emplace(temporary_, place_.stream);
}

AtomicFile::~AtomicFile() {
    if (committed_) return;
    std::error_code ignored;
    fs::remove(temporary_, ignored);
    if (place_.stream) fs::remove(temporary_.parent_path(), ignored);
}

void AtomicFile::commit() {
    if (place_.stream) return append_bytes(temporary_, place_.file, target_);  // the destructor removes the temporary file
    std::error_code error;
    fs::rename(temporary_, place_.file, error);
    if (error) fail_to_write(target_, error);
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
    if (text.empty()) return;  // an empty view may be a null pointer, which fwrite must not be given
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

void OutputFile::seek(std::uint64_t position) {
    if (::fseeko(stream_, static_cast<off_t>(position), SEEK_SET) != 0) fail(errno);
}

void OutputFile::write_at(std::uint64_t position, std::string_view text) {
    seek(position);
    write(text);
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
