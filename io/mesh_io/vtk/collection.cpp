// SPDX-License-Identifier: Apache-2.0
// One mesh of the files that a collection names. A list gives files with times, with blocks, or as pieces of one mesh; files of
// the same time are one step. Of the chosen step, lists in lists are replaced by their own files:
//
//     list → step → files → chosen blocks without surfaces → parts → joined → one mesh
//              └─ a single file without a block: another list, of which the last step is taken, or the mesh itself
//
// Blocks are named by their path in the tree, "outer/inner"; of several files with the same name the cells are added up. What
// is read is limited: the nesting of blocks, the lengths of their names, and the files and bytes in all, as a small list may
// name the same file many times.
#include "collection.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <tuple>

#include "assemble.h"
#include "formats.h"
#include "join_pieces.h"
#include "mesh_file.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/named_files.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/detail/vtk_xml.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "xml_list.h"

namespace subvol::detail {

namespace {

constexpr int kMostNested = 32;

// Puts files with the same time into one step, and the steps in order.
class Steps {
public:
    void add(double time, ListedFile file) { steps_[time].push_back(std::move(file)); }

    [[nodiscard]] Collection collection() && {
        Collection collection;
        for (auto& [time, files] : steps_) {
            collection.times.push_back(time);
            collection.files.push_back(std::move(files));
        }
        return collection;
    }

private:
    std::map<double, std::vector<ListedFile>> steps_;
};

// The blocks of a composite data set, and those of its blocks. name: of the element, with a slash; empty for the first
void add_blocks(XmlList& list, const pugi::xml_node& element, const std::string& name, int depth,
                std::vector<ListedFile>& files) {
    if (depth > kMostNested) list.xml().fail_at(element, "blocks are nested too deeply");
    if (name.size() > kLongestBlock) list.xml().fail_at(element, "the name of a block is too long", kBlockLimit);
    int count = 0;
    for (const auto& child : element.children()) {
        const std::string own = printable(as_utf8(child.attribute("name").as_string()));
        const std::string index = printable(as_utf8(child.attribute("index").as_string(std::to_string(count++).c_str())));
        if (std::string_view(child.name()) == "DataSet") {
            if (!child.attribute("file")) continue;  // an empty block
            const bool of_piece = std::string_view(element.name()) == "Piece" && !name.empty();
            files.push_back(
                list.file(child, "file",
                          own.empty() && of_piece ? name : name + (name.empty() ? "" : "/") + (own.empty() ? index : own)));
        } else {
            const std::string inner = own.empty() ? index : own;
            add_blocks(list, child, name.empty() ? inner : name + "/" + inner, depth + 1, files);
        }
    }
}

}  // namespace

Collection read_pvd(const std::filesystem::path& path) {
    XmlList list(path, "Collection", "a list of files with their times is needed");
    Steps steps;
    for (const auto& node : list.xml().data_set().children("DataSet")) {
        const auto time = number_from(trimmed(node.attribute("timestep").as_string("0")));
        if (!time || !std::isfinite(*time)) list.xml().fail_at(node, "its timestep is not a number");
        std::string name = printable(as_utf8(node.attribute("name").as_string()));
        if (name.size() > kLongestBlock) list.xml().fail_at(node, "the name of a block is too long", kBlockLimit);
        steps.add(*time, list.file(node, "file", std::move(name)));
    }
    Collection collection = std::move(steps).collection();
    if (collection.times.empty()) list.xml().fail_at(list.xml().data_set(), "it lists no files");
    return collection;
}

Collection read_series_list(const std::filesystem::path& path) {
    const std::string file = path.string(), text = read_text(path);
    const auto fail = [&](const std::string& message) {
        throw Error(ErrorCode::InvalidInput, message, file, R"({"files": [{"name": "a.vtu", "time": 0}, …]} is needed)");
    };
    const auto json = nlohmann::json::parse(of_limited_depth(text, file), nullptr, false);
    if (json.is_discarded()) fail("not well-formed JSON");
    if (!json.is_object() || !json.contains("files") || !json["files"].is_array()) fail("it has no list \"files\"");
    Steps steps;
    std::size_t number = 0;
    for (const auto& entry : json["files"]) {
        const std::string place = "entry " + std::to_string(number) + " of \"files\"";
        const bool sound = entry.is_object() && entry.contains("name") && entry["name"].is_string() &&
                           (!entry.contains("time") || entry["time"].is_number());
        if (!sound) fail(place + " has no name, or its time is not a number");
        const double time = entry.contains("time") ? entry["time"].get<double>() : static_cast<double>(number);
        auto named = named_file(path.parent_path(), entry["name"].get<std::string>(), [&] { return file + ", " + place; });
        steps.add(time, {std::move(named), {}, file + ", " + place});
        ++number;
    }
    if (number == 0) fail("it lists no files");
    return std::move(steps).collection();
}

Collection read_pieces_list(const std::filesystem::path& path) {
    const std::string extension = upper_case(path.extension().string());
    const std::string type = extension == ".PVTS"   ? "PStructuredGrid"
                             : extension == ".PVTR" ? "PRectilinearGrid"
                             : extension == ".PVTI" ? "PImageData"
                                                    : "PUnstructuredGrid";
    XmlList list(path, type, "the pieces of a volume mesh are needed");
    Collection collection{{0}, {{}}};
    for (const auto& node : list.xml().data_set().children("Piece")) {
        collection.files[0].push_back(list.file(node, "Source", {}));
    }
    if (collection.files[0].empty()) list.xml().fail_at(list.xml().data_set(), "it lists no pieces");
    collection.remarks = list.remarks();
    return collection;
}

Collection read_blocks_list(const std::filesystem::path& path) {
    XmlList list(path, "vtkMultiBlockDataSet", "blocks of volume meshes are needed");
    Collection collection{{0}, {{}}};
    add_blocks(list, list.xml().data_set(), {}, 0, collection.files[0]);
    if (collection.files[0].empty()) list.xml().fail_at(list.xml().data_set(), "it lists no blocks");
    collection.remarks = list.remarks();
    return collection;
}

void ListRemarks::add_to(std::optional<double>& time_of_mesh, std::vector<IgnoredPart>& ignored_of_mesh) const {
    if (time) time_of_mesh = time;
    for (const IgnoredPart& part : ignored) {
        const bool known = std::ranges::any_of(ignored_of_mesh, [&](const IgnoredPart& other) {
            return other.kind == part.kind && other.name == part.name && other.reason == part.reason;
        });
        if (!known) ignored_of_mesh.push_back(part);
    }
}

std::vector<double> pvd_times(const std::filesystem::path& path) {
    return read_pvd(path).times;
}

std::vector<double> series_list_times(const std::filesystem::path& path) {
    return read_series_list(path).times;
}

namespace {

constexpr std::array<std::string_view, 3> kSurfaces{".VTP", ".PVTP", ".STL"};
constexpr EntityNames kPieceNames{"point", "cell", 0};

bool is_surface(const std::filesystem::path& path) {
    return std::ranges::find(kSurfaces, upper_case(path.extension().string())) != kSurfaces.end();
}

// The files of a list, with lists of pieces or blocks replaced by their own files, in the order of the lists. Each list is read
// once.
class ListExpansion {
public:
    /// remarks: gets those of all lists, of the outer ones first
    ListExpansion(NamedFiles& named, ListRemarks& remarks) : named_(named), remarks_(remarks) {}

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
        if (is_new) {
            Collection list = blocks ? read_blocks_list(file.path) : read_pieces_list(file.path);
            known->second = std::move(list.files.front());
            if (remarks_.time) list.remarks.time.reset();
            list.remarks.add_to(remarks_.time, remarks_.ignored);
        }
        for (ListedFile next : known->second) {
            if (!file.block.empty()) next.block = file.block + (next.block.empty() ? "" : "/" + next.block);
            expand(next, files);
        }
    }

private:
    NamedFiles& named_;
    ListRemarks& remarks_;
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
            chosen.ignored.push_back({"file", file.path.filename().string(), 1, "it is one of surfaces"});
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
    ListRemarks remarks;

    [[nodiscard]] bool is_single() const { return files.size() == 1 && files.front().block.empty(); }
};

// A step that is a single list is the last step of that one.
StepFiles files_of_step(const std::filesystem::path& path, const ReadOptions& options, NamedFiles& named) {
    StepFiles found{path, {}, {}, {}};
    ReadOptions of_list = options;
    ListExpansion expansion(named, found.remarks);
    std::vector<NamedFiles::Open> open;
    std::string place;
    for (const MeshFormat* format = &readable_format(path); format != nullptr && format->files != nullptr;) {
        open.push_back(named.open(found.list, [&] { return place; }));
        check_options(*format, found.list, of_list);
        const Collection collection = format->files(found.list);
        collection.remarks.add_to(found.remarks.time, found.remarks.ignored);
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
        step.remarks.add_to(result.mesh.time, result.ignored);
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
        if (step.remarks.time) part.time.reset();  // whatever its files say
        if (!part.points.empty()) parts.push_back(std::move(part));
    }
    if (parts.empty()) parts.emplace_back();
    MeshFile found = join_pieces(std::move(parts), chosen.word, list);
    if (cells_of(found) == 0) throw Error(ErrorCode::InvalidInput, "no hexahedra in any of its files", list);
    merge_blocks(found.blocks);
    found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
    found.ignored.insert(found.ignored.end(), chosen.ignored.begin(), chosen.ignored.end());
    step.remarks.add_to(found.time, found.ignored);
    return assemble(std::move(found), list, kPieceNames, of_file);
}

}  // namespace

const EntityNames& names_in_parts() {
    return kPieceNames;
}

std::optional<PartFiles> part_files(const std::filesystem::path& path, const ReadOptions& options) {
    const MeshFormat& format = readable_format(path);
    if (format.files == nullptr && format.parts == nullptr) return {};
    check_options(format, path, options);
    const bool means = are_means(resolved_cell_values(format, options.cell_values));
    if (format.parts != nullptr) {
        const std::size_t count = format.parts(path);
        if (count < 2) return {};
        PartFiles parts{.files = {}, .word = format.finite_volumes ? "processor" : "piece", .warnings = {}, .means = means};
        for (std::size_t k = 0; k < count; ++k) parts.files.push_back({path, {}, path.string(), k});
        return parts;
    }
    std::vector<std::string> none;
    if (!format.times) std::ignore = chosen_step(options, 1, path.string(), none);
    NamedFiles named;
    StepFiles step = files_of_step(path, options, named);
    if (step.is_single()) return {};
    PartFiles chosen = chosen_files(std::move(step.files), step.list.string(), options);
    chosen.warnings.insert(chosen.warnings.begin(), step.warnings.begin(), step.warnings.end());
    chosen.means = means;
    return chosen;
}

MeshFile read_part(const ListedFile& file, const ReadOptions& options) {
    const MeshFormat* format = format_of(file.path);
    if (format != nullptr && format->part != nullptr && file.part) return format->part(file.path, *file.part, options);
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
