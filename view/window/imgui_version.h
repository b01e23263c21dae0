// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <imgui.h>

#include <cstdint>

// What differs between versions of Dear ImGui. Keys, which changed in 1.87, come from GLFW instead.

namespace subvol::detail {

/// A texture of OpenGL for ImDrawList::AddImage: a pointer until 1.91.3, a number from 1.91.4 on.
[[nodiscard]] inline ImTextureID texture_id(unsigned texture) {
#if IMGUI_VERSION_NUM >= 19140
    return static_cast<ImTextureID>(texture);
#else
    return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture));
#endif
}

}  // namespace subvol::detail
