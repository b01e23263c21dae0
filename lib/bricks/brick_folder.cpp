// SPDX-License-Identifier: Apache-2.0
#include "brick_folder.h"

#include <algorithm>

#include "brick_file.h"
#include "brick_index.h"
#include "output_file.h"
#include "subvol/error.h"
#include "text_scanner.h"

namespace subvol::detail {

namespace fs = std::filesystem;

namespace {

constexpr const char* kProgress = "progress.json";
constexpr std::uint64_t kBytesOfCell = 1000;  // topology, kernels and the halo of a brick while it is worked on

[[noreturn]] void fail(const fs::path& path, const std::error_code& error) {
    throw Error(ErrorCode::Io, "cannot be written: " + error.message(), path.string());
}

fs::path with_suffix(const fs::path& folder, const char* suffix) {
    fs::path name = folder;
    if (!name.has_filename()) name = name.parent_path();  // "a.bricks/"
    return name += suffix;
}

/// Gives a folder the name of another, which is removed only when that has been done.
void replace_folder(const fs::path& made, const fs::path& folder) {
    std::error_code error, ignored;
    fs::path old;
    if (fs::exists(folder, ignored)) {
        for (int k = 0; old.empty() || fs::exists(old, ignored); ++k)
            old = with_suffix(folder, (".old" + std::to_string(k)).c_str());
        fs::rename(folder, old, error);
        if (error) fail(folder, error);
    }
    fs::rename(made, folder, error);
    if (error) {
        if (!old.empty()) fs::rename(old, folder, ignored);
        fail(folder, error);
    }
    if (!old.empty()) fs::remove_all(old, ignored);
}

}  // namespace

void check_target(const fs::path& folder) {
    const fs::path target = with_suffix(folder, ""), above = target.parent_path();
    std::error_code error;
    if (fs::exists(target, error) && !is_bricks(target)) {
        throw Error(ErrorCode::InvalidInput, "exists and is no folder of bricks", target.string(), "another name");
    }
    if (!above.empty() && !fs::is_directory(above, error)) {
        throw Error(ErrorCode::Io, "the folder \"" + above.string() + "\" does not exist", target.string());
    }
}

BricksWriter::BricksWriter(fs::path folder, std::uint64_t id, int halo_layers)
    : folder_(with_suffix(folder, "")), work_(with_suffix(folder, ".unfinished")) {
    check_target(folder_);
    std::error_code error;
    const fs::path progress = work_ / kProgress;
    if (fs::exists(work_, error) && !fs::is_empty(work_, error)) {  // empty: ended before it had written anything
        if (!fs::is_regular_file(progress, error)) {
            throw Error(ErrorCode::InvalidInput, "exists and is no unfinished folder of bricks", work_.string(),
                        "remove it, or use another name");
        }
        try {
            done_ = bricks_from_json(read_text(progress), progress.string());
        } catch (const Error&) {
            done_ = {};  // the first brick had not been finished
        }
        if (done_.id != id || done_.halo_layers != halo_layers) {
            done_ = {};
            fs::remove_all(work_, error);
        }
    }
    fs::create_directories(work_, error);
    if (error) fail(work_, error);
    done_.id = id;
    done_.halo_layers = halo_layers;
    try {
        save_progress();
    } catch (...) {
        fs::remove(work_, error);  // if it is empty
        throw;
    }
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
    if (fs::file_size(work_ / name, error) == done->bytes && !error && hash_of_file(work_ / name) == done->hash) {
        ++result_.kept;
        return true;
    }
    done_.bricks.erase(done);
    return false;
}

void BricksWriter::write(std::size_t k, const BrickMesh& brick) {
    Brick about = describe(brick);
    about.file = brick_name(k);
    const WrittenBrick written = write_brick_file(work_ / about.file, brick, done_.id);
    about.bytes = written.bytes;
    about.hash = written.hash;
    ++result_.written;
    result_.bytes += written.bytes;
    done_.bricks.push_back(std::move(about));
    // Each time all bricks are written down: of many, a killed run may lose one in a hundred.
    if (done_.bricks.size() > saved_ + saved_ / 128) save_progress();
}

SplitResult BricksWriter::finish() {
    std::ranges::sort(done_.bricks, {}, &Brick::file);
    sum_up(done_);
    const std::string index = bricks_to_json(done_);
    write_text_file(work_ / kBricksIndex, index);
    result_.bytes += index.size();
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(work_, error)) {  // what killed runs have left behind
        const std::string name = entry.path().filename().string();
        const bool ours = name == kBricksIndex || std::ranges::binary_search(done_.bricks, name, {}, &Brick::file);
        std::error_code ignored;
        if (!ours) fs::remove(entry.path(), ignored);
    }
    replace_folder(work_, folder_);
    result_.bricks = open_bricks(folder_);
    return std::move(result_);
}

void check_options(const SplitOptions& options) {
    if (options.halo_layers < 1 || options.halo_layers > kMostHaloLayers) {
        throw Error(ErrorCode::InvalidInput, "layers of halo: " + std::to_string(options.halo_layers), {}, "1 to 16");
    }
    if (options.bricks > kMostBricks) {
        throw Error(ErrorCode::InvalidInput, std::to_string(options.bricks) + " bricks are too many", {}, "at most a million");
    }
    if (options.bricks == 0 && options.memory_bytes < 1000 * kBytesOfCell) {
        throw Error(ErrorCode::InvalidInput, std::to_string(options.memory_bytes) + " bytes are too few for a brick", {},
                    "1M or more");
    }
}

std::size_t brick_count(std::uint64_t cells, const SplitOptions& options) {
    if (options.bricks > 0) return options.bricks;
    const std::uint64_t most = options.memory_bytes / kBytesOfCell;
    return static_cast<std::size_t>(std::max<std::uint64_t>(1, (cells + most - 1) / most));
}

}  // namespace subvol::detail
