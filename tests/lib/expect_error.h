// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "subvol/error.h"

namespace subvol::test {

/// Expects that a call throws Error with a code, and that its message contains a part that tells the user what is wrong.
template <class Call>
void expect_error(ErrorCode code, const std::string& part, const Call& call) {
    try {
        call();
        ADD_FAILURE() << "no error; expected one that says '" << part << "'";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), code) << e.what();
        EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
}

}  // namespace subvol::test
