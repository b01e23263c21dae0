// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>

#include "fit_tables.h"
#include "options.h"
#include "subvol/detail/near_name.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

constexpr int kPaperLevel = 5;

/// Kernels with a name but no parameters to fit; only their errors are reported.
const std::vector<std::string> kFixed{"compact", "paper_bc", "cubic"};

std::vector<std::string> kernel_names() {
    std::vector<std::string> names = shape_names();
    names.insert(names.end(), kFixed.begin(), kFixed.end());
    return names;
}

class FitVerb : public Verb {
public:
    explicit FitVerb(CLI::App& program)
        : Verb(program, "fit", "Fit kernels to the basis function of a scheme.",
               "  subvol fit --table1\n"
               "  subvol fit --kernels\n"
               "  subvol fit --kernel bc --scheme cc --json\n"
               "  subvol fit --kernel '{\"type\": \"gaussian\", \"sigma\": 0.5}'",
               Reads::NoMesh) {
        add_option(app(),
                   Option("table1", table1_).help("table 1 of the EuroVis 2007 paper: its figures, ours, and the difference"));
        add_option(app(), Option("kernels", kernels_).help("fit every kind of kernel: parameters and errors"));
        add_option(app(), Option("kernel", kernel_)
                              .offer(kernel_names())
                              .help("NAME|JSON", text("fit this one: ", join(kernel_names()),
                                                      " (the last three have nothing to fit); or the errors of a kernel given "
                                                      "as JSON")));
        add_option(app(), Option("scheme", scheme_).help("NAME", "mcq, cc, bsxw, linear"));
        add_option(app(), Option("level", level_).between(0, 6).help("L", "samples of the basis function: 2^L per unit"));
        add_options(app(), options_of(options_));
    }

    int run(Report& report) override {
        if (!table1_ && !kernels_ && kernel_.empty()) {
            throw Error(ErrorCode::InvalidInput, "nothing was chosen", "fit", "--table1, --kernels or --kernel NAME");
        }
        if (table1_ && (scheme_ != Scheme::Mcq || level_ != kPaperLevel)) {
            throw Error(ErrorCode::InvalidInput, "the paper's table is for mcq at level 5", "--table1",
                        "leave out --scheme and --level");
        }
        const BasisFunction basis = report.timed("sample", [&] { return sample_basis_function(scheme_, level_); });
        report["scheme"] = name_of(scheme_);
        report["level"] = level_;
        if (table1_) tell(report, "rows", report.timed("fit", [&] { return table1(basis); }));
        if (kernels_) tell(report, "kernels", report.timed("fit", [&] { return kernels_table(basis); }));
        if (!kernel_.empty()) fit_one(basis, report);
        return 0;
    }

private:
    static void tell(Report& report, const char* key, FitTable table) {
        report[key] = std::move(table.rows);
        for (const std::string& line : table.lines) report.say(line);
        report.all_said();
    }

    void fit_one(const BasisFunction& basis, Report& report) {
        const KernelFit fit = report.timed("fit", [&] { return chosen(basis); });
        report["kernel"] = kernel_.front() == '{' ? "given" : kernel_;
        report["parameters"] = parameters_of(fit.kernel);
        report["double"] = to_json(fit.report.errors);
        report["definition"] = Json::parse(subvol::to_json(fit.kernel));
        if (!fit.report.converged) report.warn("the search for the parameters ended before it had converged");
        const FitErrors& errors = fit.report.errors;
        report.say(subvol::to_json(fit.kernel));
        report.say(text("RMSE ", errors.rmse, ", MAE ", errors.mae, ", max ", errors.max));
        report.all_said();
    }

    [[nodiscard]] KernelFit chosen(const BasisFunction& basis) const {
        const auto known = [&](const Kernel& kernel) { return KernelFit{kernel, {.errors = kernel_errors(basis, kernel)}}; };
        if (kernel_.front() == '{') return known(kernel_from_json(kernel_));
        if (std::ranges::find(kFixed, kernel_) != kFixed.end()) return known(named_kernel(kernel_));
        if (const auto shape = shape_named(kernel_)) return fit_shape(basis, *shape, options_);
        throw Error(ErrorCode::InvalidInput, "'" + kernel_ + "' is unknown" + detail::did_you_mean(kernel_, kernel_names()),
                    "--kernel", "supported: " + join(kernel_names()));
    }

    bool table1_ = false;
    bool kernels_ = false;
    std::string kernel_;
    Scheme scheme_ = Scheme::Mcq;
    int level_ = kPaperLevel;
    FitOptions options_;
};

}  // namespace

std::unique_ptr<Verb> make_fit_verb(CLI::App& program) {
    return std::make_unique<FitVerb>(program);
}

}  // namespace subvol::cli
