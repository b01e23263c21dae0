// SPDX-License-Identifier: Apache-2.0
#include "pdf_canvas.h"
#include "subvol/detail/module.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/plot.h"

namespace subvol {

using namespace detail;

const CairoFunctions& detail::cairo(const std::string& purpose) {
    using CairoEntry = const CairoFunctions* (*)();
    static const CairoFunctions& functions = *reinterpret_cast<CairoEntry>(load_module("cairo", purpose))();
    return functions;
}

void write_vector_graphic(const std::filesystem::path& path, const VectorGraphic& graphic, const std::string& title) {
    std::string bytes, fault;
    if (path.extension() == ".svg") {
        bytes = vector_graphic_svg(graphic, title);
    } else if (path.extension() == ".pdf") {
        bytes = cairo("writing pictures as .pdf").graphic(graphic, printable(title), fault);
    } else {
        throw Error(ErrorCode::InvalidInput, "is not the name of a vector graphic", path.string(), ".svg or .pdf");
    }
    if (!fault.empty()) throw Error(ErrorCode::InvalidInput, "cannot be drawn: " + fault, path.string());
    OutputFile file(path);
    file.write(bytes);
    file.commit();
}

}  // namespace subvol
