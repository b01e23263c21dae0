// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/text_codes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "subvol/detail/printable.h"

namespace subvol::detail {

std::string base64(std::string_view bytes) {
    const std::size_t whole = bytes.size() / 3 * 3;
    std::string text((bytes.size() + 2) / 3 * 4, '=');
    const auto byte = [&](std::size_t i) { return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0u; };
    const auto put = [&](std::size_t i, unsigned characters) {
        const unsigned bits = (byte(i) << 16) | (byte(i + 1) << 8) | byte(i + 2);
        for (unsigned k = 0; k < characters; ++k) text[i / 3 * 4 + k] = kBase64Digits[(bits >> (18 - 6 * k)) & 63];
    };
    for (std::size_t i = 0; i < whole; i += 3) put(i, 4);
    if (whole < bytes.size()) put(whole, static_cast<unsigned>(bytes.size() - whole) + 1);
    return text;
}

std::string xml_escaped(std::string_view text, XmlQuotes quotes) {
    std::string result;
    while (!text.empty()) {
        const std::size_t length = std::max<std::size_t>(utf8_length(text), 1);
        const std::string_view character = text.substr(0, length);
        text.remove_prefix(length);
        const char c = character.front();
        if (c == '&') {
            result += "&amp;";
        } else if (c == '<') {
            result += "&lt;";
        } else if (c == '>') {
            result += "&gt;";
        } else if (c == '"') {
            result += "&quot;";
        } else if (c == '\'' && quotes == XmlQuotes::Any) {
            result += "&#39;";
        } else if (c == '\n' || c == '\t' || c == '\r') {
            result += c;
        } else {
            result += printable(character);  // XML cannot hold most controls, even as the numbers of characters
        }
    }
    return result;
}

namespace {

using HashState = std::array<std::uint32_t, 8>;

// The first 32 bits of the fractions of the cube roots of the first 64 primes.
constexpr std::array<std::uint32_t, 64> kRounds{
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5, 0xd807aa98, 0x12835b01,
    0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc,
    0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147,
    0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116, 0x1e376c08,
    0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3, 0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208,
    0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

std::uint32_t byte_of(char c) {
    return static_cast<unsigned char>(c);
}

void add_block(std::string_view block, HashState& state) {
    std::array<std::uint32_t, 64> w{};
    for (std::size_t i = 0; i < 16; ++i) {
        const std::string_view four = block.substr(4 * i, 4);
        w[i] = byte_of(four[0]) << 24 | byte_of(four[1]) << 16 | byte_of(four[2]) << 8 | byte_of(four[3]);
    }
    for (std::size_t i = 16; i < 64; ++i) {
        const std::uint32_t a = w[i - 15], b = w[i - 2];
        w[i] = w[i - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ a >> 3) + w[i - 7] +
               (std::rotr(b, 17) ^ std::rotr(b, 19) ^ b >> 10);
    }
    auto [a, b, c, d, e, f, g, h] = state;
    for (std::size_t i = 0; i < 64; ++i) {
        const std::uint32_t first =
            h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) + ((e & f) ^ (~e & g)) + kRounds[i] + w[i];
        const std::uint32_t second = (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
        h = g;
        g = f;
        f = e;
        e = d + first;
        d = c;
        c = b;
        b = a;
        a = first + second;
    }
    const HashState added{a, b, c, d, e, f, g, h};
    for (std::size_t i = 0; i < 8; ++i) state[i] += added[i];
}

std::string hash_source(std::string_view text) {
    return "'sha256-" + base64(sha256(text)) + "'";
}

}  // namespace

std::string sha256(std::string_view bytes) {
    std::string padded(bytes);
    padded += '\x80';
    while (padded.size() % 64 != 56) padded += '\0';
    for (int shift = 56; shift >= 0; shift -= 8) padded += static_cast<char>(std::uint64_t{8} * bytes.size() >> shift & 255);
    HashState state{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    for (std::size_t at = 0; at < padded.size(); at += 64) add_block(std::string_view(padded).substr(at, 64), state);
    std::string hash;
    for (const std::uint32_t word : state) {
        for (int shift = 24; shift >= 0; shift -= 8) hash += static_cast<char>(word >> shift & 255);
    }
    return hash;
}

std::string html_policy(std::string_view script, std::string_view style) {
    return "<meta HTTP-EQUIV=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; script-src " +
           hash_source(script) + "; style-src " + hash_source(style) + "; base-uri 'none'; form-action 'none'\">\n";
}

}  // namespace subvol::detail
