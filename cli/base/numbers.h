// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace CLI {
class Validator;
}

namespace subvol::cli {

// Every option that takes a number has one of these, by `transform`: the text is refused unless it is a finite number of the
// range, and becomes the plain decimal that the parser of the command line converts. That parser alone would take "nan", "inf",
// "0x10" and "010", and an empty text as 0.

[[nodiscard]] CLI::Validator whole_number(std::int64_t least, std::int64_t most);
[[nodiscard]] CLI::Validator number_in(double least, double most);
/// More than 0. Numbers so small or so large that their squares or cubes are 0 or infinite are refused.
[[nodiscard]] CLI::Validator positive_number();
[[nodiscard]] CLI::Validator not_negative_number();
[[nodiscard]] CLI::Validator any_number();
/// A number, or one with % behind it.
[[nodiscard]] CLI::Validator number_or_percent();
/// A word, or one of these.
[[nodiscard]] CLI::Validator number_or(const std::string& word, const CLI::Validator& number);
/// So many numbers with commas between them. example: what would be right
[[nodiscard]] CLI::Validator number_list(std::size_t count, const std::string& example);
/// "3-12", or "12" for "1-12": numbers of frames, at most a million.
[[nodiscard]] CLI::Validator frame_range();
/// "500M", "1G", "1048576": in units of 1024, 1024² and so on.
[[nodiscard]] CLI::Validator byte_count();

/// The first and the last frame of a sequence.
struct FrameRange {
    int first = 1, last = 1;

    [[nodiscard]] int count() const { return last - first + 1; }
};

/// "3-12", or "10" for 1 to 10.
///
/// throws: Error(InvalidInput) if it is anything else, or has more than a million frames
[[nodiscard]] FrameRange parse_frames(const std::string& text);

/// option: named in the error
///
/// throws: Error(InvalidInput) if it is not a finite number
[[nodiscard]] double parse_number(const std::string& option, const std::string& value);

}  // namespace subvol::cli
