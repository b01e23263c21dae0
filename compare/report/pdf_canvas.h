// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "canvas.h"
#include "subvol/overlay.h"

namespace subvol::detail {

/// A page of PDF, which the module draws by cairo. The parts of the font that the texts need are embedded.
class PdfCanvas : public Canvas {
public:
    /// The bytes of the whole file, after which nothing is drawn any more. fault: why it failed; empty if it did not
    [[nodiscard]] virtual std::string file(std::string& fault) = 0;
};

/// The functions of the module that uses cairo; they throw nothing but std::bad_alloc.
struct CairoFunctions {
    /// size: of the page, in PostScript points; scale: of lines and markers
    std::unique_ptr<PdfCanvas> (*page)(const Vec2& size, double scale, const std::string& title);
    /// A vector graphic as the bytes of a whole file, as of `PdfCanvas::file`.
    std::string (*graphic)(const VectorGraphic& graphic, const std::string& title, std::string& fault);
};

/// Loads the module that draws pages of PDF when it is called first.
///
/// purpose: what it is needed for
/// throws:  Error(MissingCapability) if it is not there
[[nodiscard]] const CairoFunctions& cairo(const std::string& purpose);

}  // namespace subvol::detail
