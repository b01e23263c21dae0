// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "canvas.h"

namespace subvol::detail {

/// A page of PDF in Helvetica, one of the fonts that every reader of PDF has.
class PdfCanvas : public Canvas {
public:
    explicit PdfCanvas(const Vec2& size) : size_(size) {}

    void grid(const Vec2& from, const Vec2& to) override;
    void frame(const Vec2& corner, const Vec2& size) override;
    void series(const Series& series) override;
    void text(const Vec2& place, Anchor anchor, const std::string& words, double size, bool upward) override;

    /// The whole file.
    [[nodiscard]] std::string file(const std::string& title) const;

private:
    [[nodiscard]] std::string at(const Vec2& place) const;
    [[nodiscard]] std::string marker(std::size_t shape, const Vec2& place) const;

    Vec2 size_;
    std::string page_;
};

}  // namespace subvol::detail
