#include <array>
#include <charconv>

#include "subvol/error.h"
#include "subvol/points_io.h"
#include "text_scanner.h"

namespace subvol {

namespace {

constexpr std::string_view kRadius = "kernel_radius ";

}  // namespace

std::string kernel_text(const Kernel& kernel) {
    const auto* compact = std::get_if<CompactKernel>(&kernel);
    if (!compact) throw Error(ErrorCode::MissingCapability, "only points with the compact kernel can be written");
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), compact->radius).ptr;
    return std::string(kRadius) + std::string(digits.data(), end);
}

Kernel kernel_from_text(const std::string& text) {
    const std::string_view line(text);
    double radius = 0;
    if (line.starts_with(kRadius)) std::from_chars(line.data() + kRadius.size(), line.data() + line.size(), radius);
    if (!(radius > 0 && radius < 1e3)) {
        throw Error(ErrorCode::InvalidInput, in_quotes(text) + " is no kernel", {}, "such as \"kernel_radius 1.43\"");
    }
    return CompactKernel{radius};
}

}  // namespace subvol
