// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_field.h"

#include <utility>

#include "closed_surface.h"
#include "subvol/detail/cell_locator.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

HexMesh with_only(HexMesh mesh, std::string_view field) {
    validate(mesh);
    mesh.attributes = {Attribute(scalar_field(mesh, field))};
    return mesh;
}

std::vector<Box> cell_boxes(const HexMesh& mesh) {
    std::vector<Box> boxes(mesh.cells.size());
    for (std::size_t c = 0; c < boxes.size(); ++c) {
        for (const Index corner : mesh.cells[c]) boxes[c].add(mesh.points[corner]);
    }
    return boxes;
}

}  // namespace

struct MeshField::Cells {
    HexMesh mesh;
    detail::BoxTree tree;

    Cells(HexMesh all, std::string_view field) : mesh(with_only(std::move(all), field)), tree(cell_boxes(mesh)) {}

    /// Calls use(locator, tetrahedron, values at the corners) for the first cell found that contains x.
    template <class Use>
    void find(const Vec3& x, const Use& use) const {
        const auto holds = [&](const Box& box) {
            return glm::all(glm::lessThanEqual(box.lower, x)) && glm::all(glm::lessThanEqual(x, box.upper));
        };
        tree.visit(holds, [&](Index cell) {
            const CellLocator locator(mesh, cell);
            const auto tetrahedron = locator.find_tetrahedron(x);
            if (!tetrahedron) return false;
            std::array<double, 8> values;
            for (std::size_t k = 0; k < 8; ++k) values[k] = mesh.attributes.front().values[mesh.cells[cell][k]];
            use(locator, *tetrahedron, values);
            return true;
        });
    }
};

MeshField::MeshField(HexMesh mesh, std::string_view attribute)
    : cells_(std::make_unique<const Cells>(std::move(mesh), attribute)) {
}
MeshField::~MeshField() = default;
MeshField::MeshField(MeshField&&) noexcept = default;
MeshField& MeshField::operator=(MeshField&&) noexcept = default;

std::optional<double> MeshField::value(const Vec3& x) const {
    std::optional<double> result;
    cells_->find(x, [&](const CellLocator& locator, std::size_t tetrahedron, const std::array<double, 8>& values) {
        const auto weights = locator.weights(tetrahedron, x);
        double sum = 0;
        for (std::size_t k = 0; k < 8; ++k) sum += weights[k] * values[k];
        result = sum;
    });
    return result;
}

std::optional<Vec3> MeshField::gradient(const Vec3& x) const {
    std::optional<Vec3> result;
    cells_->find(x, [&](const CellLocator& locator, std::size_t tetrahedron, const std::array<double, 8>& values) {
        result = locator.gradient(tetrahedron, x, values);
    });
    return result;
}

Box MeshField::box() const {
    return cells_->tree.bounds();
}

FieldView MeshField::view() const {
    return {.value = [this](const Vec3& x) { return value(x); },
            .gradient = [this](const Vec3& x) { return gradient(x); },
            .box = box()};
}

FieldView view_of(const LimitField& field) {
    return {.value = [&field](const Vec3& x) { return field.value(x); },
            .gradient = [&field](const Vec3& x) { return field.gradient(x); },
            .box = field.box()};
}

}  // namespace subvol
