// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "subvol/names.h"
#include "subvol/option_names.h"

namespace subvol {

/// Mcq:          interpolates the control points [mnmq2007]
/// CatmullClark: Catmull-Clark solids [mj1996]
/// Bsxw:         trilinear split and averaging [bsxw2002]
/// Linear:       the trilinear split alone
enum class Scheme { Mcq, CatmullClark, Bsxw, Linear };

template <>
struct NameTable<Scheme> {
    static constexpr Name<Scheme> rows[] = {{Scheme::Mcq, "mcq", "smooth, through the control points"},
                                            {Scheme::CatmullClark, "cc", "Catmull-Clark"},
                                            {Scheme::Bsxw, "bsxw", "Bajaj-Schaefer-Warren-Xu"},
                                            {Scheme::Linear, "linear"}};
};

/// Whether a scheme's volume passes through its control points.
[[nodiscard]] bool interpolates(Scheme scheme);

/// A scheme with its parameters, for all calls that refine, sample or evaluate a volume.
struct SchemeOptions {
    Scheme kind = Scheme::Mcq;
    double tension = 1.0 / 16.0;  ///< ω of MCQ: 0 is the trilinear split; cubics are reproduced at 1/16 only
    /// Boundary edges bent by more than this become creases too; (0,180], 180: none do
    std::optional<double> crease_angle_deg{};
};

/// The options as users know them; so for the other options of the library.
[[nodiscard]] std::vector<Option> options_of(SchemeOptions& options);

}  // namespace subvol
