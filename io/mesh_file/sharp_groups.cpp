// SPDX-License-Identifier: Apache-2.0
#include "sharp_groups.h"

#include <algorithm>
#include <map>
#include <optional>

#include "subvol/detail/error_text.h"
#include "subvol/error.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

template <std::size_t N>
std::string list_of(const std::array<Index, N>& points, const EntityNames& names) {
    std::string list;
    for (std::size_t k = 0; k < N; ++k) {
        if (k > 0 && points[k] == points[k - 1]) continue;
        list += (list.empty() ? "" : ", ") + names.point(points[k]);
    }
    return list;
}

/// The parts into which `plan_split` splits faces and edges: its new points lie in the middle of edges and faces.
class SplitTags {
public:
    explicit SplitTags(const IndexRows& sources) {
        for (std::size_t p = 0; p + 1 < sources.offsets.size(); ++p) {
            const auto row = sources[p];
            if (row.size() > 4) continue;  // in the middle of a cell
            std::vector<Index> key(row.begin(), row.end());
            std::ranges::sort(key);
            middles_.emplace(std::move(key), static_cast<Index>(p));
        }
    }

    /// The quads at the corners of a polygon; nothing if it is not a face.
    [[nodiscard]] std::optional<std::vector<std::array<Index, 4>>> quads(std::span<const Index> polygon) const {
        std::vector<std::array<Index, 4>> quads;
        const auto center = middle(polygon);
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Index before = polygon[(k + polygon.size() - 1) % polygon.size()], corner = polygon[k],
                        after = polygon[(k + 1) % polygon.size()];
            const auto at = middle({corner}), ahead = middle({corner, after}), behind = middle({before, corner});
            if (!center || !at || !ahead || !behind) return std::nullopt;
            quads.push_back({*at, *ahead, *center, *behind});
        }
        return quads;
    }

    [[nodiscard]] std::optional<std::array<std::array<Index, 2>, 2>> halves(const std::array<Index, 2>& edge) const {
        const auto a = middle({edge[0]}), b = middle({edge[1]}), center = middle(edge);
        if (!a || !b || !center) return std::nullopt;
        return std::array{std::array{*a, *center}, std::array{*center, *b}};
    }

private:
    [[nodiscard]] std::optional<Index> middle(std::span<const Index> points) const {
        std::vector<Index> key(points.begin(), points.end());
        std::ranges::sort(key);
        const auto found = middles_.find(key);
        return found == middles_.end() ? std::nullopt : std::optional(found->second);
    }
    [[nodiscard]] std::optional<Index> middle(std::initializer_list<Index> points) const {
        return middle(std::span(points.begin(), points.size()));
    }

    std::map<std::vector<Index>, Index> middles_;
};

/// The faces of hexahedra that a face of the file consists of; nothing if it is not a face of a cell.
std::optional<std::vector<std::array<Index, 4>>> quads_of(const std::array<Index, 4>& face,
                                                          const std::optional<SplitTags>& split) {
    const bool triangle = face[2] == face[3];
    if (!split) return triangle ? std::nullopt : std::optional(std::vector{face});
    if (triangle) return split->quads(std::span(face).first(3));
    if (auto quads = split->quads(face)) return quads;
    // The cells were cut into tetrahedra, and the quad along one of its diagonals.
    for (std::size_t k = 0; k < 2; ++k) {
        const std::array<Index, 3> one{face[k], face[k + 1], face[k + 2]}, other{face[k + 2], face[(k + 3) % 4], face[k]};
        auto quads = split->quads(one);
        const auto more = split->quads(other);
        if (!quads || !more) continue;
        quads->insert(quads->end(), more->begin(), more->end());
        return quads;
    }
    return std::nullopt;
}

}  // namespace

bool SharpGroups::takes(const std::string& name, const std::string& number) {
    known_.insert(name);
    missing_.erase(name);
    missing_.erase(number);
    return wanted_.contains(name) || wanted_.contains(number);
}

void SharpGroups::check(std::string_view file) const {
    if (missing_.empty()) return;
    const std::vector<std::string> known(known_.begin(), known_.end());
    throw Error(ErrorCode::InvalidInput, "there is no group " + in_quotes(*missing_.begin()) + " of faces or edges",
                std::string(file), known.empty() ? "the file has none" : "it has: " + listed(known));
}

void add_sharp_tags(HexMesh& mesh, FileTags&& tags, const IndexRows* sources, std::string_view file, const EntityNames& names) {
    const Topology topology = build_topology(mesh);
    const std::optional<SplitTags> split = sources ? std::optional<SplitTags>(*sources) : std::nullopt;
    const auto refuse = [&](const auto& points, const std::string& what, const std::string& allowed) {
        throw Error(ErrorCode::InvalidInput, list_of(points, names) + ": " + what, std::string(file), allowed);
    };
    std::vector<std::uint8_t> sharp(topology.faces.size(), 0), on_boundary = topology.edge_on_boundary;
    for (const auto& face : tags.faces) {
        const auto quads = quads_of(face, split);
        if (!quads) refuse(face, "they are not a face of a cell", "groups of faces between cells");
        for (const auto& quad : *quads) {
            const auto f = topology.find_face(quad);
            if (!f) refuse(face, "they are not a face of a cell", "groups of faces between cells");
            if (topology.face_on_hull(*f) || sharp[*f]) continue;
            sharp[*f] = 1;
            mesh.sharp_faces.push_back(topology.faces[*f]);
            for (const Index e : topology.face_edges[*f]) on_boundary[e] = 1;
        }
    }
    std::vector<std::uint8_t> crease(topology.edges.size(), 0);
    for (const auto& edge : tags.edges) {
        std::vector<std::array<Index, 2>> parts{edge};
        if (const auto halves = split ? split->halves(edge) : std::nullopt) parts.assign(halves->begin(), halves->end());
        for (const auto& part : parts) {
            const auto e = topology.find_edge(part[0], part[1]);
            if (!e) refuse(edge, "they are not an edge of a cell", "groups of edges of the boundary");
            if (!on_boundary[*e]) refuse(edge, "the edge lies inside the mesh", "edges of the boundary or of a sharp face");
            if (!crease[*e]) mesh.creases.push_back(topology.edges[*e]);
            crease[*e] = 1;
        }
    }
}

std::string sharp_counts(const HexMesh& mesh) {
    const std::string creases = mesh.creases.empty() ? "" : counted(mesh.creases.size(), "crease", "creases");
    const std::string faces = mesh.sharp_faces.empty() ? "" : counted(mesh.sharp_faces.size(), "sharp face", "sharp faces");
    return creases + (creases.empty() || faces.empty() ? "" : " and ") + faces;
}

}  // namespace subvol::detail
