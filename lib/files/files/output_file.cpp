// SPDX-License-Identifier: Apache-2.0
// A file that appears complete or not at all. Links of the target are followed to their end; then
//
//     a file      a temporary file beside it → access rights of the file that is there → fsync → rename → fsync of the folder
//     a stream    a temporary file in a private folder → its bytes are appended to the device or pipe → it is removed
//
// The syncs can be left for later, for all files of a folder together. A temporary file that will replace another one can be
// read by its owner alone until it gets its rights. Its name has 64 random bits and keeps the extension.
//
// The name of each temporary file is noted before the file is made, so that a signal's handler can remove what is unfinished.
// The notes are blocks of places with an atomic state each (free, changing, held): there are no locks, and blocks are added but
// never removed, so a handler may walk along them at any time. Files are removed first, then the folders that were made for
// them.
#ifdef __linux__
#endif
#include "subvol/detail/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/xattr.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "subvol/detail/byte_hash.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kPlaces = 64, kMostBlocks = 64, kLongestName = 4096;

// A handler of signals may interrupt anything, so there are no locks: a place is free, being changed, or holds a whole name,
// and blocks of places are added but never removed.
enum class State { Free, Changing, Held };

}  // namespace

struct UnfinishedFile::Place {
    std::atomic<State> state = State::Free;
    std::array<char, kLongestName> file{};
    std::array<char, kLongestName> folder{};  // empty: not to be removed
};
static_assert(std::atomic<State>::is_always_lock_free);

namespace {

struct Block {
    std::array<UnfinishedFile::Place, kPlaces> places{};
    std::atomic<Block*> next = nullptr;
};

Block first_block;
std::atomic<void (*)() noexcept> of_module = nullptr;

void put(const std::string& name, std::array<char, kLongestName>& to) {
    *std::ranges::copy(name, to.begin()).out = '\0';
}

/// The block after this one, which is made if there is none.
Block* block_after(Block& block) {
    if (Block* const next = block.next) return next;
    auto made = std::make_unique<Block>();
    Block* none = nullptr;
    if (!block.next.compare_exchange_strong(none, made.get())) return none;  // another thread was faster
    return made.release();
}

}  // namespace

UnfinishedFile::UnfinishedFile(const std::filesystem::path& file, bool with_folder) {
    const std::string name = file.string(), folder = with_folder ? file.parent_path().string() : "";
    if (name.size() >= kLongestName) return;
    Block* block = &first_block;
    for (std::size_t b = 0; b < kMostBlocks; ++b, block = block_after(*block)) {
        for (Place& place : block->places) {
            State free = State::Free;
            if (!place.state.compare_exchange_strong(free, State::Changing)) continue;
            put(name, place.file);
            put(folder, place.folder);
            place.state = State::Held;
            place_ = &place;
            return;
        }
    }
}

UnfinishedFile::~UnfinishedFile() {
    if (place_ != nullptr) place_->state = State::Free;
}

void remove_unfinished_files() noexcept {
    const auto for_each_held = [](const auto& remove) {
        for (const Block* block = &first_block; block != nullptr; block = block->next) {
            for (const UnfinishedFile::Place& place : block->places) {
                if (place.state == State::Held) remove(place);
            }
        }
    };
    for_each_held([](const UnfinishedFile::Place& place) { (void)unlink(place.file.data()); });
    // A folder is removed once it is empty: files of other places may have been in it.
    for_each_held([](const UnfinishedFile::Place& place) {
        if (place.folder[0] != '\0') (void)rmdir(place.folder.data());
    });
    if (auto* const remove_others = of_module.load()) remove_others();
}

void remove_unfinished_files_of(void (*module)() noexcept) {
    of_module = module;
}

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

/// A file that is open as long as this is.
class OpenFile {
public:
    OpenFile(const fs::path& path, int flags) : file_(::open(path.c_str(), flags | O_CLOEXEC)) {}
    ~OpenFile() {
        if (file_ >= 0) ::close(file_);
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;

    [[nodiscard]] int number() const { return file_; }

private:
    int file_;
};

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

constexpr std::string_view kTemporary = ".subvol-";
constexpr std::size_t kLongestExtension = 16;

/// A name that nobody can foresee, and that is short, however long the name of the file is. The extension stays: it decides the
/// format.
std::string temporary_name(const std::string& extension) {
    std::random_device random;
    const std::uint64_t bits = std::uint64_t{random()} << 32 | random();
    return std::string(kTemporary) + hex_digits(bits) + (extension.size() <= kLongestExtension ? extension : std::string());
}

/// The access control list of a file, on Linux: who else may read it. A new file may have one from its folder.
void keep_list([[maybe_unused]] const fs::path& from, [[maybe_unused]] int to) {
#ifdef __linux__
    constexpr const char* kList = "system.posix_acl_access";
    std::array<char, 4096> list{};
    const ssize_t bytes = ::getxattr(from.c_str(), kList, list.data(), list.size());
    if (bytes > 0) {
        (void)::fsetxattr(to, kList, list.data(), static_cast<std::size_t>(bytes), 0);
    } else if (bytes < 0 && errno == ENODATA) {
        (void)::fremovexattr(to, kList);
    }
#endif
}

/// As the function of two paths; `to` is open.
bool keep_access(const fs::path& from, int to) {
    struct stat before {};
    struct stat made {};
    if (::stat(from.c_str(), &before) != 0) return false;
    if (::fstat(to, &made) != 0) return true;
    mode_t mode = before.st_mode & (S_ISDIR(made.st_mode) ? 07777 : 0777);
    if (made.st_gid != before.st_gid && ::fchown(to, static_cast<uid_t>(-1), before.st_gid) != 0) {
        mode = (mode & ~070U) | (mode & 070U & (mode << 3));  // another group gets no more than everybody
    } else {
        keep_list(from, to);
    }
    if (made.st_uid != before.st_uid) (void)!::fchown(to, before.st_uid, static_cast<gid_t>(-1));
    (void)::fchmod(to, mode);  // where it fails, the file stays one that only its owner may read
    return true;
}

/// Whether this process may do something with a file, as it is now: as root, everything.
bool may(const fs::path& path, int what) {
    return ::faccessat(AT_FDCWD, path.c_str(), what, AT_EACCESS) == 0;
}

/// Whether a file is in a folder such as /tmp, where only its owner, the folder's and root may replace it, and this is another
/// user.
bool is_kept_by_its_folder(const fs::path& file) {
    struct stat folder {};
    struct stat about {};
    if (::stat(folder_of(file).c_str(), &folder) != 0 || ::stat(file.c_str(), &about) != 0) return false;
    const uid_t user = ::geteuid();
    return (folder.st_mode & S_ISVTX) != 0 && user != 0 && user != folder.st_uid && user != about.st_uid;
}

}  // namespace

bool keep_access(const fs::path& from, const fs::path& to) {
    const OpenFile made(to, O_RDONLY | O_NOFOLLOW);
    if (made.number() < 0) fail_to_write(to, {errno, std::generic_category()});
    return keep_access(from, made.number());
}

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

OutputPlace writable_place(const fs::path& target) {
    OutputPlace place = output_place(target);
    if (place.stream) return place;
    std::error_code error;
    const fs::path folder = folder_of(place.file);
    if (!fs::is_directory(folder, error)) {
        throw Error(ErrorCode::Io, "the folder \"" + folder.string() + "\" does not exist", target.string());
    }
    const fs::file_status status = fs::status(place.file, error);
    if (status.type() == fs::file_type::none) fail_to_write(target, error);  // its name is too long, for example
    if (fs::is_directory(status)) throw Error(ErrorCode::Io, "is a folder; a file name is needed", target.string());
    if (!may(folder, W_OK | X_OK)) {
        throw Error(ErrorCode::Io,
                    "cannot be written: no file can be made in its folder: " + std::generic_category().message(errno),
                    target.string());
    }
    if (fs::exists(status) && !may(place.file, W_OK)) {
        throw Error(ErrorCode::Io, "cannot be written: the file that is there is read-only", target.string(),
                    "another name, or chmod u+w");
    }
    if (fs::exists(status) && is_kept_by_its_folder(place.file)) {
        throw Error(ErrorCode::Io, "cannot be written: only its owner may replace a file of this folder", target.string(),
                    "another name");
    }
    return place;
}

bool is_temporary_name(std::string_view name) {
    constexpr std::size_t kDigits = 16;
    if (!name.starts_with(kTemporary)) return false;
    const std::string_view digits = name.substr(kTemporary.size()).substr(0, kDigits);
    const std::string_view extension = name.substr(kTemporary.size() + digits.size());
    return digits.size() == kDigits && digits.find_first_not_of("0123456789abcdef") == std::string_view::npos &&
           (extension.empty() || extension.front() == '.') && extension.size() <= kLongestExtension;
}

void sync_files_in(const fs::path& folder) {
    const OpenFile opened(folder, O_RDONLY | O_DIRECTORY);
    if (opened.number() < 0) return;
#ifdef __linux__
    if (::syncfs(opened.number()) == 0 || errno == ENOSYS) return;
    if (errno == EIO || errno == ENOSPC || errno == EDQUOT) fail_to_write(folder, {errno, std::generic_category()});
#else
    ::sync();
#endif
}

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)), place_(writable_place(target_)) {
    std::error_code error;
    const fs::path folder = place_.stream ? make_private_folder(target_) : folder_of(place_.file);
    // What replaces a file that others may not read is never readable for them. Nobody else can have made the file, and a link
    // is not followed.
    const mode_t mode = place_.stream || fs::exists(place_.file, error) ? 0600 : 0666;
    int file = -1;
    do {
        temporary_ = folder / temporary_name(target_.extension().string());
        unfinished_.emplace(temporary_, place_.stream);
        file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    } while (file < 0 && errno == EEXIST);
    if (file < 0) {
        const std::error_code why(errno, std::generic_category());
        if (place_.stream) fs::remove(folder, error);
        fail_to_write(target_, why);
    }
    ::close(file);
}

AtomicFile::~AtomicFile() {
    if (committed_) return;
    std::error_code ignored;
    fs::remove(temporary_, ignored);
    if (place_.stream) fs::remove(temporary_.parent_path(), ignored);
}

std::FILE* AtomicFile::open() const {
    const int file = ::open(temporary_.c_str(), O_WRONLY | O_TRUNC | O_NOFOLLOW | O_CLOEXEC);
    std::FILE* const stream = file < 0 ? nullptr : ::fdopen(file, "wb");
    if (stream == nullptr) fail_to_write(target_, {errno, std::generic_category()});
    return stream;
}

void AtomicFile::commit(Sync sync) {
    if (place_.stream) return append_bytes(temporary_, place_.file, target_);  // the destructor removes the temporary file
    {
        // Opened again: whoever wrote to the path may have put another file there.
        const OpenFile written(temporary_, O_RDONLY | O_NOFOLLOW);
        if (written.number() < 0) fail_to_write(target_, {errno, std::generic_category()});
        (void)keep_access(place_.file, written.number());
        // Some file systems have nothing to sync.
        const bool synced = sync == Sync::Later || ::fsync(written.number()) == 0 || errno == EINVAL || errno == ENOTSUP;
        if (!synced) fail_to_write(target_, {errno, std::generic_category()});
    }
    std::error_code error;
    fs::rename(temporary_, place_.file, error);
    if (error) fail_to_write(target_, error);
    committed_ = true;
    if (sync == Sync::Later) return;
    if (const OpenFile folder(folder_of(place_.file), O_RDONLY | O_DIRECTORY); folder.number() >= 0) {
        (void)::fsync(folder.number());  // the new name; without it the old file would be there after a loss of power
    }
}

TemporaryFile::TemporaryFile(const std::string& name)
    : path_(make_private_folder(name) / name), unfinished_(path_, /*with_folder=*/true) {
}

TemporaryFile::~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
    fs::remove(path_.parent_path(), ignored);
}

OutputFile::OutputFile(const std::filesystem::path& target) : target_(target), file_(target), stream_(file_.open()) {
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

void OutputFile::commit(Sync sync) {
    close();
    file_.commit(sync);
}

void OutputFile::fail(int error) const {
    throw Error(ErrorCode::Io, "cannot be written: " + std::generic_category().message(error), target_.string());
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
    OutputFile out(file);
    out.write(text);
    out.commit();
}

std::string glb_head(std::string json, std::size_t bytes) {
    json.append((4 - json.size() % 4) % 4, ' ');
    std::string head;
    const auto put = [&](std::size_t number) {
        for (int byte = 0; byte < 4; ++byte) head += static_cast<char>(number >> (8 * byte) & 0xFF);
    };
    constexpr std::uint32_t kGltf = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBin = 0x004E4942;  // "glTF", "JSON", "BIN"
    put(kGltf);
    put(kVersion);
    put(12 + 8 + json.size() + 8 + bytes);
    put(json.size());
    put(kJson);
    head += json;
    put(bytes);
    put(kBin);
    return head;
}

}  // namespace subvol::detail
