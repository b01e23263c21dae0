// SPDX-License-Identifier: Apache-2.0
// Triangles of a surface from a file; the extension names the format.
//
//     .stl   binary if the file is as long as its count of triangles says, else text ──► corners ──► welded
//     .obj   lines v and f; corners count from 1, or from the end if negative
//     .ply   elements vertex, face and tristrips; others are skipped
//     .glb   triangles of the scene ──► corners ──► welded
//
// Welding makes corners at exactly the same place one point, numbered as they first occur. Polygons become fans about their
// first corner, and triangles with a corner twice are left out. The surface is validated at the end. Errors name the file and
// the line or the byte.
#include "subvol/read_surface.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "glb_triangles.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/ply_table.h"
#include "subvol/detail/point_welder.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/fit_shape.h"

namespace subvol {

using namespace detail;

namespace {

constexpr std::size_t kStlHead = 84, kStlTriangle = 50;  // bytes

/// A fan of triangles about the first corner of a polygon; triangles with a corner twice are left out.
void add_polygon(std::span<const Index> corners, Surface& surface) {
    for (std::size_t k = 2; k < corners.size(); ++k) {
        const std::array<Index, 3> t{corners[0], corners[k - 1], corners[k]};
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) surface.triangles.push_back(t);
    }
}

/// Makes points at the same place one.
Surface welded(const std::vector<Vec3>& corners) {
    PointWelder welder(corners, 0);
    Surface surface;
    std::vector<Index> numbers(corners.size(), kNone);
    for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
        std::array<Index, 3> triangle;
        for (std::size_t k = 0; k < 3; ++k) {
            Index& number = numbers[welder.join(static_cast<Index>(t + k))];
            if (number == kNone) {
                number = static_cast<Index>(surface.points.size());
                surface.points.push_back(corners[t + k]);
            }
            triangle[k] = number;
        }
        add_polygon(triangle, surface);
    }
    return surface;
}

Surface read_binary_stl(std::string_view text) {
    std::vector<Vec3> corners;
    const std::size_t count = (text.size() - kStlHead) / kStlTriangle;
    corners.reserve(3 * count);
    for (std::size_t t = 0; t < count; ++t) {
        const std::string_view row = text.substr(kStlHead + t * kStlTriangle, kStlTriangle);
        constexpr std::size_t kFloat = 4, kNormal = 12;
        for (std::size_t k = 0; k < 3; ++k) {
            Vec3& x = corners.emplace_back();
            for (std::size_t a = 0; a < 3; ++a) {
                x[static_cast<int>(a)] =
                    real_from(row.substr(kNormal + kFloat * (3 * k + a)), NumberType::Float32, std::endian::little);
            }
        }
    }
    return welded(corners);
}

Vec3 read_point(TextScanner& in, const Place& place) {
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = in.real(place);
    return x;
}

Surface read_text_stl(TextScanner& in) {
    std::vector<Vec3> corners;
    std::size_t facets = 0;
    bool in_facet = false, in_solid = false;
    while (!in.at_end()) {
        const std::string_view key = in.word();
        const auto expect_facet = [&] {
            if (in_facet || corners.size() != 3 * facets) in.fail("a facet does not have 3 vertices");
        };
        if (key == "vertex") {
            if (!in_facet) in.fail("a vertex is in no facet");
            corners.push_back(read_point(in, {"vertex", static_cast<std::int64_t>(corners.size())}));
        } else if (key == "facet" || key == "endfacet") {
            if (in_facet == (key == "facet")) in.fail("a facet " + std::string(in_facet ? "does not end" : "ends twice"));
            in_facet = !in_facet;
            if (in_facet) {
                ++facets;
            } else {
                expect_facet();
            }
        } else if (key == "solid" || key == "endsolid") {
            expect_facet();
            if (in_solid == (key == "solid")) in.fail("a solid " + std::string(in_solid ? "does not end" : "ends twice"));
            in_solid = !in_solid;
            std::ignore = in.line();
        } else if (key == "normal") {
            std::ignore = read_point(in, {"normal"});
        } else if (key != "outer" && key != "loop" && key != "endloop") {
            in.fail(in_quotes(key) + " is not a word of an .stl file", "facet, vertex, endsolid");
        }
    }
    if (in_solid || in_facet) in.fail("the file ends within a solid", "its last line is endsolid");
    return welded(corners);
}

Surface read_stl(std::string_view text, std::string_view name) {
    constexpr std::size_t kCount = 80;
    if (text.size() >= kStlHead) {
        const auto count =
            static_cast<std::uint64_t>(integer_from(text.substr(kCount), NumberType::UInt32, std::endian::little));
        if (text.size() - kStlHead == count * kStlTriangle) return read_binary_stl(text);
        if (!text.starts_with("solid")) {
            TextScanner in(text, name, TextScanner::Comments::None);
            in.name_bytes();
            in.fail_at(kCount, "the file should have " + std::to_string(count) + " triangles",
                       "it has room for " + std::to_string((text.size() - kStlHead) / kStlTriangle));
        }
    }
    TextScanner in(text, name, TextScanner::Comments::None);
    if (!text.starts_with("solid")) in.fail("not an STL file: it is neither binary nor begins with \"solid\"");
    return read_text_stl(in);
}

/// One corner of an .obj face: "7", "7/1", "7/1/2" or "7//2"; from the end if negative.
Index obj_corner(std::string_view word, std::size_t points, TextScanner& in) {
    const std::string_view digits = word.substr(0, word.find('/'));
    std::int64_t number = 0;
    try {
        TextScanner one(digits, "", TextScanner::Comments::None);
        number = one.integer({"corner"});
    } catch (const Error&) {
        in.fail(in_quotes(word) + " is not a corner of a face", "such as 7 or 7/1/2");
    }
    const auto count = static_cast<std::int64_t>(points);
    const std::int64_t at = number > 0 ? number - 1 : count + number;
    if (number == 0 || at < 0 || at >= count) {
        in.fail("a face has the corner " + std::to_string(number), "1 to " + std::to_string(points) + ", the points so far");
    }
    return static_cast<Index>(at);
}

/// The line of an .obj vertex: three coordinates; a weight or a colour may follow.
Vec3 obj_point(TextScanner& in, std::size_t number) {
    std::string_view rest = in.line();
    rest = rest.substr(0, rest.find('#'));
    Vec3 x;
    int numbers = 0;
    for (rest = trimmed(rest); !rest.empty(); rest = trimmed(rest), ++numbers) {
        const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
        const auto value = number_from(rest.substr(0, end));
        if (!value)
            in.fail("vertex " + std::to_string(number) + ": a number is expected, not " + in_quotes(rest.substr(0, end)));
        if (numbers < 3) x[numbers] = *value;
        rest.remove_prefix(end);
    }
    if (numbers < 3 || numbers > 8)
        in.fail("vertex " + std::to_string(number) + " has " + counted(static_cast<std::size_t>(numbers), "number", "numbers"),
                "x, y and z; a weight or a colour may follow");
    return x;
}

Surface read_obj(std::string_view text, std::string_view name) {
    TextScanner in(text, name, TextScanner::Comments::Hash);
    Surface surface;
    std::vector<Index> polygon;
    while (!in.at_end()) {
        const std::string_view key = in.word();
        if (key == "v") {
            surface.points.push_back(obj_point(in, surface.points.size()));
        } else if (key == "f") {
            polygon.clear();
            std::string_view rest = in.line();
            rest = rest.substr(0, rest.find('#'));
            for (rest = trimmed(rest); !rest.empty(); rest = trimmed(rest)) {
                const std::size_t end = std::min(rest.find_first_of(" \t"), rest.size());
                polygon.push_back(obj_corner(rest.substr(0, end), surface.points.size(), in));
                rest.remove_prefix(end);
            }
            if (polygon.size() < 3) in.fail("a face has fewer than 3 corners");
            add_polygon(polygon, surface);
        } else {
            std::ignore = in.line();
        }
    }
    return surface;
}

/// Strips of triangles, each with two corners of the last; -1 ends a strip. Every other one is turned round.
void add_strips(std::span<const double> corners, Surface& surface, const TextScanner& in) {
    std::vector<Index> strip;
    std::size_t number = 0;
    for (const double corner : corners) {
        if (corner == -1) {
            strip.clear();
            ++number;
            continue;
        }
        strip.push_back(ply_corner(in, corner, surface.points.size(), "strips: number", number++));
        const std::size_t k = strip.size() - 1;
        if (k < 2) continue;
        std::array<Index, 3> t{strip[k - 2], strip[k - 1], strip[k]};
        if (k % 2 == 1) std::swap(t[0], t[1]);
        add_polygon(t, surface);
    }
}

Surface read_ply_surface(std::string_view text, std::string_view name) {
    TextScanner in(text, name, TextScanner::Comments::None);
    const PlyHeader header = read_ply_header(in);
    if (!header.ascii) in.name_bytes();
    Surface surface;
    bool points_read = false;
    for (const PlyElement& element : header.elements) {
        if (element.name == "vertex") {
            const PlyTable table = read_ply_element(in, header, element, {"x", "y", "z"});
            std::array<const std::vector<double>*, 3> columns{};
            for (std::size_t a = 0; a < 3; ++a) {
                const auto found = table.find(std::array{"x", "y", "z"}[a]);
                if (found == table.end() || found->second.values.size() != element.count) {
                    in.fail("element \"vertex\" has no numbers x, y and z");
                }
                columns[a] = &found->second.values;
            }
            for (std::size_t p = 0; p < element.count; ++p) {
                surface.points.emplace_back((*columns[0])[p], (*columns[1])[p], (*columns[2])[p]);
            }
            points_read = true;
        } else if (element.name == "face") {
            const PlyTable table = read_ply_element(in, header, element, {"vertex_indices", "vertex_index"});
            if (table.empty() || table.begin()->second.lengths.size() != element.count) {
                in.fail("element \"face\" has no list vertex_indices");
            }
            if (!points_read) in.fail("element \"face\" comes before \"vertex\"");
            const PlyColumn& corners = table.begin()->second;
            std::vector<Index> polygon;
            std::size_t next = 0;
            for (std::size_t f = 0; f < element.count; ++f) {
                polygon.clear();
                for (std::size_t k = 0; k < corners.lengths[f]; ++k) {
                    polygon.push_back(ply_corner(in, corners.values[next++], surface.points.size(), "face", f));
                }
                if (polygon.size() < 3) {
                    in.fail("face " + std::to_string(f) + " has " + counted(polygon.size(), "corner", "corners"), "at least 3");
                }
                add_polygon(polygon, surface);
            }
        } else if (element.name == "tristrips") {
            const PlyTable table = read_ply_element(in, header, element, {"vertex_indices"});
            if (!points_read || table.empty())
                in.fail("element \"tristrips\" comes before \"vertex\", or has no vertex_indices");
            add_strips(table.begin()->second.values, surface, in);
        } else {
            std::ignore = read_ply_element(in, header, element, {});
        }
    }
    expect_ply_end(in);
    return surface;
}

}  // namespace

bool is_surface_file(const std::filesystem::path& path) {
    return names_surface(path);
}

Surface read_surface(const std::filesystem::path& path) {
    const std::string format = upper_case(path.extension().string());
    if (!is_surface_file(path)) {
        throw Error(ErrorCode::InvalidInput, in_quotes(path.extension().string()) + " is not a format of surfaces",
                    path.string(), ".stl, .obj, .ply, .glb");
    }
    const std::string text = read_text(path), name = path.string();
    Surface surface = format == ".STL"   ? read_stl(text, name)
                      : format == ".OBJ" ? read_obj(text, name)
                      : format == ".GLB" ? welded(read_glb_triangles(text, name))
                                         : read_ply_surface(text, name);
    try {
        validate(surface);
    } catch (const Error& error) {
        throw Error(error.code(), error.what(), name);
    }
    return surface;
}

}  // namespace subvol
