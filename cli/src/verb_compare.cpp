#include <sstream>

#include "input.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

constexpr int kComparisonFailed = 1;

/// "psnr=40": the metric may not be worse than the value.
struct Demand {
    std::string metric;
    double value;

    explicit Demand(const std::string& argument) {
        const std::size_t equals = argument.find('=');
        metric = argument.substr(0, equals);
        check_choice("--fail-under", metric, {"mse", "rmse", "mae", "max", "psnr"}, {"ssim", "flip"});
        std::istringstream in(equals == std::string::npos ? "" : argument.substr(equals + 1));
        if (!(in >> value) || !in.eof()) {
            throw Error(ErrorCode::InvalidInput, "'" + argument + "' has no value", "--fail-under", "write it as psnr=40");
        }
    }

    [[nodiscard]] bool met_by(double measured) const { return metric == "psnr" ? measured >= value : measured <= value; }
};

double metric_named(const ImageMetrics& metrics, const std::string& name) {
    if (name == "mse") return metrics.mse;
    if (name == "rmse") return metrics.rmse;
    if (name == "mae") return metrics.mae;
    if (name == "max") return metrics.max;
    return metrics.psnr;
}

class CompareVerb : public Verb {
public:
    explicit CompareVerb(CLI::App& program)
        : Verb(program, "compare", "Measure how much two pictures differ, in linear light.",
               "  subvol compare splat.exr reference.exr --heatmap difference.png\n"
               "  subvol compare a.png b.png --fail-under psnr=40 --fail-under max=.1") {
        app().add_option("A", a_, "a picture")->required();
        app().add_option("B", b_, "another of the same size")->required();
        app().add_option("--heatmap", heatmap_, "draw the difference into this picture (.png, .exr)")->type_name("FILE");
        app()
            .add_option("--fail-under", demands_,
                        "exit with 1 if the metric (psnr, mse, rmse, mae, max) is worse than the value; repeatable")
            ->type_name("METRIC=VALUE")
            ->allow_extra_args(false);
    }

    int run(Report& report) override {
        const std::vector<Demand> demands(demands_.begin(), demands_.end());
        if (!heatmap_.empty()) check_output(heatmap_, {".png", ".exr"});
        const Image a = report.timed("read", [&] { return read_image(a_); });
        const Image b = report.timed("read", [&] { return read_image(b_); });
        const ImageMetrics metrics = report.timed("compare", [&] { return compare_images(a, b); });
        bool passed = true;
        for (const char* name : {"mse", "rmse", "mae", "max", "psnr"}) report[name] = metric_named(metrics, name);
        for (const Demand& demand : demands) passed = passed && demand.met_by(metric_named(metrics, demand.metric));
        report["passed"] = passed;
        if (!heatmap_.empty()) {
            report.timed("write", [&] { write_image(heatmap_, difference_heatmap(a, b)); });
            report["heatmap"] = heatmap_;
        }
        return passed ? 0 : kComparisonFailed;
    }

private:
    std::string a_;
    std::string b_;
    std::string heatmap_;
    std::vector<std::string> demands_;
};

}  // namespace

std::unique_ptr<Verb> make_compare_verb(CLI::App& program) {
    return std::make_unique<CompareVerb>(program);
}

}  // namespace subvol::cli
