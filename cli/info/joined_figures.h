// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "file_info.h"
#include "mesh_figures.h"
#include "part_note.h"
#include "subvol/detail/mesh_share.h"
#include "subvol/error.h"
#include "transport.h"

namespace subvol::cli {

/// The figures of the whole mesh, of which each process finds a share; with --part those of this share, which go into the
/// report.
///
/// inspect: finds the figures of this process's share
template <class Inspect>
[[nodiscard]] detail::MeshShare joined_figures(const InfoRequest& request, Report& report, const Inspect& inspect) {
    if (request.is_part && !request.common.json) {
        throw Error(ErrorCode::InvalidInput, "the figures of a share are for `subvol join`, which reads JSON", "--part",
                    "--json, and the output in a file");
    }
    const Share share = request.share.value_or(Share{});
    detail::MeshShare figures = report.timed("inspect", [&] { return inspect(share); });
    if (request.is_part) {
        report["part"] = share.name();
        report["part_note"] = text_of(make_note(request.app, request.input, share, figures.range));
        report["part_figures"] = json_of(figures);
        return figures;
    }
    return report.unpack(join_ranks(FigureParts{}, figures, request.ranks, report.progress())).value_or(figures);
}

/// Whether another process prints the report.
[[nodiscard]] inline bool is_silent(const InfoRequest& request) {
    return request.ranks != nullptr && !request.ranks->first();
}

}  // namespace subvol::cli
