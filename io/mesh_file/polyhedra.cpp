// SPDX-License-Identifier: Apache-2.0
// Cells that are given by their faces.
//
//     faces ─► closed?   each edge has two faces, else the cell is left out
//           ─► turned    from face to face over edges, so that all have one hand; the volume decides which
//           ─► known     six quads: a hexahedron; two triangles and three quads: a prism; a quad and four triangles: a pyramid;
//                        four triangles: a tetrahedron
//           ─► other     cut from the middle: each face into triangles from one of its points, each triangle and the middle a
//                        tetrahedron; fields have the mean of the cell's points in the middle
//
// The middle is the mean of the points. Faces that are not flat may hide it from a triangle, whose tetrahedron would then lie
// outside of the cell; it is moved towards the cell's points until it sees all triangles, if such a place is found.
//
// A face is cut alike by both of its cells: from its smallest point, or in faces of more than four points the smallest one
// that gives no flat triangle and, where that can be, none that is turned over. Two triangles of a cell at the same points
// cancel. Faces that a file does not give follow from the hull of the corners: every plane through three of them that has all
// others on one side.
#include "polyhedra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "join_pieces.h"
#include "subvol/detail/byte_hash.h"

namespace subvol::detail {

namespace {

std::size_t faces_with(const CellFaces& faces, std::size_t corners) {
    return static_cast<std::size_t>(std::ranges::count_if(faces, [&](const auto& face) { return face.size() == corners; }));
}

// A face of so many corners, seen from inside the cell.
std::vector<Index> base(const CellFaces& faces, std::size_t corners) {
    auto face = *std::ranges::find_if(faces, [&](const auto& f) { return f.size() == corners; });
    std::reverse(face.begin(), face.end());
    return face;
}

// Two equal faces opposite each other: the corners of one, and those that edges join them with.
template <std::size_t N>
std::optional<std::array<Index, N>> pillar(const CellFaces& faces) {
    const std::vector<Index> bottom = base(faces, N / 2);
    std::array<Index, N> corners;
    for (std::size_t k = 0; k < N / 2; ++k) {
        Index above = kNone;
        for (const auto& face : faces) {
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
std::optional<std::array<Index, N>> cone(const CellFaces& faces, const std::vector<Index>& points) {
    const std::vector<Index> bottom = base(faces, N - 1);
    std::array<Index, N> corners;
    std::copy(bottom.begin(), bottom.end(), corners.begin());
    const auto tip = std::ranges::find_if(points, [&](Index p) { return std::ranges::find(bottom, p) == bottom.end(); });
    if (tip == points.end()) return std::nullopt;
    corners[N - 1] = *tip;
    return corners;
}

// Turns a face so that triangles from its first point have areas: that is its smallest point, as of the quads of other cells,
// but in faces of more points with some on a line, or with a corner that points inwards, the smallest one with such triangles,
// of which none is turned over if there is a choice. Both cells of a face choose alike.
void start_fan(std::vector<Index>& face, const std::vector<Vec3>& points) {
    std::rotate(face.begin(), std::ranges::min_element(face), face.end());
    if (face.size() <= 4) return;
    constexpr double kFlat = 1e-9;          // of the largest triangle
    constexpr std::size_t kMostTried = 64;  // a face of a hostile file may have any number of points
    const auto normal_of = [&](const std::vector<Index>& fan, std::size_t i) {
        const Vec3 a = points[fan[0]];
        return glm::cross(points[fan[i]] - a, points[fan[i + 1]] - a);
    };
    Vec3 of_face(0.0);
    for (std::size_t i = 1; i + 1 < face.size(); ++i) of_face += normal_of(face, i);
    if (const double length = glm::length(of_face); length > 0) of_face /= length;
    std::vector<Index> best = face, turned = face;
    int best_is = 0;  // 1: no triangle is flat, 2: and none is turned over
    for (std::size_t k = 0; k < std::min(face.size(), kMostTried); ++k) {
        double least = HUGE_VAL, least_along = HUGE_VAL, largest = 0;
        for (std::size_t i = 1; i + 1 < turned.size(); ++i) {
            const Vec3 normal = normal_of(turned, i);
            least = std::min(least, glm::length(normal));
            least_along = std::min(least_along, glm::dot(normal, of_face));
            largest = std::max(largest, glm::length(normal));
        }
        const int is = least_along > kFlat * largest ? 2 : least > kFlat * largest ? 1 : 0;
        if (is > best_is || (is > 0 && is == best_is && turned[0] < best[0])) {
            best = turned;
            best_is = is;
        }
        std::rotate(turned.begin(), turned.begin() + 1, turned.end());
    }
    face = best;
}

using Edge = std::pair<Index, Index>;

// Six times the volume between the faces and the first point.
double volume_of(const CellFaces& faces, const std::vector<Vec3>& points) {
    const Vec3 start = points[faces.front().front()];
    double volume = 0;
    for (const auto& face : faces) {
        for (std::size_t k = 1; k + 1 < face.size(); ++k) {
            const Vec3 a = points[face[0]] - start, b = points[face[k]] - start, c = points[face[k + 1]] - start;
            volume += glm::dot(a, glm::cross(b, c));
        }
    }
    return volume;
}

// Triangles of a cell's surface as planes, with normals into the cell.
class Inside {
public:
    void add(const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 normal = glm::cross(b - a, c - a);
        if (const double length = glm::length(normal); length > 0) planes_.push_back({a, normal / length});
    }

    // The triangle of which a place is farthest outside, or that is nearest; and the distance, below 0 outside.
    [[nodiscard]] std::pair<std::size_t, double> least(const Vec3& x) const {
        std::pair<std::size_t, double> found{0, HUGE_VAL};
        for (std::size_t k = 0; k < planes_.size(); ++k) {
            if (const double d = distance(k, x); d < found.second) found = {k, d};
        }
        return found;
    }
    [[nodiscard]] double distance(std::size_t plane, const Vec3& x) const {
        return glm::dot(x - planes_[plane].first, planes_[plane].second);
    }

private:
    std::vector<std::pair<Vec3, Vec3>> planes_;
};

// The weight of each of a cell's points in a place that sees all triangles: the mean if it does; else that moved again and
// again towards the point that is farthest inside of the triangle that it sees least. Nothing if that does not find one.
std::optional<std::vector<double>> weights_of_middle(const std::vector<Vec3>& points, const Inside& inside) {
    constexpr int kMostMoves = 100;
    constexpr double kRounding = 1e-12;
    constexpr double kRoom = 1e-3;  // of the cell's size: so far inside is aimed at, and half of it is enough
    std::vector<double> weights(points.size(), 1 / static_cast<double>(points.size()));
    Box box;
    Vec3 middle(0.0);
    for (const Vec3& x : points) {
        box.add(x);
        middle += x / static_cast<double>(points.size());
    }
    const double room = kRoom * box.diagonal();
    for (int move = 0; move < kMostMoves; ++move) {
        const auto [plane, least] = inside.least(middle);
        if (least >= (move == 0 ? -kRounding * box.diagonal() : room / 2)) return weights;
        std::size_t farthest = 0;
        for (std::size_t p = 1; p < points.size(); ++p) {
            if (inside.distance(plane, points[p]) > inside.distance(plane, points[farthest])) farthest = p;
        }
        const double there = inside.distance(plane, points[farthest]);
        if (!(there > room)) return {};
        const double part = (room - least) / (there - least);
        for (double& weight : weights) weight *= 1 - part;
        weights[farthest] += part;
        middle += part * (points[farthest] - middle);
    }
    return {};
}

}  // namespace

void PolyhedronTaker::add(Index number, CellFaces& faces) {
    number_ = number;
    points_.clear();
    for (const auto& face : faces) points_.insert(points_.end(), face.begin(), face.end());
    std::sort(points_.begin(), points_.end());
    points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    if (!take(faces)) split(faces);
}

template <std::size_t N>
bool PolyhedronTaker::put(FileCells<N>& into, const std::array<Index, N>* corners) {
    if (corners == nullptr) return false;
    into.corners.push_back(*corners);
    into.numbers.push_back(number_);
    return true;
}

bool PolyhedronTaker::take(const CellFaces& faces) {
    const auto put_if = [&](auto& into, const auto& corners) { return put(into, corners ? &*corners : nullptr); };
    const std::size_t triangles = faces_with(faces, 3), quads = faces_with(faces, 4);
    if (triangles + quads != faces.size()) return false;
    if (quads == 6 && triangles == 0 && points_.size() == 8) return put_if(found_.hexes, pillar<8>(faces));
    if (ignore_others_) return false;
    if (quads == 3 && triangles == 2 && points_.size() == 6) return put_if(found_.prisms, pillar<6>(faces));
    if (quads == 1 && triangles == 4 && points_.size() == 5) return put_if(found_.pyramids, cone<5>(faces, points_));
    if (quads == 0 && triangles == 4 && points_.size() == 4) return put_if(found_.tets, cone<4>(faces, points_));
    return false;
}

void PolyhedronTaker::split(CellFaces& faces) {
    if (ignore_others_) {
        ++left_out_;
        return;
    }
    ++polyhedra_;
    found_.cut = true;
    std::map<std::array<Index, 3>, std::array<Index, 3>> triangles;
    for (auto& face : faces) {
        start_fan(face, found_.points);
        for (std::size_t k = 1; k + 1 < face.size(); ++k) {
            const std::array<Index, 3> triangle{face[0], face[k + 1], face[k]};
            auto key = triangle;
            std::sort(key.begin(), key.end());
            // Two faces of a cell may share three points: its part between them is flat, and the neighbours meet there.
            const auto [same, is_new] = triangles.try_emplace(key, triangle);
            if (!is_new) triangles.erase(same);
        }
    }
    std::vector<Vec3> corners;
    for (const Index p : points_) corners.push_back(found_.points[p]);
    Inside inside;
    for (const auto& [key, t] : triangles) inside.add(found_.points[t[0]], found_.points[t[1]], found_.points[t[2]]);
    auto weights = weights_of_middle(corners, inside);
    if (!weights) {
        ++folded_;
        weights.emplace(corners.size(), 1 / static_cast<double>(corners.size()));
    }
    Vec3 middle(0.0);
    for (std::size_t k = 0; k < corners.size(); ++k) middle += (*weights)[k] * corners[k];
    const auto apex = static_cast<Index>(found_.points.size());
    found_.points.push_back(middle);
    for (const auto& [key, t] : triangles) {
        const std::array<Index, 4> tet{t[0], t[1], t[2], apex};
        put(found_.tets, &tet);
        ++tets_;
    }
    // Fields at points have the mean of the cell's points there, with the weights of the middle; a number that no other point
    // has, where they are numbers.
    constexpr double kAboveNumbers = 4503599627370496.0;
    for (FileArray& array : found_.arrays) {
        if (array.at_cells) continue;
        if (std::ranges::find(kPointNumberArrays, array.name) != kPointNumberArrays.end()) {
            ByteHash hash;
            hash.add({reinterpret_cast<const char*>(&middle), sizeof middle});
            array.values.push_back(kAboveNumbers + static_cast<double>(hash.value() >> 13));
            continue;
        }
        const auto components = static_cast<std::size_t>(array.components);
        for (std::size_t c = 0; c < components; ++c) {
            double mean = 0;
            for (std::size_t k = 0; k < points_.size(); ++k) mean += (*weights)[k] * array.values[points_[k] * components + c];
            array.values.push_back(mean);
        }
    }
}

void PolyhedronTaker::report() {
    if (polyhedra_ == 0) return;
    found_.warnings.push_back(counted(polyhedra_, "polyhedron", "polyhedra") + " split from the middle into " +
                              counted(tets_, "tetrahedron", "tetrahedra"));
    if (folded_ == 0) return;
    found_.warnings.push_back(
        counted(folded_, "polyhedron has", "polyhedra have") +
        " no point from which all faces are seen from inside, or none that is found: tetrahedra overlap there");
}

// A face whose corners are at fewer points, such as those of a collapsed prism, is the polygon of these points, or none.
void drop_repeated_points(CellFaces& faces) {
    for (auto& face : faces) {
        face.erase(std::unique(face.begin(), face.end()), face.end());
        while (face.size() > 1 && face.front() == face.back()) face.pop_back();
    }
    std::erase_if(faces, [](const auto& face) { return face.size() < 3; });
}

std::size_t Polyhedra::take_into(MeshFile& found, bool ignore_others) {
    PolyhedronTaker taker(found, ignore_others);
    std::size_t open = 0;
    for (auto& [number, faces] : cells_) {
        drop_repeated_points(faces);
        if (is_closed(faces)) {
            orient_faces(faces, found.points);
            taker.add(number, faces);
        } else {
            ++open;
        }
    }
    cells_.clear();
    taker.report();
    if (open > 0) {
        found.warnings.push_back(counted(open, "polyhedron", "polyhedra") + " whose faces do not enclose a volume left out");
    }
    return taker.left_out();
}

// The points in the plane of three of them, in their order around it; empty if others are on both sides of it.
std::vector<Index> hull_face(const std::vector<Index>& corners, const std::vector<Vec3>& points, const std::array<Vec3, 3>& x,
                             double near) {
    const Vec3 across = glm::cross(x[1] - x[0], x[2] - x[0]);
    const double area = glm::length(across);
    if (!(area > near * near)) return {};
    const Vec3 normal = across / area;
    std::vector<Index> face;
    bool below = false, above = false;
    for (const Index p : corners) {
        const double height = glm::dot(points[p] - x[0], normal);
        if (std::abs(height) <= near) face.push_back(p);
        below = below || height < -near;
        above = above || height > near;
    }
    if (below == above) return {};
    Vec3 middle(0.0);
    for (const Index p : face) middle += points[p] / static_cast<double>(face.size());
    const Vec3 right = glm::normalize(x[1] - x[0]), up = glm::cross(normal, right);
    const auto angle = [&](Index p) {
        return std::atan2(glm::dot(points[p] - middle, up), glm::dot(points[p] - middle, right));
    };
    std::ranges::sort(face, {}, angle);
    return face;
}

CellFaces hull_faces(const std::vector<Index>& corners, const std::vector<Vec3>& points) {
    constexpr std::size_t kMost = 64;
    constexpr double kFlat = 1e-3;
    if (corners.size() < 4 || corners.size() > kMost) return {};
    Box box;
    for (const Index p : corners) box.add(points[p]);
    const double near = kFlat * box.diagonal();
    std::map<std::set<Index>, std::vector<Index>> faces;  // by their points: many triples have the same plane
    std::set<Index> met;
    for (std::size_t a = 0; a < corners.size(); ++a) {
        for (std::size_t b = a + 1; b < corners.size(); ++b) {
            for (std::size_t c = b + 1; c < corners.size(); ++c) {
                auto face = hull_face(corners, points, {points[corners[a]], points[corners[b]], points[corners[c]]}, near);
                met.insert(face.begin(), face.end());
                if (!face.empty()) faces.try_emplace({face.begin(), face.end()}, std::move(face));
            }
        }
    }
    if (met.size() != corners.size()) return {};
    CellFaces found;
    for (auto& [key, face] : faces) found.push_back(std::move(face));
    return found;
}

bool is_closed(const CellFaces& faces) {
    std::map<Edge, int> count;
    for (const auto& face : faces) {
        if (face.size() < 3) return false;
        for (std::size_t k = 0; k < face.size(); ++k) {
            const Index a = face[k], b = face[(k + 1) % face.size()];
            if (a == b) return false;
            ++count[std::minmax(a, b)];
        }
    }
    return faces.size() > 3 && std::ranges::all_of(count, [](const auto& edge) { return edge.second == 2; });
}

// From face to face over edges: two faces of one hand walk along their edge in opposite directions.
void orient_faces(CellFaces& faces, const std::vector<Vec3>& points) {
    if (!is_closed(faces)) return;
    std::map<Edge, std::vector<std::size_t>> sides;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        for (std::size_t k = 0; k < faces[f].size(); ++k) {
            sides[std::minmax(faces[f][k], faces[f][(k + 1) % faces[f].size()])].push_back(f);
        }
    }
    const auto walks = [&](std::size_t f, Index a, Index b) {
        const auto& face = faces[f];
        for (std::size_t k = 0; k < face.size(); ++k) {
            if (face[k] == a && face[(k + 1) % face.size()] == b) return true;
        }
        return false;
    };
    std::vector<bool> met(faces.size(), false);
    std::vector<std::size_t> next{0};
    met[0] = true;
    while (!next.empty()) {
        const std::size_t f = next.back();
        next.pop_back();
        for (std::size_t k = 0; k < faces[f].size(); ++k) {
            const Index a = faces[f][k], b = faces[f][(k + 1) % faces[f].size()];
            for (const std::size_t other : sides[std::minmax(a, b)]) {
                if (met[other]) continue;
                met[other] = true;
                if (walks(other, a, b)) std::reverse(faces[other].begin(), faces[other].end());
                next.push_back(other);
            }
        }
    }
    if (volume_of(faces, points) >= 0) return;
    for (auto& face : faces) std::reverse(face.begin(), face.end());
}

}  // namespace subvol::detail
