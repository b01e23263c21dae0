// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace subvol::detail {

/// Remembers a temporary file while it exists, so that a program that must end at once can remove it.
///
/// with_folder: its folder was made for it alone
class UnfinishedFile {
public:
    UnfinishedFile(const std::filesystem::path& file, bool with_folder);
    ~UnfinishedFile();
    UnfinishedFile(const UnfinishedFile&) = delete;
    UnfinishedFile& operator=(const UnfinishedFile&) = delete;

    struct Place;

private:
    Place* place_ = nullptr;  // null: there are thousands already, or the name is too long
};

/// Removes all files that are remembered. May be called by a signal's handler; the program should end after it.
void remove_unfinished_files() noexcept;

/// Makes `remove_unfinished_files` call another one: that of a module, which has its own copy of this library and its own
/// files.
void remove_unfinished_files_of(void (*module)() noexcept);

/// Where a file is written that a user names.
struct OutputPlace {
    std::filesystem::path file;  ///< the name, with symbolic links followed to their end, whether there is a file or not
    /// A device, a pipe, or a link to an open file, such as /dev/stdout: it takes bytes, and nothing can replace it
    bool stream = false;
};

/// throws: Error(Io) if links go round in a circle
[[nodiscard]] OutputPlace output_place(const std::filesystem::path& target);

/// `output_place`, and whether a file can be written there: so that nothing is computed in vain.
///
/// throws: Error(Io) as `output_place`; if the folder of the file does not exist or no file can be made in it, if the file is a
///         folder, or if there is a file that this process may not write to
[[nodiscard]] OutputPlace writable_place(const std::filesystem::path& target);

/// Whether a file that is committed is there after a loss of power: from then on, or once `sync_files_in` has been called for
/// its folder, which costs less for many files.
enum class Sync { Now, Later };

/// A file that appears complete or not at all: write to `path()`, then `commit()` gives it its final name. Without a commit the
/// destructor removes it.
///
/// The temporary file lies beside the final one, exists from the beginning, and has a name of its own that cannot be foreseen,
/// so that several threads may write one target: the last one stays. The name keeps the extension, which some libraries use to
/// choose the format. A file that is replaced leaves its permissions to the new one, and where that is allowed its owner, its
/// group and its access control list; until then nobody else can read the new one.
///
/// A symbolic link stays as it is, as with cp: the file that it points to is replaced, by a temporary file in that file's
/// folder. Other names of that file (hard links) keep the old content. A device or a pipe gets the bytes of the complete file,
/// which is first written to the folder for temporary files: most formats are not written from front to back.
class AtomicFile {
public:
    /// throws: Error(Io) as `writable_place`
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }

    /// The file, empty, as a stream that the caller closes. throws: Error(Io)
    [[nodiscard]] std::FILE* open() const;

    /// throws: Error(Io) if the rename fails, the disk does not take the file, or the device or pipe does not take all bytes
    void commit(Sync sync = Sync::Now);

private:
    std::filesystem::path target_;
    OutputPlace place_;
    std::filesystem::path temporary_;
    std::optional<UnfinishedFile> unfinished_;
    bool committed_ = false;
};

/// A file that is needed for a while, in a folder of its own that nobody else can write to; both are removed at the end.
class TemporaryFile {
public:
    /// name: of the file, which others may show; throws: Error(Io)
    explicit TemporaryFile(const std::string& name);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    /// There is no file yet.
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
    UnfinishedFile unfinished_;
};

/// Whether a file has a name as AtomicFile gives to temporary files: a process that was killed leaves one behind.
[[nodiscard]] bool is_temporary_name(std::string_view name);

/// Gives a file or folder the permissions, and where that is allowed the owner, the group and the access control list, of the
/// one that it replaces.
///
/// returns: false if there is nothing that it replaces; throws: Error(Io) if `to` cannot be opened
bool keep_access(const std::filesystem::path& from, const std::filesystem::path& to);

/// Waits until everything in a folder, and on its file system, is on the disk. throws: Error(Io)
void sync_files_in(const std::filesystem::path& folder);

/// Writes a text to a temporary file, then renames it.
///
/// throws: Error(Io)
void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace subvol::detail
