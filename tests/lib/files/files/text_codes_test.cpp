// SPDX-License-Identifier: Apache-2.0
// Codes of texts and bytes, by the examples of their standards: base64, SHA-256, words of a shell, hashes.
#include "subvol/detail/text_codes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <random>
#include <set>
#include <string>

#include "lib/temp_folder.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/refuse_surface.h"

namespace subvol::detail {
namespace text_codes_test {

using test::error_of;

std::string digits_of(std::string_view bytes) {
    std::string digits;
    for (const char c : bytes) digits += hex_digits(static_cast<unsigned char>(c)).substr(14);
    return digits;
}

TEST(TextCodes, Base64IsThatOfTheStandard) {
    // RFC 4648, section 10
    for (const auto& [bytes, text] : {std::pair{"", ""},
                                      {"f", "Zg=="},
                                      {"fo", "Zm8="},
                                      {"foo", "Zm9v"},
                                      {"foob", "Zm9vYg=="},
                                      {"fooba", "Zm9vYmE="},
                                      {"foobar", "Zm9vYmFy"},
                                      {"\xff\xfe\xfd", "//79"}}) {
        EXPECT_EQ(base64(bytes), text);
    }
}

TEST(TextCodes, Sha256IsThatOfTheStandard) {
    // The examples of NIST for FIPS 180-4, and the ends of blocks as coreutils' sha256sum has them.
    for (const auto& [bytes, digits] :
         {std::pair{std::string(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
          {std::string("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
          {std::string("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
           "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
          {std::string(1'000'000, 'a'), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"},
          {std::string(55, 'a'), "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318"},
          {std::string(64, 'a'), "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb"}}) {
        EXPECT_EQ(digits_of(sha256(bytes)), digits) << bytes.size();
    }
    const std::string policy = html_policy("abc", "");
    EXPECT_NE(policy.find("script-src 'sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0='"), std::string::npos) << policy;
    EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
}

TEST(TextCodes, XmlHasNothingThatEndsATextOrAnAttribute) {
    EXPECT_EQ(xml_escaped("a<b>&\"c\" 'd'"), "a&lt;b&gt;&amp;&quot;c&quot; 'd'");
    EXPECT_EQ(xml_escaped("'", XmlQuotes::Any), "&#39;");
    EXPECT_EQ(xml_escaped("é\n\t"), "é\n\t");
    EXPECT_EQ(xml_escaped(std::string("\0", 1)).find('\0'), std::string::npos);
}

/// What a shell makes of a word.
std::string by_shell(const std::string& word) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> shell(::popen(("printf %s " + word).c_str(), "r"), &::pclose);
    std::string text;
    for (int c = std::fgetc(shell.get()); c != EOF; c = std::fgetc(shell.get())) text += static_cast<char>(c);
    return text;
}

TEST(TextCodes, WordsOfAShellAreTheirTexts) {
    for (const std::string word : {"plain-1.5_a/b.stl", "two words", "it's", "'", "$HOME", "`id`", "a;b", "\\", "\"", "*", "~",
                                   "a\nb", "é", "", "-n", "!x", "a=b"}) {
        EXPECT_EQ(by_shell(shell_word(word)), word) << shell_word(word);
    }
    EXPECT_EQ(shell_word("plain-1.5_a/b.stl"), "plain-1.5_a/b.stl") << "without quotes";
    EXPECT_EQ(command_for_surface("my parts/a b.STL", "--cells 100"),
              "subvol mesh 'my parts/a b.STL' --cells 100 -o 'a b.vtu'");
    EXPECT_TRUE(names_surface("A.STL") && names_surface("b.glb") && names_foreign_surface("c.Step"));
    EXPECT_FALSE(names_surface("stl") || names_surface("a.stl.gz") || names_foreign_surface("c.stl"));
    EXPECT_NE(error_of([] {
                  refuse_surface("a/part.step");
              }).find("a/part.step: is a surface, not a mesh of cells (exported as part.stl"),
              std::string::npos);
}

TEST(TextCodes, HashesDoNotDependOnThePieces) {
    std::mt19937 random(1);
    std::string bytes(1000, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    const std::uint64_t whole = hash_of(bytes);
    for (int k = 0; k < 50; ++k) {
        ByteHash hash;
        for (std::size_t at = 0; at < bytes.size();) {
            const std::size_t length = std::min<std::size_t>(random() % 30, bytes.size() - at);
            hash.add(std::string_view(bytes).substr(at, length));
            at += length;
        }
        EXPECT_EQ(hash.value(), whole);
    }
    // A changed bit, a zero more and another place of the end of a word change the hash.
    std::set<std::uint64_t> hashes{whole, hash_of(bytes + '\0'), hash_of(bytes.substr(1)), hash_of("")};
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        std::string changed = bytes;
        changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ 1 << bit % 8);
        hashes.insert(hash_of(changed));
    }
    EXPECT_EQ(hashes.size(), 8004U);
    ByteHash one, other;
    for (const char* word : {"ab", "c"}) one.add_text(word);
    for (const char* word : {"a", "bc"}) other.add_text(word);
    EXPECT_NE(one.value(), other.value());
    EXPECT_EQ(hex_digits(0xABCDEF), "0000000000abcdef");
}

}  // namespace text_codes_test
}  // namespace subvol::detail
