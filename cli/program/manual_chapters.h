// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace subvol::cli {

/// A chapter of the manual page beyond what the argument table says. Paragraphs are separated by empty lines; a paragraph whose
/// lines are indented is to be typed; one that begins with "TERM = " explains the term.
struct Chapter {
    const char* title;
    const char* text;
};

/// Before the verbs, and after them.
extern const std::array<Chapter, 3> kFirstChapters;
extern const std::array<Chapter, 6> kLastChapters;

}  // namespace subvol::cli
