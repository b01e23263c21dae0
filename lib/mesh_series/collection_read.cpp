// SPDX-License-Identifier: Apache-2.0
// One mesh of the files that a collection names.

#include <algorithm>

#include "assemble.h"
#include "collection.h"
#include "format_table.h"
#include "join_pieces.h"
#include "steps.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr int kMostLists = 8;  // in lists
constexpr std::size_t kMostFiles = 100000;
constexpr std::array<std::string_view, 3> kSurfaces{".VTP", ".PVTP", ".STL"};
constexpr EntityNames kPieceNames{"point", "cell", 0};

// The files that are no lists, in the order of the lists. extension: in capitals
void expand(const ListedFile& file, int depth, std::vector<ListedFile>& files) {
    const std::string extension = upper_case(file.path.extension().string());
    const bool blocks = extension == ".VTM";
    if (!blocks && !extension.starts_with(".PVT")) {
        if (files.size() == kMostFiles) {
            throw Error(ErrorCode::InvalidInput, "there are more than " + std::to_string(kMostFiles) + " files", file.place);
        }
        files.push_back(file);
        return;
    }
    if (std::ranges::find(kSurfaces, extension) != kSurfaces.end()) return files.push_back(file);
    if (depth == kMostLists) {
        throw Error(ErrorCode::InvalidInput, "lists in lists, more than " + std::to_string(kMostLists) + " deep", file.place,
                    "a list must not name itself");
    }
    const Collection inner = blocks ? read_blocks_list(file.path) : read_pieces_list(file.path);
    for (ListedFile next : inner.files.front()) {
        if (!file.block.empty()) next.block = file.block + (next.block.empty() ? "" : "/" + next.block);
        expand(next, depth + 1, files);
    }
}

std::size_t cells_of(const MeshFile& found) {
    std::size_t count = 0;
    each_kind(found, [&](const auto& cells) { count += cells.corners.size(); });
    return count;
}

// Leaves out the files of blocks that are not chosen, and surfaces.
PartFiles chosen_files(std::vector<ListedFile> files, std::string_view list, const ReadOptions& options) {
    std::vector<std::string> names;
    for (const ListedFile& file : files) {
        if (!file.block.empty()) names.push_back(file.block);
    }
    const BlockChoice choice(options.blocks, names, list);
    PartFiles chosen{{}, names.empty() ? "piece" : "block", {}};
    std::size_t surfaces = 0;
    for (ListedFile& file : files) {
        if (!choice.takes(file.block)) continue;
        const std::string extension = upper_case(file.path.extension().string());
        if (std::ranges::find(kSurfaces, extension) != kSurfaces.end()) {
            ++surfaces;
        } else {
            chosen.files.push_back(std::move(file));
        }
    }
    if (surfaces > 0) chosen.warnings.push_back(counted(surfaces, "file", "files") + " of surfaces (.vtp) ignored");
    return chosen;
}

// Blocks that consist of several files are listed once.
void merge_blocks(std::vector<MeshBlock>& blocks) {
    std::vector<MeshBlock> merged;
    for (const MeshBlock& block : blocks) {
        const auto same = std::ranges::find(merged, block.name, &MeshBlock::name);
        if (same == merged.end()) {
            merged.push_back(block);
        } else {
            same->cells += block.cells;
        }
    }
    blocks = std::move(merged);
}

// The files of a step, and a warning if it is the last one because none was chosen.
std::vector<ListedFile> files_of_step(const std::string& list, const Collection& collection, const ReadOptions& options,
                                      std::vector<std::string>& warnings) {
    const std::size_t step = chosen_step(options, collection.times.size(), list, warnings);
    std::vector<ListedFile> files;
    for (const ListedFile& file : collection.files[step]) expand(file, 0, files);
    return files;
}

bool is_single(const std::vector<ListedFile>& files) {
    return files.size() == 1 && files.front().block.empty();
}

ReadResult read_step(const std::filesystem::path& path, const Collection& collection, const ReadOptions& options) {
    const std::string list = path.string();
    std::vector<std::string> warnings;
    std::vector<ListedFile> files = files_of_step(list, collection, options, warnings);
    ReadOptions of_file = options;
    of_file.step.reset();
    if (is_single(files)) {
        const MeshFormat& format = readable_format(files.front().path);
        check_options(format, files.front().path, of_file);
        ReadResult result = format.read(files.front().path, of_file);
        result.warnings.insert(result.warnings.begin(), warnings.begin(), warnings.end());
        return result;
    }
    const PartFiles chosen = chosen_files(std::move(files), list, options);
    warnings.insert(warnings.end(), chosen.warnings.begin(), chosen.warnings.end());
    std::vector<MeshFile> parts;
    for (const ListedFile& file : chosen.files) {
        MeshFile part = read_part(file, options);
        if (!part.points.empty()) parts.push_back(std::move(part));
    }
    if (parts.empty()) parts.emplace_back();
    MeshFile found = join_pieces(std::move(parts), chosen.word, list);
    if (cells_of(found) == 0) throw Error(ErrorCode::InvalidInput, "no hexahedra in any of its files", list);
    merge_blocks(found.blocks);
    found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
    return assemble(std::move(found), list, kPieceNames, of_file);
}

}  // namespace

const EntityNames& names_in_parts() {
    return kPieceNames;
}

std::optional<PartFiles> part_files(const std::filesystem::path& path, const ReadOptions& options) {
    const MeshFormat& format = readable_format(path);
    if (format.files == nullptr) return {};
    check_options(format, path, options);
    const std::string list = path.string();
    std::vector<std::string> warnings, none;
    if (!format.times) static_cast<void>(chosen_step(options, 1, list, none));
    std::vector<ListedFile> files = files_of_step(list, format.files(path), options, warnings);
    if (is_single(files)) return {};
    PartFiles chosen = chosen_files(std::move(files), list, options);
    chosen.warnings.insert(chosen.warnings.begin(), warnings.begin(), warnings.end());
    return chosen;
}

MeshFile read_part(const ListedFile& file, const ReadOptions& options) {
    const MeshFormat* format = format_of(file.path);
    if (format == nullptr || format->piece == nullptr) {
        throw Error(ErrorCode::InvalidInput, in_quotes(file.path.filename().string()) + " cannot be read as a part of a mesh",
                    file.place, ".vtu, .vts, .vtr and .vti files can");
    }
    MeshFile part = format->piece(read_text(file.path), file.path.string(), options);
    if (!file.block.empty() && !part.points.empty()) part.blocks = {{file.block, cells_of(part)}};
    return part;
}

ReadResult read_pvd_step(const std::filesystem::path& path, const ReadOptions& options) {
    return read_step(path, read_pvd(path), options);
}

ReadResult read_series_step(const std::filesystem::path& path, const ReadOptions& options) {
    return read_step(path, read_series_list(path), options);
}

ReadResult read_pieces(const std::filesystem::path& path, const ReadOptions& options) {
    return read_step(path, read_pieces_list(path), options);
}

ReadResult read_blocks(const std::filesystem::path& path, const ReadOptions& options) {
    return read_step(path, read_blocks_list(path), options);
}

}  // namespace subvol::detail
