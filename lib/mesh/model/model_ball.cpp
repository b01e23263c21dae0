// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>

#include "model_block.h"
#include "subvol/model.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kCore = 0.5;  // size of the inner cube: the radius of its faces' centres
constexpr double kBulge =
    0.5;  // how far the inner cube is rounded towards a sphere; .5 gives the best worst scaled Jacobian (.74)

/// Maps the cube [-1,1]³ smoothly onto the unit ball, its surface onto the sphere.
/// Source: P. Nowell, "Mapping a cube to a sphere" (2005).
Vec3 ball_from_cube(const Vec3& p) {
    const Vec3 s = p * p;
    const auto factor = [](double a, double b) { return std::sqrt(1 - 0.5 * (a + b) + a * b / 3); };
    return p * Vec3(factor(s.y, s.z), factor(s.z, s.x), factor(s.x, s.y));
}

Vec3 core_position(const Vec3& p) {
    return kCore * glm::mix(p, ball_from_cube(p), kBulge);
}

/// The points of a cubic lattice's surface, numbered in their lattice order.
class Shell {
public:
    explicit Shell(Index n) : row_(n + 1), ordinals_(std::size_t{row_} * row_ * row_, kNone) {
        for (Index id = 0; id < ordinals_.size(); ++id) {
            const Index i = id % row_, j = id / row_ % row_, k = id / row_ / row_;
            const auto outer = [n](Index x) { return x == 0 || x == n; };
            if (!outer(i) && !outer(j) && !outer(k)) continue;
            ordinals_[id] = static_cast<Index>(lattice_ids_.size());
            lattice_ids_.push_back(id);
        }
    }

    [[nodiscard]] const std::vector<Index>& lattice_ids() const { return lattice_ids_; }

    /// The n² quads of a side of the cube as shell ordinals, counter-clockwise seen from outside.
    template <class Visit>
    void for_each_quad(Index axis, bool upper, Visit visit) const {
        const std::array<Index, 3> stride{1, row_, row_ * row_};
        // (a, b, axis) is right-handed on the upper side; exchanged on the lower one.
        const Index a = stride[(axis + (upper ? 1 : 2)) % 3], b = stride[(axis + (upper ? 2 : 1)) % 3];
        const Index origin = upper ? (row_ - 1) * stride[axis] : 0;
        for (Index j = 0; j + 1 < row_; ++j) {
            for (Index i = 0; i + 1 < row_; ++i) {
                const Index p = origin + i * a + j * b;
                visit(std::array{ordinals_[p], ordinals_[p + a], ordinals_[p + a + b], ordinals_[p + b]});
            }
        }
    }

private:
    Index row_;
    std::vector<Index> ordinals_;  // lattice id → ordinal
    std::vector<Index> lattice_ids_;
};

/// Adds layers of points from the core's surface (which is already in the mesh, with parameters in `cube`) to the sphere.
void add_shell_points(HexMesh& mesh, const std::vector<Vec3>& cube, const Shell& shell, Index layers) {
    for (Index layer = 1; layer <= layers; ++layer) {
        const double t = static_cast<double>(layer) / static_cast<double>(layers);
        for (const Index id : shell.lattice_ids()) {
            const Vec3 outer = glm::normalize(ball_from_cube(cube[id]));
            mesh.points.push_back(layer == layers ? outer : glm::mix(core_position(cube[id]), outer, t));
        }
    }
}

void add_shell_cells(HexMesh& mesh, const Shell& shell, Index core_points, Index layers) {
    const auto& ids = shell.lattice_ids();
    const auto point = [&](Index layer, Index ordinal) {
        return layer == 0 ? ids[ordinal] : core_points + (layer - 1) * static_cast<Index>(ids.size()) + ordinal;
    };
    for (Index side = 0; side < 6; ++side) {
        for (Index layer = 0; layer < layers; ++layer) {
            shell.for_each_quad(side / 2, side % 2 == 1, [&](const std::array<Index, 4>& quad) {
                std::array<Index, 8> cell;
                for (std::size_t k = 0; k < 4; ++k) {
                    cell[k] = point(layer, quad[k]);
                    cell[k + 4] = point(layer + 1, quad[k]);
                }
                mesh.cells.push_back(cell);
            });
        }
    }
}

}  // namespace

double BallField::density(const Vec3& x) {
    // |sum| ≤ .6 + .4, and the radial factor is at most 1 in the ball.
    const double waves = 0.6 * std::sin(3 * x.x + 0.4) * std::cos(2.5 * x.y - 0.2) + 0.4 * std::cos(2.8 * x.z + 0.5);
    return (1 - 0.4 * glm::dot(x, x)) * waves;
}

std::optional<double> BallField::value(const Vec3& x) const {
    if (!(glm::dot(x, x) <= 1)) return std::nullopt;
    return density(x);
}

HexMesh detail::model::make_ball(Index resolution) {
    const Index layers = (resolution + 1) / 2;
    HexMesh mesh = parameter_block({resolution, resolution, resolution});
    const std::vector<Vec3> cube = mesh.points;
    const auto core_points = static_cast<Index>(cube.size());
    for (Vec3& p : mesh.points) p = core_position(p);

    const Shell shell(resolution);
    add_shell_points(mesh, cube, shell, layers);
    add_shell_cells(mesh, shell, core_points, layers);

    Attribute field{.name = "density", .channels = 1, .values = {}};
    field.values.reserve(mesh.points.size());
    for (const Vec3& p : mesh.points) field.values.push_back(BallField::density(p));
    mesh.attributes.push_back(std::move(field));
    return mesh;
}

}  // namespace subvol
