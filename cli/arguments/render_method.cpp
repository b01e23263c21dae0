// SPDX-License-Identifier: Apache-2.0
#include "render_method.h"

#include <cmath>

#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {

bool is_of_splats(const std::string& method) {
    return method == "splat" || method == "sheets" || method == "footprints";
}

void check_edges(const std::string& method, const PictureArguments& picture) {
    if (!picture.edges || is_of_splats(method)) return;
    throw Error(ErrorCode::InvalidInput, "method " + method + " has no depths to hide lines by", "--edges",
                "use --method splat or sheets");
}

void check_method(const std::string& method, const PictureArguments& picture, const SplatArguments& splat,
                  const ReferenceArguments& reference) {
    if (reference.lod && !std::isfinite(*reference.lod))
        throw Error(ErrorCode::InvalidInput, "is not a number of pixels", "--lod", "0 or more");
    (void)reference.projected_order();
    if (method == "pt") (void)reference.projected_options();
    if (is_of_splats(method)) {
        if (reference.lod && splat.seconds)
            throw Error(ErrorCode::InvalidInput, "a time limit chooses its own kernels", "--lod", "leave out --seconds");
        return;
    }
    if (reference.lod && method != "pt") {
        throw Error(ErrorCode::InvalidInput, "method " + method + " draws all there is", "--lod",
                    "use --method splat, sheets or pt");
    }
    if (splat.shadows || splat.ambient_occlusion > 0) {
        throw Error(ErrorCode::InvalidInput, "method " + method + " draws without them", "--shadows, --ambient-occlusion",
                    "use --method splat");
    }
    if (splat.shade || splat.color_field) {
        throw Error(ErrorCode::InvalidInput, "method " + method + " draws one field without light", "--shade, --color-field",
                    "use --method splat or sheets");
    }
    check_edges(method, picture);
    const bool on_gpu = method == "pt";
    if (splat.seconds && !on_gpu) {
        throw Error(ErrorCode::InvalidInput, "method " + method + " has no time limit", "--seconds",
                    "use --method splat, sheets or pt");
    }
    if (splat.backend == (on_gpu ? "cpu" : "gl")) {
        throw Error(ErrorCode::InvalidInput, text("method ", method, " is drawn by ", on_gpu ? "OpenGL" : "the CPU", " only"),
                    text("--backend ", splat.backend));
    }
}

}  // namespace subvol::cli
