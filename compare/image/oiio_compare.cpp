// SPDX-License-Identifier: Apache-2.0
#include "subvol/oiio_compare.h"

#include "image_difference.h"
#include "openimageio.h"
#include "subvol/detail/module.h"

namespace subvol {

using namespace detail;

const OpenImageIo& detail::openimageio() {
    using Entry = const OpenImageIo* (*)();
    static const OpenImageIo& functions =
        *reinterpret_cast<Entry>(load_module("openimageio", "reading or comparing pictures"))();
    return functions;
}

OiioMetrics compare_oiio(const Image& a, const Image& b, const OiioOptions& options) {
    check_comparable(a, b);
    return openimageio().compare(a, b, options);
}

std::size_t compare_yee(const Image& a, const Image& b, float luminance, float field_of_view_deg) {
    check_finite(a, b);
    return openimageio().compare_yee(a, b, luminance, field_of_view_deg);
}

}  // namespace subvol
