#pragma once

#include "subvol/render.h"

namespace subvol::detail {

/// Each n × n pixels become one, their mean; the depth is that of what is seen in all of them, by opacity.
void take_means(SplatResult& drawn, int n);

}  // namespace subvol::detail
