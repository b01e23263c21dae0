// SPDX-License-Identifier: Apache-2.0
#include "brick_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <functional>

#include "brick_file.h"
#include "brick_index.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/option.h"

// How a folder of bricks appears whole or not at all:
//
//      big.bricks.unfinished/     brick_00000.vtu …    each with its hash in progress.json, saved from time to time
//                │                progress.json        (a killed run is continued: bricks with the right hash are kept)
//                │ all bricks are there
//                ▼
//                                 index.json           written last
//      big.bricks/  ◀── renamed; a folder of bricks that was there is removed file by file, and only if it holds nothing but
//                       its index and the bricks that this lists

namespace subvol::detail {

namespace fs = std::filesystem;

namespace {

constexpr const char* kProgress = "progress.json";
constexpr std::uint64_t kBytesOfCell = 1000;  // topology, kernels and the halo of a brick while it is worked on

[[noreturn]] void fail(const fs::path& path, const std::error_code& error) {
    throw Error(ErrorCode::Io, "cannot be written: " + error.message(), path.string());
}

fs::path with_suffix(const fs::path& folder, const std::string& suffix) {
    fs::path name = folder;
    if (!name.has_filename()) name = name.parent_path();  // "a.bricks/"
    return name += suffix;
}

/// Where a folder lies or will lie: what a link points to is filled, the link stays.
fs::path place_of(const fs::path& folder) {
    fs::path place = output_place(with_suffix(folder, "")).file;
    std::error_code error;
    if (fs::exists(place, error)) place = fs::canonical(place, error);  // "." and ".." cannot take a suffix
    if (error) fail(folder, error);
    return place;
}

/// Calls `look` for the name of everything in a folder, and whether that is a plain file: no folder, and no link.
template <class Look>
void for_each_entry(const fs::path& folder, const Look& look) {
    std::error_code error;
    auto entry = fs::directory_iterator(folder, error);
    while (!error && entry != fs::directory_iterator()) {
        const bool plain = entry->symlink_status(error).type() == fs::file_type::regular;
        if (!error) look(entry->path().filename().string(), plain);
        if (!error) entry.increment(error);
    }
    if (error) fail(folder, error);
}

bool is_plain_file(const fs::path& file) {
    std::error_code error;
    return fs::symlink_status(file, error).type() == fs::file_type::regular;
}

/// The names of the files of a folder of bricks, sorted: the index and what it lists, whether that is there or not.
///
/// throws: Error(InvalidInput) if it is not a folder of bricks, or holds anything else
std::vector<std::string> files_of_bricks(const fs::path& folder) {
    const auto refuse = [&](const std::string& why, const std::string& hint) {
        throw Error(ErrorCode::InvalidInput, "exists and " + why, folder.string(), hint);
    };
    if (!is_plain_file(folder / kBricksIndex)) refuse("is not a folder of bricks", "another name");
    std::vector<std::string> names{kBricksIndex};
    try {
        const std::string index = (folder / kBricksIndex).string();
        for (Brick& brick : bricks_from_json(read_text(index), index).bricks) names.push_back(std::move(brick.file));
    } catch (const Error&) {
        refuse("is not a folder of bricks: this program has not written its index.json", "another name");
    }
    std::ranges::sort(names);
    for_each_entry(folder, [&](const std::string& name, bool plain) {
        if (!plain || !std::ranges::binary_search(names, name)) {
            refuse("holds " + in_quotes(name) + ", which is none of its bricks", "move that away, or use another name");
        }
    });
    return names;
}

/// Gives a folder the name of another, which must hold bricks only, and is removed when that has been done.
void replace_folder(const fs::path& made, const fs::path& folder) {
    std::error_code error, ignored;
    fs::path old;
    std::vector<std::string> names;
    if (fs::exists(folder, ignored)) {
        names = files_of_bricks(folder);  // once more: something may have been put there meanwhile
        for_each_entry(made, [&](const std::string& name, bool) {
            if (!keep_access(folder / name, made / name)) (void)keep_access(folder / kBricksIndex, made / name);
        });
        (void)keep_access(folder, made);
        for (int k = 0; old.empty() || fs::exists(fs::symlink_status(old, ignored)); ++k)
            old = with_suffix(folder, ".old" + std::to_string(k));
        // The finished folder takes the name by two renames, each of which is atomic: whoever opens the name finds the old
        // bricks, none for an instant, or the new ones, but never a mixture.
        fs::rename(folder, old, error);
        if (error) fail(folder, error);
    }
    fs::rename(made, folder, error);
    if (error) {
        // The old folder gets its name back, as if nothing had been done.
        if (!old.empty()) fs::rename(old, folder, ignored);
        fail(folder, error);
    }
    if (old.empty()) return;
    for (const std::string& name : names) fs::remove(old / name, ignored);
    if (::rmdir(old.c_str()) != 0) {
        throw Error(ErrorCode::Io, "is written, but not all of what was there before could be removed", folder.string(),
                    "the rest is in " + old.string());
    }
}

}  // namespace

void check_target(const fs::path& folder) {
    // What can be checked of the last step is checked before the first brick is made, because a split may take hours.
    const fs::path target = place_of(folder), above = target.parent_path();
    if (target.empty()) throw Error(ErrorCode::InvalidInput, "the folder of bricks has no name");
    std::error_code error;
    const fs::file_status status = fs::status(target, error);
    if (status.type() == fs::file_type::none) fail(target, error);
    if (fs::exists(status)) (void)files_of_bricks(target);
    if (fs::exists(status) && ::access(target.c_str(), W_OK | X_OK) != 0) fail(target, {errno, std::generic_category()});
    if (!above.empty() && !fs::is_directory(above, error)) {
        throw Error(ErrorCode::Io, "the folder \"" + above.string() + "\" does not exist", target.string());
    }
}

BricksWriter::BricksWriter(fs::path folder, std::uint64_t id, int halo_layers)
    : folder_(with_suffix(folder, "")), place_(place_of(folder_)), work_(with_suffix(place_, ".unfinished")) {
    check_target(folder_);
    std::error_code error;
    // An unfinished folder of an earlier run is continued, so that a killed split loses little.
    if (fs::exists(fs::symlink_status(work_, error))) {
        take_up(id, halo_layers);
    } else {
        fs::create_directory(work_, error);
        if (error) fail(work_, error);
        (void)keep_access(place_, work_);  // from the beginning
    }
    done_.id = id;
    done_.halo_layers = halo_layers;
    try {
        save_progress();
    } catch (...) {
        (void)::rmdir(work_.c_str());  // if it is empty
        throw;
    }
}

void BricksWriter::take_up(std::uint64_t id, int halo_layers) {
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorCode::InvalidInput, "exists and " + why, work_.string(), "move it away, or use another name");
    };
    std::error_code error;
    if (fs::symlink_status(work_, error).type() != fs::file_type::directory) refuse("is not an unfinished folder of bricks");
    // The list of what has been done: of a run that ended while the folder got its name, the index.
    std::vector<std::string> lists, bricks;
    for_each_entry(work_, [&](const std::string& name, bool plain) {
        if (plain && (name == kProgress || name == kBricksIndex)) {
            lists.push_back(name);
        } else if (plain && is_brick_name(name)) {
            bricks.push_back(name);
        } else if (!plain || !is_temporary_name(name)) {
            refuse("is not an unfinished folder of bricks: it holds " + in_quotes(name));
        }
    });
    if (lists.empty() && bricks.empty()) return;  // ended before it had written anything
    std::ranges::sort(lists, std::greater());     // the progress first
    try {
        const fs::path list = work_ / lists.at(0);
        done_ = bricks_from_json(read_text(list), list.string(), /*unfinished=*/true);
    } catch (const std::exception&) {
        refuse("is not an unfinished folder of bricks");
    }
    std::ranges::sort(done_.bricks, {}, &Brick::file);
    for (const std::string& name : bricks) {  // also those that were written after the list
        const bool listed = std::ranges::binary_search(done_.bricks, name, {}, &Brick::file);
        if (!listed && !is_brick_of(work_ / name, done_.id)) {
            refuse("is not an unfinished folder of bricks: it holds " + in_quotes(name) + " of another mesh");
        }
    }
    // The same mesh, cut in the same way: its bricks stay. Otherwise they are of no use, and since all of them are known to be
    // bricks of one split, they may be removed.
    if (done_.id == id && done_.halo_layers == halo_layers) return;
    if (lists.front() == kBricksIndex) refuse("is a finished folder of bricks");  // somebody's, whose name happens to be this
    for (const std::string& name : bricks) fs::remove(work_ / name, error);
    for (const std::string& name : lists) fs::remove(work_ / name, error);
    done_ = {};
}

void BricksWriter::save_progress() {
    Bricks all = done_;
    sum_up(all);
    write_text_file(work_ / kProgress, bricks_to_json(all));
    saved_ = done_.bricks.size();
}

bool BricksWriter::keeps(std::size_t k) {
    const std::string name = brick_name(k);
    const auto done = std::ranges::find(done_.bricks, name, &Brick::file);
    if (done == done_.bricks.end()) return false;
    std::error_code error;
    // The size is compared first, because it costs nothing; only a file of the right size is read for its hash.
    if (fs::file_size(work_ / name, error) == done->bytes && !error && hash_of_file(work_ / name) == done->hash) {
        ++result_.kept;
        return true;
    }
    done_.bricks.erase(done);
    return false;
}

void BricksWriter::write(std::size_t k, const MeshPiece& brick) {
    Brick about = describe(brick);
    about.file = brick_name(k);
    const WrittenBrick written = write_brick_file(work_ / about.file, brick, done_.id);
    about.bytes = written.bytes;
    about.hash = written.hash;
    ++result_.written;
    result_.bytes += written.bytes;
    done_.bricks.push_back(std::move(about));
    // Saving rewrites the whole list, so it is not done for every brick but whenever it has grown by 1/128. The work is then
    // linear in the number of bricks, and a killed run loses less than one brick in a hundred.
    if (done_.bricks.size() > saved_ + saved_ / 128) save_progress();
}

SplitResult BricksWriter::finish() {
    std::ranges::sort(done_.bricks, {}, &Brick::file);
    sum_up(done_);
    const std::string index = bricks_to_json(done_);
    write_text_file(work_ / kBricksIndex, index);
    result_.bytes += index.size();
    std::vector<std::string> left;  // by this run, and by those that were killed
    for_each_entry(work_, [&](const std::string& name, bool plain) {
        if (plain && (name == kBricksIndex || std::ranges::binary_search(done_.bricks, name, {}, &Brick::file))) return;
        if (!plain || (name != kProgress && !is_temporary_name(name))) {
            throw Error(ErrorCode::InvalidInput, "holds " + in_quotes(name) + ", which this split has not written",
                        work_.string(), "move that away and split again: finished bricks are kept");
        }
        left.push_back(name);
    });
    std::error_code ignored;
    for (const std::string& name : left) fs::remove(work_ / name, ignored);
    // The bytes must be on the disk before the name is: a loss of power then leaves an unfinished folder, but no damaged one.
    sync_files_in(work_);
    replace_folder(work_, place_);
    result_.bricks = open_bricks(place_);
    result_.bricks.path = folder_;
    return std::move(result_);
}

void check_options(const SplitOptions& options) {
    subvol::check_options(options);
    if (options.bricks == 0 && options.memory_bytes < 1000 * kBytesOfCell) {
        throw Error(ErrorCode::InvalidInput, std::to_string(options.memory_bytes) + " bytes are too few for a brick", {},
                    "1M or more");
    }
}

std::size_t brick_count(std::uint64_t cells, const SplitOptions& options) {
    if (options.bricks > 0) return options.bricks;
    // Owned cells are counted; kBytesOfCell includes what their halo takes.
    const std::uint64_t most = options.memory_bytes / kBytesOfCell;
    return static_cast<std::size_t>(std::max<std::uint64_t>(1, (cells + most - 1) / most));
}

}  // namespace subvol::detail

namespace subvol {

std::vector<Option> options_of(SplitOptions& options) {
    return {
        Option("bricks", options.bricks).between(1, detail::kMostBricks).or_none().help("N", "how many bricks"),
        Option("memory", options.memory_bytes)
            .bytes()
            .help("BYTES", "instead: bricks so small that a command takes about this much for one (default 1G)")
            .instead_of({"bricks"}),
        Option("halo", options.halo_layers)
            .between(1, detail::kMostHaloLayers)
            .help("N", "layers of cells about each brick; kernels of cc and bsxw need 4, and --correction full one more"),
        Option("by", options.shape).help("SHAPE", "blocks (compact), slabs (slices of the longest side), random (for tests)")};
}

}  // namespace subvol
