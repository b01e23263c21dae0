// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "subvol/picture_maker.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The options of splatting.
struct SplatArguments : PictureChoices {
    SplatOptions chosen{};  ///< the options that the library describes

    void add_to(CLI::App& app);
    [[nodiscard]] std::vector<Option> described();

    [[nodiscard]] SplatOptions options() const;
};

}  // namespace subvol::cli
