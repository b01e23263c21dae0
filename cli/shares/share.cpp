// SPDX-License-Identifier: Apache-2.0
#include "share.h"

#include <CLI/CLI.hpp>
#include <charconv>

#include "options.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol::cli {
namespace {

constexpr int kMostShares = 1 << 20;

bool whole_number(std::string_view text, int& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

Share parse_share(const std::string& option, const std::string& text) {
    const std::size_t slash = text.find('/');
    Share share;
    const bool numbers = slash != std::string::npos && whole_number(std::string_view(text).substr(0, slash), share.number) &&
                         whole_number(std::string_view(text).substr(slash + 1), share.count);
    if (!numbers)
        throw Error(ErrorCode::InvalidInput, "'" + text + "' does not name a share", option, "K/N, such as 1/4 to 4/4");
    if (share.count < 1 || share.count > kMostShares) {
        throw Error(ErrorCode::InvalidInput, "there cannot be " + std::to_string(share.count) + " shares", option,
                    "1 to " + std::to_string(kMostShares));
    }
    if (share.number < 1 || share.number > share.count) {
        const std::string count = std::to_string(share.count);
        throw Error(ErrorCode::InvalidInput, "there is no share " + std::to_string(share.number) + " of " + count, option,
                    "1/" + count + " to " + count + "/" + count);
    }
    return share;
}

void ShareArgument::add_to(CLI::App& app, const std::string& does) {
    add_option(app, Option("part", text_).help("K/N", "do one of N shares of the work, K from 1 to N: " + does));
}

Share ShareArgument::share() const {
    return given() ? parse_share("--part", text_) : Share{};
}

}  // namespace subvol::cli
