// SPDX-License-Identifier: Apache-2.0
#include "verb.h"

#include <CLI/CLI.hpp>

#include "subvol/error.h"

namespace subvol::cli {

Verb::Verb(CLI::App& program, const std::string& name, const std::string& description, const std::string& examples, Reads reads)
    : app_(*program.add_subcommand(name, description)), name_(name) {
    app_.footer("Examples:\n" + examples);
    add_common_options(app_, common_, reads);
    common_.draws = name == "render" || name == "view" || name == "page";
}

void Verb::add_patches(const std::string& help) {
    add_option(app_, Option("patch", common_.patches).help("NAME", help));
}

void Verb::add_part_opacities(const std::string& help) {
    add_option(app_, Option("part-opacity", common_.part_opacities).help("PART=A", help));
}

void Verb::group(const std::string& heading, std::initializer_list<const char*> options) {
    for (const char* option : options) app_.get_option(option)->group(heading);
}

Share Verb::share_of(const ShareArgument& part) const {
    if (ranks_ == nullptr) return part.share();
    if (part.given()) {
        throw Error(ErrorCode::InvalidInput, "each process of MPI is a share already", "--part",
                    "either mpirun, or --part without it");
    }
    return ranks_->share();
}

Transport Verb::transport(const ShareArgument& part, const std::string& input, const ShareRange& range, Json how,
                          Report& report) const {
    Transport transport{.share = share_of(part), .ranks = ranks_, .progress = report.progress()};
    if (part.given()) transport.note = make_note(app_, input, transport.share, range, std::move(how));
    return transport;
}

bool Verb::chosen() const {
    return app_.parsed();
}

std::vector<std::unique_ptr<Verb>> make_verbs(CLI::App& program) {
    std::vector<std::unique_ptr<Verb>> verbs;
    for (auto make :
         {make_model_verb, make_info_verb,    make_subdivide_verb,   make_fit_verb,   make_points_verb,  make_compress_verb,
          make_vdb_verb,   make_usd_verb,     make_render_verb,      make_view_verb,  make_page_verb,    make_probe_verb,
          make_check_verb, make_mesh_verb,    make_approximate_verb, make_slice_verb, make_surface_verb, make_split_verb,
          make_join_verb,  make_compare_verb, make_study_verb,       make_demo_verb}) {
        verbs.push_back(make(program));
    }
    return verbs;
}

}  // namespace subvol::cli
