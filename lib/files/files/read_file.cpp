// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/read_file.h"

#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>
#include <tuple>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostWithoutSize = 200'000'000;

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

[[noreturn]] void fail_read(const std::filesystem::path& path, int error) {
    throw Error(ErrorCode::Io, "cannot be read: " + std::generic_category().message(error), path.string());
}

// Files of /proc have the size 0, whatever they contain.
bool has_size(const struct stat& about) {
    return S_ISREG(about.st_mode) && about.st_size > 0;
}

// A file may have holes, and so any size.
void expect_memory(const std::filesystem::path& path, std::size_t size) {
    const auto pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
    if (pages <= 0 || page <= 0) return;
    const std::size_t memory = static_cast<std::size_t>(pages) * static_cast<std::size_t>(page);
    if (size < memory) return;
    throw Error(ErrorCode::InvalidInput, "has " + number_text(static_cast<double>(size) / 1e9, 3) + " GB", path.string(),
                "this machine's memory has " + number_text(static_cast<double>(memory) / 1e9, 3) + " GB");
}

}  // namespace

void refuse_missing(const std::filesystem::path& path) {
    struct stat about {};
    if (::stat(path.c_str(), &about) != 0 && (errno == ENOENT || errno == ENOTDIR)) fail_read(path, errno);
}

std::string read_text(const std::filesystem::path& path) {
    const File file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file) fail_read(path, errno);
    struct stat about {};
    if (::fstat(::fileno(file.get()), &about) != 0) fail_read(path, errno);
    if (S_ISDIR(about.st_mode)) fail_read(path, EISDIR);
    std::string text;
    const auto read_to = [&](std::size_t end) {
        const std::size_t before = text.size();
        text.resize(end);
        text.resize(before + std::fread(text.data() + before, 1, end - before, file.get()));
        if (std::ferror(file.get())) fail_read(path, errno);
        return text.size() == end;
    };
    if (has_size(about)) {
        const auto size = static_cast<std::size_t>(about.st_size);
        expect_memory(path, size);
        std::ignore = read_to(size);
        return text;
    }
    constexpr std::size_t kChunk = 1 << 20;
    if (!S_ISREG(about.st_mode)) text.reserve(kMostWithoutSize + 1);  // of which only what is read takes memory
    while (read_to(std::min(text.size() + kChunk, kMostWithoutSize + 1))) {
        if (text.size() <= kMostWithoutSize) continue;
        throw Error(ErrorCode::InvalidInput, "does not end within 200 MB", path.string(), "a file, which may be larger");
    }
    text.shrink_to_fit();
    return text;
}

std::string read_range(const std::filesystem::path& path, std::uint64_t first, std::size_t count) {
    const File file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file || ::fseeko(file.get(), static_cast<off_t>(first), SEEK_SET) != 0) fail_read(path, errno);
    std::string bytes(count, '\0');
    bytes.resize(std::fread(bytes.data(), 1, count, file.get()));
    if (std::ferror(file.get())) fail_read(path, errno);
    return bytes;
}

std::string not_regular(const std::filesystem::path& path) {
    struct stat about {};
    if (::stat(path.c_str(), &about) != 0 || has_size(about)) return {};
    if (S_ISREG(about.st_mode)) {
        const File file(std::fopen(path.c_str(), "rb"), &std::fclose);
        if (!file || std::fgetc(file.get()) == EOF) return {};  // it is empty, or reading it says what is wrong
    }
    return in_quotes(path.filename().string()) + " is not a regular file";
}

std::string read_regular(const std::filesystem::path& path) {
    const std::string wrong = not_regular(path);
    if (!wrong.empty()) throw Error(ErrorCode::InvalidInput, wrong, path.string());
    return read_text(path);
}

std::filesystem::path named_file(const std::filesystem::path& folder, const std::string& name,
                                 const std::function<std::string()>& place) {
    const auto refuse = [&](const std::string& message, const std::string& allowed) {
        throw Error(ErrorCode::InvalidInput, message, place(), allowed);
    };
    constexpr const char* kRelative = "names are relative to the folder of this file";
    if (name.empty()) refuse("no file is named", kRelative);
    if (name.find('\0') != std::string::npos) refuse("the name " + in_quotes(name) + " has a zero byte", "a file's name");
    std::filesystem::path path = folder / name;
    struct stat about {};
    if (::stat(path.c_str(), &about) != 0) refuse("there is no file " + in_quotes(name), kRelative);
    if (!not_regular(path).empty())
        refuse(in_quotes(name) + " is not a regular file", "pipes, devices and folders are not read");
    return path;
}

}  // namespace subvol::detail
