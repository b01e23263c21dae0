// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/flip.h"
#include "subvol/image_metrics.h"
#include "subvol/ssim.h"

namespace subvol {

/// Two pictures of the same size, which must live as long, and what metrics of them share: each is made by the first metric
/// that needs it. Not for several threads at once.
class PicturePair {
public:
    PicturePair(const Image& test, const Image& reference, double pixels_per_degree = kFlipPixelsPerDegree);
    ~PicturePair();
    PicturePair(PicturePair&&) noexcept;
    PicturePair& operator=(PicturePair&&) noexcept;

    [[nodiscard]] const Image& test() const;
    [[nodiscard]] const Image& reference() const;
    [[nodiscard]] const ImageMetrics& differences() const;
    /// `luminance_ssim` of the pictures as they are; `on_screen().luminance_ssim()` is what [ssim2004] defines.
    [[nodiscard]] const SsimResult& luminance_ssim() const;
    /// `ssim` of red, green and blue.
    [[nodiscard]] const SsimResult& color_ssim() const;
    [[nodiscard]] const FlipResult& flip() const;
    [[nodiscard]] const HdrFlipResult& hdr_flip() const;
    /// The same pictures as `srgb8_image`s.
    [[nodiscard]] const PicturePair& on_screen() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A number that says how far two pictures are apart.
struct PictureMetric {
    std::string_view name;   ///< the name that `subvol compare` has for it
    std::string_view study;  ///< the name that studies have for it
    std::string_view stage;  ///< the stage whose seconds it takes
    /// The number. `mask`: the pixels that count, only if `masked`; empty: all.
    double (*of)(const PicturePair& pair, std::span<const std::uint8_t> mask);
    std::string_view unit{};
    bool more_is_better = false;
    bool masked = false;          ///< whether it can be of a part of the pixels
    bool encoded = false;         ///< whether `compare` also takes it of 8-bit sRGB
    bool seen = false;            ///< whether it is always of 8-bit sRGB
    std::string_view flag{};      ///< the option of `compare` that asks for it; empty: it is always taken
    std::string_view help{};      ///< the help of that option
    std::string_view quantity{};  ///< what an axis calls it; the unit is not part of it
    std::string_view formula{};   ///< its definition, with the colour space and the peak
    std::string_view source{};    ///< where the formula is from

    /// The number of a pair of pictures, in the colours that the metric is about.
    [[nodiscard]] double measure(const PicturePair& pair, std::span<const std::uint8_t> mask = {}) const {
        return of(seen ? pair.on_screen() : pair, mask);
    }
};

/// All metrics of pictures. The figures of `compare` and what --fail-under takes for better, the metrics of studies and the
/// units in reports are made from this table.
[[nodiscard]] std::span<const PictureMetric> picture_metrics();

/// The names of studies; those of masked metrics also with _interior and _edge.
[[nodiscard]] std::vector<std::string> study_metrics();

/// The metrics of a study by name; without those of a region that the reference does not have.
///
/// names: separated by commas
[[nodiscard]] std::map<std::string, double> measure_pictures(const Image& test, const Image& reference,
                                                             const std::string& names);

/// The metric of a figure: of "psnr", "srgb8.psnr" and "psnr_edge" that of psnr. Null: the figure is another one.
[[nodiscard]] const PictureMetric* find_metric(std::string_view figure);

}  // namespace subvol
