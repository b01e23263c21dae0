// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace subvol::test {

/// While it exists, numbers have a decimal comma and points between thousands, as in German: for new streams always; for
/// printf, strtod and std::to_string if the system has such a locale.
class CommaLocale {
public:
    CommaLocale()
        : streams_(std::locale::global({std::locale::classic(), new Comma})), numbers_(std::setlocale(LC_NUMERIC, nullptr)) {
        for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE", "fr_FR"}) {
            if (std::setlocale(LC_NUMERIC, name)) return;
        }
    }
    ~CommaLocale() {
        std::setlocale(LC_NUMERIC, numbers_.c_str());
        std::locale::global(streams_);
    }
    CommaLocale(const CommaLocale&) = delete;
    CommaLocale& operator=(const CommaLocale&) = delete;

private:
    struct Comma : std::numpunct<char> {
        char do_decimal_point() const override { return ','; }
        char do_thousands_sep() const override { return '.'; }
        std::string do_grouping() const override { return "\3"; }
    };

    std::locale streams_;
    std::string numbers_;
};

}  // namespace subvol::test
