// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "assemble.h"
#include "foam_case.h"
#include "foam_cells.h"
#include "gzip.h"
#include "join_pieces.h"
#include "named_files.h"
#include "steps.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

namespace fs = std::filesystem;

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
    PartReader(const FoamCase& of, std::size_t part, std::size_t step, const ReadOptions& options, NamedFiles& named)
        : case_(of), part_(part), step_(step), options_(options), named_(named) {}

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
    const FoamCase of = find_foam_case(path);
    const std::string file = path.string();
    std::vector<std::string> warnings;
    const std::size_t step = chosen_step(options, std::max<std::size_t>(1, of.times.size()), file, warnings);
    NamedFiles named;
    std::vector<MeshFile> parts;
    for (std::size_t part = 0; part < of.parts.size(); ++part) {
        parts.push_back(PartReader(of, part, step, options, named).read());
    }
    MeshFile found = parts.size() == 1 ? std::move(parts.front()) : join_pieces(std::move(parts), "processor", file);
    if (of.decomposed) {
        std::erase_if(found.arrays, [](const FileArray& array) { return array.name == "GlobalNodeId"; });
    }
    found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
    add_left_out_warning(found, {}, file);
    return assemble(std::move(found), file, kFoamNames, options);
}

}  // namespace subvol::detail
