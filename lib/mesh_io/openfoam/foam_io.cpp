// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "assemble.h"
#include "foam_text.h"
#include "formats.h"
#include "gzip.h"
#include "join_pieces.h"
#include "mesh_file.h"
#include "named_files.h"
#include "subvol/error.h"
#include "subvol/read_options.h"
#include "text_scanner.h"

namespace subvol::detail {

namespace {

/// Where the meshes and fields of an OpenFOAM case are.
///
/// parts:   the folder of the case, or those of its processors
/// numbers: of the times in increasing order; folders: their names
struct FoamCase {
    std::filesystem::path root;
    std::vector<std::filesystem::path> parts;
    std::vector<double> times;
    std::vector<std::string> folders;
    bool decomposed = false;

    /// A file of the mesh of a part at a step: that of the last time, up to the step's, that has one; else in `constant`.
    [[nodiscard]] std::filesystem::path mesh_file(std::size_t part, std::size_t step, const std::string& name) const;
};

namespace fs = std::filesystem;

template <class Number>
std::optional<Number> number_of(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

bool is_there(const fs::path& file) {
    std::error_code none;
    return fs::exists(file, none) || fs::exists(file.string() + ".gz", none);
}

// The folders inside a folder, by the numbers that their names are after a prefix.
std::map<double, std::string> numbered(const fs::path& folder, std::string_view prefix) {
    std::map<double, std::string> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with(prefix) || !entry.is_directory(none)) continue;
        const auto number = number_of<double>(std::string_view(name).substr(prefix.size()));
        if (number && std::isfinite(*number)) found.emplace(*number, name);
    }
    return found;
}

bool has_mesh(const fs::path& part) {
    if (is_there(part / "constant/polyMesh/faces")) return true;
    return std::ranges::any_of(numbered(part, ""),
                               [&](const auto& time) { return is_there(part / time.second / "polyMesh/faces"); });
}

double last_time(const fs::path& part) {
    const auto times = numbered(part, "");
    return times.empty() ? -1 : times.rbegin()->first;
}

fs::path FoamCase::mesh_file(std::size_t part, std::size_t step, const std::string& name) const {
    for (std::size_t k = std::min(step + 1, folders.size()); k-- > 0;) {
        const fs::path file = parts[part] / folders[k] / "polyMesh" / name;
        if (is_there(file)) return file;
    }
    return parts[part] / "constant/polyMesh" / name;
}

// path: the folder, or a file in it. The case is decomposed if its processors have later times, or it has no mesh itself.
//
// throws: Error(InvalidInput) if there is no mesh
FoamCase find_foam_case(const fs::path& path) {
    std::error_code none;
    if (!fs::exists(path, none)) std::ignore = read_text(path);  // says what is wrong; the file's contents mean nothing
    FoamCase found;
    found.root = fs::is_directory(path, none) ? path : path.has_parent_path() ? path.parent_path() : fs::path(".");
    for (const auto& [number, name] : numbered(found.root, "processor")) {
        if (has_mesh(found.root / name)) found.parts.push_back(found.root / name);
    }
    const bool whole = has_mesh(found.root);
    if (!whole && found.parts.empty()) {
        throw Error(ErrorCode::InvalidInput, "there is no mesh of OpenFOAM", path.string(),
                    "constant/polyMesh/faces is needed, there or in processor0");
    }
    found.decomposed = !whole || (!found.parts.empty() && last_time(found.parts.front()) > last_time(found.root));
    if (!found.decomposed) found.parts = {found.root};
    for (const auto& [time, name] : numbered(found.parts.front(), "")) {
        found.times.push_back(time);
        found.folders.push_back(name);
    }
    return found;
}

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
        : mesh_(mesh), ignore_others_(ignore_others), found_(found) {}

    void run() {
        sort_faces();
        for (std::size_t c = 0; c < mesh_.cells; ++c) {
            number_ = static_cast<Index>(c);
            load(c);
            if (!take()) split();
        }
        if (left_out_ > 0) found_.warnings.push_back(counted(left_out_, "other cell", "other cells") + " ignored");
        if (polyhedra_ == 0) return;
        found_.warnings.push_back(counted(polyhedra_, "polyhedron", "polyhedra") + " split from the middle into " +
                                  counted(tets_, "tetrahedron", "tetrahedra"));
    }

private:
    void sort_faces() {
        starts_.assign(mesh_.cells + 1, 0);
        const auto each = [&](const auto& call) {
            for (std::size_t f = 0; f < mesh_.owner.size(); ++f) call(mesh_.owner[f], Side{f, false});
            for (std::size_t f = 0; f < mesh_.neighbour.size(); ++f) call(mesh_.neighbour[f], Side{f, true});
        };
        each([&](std::int64_t cell, const Side&) { ++starts_[static_cast<std::size_t>(cell) + 1]; });
        for (std::size_t c = 0; c < mesh_.cells; ++c) starts_[c + 1] += starts_[c];
        sides_.resize(starts_.back());
        std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
        each([&](std::int64_t cell, const Side& side) { sides_[next[static_cast<std::size_t>(cell)]++] = side; });
    }

    // The faces of a cell with outward normals, and its points.
    void load(std::size_t c) {
        faces_.clear();
        points_.clear();
        for (std::size_t s = starts_[c]; s < starts_[c + 1]; ++s) {
            auto& face = faces_.emplace_back();
            for (const std::int64_t p : mesh_.faces[sides_[s].face]) face.push_back(static_cast<Index>(p));
            if (sides_[s].reversed) std::reverse(face.begin(), face.end());
            points_.insert(points_.end(), face.begin(), face.end());
        }
        std::sort(points_.begin(), points_.end());
        points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    }

    [[nodiscard]] std::size_t faces_of(std::size_t corners) const {
        return static_cast<std::size_t>(
            std::ranges::count_if(faces_, [&](const auto& face) { return face.size() == corners; }));
    }

    bool take() {
        const std::size_t triangles = faces_of(3), quads = faces_of(4);
        if (triangles + quads != faces_.size()) return false;
        if (quads == 6 && triangles == 0 && points_.size() == 8) return put(found_.hexes, pillar<8>());
        if (ignore_others_) return false;
        if (quads == 3 && triangles == 2 && points_.size() == 6) return put(found_.prisms, pillar<6>());
        if (quads == 1 && triangles == 4 && points_.size() == 5) return put(found_.pyramids, cone<5>());
        if (quads == 0 && triangles == 4 && points_.size() == 4) return put(found_.tets, cone<4>());
        return false;
    }

    template <std::size_t N>
    bool put(FileCells<N>& into, const std::optional<std::array<Index, N>>& corners) {
        if (!corners) return false;
        into.corners.push_back(*corners);
        into.numbers.push_back(number_);
        return true;
    }

    // A face of so many corners, seen from inside the cell.
    [[nodiscard]] std::vector<Index> base(std::size_t corners) const {
        auto face = *std::ranges::find_if(faces_, [&](const auto& f) { return f.size() == corners; });
        std::reverse(face.begin(), face.end());
        return face;
    }

    // Two equal faces opposite each other: the corners of one, and those that edges join them with.
    template <std::size_t N>
    [[nodiscard]] std::optional<std::array<Index, N>> pillar() const {
        const std::vector<Index> bottom = base(N / 2);
        std::array<Index, N> corners;
        for (std::size_t k = 0; k < N / 2; ++k) {
            Index above = kNone;
            for (const auto& face : faces_) {
                const auto at = std::ranges::find(face, bottom[k]);
                if (at == face.end()) continue;
                const auto i = static_cast<std::size_t>(at - face.begin());
                for (const Index p : {face[(i + 1) % face.size()], face[(i + face.size() - 1) % face.size()]}) {
                    if (std::ranges::find(bottom, p) != bottom.end()) continue;
                    if (above != kNone && above != p) return std::nullopt;
                    above = p;
                }
            }
            if (above == kNone) return std::nullopt;
            corners[k] = bottom[k];
            corners[k + N / 2] = above;
        }
        auto all = corners;
        std::sort(all.begin(), all.end());
        return std::adjacent_find(all.begin(), all.end()) == all.end() ? std::optional(corners) : std::nullopt;
    }

    // A face and a point.
    template <std::size_t N>
    [[nodiscard]] std::optional<std::array<Index, N>> cone() const {
        const std::vector<Index> bottom = base(N - 1);
        std::array<Index, N> corners;
        std::copy(bottom.begin(), bottom.end(), corners.begin());
        corners[N - 1] = *std::ranges::find_if(points_, [&](Index p) { return std::ranges::find(bottom, p) == bottom.end(); });
        return corners;
    }

    // Both cells of a face cut it alike: into triangles from its smallest point, as other cells' quads are cut.
    void split() {
        if (ignore_others_) {
            ++left_out_;
            return;
        }
        ++polyhedra_;
        found_.cut = true;
        Vec3 middle(0.0);
        for (const Index p : points_) middle += found_.points[p] / static_cast<double>(points_.size());
        const auto apex = static_cast<Index>(found_.points.size());
        found_.points.push_back(middle);
        std::map<std::array<Index, 3>, std::array<Index, 3>> triangles;
        for (auto& face : faces_) {
            std::rotate(face.begin(), std::ranges::min_element(face), face.end());
            for (std::size_t k = 1; k + 1 < face.size(); ++k) {
                const std::array<Index, 3> triangle{face[0], face[k + 1], face[k]};
                auto key = triangle;
                std::sort(key.begin(), key.end());
                // Two faces of a cell may share three points: its part between them is flat, and the neighbours meet there.
                const auto [same, is_new] = triangles.try_emplace(key, triangle);
                if (!is_new) triangles.erase(same);
            }
        }
        for (const auto& [key, t] : triangles) {
            put(found_.tets, std::optional(std::array<Index, 4>{t[0], t[1], t[2], apex}));
            ++tets_;
        }
    }

    const FoamMesh& mesh_;
    bool ignore_others_;
    MeshFile& found_;
    std::vector<std::size_t> starts_;
    std::vector<Side> sides_;
    std::vector<std::vector<Index>> faces_;  // of the cell at hand
    std::vector<Index> points_;
    Index number_ = 0;
    std::size_t polyhedra_ = 0, tets_ = 0, left_out_ = 0;
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
            const fs::path folder = case_.parts[part_] / case_.folders[step_];
            for (const std::string& name : names_in(folder)) read_field(folder / name, name);
        }
        return std::move(found_);
    }

private:
    [[nodiscard]] fs::path file(const std::string& name) const { return case_.mesh_file(part_, step_, name); }

    // Before the points, so that no file contains more of anything than the others say.
    [[nodiscard]] FoamMesh read_faces() {
        FoamMesh mesh;
        mesh.owner = FoamText(file("owner")).labels();
        mesh.neighbour = FoamText(file("neighbour"), mesh.owner.size()).labels();
        FoamText faces(file("faces"), mesh.owner.size() + 1);
        mesh.faces = faces.faces();
        take(file("faces"), faces, 0);
        return mesh;
    }

    void read_points(const FoamMesh& mesh) {
        constexpr std::size_t kUnused = 1000;  // points of no face, which are harmless
        const auto& used = mesh.faces.points;
        const std::int64_t last = used.empty() ? 0 : std::max<std::int64_t>(0, *std::ranges::max_element(used));
        const fs::path path = file("points");
        FoamText text(path, 2 * static_cast<std::size_t>(last) + kUnused);
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
        const std::string of_points = file("points").string();
        TextScanner in(std::string_view(), of_points, TextScanner::Comments::None);
        in.name_no_place();
        refuse_not_finite(found_, in, kFoamNames);
    }

    // Those of the points in the whole mesh; points that were added in the middle of cells belong to no other part.
    void read_numbers() {
        const fs::path path = file("pointProcAddressing");
        std::error_code none;
        if (!fs::exists(path, none) && !fs::exists(path.string() + ".gz", none)) return;
        FoamText text(path);
        const auto numbers = text.labels();
        if (numbers.size() != points_) {
            text.fail(counted(numbers.size(), "number", "numbers") + " of points", std::to_string(points_) + " are needed");
        }
        FileArray array{"GlobalNodeId", 1, false, {}};
        for (const std::int64_t number : numbers) array.values.push_back(static_cast<double>(number));
        for (std::size_t p = points_; p < found_.points.size(); ++p) {
            array.values.push_back(static_cast<double>(part_ + 1) * 4294967296.0 + static_cast<double>(p));
        }
        found_.arrays.push_back(std::move(array));
    }

    void read_field(const fs::path& path, const std::string& name) {
        constexpr std::size_t kHeader = 4096;
        if (start_of_maybe_gzipped(path, kHeader).find("FoamFile") == std::string::npos) return;
        FoamText text(path);
        const std::size_t components = components_of_class(text.type());
        if (components == 0) return;
        take(path, text, cells_ * components * sizeof(double));  // "uniform" is one value for all cells
        found_.arrays.push_back({name, static_cast<int>(components), true, text.internal_field(components, cells_)});
    }

    void take(const fs::path& path, const FoamText& text, std::size_t made) {
        named_.take(path.string(), text.size(), made, [&] { return path.string(); });
    }

    const FoamCase& case_;
    std::size_t part_, step_;
    ReadOptions options_;
    NamedFiles& named_;
    MeshFile found_;
    std::size_t points_ = 0, cells_ = 0;
};

}  // namespace

ReadResult read_foam(const fs::path& path, const ReadOptions& options) {
    const FoamCase foam_case = find_foam_case(path);
    const std::string file = path.string();
    std::vector<std::string> warnings;
    const std::size_t step = chosen_step(options, std::max<std::size_t>(1, foam_case.times.size()), file, warnings);
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
