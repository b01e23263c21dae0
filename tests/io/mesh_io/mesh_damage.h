// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>

#include "lib/temp_folder.h"
#include "subvol/detail/printable.h"
#include "subvol/mesh_io.h"

namespace subvol::test {

/// Any byte, but often one that has a meaning for parsers.
inline char odd_byte(std::mt19937& random) {
    constexpr std::string_view kLikely = "0123456789-+.eE \n#na\t%\"";
    const auto draw = random();
    return draw % 2 == 0 ? static_cast<char>(draw >> 8) : kLikely[(draw >> 8) % kLikely.size()];
}

inline std::string damaged(std::string text, std::mt19937& random) {
    const auto place = [&] { return random() % text.size(); };
    const auto ways = random() % 4;
    if (ways == 0) return text.substr(0, place());
    if (ways == 1) return text.erase(place(), 1 + random() % 40);
    if (ways == 2) return text.insert(place(), text.substr(place(), random() % 40));
    for (auto flips = 1 + random() % 4; flips > 0; --flips) text[place()] = odd_byte(random);
    return text;
}

/// SUBVOL_MUTATIONS sets how many damaged files a test makes of each good one.
inline int run_count() {
    constexpr int kUsual = 1500;
    const char* const given = std::getenv("SUBVOL_MUTATIONS");
    return given ? std::max(std::atoi(given), 1) : kUsual;
}

/// A text for people or JSON, which must not repeat bytes of a file that a terminal obeys.
inline void expect_printable(const std::string& text) {
    EXPECT_FALSE(text.empty());
    EXPECT_EQ(text, detail::printable(text));
}

/// A test of how a reader copes with damaged files.
class MeshFuzz : public TempFolder {
protected:
    /// A damaged file either gives a valid mesh or is refused by an Error; the reader throws nothing else.
    void expect_sound_or_refused(const std::string& extension, const std::string& text, unsigned seed) const {
        const int runs = run_count();
        std::mt19937 random(seed);
        int refused = 0;
        for (int run = 0; run < runs; ++run) {
            const auto file =
                write(std::to_string(run) + extension, damaged(text, random));  // a new file each time: truncating one is slow
            try {
                const ReadResult read = read_mesh(file);
                validate(read.mesh);
                validate(read.sets, read.mesh);
                if (!read.shells.empty()) validate(read.shells, read.mesh);
                for (const std::string& warning : read.warnings) expect_printable(warning);
                for (const FieldInfo& field : read.fields) expect_printable(field.name);
                for (const Attribute& attribute : read.mesh.attributes) expect_printable(attribute.name);
                for (const Patch& patch : read.sets.patches) expect_printable(patch.name);
                for (const CellSet& set : read.sets.sets) expect_printable(set.name);
            } catch (const Error& error) {
                expect_printable(error.what());
                ++refused;
            }
            std::filesystem::remove(file);
        }
        EXPECT_GT(refused, runs / 10);  // the damage is real
    }
};

}  // namespace subvol::test
