// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "subvol/detail/read_file.h"

namespace subvol::detail {

/// What the files that a user names lead to, by the names of other files in them. A few lines could ask for any number of
/// files and any number of bytes: lists may name themselves, and a file may be named again and again.
///
/// Every failure is an Error(InvalidInput). place: says where a file is named, and is called for messages alone.
class NamedFiles {
public:
    using Place = std::function<std::string()>;
    static constexpr std::size_t kDeepest = 16;
    /// What is read and made is at most so many times what is there, and so many bytes more.
    static constexpr std::size_t kMostTimes = 16;
    static constexpr std::size_t kFewBytes = std::size_t{16} << 20;

    /// most: names of files
    explicit NamedFiles(std::size_t most = 100000) : most_(most) {}

    /// The time for which a file is open that names others.
    class Open {
    public:
        Open(Open&& other) noexcept : files_(std::exchange(other.files_, nullptr)) {}
        Open& operator=(Open&&) = delete;
        ~Open() {
            if (files_ != nullptr) files_->open_.pop_back();
        }

    private:
        friend class NamedFiles;
        explicit Open(NamedFiles* files) : files_(files) {}
        NamedFiles* files_;
    };

    /// Opens a file that names others; fails if it is open already, or too many are.
    [[nodiscard]] Open open(const std::filesystem::path& path, const Place& place);

    /// Counts one more name of a file.
    void count(const Place& place);

    /// Counts bytes that are read, or made of what is read.
    ///
    /// source: what they are of; there: the bytes that it has, which count when it is met for the first time
    void take(const std::string& source, std::size_t there, std::size_t taken, const Place& place);

    /// A text that is the same for all paths of a file.
    [[nodiscard]] static std::string identity(const std::filesystem::path& path);

    /// Counts a file that is read as a whole.
    void take_file(const std::filesystem::path& path, const Place& place);

private:
    struct Opened {
        std::string identity, name;
    };

    std::size_t most_;
    std::vector<Opened> open_;
    std::set<std::string> met_;
    std::size_t count_ = 0, there_ = 0, taken_ = 0;
};

}  // namespace subvol::detail
