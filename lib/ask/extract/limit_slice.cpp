// SPDX-License-Identifier: Apache-2.0
// Values of a field on a plane through the limit, contour lines of them, and their files. The plane cuts the box of the volume
// in a polygon; the rectangle around it is filled with squares, whose centres are the places:
//
//     plane, box → rectangle → places, row after row → values, gradients and cells at them → contour lines
//
// The longer side has as many places as the resolution says. A place outside the volume has NaN. For contour lines each square
// of four places is halved, and where a value lies between the ends of an edge of a triangle, the line crosses it, at the place
// of linear interpolation. A triangle is crossed at two edges or none; pieces with an edge in common are joined by its number,
// first those that have an end, then the closed ones. Triangles with a NaN have no lines.
#include "subvol/limit_slice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "subvol/detail/number_text.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/vtk_xml_writer.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/part_places.h"
#include "subvol/raster.h"

namespace subvol {

namespace {

bool is_finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The directions of a picture of a plane: its normal points at who looks at it.
std::array<Vec3, 2> axes_of(const Vec3& normal) {
    const bool level = std::abs(normal.z) > 0.999;
    const Vec3 up = level ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
    const Vec3 right = glm::normalize(glm::cross(up, normal));
    return {right, -glm::cross(normal, right)};
}

/// The part of the plane that is in a box, in its own coordinates.
struct Part {
    Vec2 lower{std::numeric_limits<double>::infinity()}, upper{-std::numeric_limits<double>::infinity()};
};

Part cut_box(const Box& box, const Vec3& point, const Vec3& normal, const Vec3& right, const Vec3& down) {
    Part part;
    const auto corner = [&](unsigned c) {
        return Vec3((c & 1) != 0 ? box.upper.x : box.lower.x, (c & 2) != 0 ? box.upper.y : box.lower.y,
                    (c & 4) != 0 ? box.upper.z : box.lower.z);
    };
    for (unsigned c = 0; c < 8; ++c) {
        for (unsigned axis = 1; axis < 8; axis *= 2) {
            if ((c & axis) != 0) continue;
            const Vec3 a = corner(c), b = corner(c | axis);
            const double from = glm::dot(a - point, normal), to = glm::dot(b - point, normal);
            if ((from > 0) == (to > 0) && from != 0 && to != 0) continue;
            for (const double t : from == to ? std::array{0.0, 1.0} : std::array{from / (from - to), from / (from - to)}) {
                const Vec3 x = (1 - t) * a + t * b - point;
                const Vec2 at(glm::dot(x, right), glm::dot(x, down));
                part.lower = glm::min(part.lower, at);
                part.upper = glm::max(part.upper, at);
            }
        }
    }
    return part;
}

/// Closed and open lines from pieces that meet at the same edges.
class LineJoiner {
public:
    using Edge = std::size_t;

    void add(Edge a, Edge b) {
        next_[a].push_back(b);
        next_[b].push_back(a);
    }

    /// Calls take(edges in order) for each line.
    template <class Take>
    void run(const Take& take) {
        for (const bool open : {true, false}) {
            for (auto& [edge, others] : next_) {
                while (!others.empty() && (!open || others.size() == 1)) take(follow(edge));
            }
        }
    }

private:
    std::vector<Edge> follow(Edge from) {
        std::vector<Edge> line{from};
        while (!next_[from].empty()) {
            const Edge to = next_[from].front();
            remove(from, to);
            remove(to, from);
            line.push_back(to);
            from = to;
        }
        return line;
    }
    void remove(Edge from, Edge to) {
        auto& list = next_[from];
        list.erase(std::ranges::find(list, to));
    }

    std::map<Edge, std::vector<Edge>> next_;
};

/// The lines of one value, in triangles: each square of places is halved.
void add_lines(const LimitSlice& slice, double value, std::vector<ContourLine>& lines) {
    const auto width = static_cast<std::size_t>(slice.width), height = static_cast<std::size_t>(slice.height);
    // The edges of a place: to the right 0, down 1, down and right 2.
    const auto edge = [&](std::size_t a, std::size_t b) {
        const std::size_t first = std::min(a, b), by = std::max(a, b) - first;
        return 3 * first + (by == 1 ? 0 : by == width ? 1 : 2);
    };
    LineJoiner joiner;
    for (std::size_t row = 0; row + 1 < height; ++row) {
        for (std::size_t column = 0; column + 1 < width; ++column) {
            const std::size_t p = row * width + column;
            for (const std::array<std::size_t, 3>& t :
                 {std::array{p, p + 1, p + width + 1}, std::array{p, p + width + 1, p + width}}) {
                if (std::isnan(slice.values[t[0]] + slice.values[t[1]] + slice.values[t[2]])) continue;
                std::array<std::size_t, 3> crossed{};
                std::size_t count = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::size_t a = t[k], b = t[(k + 1) % 3];
                    if ((slice.values[a] >= value) != (slice.values[b] >= value)) crossed[count++] = edge(a, b);
                }
                if (count == 2) joiner.add(crossed[0], crossed[1]);
            }
        }
    }
    joiner.run([&](const std::vector<std::size_t>& edges) {
        ContourLine line{value, {}};
        for (const std::size_t e : edges) {
            const std::size_t a = e / 3, b = a + (e % 3 == 0 ? 1 : e % 3 == 1 ? width : width + 1);
            const double t = (value - slice.values[a]) / (slice.values[b] - slice.values[a]);
            const Vec2 from(a % width, a / width), to(b % width, b / width);
            line.places.push_back((1 - t) * from + t * to);
        }
        lines.push_back(std::move(line));
    });
}

void write_csv(detail::OutputFile& out, const LimitSlice& slice) {
    using detail::exact_text;
    std::string table = "x,y,z,column,row,cell,";
    for (const char c : detail::printable(slice.field)) table += c == ',' || c == '"' || c == '\n' || c == '\r' ? '_' : c;
    table += ",dx,dy,dz\n";
    for (std::size_t p = 0; p < slice.values.size(); ++p) {
        if (slice.cells[p] == kNone) continue;
        const std::size_t column = p % static_cast<std::size_t>(slice.width), row = p / static_cast<std::size_t>(slice.width);
        const Vec3 x = slice.place(static_cast<double>(column), static_cast<double>(row)), &g = slice.gradients[p];
        table += exact_text(x.x) + "," + exact_text(x.y) + "," + exact_text(x.z) + "," + std::to_string(column) + "," +
                 std::to_string(row) + "," + std::to_string(slice.cells[p]) + "," + exact_text(slice.values[p]) + "," +
                 exact_text(g.x) + "," + exact_text(g.y) + "," + exact_text(g.z) + "\n";
        if (table.size() > (1U << 16)) {
            out.write(table);
            table.clear();
        }
    }
    out.write(table);
}

void write_vtp(detail::OutputFile& out, const LimitSlice& slice, std::span<const ContourLine> lines) {
    const auto width = static_cast<std::size_t>(slice.width);
    std::vector<Vec3> points;
    std::vector<double> values;
    std::vector<std::int64_t> numbers(slice.values.size(), -1), squares, line_corners, line_ends;
    for (std::size_t p = 0; p < slice.values.size(); ++p) {
        if (slice.cells[p] == kNone) continue;
        numbers[p] = static_cast<std::int64_t>(points.size());
        points.push_back(slice.place(static_cast<double>(p % width), static_cast<double>(p / width)));
        values.push_back(slice.values[p]);
    }
    for (std::size_t p = 0; p + width + 1 < slice.values.size(); ++p) {
        if (p % width == width - 1) continue;
        const std::array<std::int64_t, 4> square{numbers[p], numbers[p + width], numbers[p + width + 1], numbers[p + 1]};
        if (std::ranges::find(square, -1) == square.end()) squares.insert(squares.end(), square.begin(), square.end());
    }
    for (const ContourLine& line : lines) {
        for (const Vec2& at : line.places) {
            line_corners.push_back(static_cast<std::int64_t>(points.size()));
            points.push_back(slice.place(at.x, at.y));
            values.push_back(line.value);
        }
        line_ends.push_back(static_cast<std::int64_t>(line_corners.size()));
    }
    detail::VtkXmlWriter xml(out, "PolyData");
    xml.line("<Piece NumberOfPoints=\"" + std::to_string(points.size()) + "\" NumberOfVerts=\"0\" NumberOfLines=\"" +
             std::to_string(line_ends.size()) + "\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
             std::to_string(squares.size() / 4) + "\">\n<Points>");
    xml.made_array<double>("Points", 3, 3 * points.size(),
                           [&](std::size_t i) { return points[i / 3][static_cast<int>(i % 3)]; });
    xml.line("</Points>\n<Lines>");
    xml.array<std::int64_t>("connectivity", 1, line_corners);
    xml.array<std::int64_t>("offsets", 1, line_ends);
    xml.line("</Lines>\n<Polys>");
    xml.array<std::int64_t>("connectivity", 1, squares);
    xml.made_array<std::int64_t>("offsets", 1, squares.size() / 4,
                                 [](std::size_t q) { return static_cast<std::int64_t>(4 * q + 4); });
    xml.line("</Polys>\n<PointData Scalars=\"" + detail::attribute_value(slice.field) + "\">");
    xml.array<double>(slice.field, 1, values);
    xml.line("</PointData>\n</Piece>");
    xml.end();
}

/// throws: Error(InvalidInput) if the normal has no length, or an option is out of range
void check_plane(const Vec3& point, const Vec3& normal, const SliceOptions& options) {
    if (!is_finite(point) || !is_finite(normal) || !(glm::length(normal) > 0)) {
        throw Error(ErrorCode::InvalidInput, "the plane has no place or no direction", "slice", "a point and a normal");
    }
    if (options.resolution < 2 || options.resolution > 20000) {
        throw Error(ErrorCode::InvalidInput, "the resolution is " + std::to_string(options.resolution), "slice", "2 to 20,000");
    }
}

/// A slice without values: its places cover the part of a plane that is in a box.
///
/// throws: Error(InvalidInput) if the plane misses the box
LimitSlice empty_slice(const Box& box, const Vec3& point, const Vec3& normal, const SliceOptions& options) {
    LimitSlice slice;
    const Vec3 facing = glm::normalize(normal);
    const auto [right, down] = axes_of(facing);
    const Part part = cut_box(box, point, facing, right, down);
    if (!(part.lower.x <= part.upper.x)) {
        throw Error(ErrorCode::InvalidInput, "the plane misses the volume", "slice", "a point within its box");
    }
    const Vec2 size = part.upper - part.lower;
    // Places are the centres of squares.
    const double step = std::max(std::max(size.x, size.y) / options.resolution, 1e-300);
    slice.width = std::clamp(static_cast<int>(std::ceil(size.x / step - 1e-6)), 1, options.resolution);
    slice.height = std::clamp(static_cast<int>(std::ceil(size.y / step - 1e-6)), 1, options.resolution);
    constexpr std::int64_t kMostPlaces = std::int64_t{1} << 28;  // as the pixels of a picture
    if (std::int64_t{slice.width} * slice.height > kMostPlaces) {
        throw Error(ErrorCode::InvalidInput,
                    std::to_string(slice.width) + " x " + std::to_string(slice.height) + " places are too many", "slice",
                    "at most 2^28; a lower resolution");
    }
    slice.right = step * right;
    slice.down = step * down;
    const Vec2 middle = 0.5 * (part.lower + part.upper);
    slice.origin = point + middle.x * right + middle.y * down - 0.5 * (slice.width - 1) * slice.right -
                   0.5 * (slice.height - 1) * slice.down;
    return slice;
}

std::vector<Vec3> places_of(const LimitSlice& slice) {
    std::vector<Vec3> places;
    places.reserve(pixel_count(slice.width, slice.height));
    for (int row = 0; row < slice.height; ++row) {
        for (int column = 0; column < slice.width; ++column) places.push_back(slice.place(column, row));
    }
    return places;
}

/// Puts the first field that was found at the places into the slice, and counts.
///
/// throws: Error(InvalidInput) if no place is in the volume
void take_found(LimitSlice& slice, ProbeResult found) {
    slice.values = std::move(found.fields[0].values);
    slice.gradients = std::move(found.fields[0].gradients);
    slice.cells = std::move(found.cells);
    slice.min = std::numeric_limits<double>::infinity();
    slice.max = -slice.min;
    for (std::size_t p = 0; p < slice.values.size(); ++p) {
        if (slice.cells[p] == kNone) {
            slice.values[p] = std::numeric_limits<double>::quiet_NaN();
            continue;
        }
        ++slice.inside;
        const auto width = static_cast<std::size_t>(slice.width);
        const Vec3 at = slice.place(static_cast<double>(p % width), static_cast<double>(p / width));
        if (slice.values[p] < slice.min) std::tie(slice.min, slice.min_at) = std::pair(slice.values[p], at);
        if (slice.values[p] > slice.max) std::tie(slice.max, slice.max_at) = std::pair(slice.values[p], at);
    }
    if (slice.inside == 0) {
        throw Error(ErrorCode::InvalidInput, "no place on the plane is in the volume", "slice",
                    "another plane, or a higher resolution");
    }
}

}  // namespace

LimitSlice slice_limit(const MeshSource& source, std::string_view field, const Vec3& point, const Vec3& normal,
                       const SliceOptions& options) {
    check_plane(point, normal, options);
    if (const HexMesh* mesh = source.mesh()) {
        validate(*mesh);
        HexMesh chosen = with_scalar_field(*mesh, field);
        const std::string name = chosen.attributes.front().name;
        LimitSlice slice;
        if (!options.cells.empty()) {
            if (options.cells.size() != chosen.cells.size())
                throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(options.cells.size()) + " flags of cells",
                            "slice", "one for each of the cells");
            Box box;
            for (std::size_t c = 0; c < chosen.cells.size(); ++c) {
                for (const Index p : chosen.cells[c]) {
                    if (options.cells[c] != 0) box.add(chosen.points[p]);
                }
            }
            slice = empty_slice(box, point, normal, options);
            ProbeResult found = probe_limit(chosen, places_of(slice), {.limit = options.limit}, options.progress);
            keep_places_in(chosen, options.cells, found);
            take_found(slice, std::move(found));
        } else if (chosen.cells.size() > kMostCellsOfAProbe) {
            slice = empty_slice(bounds(chosen), point, normal, options);
            take_found(slice, probe_limit(chosen, places_of(slice), {.limit = options.limit}, options.progress));
        } else {
            const LimitProbe probe(std::move(chosen), {.limit = options.limit});
            slice = empty_slice(probe.box(), point, normal, options);
            take_found(slice, probe.at(places_of(slice), options.progress));
        }
        slice.field = name;
        return slice;
    }
    LimitSlice slice = empty_slice(source.bounds(), point, normal, options);
    const MeshSource scalar = source.changed([&](const HexMesh& piece) {
        HexMesh chosen = with_scalar_field(piece, field);
        slice.field = chosen.attributes.front().name;
        return chosen;
    });
    take_found(slice, probe_limit(scalar, places_of(slice), {.limit = options.limit}, options.progress));
    return slice;
}

std::vector<ContourLine> contour_lines(const LimitSlice& slice, std::span<const double> values) {
    std::vector<ContourLine> lines;
    for (const double value : values) add_lines(slice, value, lines);
    return lines;
}

void write_slice(const std::filesystem::path& path, const LimitSlice& slice, std::span<const ContourLine> lines) {
    const std::string extension = path.extension().string();
    if (extension != ".csv" && extension != ".vtp") {
        throw Error(ErrorCode::InvalidInput, "'" + detail::printable(extension) + "' is not a format of slices", path.string(),
                    ".csv, .vtp");
    }
    detail::OutputFile out(path);
    if (extension == ".csv") {
        write_csv(out, slice);
    } else {
        write_vtp(out, slice, lines);
    }
    out.commit();
}

std::vector<Option> options_of(SliceOptions& options) {
    return {Option("resolution", options.resolution).between(2, 20000).help("N", "places along the longer side")};
}

}  // namespace subvol
