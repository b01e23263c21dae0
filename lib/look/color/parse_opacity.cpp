// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <string_view>

#include "subvol/detail/knot_values.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "subvol/transfer_function.h"

namespace subvol {

using namespace detail;
namespace {

std::optional<double> number_in(std::string_view text) {
    const auto number = number_from(text);
    return number && std::isfinite(*number) ? number : std::nullopt;
}

class OpacityEntry {
public:
    OpacityEntry(std::string_view text, std::size_t index) : text_(text), index_(index) {}

    [[nodiscard]] TransferFunction::OpacityKnot read(const KnotRange& range) const {
        constexpr const char* kForm = "value:opacity or part%:opacity, such as 0%:0,50%:.2,100%:.9";
        const std::size_t colon = text_.find(':');
        if (colon == std::string_view::npos) refuse("is not a value and an opacity", kForm);
        std::string_view place = trimmed(text_.substr(0, colon));
        const bool part = !place.empty() && place.back() == '%';
        if (part) place.remove_suffix(1);
        const auto value = number_in(place), alpha = number_in(text_.substr(colon + 1));
        if (!value || !alpha) refuse(value ? "the opacity is not a number" : "the value is not a number", kForm);
        if (!(*alpha >= 0 && *alpha <= 1)) refuse("the opacity is out of range", "[0,1]");
        return {part ? range.at(*value / 100) : *value, *alpha};
    }

    [[noreturn]] void refuse(const char* message, const char* allowed = "") const {
        throw Error(ErrorCode::InvalidInput, message,
                    "opacity entry " + std::to_string(index_) + ", '" + std::string(trimmed(text_)) + "'", allowed);
    }

private:
    std::string_view text_;
    std::size_t index_;
};

}  // namespace

std::vector<TransferFunction::OpacityKnot> parse_opacity(const std::string& text, double min, double max) {
    const KnotRange range = usable_range(min, max);
    std::vector<TransferFunction::OpacityKnot> knots;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const OpacityEntry entry(std::string_view(text).substr(begin, end - begin), knots.size());
        const auto knot = entry.read(range);
        if (!knots.empty() && knot.value < knots.back().value) entry.refuse("the value is below the one before it");
        knots.push_back(knot);
        begin = end + 1;
    }
    part_equal_values(knots);
    return knots;
}

}  // namespace subvol
