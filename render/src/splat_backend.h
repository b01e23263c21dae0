#pragma once

#include "splat_frame.h"
#include "subvol/image.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// A picture and the mean depth of what is seen in each pixel, by opacity (eye depth; infinity where nothing is).
struct Drawn {
    Image image;
    std::vector<float> depth;
};

[[nodiscard]] Drawn draw_splats_cpu(const SplatFrame& frame, Progress* progress);

}  // namespace subvol::detail
