// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/limit_words.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/number_text.h"

namespace subvol::detail {
namespace {

constexpr double kWorthSaying = 0.01;

std::string percent(double part) {
    return number_text(100 * part, 2) + " %";
}

std::string cure(OptionNames names) {
    const bool flags = names == OptionNames::Flags;
    return ": a smaller " + option_name("crease-angle", names) + " keeps more sharp edges, " +
           (flags ? "--scheme linear" : "scheme='linear'") + " is the cells";
}

}  // namespace

std::string limit_words(const LimitBody& body, OptionNames names) {
    const double more = body.given_volume > 0 ? body.volume / body.given_volume - 1 : 0;
    if (std::abs(more) > kWorthSaying)
        return "the limit has " + percent(std::abs(more)) + (more > 0 ? " more" : " less") +
               " volume than the cells of the file" + cure(names);
    if (body.difference() > kWorthSaying)
        return "the box of the limit differs from that of the cells of the file by " + percent(body.difference()) +
               " of its longest side" + cure(names);
    return "";
}

std::string fold_words(std::size_t cells, Index first, const Vec3& place, OptionNames names) {
    if (cells == 0) return "";
    const bool flags = names == OptionNames::Flags;
    const std::string where = first == kNone ? "" : "in cell " + std::to_string(first) + " ";
    return "the limit folds in at least " + std::to_string(cells) + (cells == 1 ? " cell" : " cells") + ", as " + where +
           "at " + number_text(place.x, 4) + "," + number_text(place.y, 4) + "," + number_text(place.z, 4) + ": " +
           (flags ? "subvol check finds them all, and with --mend moves points until it does not fold"
                  : "check_folds finds them all, mend_folds moves points until it does not fold") +
           "; a smaller " + option_name("crease-angle", names) + " may do, too";
}

std::string range_words(const std::string& field, double file_min, double file_max, double min, double max, OptionNames names,
                        bool at_least) {
    const double range = file_max - file_min, beyond = std::max(max - file_max, file_min - min);
    if (!(range > 0) || !(beyond > kWorthSaying * range)) return "";
    return field + " is " + number_text(min) + " to " + number_text(max) + " in the limit, beyond its range in the file by " +
           (at_least ? "at least " : "") + percent(beyond / range) + ": " +
           (names == OptionNames::Flags ? "--clamp file" : "clamp='file'") + " keeps it within";
}

}  // namespace subvol::detail
