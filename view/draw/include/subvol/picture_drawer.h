// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "subvol/image.h"
#include "subvol/picture_maker.h"
#include "subvol/progress.h"
#include "subvol/view_state.h"

namespace subvol {

struct DrawnPicture {
    Image image;
    std::vector<float> depth{};  ///< for each pixel, as of SplatResult; empty: not known
    int scale = 1;  ///< 1 for a full picture; else its pixels are so many times as wide and as high, and the image is smaller
    ViewState state{};
    std::string backend{};
    std::size_t points = 0;    ///< kernels, tetrahedra, small cells, or points of the boundary
    bool is_boundary = false;  ///< whether the picture is that of a solid by its boundary alone
    double seconds_build = 0;  ///< for what is kept from picture to picture: kernels, boundary, tetrahedra
    double seconds_boundary = 0, seconds_kernels = 0;  ///< for the boundary and the kernels that were made anew
    double seconds_draw = 0;
};

/// Draws the pictures of `subvol render`, bit for bit, and keeps what does not depend on the view from picture to picture. Not
/// for several threads at once.
class PictureDrawer {
public:
    explicit PictureDrawer(const MethodOptions& settings);
    ~PictureDrawer();
    PictureDrawer(PictureDrawer&&) noexcept;
    PictureDrawer& operator=(PictureDrawer&&) noexcept;

    /// body:   kept until the next call with another one
    /// scale:  1 for the full picture; of a coarse one the width and height of its pixels in those of the full one
    /// throws: Error(InvalidInput) for a method that cannot draw this look, and as the renderers; Error(Cancelled)
    [[nodiscard]] DrawnPicture draw(const ViewState& state, const std::shared_ptr<const ViewBody>& body, int scale = 1,
                                    Progress* progress = nullptr);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol
