#include "study_metrics.h"

#include <sstream>

#include "subvol/image_metrics.h"

namespace subvol::cli {

std::map<std::string, double> picture_metrics(const Image& image, const Image& reference, const std::string& names) {
    const ImageMetrics all = compare_images(image, reference);
    std::map<std::string, double> metrics;
    std::istringstream in(names);
    for (std::string name; std::getline(in, name, ',');) {
        if (name == "mse") metrics[name] = all.mse;
        if (name == "rmse") metrics[name] = all.rmse;
        if (name == "mae") metrics[name] = all.mae;
        if (name == "max") metrics[name] = all.max;
        if (name == "psnr") metrics[name] = all.psnr;
    }
    return metrics;
}

}  // namespace subvol::cli
