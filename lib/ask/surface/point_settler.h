// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soup_cutter.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/limit.h"
#include "subvol/probe.h"

namespace subvol::detail {

/// The middle of a triangle is farther from a sphere than those of its edges.
inline constexpr double kTriangleBend = 4.0 / 3;

/// Where points are, and the fields of the mesh there: after settling those that the settler has.
struct SettledPoints {
    std::vector<LimitQuery> places;
    std::vector<Vec3> positions, normals;
    std::vector<ProbedField> fields;

    /// Has the fields of `like`, and so many points.
    void resize(std::size_t count, std::span<const ProbedField> like);
    /// Adds a point of others with the same fields.
    void add(const SettledPoints& from, std::size_t point);
};

/// Adds the values and gradients at one point of `from` to `to`, field by field.
void add_fields(std::span<const ProbedField> from, std::size_t point, std::span<ProbedField> to);
/// Sets the fields at a point from those of a sample, which are followed along a step in its cell.
void take_fields(const LimitSamples& samples, std::size_t i, const Vec3& step, std::size_t point,
                 std::span<ProbedField> fields);
/// Returns the names and channels of the fields of a mesh, without points.
[[nodiscard]] std::vector<ProbedField> fields_of(const HexMesh& mesh);
/// Returns the names and channels of fields, without points.
[[nodiscard]] std::vector<ProbedField> without_points(std::span<const ProbedField> fields);

/// Moves the points of a soup along their edges to the limit, and measures how far its triangles are from it.
class PointSettler {
public:
    /// mesh:  its first attribute is the field, if the cuts have isovalues. The topology is kept by reference
    /// whole: the extent of the mesh that it is a part of
    PointSettler(const HexMesh& mesh, const Topology& topology, const LimitExtent& whole, const SchemeOptions& scheme,
                 Progress* progress);

    [[nodiscard]] SettledPoints settle(const SurfaceSoup& soup, const Cut& cut, int level) const;

    /// How far most triangles are from the limit: all but one edge in a thousand, as normals are arbitrary where gradients
    /// vanish.
    [[nodiscard]] double deviation(const SurfaceSoup& soup, const SettledPoints& settled, int level) const;

private:
    struct Moving;
    void move(const SurfaceSoup& soup, const Cut& cut, int level, std::vector<Moving>& moving, SettledPoints& settled) const;
    void add_hull_bends(const SurfaceSoup& soup, const SettledPoints& settled, int level, const std::vector<std::size_t>& hull,
                        std::vector<double>& bends) const;
    [[nodiscard]] bool on_hull(Index cell, const Vec3& uvw) const;

    std::vector<ProbedField> fields_;  // of the mesh, without points
    const Topology& topology_;
    LimitEvaluator limit_;
    Progress* progress_;
};

}  // namespace subvol::detail
