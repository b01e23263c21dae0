// SPDX-License-Identifier: Apache-2.0
#include "subvol/kernel_file.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "lib/expect_error.h"
#include "lib/rbf_volumes.h"
#include "lib/temp_folder.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/printable.h"
#include "subvol/points_io.h"
#include "svk_file.h"

namespace subvol::test {
namespace kernel_file_test {

using detail::SvkFile;
using detail::SvkLayout;

RbfVolume ball(int cells = 4, int per_edge = 2) {
    return sample_rbf_points(make_model("ball", cells), {.per_edge = per_edge}).volume;
}

/// A second channel, with other error bounds.
RbfVolume with_square(RbfVolume volume) {
    RbfChannel square = volume.channels[0];
    square.name = "square";
    for (float& value : square.values) value *= value;
    volume.channels.push_back(std::move(square));
    return volume;
}

View view_from(const RbfVolume& volume, double distance, double ortho_height = 0) {
    const Vec3 eye = volume.bounds.center() + distance * volume.bounds.diagonal() * glm::normalize(Vec3(1, -2, .5));
    return View({.eye = eye, .target = volume.bounds.center(), .up = {0, 0, 1}, .fovy_deg = 30, .ortho_height = ortho_height},
                64, 64);
}

void expect_same(const RbfVolume& a, const RbfVolume& b) {
    EXPECT_EQ(a.centers, b.centers);
    expect_same_but_centers(a, b);
    EXPECT_EQ(a.bounds.lower, b.bounds.lower);
    EXPECT_EQ(a.bounds.upper, b.bounds.upper);
}

class KernelFiles : public TempFolder {
protected:
    std::filesystem::path written(const RbfVolume& volume, const std::string& name = "a.svk") const {
        write_kernel_file(path(name), volume);
        return path(name);
    }

    /// The message with which a file is refused: all kernels are read, then the whole tree.
    std::string refusal(const std::string& bytes) const {
        const auto file = write("bad.svk", bytes);
        return error_of([&] {
            static_cast<void>(read_points(file));
            static_cast<void>(KernelFile(file).choose_level(View({}, 8, 8), {.pixels = 0}));
        });
    }
};

TEST_F(KernelFiles, GiveBackEveryBitInTheSameOrder) {
    for (const std::size_t kernels : {1U, 7U, 8U, 9U, 17U, 500U, 5000U}) {
        const RbfVolume volume = random_points(kernels, 3);
        const KernelFileContents contents = write_kernel_file(path("a.svk"), volume);
        expect_same(read_points(path("a.svk")), volume);
        EXPECT_EQ(contents.kernels, kernels);
        EXPECT_EQ(contents.bytes, std::filesystem::file_size(path("a.svk")));
    }
    RbfVolume open = ball();
    open.boundary = {};
    open.bounds = box_of(open);
    expect_same(read_points(written(open)), open);
    expect_same(read_points(written(ball_with_hessians())), ball_with_hessians());
}

TEST_F(KernelFiles, TheCutIsThatOfTheHierarchyInMemory) {
    for (const RbfVolume& volume : {with_square(ball(6, 4)), ball(2, 1), ball_with_hessians()}) {
        const KernelHierarchy hierarchy = build_kernel_hierarchy(volume);
        KernelFile file(written(volume));
        std::size_t most_nodes = 0;
        for (const double distance : {.4, 1.0, 3.0, 10.0, 40.0, 1000.0}) {
            for (const double pixels : {0.0, 1.0, 3.0, 12.0}) {
                for (const double height : {0.0, distance}) {
                    const View view = view_from(volume, distance, height);
                    LevelOptions options{.pixels = pixels, .channel = volume.channels.size() - 1};
                    if (pixels == 3) options.error = .2;
                    const KernelCut cut = choose_cut(hierarchy, view, options);
                    const StreamedKernels streamed = file.choose_level(view, options);
                    EXPECT_EQ(streamed.cut.nodes, cut.nodes);
                    EXPECT_EQ(streamed.cut.kernels, cut.kernels);
                    EXPECT_EQ(streamed.cut.error, cut.error);
                    expect_same(streamed.volume, kernels_of_cut(hierarchy, volume, cut));
                    most_nodes = std::max(most_nodes, cut.nodes.size());
                }
            }
        }
        EXPECT_GT(most_nodes, 0U) << "or nothing has been compared";
    }
}

TEST_F(KernelFiles, ChannelsAreChosenInAnyOrder) {
    const RbfVolume volume = with_square(ball());
    KernelFile file(written(volume));
    for (const std::vector<std::size_t>& channels : {std::vector<std::size_t>{1}, {1, 0}, {0}}) {
        RbfVolume some = volume;
        some.channels.clear();
        for (const std::size_t c : channels) some.channels.push_back(volume.channels[c]);
        const View view = view_from(volume, 8);
        const KernelHierarchy hierarchy = build_kernel_hierarchy(some);
        expect_same(file.choose_level(view, {.channel = channels[0]}, channels).volume, choose_level(hierarchy, some, view));
    }
    const View view = view_from(volume, 8);
    expect_error(ErrorCode::InvalidInput, "no channel 2", [&] { (void)file.choose_level(view, {}, {2}); });
    expect_error(ErrorCode::InvalidInput, "no channel 2", [&] { (void)file.choose_level(view, {.channel = 2}); });
    expect_error(ErrorCode::InvalidInput, "0 or more", [&] { (void)file.choose_level(view, {.pixels = -1}); });
}

TEST_F(KernelFiles, ADistantViewReadsLittleAndTheSameViewNothing) {
    const RbfVolume volume = ball(8, 4);
    const auto path = written(volume);
    KernelFile file(path);
    const std::uint64_t bytes = file.contents().bytes;
    EXPECT_LT(file.bytes_read(), bytes / 100) << "the head";
    EXPECT_GT(file.contents().blocks, 1U);
    static_cast<void>(file.boundary());
    const StreamedKernels far = file.choose_level(view_from(volume, 200));
    EXPECT_GT(far.volume.size(), 0U);
    EXPECT_LT(far.bytes_read, bytes / 100) << "a few nodes";
    const std::uint64_t before = file.bytes_read();
    const StreamedKernels close = file.choose_level(view_from(volume, .5));
    EXPECT_EQ(close.volume.size(), volume.size());
    EXPECT_EQ(file.bytes_read() - before, close.bytes_read);
    EXPECT_EQ(file.choose_level(view_from(volume, .5)).bytes_read, 0U) << "all is kept";

    // Whatever is kept, the kernels are the same; less is read the more is kept.
    std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
    for (const std::uint64_t kept : {std::uint64_t{0}, bytes / 2, 2 * bytes}) {
        KernelFile small(path, kept);
        for (int turn = 0; turn < 3; ++turn) expect_same(small.choose_level(view_from(volume, .5)).volume, close.volume);
        EXPECT_LT(small.bytes_read(), last);
        last = small.bytes_read();
    }
}

TEST_F(KernelFiles, AreTheSameForAnyNumberOfThreads) {
    const RbfVolume volume = ball(8, 4);
    std::vector<std::string> bytes;
    for (const std::size_t threads : {1U, 4U}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        bytes.push_back(read_bytes(written(volume)));
    }
    EXPECT_TRUE(bytes[0] == bytes[1]);
}

TEST_F(KernelFiles, AreNotWrittenOfNothing) {
    expect_error(ErrorCode::InvalidInput, "no kernels", [&] { written(random_points(0, 1)); });
    RbfVolume wrong = random_points(20, 1);
    wrong.frames[3] = {};
    expect_error(ErrorCode::InvalidInput, "point 3", [&] { written(wrong); });
    EXPECT_EQ(file_count(), 0U);
    expect_error(ErrorCode::Io, "none", [&] { write_kernel_file(path("none/a.svk"), random_points(20, 1)); });
    expect_error(ErrorCode::InvalidInput, "write_kernel_file", [&] { write_points(path("a.svk"), random_points(20, 1)); });
}

// Hashes find every byte that is another one, and every length that is not that of the file.
TEST_F(KernelFiles, AnyDamageIsFound) {
    const std::string good = read_bytes(written(random_points(20, 2)));
    for (std::size_t at = 0; at < good.size(); at += at < 1000 ? 1 : 5) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ (1 << at % 8));
        EXPECT_THAT(refusal(bad), testing::HasSubstr("bad.svk")) << at;
    }
    for (std::size_t size = 0; size < good.size(); size += 1 + size / 16) {
        EXPECT_THAT(refusal(good.substr(0, size)), testing::HasSubstr("bad.svk")) << size;
    }
    EXPECT_THAT(refusal(good + "x"), testing::HasSubstr("of"));
    EXPECT_THAT(refusal(good.substr(0, 20)), testing::HasSubstr("cut off"));
    EXPECT_THAT(refusal("ply\n"), testing::HasSubstr("subvol-kernels"));
}

// Files whose hashes are right while their contents are not, as a wrong program would write them.
class WrongContents : public KernelFiles {
protected:
    WrongContents() : volume_(random_points(300, 2)) {
        good_ = read_bytes(written(volume_));
        const SvkFile file(path("a.svk"));
        layout_ = file.layout();
        head_bytes_ = load<std::uint64_t>(good_, 24);
    }

    template <class T>
    static T load(const std::string& bytes, std::size_t at) {
        T value;
        std::memcpy(&value, &bytes[at], sizeof value);
        return value;
    }
    template <class T>
    static std::string with(std::string bytes, std::size_t at, const T& value) {
        std::memcpy(&bytes[at], &value, sizeof value);
        return bytes;
    }

    static std::uint64_t hash_of(std::string_view bytes) {
        detail::ByteHash hash;
        hash.add(bytes);
        return hash.value();
    }

    /// The bytes with hashes that fit them.
    std::string sealed(std::string bytes) const {
        const std::size_t first = 48 + head_bytes_ - 8 * layout_.hashes();
        const auto seal = [&](const detail::SvkExtent& extent, std::size_t hash) {
            const std::uint64_t now = hash_of(std::string_view(bytes).substr(extent.offset, extent.bytes));
            bytes = with(std::move(bytes), first + 8 * hash, now);
        };
        seal(layout_.boundary(), 0);
        seal(layout_.top(), 1);
        for (std::size_t b = 0; b < layout_.blocks(); ++b) {
            for (std::size_t p = 0; p < layout_.parts(); ++p) seal(layout_.part(b, p), layout_.hash_of_part(b, p));
        }
        return with(bytes, 40, hash_of(std::string_view(bytes).substr(48, head_bytes_)));
    }

    RbfVolume volume_;
    std::string good_;
    SvkLayout layout_;
    std::size_t head_bytes_ = 0;
};

TEST_F(WrongContents, AreRefusedInASentence) {
    ASSERT_EQ(sealed(good_), good_);
    const std::size_t numbers = layout_.part(0, layout_.numbers_part()).offset;
    const std::size_t kernels = layout_.part(0, layout_.kernels_part()).offset;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::size_t corner = layout_.boundary().offset + layout_.boundary().bytes - 4;
    const std::vector<std::pair<std::string, const char*>> cases{
        {with(good_, 16, 0x04030201), "order of bytes"},
        {with(good_, 20, 2), "version 2"},
        {with(good_, 24, ~std::uint64_t{0}), "longer than the file"},
        {sealed(with(good_, 48, ~std::uint64_t{0})), "2³²"},
        {sealed(with(good_, 48, std::uint64_t{0})), "no kernels"},
        {sealed(with(good_, 48, std::uint64_t{4000000000})), "do not fit its size"},
        {sealed(with(good_, 64, std::uint64_t{4000000000})), "do not fit its size"},
        {sealed(with(good_, 120, std::uint32_t{4000000000})), "ends too early"},
        {sealed(with(good_, 124, 'x')), "kernel"},
        {sealed(with(good_, numbers, std::uint32_t{300})), "number 300"},
        {sealed(with(good_, numbers, load<std::uint32_t>(good_, numbers + 4))), "twice"},
        {sealed(with(good_, kernels, nan)), "block 0: point 0: a coordinate is not finite"},
        {sealed(with(good_, layout_.boundary().offset, nan)), "boundary is not finite"},
        {sealed(with(good_, corner, std::uint32_t{4})), "no point 4"}};
    for (const auto& [bytes, said] : cases) {
        const std::string message = refusal(bytes);
        EXPECT_THAT(message, testing::HasSubstr(said));
        EXPECT_THAT(message, testing::HasSubstr("bad.svk"));
    }
    const auto file =
        write("top.svk", sealed(with(good_, layout_.top().offset + layout_.top().bytes - 4, static_cast<float>(nan))));
    expect_error(ErrorCode::InvalidInput, "top of the tree",
                 [&] { static_cast<void>(KernelFile(file).choose_level(view_from(volume_, 3))); });
}

// Other bytes with right hashes give an error with a sentence, or other kernels; never a crash, which the sanitizers check.
TEST_F(WrongContents, DoNotCrash) {
    std::mt19937 random(5);
    const char* const more = std::getenv("SUBVOL_MUTATIONS");
    const int trials = more == nullptr ? 300 : std::atoi(more);
    for (int trial = 0; trial < trials; ++trial) {
        std::string bad = good_;
        const std::size_t below = trial % 2 == 0 ? 48 + head_bytes_ : bad.size();
        for (int n = 1 + trial % 3; n > 0; --n) bad[random() % below] = static_cast<char>(random());
        const auto file = write("bad.svk", sealed(bad));
        for (const double distance : {0.0, 1.0, 20.0}) {
            try {
                if (distance == 0) {
                    validate(read_points(file));
                } else {
                    validate(KernelFile(file).choose_level(view_from(volume_, distance), {.pixels = 4}).volume);
                }
            } catch (const Error& error) {
                EXPECT_EQ(detail::printable(error.what()), error.what());
                EXPECT_EQ(error.code(), ErrorCode::InvalidInput) << error.what();
            }
        }
    }
}

}  // namespace kernel_file_test
}  // namespace subvol::test
