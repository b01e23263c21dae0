// SPDX-License-Identifier: Apache-2.0
#include "wavelet_output.h"

#include "quantities.h"
#include "text.h"

namespace subvol::cli {

Facts write_wavelets_reported(const std::string& path, const HexMesh& mesh, const WaveletFileOptions& options) {
    Facts facts;
    const WaveletFileReport written =
        facts.timed(options.progress, "wavelets", [&] { return write_wavelet_file(path, mesh, options); });
    std::size_t coefficients = 0, kept = 0;
    for (const WaveletArrayReport& array : written.arrays) {
        coefficients += array.coefficients;
        kept += array.kept;
    }
    const WaveletArrayReport &points = written.arrays.front(), &field = written.arrays.back();
    facts["points"] = mesh.points.size();
    facts["cells"] = written.cells;
    facts["levels"] = written.levels;
    facts["coarse_cells"] = written.coarse_cells;
    if (written.added_cells > 0) facts["added_cells"] = written.added_cells;
    facts["coefficients"] = coefficients;
    facts["coefficients_kept"] = kept;
    facts["bytes"] = written.bytes;
    facts["rms"] = field.rms;
    facts["max"] = field.max;
    facts["point_rms"] = points.rms;
    facts["point_max"] = points.max;
    facts["inverted_cells"] = written.inverted_cells;
    facts["output"] = path;
    if (written.inverted_cells > written.inverted_cells_before) {
        facts.warn(text(count_text(written.inverted_cells - written.inverted_cells_before),
                        " cells are inverted after rounding; a smaller --wavelet-point-tolerance keeps their shapes"));
    }
    return facts;
}

}  // namespace subvol::cli
