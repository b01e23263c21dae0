// SPDX-License-Identifier: Apache-2.0
// The manual page, from the same table of arguments by which the program parses its command line. Each verb gives its name,
// description, options in groups and footer; each option its names, the type of its value, the allowed range, and what it
// needs or excludes. Chapters on the volume, the fields and the files come before the verbs, others after them. All words are
// written as roff: its own characters are escaped, a hyphen becomes a minus, and a character of several bytes becomes its code
// point. The date is that of SOURCE_DATE_EPOCH if it is set, so that a repeated build has the same page.
#include "manual.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <ostream>
#include <sstream>

#include "render_arguments.h"
#include "subvol/method.h"
#include "subvol/option.h"
#include "subvol/version.h"

namespace subvol::cli {
namespace {

/// A chapter of the manual page beyond what the argument table says. Paragraphs are separated by empty lines; a paragraph whose
/// lines are indented is to be typed; one that begins with "TERM = " explains the term.
struct Chapter {
    const char* title;
    const char* text;
};

/// Before the verbs, and after them.
extern const std::array<Chapter, 3> kFirstChapters;

extern const std::array<Chapter, 6> kLastChapters;

const std::array<Chapter, 3> kFirstChapters{
    {{"THE VOLUME",
      R"(A mesh of hexahedra with values at its points is the control mesh. A scheme refines it again and again; what the
levels converge to is the limit, in geometry and in values. The volume is the limit. Outside of it there is nothing, which is not the
same as a value of 0. --levels L takes the mesh of level L with trilinear cells instead; --levels 0 is the mesh as it came.

mcq = the default: passes through the control points; smooth except at irregular edges. It can fold badly shaped cells; subvol
subdivide counts them.

cc = Catmull-Clark solids: smooth, does not pass through the control points.

bsxw = the scheme of Bajaj, Schaefer, Warren and Xu: likewise.

linear = trilinear cells: what most programs show.)"},
     {"FIELDS",
      R"(Values may be at points or at cells. Values at cells become values at points: the mean over the cells at a point,
weighted by volume. A vector counts by its length; NAME.k is its component k. Without --field a physical scalar is taken rather than
node numbers, flags or constants, and the choice is said. --density takes an expression in x, y and z instead, such as
sin(3*x)+z. A mesh without fields has the density 1.)"},
     {"FILES",
      R"(Which format a file has follows from its extension. Meshes: MEDIT .mesh and .meshb; VTK .vtk, .vtu, .vts, .vtr and
.vti; Gmsh .msh; Plot3D .xyz and .p3d; Exodus II .e, .exo, .ex2 and .g; VTKHDF .vtkhdf and .hdf; XDMF .xdmf and .xmf; CGNS
.cgns; CalculiX .frd; Abaqus .inp; EnSight .case; OpenFOAM .foam, or the folder of a case; lists of files .pvd, .series, .vtm, .vth
and .pvtu; wavelets .svw. Points: .ply, .vtp, .svk and .vdb. Grids: .vdb. Pictures: .png and .exr, and what OpenImageIO reads.
model:NAME and model:NAME:RESOLUTION generate a mesh.

An output file is complete or absent: it is written under a temporary name beside its place, and takes its name when it is done. What
was there before stays if the command fails, and leaves its permissions to what replaces it. A row of # in a name stands for the number of a frame.)"}}};

const std::array<Chapter, 6> kLastChapters{
    {{"OUTPUT FOR PROGRAMS",
      R"(With --json a verb prints one JSON object on standard output, and nothing else there. Numbers are in SI or
world units, seconds and bytes. warnings is a list of sentences; seconds has the time of each stage; peak_bytes is the most memory that
was held. If there is an error, the object has the one key error, with

code = the exit code,

what = the sentence without its place,

where = the option, file, line or cell that is wrong; may be empty,

allowed = what would be right; may be empty.

Messages for people are on standard error.)"},
     {"A FIRST SESSION", R"(Look at a mesh before anything else: info ends with a verdict.

  subvol info part.vtk

Draw it; --views 4 shows it from four sides. Then look into it: opacities at percentages of the field's range.

  subvol render part.vtk -o part.png --views 4
  subvol render part.vtk -o inside.png --tf coolwarm --opacity 0%:0,50%:.1,100%:.8

How good is a picture? Draw the reference by rays, and compare. Above 40 dB people see no difference.

  subvol render part.vtk -o splat.exr
  subvol render part.vtk -o rays.exr --method tets --levels 2
  subvol compare splat.exr rays.exr --heatmap difference.png

Take it to a renderer of films.

  subvol vdb part.vtk -o part.vdb --resolution 400)"},
     {"HOW LONG THINGS TAKE",
      R"(Splats of a few thousand cells take under a second. Rays through tetrahedra take seconds, through dense
grids minutes: draw a smaller --size first, or fewer --levels. The time of a grid grows with the number of its voxels, eightfold for
twice the --resolution. Every level makes eight cells of one. The progress bar on a terminal estimates the time left; Ctrl-C ends the
command within half a second and leaves no unfinished file.)"},
     {"SHARES OF THE WORK",
      R"(Of points, vdb, render and info, --part K/N does one of N shares, K from 1 to N, and writes it as a file of its own: for
the array jobs of batch systems. join puts the files together; the result has the bits of one process. mpirun -n N subvol VERB does all
shares at once, in builds with MPI; rank 0 writes the one output, and speaks for all.

  subvol vdb part.vtu -o slab1.vdb --part 1/2
  subvol vdb part.vtu -o slab2.vdb --part 2/2
  subvol join slab1.vdb slab2.vdb -o part.vdb)"},
     {"ENVIRONMENT", R"(SOURCE_DATE_EPOCH = the date of this page, in seconds, where it is made.

COLUMNS, LINES = not used: help is 80 columns wide.

TMPDIR = where a file that goes to a pipe or a device is made first.)"},
     {"SEE ALSO", R"(ffmpeg(1), for videos; paraview(1); blender(1).

The documents of the sources: docs/pictures.md (looks and colours), docs/studies.md (error studies), docs/formats.md (files),
docs/science.md (what is computed), docs/cookbook.md (other programs), docs/shares.md (shares of the work).)"}}};

std::vector<std::string> names_of(const std::set<CLI::Option*>& options) {
    std::vector<std::string> names;
    for (const CLI::Option* option : options) names.push_back(option->get_name());
    std::ranges::sort(names);
    return names;
}

std::string in_one_line(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    return text;
}

Argument argument_of(const CLI::Option& option) {
    Argument argument;
    argument.description = in_one_line(option.get_description());
    argument.positional = option.get_positional();
    argument.required = option.get_required();
    argument.repeatable = option.get_expected_max() > 1;
    argument.value_optional = option.get_expected_min() == 0;
    argument.excludes = names_of(option.get_excludes());
    argument.needs = names_of(option.get_needs());
    if (argument.positional) {
        argument.names = {option.get_name(true)};
    } else {
        for (const std::string& name : option.get_snames()) argument.names.push_back("-" + name);
        for (const std::string& name : option.get_lnames()) argument.names.push_back("--" + name);
    }
    if (option.get_items_expected_max() == 0) return argument;
    std::string type = option.get_type_name();  // "N:INT in [1 - 64]", "WHEN:{auto,on,off}", "POSITIVE"
    if (const std::size_t colon = type.find(':'); colon != std::string::npos && !type.starts_with("V:A")) {
        argument.range = type.substr(colon + 1);
        type.resize(colon);
    }
    argument.value = argument.positional ? argument.names.front() : type;
    if (argument.value.starts_with('[')) argument.value = argument.value.substr(1, argument.value.size() - 2);
    if (argument.range.starts_with('{')) {
        std::istringstream list(argument.range.substr(1, argument.range.size() - 2));
        for (std::string choice; std::getline(list, choice, ',');) argument.choices.push_back(choice);
    }
    return argument;
}

/// A character of more than one byte as roff's "\[u2026]"; moves i to its last byte.
std::string roff_unicode(const std::string& text, std::size_t& i) {
    const auto first = static_cast<unsigned char>(text[i]);
    const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
    unsigned code = first & (0x3fU >> more);
    for (int byte = 0; byte < more && i + 1 < text.size(); ++byte)
        code = code << 6 | (static_cast<unsigned char>(text[++i]) & 0x3fU);
    std::array<char, 16> escape{};
    std::snprintf(escape.data(), escape.size(), "\\[u%04X]", code);
    return escape.data();
}

/// Text with roff's own characters escaped; a hyphen that is to be typed is a minus.
std::string roff(const std::string& text) {
    static const std::map<char, std::string> kEscapes{{'\\', "\\e"},  {'-', "\\-"},   {'\'', "\\(aq"},
                                                      {'`', "\\(ga"}, {'^', "\\(ha"}, {'~', "\\(ti"}};
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const auto escape = kEscapes.find(c);
        if (c == '.' && (out.empty() || out.back() == '\n')) out += "\\&";
        if ((c & 0x80) != 0) {
            out += roff_unicode(text, i);
        } else {
            out += escape == kEscapes.end() ? std::string(1, c) : escape->second;
        }
    }
    return out;
}

std::string today() {
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    const std::time_t now = epoch ? std::strtoll(epoch, nullptr, 10) : std::time(nullptr);
    char text[16];
    std::strftime(text, sizeof text, "%Y-%m-%d", std::gmtime(&now));
    return text;
}

std::string sentence(const char* words, const std::vector<std::string>& names) {
    std::string out;
    for (const std::string& name : names) out += (out.empty() ? std::string(words) : ",") + " " + name;
    return out.empty() ? out : "; " + out;
}

void write_argument(std::ostream& out, const Argument& argument) {
    out << ".TP\n";
    if (argument.positional) {
        out << "\\fI" << roff(argument.value) << "\\fR";
    } else {
        for (std::size_t i = 0; i < argument.names.size(); ++i)
            out << (i ? ", " : "") << "\\fB" << roff(argument.names[i]) << "\\fR";
        if (!argument.value.empty()) {
            const bool optional = argument.value_optional;
            out << ' ' << (optional ? "[" : "") << "\\fI" << roff(argument.value) << "\\fR" << (optional ? "]" : "");
        }
    }
    out << '\n'
        << roff(argument.description) << roff(argument.range.empty() || !argument.choices.empty() ? "" : "; " + argument.range)
        << roff(sentence("not with", argument.excludes)) << roff(sentence("with", argument.needs))
        << (argument.required ? "; required" : "") << '\n';
}

/// "Examples:\n  lines" as a heading and lines to type, "Exit codes: words" as a heading and words.
void write_paragraph(std::ostream& out, const std::string& paragraph, const char* heading) {
    const std::size_t colon = paragraph.find(':');
    std::string title = paragraph.substr(0, colon), rest = paragraph.substr(colon + 1);
    const bool section = std::string(heading) == ".SH";
    if (section) std::ranges::transform(title, title.begin(), [](unsigned char c) { return std::toupper(c); });
    out << heading << (section ? " " : "\n") << roff(title) << (section ? "\n" : ":\n");
    if (rest.starts_with('\n')) {
        out << (section ? "" : ".PP\n") << ".EX\n" << roff(rest.substr(1)) << "\n.EE\n";
    } else {
        out << roff(rest.substr(rest.find_first_not_of(' '))) << '\n';
    }
}

void write_footer(std::ostream& out, const CLI::App& app, const char* heading) {
    std::string rest = app.get_footer();
    while (!rest.empty()) {
        const std::size_t end = rest.find("\n\n");
        write_paragraph(out, rest.substr(0, end), heading);
        rest = end == std::string::npos ? "" : rest.substr(end + 2);
    }
}

void write_chapter(std::ostream& out, const Chapter& chapter) {
    out << ".SH " << roff(chapter.title) << '\n';
    std::string rest = chapter.text;
    for (bool first = true; !rest.empty(); first = false) {
        const std::size_t end = rest.find("\n\n");
        const std::string paragraph = rest.substr(0, end);
        const std::size_t equals = paragraph.find(" = ");
        if (paragraph.starts_with("  ")) {
            out << ".PP\n.EX\n" << roff(paragraph) << "\n.EE\n";
        } else if (equals < paragraph.find(' ') + 8) {
            out << ".TP\n\\fB" << roff(paragraph.substr(0, equals)) << "\\fR\n" << roff(paragraph.substr(equals + 3)) << '\n';
        } else {
            out << (first ? "" : ".PP\n") << roff(paragraph) << '\n';
        }
        rest = end == std::string::npos ? "" : rest.substr(end + 2);
    }
}

const char* const kCommon = "Common options";
const char* const kReading = "Reading meshes";

void write_verb(std::ostream& out, const CLI::App& verb) {
    out << ".SS subvol " << roff(verb.get_name());
    std::vector<Argument> arguments = arguments_of(verb, "Positionals");
    for (const Argument& argument : arguments)
        out << (argument.required ? " " : " [") << roff(argument.value) << (argument.required ? "" : "]");
    out << " [options]\n" << roff(verb.get_description()) << '\n';
    for (const Argument& argument : arguments) write_argument(out, argument);
    for (const std::string& group : groups_of(verb)) {
        if (group == kCommon || group == kReading || arguments_of(verb, group).empty()) continue;
        if (group != "Options") out << ".PP\n\\fI" << roff(group) << "\\fR\n";
        for (const Argument& option : arguments_of(verb, group)) write_argument(out, option);
    }
    write_footer(out, verb, ".PP");
}

}  // namespace

std::vector<std::string> groups_of(const CLI::App& verb) {
    std::vector<std::string> groups{"Options"};
    for (const std::string& group : verb.get_groups()) {
        if (!group.empty() && group != "Options" && group != kReading && group != kCommon) groups.push_back(group);
    }
    groups.emplace_back(kReading);
    groups.emplace_back(kCommon);
    return groups;
}

std::vector<const CLI::App*> verbs_of(const CLI::App& program) {
    return program.get_subcommands([](const CLI::App* verb) { return !verb->get_group().empty(); });
}

std::vector<Argument> arguments_of(const CLI::App& verb, const std::string& group) {
    std::vector<Argument> arguments;
    for (const CLI::Option* option : verb.get_options()) {
        const std::string its_group = option->get_positional() ? "Positionals" : option->get_group();
        if (!option->get_group().empty() && its_group == group) arguments.push_back(argument_of(*option));
    }
    return arguments;
}

std::vector<Argument> arguments_of(const CLI::App& verb) {
    std::vector<Argument> arguments = arguments_of(verb, "Positionals");
    for (const std::string& group : groups_of(verb)) {
        for (const Argument& argument : arguments_of(verb, group)) arguments.push_back(argument);
    }
    return arguments;
}

void write_man_page(std::ostream& out, const CLI::App& program) {
    const auto verbs = verbs_of(program);
    std::string summary = program.get_description();
    out << ".\\\" Made by the build: subvol --generate man\n"
        << ".TH SUBVOL 1 " << today() << " \"subvol " << SUBVOL_VERSION << "\" \"User Commands\"\n"
        << ".SH NAME\nsubvol \\- " << roff(summary.substr(0, summary.find(':'))) << '\n'
        << ".SH SYNOPSIS\n.B subvol\n.I verb\n.RI [ arguments ]\n.br\n.B subvol\n.BR \\-\\-help | \\-\\-version\n"
        << ".SH DESCRIPTION\n"
        << roff(summary) << '\n';
    for (const Argument& argument : arguments_of(program)) write_argument(out, argument);
    for (const Chapter& chapter : kFirstChapters) write_chapter(out, chapter);
    out << ".SH VERBS\n";
    for (const CLI::App* verb : verbs) write_verb(out, *verb);
    out << ".SH OPTIONS FOR READING MESHES\nThese can be given to every verb that reads meshes.\n";
    for (const CLI::App* verb : verbs) {
        if (verb->get_name() != "info") continue;
        for (const Argument& argument : arguments_of(*verb, kReading)) write_argument(out, argument);
    }
    out << ".SH COMMON OPTIONS\nThese can be given to every verb.\n";
    for (const Argument& argument : arguments_of(*verbs.front(), kCommon)) write_argument(out, argument);
    write_footer(out, program, ".SH");
    for (const Chapter& chapter : kLastChapters) write_chapter(out, chapter);
}

void write_manual(std::ostream& out, const std::string& kind, const CLI::App& program) {
    if (kind == "man") return write_man_page(out, program);
    if (kind == "bash") return write_bash_completion(out, program);
    if (kind == "methods") {
        out << option_table(RenderArguments().described());
        return;
    }
    write_zsh_completion(out, program);
}

}  // namespace subvol::cli
