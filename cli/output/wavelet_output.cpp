// SPDX-License-Identifier: Apache-2.0
#include "wavelet_output.h"

#include "quantities.h"
#include "report.h"
#include "text.h"

namespace subvol::cli {

void write_wavelets_reported(const std::string& path, const HexMesh& mesh, const WaveletFileOptions& options, Report& report) {
    const WaveletFileReport written = report.timed("wavelets", [&] { return write_wavelet_file(path, mesh, options); });
    std::size_t coefficients = 0, kept = 0;
    for (const WaveletArrayReport& array : written.arrays) {
        coefficients += array.coefficients;
        kept += array.kept;
    }
    const WaveletArrayReport &points = written.arrays.front(), &field = written.arrays.back();
    report["points"] = mesh.points.size();
    report["cells"] = written.cells;
    report["levels"] = written.levels;
    report["coarse_cells"] = written.coarse_cells;
    if (written.added_cells > 0) report["added_cells"] = written.added_cells;
    report["coefficients"] = coefficients;
    report["coefficients_kept"] = kept;
    report["bytes"] = written.bytes;
    report["rms"] = field.rms;
    report["max"] = field.max;
    report["point_rms"] = points.rms;
    report["point_max"] = points.max;
    report["inverted_cells"] = written.inverted_cells;
    report["output"] = path;
    if (written.inverted_cells > written.inverted_cells_before) {
        report.warn(text(count_text(written.inverted_cells - written.inverted_cells_before),
                         " cells are inverted after rounding; a smaller --wavelet-point-tolerance keeps their shapes"));
    }
}

}  // namespace subvol::cli
