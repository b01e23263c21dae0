// SPDX-License-Identifier: Apache-2.0
#include "subvol/oiio_compare.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "random_image.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"

namespace subvol {
namespace oiio_compare_test {

namespace fs = std::filesystem;

std::string output_of(const std::string& command) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen((command + " 2>&1").c_str(), "r"), &pclose);
    std::string all;
    std::array<char, 256> part;
    while (pipe && std::fgets(part.data(), part.size(), pipe.get()) != nullptr) all += part.data();
    return all;
}

/// The number after the given words; NaN if the words are missing.
double number_after(const std::string& text, const std::string& words) {
    const std::size_t at = text.find(words);
    return at == std::string::npos ? NAN : std::stod(text.substr(at + words.size()));
}

class AsIdiff : public testing::Test {
protected:
    void SetUp() override {
        if (std::system("idiff --help > /dev/null 2>&1") != 0) GTEST_SKIP() << "the program idiff is not installed";
        folder_ = fs::temp_directory_path() / ("subvol_idiff_" + std::to_string(::getpid()));
        fs::create_directory(folder_);
        // Noise over a third of the picture, a slight tint over the rest.
        const Image noise = random_image(64, 48, 1);
        b_ = a_;
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 64; ++x) b_.pixel(x, y)[0] = x < 20 ? noise.pixel(x, y)[0] : .5001f;
        }
        write_image(folder_ / "a.exr", a_);
        write_image(folder_ / "b.exr", b_);
    }
    void TearDown() override {
        if (!folder_.empty()) fs::remove_all(folder_);
    }
    [[nodiscard]] std::string idiff(const std::string& options) const {
        return output_of("idiff " + options + " '" + (folder_ / "a.exr").string() + "' '" + (folder_ / "b.exr").string() + "'");
    }

    Image a_ = plain_image(64, 48, .5f, .4f, .3f), b_;
    fs::path folder_;
};

TEST_F(AsIdiff, Numbers) {
    const std::string said = idiff("-fail .01 -warn .00001");
    const OiioMetrics metrics = compare_oiio(a_, b_, {.fail = .01f, .warn = .00001f});
    // The program prints six digits, and dB to about hundredths.
    const double mean = number_after(said, "Mean error = "), rms = number_after(said, "RMS error = ");
    EXPECT_NEAR(metrics.mean_error, mean, 1e-5 * mean) << said;
    EXPECT_NEAR(metrics.rms_error, rms, 1e-5 * rms) << said;
    EXPECT_NEAR(metrics.psnr, number_after(said, "Peak SNR = "), .01) << said;
    EXPECT_NEAR(metrics.max_error, number_after(said, "Max error  = "), 1e-5) << said;
    EXPECT_EQ(metrics.warnings, 64u * 48u);
    EXPECT_NE(said.find(std::to_string(metrics.failures) + " pixels"), std::string::npos) << said << metrics.failures;
    EXPECT_NE(said.find(std::to_string(metrics.warnings) + " pixels"), std::string::npos) << said;
}

TEST_F(AsIdiff, Perceptually) {
    const std::size_t failures = compare_yee(a_, b_);
    EXPECT_GT(failures, 100u);
    const std::string said = idiff("-p");
    EXPECT_NE(said.find(std::to_string(failures) + " pixels"), std::string::npos) << said << failures;
}

TEST(CompareOiio, AgreesWithOurMetrics) {
    Image a = random_image(33, 21, 2), b = random_image(33, 21, 3);
    const OiioMetrics oiio = compare_oiio(a, b);
    const ImageMetrics ours = compare_images(a, b);
    // OpenImageIO counts alpha as a fourth channel, which is equal here; it adds up partly in floats and partly in doubles.
    EXPECT_NEAR(oiio.mean_error, .75 * ours.mae, 1e-6);
    EXPECT_NEAR(oiio.rms_error, std::sqrt(.75) * ours.rmse, 1e-6);
    EXPECT_NEAR(oiio.max_error, ours.max, 1e-6);
    EXPECT_EQ(oiio.failures, 33u * 21u);
}

TEST(CompareOiio, EqualAndWrongPictures) {
    const Image a = random_image(16, 16, 4);
    EXPECT_EQ(compare_oiio(a, a).failures, 0u);
    EXPECT_EQ(compare_yee(a, a), 0u);
    EXPECT_THROW((void)compare_oiio(a, Image(16, 15)), Error);
    EXPECT_THROW((void)compare_yee(Image(), Image()), Error);
    EXPECT_NO_THROW((void)compare_yee(plain_image(1, 1, 0, 0, 0), plain_image(1, 1, 1, 1, 1)));
}

}  // namespace oiio_compare_test
}  // namespace subvol
