// SPDX-License-Identifier: Apache-2.0
#include "subvol/coarse_edit.h"

#include <string>
#include <utility>

#include "subvol/error.h"
#include "wavelet_format.h"

namespace subvol {

using detail::coordinates;

CoarseEdit::CoarseEdit(const HexMesh& mesh, int levels, const SchemeOptions& scheme)
    : hierarchy_(find_hierarchy(mesh, {.levels = levels})) {
    if (hierarchy_.levels < levels) {
        throw Error(ErrorCode::InvalidInput,
                    "the mesh has only " + std::to_string(hierarchy_.levels) +
                        (hierarchy_.levels == 1 ? " coarser level" : " coarser levels"),
                    "levels", "at most " + std::to_string(hierarchy_.levels));
    }
    basis_ = wavelet_basis(build_topology(hierarchy_.coarse), {.scheme = scheme, .levels = levels});
    coarse_ = hierarchy_.coarse;
    take(mesh);
}

void CoarseEdit::take(const HexMesh& mesh) {
    shape_ = analyze(basis_, in_hierarchy(hierarchy_, coordinates(mesh.points), 3), 3);
    turn_details_to_shape(basis_, shape_);
    for (std::size_t p = 0; p < coarse_.points.size(); ++p) {
        coarse_.points[p] = {shape_.coarse[3 * p], shape_.coarse[3 * p + 1], shape_.coarse[3 * p + 2]};
    }
    coarse_.attributes.clear();
    fields_.clear();
    for (const Attribute& a : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(a.channels);
        fields_.push_back(analyze(basis_, in_hierarchy(hierarchy_, a.values, channels), channels));
        coarse_.attributes.push_back({a.name, a.channels, fields_.back().coarse});
    }
    mesh_ = mesh;
}

const HexMesh& CoarseEdit::change(HexMesh changed) {
    if (changed.points.size() != coarse_.points.size() || changed.attributes.size() != coarse_.attributes.size()) {
        throw Error(ErrorCode::InvalidInput, std::to_string(changed.points.size()) + " points", "coarse mesh",
                    "as many points and fields as the coarser level has: " + std::to_string(coarse_.points.size()) + " and " +
                        std::to_string(coarse_.attributes.size()));
    }
    const auto each_point = [&](const auto& set) {  // points that were added are left out
        for (std::size_t i = 0; i < hierarchy_.points.size(); ++i) {
            if (hierarchy_.points[i] < mesh_.points.size()) set(hierarchy_.points[i], i);
        }
    };
    shape_.coarse = coordinates(changed.points);
    WaveletField shape = shape_;
    turn_details_to_world(basis_, shape);
    const std::vector<double> places = synthesize(basis_, shape);
    each_point([&](Index p, std::size_t i) { mesh_.points[p] = {places[3 * i], places[3 * i + 1], places[3 * i + 2]}; });
    for (std::size_t f = 0; f < fields_.size(); ++f) {
        WaveletField& field = fields_[f];
        if (changed.attributes[f].values == field.coarse) continue;
        field.coarse = changed.attributes[f].values;
        const std::vector<double> values = synthesize(basis_, field);
        each_point([&](Index p, std::size_t i) {
            for (std::size_t k = 0; k < field.channels; ++k) {
                mesh_.attributes[f].values[p * field.channels + k] = values[i * field.channels + k];
            }
        });
    }
    coarse_ = std::move(changed);
    return mesh_;
}

}  // namespace subvol
