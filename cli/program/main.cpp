// SPDX-License-Identifier: Apache-2.0
// The program: it parses the words of the command line, runs one verb, and turns whatever is thrown into one message and one
// exit code.
//
//     words ─► parser ─► verb ─► report          code 0, or 1 if a comparison failed
//                │        │
//                └────────┴────► error           2 bad input, 3 something is missing, 128 + the signal if it is interrupted
//
// An error goes to standard error as a sentence with its place; with --json an object on standard output says it, too. Of
// several processes that MPI started, rank 0 alone speaks, and all end with the error of any: the ranks agree on it before one
// of them ends, as mpirun ends the others with the first. The cores of a computer are divided among its ranks. Before the
// parser runs, closed standard streams are filled, so that no output file takes their place, and numbers get a point whatever
// the locale is.
#include <execinfo.h>
#include <fcntl.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "choices.h"
#include "foreign_input.h"
#include "help.h"
#include "interrupt.h"
#include "manual.h"
#include "mistakes.h"
#include "ranks.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/several_errors.h"
#include "subvol/error.h"
#include "subvol/version.h"
#include "text.h"
#include "verb.h"

namespace {

using subvol::Error;
using subvol::ErrorCode;
using subvol::detail::printable_message;
using subvol::detail::SeveralErrors;

constexpr int kBadInput = 2;
constexpr int kEnvironment = 3;
constexpr int kEndedBySignal = 128;  // and the signal's number, as shells count

constexpr const char* kCompress = "compress";
constexpr const char* kDescription = "Refine hexahedral meshes, render them as splats, and convert them to OpenVDB grids.";
constexpr const char* kFooter = R"(Start here:
  subvol model --list                    list the built-in models
  subvol info part.vtk                   print mesh statistics, check the mesh
  subvol render model:ball -o ball.png   render a model (or part.vtk)
  subvol vdb part.vtk -o part.vdb        write an OpenVDB grid
  subvol help render                     show the options of a command

Exit codes: 0 done, 1 a comparison failed, 2 bad input, 3 a required component is missing, 130 interrupted (143 by SIGTERM).)";

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

/// Whether this process prints messages: if MPI started several, only rank 0 does.
bool speaks() {
    const auto rank = subvol::cli::rank_in_environment();
    return !rank || rank->rank == 0;
}

/// Says what is wrong on standard error; with --json an object on standard output says it, too.
int complain(const Error& error, int code, bool json, const std::optional<SeveralErrors>& several = {}) {
    if (!speaks()) return code;
    subvol::cli::say_at_last([&] {
        // The message is put together from the error's parts, because what() ends at a zero byte.
        const std::string sentence = subvol::detail::error_sentence(error.where(), error.message(), error.allowed());
        std::string text = "subvol: " + printable_message(sentence) + "\n";
        if (several) {  // each mistake on a line of its own
            text = "subvol: ";
            for (const std::string& line : several->lines()) text += line + "\n";
        }
        std::cerr << text;  // in one go: mpirun may write between two
        if (json)
            std::cout << subvol::cli::error_json(error, code, several ? several->all() : std::vector<Error>()) << std::endl;
    });
    return code;
}

/// The library's messages name cells and points. This adds the name of the input where it is missing.
int run_naming_input(subvol::cli::Verb& verb, subvol::cli::Report& report) {
    try {
        return verb.run(report);
    } catch (const SeveralErrors&) {  // they name their input
        throw;
    } catch (const Error& error) {
        const std::string input = report.json().value("input", "");
        if (error.code() != ErrorCode::InvalidInput || std::string(error.what()).find(input) != std::string::npos) throw;
        const std::string where = error.where().empty() ? input : input + ": " + error.where();
        throw Error(error.code(), error.message(), where, error.allowed());
    }
}

/// Whether an exception says that no thread could be started: the standard library's, or TBB's, which has a text alone.
bool lacks_threads(const std::exception& error) {
    const auto* const system = dynamic_cast<const std::system_error*>(&error);
    return (system != nullptr && system->code() == std::errc::resource_unavailable_try_again) ||
           std::string_view(error.what()).starts_with("pthread_create");
}

/// The exception that is being handled as an error, the program's exit code for it, and its parts if it is of several mistakes.
struct ErrorAtHand {
    Error error;
    int code;
    std::optional<SeveralErrors> several{};
};

ErrorAtHand error_at_hand() {
    try {
        throw;
    } catch (const SeveralErrors& several) {
        return {several, exit_code(several.code()), several};
    } catch (const Error& error) {
        return {error, exit_code(error.code())};
    } catch (const std::bad_alloc&) {
        return {Error(ErrorCode::MissingCapability, "not enough memory for this; try a lower resolution or fewer levels"),
                kEnvironment};
    } catch (const std::filesystem::filesystem_error& error) {
        return {Error(ErrorCode::InvalidInput, error.what()), kBadInput};
    } catch (const std::exception& error) {  // thrown unexpectedly by a library
        if (!lacks_threads(error)) return {Error(ErrorCode::InvalidInput, error.what()), kEnvironment};
        return {Error(ErrorCode::MissingCapability, "the system cannot start another thread; try fewer with --threads"),
                kEnvironment};
    }
}

/// An error that has been said. code: to exit with
struct Said {
    int code;
};

/// Runs a verb in all processes together: they end together, and if one fails, all fail with its error. It is said before any
/// of them ends, as mpirun ends the others when one has failed.
int run_in_ranks(subvol::cli::Verb& verb, subvol::cli::Report& report, subvol::cli::Ranks& ranks) {
    int code = 0;
    try {
        code = run_naming_input(verb, report);
        report.merge(ranks.facts());
    } catch (...) {
        auto [error, wrong, several] = error_at_hand();
        try {
            if (!ranks.agreed()) ranks.agree(&error);
        } catch (const Error& of_all) {
            error = of_all;
            wrong = exit_code(of_all.code());
        }
        complain(error, wrong, verb.common().json, several);
        ranks.finish();
        throw Said{wrong};
    }
    ranks.finish();
    return code;
}

/// The options of a process whose words nobody shall read, because another one speaks.
subvol::cli::CommonOptions silent(subvol::cli::CommonOptions options) {
    options.json = false;
    options.quiet = true;
    options.progress = "off";
    return options;
}

/// The number of threads if none was chosen: the cores of this computer, divided among the processes that MPI started on it.
std::size_t default_threads(const std::optional<subvol::cli::RankInEnvironment>& rank) {
    if (!rank) return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    return std::max(1U, std::thread::hardware_concurrency() / static_cast<unsigned>(rank->on_host));
}

/// Whether these arguments ask `points` for a compressed mesh, which `compress` writes.
bool ask_points_to_compress(const std::vector<std::string>& arguments) {
    constexpr std::array<std::string_view, 5> kOptions{"--wavelet-tolerance", "--wavelet-point-tolerance", "--max-error",
                                                       "--max-point-error", "--key-steps"};
    if (arguments.empty() || arguments.front() != "points") return false;
    for (std::size_t i = 1; i < arguments.size(); ++i) {
        const std::string name = arguments[i].substr(0, arguments[i].find('='));
        const bool is_output = name == "--output" || arguments[i - 1] == "--output" || arguments[i - 1] == "-o";
        if (is_output && arguments[i].ends_with(".svw")) return true;
        if (std::ranges::find(kOptions, name) != kOptions.end()) return true;
    }
    return false;
}

/// "help VERB" is "VERB --help", "help" alone "--help"; "--clamp file" is "--clamp-file", as --clamp alone has no value; and
/// "points" is "compress" where it was asked for a compressed mesh.
std::vector<std::string> asked(int argc, char** argv) {
    std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
    for (std::size_t i = 0; i + 1 < arguments.size(); ++i) {
        if (arguments[i] != "--clamp" || arguments[i + 1] != "file") continue;
        arguments[i] = "--clamp-file";
        arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    }
    if (ask_points_to_compress(arguments)) arguments.front() = kCompress;
    if (arguments.empty() || arguments.front() != "help") return arguments;
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
    return arguments;
}

/// given: the first word that the user wrote
int run(CLI::App& program, std::vector<std::string> arguments, std::string_view given) {
    program.set_help_flag("-h,--help", "print this help, or that of a verb");
    program.set_help_all_flag("--help-all", "print all options of a verb");
    program.set_version_flag("--version", SUBVOL_VERSION, "print the version");
    const auto generate = [&program](const std::string& kind) {
        subvol::cli::write_manual(std::cout, kind, program);
        if (!std::cout.flush()) throw Error(ErrorCode::Io, "could not be written", "standard output");
        throw CLI::Success();
    };
    program.add_option_function<std::string>("--generate", generate, "the manual page or a shell's completion")
        ->group("")  // for the build: no help shows it
        ->check(subvol::cli::one_of(subvol::cli::kManuals))
        ->trigger_on_parse();
    program.require_subcommand(1);
    program.footer(kFooter);
    const auto help = std::make_shared<subvol::cli::Help>();
    program.formatter(help);
    const auto verbs = subvol::cli::make_verbs(program);
    for (const auto& verb : verbs) help->set_essentials(verb->name(), verb->essentials());

    subvol::cli::check_verb(program, arguments);
    std::ranges::reverse(arguments);  // as the parser wants them
    try {
        program.parse(std::move(arguments));
    } catch (const CLI::Success&) {
        throw;
    } catch (const CLI::ParseError& error) {
        throw subvol::cli::explained(program, error);
    } catch (const Error& error) {
        throw subvol::cli::explained(program, error);
    }
    for (const auto& verb : verbs) {
        if (!verb->chosen()) continue;
        const auto rank = subvol::cli::rank_in_environment();
        if (rank && !verb->works_in_ranks()) {
            throw Error(ErrorCode::InvalidInput, "does not support MPI", verb->name(),
                        "leave out mpirun; points, vdb, render and info work in ranks");
        }
        const auto threads = static_cast<std::size_t>(verb->common().threads);
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        threads > 0 ? threads : default_threads(rank));
        if (verb->common().json && speaks()) {
            subvol::cli::say_when_interrupted(
                [](int code) { return subvol::cli::error_json(Error(ErrorCode::Cancelled, "cancelled"), code) + "\n"; });
        }
        std::optional<subvol::cli::Ranks> ranks;
        if (rank) verb->set_ranks(&ranks.emplace());
        subvol::cli::catch_interrupts(!speaks());
        subvol::cli::Report report(speaks() ? verb->common() : silent(verb->common()));
        verb->set_progress(report.progress());
        if (verb->name() == kCompress && given == "points") {
            report.warn(
                "compressed meshes are written by `subvol compress`, with the same options; `points` does it until the end of "
                "2027");
        }
        const int code = ranks ? run_in_ranks(*verb, report, *ranks) : run_naming_input(*verb, report);
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

}  // namespace

int main(int argc, char** argv) {
    subvol::cli::catch_failures();  // libraries may throw where nothing can catch, as OpenVDB does when it frees a grid
    keep_standard_streams();
    std::setlocale(LC_ALL, "C");          // a library that is loaded before us may have chosen another: numbers have a point
    setenv("EGL_LOG_LEVEL", "fatal", 0);  // we report a lack of OpenGL ourselves, in one sentence
    std::signal(SIGXFSZ, SIG_IGN);        // when a file gets too long, the write fails
    // What unwinds std::call_once is loaded by glibc when it is first needed, too late where memory has run out.
    void* frame = nullptr;
    (void)backtrace(&frame, 1);
    subvol::cli::read_foreign_inputs();
    CLI::App program(kDescription, "subvol");
    const std::vector<std::string> arguments = asked(argc, argv);
    const bool json = std::ranges::find(arguments, "--json") != arguments.end();
    try {
        return run(program, arguments, argc > 1 ? argv[1] : "");
    } catch (const CLI::Success& wanted) {  // --help, --version
        const int code = speaks() ? program.exit(wanted) : 0;
        if (std::cout.flush()) return code;
        return complain(Error(ErrorCode::Io, "could not be written", "standard output"), kBadInput, json);
    } catch (const Said& error) {
        return error.code;
    } catch (...) {
        const auto [error, code, several] = error_at_hand();
        return complain(error, code, json, several);
    }
}
