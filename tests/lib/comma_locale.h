// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdlib.h>
#include <unistd.h>

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <locale>
#include <string>

namespace subvol::test {

/// Makes the German locale for this process, if it is not installed. The program localedef and the definitions are in
/// Debian's packages libc-bin and locales; without them nothing happens.
class BuiltLocale {
public:
    BuiltLocale() : folder_(std::filesystem::temp_directory_path() / ("subvol_locale_" + std::to_string(::getpid()))) {
        const std::string before = std::setlocale(LC_NUMERIC, nullptr);
        const bool installed = std::setlocale(LC_NUMERIC, "de_DE.UTF-8") != nullptr;
        std::setlocale(LC_NUMERIC, before.c_str());
        if (installed) return;
        std::filesystem::create_directories(folder_);
        const std::string command = "localedef -i de_DE -f UTF-8 '" + (folder_ / "de_DE.UTF-8").string() + "' > /dev/null 2>&1";
        if (std::system(command.c_str()) == 0) ::setenv("LOCPATH", folder_.c_str(), 1);
    }
    ~BuiltLocale() {
        ::unsetenv("LOCPATH");
        std::filesystem::remove_all(folder_);
    }
    BuiltLocale(const BuiltLocale&) = delete;
    BuiltLocale& operator=(const BuiltLocale&) = delete;

private:
    std::filesystem::path folder_;
};

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

    /// Whether that is so for printf and strtod.
    [[nodiscard]] static bool of_numbers() { return *std::localeconv()->decimal_point == ','; }

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
