// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "subvol/clip.h"
#include "subvol/names.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"
#include "subvol/shading.h"

namespace subvol {

/// How kernels are drawn; for a number of sheets the pictures of the first four are the same.
///
/// Auto:   Gl where there is a hardware GPU, else Cpu; Cpu, too, as soon as the GPU refuses the shaders, has no memory left or
/// is
///         lost, with a warning in the report
/// Cpu:    tiles of the picture, batches of sheets, on all threads
/// Gl:     the same by OpenGL compute shaders
/// Sheets: one sheet buffer after the other, drawn and composited by OpenGL, also by software: the method of the EuroVis 2007
///         paper, for comparison. Without a number of sheets it has no more of them where kernels are thin
/// Footprints: the method of [westover1990], for comparison: kernels are coloured first, by the value at their centre, and
///         composited one by one by the integrals of their weights along rays. Another picture: blurred, and not cut off at
///         the boundary. By the CPU, for radial kernels, without cuts and shadows
enum class SplatMethod { Auto, Cpu, Gl, Sheets, Footprints };

/// The names of the backends; users choose the other two as methods of pictures.
template <>
struct NameTable<SplatMethod> {
    static constexpr Name<SplatMethod> rows[] = {
        {SplatMethod::Auto, "auto"}, {SplatMethod::Gl, "gl"}, {SplatMethod::Cpu, "cpu"}};
};

struct SplatOptions {
    SplatMethod method = SplatMethod::Auto;
    std::optional<int> device{};  ///< the OpenGL device's number in gl_devices(); none: the first hardware, else software
    int samples = 1;              ///< the mean of n × n places on a regular grid in each pixel is taken, 1..16
    /// Planes of constant eye depth over the volume's depth range, 2..65536; 0: as many as the kernels need for the tolerance.
    /// Where rays enter and leave the volume it is sampled besides, so bodies thinner than a sheet are not lost.
    int sheets = 0;
    /// Without a number of sheets, the RMS by which colours may differ from those of very many sheets, > 0; single pixels may
    /// differ by about as much, as kernels that are thin for the sheets get more of them (SplatReport::sheets_finest).
    double image_tolerance = 1e-3;
    /// If above 0: without a number of sheets, what `sheets_of_picture` has found for a picture of which this volume has some
    /// of the kernels.
    int needed_sheets = 0;
    std::size_t channel = 0;  ///< the channel of the volume that is shown
    /// A channel for the colours that is not that of the opacities; its colours are not pre-integrated.
    std::optional<std::size_t> color_channel{};
    bool normalized = true;  ///< whether sums are divided by the sum of weights; if not, kernels add up as they are
    std::optional<Shading> shading{};
    Clip clip{};  ///< how the volume is cut open; Splatter::set_clip changes it later
    /// Whether the volume shadows itself from the key light (of `shading`, else of `Shading{}`); where no light of it arrives,
    /// the part Shading::ambient of colours without light on surfaces is left. Not with Sheets.
    bool shadows = false;
    /// If above 0: darkens places from which less than half of the directions are open over this distance, in parts of the
    /// volume's diagonal, at most 1. Not with Sheets.
    double ambient_occlusion = 0;
    Progress* progress = nullptr;
};

/// The backend, the device, the sheets, and the light inside the volume.
[[nodiscard]] std::vector<Option> options_of(SplatOptions& options);

}  // namespace subvol
