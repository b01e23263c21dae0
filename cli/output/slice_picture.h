// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report.h"
#include "subvol/legend.h"
#include "subvol/limit_slice.h"
#include "subvol/transfer_function.h"

namespace subvol::cli {

/// How a slice is drawn.
struct SlicePicture {
    TransferFunction function{};
    std::optional<LegendOptions> legend{};
    Vec3 background{1.0};
    std::string title{};
    bool axes = false;
    bool extremes = false;        // mark them
    bool contour_labels = false;  // write the values of the lines on them
    Vec3 point{0.0};              // of the plane, from which lengths along its sides count
};

/// Whether a file has lines and letters as shapes: .svg and .pdf.
[[nodiscard]] bool is_vector_graphic(const std::string& path);

/// Writes a slice as a picture, with what explains it: of .png and .exr the pixels, of .svg and .pdf the pixels of the slice
/// with lines and letters as shapes over it.
///
/// report: gets the places of the extremes that are marked, and a warning of letters that cannot be drawn
void write_slice_picture(const std::string& path, const LimitSlice& slice, const std::vector<ContourLine>& lines,
                         const SlicePicture& picture, Report& report);

}  // namespace subvol::cli
