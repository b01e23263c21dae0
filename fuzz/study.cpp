// SPDX-License-Identifier: Apache-2.0
// Studies; the methods are two with an option each.

#include "subvol/study.h"
#include "input.h"
#include "subvol/option.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    static double step = 1;
    static int samples = 1;
    static const std::vector<PictureMethod> methods{{"splat", {Option("samples", samples).between(1, 64)}},
                                                    {"dense", {Option("step", step).positive()}}};
    return fuzz::run([&] {
        const Study study = parse_study(std::string(fuzz::text_of(data, size)), "study", methods);
        fuzz::check(study.cases.size() <= kMaxStudyCases);
    });
}
