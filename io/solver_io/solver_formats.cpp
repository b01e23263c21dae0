// SPDX-License-Identifier: Apache-2.0
#include "solver_formats.h"

#include "solver_readers.h"
#include "subvol/detail/text_scanner.h"

namespace subvol::detail {
namespace {

constexpr std::array<MeshFormat, 6> kSolverFormats{{
    {.extensions = {".e", ".exo", ".ex2", ".g"},
     .name = "Exodus II",
     .read = read_exodus_file,
     .write = write_exodus,
     .times = exodus_times,
     .piece = read_exodus_piece,
     .parts = exodus_parts,
     .part = read_exodus_part,
     .blocks = true},
    {.extensions = {".frd"}, .name = "CalculiX", .read = read_file<read_frd>, .times = frd_times, .deck = true},
    {.extensions = {".cgns"}, .name = "CGNS", .read = read_cgns, .times = cgns_times, .blocks = true},
    {.extensions = {".case"}, .name = "EnSight Gold", .read = read_ensight, .times = ensight_times, .blocks = true},
    {.extensions = {".foam", ".openfoam"},
     .name = "OpenFOAM",
     .read = read_foam,
     .write = write_foam,
     .times = foam_times,
     .parts = foam_parts,
     .part = read_foam_part,
     .folder = true,
     .finite_volumes = true},
    {.extensions = {".inp"}, .name = "Abaqus", .read = read_inp, .write = write_inp, .blocks = true},
}};

Contents contents_of_solvers(std::string_view begin) {
    const auto has = [&](std::string_view text) { return begin.find(text) != std::string_view::npos; };
    if (begin.starts_with("CDF\1") || begin.starts_with("CDF\2") || begin.starts_with("CDF\5")) return {".exo"};
    if (begin.starts_with("\x89HDF")) {
        if (has("CGNSLibraryVersion") || has("CGNSBase_t")) return {".cgns"};
        return {".exo", false, true};  // the names of its groups may come later
    }
    if (begin.substr(0, 64).find("ADF Database") != std::string_view::npos) return {".cgns"};
    begin = begin.substr(0, kFirstText);
    const std::string upper = upper_case(trimmed(begin));
    if (begin.starts_with("    1C")) return {".frd"};
    if (upper.find("FORMAT") != std::string::npos && upper.find("ENSIGHT") != std::string::npos &&
        upper.find("GEOMETRY") != std::string::npos)
        return {".case", upper.starts_with("FORMAT")};
    for (const std::string_view keyword : {"*HEADING", "*NODE", "*PART", "*INCLUDE", "**"}) {
        if (upper.starts_with(keyword) && upper.find("*NODE") != std::string::npos) return {".inp", keyword != "**"};
    }
    return {};
}

}  // namespace

FormatFamily solver_formats() {
    return {kSolverFormats, contents_of_solvers};
}

}  // namespace subvol::detail
