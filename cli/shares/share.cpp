// SPDX-License-Identifier: Apache-2.0
#include "share.h"

#include <CLI/CLI.hpp>
#include <charconv>

#include "subvol/error.h"

namespace subvol::cli {
namespace {

constexpr int kMostShares = 1 << 20;

bool whole_number(std::string_view text, int& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::pair<std::size_t, std::size_t> Share::range(std::size_t things) const {
    const auto first = static_cast<std::size_t>(part - 1), count = static_cast<std::size_t>(of);
    // Without a product that may overflow: every share has things/of, the first ones one more.
    const std::size_t each = things / count, more = things % count;
    const auto begin = [&](std::size_t share) { return share * each + std::min(share, more); };
    return {begin(first), begin(first + 1)};
}

std::string Share::name() const {
    return std::to_string(part) + "/" + std::to_string(of);
}

Share parse_share(const std::string& option, const std::string& text) {
    const std::size_t slash = text.find('/');
    Share share;
    const bool numbers = slash != std::string::npos && whole_number(std::string_view(text).substr(0, slash), share.part) &&
                         whole_number(std::string_view(text).substr(slash + 1), share.of);
    if (!numbers) throw Error(ErrorCode::InvalidInput, "'" + text + "' is no share", option, "K/N, such as 1/4 to 4/4");
    if (share.of < 1 || share.of > kMostShares) {
        throw Error(ErrorCode::InvalidInput, "there cannot be " + std::to_string(share.of) + " shares", option,
                    "1 to " + std::to_string(kMostShares));
    }
    if (share.part < 1 || share.part > share.of) {
        throw Error(ErrorCode::InvalidInput,
                    "there is no share " + std::to_string(share.part) + " of " + std::to_string(share.of), option,
                    "1/" + std::to_string(share.of) + " to " + std::to_string(share.of) + "/" + std::to_string(share.of));
    }
    return share;
}

void ShareArgument::add_to(CLI::App& app, const std::string& does) {
    app.add_option("--part", text_, "do one of N shares of the work, K from 1 to N: " + does)->type_name("K/N");
}

Share ShareArgument::share() const {
    return given() ? parse_share("--part", text_) : Share{};
}

}  // namespace subvol::cli
