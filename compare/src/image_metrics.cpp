#include "subvol/image_metrics.h"

#include <cmath>
#include <string>

#include "image_difference.h"
#include "subvol/error.h"

namespace subvol {

namespace {

struct Sums {
    double squares = 0, absolutes = 0, largest = 0;

    void add(double difference) {
        squares += difference * difference;
        absolutes += std::abs(difference);
        largest = std::fmax(largest, std::abs(difference));
    }
    void add(const Sums& other) {
        squares += other.squares;
        absolutes += other.absolutes;
        largest = std::fmax(largest, other.largest);
    }
};

double difference(const Image& a, const Image& b, int x, int y, std::size_t channel) {
    return static_cast<double>(a.pixel(x, y)[channel]) - static_cast<double>(b.pixel(x, y)[channel]);
}

std::string size_text(const Image& image) {
    return std::to_string(image.width) + " x " + std::to_string(image.height);
}

}  // namespace

void check_same_size(const Image& a, const Image& b) {
    if (a.width == b.width && a.height == b.height) return;
    throw Error(ErrorCode::InvalidInput, "images of " + size_text(a) + " and " + size_text(b) + " pixels cannot be compared");
}

double pixel_difference(const Image& a, const Image& b, int x, int y) {
    double largest = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double d = std::abs(difference(a, b, x, y, c));
        if (!(d <= largest)) largest = d;
        if (std::isnan(d)) break;
    }
    return largest;
}

ImageMetrics compare_images(const Image& a, const Image& b) {
    check_same_size(a, b);
    // Row by row, then the rows: always in the same order, and sums of like size.
    Sums total;
    for (int y = 0; y < a.height; ++y) {
        Sums row;
        for (int x = 0; x < a.width; ++x) {
            for (std::size_t c = 0; c < 3; ++c) row.add(difference(a, b, x, y, c));
        }
        total.add(row);
    }
    const double count = 3.0 * a.width * a.height;
    if (count == 0) throw Error(ErrorCode::InvalidInput, "images without pixels cannot be compared");
    const double mse = total.squares / count;
    return {.mse = mse,
            .rmse = std::sqrt(mse),
            .mae = total.absolutes / count,
            .max = std::isnan(mse) ? mse : total.largest,
            .psnr = -10 * std::log10(mse)};
}

}  // namespace subvol
