// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "lib/temp_folder.h"
#include "picture_methods.h"
#include "subvol/detail/several_errors.h"
#include "subvol/study.h"

namespace subvol {
namespace study_parse_test {

using test::error_of;

/// A study with one part replaced by another.
std::string study_with(const std::string& part, const std::string& instead) {
    std::string text = R"({"name": "s", "inputs": [{"model": "ball", "resolution": 4}],
        "methods": [{"method": "splat", "sheets": [50, 100], "per_edge": [1, 2]}, {"method": "tets"}],
        "cameras": ["iso", {"name": "front", "camera": "-y"}], "size": [64, 48]})";
    const std::size_t place = text.find(part);
    EXPECT_NE(place, std::string::npos) << part;
    return text.replace(place, part.size(), instead);
}

Study parse(const std::string& text) {
    return parse_study(text, "s.json", picture_methods());
}

const std::string kTets = R"({"method": "tets"})";

TEST(StudyFile, IsExpandedIntoTheProductOfItsLists) {
    const Study study = parse(study_with(kTets, kTets));
    ASSERT_EQ(study.cases.size(), 2U * (4 + 1));  // cameras × (2 sheets × 2 per edge + tets)
    const StudyCase& first = study.cases.front();
    EXPECT_EQ(first.text("input"), "ball");
    EXPECT_EQ(first.number("input.resolution"), 4);
    EXPECT_EQ(first.text("view"), "iso");
    EXPECT_EQ(first.whole("width"), 64);
    EXPECT_EQ(first.whole("height"), 48);
    EXPECT_EQ(first.text("kernel"), "compact");  // missing options have their defaults
    std::set<std::string> ids, names;
    for (const StudyCase& of : study.cases) {
        ids.insert(of.id);
        names.insert(of.name);
        EXPECT_EQ(of.id.size(), 16U);
    }
    EXPECT_EQ(ids.size(), study.cases.size());
    EXPECT_EQ(names.size(), study.cases.size());
}

/// A study with tables, plots or demands.
std::string shown_as(const std::string& part) {
    return study_with("\"size\"", part + ", \"size\"");
}

TEST(StudyFile, KeysThatNoCaseHasAreRefusedWithAList) {
    for (const auto& [part, place] : std::vector<std::pair<std::string, std::string>>{
             {R"("tables": [{"rows": ["view", "per_edgee"], "columns": "psnr"}])", "tables[0].rows[1]"},
             {R"("tables": [{"rows": "view", "columns": "mae"}])", "tables[0].columns"},
             {R"("tables": [{"rows": "view", "across": "labell", "values": "psnr"}])", "tables[0].across"},
             {R"("tables": [{"rows": "view", "columns": "psnr", "where": {"label": "spalt"}}])", "tables[0].where.label"},
             {R"("tables": [{"rows": "view", "columns": "psnr", "where": {"labell": "splat"}}])", "tables[0].where.labell"},
             {R"("plots": [{"x": "kernel_count", "y": "psnr", "series": "label"}])", "plots[0].x"},
             {R"("plots": [{"x": "kernels", "y": "flip", "series": "label"}])", "plots[0].y"},
             {R"("plots": [{"x": "kernels", "y": "psnr", "series": "lable"}])", "plots[0].series"},
             {R"("plots": [{"x": "kernels", "y": "psnr", "series": "label", "panels": "mesh"}])", "plots[0].panels"},
             {R"("pictures": {"view": "top"})", "pictures.view"},
             {R"("demands": [{"metric": "ssim", "least": 1}])", "demands[0].metric"}}) {
        const std::string message = error_of([&] { (void)parse(shown_as(part)); });
        EXPECT_NE(message.find("s.json: " + place + ": no case has the "), std::string::npos) << part << message;
        EXPECT_NE(message.find('('), std::string::npos) << "no list: " << message;
    }
    // A key that only other cases have.
    const std::string none = R"("tables": [{"rows": "view", "columns": "kernels", "where": {"label": "tets"}}])";
    EXPECT_NE(error_of([&] { (void)parse(shown_as(none)); }).find("none of the cases is measured by"), std::string::npos);
}

TEST(StudyFile, CasesThatDifferDoNotMeetUnsaid) {
    const std::string table = R"("tables": [{"rows": ["view", "label"], "columns": "psnr")";
    const std::string message = error_of([&] { (void)parse(shown_as(table + "}]")); });
    EXPECT_NE(message.find("they differ in per_edge, sheets"), std::string::npos) << message;
    EXPECT_NO_THROW((void)parse(shown_as(table + R"(, "average": ["per_edge", "sheets"]}])")));
    EXPECT_NO_THROW((void)parse(shown_as(table + R"(, "where": {"label": "tets"}}])")));
    const std::string plot = R"("plots": [{"x": "kernels", "y": "psnr", "series": ["label", "sheets"])";
    EXPECT_NE(error_of([&] { (void)parse(shown_as(plot + "}]")); }).find("cases of one series differ in view"),
              std::string::npos);
    for (const char* said : {R"("panels": "view")", R"("average": "view")", R"("together": "view")"})
        EXPECT_NO_THROW((void)parse(shown_as(plot + ", " + said + "}]"))) << said;
}

TEST(StudyFile, ClosedFormsAreThoseOfModels) {
    const std::string exact = R"({"method": "exact"})";
    EXPECT_NO_THROW((void)parse(study_with(kTets, exact)));
    EXPECT_NO_THROW((void)parse(shown_as(R"("reference": {"method": "exact"})")));
    std::string other = study_with(kTets, exact);
    other.insert(other.find("\"resolution\""), R"("density": "x", )");
    EXPECT_NE(error_of([&] { (void)parse(other); }).find("has no closed form"), std::string::npos);
}

TEST(StudyFile, MethodsWithoutPicturesNeedNoCamera) {
    const Study study = parse(study_with(kTets, R"({"method": "field", "per_edge": [1, 2, 4]}, {"method": "fit"})"));
    EXPECT_EQ(study.cases.size(), 2U * 4 + 3 + 1);
    EXPECT_FALSE(reference_of(study.cases.back()));
    EXPECT_TRUE(reference_of(study.cases.front()));
}

TEST(StudyFile, IdsAreOfWhatIsComputed) {
    const auto ids = [](const std::string& text) {
        std::set<std::string> all;
        for (const StudyCase& of : parse(text).cases) all.insert(of.id);
        return all;
    };
    const auto plain = ids(study_with(kTets, kTets));
    // Explicit or by default, named or not, in any order: the same cases.
    EXPECT_EQ(plain, ids(study_with(kTets, R"({"levels": 1, "label": "rays", "given": {"known": 3}, "method": "tets"})")));
    EXPECT_EQ(plain, ids(study_with(R"("name": "s")", R"("name": "other")")));
    EXPECT_EQ(plain, ids(study_with(R"("model": "ball")", R"("name": "b", "model": "ball")")));
    EXPECT_NE(plain, ids(study_with(kTets, R"({"method": "tets", "levels": 2})")));
    EXPECT_NE(plain, ids(study_with("[64, 48]", "[64, 49]")));
    // A constant from another program (FNV-1a of "subvol case 1\nkernel\t2\tbc\nmethod\t2\terrors\n"): ids are the same on
    // every machine, so folders can be moved between machines.
    EXPECT_EQ(parse(R"({"name": "s", "methods": [{"method": "errors", "kernel": "bc"}]})").cases.front().id,
              "3e79ae9a4e9cb9f9");
}

TEST(StudyFile, CasesReadBack) {
    for (const StudyCase& of : parse(study_with(kTets, kTets)).cases) {
        const StudyCase back = study_case_from_json(to_json(of));
        EXPECT_EQ(back.id, of.id);
        EXPECT_EQ(back.values, of.values);
    }
}

TEST(StudyFile, OneReferenceForAllMethods) {
    std::set<std::string> references;
    for (const StudyCase& of : parse(study_with(kTets, kTets)).cases) references.insert(reference_of(of)->id);
    EXPECT_EQ(references.size(), 2U);  // one per camera
}

/// The places of all mistakes of a study.
std::set<std::string> places_of(const std::string& text) {
    std::set<std::string> places;
    try {
        (void)parse(text);
    } catch (const detail::SeveralErrors& several) {
        for (const Error& one : several.all()) EXPECT_TRUE(places.insert(one.where()).second) << one.what();
    } catch (const Error& one) {
        places.insert(one.where());
    }
    return places;
}

TEST(StudyMistakes, AreFoundTogether) {
    // Parts of a study, right and wrong, and the place of the mistake.
    struct Part {
        std::string right, wrong, place;
    };
    const std::vector<Part> parts{
        {R"("name": "s")", R"("name": "a b")", "name"},
        {R"("timed": true)", R"("timed": 1)", "timed"},
        {R"("size": [64, 48])", R"("size": [64, 4])", "size[1]"},
        {R"("metrics": ["psnr"])", R"("metrics": ["psnr", "psrn"])", "metrics[1]"},
        {R"("reference": {"max_levels": 3})", R"("reference": {"max_levels": 30})", "reference.max_levels"},
        {R"("inputs": [{"model": "ball", "resolution": 4}])", R"("inputs": [{"model": "bal", "resolution": 4}])",
         "inputs[0].model"},
        {R"("cameras": ["iso"])", R"("cameras": ["iso", 7])", "cameras[1]"},
        {R"("transfer_functions": ["turbo"])", R"("transfer_functions": [{"name": "t", "opacity_unit": -1}])",
         "transfer_functions[0].opacity_unit"},
        {R"("methods": [{"method": "splat", "sheets": 50}, {"method": "tets"}])",
         R"("methods": [{"method": "splat", "sheets": 1}, {"method": "tets"}])", "methods[0].sheets"},
        {R"("tables": [{"rows": ["label"], "columns": ["psnr"], "digits": 3}])",
         R"("tables": [{"rows": ["label"], "columns": ["psnr"], "digits": 99}])", "tables[0].digits"},
        {R"("plots": [{"x": "kernels", "y": "psnr", "series": "label"}])",
         R"("plots": [{"x": "kernels", "y": "psnrr", "series": "label"}])", "plots[0].y"},
        {R"("demands": [{"metric": "psnr", "least": 1}])", R"("demands": [{"metric": "psnr", "least": "1"}])",
         "demands[0].least"},
        {R"("seconds": 3)", R"("secons": 3)", "secons"}};
    std::uint32_t random = 7;
    for (int round = 0; round < 200; ++round) {
        std::string text;
        std::set<std::string> wanted;
        for (const Part& part : parts) {
            random = 1664525 * random + 1013904223;  // Numerical Recipes
            const bool wrong = round > 0 && (random >> 16U) % 100 < static_cast<unsigned>(10 + round / 2 % 60);
            text += (text.empty() ? "{" : ", ") + (wrong ? part.wrong : part.right);
            if (wrong) wanted.insert("s.json: " + part.place);
        }
        EXPECT_EQ(places_of(text + "}"), wanted) << text;
    }
}

TEST(StudyMistakes, OfOneObjectAreFoundTogether) {
    const std::string text = R"({"name": "s", "inputs": [{"model": "ball", "resolution": [4, 1], "filed": "T"}],
        "methods": [{"method": "splat", "sheets": [1, 50, 2.5], "per_edges": 2, "backend": "gpu"}],
        "tables": [{"rows": ["label", "sheet"], "columns": ["psrn"], "digit": 3, "where": {"lable": "x"}}]})";
    EXPECT_EQ(places_of(text), (std::set<std::string>{"s.json: inputs[0].resolution[1]", "s.json: inputs[0].filed",
                                                      "s.json: methods[0].sheets[0]", "s.json: methods[0].sheets[2]",
                                                      "s.json: methods[0].per_edges", "s.json: methods[0].backend",
                                                      "s.json: tables[0].digit", "s.json: tables[0].rows[1]",
                                                      "s.json: tables[0].columns", "s.json: tables[0].where.lable"}));
    const std::string message = error_of([&] { (void)parse(text); });
    EXPECT_LE(std::ranges::count(message, '\n'), 10) << message;
    EXPECT_TRUE(message.starts_with("s.json: 10 mistakes:\n  ")) << message;
    EXPECT_TRUE(message.ends_with("\n  and 2 more")) << message;
}

struct Mistake {
    const char* part;
    const char* instead;
    const char* says;

    friend void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.instead; }
};

class StudyMistake : public testing::TestWithParam<Mistake> {};

TEST_P(StudyMistake, IsToldWithItsPlace) {
    const Mistake& mistake = GetParam();
    const std::string message = error_of([&] { (void)parse(study_with(mistake.part, mistake.instead)); });
    EXPECT_NE(message.find(mistake.says), std::string::npos) << message;
    EXPECT_TRUE(message.starts_with("s.json")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(StudyMistakes, LongNamesAreShortened) {
    for (const std::string part : {R"("method": "tets")", R"("camera": "-y")"}) {
        const std::string key = part.substr(0, part.find(':')), letters(5000, 'c');
        const std::string message = error_of([&] { (void)parse(study_with(part, key + ": \"" + letters + "\"")); });
        EXPECT_NE(message.find(std::string(30, 'c')), std::string::npos) << message;
        EXPECT_LT(message.size(), 400U) << message;
    }
}

INSTANTIATE_TEST_SUITE_P(
    Study, StudyMistake,
    testing::Values(
        Mistake{R"({"name")", R"({"nam")", "s.json: nam: this key is unknown: did you mean name? (name, title"},
        Mistake{R"("name": "s")", R"("name": 7)", "s.json: name: must be a string, not a number"},
        Mistake{R"("name": "s")", R"("name": "a/b")", "name: 'a/b' is not a valid name"},
        Mistake{R"({"name": "s", )", "{", "s.json: name: the name is missing"},
        Mistake{R"({"name": "s", )", R"({"name": "s")", "is not JSON"},
        Mistake{R"([{"model": "ball", "resolution": 4}])", "[]", "inputs: the list is empty"},
        Mistake{R"([{"model": "ball", "resolution": 4}])", R"("ball")", "inputs: must be a list, not a string"},
        Mistake{R"({"model": "ball", "resolution": 4})", R"("ball")", "inputs[0]: must be an object, not a string"},
        Mistake{R"("model": "ball")", R"("model": "cat")", "inputs[0].model: 'cat' is unknown: did you mean car? (cell, pawn"},
        Mistake{R"("model": "ball")", R"("file": "no.vtk")", "inputs[0]: a file has no resolution"},
        Mistake{R"("model": "ball", "resolution": 4)", R"("file": "no.vtk")", "inputs[0].file: 'no.vtk' cannot be read"},
        Mistake{R"("model": "ball", )", "", "inputs[0]: an input has either a model or a file"},
        Mistake{R"("model": "ball")", R"("model": "ball", "field": "f", "density": "x")",
                "inputs[0]: an input has either a field or a density"},
        Mistake{R"("resolution": 4)", R"("resolution": 1)", "inputs[0].resolution: 1 is out of range (2 to 512)"},
        Mistake{R"("resolution": 4)", R"("resolution": [4, 2.5])", "inputs[0].resolution[1]: 2.5 is not a whole number"},
        Mistake{R"("resolution": 4)", R"("resolution": 1e300)", "inputs[0].resolution: 1e+300 is out of range"},
        Mistake{R"("resolution": 4)", R"("resolution": "4")", "inputs[0].resolution: must be a number, not a string"},
        Mistake{R"("method": "tets")", R"("method": "magic")", "methods[1].method: there is no method 'magic' (splat, sheets"},
        Mistake{R"("method": "tets")", R"("level": 1)", "methods[1]: the method is missing"},
        Mistake{R"("method": "tets")", R"("method": "tets", "level": 1)", "methods[1].level: this key is unknown"},
        Mistake{"[50, 100]", "[]", "methods[0].sheets: the list is empty"},
        Mistake{"[50, 100]", "[50, [100]]", "methods[0].sheets[1]: must be a number, not a list"},
        Mistake{"[50, 100]", "[50, 1]", "methods[0].sheets[1]: 1 is out of range (2 to 65536)"},
        Mistake{"[50, 100]", "50, \"levels\": 11", "methods[0].levels: 11 is out of range (0 to 10)"},
        Mistake{"[50, 100]", "50, \"device\": 0", "methods[0].device: has no effect with backend='cpu'"},
        Mistake{"[50, 100]", "50, \"scheme\": [\"mcq\", \"cc\"], \"tension\": 0.1",
                "methods[0].tension: has no effect without scheme='mcq'"},
        Mistake{"[50, 100]", "50, \"spacing\": 0.1", "methods[0].per_edge: cannot be given together with spacing"},
        Mistake{R"("method": "tets")", R"("method": "tets", "sheets": 50)", "methods[1].sheets: this key is unknown"},
        Mistake{R"("method": "tets")", R"("method": "pt", "kbuffer": 4)",
                "methods[1].kbuffer: has no effect without order='havs'"},
        Mistake{"[50, 100]", "[50, 50]", "are the same"},
        Mistake{"[50, 100]", "50, \"correction\": \"third\"",
                "methods[0].correction: 'third' is unknown (none, gradient, second, full"},
        Mistake{"[50, 100]", "50, \"visible_only\": 1", "methods[0].visible_only: must be a boolean, not a number"},
        Mistake{"[50, 100]", "50, \"kernel\": \"square\"", "methods[0].kernel: "},
        Mistake{"[50, 100]", "50, \"kernel\": {\"type\": \"gaussian\", \"sigma\": -1}", "methods[0].kernel: "},
        Mistake{"[50, 100]", "50, \"given\": {\"x\": []}", "methods[0].given.x: must be a number or a string, not a list"},
        Mistake{R"({"name": "front", "camera": "-y"})", R"({"name": "front"})", "cameras[1].camera: the camera is missing"},
        Mistake{R"("camera": "-y")", R"("camera": "above")", "cameras[1]: camera 'above': is neither a view nor ten numbers"},
        Mistake{R"({"name": "front", "camera": "-y"})", "3", "cameras[1]: must be a string, not a number"},
        Mistake{"[64, 48]", "[64]", "size: a size is a width and a height"},
        Mistake{"[64, 48]", "[64, 1e9]", "size[1]: 1000000000.0 is out of range"},
        Mistake{"[64, 48]", "64, \"metrics\": [\"beauty\"]", "metrics[0]: 'beauty' is unknown"},
        Mistake{"[64, 48]", "64, \"reference\": {\"tolerance\": 0}", "reference.tolerance: 0 is out of range"},
        Mistake{"[64, 48]", "64, \"reference\": {\"tolerance\": [0.1, 0.2]}", "reference: there is only one reference"},
        Mistake{"[64, 48]", "64, \"transfer_functions\": [\"no.json\"]", "transfer_functions[0]: 'no.json' cannot be read"},
        Mistake{"[64, 48]", "64, \"tables\": [{\"columns\": [\"rmse\"]}]", "tables[0].rows: this key is missing"},
        Mistake{"[64, 48]", "64, \"tables\": [{\"rows\": \"input\", \"values\": \"rmse\"}]", "tables[0].across: "},
        Mistake{"[64, 48]", "64, \"plots\": [{\"x\": \"kernels\", \"y\": \"psnr\"}]", "plots[0].series: this key is missing"},
        Mistake{"[64, 48]", "64, \"demands\": [{\"metric\": \"psnr\"}]", "demands[0]: a demand needs 'least' or 'most'"}));

TEST(StudyFile, TooManyCasesAreRefusedBeforeTheyAreMade) {
    std::string numbers = "1";
    for (int i = 2; i <= 300; ++i) numbers += "," + std::to_string(i);
    const std::string seeds = R"({"method": "field", "seed": [)" + numbers + R"(], "places": [)" + numbers + "]}";
    EXPECT_NE(error_of([&] { (void)parse(study_with(kTets, seeds)); }).find("methods[1].seed: there are too many combinations"),
              std::string::npos);
    // Lists that are short enough alone, but not times the inputs.
    const std::string many = R"("resolution": [)" + numbers.substr(2) + "]";
    std::string text = study_with(R"("resolution": 4)", many);
    text.replace(text.find("[1, 2]"), 6, "[" + numbers.substr(0, numbers.find(",65")) + "]");
    EXPECT_NE(error_of([&] { (void)parse(text); }).find("methods[0]: there are too many cases (at most 10000)"),
              std::string::npos);
}

TEST(StudyFile, DeepNestingIsNoCrash) {
    const std::string deep(200000, '[');
    for (const std::string& text : {deep, deep + std::string(deep.size(), ']')}) {
        EXPECT_NE(error_of([&] { (void)parse(text); }).find("nested too deep"), std::string::npos);
    }
    EXPECT_NE(error_of([&] { (void)parse("[[]]"); }).find("must be an object, not a list"), std::string::npos);
}

class StudyFolder : public test::TempFolder {};

TEST_F(StudyFolder, AChangedMeshIsAnotherCase) {
    const auto id = [&] {
        const auto file =
            write("s.json", R"({"name": "s", "inputs": [{"file": "a.mesh"}], "methods": [{"method": "values"}]})");
        return read_study(file, picture_methods()).cases.front().id;
    };
    write("a.mesh", "one");
    const std::string one = id();
    EXPECT_EQ(one, id());
    write("a.mesh", "two");
    EXPECT_NE(one, id());
}

TEST_F(StudyFolder, FilesThatAreNoneAreRefused) {
    EXPECT_NE(error_of([&] { (void)read_study(path("no.json"), {}); }, ErrorCode::Io).find("no.json"), std::string::npos);
    EXPECT_NE(error_of([&] { (void)read_study(write("big.json", std::string(2 << 20, ' ')), {}); }).find("larger"),
              std::string::npos);
}

}  // namespace study_parse_test
}  // namespace subvol
