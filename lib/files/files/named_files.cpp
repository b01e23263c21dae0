// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/named_files.h"

#include <sys/stat.h>
#include <algorithm>
#include <system_error>
#include <utility>

#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

[[noreturn]] void refuse_named(const NamedFiles::Place& place, const std::string& message, const std::string& allowed = {}) {
    throw Error(ErrorCode::InvalidInput, message, place(), allowed);
}

}  // namespace

NamedFiles::Open NamedFiles::open(const std::filesystem::path& path, const Place& place) {
    const Opened file{identity(path), shortened(path.filename().string())};
    const auto itself = std::ranges::find(open_, file.identity, &Opened::identity);
    if (itself != open_.end()) {
        std::string chain;
        for (auto other = itself; other != open_.end(); ++other) chain += other->name + " > ";
        refuse_named(place, "names itself, by " + chain + file.name);
    }
    if (open_.size() == kDeepest) {
        refuse_named(place, "files name each other, more than " + std::to_string(kDeepest) + " deep");
    }
    open_.push_back(file);
    return Open(this);
}

void NamedFiles::count(const Place& place) {
    if (++count_ <= most_) return;
    refuse_named(place, "more than " + std::to_string(most_) + " files are named", "a file counts each time that it is named");
}

void NamedFiles::take(const std::string& source, std::size_t there, std::size_t taken, const Place& place) {
    if (met_.insert(source).second) there_ += there;
    taken_ += taken;
    if (taken_ <= kFewBytes || (taken_ - kFewBytes) / kMostTimes <= there_) return;
    refuse_named(place, "what is named again and again is too much",
                 "at most " + std::to_string(kMostTimes) + " times the bytes that are there, and " +
                     std::to_string(kFewBytes >> 20) + " MiB");
}

std::string NamedFiles::identity(const std::filesystem::path& path) {
    struct stat about {};
    if (::stat(path.c_str(), &about) != 0) return path.string();
    return std::to_string(about.st_dev) + ":" + std::to_string(about.st_ino);
}

void NamedFiles::take_file(const std::filesystem::path& path, const Place& place) {
    std::error_code none;
    const auto size = std::filesystem::file_size(path, none);
    if (!none) take(identity(path), size, size, place);
}

}  // namespace subvol::detail
