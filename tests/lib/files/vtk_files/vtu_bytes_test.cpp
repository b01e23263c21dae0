// SPDX-License-Identifier: Apache-2.0
// Bytes in base64 and compressed blocks, by the encoders of the libraries.
#include "subvol/detail/vtu_bytes.h"

#include <gtest/gtest.h>
#include <lz4.h>
#include <zlib.h>

#include <algorithm>
#include <random>

#include "subvol/detail/text_codes.h"

namespace subvol::detail {
namespace vtu_bytes_test {

std::string random_bytes(std::size_t count, unsigned seed, int most = 255) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> byte(0, most);
    std::string bytes(count, '\0');
    for (char& c : bytes) c = static_cast<char>(byte(random));
    return bytes;
}

TEST(ByteSources, DecodeTheExamplesOfTheStandard) {
    // RFC 4648, section 10
    for (const auto& [text, bytes] : {std::pair{"Zg==", "f"},
                                      {"Zm8=", "fo"},
                                      {"Zm9v", "foo"},
                                      {"Zm9vYg==", "foob"},
                                      {"Zm9vYmE=", "fooba"},
                                      {"Zm9vYmFy", "foobar"},
                                      {"\n Zm9v\tYm\r\nFy ", "foobar"},
                                      {"Zm8=bw==YmFy", "foobar"}}) {
        const std::string expected = bytes;
        EXPECT_EQ(ByteSource(text, true).take(expected.size()), expected) << text;
        EXPECT_GE(ByteSource(text, true).left(), expected.size()) << text;
        EXPECT_EQ(ByteSource(text, true).take(expected.size() + 1), std::nullopt) << text;
    }
    for (const char* damaged : {"Zm9", "Z===", "Zg=v", "Zm-v", "Zm9\xC3", "===="}) {
        EXPECT_EQ(ByteSource(damaged, true).take(3), std::nullopt) << damaged;
    }
}

TEST(ByteSources, GiveTheSameBytesInPartsOfAnySize) {
    const std::string bytes = random_bytes(3000, 1);
    std::mt19937 random(2);
    for (const bool encoded : {true, false}) {
        const std::string text = encoded ? base64(bytes.substr(0, 1000)) + "\n" + base64(bytes.substr(1000)) : bytes;
        ByteSource source(text, encoded);
        std::string taken;
        while (taken.size() < bytes.size()) {
            EXPECT_GE(source.left(), bytes.size() - taken.size());
            const auto part = source.take(std::min<std::size_t>(random() % 40, bytes.size() - taken.size()));
            ASSERT_TRUE(part);
            taken += *part;
        }
        EXPECT_TRUE(taken == bytes);
        EXPECT_EQ(source.take(1), std::nullopt);
        EXPECT_EQ(source.take(0), "");
    }
}

std::string zipped(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    EXPECT_EQ(compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                        bytes.size(), Z_BEST_COMPRESSION),
              Z_OK);
    packed.resize(size);
    return packed;
}

std::string packed_by_lz4(const std::string& bytes) {
    const auto size = static_cast<int>(bytes.size());
    std::string packed(static_cast<std::size_t>(LZ4_compressBound(size)), '\0');
    packed.resize(
        static_cast<std::size_t>(LZ4_compress_default(bytes.data(), packed.data(), size, static_cast<int>(packed.size()))));
    return packed;
}

std::string packed(Compressor compressor, const std::string& bytes) {
    return compressor == Compressor::Zlib  ? zipped(bytes)
           : compressor == Compressor::Lz4 ? packed_by_lz4(bytes)
                                           : compressed_numbers(bytes);
}

constexpr std::array kCompressors{Compressor::Zlib, Compressor::Lzma, Compressor::Lz4};

TEST(CompressedBlocks, AreDecompressedToTheirSizeAlone) {
    for (const Compressor compressor : kCompressors) {
        for (const std::string& bytes : {std::string("a"), random_bytes(10'000, 3), random_bytes(10'000, 4, 3)}) {
            const std::string block = packed(compressor, bytes);
            const auto which = static_cast<int>(compressor);
            EXPECT_TRUE(decompressed(compressor, block, bytes.size()) == bytes) << which;
            EXPECT_FALSE(decompressed(compressor, block, bytes.size() + 1)) << which;
            EXPECT_FALSE(decompressed(compressor, block, bytes.size() - 1)) << which << ", " << bytes.size();
            EXPECT_FALSE(decompressed(compressor, std::string_view(block).substr(0, block.size() - 1), bytes.size())) << which;
        }
    }
}

// The most that a block can stand for is not less than what a library packs into it, and a larger size makes no memory be
// taken.
TEST(CompressedBlocks, StandForNoMoreThanTheyCan) {
    const std::string zeros(std::size_t{1} << 24, '\0');
    for (const Compressor compressor : kCompressors) {
        const std::string block = packed(compressor, zeros);
        EXPECT_LT(block.size(), zeros.size() / 200);
        EXPECT_GE(largest_size(compressor, block.size()), zeros.size());
        EXPECT_TRUE(decompressed(compressor, block, zeros.size()) == zeros);
        EXPECT_FALSE(decompressed(compressor, block, std::size_t{1} << 60));
    }
}

TEST(CompressedBlocks, HaveTheNamesOfVtk) {
    EXPECT_EQ(compressor_named(""), Compressor::None);
    EXPECT_EQ(compressor_named("vtkZLibDataCompressor"), Compressor::Zlib);
    EXPECT_EQ(compressor_named("vtkLZMADataCompressor"), Compressor::Lzma);
    EXPECT_EQ(compressor_named("vtkLZ4DataCompressor"), Compressor::Lz4);
    EXPECT_EQ(compressor_named("vtkZfpDataCompressor"), std::nullopt);
}

std::optional<std::string> read_all(const std::string& packed) {
    LzmaReader reader(packed);
    std::string bytes;
    for (;;) {
        const auto part = reader.next();
        if (!part) return std::nullopt;
        if (part->empty()) return bytes;
        bytes += *part;
    }
}

TEST(CompressedNumbers, ComeBackInParts) {
    const std::string bytes = random_bytes(300'000, 5, 4);
    for (const Effort effort : {Effort::Least, Effort::Most}) {
        const std::string packed = compressed_numbers(bytes, effort);
        EXPECT_LT(packed.size(), bytes.size() / 2) << "numbers of five kinds need less than three bits";
        EXPECT_TRUE(read_all(packed) == bytes);
        EXPECT_FALSE(read_all(packed + "x")) << "more after the end";
        for (const std::size_t place : {std::size_t{20}, packed.size() / 2, packed.size() - 1}) {
            std::string damaged = packed;
            damaged[place] = static_cast<char>(damaged[place] ^ 1);
            EXPECT_FALSE(read_all(damaged)) << place;
        }
        for (const std::size_t missing : {1U, 2U, 7U, 12U, 20U, 28U, 40U}) {
            EXPECT_FALSE(read_all(packed.substr(0, packed.size() - missing))) << missing << " bytes are missing at the end";
        }
    }
    EXPECT_EQ(read_all(compressed_numbers("")), "");
}

}  // namespace vtu_bytes_test
}  // namespace subvol::detail
