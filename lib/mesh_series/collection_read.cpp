// SPDX-License-Identifier: Apache-2.0
// One mesh of the files that a collection names.

#include <algorithm>
#include <map>

#include "assemble.h"
#include "collection.h"
#include "format_table.h"
#include "join_pieces.h"
#include "named_files.h"
#include "steps.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::array<std::string_view, 3> kSurfaces{".VTP", ".PVTP", ".STL"};
constexpr EntityNames kPieceNames{"point", "cell", 0};

bool is_surface(const std::filesystem::path& path) {
    return std::ranges::find(kSurfaces, upper_case(path.extension().string())) != kSurfaces.end();
}

// The files of a list that are no lists of pieces or blocks, in the order of the lists. Each list is read once.
class ListExpansion {
public:
    explicit ListExpansion(NamedFiles& named) : named_(named) {}

    void expand(const ListedFile& file, std::vector<ListedFile>& files) {
        const auto place = [&] { return file.place; };
        named_.count(place);
        if (file.block.size() > kLongestBlock) {
            throw Error(ErrorCode::InvalidInput, "the name of a block is too long", file.place, kBlockLimit);
        }
        const std::string extension = upper_case(file.path.extension().string());
        const bool blocks = extension == ".VTM";
        if ((!blocks && !extension.starts_with(".PVT")) || is_surface(file.path)) return files.push_back(file);
        const auto open = named_.open(file.path, place);
        const auto [known, is_new] = lists_.try_emplace(file.path);
        if (is_new) known->second = (blocks ? read_blocks_list(file.path) : read_pieces_list(file.path)).files.front();
        for (ListedFile next : known->second) {
            if (!file.block.empty()) next.block = file.block + (next.block.empty() ? "" : "/" + next.block);
            expand(next, files);
        }
    }

private:
    NamedFiles& named_;
    std::map<std::filesystem::path, std::vector<ListedFile>> lists_;
};

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
        if (is_surface(file.path)) {
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
    std::map<std::string_view, std::size_t> places;
    for (const MeshBlock& block : blocks) {
        const auto [place, is_new] = places.try_emplace(block.name, merged.size());
        if (is_new) {
            merged.push_back(block);
        } else {
            merged[place->second].cells += block.cells;
        }
    }
    blocks = std::move(merged);
}

// The files of the chosen step.
//
// list:     the one that lists them
// warnings: that it is the last step because none was chosen
struct StepFiles {
    std::filesystem::path list;
    std::vector<ListedFile> files;
    std::vector<std::string> warnings;

    [[nodiscard]] bool is_single() const { return files.size() == 1 && files.front().block.empty(); }
};

// A step that is a single list is the last step of that one.
StepFiles files_of_step(const std::filesystem::path& path, const ReadOptions& options, NamedFiles& named) {
    StepFiles found{path, {}, {}};
    ReadOptions of_list = options;
    ListExpansion expansion(named);
    std::vector<NamedFiles::Open> open;
    std::string place;
    for (const MeshFormat* format = &readable_format(path); format != nullptr && format->files != nullptr;) {
        open.push_back(named.open(found.list, [&] { return place; }));
        check_options(*format, found.list, of_list);
        const Collection collection = format->files(found.list);
        const std::size_t step = chosen_step(of_list, collection.times.size(), found.list.string(), found.warnings);
        found.files.clear();
        for (const ListedFile& file : collection.files[step]) expansion.expand(file, found.files);
        if (!found.is_single()) break;
        format = format_of(found.files.front().path);
        if (format == nullptr || format->files == nullptr) break;
        found.list = found.files.front().path;
        place = found.files.front().place;
        of_list.step.reset();
    }
    return found;
}

std::size_t bytes_of(const MeshFile& part) {
    std::size_t bytes = sizeof part + part.points.size() * sizeof(Vec3);
    each_kind(part, [&](const auto& cells) { bytes += cells.corners.size() * sizeof cells.corners[0]; });
    for (const FileArray& array : part.arrays) bytes += sizeof array + array.values.size() * sizeof(double);
    return bytes;
}

ReadResult read_step(const std::filesystem::path& path, const ReadOptions& options) {
    NamedFiles named;
    StepFiles step = files_of_step(path, options, named);
    const std::string list = step.list.string();
    ReadOptions of_file = options;
    of_file.step.reset();
    if (step.is_single()) {
        const ListedFile& file = step.files.front();
        const MeshFormat& format = readable_format(file.path);
        check_options(format, file.path, of_file);
        ReadResult result = format.read(file.path, of_file);
        result.warnings.insert(result.warnings.begin(), step.warnings.begin(), step.warnings.end());
        return result;
    }
    const PartFiles chosen = chosen_files(std::move(step.files), list, options);
    std::vector<std::string> warnings = std::move(step.warnings);
    warnings.insert(warnings.end(), chosen.warnings.begin(), chosen.warnings.end());
    std::vector<MeshFile> parts;
    for (const ListedFile& file : chosen.files) {
        named.take_file(file.path, [&] { return file.place; });
        MeshFile part = read_part(file, options);
        const std::size_t bytes = bytes_of(part);
        named.take("cells of " + NamedFiles::identity(file.path), bytes, bytes, [&] { return file.place; });
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
    std::vector<std::string> none;
    if (!format.times) static_cast<void>(chosen_step(options, 1, path.string(), none));
    NamedFiles named;
    StepFiles step = files_of_step(path, options, named);
    if (step.is_single()) return {};
    PartFiles chosen = chosen_files(std::move(step.files), step.list.string(), options);
    chosen.warnings.insert(chosen.warnings.begin(), step.warnings.begin(), step.warnings.end());
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

ReadResult read_collection(const std::filesystem::path& path, const ReadOptions& options) {
    return read_step(path, options);
}

}  // namespace subvol::detail
