// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common_options.h"
#include "ranks.h"
#include "report.h"
#include "share.h"
#include "subvol/part_of_limit.h"
#include "transport.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// One verb of the command: the constructor of a derived class declares its arguments, `run` does its work.
class Verb {
public:
    /// examples: shown below the help, one command a line
    Verb(CLI::App& program, const std::string& name, const std::string& description, const std::string& examples,
         Reads reads = Reads::Meshes);
    virtual ~Verb() = default;
    Verb(const Verb&) = delete;
    Verb& operator=(const Verb&) = delete;

    [[nodiscard]] bool chosen() const;
    [[nodiscard]] const CommonOptions& common() const { return common_; }
    /// Quantities report to it, and may be cancelled.
    void set_progress(Progress* progress) { common_.listener = progress; }
    [[nodiscard]] const std::string& name() const { return name_; }

    /// The options that --help shows; --help-all shows all. None: all of the verb's own.
    [[nodiscard]] const std::vector<std::string>& essentials() const { return essentials_; }

    /// Whether the verb can be done by several processes of MPI together.
    [[nodiscard]] virtual bool works_in_ranks() const { return false; }
    /// Before `run`: the other processes that do the verb. They must live as long as the verb runs.
    void set_ranks(Ranks* ranks) { ranks_ = ranks; }

    /// returns: the exit code
    virtual int run(Report& report) = 0;

protected:
    [[nodiscard]] CLI::App& app() { return app_; }
    /// Adds --patch, by which nothing but patches of the mesh is read. help: what becomes of them
    void add_patches(const std::string& help);
    /// Adds --part-opacity, which takes translucent parts out of the mesh.
    void add_part_opacities(const std::string& help);
    /// For a verb that works on the limit of what --only leaves: `part_of_limit`.
    void show_limit_of_parts() { common_.part_levels = PartOptions{}.max_levels; }
    /// Adds --crease-angle to a verb that reads meshes and has no scheme, whose options contain it.
    void add_crease_angle() { cli::add_crease_angle(app_, common_); }

    /// Null: this process is alone.
    [[nodiscard]] Ranks* ranks() const { return ranks_; }

    /// Whether this process writes the result and prints the report.
    [[nodiscard]] bool speaks() const { return ranks_ == nullptr || ranks_->first(); }

    /// Whether this process does one share of the work only.
    [[nodiscard]] bool shares(const ShareArgument& part) const { return ranks_ != nullptr || part.given(); }
    /// The share that --part or the rank says; else the whole.
    ///
    /// throws: Error(InvalidInput) if both do
    [[nodiscard]] Share share_of(const ShareArgument& part) const;

    /// How the part that this process makes comes to the others: by --part into a file, or to rank 0.
    ///
    /// how: what `join` must know to write the whole
    [[nodiscard]] Transport transport(const ShareArgument& part, const std::string& input, const ShareRange& range, Json how,
                                      Report& report) const;

    void set_essentials(std::vector<std::string> options) { essentials_ = std::move(options); }

    /// Puts options under a heading of --help-all and of the manual page.
    void group(const std::string& heading, std::initializer_list<const char*> options);

private:
    CLI::App& app_;
    CommonOptions common_;
    Ranks* ranks_ = nullptr;
    std::string name_;
    std::vector<std::string> essentials_;
};

[[nodiscard]] std::unique_ptr<Verb> make_model_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_info_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_subdivide_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_fit_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_points_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_compress_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_vdb_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_usd_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_render_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_view_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_page_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_probe_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_check_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_mesh_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_approximate_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_slice_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_surface_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_split_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_join_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_compare_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_study_verb(CLI::App& program);
[[nodiscard]] std::unique_ptr<Verb> make_demo_verb(CLI::App& program);

/// All verbs, in the order of the help.
[[nodiscard]] std::vector<std::unique_ptr<Verb>> make_verbs(CLI::App& program);

}  // namespace subvol::cli
