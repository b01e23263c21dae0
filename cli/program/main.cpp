// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>

#include "interrupt.h"
#include "manual.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/version.h"
#include "text.h"
#include "verb.h"

namespace {

using subvol::Error;
using subvol::ErrorCode;
using subvol::detail::printable;

constexpr int kBadInput = 2;
constexpr int kEnvironment = 3;
constexpr int kEndedBySignal = 128;  // and the signal's number, as shells count

constexpr const char* kDescription = "Subdivision volumes: refine hexahedral meshes, splat them, turn them into OpenVDB grids.";
constexpr const char* kFooter = R"(Start here:
  subvol model --list                    models to play with
  subvol info part.vtk                   what is in a mesh, is it sound
  subvol render model:ball -o ball.png   a picture of a model (or of part.vtk)
  subvol vdb part.vtk -o part.vdb        an OpenVDB grid
  subvol VERB --help                     everything about a verb

Exit codes: 0 done, 1 a comparison failed, 2 bad input, 3 the environment lacks something, 130 interrupted (143 by SIGTERM).)";

int exit_code(ErrorCode code) {
    switch (code) {
        case ErrorCode::MissingCapability:
            return kEnvironment;
        case ErrorCode::Cancelled:
            return kEndedBySignal + (subvol::cli::interrupt_signal() != 0 ? subvol::cli::interrupt_signal() : SIGINT);
        case ErrorCode::InvalidInput:
        case ErrorCode::Io:
            break;
    }
    return kBadInput;
}

int complain(const std::string& message, int code) {
    std::cerr << "subvol: " << message << '\n';
    return code;
}

/// For a mistyped verb the list of verbs is more helpful than the parser's "argument was not expected".
void check_verb(const CLI::App& program, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') return;
    std::vector<std::string> known;
    for (const CLI::App* verb : program.get_subcommands([](const CLI::App*) { return true; }))
        known.push_back(verb->get_name());
    if (std::ranges::find(known, argv[1]) == known.end()) {
        throw Error(ErrorCode::InvalidInput, std::string("'") + argv[1] + "' is not a verb", {}, subvol::cli::join(known));
    }
}

/// The library's messages name cells and points. This adds the name of the input where it is missing.
int run_naming_input(subvol::cli::Verb& verb, subvol::cli::Report& report) {
    try {
        return verb.run(report);
    } catch (const Error& error) {
        const std::string message = error.what();
        const std::string input = report.json().value("input", "");
        if (error.code() != ErrorCode::InvalidInput || message.find(input) != std::string::npos) throw;
        throw Error(error.code(), message, input);
    }
}

int run(CLI::App& program, int argc, char** argv) {
    program.set_version_flag("--version", SUBVOL_VERSION);
    const auto generate = [&program](const std::string& kind) {
        subvol::cli::write_manual(std::cout, kind, program);
        if (!std::cout.flush()) throw Error(ErrorCode::Io, "could not be written", "standard output");
        throw CLI::Success();
    };
    program.add_option_function<std::string>("--generate", generate, "the manual page or a shell's completion")
        ->group("")  // for the build: no help shows it
        ->check(CLI::IsMember(subvol::cli::kManuals))
        ->trigger_on_parse();
    program.require_subcommand(1);
    program.footer(kFooter);
    program.get_formatter()->column_width(36);
    const auto verbs = subvol::cli::make_verbs(program);

    check_verb(program, argc, argv);
    program.parse(argc, argv);
    for (const auto& verb : verbs) {
        if (!verb->chosen()) continue;
        const auto threads = static_cast<std::size_t>(verb->common().threads);
        const tbb::global_control limit(
            tbb::global_control::max_allowed_parallelism,
            threads > 0 ? threads : tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
        subvol::cli::catch_interrupts();
        subvol::cli::Report report(verb->common());
        const int code = run_naming_input(*verb, report);
        report.finish();
        return code;
    }
    return kBadInput;
}

/// A file that is opened while a standard stream is closed would take its place. This opens /dev/null there instead, so that
/// using the stream is an error.
void keep_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(stream, F_GETFD) < 0) (void)open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
}

/// Libraries may throw where exceptions cannot be caught, as OpenVDB does when it frees a grid and memory is short.
[[noreturn]] void end_with_a_sentence() {
    std::fputs("subvol: a library failed; memory may be short\n", stderr);
    std::_Exit(kEnvironment);
}

}  // namespace

int main(int argc, char** argv) {
    std::set_terminate(end_with_a_sentence);
    keep_standard_streams();
    setenv("EGL_LOG_LEVEL", "fatal", 0);  // we report a lack of OpenGL ourselves, in one sentence
    std::signal(SIGXFSZ, SIG_IGN);        // when a file gets too long, the write fails
    CLI::App program(kDescription, "subvol");
    try {
        return run(program, argc, argv);
    } catch (const CLI::Success& wanted) {  // --help, --version
        return program.exit(wanted);
    } catch (const CLI::ParseError& error) {
        return complain(std::string(error.what()) + " (see subvol --help)", kBadInput);
    } catch (const Error& error) {
        return complain(printable(error.what()), exit_code(error.code()));
    } catch (const std::bad_alloc&) {
        return complain("not enough memory for this; try a lower resolution or fewer levels", kEnvironment);
    } catch (const std::filesystem::filesystem_error& error) {
        return complain(printable(error.what()), kBadInput);
    } catch (const std::exception& error) {  // thrown unexpectedly by a library
        return complain(printable(error.what()), kEnvironment);
    }
}
