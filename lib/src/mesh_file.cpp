#include "mesh_file.h"

#include <algorithm>
#include <cmath>

#include "subvol/error.h"
#include "subvol/mesh_report.h"

namespace subvol {

namespace {

// The ends of the three edges at each corner, such that a right-handed cell has a positive determinant there.
constexpr std::array<std::array<int, 3>, 8> kCornerEdges{
    {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7}, {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}}};

std::array<Vec3, 8> corners_of(const HexMesh& mesh, const std::array<Index, 8>& cell) {
    std::array<Vec3, 8> corners;
    for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[cell[k]];
    return corners;
}

bool is_folded(const std::array<Vec3, 8>& x) {
    for (std::size_t k = 0; k < 8; ++k) {
        const auto edge = [&](std::size_t e) { return x[static_cast<std::size_t>(kCornerEdges[k][e])] - x[k]; };
        if (glm::dot(edge(0), glm::cross(edge(1), edge(2))) < 0) return true;
    }
    return false;
}

void warn_of_handedness(ReadResult& result) {
    const std::string of_all = " of " + counted(result.mesh.cells.size(), "hexahedron", "hexahedra");
    const std::size_t turned = orient_cells(result.mesh);
    if (turned > 0) {
        result.warnings.push_back(std::to_string(turned) + of_all + (turned == 1 ? " was" : " were") +
                                  " left-handed (negative Jacobian) and turned round");
    }
    const auto folded = std::count_if(result.mesh.cells.begin(), result.mesh.cells.end(),
                                      [&](const auto& cell) { return is_folded(corners_of(result.mesh, cell)); });
    if (folded > 0) {
        result.warnings.push_back(std::to_string(folded) + of_all + (folded == 1 ? " has" : " have") +
                                  " a negative Jacobian at a corner");
    }
}

std::vector<std::uint8_t> used_points(const HexMesh& mesh) {
    std::vector<std::uint8_t> used(mesh.points.size());
    for (const auto& cell : mesh.cells) {
        for (const Index p : cell) used[p] = 1;
    }
    return used;
}

FieldInfo describe(const FileArray& array) {
    FieldInfo info{array.name, array.at_cells ? "cell" : "point", array.components, 0, 0};
    const auto components = static_cast<std::size_t>(array.components);
    bool first = true;
    for (std::size_t i = 0; i + components <= array.values.size(); i += components) {
        double value = array.values[i];
        if (components > 1) {
            double sum = 0;
            for (std::size_t c = 0; c < components; ++c) sum += array.values[i + c] * array.values[i + c];
            value = std::sqrt(sum);
        }
        if (!std::isfinite(value)) continue;
        info.min = first ? value : std::min(info.min, value);
        info.max = first ? value : std::max(info.max, value);
        first = false;
    }
    return info;
}

// Cells without volume would have no say; where all the cells at a point are such, each counts the same.
std::vector<double> mean_over_cells(const HexMesh& mesh, const std::vector<double>& values, std::size_t components) {
    std::vector<double> sums(mesh.points.size() * components);
    std::vector<double> plain_sums(sums.size());
    std::vector<double> weights(mesh.points.size());
    std::vector<double> counts(mesh.points.size());
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        const double volume = cell_volume(corners_of(mesh, mesh.cells[c]));
        for (const Index p : mesh.cells[c]) {
            weights[p] += volume;
            counts[p] += 1;
            for (std::size_t k = 0; k < components; ++k) {
                sums[p * components + k] += volume * values[c * components + k];
                plain_sums[p * components + k] += values[c * components + k];
            }
        }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const std::size_t p = i / components;
        if (counts[p] == 0) continue;
        sums[i] = weights[p] > 0 ? sums[i] / weights[p] : plain_sums[i] / counts[p];
    }
    return sums;
}

class ArrayConversion {
public:
    ArrayConversion(ReadResult& result, const MeshFile& found, std::string_view file, const Wording& wording)
        : result_(result), found_(found), file_(file), wording_(wording), used_(used_points(result.mesh)) {}

    void take(FileArray&& array) {
        result_.fields.push_back(describe(array));
        const FieldInfo& info = result_.fields.back();
        if (array.components == 1 && upper_case(array.name) == "DENSITY" && info.min < 0) {
            result_.warnings.push_back("\"" + array.name + "\" has negative values");
        }
        Attribute attribute{unused_name(array.name), array.components, {}};
        attribute.values = array.at_cells ? to_points(array) : checked_points(std::move(array));
        result_.mesh.attributes.push_back(std::move(attribute));
    }

private:
    [[noreturn]] void refuse(const std::string& array, const std::string& entity) const {
        throw Error(ErrorCode::InvalidInput, "the value at " + entity + " is not finite",
                    std::string(file_) + ", array \"" + array + "\"");
    }

    std::vector<double> checked_points(FileArray&& array) const {
        for (std::size_t i = 0; i < array.values.size(); ++i) {
            const std::size_t p = i / static_cast<std::size_t>(array.components);
            if (!std::isfinite(array.values[i]) && used_[p]) refuse(array.name, wording_.name_point(p));
        }
        return std::move(array.values);
    }

    std::vector<double> to_points(const FileArray& array) const {
        const auto components = static_cast<std::size_t>(array.components);
        const auto& numbers = found_.hex_numbers;
        std::vector<double> of_hexes;
        of_hexes.reserve(result_.mesh.cells.size() * components);
        for (std::size_t c = 0; c < result_.mesh.cells.size(); ++c) {
            const std::size_t number = numbers.empty() ? c : numbers[c];
            for (std::size_t k = 0; k < components; ++k) {
                of_hexes.push_back(array.values[number * components + k]);
                if (!std::isfinite(of_hexes.back())) refuse(array.name, wording_.name_cell(number));
            }
        }
        result_.warnings.push_back("cell array \"" + array.name +
                                   "\" became a point array: the volume-weighted mean over the cells at each point");
        return mean_over_cells(result_.mesh, of_hexes, components);
    }

    std::string unused_name(const std::string& name) const {
        std::string candidate = name;
        for (int k = 2; result_.mesh.find_attribute(candidate) != nullptr; ++k) candidate = name + "_" + std::to_string(k);
        if (candidate != name) {
            result_.warnings.push_back("there is more than one array \"" + name + "\": another is called \"" + candidate +
                                       "\"");
        }
        return candidate;
    }

    ReadResult& result_;
    const MeshFile& found_;
    std::string_view file_;
    const Wording& wording_;
    std::vector<std::uint8_t> used_;
};

}  // namespace

void read_point(TextScanner& in, MeshFile& into, const Wording& wording, std::size_t of) {
    const std::size_t p = into.points.size();
    const Place place{wording.point, static_cast<std::int64_t>(p + wording.first), of};
    Vec3& x = into.points.emplace_back();
    for (int i = 0; i < 3; ++i) {
        x[i] = in.real(place);
        if (!std::isfinite(x[i])) into.not_finite.push_back({p, in.position()});
    }
}

void check_corners(const TextScanner& in, std::size_t position, const std::array<Index, 8>& hex, std::size_t cell,
                   const Wording& wording) {
    auto sorted = hex;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice == sorted.end()) return;
    in.fail_at(position, wording.name_cell(cell) + " has " + wording.name_point(*twice) + " twice",
               "a hexahedron needs 8 different corners");
}

ReadResult finish(MeshFile&& found, const TextScanner& in, std::string_view file, const Wording& wording) {
    ReadResult result;
    result.mesh.points = std::move(found.points);
    result.mesh.cells = std::move(found.hexes);
    result.warnings = std::move(found.warnings);
    if (!found.not_finite.empty()) {
        const auto used = used_points(result.mesh);
        for (const auto& [point, position] : found.not_finite) {
            if (used[point]) in.fail_at(position, "non-finite coordinate at " + wording.name_point(point));
        }
    }
    warn_of_handedness(result);
    auto arrays = std::move(found.arrays);
    ArrayConversion conversion(result, found, file, wording);
    for (auto& array : arrays) conversion.take(std::move(array));
    try {
        validate(result.mesh);
    } catch (const Error& error) {
        throw Error(error.code(), error.what(), std::string(file));
    }
    return result;
}

}  // namespace subvol
