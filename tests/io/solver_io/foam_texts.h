// SPDX-License-Identifier: Apache-2.0
// The files of OpenFOAM cases as texts.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "io/mesh_io/mesh_texts.h"
#include "subvol/hex_mesh.h"

namespace subvol::test::foam {

// How numbers are written.
struct Form {
    bool binary = false;
    bool wide_labels = false, wide_reals = true;
    bool gzipped = false;
};

template <class Number>
inline std::string raw(const std::vector<Number>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)};
}

inline std::string header(const std::string& type, const Form& form) {
    return std::string("/* a comment */\nFoamFile\n{\n    version 2.0;\n    format ") + (form.binary ? "binary" : "ascii") +
           ";\n    class " + type + ";\n    arch \"LSB;label=" + (form.wide_labels ? "64" : "32") +
           ";scalar=" + (form.wide_reals ? "64" : "32") + "\";\n    object x;\n}\n// * * //\n\n";
}

inline std::string labels(const std::vector<int>& values, const Form& form) {
    std::string text = std::to_string(values.size()) + "\n(";
    if (form.binary) {
        text += form.wide_labels ? raw(std::vector<std::int64_t>(values.begin(), values.end()))
                                 : raw(std::vector<std::int32_t>(values.begin(), values.end()));
    } else {
        for (const int value : values) text += " " + std::to_string(value);
    }
    return text + ")\n";
}

inline std::string reals(const std::vector<double>& values, std::size_t components, const Form& form) {
    std::string text = std::to_string(values.size() / components) + "\n(";
    if (form.binary)
        return text + (form.wide_reals ? raw(values) : raw(std::vector<float>(values.begin(), values.end()))) + ")\n";
    for (std::size_t i = 0; i < values.size(); ++i) {
        text += (components > 1 && i % components == 0 ? "(" : " ") + number(values[i]);
        if (components > 1 && i % components == components - 1) text += ")\n";
    }
    return text + ")\n";
}

// Polyhedra by their faces, outward normals, as OpenFOAM orders them: faces between cells first.
struct Polyhedra {
    std::vector<Vec3> points;
    std::vector<std::vector<int>> faces;
    std::vector<int> owner, neighbour;
};

// cells: each a list of faces whose normals point out of it
inline Polyhedra polyhedra(const std::vector<Vec3>& points, const std::vector<std::vector<std::vector<int>>>& cells) {
    Polyhedra mesh{points, {}, {}, {}};
    const auto sorted = [](std::vector<int> face) {
        std::sort(face.begin(), face.end());
        return face;
    };
    for (const bool inside : {true, false}) {
        for (std::size_t c = 0; c < cells.size(); ++c) {
            for (const auto& face : cells[c]) {
                int other = -1;
                for (std::size_t d = 0; d < cells.size(); ++d) {
                    for (const auto& of_other : cells[d]) {
                        if (d != c && sorted(of_other) == sorted(face)) other = static_cast<int>(d);
                    }
                }
                if ((other >= 0) != inside || (inside && other < static_cast<int>(c))) continue;
                mesh.faces.push_back(face);
                mesh.owner.push_back(static_cast<int>(c));
                if (inside) mesh.neighbour.push_back(other);
            }
        }
    }
    return mesh;
}

inline std::vector<std::vector<int>> faces_of_hex(const std::array<Index, 8>& c) {
    std::vector<std::vector<int>> faces;
    for (const std::array<int, 4> f : {std::array{0, 3, 2, 1}, std::array{4, 5, 6, 7}, std::array{0, 1, 5, 4},
                                       std::array{1, 2, 6, 5}, std::array{2, 3, 7, 6}, std::array{3, 0, 4, 7}}) {
        auto& face = faces.emplace_back();
        for (const int k : f) face.push_back(static_cast<int>(c[static_cast<std::size_t>(k)]));
    }
    return faces;
}

inline std::string points_text(const std::vector<Vec3>& points, const Form& form) {
    std::vector<double> coordinates;
    for (const Vec3& x : points) coordinates.insert(coordinates.end(), {x.x, x.y, x.z});
    return header("vectorField", form) + reals(coordinates, 3, form);
}

/// The files of a folder polyMesh, by their names.
inline std::map<std::string, std::string> mesh_texts(const Polyhedra& mesh, const Form& form) {
    std::vector<int> starts{0}, all;
    std::string list = std::to_string(mesh.faces.size()) + "\n(\n";
    for (const auto& face : mesh.faces) {
        all.insert(all.end(), face.begin(), face.end());
        starts.push_back(static_cast<int>(all.size()));
        list += labels(face, {});
    }
    return {{"points", points_text(mesh.points, form)},
            {"faces", form.binary ? header("faceCompactList", form) + labels(starts, form) + labels(all, form)
                                  : header("faceList", form) + list + ")\n"},
            {"owner", header("labelList", form) + labels(mesh.owner, form)},
            {"neighbour", header("labelList", form) + labels(mesh.neighbour, form)}};
}

/// The files of a case that is cut along x into processors, each with its number as the field p of the step 3.
inline std::map<std::string, std::string> case_of_processors(const HexMesh& whole, int count) {
    std::map<std::string, std::string> files;
    double last = 0;
    for (const Vec3& x : whole.points) last = std::max(last, x.x);
    for (int part = 0; part < count; ++part) {
        std::vector<std::array<Index, 8>> taken;
        std::vector<int> numbers;
        for (const auto& cell : whole.cells) {
            if (static_cast<int>(whole.points[cell[0]].x * count / last) != part) continue;
            taken.push_back(cell);
            for (const Index p : cell) numbers.push_back(static_cast<int>(p));
        }
        std::sort(numbers.begin(), numbers.end());
        numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
        std::vector<Vec3> points;
        for (const int p : numbers) points.push_back(whole.points[static_cast<std::size_t>(p)]);
        std::vector<std::vector<std::vector<int>>> cells;
        for (auto& cell : taken) {
            for (Index& p : cell) {
                p = static_cast<Index>(std::ranges::lower_bound(numbers, static_cast<int>(p)) - numbers.begin());
            }
            cells.push_back(faces_of_hex(cell));
        }
        const std::string folder = "processor" + std::to_string(part) + "/", mesh = folder + "constant/polyMesh/";
        for (const auto& [name, text] : mesh_texts(polyhedra(points, cells), {})) files[mesh + name] = text;
        files[mesh + "pointProcAddressing"] = header("labelList", {}) + labels(numbers, {});
        std::string patches;
        int neighbours = 0;
        for (const int other : {part - 1, part + 1}) {
            if (other < 0 || other == count) continue;
            ++neighbours;
            patches += "procBoundary" + std::to_string(part) + "to" + std::to_string(other) +
                       " { type processor; nFaces 0; startFace 0; neighbProcNo " + std::to_string(other) + "; }\n";
        }
        files[mesh + "boundary"] = header("polyBoundaryMesh", {}) + std::to_string(neighbours) + "\n(\n" + patches + ")\n";
        files[folder + "3/p"] = header("volScalarField", {}) + "internalField uniform " + std::to_string(part) + ";";
    }
    return files;
}

}  // namespace subvol::test::foam
