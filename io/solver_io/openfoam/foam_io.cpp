// SPDX-License-Identifier: Apache-2.0
// Reads cases of OpenFOAM. A mesh is a list of faces, each with its owner and, inside the mesh, its neighbour; normals point
// out of the owner. Cells are the faces that name them:
//
//     owner, neighbour → faces → points → check → faces sorted by cells, those of a neighbour reversed → cells by their shape
//     → patches and zones → fields of the step's folder
//
// Files are read in this order so that the counts of one limit those of the next. The faces of a cell decide whether it is a
// hexahedron, prism, pyramid or tetrahedron; others are split. A decomposed case has a part for each processor: patches where
// it was cut are left out, and the parts are joined, with the numbers of their points in the whole mesh where files give these.
// Patches, zones and fields that cannot be read stop nothing but themselves.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "assemble.h"
#include "foam_case.h"
#include "foam_text.h"
#include "join_pieces.h"
#include "mesh_file.h"
#include "polyhedra.h"
#include "solver_readers.h"
#include "subvol/detail/counted_rows.h"
#include "subvol/detail/gzip.h"
#include "subvol/detail/named_files.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/read_options.h"

namespace subvol::detail {

namespace fs = std::filesystem;

namespace {

/// A mesh as OpenFOAM has it. owner, neighbour: the cells of each face; only the first faces have a neighbour. The normal of a
/// face points out of its owner
struct FoamMesh {
    FoamFaces faces;
    std::vector<std::int64_t> owner, neighbour;
    std::size_t cells = 0;
};

// A face of a cell, and whether its order has to be reversed for the normal to point out of the cell.
struct Side {
    std::size_t face;
    bool reversed;
};

class Cells {
public:
    Cells(const FoamMesh& mesh, bool ignore_others, MeshFile& found)
        : mesh_(mesh), found_(found), taker_(found, ignore_others) {}

    void run() {
        sort_faces();
        for (std::size_t c = 0; c < mesh_.cells; ++c) {
            load(c);
            taker_.add(static_cast<Index>(c), faces_);
        }
        if (taker_.left_out() > 0)
            add_left_out_warning(found_, {{"cells", "other cells", taker_.left_out()}}, std::nullopt,
                                 [](const IgnoredPart& cells) { return counted(cells.count, "other cell", "other cells"); });
        taker_.report();
    }

private:
    void sort_faces() {
        sides_ = counted_rows<Side>(mesh_.cells, [&](const auto& put) {
            for (std::size_t f = 0; f < mesh_.owner.size(); ++f) put(static_cast<std::size_t>(mesh_.owner[f]), Side{f, false});
            for (std::size_t f = 0; f < mesh_.neighbour.size(); ++f)
                put(static_cast<std::size_t>(mesh_.neighbour[f]), Side{f, true});
        });
    }

    // The faces of a cell with outward normals.
    void load(std::size_t c) {
        faces_.clear();
        for (const Side& side : sides_[c]) {
            auto& face = faces_.emplace_back();
            for (const std::int64_t p : mesh_.faces[side.face]) face.push_back(static_cast<Index>(p));
            if (side.reversed) std::reverse(face.begin(), face.end());
        }
    }

    const FoamMesh& mesh_;
    MeshFile& found_;
    PolyhedronTaker taker_;
    Rows<Side> sides_;
    CellFaces faces_;  // of the cell at hand
};

// Checks all numbers, and counts the cells. fail: throws an Error with a sentence
void check_foam_mesh(FoamMesh& mesh, std::size_t points, const std::function<void(const std::string&)>& fail) {
    const std::size_t faces = mesh.faces.size();
    if (mesh.owner.size() != faces) {
        fail("there are " + std::to_string(mesh.owner.size()) + " owners for " + std::to_string(faces) + " faces");
    }
    if (mesh.neighbour.size() > faces) fail("there are more neighbours than faces");
    for (const auto* cells : {&mesh.owner, &mesh.neighbour}) {
        for (std::size_t f = 0; f < cells->size(); ++f) {
            const std::int64_t cell = (*cells)[f];
            if (cell < 0 && cells == &mesh.neighbour) {  // old meshes have -1 at the boundary
                mesh.neighbour.resize(f);
                break;
            }
            // A cell has faces, so it cannot have a number that is larger than twice theirs.
            if (cell < 0 || static_cast<std::uint64_t>(cell) >= 2 * faces) {
                fail("face " + std::to_string(f) + " belongs to cell " + std::to_string(cell));
            }
            mesh.cells = std::max(mesh.cells, static_cast<std::size_t>(cell) + 1);
        }
    }
    for (std::size_t f = 0; f < faces; ++f) {
        if (mesh.faces[f].size() < 3) fail("face " + std::to_string(f) + " has less than 3 points");
        for (const std::int64_t p : mesh.faces[f]) {
            if (p < 0 || static_cast<std::uint64_t>(p) >= points) {
                fail("face " + std::to_string(f) + ": there is no point " + std::to_string(p));
            }
        }
    }
}

// Adds the cells to `found`, which has the points: as the hexahedra, prisms, pyramids and tetrahedra that their faces make
// them. Others are split from a new point in their middle into tetrahedra, with a warning that counts them.
//
// ignore_others: only the hexahedra
void add_foam_cells(const FoamMesh& mesh, bool ignore_others, MeshFile& found) {
    Cells(mesh, ignore_others, found).run();
}

constexpr EntityNames kFoamNames{"point", "cell", 0};

std::size_t components_of_class(std::string_view type) {
    return type == "volScalarField"       ? 1
           : type == "volVectorField"     ? 3
           : type == "volSymmTensorField" ? 6
           : type == "volTensorField"     ? 9
                                          : 0;
}

PatchRole role_of(std::string_view type) {
    if (type == "wall") return PatchRole::Wall;
    const bool plane = type.starts_with("symmetry") || type.starts_with("cyclic") || type == "empty" || type == "wedge";
    return plane ? PatchRole::Plane : PatchRole::Open;
}

// The files of a folder that may be fields: each once, without .gz.
std::set<std::string> names_in(const fs::path& folder) {
    std::set<std::string> names;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        if (!entry.is_regular_file(none)) continue;
        const std::string name = entry.path().filename().string();
        names.insert(name.ends_with(".gz") ? name.substr(0, name.size() - 3) : name);
    }
    return names;
}

class PartReader {
public:
    PartReader(const FoamCase& foam_case, std::size_t part, std::size_t step, const ReadOptions& options, NamedFiles& named)
        : case_(foam_case), part_(part), step_(step), options_(options), named_(named) {}

    MeshFile read() {
        FoamMesh mesh = read_faces();
        read_points(mesh);
        add_cells(std::move(mesh));
        if (case_.decomposed) read_numbers();
        if (step_ < case_.folders.size()) {
            const fs::path folder = case_.parts[part_].folder / case_.folders[step_];
            for (const std::string& name : names_in(folder)) {
                // A field that cannot be read stops nothing but itself.
                try {
                    read_field(folder / name, name);
                } catch (const Error& error) {
                    found_.unread.push_back({name, error.what()});
                }
            }
        }
        without_values_.report("boundaryField", "boundaryFields", found_.warnings, found_.ignored);
        return std::move(found_);
    }

private:
    static constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();
    [[nodiscard]] std::optional<std::size_t> block() const { return case_.parts[part_].block; }
    // A file of several processors has more than one of them says.
    [[nodiscard]] std::size_t limit(std::size_t entries) const { return block() ? kNoLimit : entries; }
    [[nodiscard]] fs::path file(const std::string& name) const { return case_.mesh_file(part_, step_, name); }

    // Before the points, so that no file contains more of anything than the others say.
    [[nodiscard]] FoamMesh read_faces() {
        FoamMesh mesh;
        mesh.owner = FoamText(file("owner"), kNoLimit, block()).labels();
        mesh.neighbour = FoamText(file("neighbour"), limit(mesh.owner.size()), block()).labels();
        FoamText faces(file("faces"), limit(mesh.owner.size() + 1), block());
        mesh.faces = faces.faces();
        take(file("faces"), faces, 0);
        return mesh;
    }

    void read_points(const FoamMesh& mesh) {
        constexpr std::size_t kUnused = 1000;  // points of no face, which are harmless
        const auto& used = mesh.faces.points;
        const std::int64_t last = used.empty() ? 0 : std::max<std::int64_t>(0, *std::ranges::max_element(used));
        const fs::path path = file("points");
        FoamText text(path, limit(2 * static_cast<std::size_t>(last) + kUnused), block());
        const auto values = text.reals(3);
        for (std::size_t i = 0; i + 2 < values.size(); i += 3) add_point(found_, {values[i], values[i + 1], values[i + 2]}, 0);
        points_ = found_.points.size();
        take(path, text, 0);
        if (points_ >= kNone / 2) text.fail("there are too many points");
    }

    void add_cells(FoamMesh mesh) {
        const std::string name = file("faces").string();
        const auto fail = [&](const std::string& message) { throw Error(ErrorCode::InvalidInput, message, name); };
        check_foam_mesh(mesh, points_, fail);
        if (mesh.cells >= kNone / 2) fail("there are too many cells");
        cells_ = mesh.cells;
        add_foam_cells(mesh, options_.other_cells == OtherCells::Ignore, found_);
        without_failing("boundary", [&](const fs::path& path) { read_patches(path, mesh.faces); });
        if (case_.decomposed && borders_on_ >= static_cast<std::int64_t>(case_.parts.size())) {
            throw Error(ErrorCode::InvalidInput, "processor " + std::to_string(borders_on_) + ", a neighbour, is not there",
                        file("boundary").string(), "there are " + counted(case_.parts.size(), "processor", "processors"));
        }
        without_failing("cellZones", [&](const fs::path& path) { read_zones(path); });
        const std::string of_points = file("points").string();
        TextScanner in(std::string_view(), of_points, TextScanner::Comments::None);
        in.name_no_place();
        refuse_not_finite(found_, in, kFoamNames);
    }

    // What names parts of the mesh stops nothing but itself where it cannot be read.
    template <class Read>
    void without_failing(const std::string& name, const Read& read) {
        const fs::path path = file(name);
        if (!is_there(path)) return;
        try {
            read(path);
        } catch (const Error& error) {
            found_.ignore({"file", name, 1, error.what()});
        }
    }

    void read_patches(const fs::path& path, const FoamFaces& faces) {
        FoamText text(path, kNoLimit, block());
        std::vector<FilePatch> patches;
        std::vector<FoamPatch> taken_patches;
        std::vector<Index> corners;
        const auto all = static_cast<std::int64_t>(faces.size());
        std::int64_t left = all;  // patches have no face in common
        for (const FoamPatch& patch : text.patches()) {
            left -= std::clamp<std::int64_t>(patch.count, 0, all);
            if (patch.first < 0 || patch.count < 0 || patch.first > all || patch.count > all - patch.first || left < 0) {
                text.fail("patch " + in_quotes(patch.name) + " has " + std::to_string(patch.count) + " faces from " +
                              std::to_string(patch.first) + " on",
                          "the mesh has " + std::to_string(all));
            }
            if (patch.type.starts_with("processor")) {  // where the mesh was cut
                borders_on_ = std::max(borders_on_, patch.neighbour);
                continue;
            }
            taken_patches.push_back(patch);
            FilePatch& taken = patches.emplace_back(FilePatch{.name = patch.name, .role = role_of(patch.type)});
            for (std::int64_t f = patch.first; f < patch.first + patch.count; ++f) {
                const auto face = faces[static_cast<std::size_t>(f)];
                corners.assign(face.begin(), face.end());
                taken.add(corners);
            }
        }
        take(path, text, 0);
        found_.patches = std::move(patches);
        patches_ = std::move(taken_patches);
    }

    void read_zones(const fs::path& path) {
        FoamText text(path, limit(cells_), block());
        std::vector<FileSet> sets;
        for (const FoamZone& zone : text.zones("cellLabels")) {
            FileSet& set = sets.emplace_back(FileSet{zone.name, {}});
            for (const std::int64_t cell : zone.labels) {
                if (cell < 0 || static_cast<std::uint64_t>(cell) >= cells_)
                    text.fail("zone " + in_quotes(zone.name) + ": there is no cell " + std::to_string(cell));
                set.numbers.push_back(static_cast<Index>(cell));
            }
        }
        take(path, text, 0);
        found_.sets = std::move(sets);
    }

    // Those of the points in the whole mesh; points that were added in the middle of cells belong to no other part.
    void read_numbers() {
        const fs::path path = file("pointProcAddressing");
        std::error_code none;
        if (!fs::exists(path, none) && !fs::exists(path.string() + ".gz", none)) return;
        FoamText text(path, kNoLimit, block());
        const auto numbers = text.labels();
        if (numbers.size() != points_) {
            text.fail(counted(numbers.size(), "number", "numbers") + " of points", std::to_string(points_) + " are needed");
        }
        FileArray array{"GlobalNodeId", 1, false, {}};
        for (const std::int64_t number : numbers) {
            if (number < 0)
                text.fail("point " + std::to_string(array.values.size()) + " has the number " + std::to_string(number));
            array.values.push_back(static_cast<double>(number));
        }
        for (std::size_t p = points_; p < found_.points.size(); ++p) {
            array.values.push_back(static_cast<double>(part_ + 1) * 4294967296.0 + static_cast<double>(p));
        }
        found_.arrays.push_back(std::move(array));
    }

    void read_field(const fs::path& path, const std::string& name) {
        constexpr std::size_t kHeader = 4096;
        if (start_of_maybe_gzipped(path, kHeader).find("FoamFile") == std::string::npos) {
            found_.ignored.push_back({"file", name, 1, "it is no file of OpenFOAM"});
            return;
        }
        FoamText text(path, kNoLimit, block());
        const std::size_t components = components_of_class(text.type());
        if (components == 0) {
            found_.ignored.push_back({"field", name, 1, "it is of class " + text.type()});
            return;
        }
        take(path, text, cells_ * components * sizeof(double));  // "uniform" is one value for all cells
        found_.arrays.push_back({name, static_cast<int>(components), true, text.internal_field(components, cells_)});
        FileArray& array = found_.arrays.back();
        array.unit = text.unit();
        if (options_.patch_values != PatchValuesUse::Ignore) read_on_patches(text, array);
        if (components != kSymmetricByRows.size()) return;
        order_symmetric(array.values, kSymmetricByRows);
        for (FileOnPatch& patch : array.on_patches) order_symmetric(patch.values, kSymmetricByRows);
    }

    void read_on_patches(FoamText& text, FileArray& array) {
        try {
            const auto on_patches = text.boundary_field(static_cast<std::size_t>(array.components), patches_);
            for (std::size_t k = 0; k < on_patches.size(); ++k) {
                const FoamOnPatch& known = on_patches[k];
                if (known.along || known.level || !known.values.empty())
                    array.on_patches.push_back({k, known.along, known.values, known.level});
            }
        } catch (const Error& error) {
            without_values_.add(array.name, error.what());
        }
    }

    void take(const fs::path& path, const FoamText& text, std::size_t made) {
        named_.take(path.string(), text.size(), made, [&] { return path.string(); });
    }

    const FoamCase& case_;
    std::size_t part_, step_;
    ReadOptions options_;
    NamedFiles& named_;
    MeshFile found_;
    std::vector<FoamPatch> patches_;  // as found_.patches
    LeftOut without_values_;
    std::size_t points_ = 0, cells_ = 0;
    std::int64_t borders_on_ = -1;  // the last processor that is behind a patch
};

std::size_t step_of(const FoamCase& foam_case, const fs::path& path, const ReadOptions& options,
                    std::vector<std::string>& warnings) {
    return chosen_step(options, std::max<std::size_t>(1, foam_case.times.size()), path.string(), warnings);
}

}  // namespace

std::size_t foam_parts(const fs::path& path) {
    return find_foam_case(path).parts.size();
}

MeshFile read_foam_part(const fs::path& path, std::size_t part, const ReadOptions& options) {
    const FoamCase foam_case = find_foam_case(path);
    if (part >= foam_case.parts.size()) {
        throw Error(ErrorCode::InvalidInput, "has changed while it was being read", path.string());
    }
    std::vector<std::string> warnings;
    const std::size_t step = step_of(foam_case, path, options, warnings);
    NamedFiles named;
    MeshFile found = PartReader(foam_case, part, step, options, named).read();
    found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
    return found;
}

ReadResult read_foam(const fs::path& path, const ReadOptions& options) {
    const FoamCase foam_case = find_foam_case(path);
    const std::string file = path.string();
    std::vector<std::string> warnings;
    const std::size_t step = step_of(foam_case, path, options, warnings);
    NamedFiles named;
    std::vector<MeshFile> parts;
    for (std::size_t part = 0; part < foam_case.parts.size(); ++part) {
        parts.push_back(PartReader(foam_case, part, step, options, named).read());
    }
    MeshFile found = parts.size() == 1 ? std::move(parts.front()) : join_pieces(std::move(parts), "processor", file);
    if (foam_case.decomposed) {
        std::erase_if(found.arrays, [](const FileArray& array) { return array.name == "GlobalNodeId"; });
    }
    found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
    add_left_out_warning(found, {}, file);
    return assemble(std::move(found), file, kFoamNames, options);
}

std::vector<double> foam_times(const fs::path& path) {
    return find_foam_case(path).times;
}

}  // namespace subvol::detail
