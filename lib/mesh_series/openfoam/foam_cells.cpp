// SPDX-License-Identifier: Apache-2.0
#include "foam_cells.h"

#include <algorithm>
#include <map>
#include <optional>

namespace subvol::detail {

namespace {

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

}  // namespace

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

void add_foam_cells(const FoamMesh& mesh, bool ignore_others, MeshFile& found) {
    Cells(mesh, ignore_others, found).run();
}

}  // namespace subvol::detail
