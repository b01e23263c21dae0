// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/scheme_rows.h"

#include "subvol/detail/bucket_sort.h"
#include "subvol/error.h"

namespace subvol::detail {

SchemeRows::SchemeRows(const Topology& topology, const SchemeOptions& scheme, Columns columns)
    : topology_(topology),
      first_(topology),
      rules_(make_rules(topology, scheme)),
      sums_(columns == Columns::WithSums ? rules_->use_ring_sums() : nullptr),
      kept_(rules_->interpolates() ? topology.point_count : 0),
      cell_of_rank_(topology.cells.size()) {
    if (first_.end >= kNone) {
        throw Error(ErrorCode::InvalidInput, "the refined mesh needs " + std::to_string(first_.end) + " points", {},
                    "at most " + std::to_string(kNone - 1) + ": use fewer levels");
    }
    parallel_each(topology.cells.size(),
                  [&](std::size_t c) { cell_of_rank_[topology.cell_ordinal[c]] = static_cast<Index>(c); });
}

RowInput::RowInput(const SchemeRows& rows, const HexMesh& mesh) : mesh_(mesh) {
    if (rows.sums() == nullptr) return;
    columns_.push_back(rows.sums()->with_sums(&mesh.points[0].x, 3));
    for (const Attribute& attribute : mesh.attributes) {
        columns_.push_back(rows.sums()->with_sums(attribute.values.data(), static_cast<std::size_t>(attribute.channels)));
    }
}

void SchemeRows::write_row(std::size_t point, StencilBuilder& row) const {
    if (point < first_.edges) {
        const bool used = !topology_.point_edges[point].empty();
        used ? rules_->vertex_point(static_cast<Index>(point), row) : row.add(static_cast<Index>(point), 1);
    } else if (point < first_.faces) {
        rules_->edge_point(static_cast<Index>(point - first_.edges), row);
    } else if (point < first_.cells) {
        rules_->face_point(static_cast<Index>(point - first_.faces), row);
    } else {
        rules_->cell_point(cell_of_rank_[point - first_.cells], row);
    }
}

}  // namespace subvol::detail
