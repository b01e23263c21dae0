// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/schemes.h"

namespace subvol::detail {

namespace {

class LinearRules final : public SchemeRules {
public:
    explicit LinearRules(const Topology& topology) : topology_(topology) {}
    void edge_point(Index edge, StencilBuilder& row) const override { mean(topology_.edges[edge], row); }
    void face_point(Index face, StencilBuilder& row) const override { mean(topology_.faces[face], row); }
    void cell_point(Index cell, StencilBuilder& row) const override { mean(topology_.cells[cell], row); }

private:
    template <std::size_t N>
    static void mean(const std::array<Index, N>& points, StencilBuilder& row) {
        for (const Index p : points) row.add(p, 1.0 / static_cast<double>(N));
    }
    const Topology& topology_;
};

}  // namespace

std::unique_ptr<SchemeRules> make_linear_rules(const Topology& topology) {
    return std::make_unique<LinearRules>(topology);
}

}  // namespace subvol::detail
