// SPDX-License-Identifier: Apache-2.0
#include "subvol/oiio_compare.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include "image_difference.h"

namespace subvol {

using namespace detail;

namespace {

OIIO::ImageBuf as_buffer(const Image& image) {
    // The buffer refers to the pixels and only reads them; its constructor has no const variant in OpenImageIO 2.4.
    OIIO::ImageSpec spec(image.width, image.height, 4, OIIO::TypeDesc::FLOAT);
    return OIIO::ImageBuf(spec, const_cast<float*>(image.rgba.data()));
}

}  // namespace

OiioMetrics compare_oiio(const Image& a, const Image& b, const OiioOptions& options) {
    check_comparable(a, b);
    const auto result = OIIO::ImageBufAlgo::compare(as_buffer(a), as_buffer(b), options.fail, options.warn,
                                                    options.fail_relative, options.warn_relative);
    // `error` is also set by failures; for pictures of one size and format there are no other errors.
    return {result.meanerror, result.rms_error, result.PSNR, result.maxerror, result.nwarn, result.nfail};
}

std::size_t compare_yee(const Image& a, const Image& b, float luminance, float field_of_view_deg) {
    check_finite(a, b);
    OIIO::ImageBufAlgo::CompareResults result{};
    const int failures = OIIO::ImageBufAlgo::compare_Yee(as_buffer(a), as_buffer(b), result, luminance, field_of_view_deg);
    return static_cast<std::size_t>(failures);
}

}  // namespace subvol
