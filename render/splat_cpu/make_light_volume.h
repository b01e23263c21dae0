// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "light_volume.h"
#include "splat_scene.h"

namespace subvol::detail {

/// The light that arrives in a scene's volume, seen in a view: its key light is fixed to the eye. Clips let light in.
///
/// cost: as a picture of 128² pixels and 128 sheets for shadows, and seven of 64² and 64 sheets for ambient occlusion
[[nodiscard]] LightVolume make_light_volume(const SplatScene& scene, const View& view, const Classification& classification);

}  // namespace subvol::detail
