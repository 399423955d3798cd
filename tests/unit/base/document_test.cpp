#include "../own_folder.hpp"
#include "sample.hpp"

#include <algorithm>
#include <fstream>
#include <random>

namespace treacle {
namespace {

using Messages = std::vector<std::string>;
constexpr auto small = "parts: [{name: one, box: {}}]\n";

TEST(Yaml, ATabInTheIndentationIsNamed) {
    const auto message = [](const std::string& text) -> std::string {
        try {
            Document::from_text(text, "scene.yaml");
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    };
    for (const std::string text : {"a:\n\tb: 1\n", "a:\n  b: 1\n\tc: 2\n", "a: 1\n\tb: 2\n", "a:\n  b: 1\n \tc: 2\n",
             "a:\n -\tb: 1\n   c: 2\n", "a:\n\t- b: 1\n"}) {
        const auto line =
            std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find('\t')), '\n') + 1;
        EXPECT_TRUE(message(text).starts_with(
            "scene.yaml:" + std::to_string(line) + ": is not YAML: a tab stands in the indentation"))
            << message(text);
    }
    EXPECT_EQ(message("a:\t1\nb: {\n\tc: 2}\nd: 3\t# more\n"), "accepted");
    EXPECT_EQ(message("a: [1\nb: 2\n").find("tab"), std::string::npos);
}

TEST(Document, ADuplicateKeyIsAnErrorAtItsSecondPlace) {
    EXPECT_EQ(problems("width: 1\nparts: []\nwidth: 2\n"),
        (Messages{"scene.yaml:3: the key width stands twice; it is already given at scene.yaml:1; "
                  "remove one of them."}));
    EXPECT_EQ(problems("parts:\n  - box: {}\n    mass: 1\n    mass: 1\n"),
        (Messages{"scene.yaml:4: the key mass stands twice; it is already given at scene.yaml:3; "
                  "remove one of them."}));
}

TEST(Document, AnAliasStandsForItsAnchor) {
    const auto sample = read("parts:\n  - &p {mass: 3, box: {}}\n  - *p\n");
    ASSERT_EQ(sample.parts.size(), 2u);
    EXPECT_EQ(sample.parts[1].mass, 3);
}

TEST(Document, ASyntaxErrorHasItsLine) {
    for (const char* text : {"width: 1\nparts: [", "width: 1\n\tparts: []", "width: 1\nparts: {a", "a: 1\n  b: 2\n",
             "a: \"x\n", "a: *b\n", "a: 'x", "? [", "%YAML 9\na"}) {
        const std::string source = text;
        try {
            document(source);
            ADD_FAILURE() << source;
        } catch (const InputError& error) {
            EXPECT_EQ(error.diagnostics()[0].where.rfind("scene.yaml:", 0), 0u) << error.what();
            EXPECT_EQ(error.diagnostics()[0].problem.rfind("is not YAML", 0), 0u) << error.what();
        }
    }
}

TEST(Document, WhatIsNoSceneIsAnError) {
    EXPECT_EQ(problems(""), (Messages{"scene.yaml:1: the file is empty; a scene is lines of the form `key: value`; "
                                      "start from a file in inputs/."}));
    EXPECT_EQ(problems("- a\n")[0].rfind("scene.yaml:1: is not a block of keys", 0), 0u);
    EXPECT_EQ(problems("just words\n")[0].rfind("scene.yaml:1: is not a block of keys", 0), 0u);
    EXPECT_EQ(problems("a: 1\n---\nb: 1\n")[0].rfind("scene.yaml:3: a second document starts", 0), 0u);
    EXPECT_EQ(problems("width: !!float 1\n")[0].rfind("scene.yaml:1: the tag tag:yaml.org,2002:float", 0), 0u);
    EXPECT_EQ(problems("[a]: 1\n")[0].rfind("scene.yaml:1: a key is not a word", 0), 0u);
    EXPECT_EQ(problems(std::string("a: 1\0", 5))[0].rfind("scene.yaml:1: is not a text file", 0), 0u);
}

TEST(Document, AliasesThatMultiplyOrNestWithoutEndAreErrors) {
    std::string laughs = "a: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
    for (int i = 1; i < 12; ++i) {
        const auto before = "*a" + std::to_string(i - 1);
        laughs += "b" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
        for (int j = 0; j < 10; ++j) laughs += before + " ,";
        laughs += before + " ]\n";
    }
    EXPECT_NE(problems(laughs)[0].find("more than a million values"), std::string::npos);
    EXPECT_NE(problems("a: " + std::string(100, '[') + std::string(100, ']'))[0].find("nested more than 64 deep"),
        std::string::npos);
    EXPECT_NE(problems("a: &a [*a ]\n")[0].find("inside its own anchor"), std::string::npos);
    std::string keys;
    for (int i = 0; i < 1001; ++i) keys += "k" + std::to_string(i) + ": 1\n";
    EXPECT_NE(problems(keys)[0].find("scene.yaml:1001: more than 1000 keys"), std::string::npos);
}

TEST(Document, AFileThatIsNotThereOrAFolderIsAnError) {
    const test::OwnFolder folder;
    EXPECT_THROW(Document::load(folder.path() / "missing.yaml"), InputError);
    EXPECT_THROW(Document::load(folder.path()), InputError);
}

TEST(Document, AFileIsNamedInMessagesAsGiven) {
    const test::OwnFolder folder;
    const auto path = folder.path() / "scene.yaml";
    std::ofstream(path) << "parts: []\nwidth: -1\n";
    Sample sample;
    try {
        parse(Document::load(path), sample);
        ADD_FAILURE();
    } catch (const InputError& error) {
        EXPECT_EQ(error.diagnostics()[0].where, path.string() + ":2");
    }
}

TEST(Set, ReplacesAndMakesValues) {
    const auto sample = read(small, {"width=3 mm", "side.layers=4", "pull=[1, 2, 3]", "title=a=b"});
    EXPECT_EQ(sample.width, 0.003);
    EXPECT_EQ(sample.side.layers, 4);
    EXPECT_EQ(sample.pull, (Vec3{1, 2, 3}));
    EXPECT_EQ(sample.title, "a=b");
}

TEST(Set, FindsItemsByNumberAndName) {
    const std::string text = "parts: [{name: one, box: {}}, {name: two, box: {}}]\n";
    const auto sample = read(text, {"parts.0.mass=2 g", "parts.two.mass=3 g"});
    EXPECT_EQ(sample.parts[0].mass, 0.002);
    EXPECT_EQ(sample.parts[1].mass, 0.003);
}

TEST(Set, ErrorsNameTheOverride) {
    EXPECT_EQ(problems(small, {"width=-3"})[0], "--set width=-3: width = -3 m: must be > 0 and <= 10.");
    EXPECT_EQ(problems(small, {"wdth=3"})[0], "--set wdth=3: wdth is not a known key; did you mean width?");
    EXPECT_EQ(problems(small, {"parts.one.mess=3"})[0],
        "--set parts.one.mess=3: parts.one.mess is not a known key; did you mean mass?");
}

TEST(Set, WhatDoesNotFitIsAnError) {
    EXPECT_EQ(problems(small, {"parts.1.mass=2"})[0],
        "--set parts.1.mass=2: there is no item 1; the list has 1 items, counted from 0.");
    EXPECT_EQ(problems(small, {"parts.onee.mass=2"})[0],
        "--set parts.onee.mass=2: there is no item named onee; the names are one; did you mean one?");
    EXPECT_EQ(problems("side: red\n" + std::string(small), {"side.layers=2"})[0],
        "--set side.layers=2: layers would be a key of \"red\", which is not a block; it is given at "
        "scene.yaml:1; override it as a whole, for instance ={...}.");
    for (const char* assignment : {"width", "=3", "a..b=3", ".a=1", ""}) {
        EXPECT_NE(problems(small, {assignment})[0].find("is not of the form a.b.c=value"), std::string::npos);
    }
    EXPECT_NE(problems(small, {"width=[1"})[0].find("--set width=[1: is not YAML"), std::string::npos);
    EXPECT_EQ(problems(small, {"width="})[0].rfind("--set width=: width has no value", 0), 0u);
}

TEST(Set, SeveralBadOnesAreReportedTogether) {
    EXPECT_EQ(problems(small, {"width=-3", "parts.7.mass=1", "title"}).size(), 3u);
}

// Pieces of YAML put together at random: an InputError or success, nothing else, and soon.
TEST(Document, RandomTextsAreReadOrRejected) {
    const std::vector<std::string> pieces{"width", "side", "parts", "pull", "tags", "name", "box", ": ", ":", "- ", "-",
        "\n", "\n  ", "\n    ", " ", "[", "]", "{", "}", ", ", "&a ", "*a", "!!str ", "!x", "\"", "'", "|\n  ", ">-\n",
        "#", "? ", "<<", "~", "null", "1e999", "-1", ".nan", ".inf", "5 mm", "true", "99999999999999999999", "\t", "%",
        "@", "`", "---\n", "...\n", "\xff", "\xc3\xa4", "\\", "\\x", "0x1", "\r\n", "=", "red"};
    std::mt19937 random(7);
    for (int i = 0; i < 20000; ++i) {
        std::string text = i % 2 == 0 ? "" : small;
        for (auto n = random() % 25; n > 0; --n) text += pieces[random() % pieces.size()];
        try {
            read(text, {text.substr(0, text.find('\n'))});
        } catch (const InputError&) {
        } catch (const std::exception& error) {
            FAIL() << text << "\n: " << error.what();
        }
    }
}

} // namespace
} // namespace treacle
