// SPDX-License-Identifier: Apache-2.0
#include "subvol/approximate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "data_field.h"
#include "fitter.h"
#include "refine_where.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/topology.h"

namespace subvol {

std::vector<Option> options_of(ApproximateOptions& options) {
    return {Option("levels", options.levels)
                .between(1, 4)
                .help("L", "how finely the limit is interpolated where the samples are: between its points on level L"),
            Option("reach", options.reach)
                .between(0, 1)
                .help("R", "samples outside count at the nearest place up to R times the box's diagonal away"),
            Option("smoothing", options.smoothing)
                .between(0, 1e6)
                .help("S", "the weight of the differences along edges: for samples with noise"),
            Option("iterations", options.iterations).between(1, 100000).help("N", "the most steps of the search"),
            Option("clamp", options.clamp).help("keep control values within the range of the samples"),
            Option("refine", options.refine)
                .between(0, 6)
                .help("N", "refine the control mesh up to N times, where the samples are not met within --tolerance"),
            Option("tolerance", options.tolerance)
                .between(0, 1)
                .only_with("refine")
                .help("T", "an error that is good enough, as a part of the range")};
}

Facts facts_of(const ApproximateReport& report) {
    Facts facts;
    facts["samples"] = report.samples;
    facts["between"] = report.between;
    facts["outside"] = report.outside;
    facts["snapped"] = report.snapped;
    facts["unseen"] = report.unseen;
    facts["undecided"] = report.undecided;
    facts["iterations"] = report.iterations;
    facts["refined"] = report.refined;
    facts["continuous"] = report.continuous;
    Facts& fields = facts.group("fields");
    for (const FieldError& error : report.fields) {
        Facts& field = fields.group(error.name);
        field["rms"] = error.rms;
        field["rms_boundary"] = error.rms_boundary;
        field["max"] = error.max;
        field["max_at"] = std::array{error.max_at.x, error.max_at.y, error.max_at.z};
        field["range"] = error.range;
        field["rms_between"] = error.rms_between;
        field["max_between"] = error.max_between;
        field["max_between_at"] = std::array{error.max_between_at.x, error.max_between_at.y, error.max_between_at.z};
        field["beyond"] = error.beyond;
    }
    return facts;
}

Approximation approximate(const HexMesh& onto, const HexMesh& samples, const ApproximateOptions& given) {
    ApproximateOptions options = given;
    HexMesh mesh = detail::prepared(onto, options);
    detail::check_samples(samples);
    const detail::DataField data(samples, given);
    std::vector<PartOfCell> parts;
    for (int refined = 0;; ++refined) {
        std::optional<detail::SampleFinder> finder(std::in_place, mesh, options);
        const detail::Fitter fitter(mesh, data, options, *finder);
        finder.reset();  // its memory is for the search
        Approximation result = fitter.fit(samples.attributes, options.progress);
        result.report.refined = refined;
        result.parts = parts;
        if (refined == options.refine) return result;
        const std::vector<std::uint8_t> beyond = fitter.cells_beyond(options.tolerance, samples.attributes, result);
        if (std::ranges::count(beyond, 1) == 0) return result;
        detail::SplitMesh split = detail::refine_where(
            result.mesh, beyond, {.scheme = options.scheme, .levels = options.levels, .progress = options.progress});
        mesh = std::move(split.mesh);
        if (!parts.empty()) {
            for (PartOfCell& part : split.parts) {
                const PartOfCell& before = parts[part.parent];
                part = {before.parent, before.lower + before.size * part.lower, before.size * part.size};
            }
        }
        parts = std::move(split.parts);
    }
}

HexMesh mesh_of_box(const Box& box, int cells) {
    constexpr int kMost = 1000;
    if (cells < 1 || cells > kMost)
        throw Error(ErrorCode::InvalidInput, std::to_string(cells) + " cells along the longest side", "cells", "1 to 1000");
    const Vec3 size = box.empty() ? Vec3(0.0) : box.size();
    if (!(std::min({size.x, size.y, size.z}) > 0)) throw Error(ErrorCode::InvalidInput, "has no volume", "box", "three sides");
    const double side = std::max({size.x, size.y, size.z}) / cells;
    std::array<Index, 3> count;
    for (int k = 0; k < 3; ++k)
        count[static_cast<std::size_t>(k)] = static_cast<Index>(std::max(1.0, std::round(size[k] / side)));
    const auto number = [&](Index i, Index j, Index k) { return (k * (count[1] + 1) + j) * (count[0] + 1) + i; };
    HexMesh mesh;
    for (Index k = 0; k <= count[2]; ++k) {
        for (Index j = 0; j <= count[1]; ++j) {
            for (Index i = 0; i <= count[0]; ++i)
                mesh.points.push_back(box.lower + size * (Vec3(i, j, k) / Vec3(count[0], count[1], count[2])));
        }
    }
    for (Index k = 0; k < count[2]; ++k) {
        for (Index j = 0; j < count[1]; ++j) {
            for (Index i = 0; i < count[0]; ++i) {
                mesh.cells.push_back({number(i, j, k), number(i + 1, j, k), number(i + 1, j + 1, k), number(i, j + 1, k),
                                      number(i, j, k + 1), number(i + 1, j, k + 1), number(i + 1, j + 1, k + 1),
                                      number(i, j + 1, k + 1)});
            }
        }
    }
    return mesh;
}

std::vector<Vec3> places_in_cells(const HexMesh& mesh, int per_edge, const LimitOptions& options) {
    std::vector<LimitQuery> queries;
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (int i = 0; i < per_edge * per_edge * per_edge; ++i) {
            queries.push_back(
                {c, (Vec3(i % per_edge, i / per_edge % per_edge, i / (per_edge * per_edge)) + 0.5) / double(per_edge)});
        }
    }
    HexMesh bare = mesh;
    bare.attributes.clear();
    return evaluate_limit(bare, queries, options).positions;
}

}  // namespace subvol
