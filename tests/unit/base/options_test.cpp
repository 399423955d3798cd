#include "sample.hpp"

namespace treacle {
namespace {

using Messages = std::vector<std::string>;
constexpr auto least = "parts: []\n";

std::string first(const std::string& text) {
    const auto found = problems(text);
    return found.empty() ? "no problem" : found[0];
}

TEST(Parse, ReadsEveryKindOfValue) {
    const auto sample = read("width: 30 cm\n"
                             "hollow: true\n"
                             "title: \"some: words\"\n"
                             "tags: [c]\n"
                             "pull: [0, 1 cm/s2, -2]\n"
                             "axis: [1, 1, 0]\n"
                             "side: {colour: green, layers: 3}\n"
                             "parts:\n"
                             "  - {name: one, disc: {radius: 2}}\n"
                             "  - mass: 5 g\n"
                             "    box: {corner: [1, 2, 3]}\n"
                             "spare: {layers: 9}\n");
    EXPECT_EQ(sample.width, 0.3);
    EXPECT_TRUE(sample.hollow);
    EXPECT_EQ(sample.title, "some: words");
    EXPECT_EQ(sample.tags, (std::vector<std::string>{"c"}));
    EXPECT_EQ(sample.pull, (Vec3{0, 0.01, -2}));
    EXPECT_EQ(sample.axis, (Vec3{1, 1, 0}));
    EXPECT_EQ(sample.side.colour, Colour::green);
    EXPECT_EQ(sample.side.layers, 3);
    ASSERT_EQ(sample.parts.size(), 2u);
    EXPECT_EQ(sample.parts[0].disc, 1);
    EXPECT_EQ(sample.parts[0].radius, 2);
    EXPECT_EQ(sample.parts[1].mass, 0.005);
    EXPECT_EQ(sample.parts[1].corner, (Vec3{1, 2, 3}));
    ASSERT_EQ(sample.spare.size(), 1u);
    EXPECT_EQ(sample.spare[0].layers, 9);
}

TEST(Parse, WhatIsNotGivenKeepsItsDefault) {
    const auto sample = read(least);
    EXPECT_EQ(sample.width, 0.25);
    EXPECT_EQ(sample.tags, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(sample.side.layers, 2);
    EXPECT_TRUE(sample.spare.empty());
}

TEST(Parse, AWordMayStandForABlockWithAShorthand) {
    EXPECT_EQ(read("side: green\n" + std::string(least)).side.colour, Colour::green);
    EXPECT_EQ(first("side: gren\n" + std::string(least)),
        "scene.yaml:1: side.colour = gren: must be one of red, green; did you mean green?");
}

TEST(Parse, AnUnknownKeyComesWithTheNearestKnownOne) {
    EXPECT_EQ(first("parts: []\nwidht: 3\n"), "scene.yaml:2: widht is not a known key; did you mean width?");
    EXPECT_EQ(first("parts: []\nside:\n  colors: red\n"),
        "scene.yaml:3: side.colors is not a known key; did you mean colour?");
    EXPECT_EQ(first("parts: []\nside:\n  xyzzy: red\n"),
        "scene.yaml:3: side.xyzzy is not a known key; known here: colour, layers.");
}

TEST(Parse, AValueOfTheWrongTypeIsAnError) {
    const std::string rest = "\nparts: []\n";
    EXPECT_EQ(first("width: [1]" + rest), "scene.yaml:1: width = [1]: must be a number.");
    EXPECT_EQ(first("width: true" + rest).rfind("scene.yaml:1: width = true: must be a length [m]", 0), 0u);
    EXPECT_EQ(first("hollow: yes" + rest), "scene.yaml:1: hollow = yes: must be true or false.");
    EXPECT_EQ(first("hollow: [true]" + rest), "scene.yaml:1: hollow = [true]: must be true or false.");
    EXPECT_EQ(first("title: {a: b}" + rest), "scene.yaml:1: title = {...}: must be a text.");
    EXPECT_EQ(first("tags: a" + rest), "scene.yaml:1: tags = a: must be a list of words.");
    EXPECT_EQ(first("tags: [[a]]" + rest), "scene.yaml:1: tags.0 = [a]: must be a word.");
    EXPECT_EQ(first("pull: 5" + rest), "scene.yaml:1: pull = 5: must be a list of 3 numbers.");
    EXPECT_EQ(first("pull: [1, [2], 3]" + rest), "scene.yaml:1: pull.1 = [2]: must be a number.");
    EXPECT_EQ(first("side: [1]" + rest), "scene.yaml:1: side = [1]: must be a block of keys.");
    EXPECT_EQ(first("spare: red" + rest), "scene.yaml:1: spare = red: must be a block of keys.");
    EXPECT_EQ(first("side: {colour: [red]}" + rest), "scene.yaml:1: side.colour = [red]: must be one of red, green.");
    EXPECT_EQ(first("parts: 5\n"), "scene.yaml:1: parts = 5: must be a list, each item starting with \"- \".");
    EXPECT_EQ(first("parts: [5]\n"), "scene.yaml:1: parts.0 = 5: must be a block of keys.");
}

TEST(Parse, AWholeNumberIsWholeAndFits) {
    const auto layers = [](const std::string& value) { return first("parts: []\nside: {layers: " + value + "}\n"); };
    EXPECT_EQ(layers("2.5"), "scene.yaml:2: side.layers = 2.5: must be a whole number.");
    EXPECT_EQ(layers("1e1"), "scene.yaml:2: side.layers = 1e1: must be a whole number.");
    EXPECT_EQ(layers("10"), "scene.yaml:2: side.layers = 10: must be in [1, 9].");
    EXPECT_EQ(layers("0"), "scene.yaml:2: side.layers = 0: must be in [1, 9].");
    EXPECT_EQ(
        layers("99999999999999999999").rfind("scene.yaml:2: side.layers = 99999999999999999999: is too large", 0), 0u);
}

TEST(Parse, ANumberOutOfRangeIsAnErrorWithItsReason) {
    EXPECT_EQ(first("parts: []\nwidth: 0\n"), "scene.yaml:2: width = 0 m: must be > 0 and <= 10.");
    EXPECT_EQ(first("parts: []\nwidth: 20 m\n"), "scene.yaml:2: width = 20 m: must be > 0 and <= 10.");
    EXPECT_EQ(first("parts:\n - name: one\n   length: -3 mm\n   box: {}\n"),
        "scene.yaml:3: parts.one.length = -3 mm: must be > 0; lengths are positive; write 5 mm.");
}

TEST(Parse, AWrongUnitIsAnErrorWithTheAcceptedOnes) {
    EXPECT_EQ(first("parts: []\nwidth: 5 Pa.s\n"),
        "scene.yaml:2: width = 5 Pa.s: must be a length [m]; \"Pa.s\" is the unit of a dynamic viscosity; "
        "accepted units: m, cm, mm, um, km.");
    EXPECT_EQ(
        first("parts: []\npull: [1, 2, 3 kg]\n").rfind("scene.yaml:2: pull.2 = 3 kg: must be an acceleration", 0), 0u);
}

TEST(Parse, NonFiniteNumbersAreErrors) {
    for (const char* value : {".nan", ".inf", "-.inf", "1e999", "nan"}) {
        EXPECT_NE(first("parts: []\nwidth: " + std::string(value) + "\n").find("must be finite"), std::string::npos);
    }
}

TEST(Parse, AVectorHasThreeNumbersInSpace) {
    EXPECT_EQ(
        first("parts: []\npull: [1, 2]\n"), "scene.yaml:2: pull = [1, 2]: must be a list of 3 numbers; it has 2.");
    EXPECT_EQ(first("parts: []\npull: [1, 2, 3, 4]\n"),
        "scene.yaml:2: pull = [1, 2, 3, 4]: must be a list of 3 numbers; it has 4.");
    EXPECT_EQ(first("parts: []\naxis: [0, 0, 0]\n").rfind("scene.yaml:2: axis = [0, 0, 0]: must not be zero", 0), 0u);
}

TEST(Parse, AKeyWithoutAValueIsAnErrorAtItsLine) {
    EXPECT_EQ(first("width:\nparts: []\n"),
        "scene.yaml:1: width has no value; it must be a number; give it one or remove the key.");
    EXPECT_EQ(first("parts: []\nside:\n\n\n").rfind("scene.yaml:2: side has no value", 0), 0u);
    EXPECT_EQ(first("parts: []\ntitle: ~\n").rfind("scene.yaml:2: title has no value", 0), 0u);
    EXPECT_EQ(read("parts: []\ntitle: \"\"\n").title, "");
}

TEST(Parse, AMissingRequiredKeyIsAnErrorAtItsBlock) {
    EXPECT_EQ(first("width: 1\n"), "scene.yaml:1: parts is missing; The parts; see `treacle schema parts`.");
}

TEST(Parse, ExactlyOneOfTheAlternativesIsGiven) {
    EXPECT_EQ(
        first("parts:\n  - mass: 1\n"), "scene.yaml:2: parts.0 has no box, disc; exactly one of these keys is given.");
    EXPECT_EQ(first("parts:\n  - box: {}\n    disc: {}\n"),
        "scene.yaml:2: parts.0 has box and disc; exactly one of these keys is given.");
    EXPECT_EQ(first("parts:\n  - box: {corne: [0, 0, 0]}\n"),
        "scene.yaml:2: parts.0.box.corne is not a known key; did you mean corner?");
}

TEST(Parse, AWordThatIsNotAllowedIsAnError) {
    EXPECT_EQ(first("parts: []\ntags: [a, d]\n"), "scene.yaml:2: tags.1 = d: must be one of a, b, c.");
}

TEST(Parse, ChecksSeeSeveralKeys) {
    EXPECT_EQ(first("parts: []\nwidth: 6\nhollow: false\n"),
        "scene.yaml:3: hollow = false: must be true for a wide one; it would be heavy; write true.");
    EXPECT_EQ(first("parts: []\nwidth: 6\n"),
        "scene.yaml:1: hollow: must be true for a wide one; it would be heavy; write true.");
    EXPECT_EQ(read("parts: []\nwidth: 6\nhollow: true\n").width, 6);
}

TEST(Parse, ChecksAreSkippedWhenAValueCouldNotBeRead) {
    EXPECT_EQ(problems("parts: []\nwidth: 6\nhollow: perhaps\n").size(), 1u);
}

TEST(Parse, AllProblemsComeAtOnceAndNothingIsChanged) {
    const std::string text = "width: -1\nhollow: maybe\nside: {colour: blue}\nparts: [{mas: 1, box: {}}]\nfoo: 1\n"
                             "title: a\ntitle: b\n";
    EXPECT_EQ(problems(text).size(), 6u);
    Sample sample;
    sample.title = "kept";
    EXPECT_THROW(parse(document(text), sample), InputError);
    EXPECT_EQ(sample.title, "kept");
}

struct Plane {
    Vec3 point{0, 0, 0};
    Vec3 axis{0, 0, 1};
    void declare(Declaration& d) {
        d.allow_2d_vectors();
        d.vec3("point", point, unit::length, "A point.");
        d.direction("axis", axis, "An axis.");
    }
};

std::string plane_problem(const std::string& text) {
    Plane plane;
    try {
        parse(document(text), plane);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(Parse, PlaneVectorsHaveTwoNumbers) {
    Plane plane;
    parse(document("point: [1, 2]\naxis: [0, 0, 2]\n"), plane);
    EXPECT_EQ(plane.point, (Vec3{1, 2, 0}));
    EXPECT_EQ(plane.axis, (Vec3{0, 0, 2}));
    EXPECT_EQ(effective(plane), "point: [1 m, 2 m]\naxis: [0, 0, 2]\n");
    EXPECT_EQ(plane_problem("point: [1, 2, 0]\n"), "");
    EXPECT_EQ(plane_problem("point: [1, 2, 3]\n").rfind("scene.yaml:1: point = [1, 2, 3]: must have no third", 0), 0u);
    EXPECT_EQ(plane_problem("point: [1]\n"), "scene.yaml:1: point = [1]: must be a list of 2 numbers; it has 1.");
}

} // namespace
} // namespace treacle
