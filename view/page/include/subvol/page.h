// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/boundary_values.h"
#include "subvol/camera.h"
#include "subvol/image.h"
#include "subvol/names.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"
#include "subvol/transfer_function.h"

namespace subvol {

/// How a page shows a body. Solid: its boundary, opaque and lit. Volume: transparent as the transfer function says. Xray: the
/// same on white.
enum class PageLook { Solid, Volume, Xray };

template <>
struct NameTable<PageLook> {
    static constexpr Name<PageLook> rows[] = {
        {PageLook::Solid, "solid"}, {PageLook::Volume, "volume"}, {PageLook::Xray, "xray"}};
};

/// A field of all steps of a page.
struct PageField {
    std::string name{};
    std::string unit{};
    TransferFunction function{};  ///< its colours, and the opacities of the looks Volume and Xray
    double min = 0, max = 1;      ///< over the values of all steps
};

/// One state of what a page shows.
struct PageStep {
    std::string label{};        ///< the name in the chooser of steps
    RbfVolume volume{};         ///< compact kernels without Hessians; one channel for each field of the page, in their order
    BoundaryValues boundary{};  ///< where the volume ends, closed, with a value for each field at its points
};

struct PageOptions {
    std::string title{};
    std::string source{};                                      ///< the file that the data are from
    std::vector<std::pair<std::string, std::string>> facts{};  ///< more of what stands on the page, under names
    std::vector<PageField> fields{};
    bool solid = true;  ///< whether there is a body whose boundary can be looked at; false: fog, without the look Solid
    PageLook look = PageLook::Solid;
    Camera camera{};                ///< the camera with which the page opens
    UpAxis up = UpAxis::Z;          ///< the axis of the world that is up when a side is chosen
    double opacity_unit_world = 0;  ///< as in Optics; 0: 1/100 of the diagonal
    Vec3 background{0.0};           ///< linear RGB
    /// A picture of the first field and the last step by the same camera, to be shown beside the page's own.
    std::optional<Image> reference{};
    std::size_t max_bytes = 24'000'000;  ///< the most bytes of the page; kernels are rounded, then merged, until they fit
    Progress* progress = nullptr;
};

/// How far a field of the page is from that of the given kernels, in its unit, at places inside all steps.
struct PageError {
    double rmse = 0;
    double max_abs = 0;
};

struct PageReport {
    std::size_t bytes = 0;
    int bits = 16;            ///< bits of each number of a kernel
    std::size_t kernels = 0;  ///< kernels of all steps, as given
    std::size_t kept = 0;     ///< kernels in the page
    std::size_t triangles = 0;
    std::vector<PageError> errors{};  ///< one for each field
};

struct PageResult {
    std::string html;
    PageReport report;
};

/// Makes one HTML page that needs no other file and no network, and draws the volume in the browser by WebGL2 as the splatter
/// does: the transfer function acts on the sums of the kernels, so it can be changed there, as can the camera, a clip plane,
/// the field and the step. The errors and the program's version stand on the page.
///
/// throws: Error(InvalidInput) if there is no step or no field, channels or values do not match the fields, a boundary is
///         empty, the look is Solid without a solid, kernels are not compact or have Hessians, or the page cannot be made that
///         small
/// cost:   O(kernels), some µs each; the same bytes for any number of threads
[[nodiscard]] PageResult make_page(std::span<const PageStep> steps, const PageOptions& options);

}  // namespace subvol
