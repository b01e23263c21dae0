#include "subvol/study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "studies.h"
#include "subvol/error.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"

namespace subvol {

namespace {

struct Study {
    const char* name;
    const char* description;
    std::vector<StudyTable> (*run)(const StudyOptions&);
};

constexpr std::array<Study, 3> kStudies{{
    {"table2", "the paper's table 2: its seven models, errors of value rules at the points of one refinement",
     detail::study_table2},
    {"order", "how fast corrected kernels converge inside, at irregular edges and at the boundary", detail::study_order},
    {"spacing", "error of the field by kernel and spacing", detail::study_spacing},
}};

std::string cell_text(const StudyTable::Cell& cell) {
    if (const auto* words = std::get_if<std::string>(&cell)) return *words;
    const double number = std::get<double>(cell);
    if (std::isnan(number)) return "-";
    std::array<char, 32> text{};
    const bool count = number == std::floor(number) && std::abs(number) < 1e15;
    std::snprintf(text.data(), text.size(), count ? "%.0f" : "%.4g", number);
    return text.data();
}

/// Columns of UTF-8 text are counted in characters.
std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

std::vector<StudyInfo> list_studies() {
    std::vector<StudyInfo> studies;
    for (const Study& study : kStudies) studies.push_back({study.name, study.description});
    return studies;
}

std::vector<StudyTable> run_study(const std::string& name, const StudyOptions& options) {
    std::string known;
    for (const Study& study : kStudies) {
        if (name == study.name) return study.run(options);
        known += (known.empty() ? "" : ", ") + std::string(study.name);
    }
    throw Error(ErrorCode::InvalidInput, "there is no study '" + name + "'", {}, known);
}

std::string as_text(const StudyTable& table) {
    std::vector<std::vector<std::string>> lines{table.columns};
    for (const auto& row : table.rows) {
        auto& line = lines.emplace_back();
        for (const auto& cell : row) line.push_back(cell_text(cell));
    }
    std::vector<std::size_t> widths(table.columns.size());
    for (const auto& line : lines) {
        for (std::size_t c = 0; c < line.size(); ++c) widths[c] = std::max(widths[c], width_of(line[c]));
    }
    std::string text = table.caption + "\n";
    for (const auto& line : lines) {
        for (std::size_t c = 0; c < line.size(); ++c) {
            const std::string blanks(widths[c] - width_of(line[c]), ' ');
            text += c == 0 ? line[c] + blanks : "  " + blanks + line[c];
        }
        text += '\n';
    }
    return text;
}

std::string as_csv(const StudyTable& table) {
    std::string text;
    const auto put = [&](const std::string& field, bool last) {
        std::string quoted;
        for (const char c : field) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
        text += '"' + quoted + '"' + (last ? "\n" : ",");
    };
    for (std::size_t c = 0; c < table.columns.size(); ++c) put(table.columns[c], c + 1 == table.columns.size());
    for (const auto& row : table.rows) {
        for (std::size_t c = 0; c < row.size(); ++c) put(cell_text(row[c]), c + 1 == row.size());
    }
    return text;
}

void detail::put_smooth_density(HexMesh& mesh) {
    const Box box = bounds(mesh);
    const double unit = 2 / box.diagonal() * std::sqrt(3.0);
    Attribute density{.name = "density", .channels = 1, .values = {}};
    for (const Vec3& p : mesh.points) {
        const Vec3 x = unit * (p - box.center());
        density.values.push_back(.5 * (std::sin(3 * x.x) * std::cos(2 * x.y) + x.z));
    }
    mesh.attributes = {std::move(density)};
}

std::vector<detail::StudyMesh> detail::smooth_meshes(int pawn, int ball, const StudyOptions& options) {
    std::vector<StudyMesh> meshes{{"pawn", make_model("pawn", pawn)}, {"ball", make_model("ball", ball)}};
    for (const auto& path : options.meshes) {
        meshes.push_back({path.stem().string(), without_unused_points(read_mesh(path).mesh)});
    }
    for (StudyMesh& mesh : meshes) put_smooth_density(mesh.mesh);
    return meshes;
}

double detail::order_of(double coarse, double fine) {
    return fine > 0 ? std::log2(coarse / fine) : std::nan("");
}

}  // namespace subvol
