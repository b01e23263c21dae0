// SPDX-License-Identifier: Apache-2.0
// Writes a case of OpenFOAM as text. Faces inside the mesh come first, by their cells, then those of each patch; normals point
// out of the cell that is named first. Nothing that is there is replaced: folders are made under other names and renamed at the
// end, and if anything fails before they are complete, they are removed.
#include <algorithm>
#include <array>
#include <charconv>
#include <list>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <system_error>

#include "mesh_arrays.h"
#include "sharp_groups.h"
#include "solver_readers.h"
#include "subvol/cell.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/topology.h"

namespace subvol::detail {
namespace {

namespace fs = std::filesystem;

/// A folder that appears with all its files or not at all, where there is none.
class NewFolder {
public:
    /// root: where it is made if the folder above it is not there
    NewFolder(fs::path target, const fs::path& root) : target_(std::move(target)) {
        std::error_code error;
        const fs::path above = fs::is_directory(target_.parent_path(), error) ? target_.parent_path() : root;
        std::random_device random;
        do {
            now_ = above / (".subvol-" + hex_digits(std::uint64_t{random()} << 32 | random()));
        } while (!fs::create_directory(now_, error) && !error);
        if (error) fail(error);
    }
    ~NewFolder() {
        if (kept_) return;
        std::error_code ignored;
        for (const std::string& name : names_) fs::remove(now_ / name, ignored);
        fs::remove(now_, ignored);  // if it is empty
        if (made_above_) fs::remove(target_.parent_path(), ignored);
    }
    NewFolder(const NewFolder&) = delete;
    NewFolder& operator=(const NewFolder&) = delete;

    /// Where a file of the folder is written.
    [[nodiscard]] fs::path file(const std::string& name) {
        names_.push_back(name);
        unfinished_.emplace_back(now_ / name, /*with_folder=*/true);
        return now_ / name;
    }
    /// Gives the folder its name. It does not last unless `keep` is called.
    void rename() {
        std::error_code error;
        sync_files_in(now_);
        if (fs::exists(fs::symlink_status(target_, error))) fail(std::make_error_code(std::errc::file_exists));
        error.clear();
        if (!fs::exists(target_.parent_path(), error)) made_above_ = fs::create_directory(target_.parent_path(), error);
        if (!error) fs::rename(now_, target_, error);
        if (error) fail(error);
        now_ = target_;
    }
    void keep() { kept_ = true; }

private:
    [[noreturn]] void fail(const std::error_code& error) const {
        throw Error(ErrorCode::Io, "cannot be written: " + error.message(), target_.string());
    }

    fs::path target_, now_;
    std::list<UnfinishedFile> unfinished_;
    std::vector<std::string> names_;
    bool made_above_ = false, kept_ = false;
};

/// A file of a case, with its header.
class FoamOutput {
public:
    FoamOutput(NewFolder& folder, const std::string& location, const std::string& type, const std::string& name,
               const std::string& note = {})
        : out_(folder.file(name)) {
        text("FoamFile\n{\n    version     2.0;\n    format      ascii;\n    class       " + type + ";\n");
        if (!note.empty()) text("    note        \"" + note + "\";\n");
        if (!location.empty()) text("    location    \"" + location + "\";\n");
        text("    object      " + name + ";\n}\n\n");
    }

    void text(std::string_view text) {
        buffer_.append(text);
        flush_beyond(kFull);
    }
    template <class Number>
    void number(Number number) {
        std::array<char, 32> digits;
        buffer_.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
    }
    /// Several numbers between parentheses, one alone.
    template <class Number>
    void tuple(std::span<const Number> numbers) {
        if (numbers.size() > 1) buffer_ += '(';
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            if (k > 0) buffer_ += ' ';
            number(numbers[k]);
        }
        buffer_ += numbers.size() > 1 ? ")\n" : "\n";
        flush_beyond(kFull);
    }
    void commit() {
        flush_beyond(0);
        out_.commit(Sync::Later);
    }

private:
    static constexpr std::size_t kFull = 1 << 16;
    void flush_beyond(std::size_t bytes) {
        if (buffer_.size() <= bytes) return;
        out_.write(buffer_);
        buffer_.clear();
    }

    OutputFile out_;
    std::string buffer_;
};

/// Names of one kind as words of OpenFOAM: a letter first, no blanks, quotes and brackets, and each once.
class FoamNames {
public:
    FoamNames(const char* kind, std::vector<std::string>& warnings) : kind_(kind), warnings_(warnings) {}

    std::string of(const std::string& name) {
        const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
        std::string word;
        for (const char c : name)
            word +=
                is_letter(c) || (c >= '0' && c <= '9') || std::string_view("_-.:").find(c) != std::string_view::npos ? c : '_';
        if (word.empty() || !is_letter(word[0])) word.insert(0, "S_");
        word.resize(std::min(word.size(), kLongest));
        const std::string begin = word;
        for (int k = 2; !taken_.insert(word).second; ++k) word = begin + "_" + std::to_string(k);
        if (word != name) warnings_.push_back(std::string(kind_) + " " + in_quotes(name) + " is called " + in_quotes(word));
        return word;
    }

private:
    static constexpr std::size_t kLongest = 200;  // fields are files of that name

    const char* kind_;
    std::vector<std::string>& warnings_;
    std::set<std::string> taken_;
};

constexpr const char* kMeshFolder = "constant/polyMesh";
constexpr const char* kTimeFolder = "0";
constexpr const char* kSystemFolder = "system";

class FoamWriter {
public:
    FoamWriter(const fs::path& path, const WrittenMesh& written)
        : path_(path),
          root_(path.has_parent_path() ? path.parent_path() : fs::path(".")),
          marker_(path),
          mesh_(written.mesh),
          sets_(written.sets),
          topology_(build_topology(without_tags(written.mesh))) {}

    std::vector<std::string> run() {
        if (is_taken(kMeshFolder)) {
            throw Error(ErrorCode::InvalidInput, "there is a mesh of OpenFOAM already, which is not replaced",
                        (root_ / kMeshFolder).string(), "another folder, or move it away");
        }
        try {
            write_all();
        } catch (const Error& error) {
            // Files have other names until they are finished.
            if (error.code() != ErrorCode::Io) throw;
            throw Error(ErrorCode::Io, error.message(), path_.string(), error.allowed());
        }
        warn_of_lost_creases(".foam", mesh_, warnings_);
        return std::move(warnings_);
    }

private:
    struct InnerFace {
        Index owner, neighbour;
        std::uint8_t side;  // of the owner
    };
    struct FoamPatchFaces {
        std::string name;
        std::vector<CellSide> sides;
    };

    // Creases and sharp faces are not written, so they need not be right.
    static HexMesh without_tags(const HexMesh& mesh) {
        HexMesh plain;
        plain.points = mesh.points;
        plain.cells = mesh.cells;
        return plain;
    }

    [[nodiscard]] bool is_taken(const char* name) const {
        std::error_code error;
        return fs::exists(fs::symlink_status(root_ / name, error));
    }

    void write_all() {
        find_inner_faces();
        find_patches();
        NewFolder mesh(root_ / kMeshFolder, root_);
        write_points(mesh);
        write_faces(mesh);
        write_owners(mesh);
        write_boundary(mesh);
        write_zones(mesh);
        std::optional<NewFolder> fields, system;
        write_fields(fields);
        write_system(system);
        if (fields) fields->rename();
        if (system) system->rename();
        mesh.rename();
        if (std::error_code error; !fs::exists(path_, error)) marker_.commit();
        mesh.keep();
        if (fields) fields->keep();
        if (system) system->keep();
    }

    // By their cell of the smaller number, those of one cell by the other.
    void find_inner_faces() {
        std::array<InnerFace, 6> of_cell{};
        for (Index c = 0; c < mesh_.cells.size(); ++c) {
            std::size_t count = 0;
            for (std::size_t side = 0; side < 6; ++side) {
                const auto [first, second] = topology_.face_cells[topology_.cell_faces[c][side]];
                if (first == c && second != kNone) of_cell[count++] = {c, second, static_cast<std::uint8_t>(side)};
            }
            const auto end = of_cell.begin() + static_cast<std::ptrdiff_t>(count);
            std::sort(of_cell.begin(), end, [](const InnerFace& a, const InnerFace& b) { return a.neighbour < b.neighbour; });
            inner_.insert(inner_.end(), of_cell.begin(), end);
        }
    }

    // A face is in one patch: the first one that has it.
    void find_patches() {
        FoamNames names("patch", warnings_);
        std::vector<std::uint8_t> taken(topology_.faces.size());
        for (const Patch& patch : sets_.patches) {
            if (patch.sides.empty()) continue;
            FoamPatchFaces faces{names.of(patch.name), {}};
            for (const CellSide& side : patch.sides) {
                const Index face = topology_.cell_faces[side.cell][side.side];
                if (!topology_.face_on_hull(face) || taken[face] != 0) continue;
                taken[face] = 1;
                faces.sides.push_back(side);
            }
            if (const std::size_t lost = patch.sides.size() - faces.sides.size(); lost > 0) {
                warnings_.push_back(counted(lost, "face of patch ", "faces of patch ") + in_quotes(patch.name) +
                                    " not written there: a face is in one patch, the first that has it");
            }
            patches_.push_back(std::move(faces));
        }
        std::vector<CellSide> rest;
        for (Index c = 0; c < mesh_.cells.size(); ++c) {
            for (std::size_t side = 0; side < 6; ++side) {
                const Index face = topology_.cell_faces[c][side];
                if (topology_.face_on_hull(face) && taken[face] == 0) rest.push_back({c, static_cast<std::uint8_t>(side)});
            }
        }
        if (!rest.empty()) patches_.push_back({names.of("defaultFaces"), std::move(rest)});
    }

    void write_points(NewFolder& folder) const {
        FoamOutput out(folder, kMeshFolder, "vectorField", "points");
        begin_list(out, mesh_.points.size());
        for (const Vec3& x : mesh_.points) out.tuple<double>(std::array{x[0], x[1], x[2]});
        end_list(out);
    }

    static void begin_list(FoamOutput& out, std::size_t count) { out.text(std::to_string(count) + "\n(\n"); }
    static void end_list(FoamOutput& out) {
        out.text(")\n");
        out.commit();
    }

    /// Calls `each` for all faces in their order, with the cell and the side that they are written from.
    template <class Each>
    void for_each_face(const Each& each) const {
        for (const InnerFace& face : inner_) each(face.owner, face.side);
        for (const FoamPatchFaces& patch : patches_) {
            for (const CellSide& side : patch.sides) each(side.cell, side.side);
        }
    }

    [[nodiscard]] std::size_t face_count() const {
        std::size_t count = inner_.size();
        for (const FoamPatchFaces& patch : patches_) count += patch.sides.size();
        return count;
    }

    void write_faces(NewFolder& folder) const {
        FoamOutput out(folder, kMeshFolder, "faceList", "faces");
        begin_list(out, face_count());
        for_each_face([&](Index cell, std::uint8_t side) {
            std::array<Index, 4> corners{};
            for (std::size_t k = 0; k < corners.size(); ++k) corners[k] = mesh_.cells[cell][kCellFaces[side][k]];
            out.text("4");
            out.tuple<Index>(corners);
        });
        end_list(out);
    }

    void write_owners(NewFolder& folder) const {
        const std::string note = "nPoints:" + std::to_string(mesh_.points.size()) +
                                 "  nCells:" + std::to_string(mesh_.cells.size()) + "  nFaces:" + std::to_string(face_count()) +
                                 "  nInternalFaces:" + std::to_string(inner_.size());
        FoamOutput owner(folder, kMeshFolder, "labelList", "owner", note);
        begin_list(owner, face_count());
        for_each_face([&](Index cell, std::uint8_t) { owner.tuple<Index>(std::array{cell}); });
        end_list(owner);
        FoamOutput neighbour(folder, kMeshFolder, "labelList", "neighbour", note);
        begin_list(neighbour, inner_.size());
        for (const InnerFace& face : inner_) neighbour.tuple<Index>(std::array{face.neighbour});
        end_list(neighbour);
    }

    void write_boundary(NewFolder& folder) const {
        FoamOutput out(folder, kMeshFolder, "polyBoundaryMesh", "boundary");
        begin_list(out, patches_.size());
        std::size_t first = inner_.size();
        for (const FoamPatchFaces& patch : patches_) {
            out.text("    " + patch.name + "\n    {\n        type            patch;\n        nFaces          " +
                     std::to_string(patch.sides.size()) + ";\n        startFace       " + std::to_string(first) + ";\n    }\n");
            first += patch.sides.size();
        }
        end_list(out);
    }

    void write_zones(NewFolder& folder) {
        std::vector<std::pair<std::string, std::vector<Index>>> cells, points;
        FoamNames of_cells("set of cells", warnings_), of_points("set of nodes", warnings_);
        for (const CellSet& set : sets_.sets) {
            if (!set.cells.empty()) cells.emplace_back(of_cells.of(set.name), set.cells);
        }
        for (const NodeSet& set : sets_.nodes) {
            if (!set.cells.empty()) points.emplace_back(of_points.of(set.name), points_of(mesh_, set));
        }
        write_zones_of(folder, "cell", cells);
        write_zones_of(folder, "point", points);
    }

    static void write_zones_of(NewFolder& folder, const std::string& kind,
                               const std::vector<std::pair<std::string, std::vector<Index>>>& zones) {
        if (zones.empty()) return;
        FoamOutput out(folder, kMeshFolder, "regIOobject", kind + "Zones");
        begin_list(out, zones.size());
        for (const auto& [name, numbers] : zones) {
            out.text(name + "\n{\n    type " + kind + "Zone;\n    " + kind + "Labels List<label>\n");
            begin_list(out, numbers.size());
            for (const Index number : numbers) out.tuple<Index>(std::array{number});
            out.text(")\n;\n}\n");
        }
        end_list(out);
    }

    /// How the components of a field are written.
    struct FoamField {
        const char* type;
        const char* of_class;
        std::vector<std::size_t> order;
    };

    void write_fields(std::optional<NewFolder>& folder) {
        static const std::map<int, FoamField> kinds{{1, {"scalar", "ScalarField", {0}}},
                                                    {3, {"vector", "VectorField", {0, 1, 2}}},
                                                    {6, {"symmTensor", "SymmTensorField", {0, 3, 5, 1, 4, 2}}},
                                                    {9, {"tensor", "TensorField", {0, 1, 2, 3, 4, 5, 6, 7, 8}}}};
        FoamNames names("field", warnings_);
        std::vector<Attribute> lost;
        const bool in_the_way = !mesh_.attributes.empty() && is_taken(kTimeFolder);
        for (const Attribute& field : mesh_.attributes) {
            const auto kind = kinds.find(field.channels);
            if (in_the_way) continue;
            if (kind == kinds.end()) {
                lost.push_back(field);
                continue;
            }
            if (!folder) folder.emplace(root_ / kTimeFolder, root_);
            write_field(*folder, names.of(field.name), field, kind->second);
        }
        if (in_the_way) {
            warnings_.push_back("the fields are not written: the folder " + in_quotes(kTimeFolder) +
                                " of the case is there already");
        }
        warn_of_lost_fields(".foam", lost, warnings_);
    }

    void write_field(NewFolder& folder, const std::string& name, const Attribute& field, const FoamField& kind) const {
        const bool at_cells = is_at_cells(mesh_, field);
        const std::vector<double>& values = at_cells ? field.cells : field.values;
        const std::size_t channels = kind.order.size(), count = values.size() / channels;
        FoamOutput out(folder, kTimeFolder, (at_cells ? "vol" : "point") + std::string(kind.of_class), name);
        out.text("dimensions      [0 0 0 0 0 0 0];\n\ninternalField   nonuniform List<" + std::string(kind.type) + ">\n");
        begin_list(out, count);
        std::array<double, 9> tuple{};
        for (std::size_t k = 0; k < count; ++k) {
            for (std::size_t c = 0; c < channels; ++c) tuple[c] = values[k * channels + kind.order[c]];
            out.tuple<double>(std::span(tuple).first(channels));
        }
        out.text(")\n;\n\nboundaryField\n{\n");
        for (const FoamPatchFaces& patch : patches_) {
            out.text("    " + patch.name + "\n    {\n        type            " + (at_cells ? "zeroGradient" : "calculated") +
                     ";\n    }\n");
        }
        out.text("}\n");
        out.commit();
    }

    // Programs open no case without it.
    void write_system(std::optional<NewFolder>& folder) const {
        if (is_taken(kSystemFolder)) return;
        folder.emplace(root_ / kSystemFolder, root_);
        FoamOutput out(*folder, kSystemFolder, "dictionary", "controlDict");
        out.text(
            "startFrom       startTime;\nstartTime       0;\nstopAt          endTime;\nendTime         1;\ndeltaT          1;\n"
            "writeControl    timeStep;\nwriteInterval   1;\n");
        out.commit();
    }

    fs::path path_, root_;
    OutputFile marker_;
    const HexMesh& mesh_;
    const MeshSets& sets_;
    Topology topology_;
    std::vector<InnerFace> inner_;
    std::vector<FoamPatchFaces> patches_;
    std::vector<std::string> warnings_;
};

}  // namespace

std::vector<std::string> write_foam(const fs::path& path, const WrittenMesh& written) {
    return FoamWriter(path, written).run();
}

}  // namespace subvol::detail
