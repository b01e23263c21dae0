// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "openimageio.h"

namespace subvol::detail {

/// The functions of the module that uses OpenEXR, as in OpenImageIo. OpenImageIO reads every .exr there is; what this command
/// writes takes a tenth of the time without its 250 libraries.
struct OpenExr {
    std::optional<PictureFault> (*write)(const std::string& path, const PictureValues& picture);

    /// Reads a flat picture in scan lines whose channels are R, G, B, perhaps A, and then perhaps Z, as floats or halves.
    ///
    /// taken: whether it is such a picture; if not, it is for OpenImageIO
    std::optional<PictureFault> (*read)(const std::string& path, DecodedPicture& picture, bool& taken);
};

/// Loads the module when it is called first.
///
/// throws: Error(MissingCapability) if it is not there
[[nodiscard]] const OpenExr& openexr();

}  // namespace subvol::detail
