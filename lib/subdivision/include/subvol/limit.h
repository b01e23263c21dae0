// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "subvol/refine.h"

namespace subvol {

namespace detail {
struct LimitExtent;
}

/// A place in a control cell: uvw in [0,1]³, u along corners 0→1, v along 0→3, w along 0→4.
struct LimitQuery {
    Index cell = 0;
    Vec3 uvw{0.0};
};

struct LimitOptions {
    SchemeOptions scheme{};
    /// Relative to the diagonal of the mesh's box and to each attribute's range. What is not exact is refined until two levels
    /// differ by less, and their derivatives (per cell) by less than its square root; beside extraordinary edges and vertices
    /// that of the derivatives is given up after level 6
    double tolerance = 1e-6;
    int max_levels = 10;  ///< ≥ 2; refinement ends there in any case
    Progress* progress = nullptr;
};

/// The options without those of the scheme.
[[nodiscard]] std::vector<Option> options_of(LimitOptions& options);

/// How many values were found in which way. Exact ones are those of regular Catmull-Clark and BSXW cells (tricubic B-splines)
/// and of the linear scheme; `unconverged` ones had not reached the tolerance at max_levels.
struct LimitReport {
    std::size_t exact = 0;
    std::size_t refined = 0;
    std::size_t unconverged = 0;
    int deepest_level = 0;
};

/// Values of one attribute: channel c of query q at q × channels + c; its derivatives by u, v, w at the same place.
struct LimitAttribute {
    std::string name;
    std::size_t channels = 1;
    std::vector<double> values;
    std::vector<Vec3> derivatives;
};

/// One entry per query.
struct LimitSamples {
    std::vector<Vec3> positions;
    std::vector<Mat3> jacobians;  ///< columns ∂x/∂u, ∂x/∂v, ∂x/∂w
    std::vector<LimitAttribute> attributes;
    LimitReport report;
};

/// Position, Jacobian and attributes of the limit volume at places in control cells.
///
/// Catmull-Clark and BSXW are evaluated as tricubic B-splines where the cell's surroundings are a grid (the boundary of a box
/// included). Elsewhere, and everywhere for MCQ, the surroundings of the place are refined: the vertices of MCQ lie on the
/// limit, which is interpolated tricubically between them. The error falls with the second power of the cell size, as the
/// smoothness of the scheme allows, that of the Jacobian with the first.
///
/// Where the limit of MCQ is C1, cells that meet have one gradient, to the tolerance: derivatives at the ends of an edge are
/// taken from the points on both sides of it, and converge there with the second power. On the boundary that holds along it. At
/// extraordinary vertices and edges, and at interior creases, derivatives are those of the cell that is asked, from its side
/// alone: they differ from cell to cell by up to some tenths of what the field changes in a cell, and a tighter tolerance does
/// not help. At an extraordinary vertex or edge the Jacobian is that of the last level.
///
/// throws: Error(InvalidInput) as `refine`, or if a query names a cell that does not exist or lies outside [0,1]³
/// cost:   parallel; queries in one cell share the work: best are many queries in one call. Bitwise the same for any number of
///         threads and whatever the other queries
[[nodiscard]] LimitSamples evaluate_limit(const HexMesh& mesh, std::span<const LimitQuery> queries,
                                          const LimitOptions& options = {});

/// `evaluate_limit` for many calls: the mesh's topology, the tables of the neighbourhoods that were met, and up to 256 MB of
/// cells that had to be refined are kept between them.
class LimitEvaluator {
public:
    /// The mesh is copied.
    ///
    /// throws: Error(InvalidInput) as `refine`, or if an option is out of range
    explicit LimitEvaluator(const HexMesh& mesh, const LimitOptions& options = {});

    /// Constructs an evaluator for a mesh that may be part of a larger mesh of the given extent. Results depend only on the
    /// cells around a place, so they have the same bits in the part and in the whole. Tables that pay where many neighbourhoods
    /// are alike are not used.
    LimitEvaluator(const HexMesh& mesh, const LimitOptions& options, const detail::LimitExtent& whole);
    ~LimitEvaluator();
    LimitEvaluator(LimitEvaluator&&) noexcept;
    LimitEvaluator& operator=(LimitEvaluator&&) noexcept;

    /// What `evaluate_limit` returns for these places, bit for bit. Several threads may call it.
    ///
    /// throws: Error(InvalidInput) if a query names a cell that does not exist or lies outside [0,1]³
    [[nodiscard]] LimitSamples at(std::span<const LimitQuery> queries) const;

    /// `at`, but each place first moves towards where the limit has a given position: by Newton's method on the coarse levels,
    /// within its cell. From a place that is near, most end within 1e-3 of a cell; what is left is a step by the Jacobian.
    ///
    /// queries:   where the search starts; become the places of the samples
    /// positions: one for each query; others than finite ones leave it where it is
    /// throws:    Error(InvalidInput) as `at`, or if there are not as many positions
    [[nodiscard]] LimitSamples approach(std::span<LimitQuery> queries, std::span<const Vec3> positions) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The limit positions of the vertices as stencils over the mesh's points. If the scheme interpolates, the table keeps every
/// point.
///
/// source: the dominant left eigenvector of each vertex's local subdivision matrix; in the regular case (1,4,1)/6 along
///         each axis
[[nodiscard]] StencilTable limit_stencils(const Topology& topology, Scheme scheme);

/// The mesh with its points and attributes moved to the limit: the approximation of the volume that is shown or measured.
[[nodiscard]] HexMesh on_limit(HexMesh mesh, Scheme scheme);

}  // namespace subvol
