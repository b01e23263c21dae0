// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "canvas.h"

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
};

}  // namespace subvol::detail
