#include "sample.hpp"

#include <random>

namespace treacle {
namespace {

TEST(Effective, ParsesToTheIdenticalStruct) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform(0.001, 9);
    for (int i = 0; i < 100; ++i) {
        Sample sample;
        sample.hollow = true;
        sample.width = uniform(random);
        sample.title = "quotes \" \\ \n\t: # ' \x01 \xc3\xa4 null";
        sample.tags = {"c", "a"};
        sample.pull = {uniform(random) * 1e-200, -uniform(random), uniform(random) * 1e200};
        sample.side = {Colour::green, 5};
        sample.parts.resize(2);
        sample.parts[0].name = "one";
        sample.parts[0].corner = {uniform(random), -0.0, 1.0 / 3};
        sample.parts[1].disc = 1;
        sample.parts[1].radius = uniform(random);
        sample.parts[1].mass = uniform(random) * 1e-9;
        sample.spare = {{Colour::red, 7}};
        const auto text = effective(sample);
        const auto again = read(text);
        EXPECT_EQ(again.width, sample.width);
        EXPECT_EQ(again.title, sample.title);
        EXPECT_EQ(again.tags, sample.tags);
        EXPECT_EQ(again.pull, sample.pull);
        EXPECT_EQ(again.side.colour, sample.side.colour);
        EXPECT_EQ(again.parts[0].corner, sample.parts[0].corner);
        EXPECT_EQ(again.parts[1].radius, sample.parts[1].radius);
        EXPECT_EQ(again.parts[1].mass, sample.parts[1].mass);
        EXPECT_EQ(again.spare.at(0).layers, 7);
        EXPECT_EQ(effective(again), text);
    }
}

TEST(Effective, HasEveryKeyWithItsUnit) {
    EXPECT_EQ(effective(read("parts: [{name: one, disc: {radius: 5 mm}}]\n")), "width: 0.25 m\n"
                                                                               "hollow: false\n"
                                                                               "title: \"plain\"\n"
                                                                               "tags: [\"a\", \"b\"]\n"
                                                                               "pull: [0 m/s2, 0 m/s2, -9.81 m/s2]\n"
                                                                               "axis: [0, 0, 1]\n"
                                                                               "side:\n"
                                                                               "  colour: red\n"
                                                                               "  layers: 2\n"
                                                                               "parts:\n"
                                                                               "  - name: \"one\"\n"
                                                                               "    length: 0.5 m\n"
                                                                               "    mass: 1 kg\n"
                                                                               "    disc:\n"
                                                                               "      radius: 0.005 m\n");
}

TEST(Manual, ListsEveryKeyWithTypeRangeDefaultAndSentence) {
    const auto text = manual(Sample{});
    EXPECT_EQ(text.rfind("width: number [m], > 0 and <= 10, default 0.25 m\n    The width.\n", 0), 0u);
    for (const char* line : {"hollow: true or false, default false\n", "title: text, default \"plain\"\n",
             "tags: list of a, b, c, default [a, b]\n", "pull: 3 numbers [m/s2], default [0, 0, -9.81]\n",
             "side: block, or a word for its colour\n", "  colour: one of red, green, default red\n",
             "  layers: whole number, in [1, 9], default 2\n", "parts: list of blocks, required\n",
             "  disc: block, one of these is given\n", "    radius: number [m], > 0, default 1 m\n"}) {
        EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
    }
}

TEST(Manual, OfOneKeyHasItsUnitsAndReason) {
    EXPECT_EQ(manual(Sample{}, "parts.length"), "parts.length: number [m], > 0, default 0.5 m\n"
                                                "    Its length.\n"
                                                "    Plain numbers are in m; with a unit: m, cm, mm, um, km.\n"
                                                "    lengths are positive; write 5 mm.\n");
    EXPECT_EQ(manual(Sample{}, "parts.0.length"), "parts.0.length: number [m], > 0, default 0.5 m\n"
                                                  "    Its length.\n"
                                                  "    Plain numbers are in m; with a unit: m, cm, mm, um, km.\n"
                                                  "    lengths are positive; write 5 mm.\n");
}

TEST(Manual, OfAnUnknownKeySuggestsOne) {
    const auto message = [](const std::string& key) -> std::string {
        try {
            return manual(Sample{}, key);
        } catch (const InputError& error) {
            return error.what();
        }
    };
    EXPECT_EQ(message("parts.lenght"), "parts.lenght is not a known key; did you mean parts.length?");
    EXPECT_EQ(message("radius"), "radius is not a known key; did you mean parts.disc.radius?");
    EXPECT_EQ(message("qqqq"), "qqqq is not a known key; `treacle schema` lists all keys.");
    EXPECT_EQ(message("width."), "width. is not a known key; did you mean width?");
}

TEST(JsonSchema, HasTypesRangesAndRequiredKeys) {
    const auto text = json_schema(Sample{});
    std::string dense;
    for (const char c : text) {
        if (c != ' ' && c != '\n') dense += c;
    }
    for (const char* part : {"\"additionalProperties\":false", "\"required\":[\"parts\"]",
             "\"exclusiveMinimum\":0.0,\"maximum\":10.0", "{\"enum\":[\"red\",\"green\"]",
             "\"oneOf\":[{\"required\":[\"box\"]},{\"required\":[\"disc\"]}]", "\"minimum\":1.0,\"maximum\":9.0",
             "\"minItems\":2,\"maxItems\":3", "\"default\":\"0.25m\"", "\"description\":\"Thewidth.[m]\""}) {
        EXPECT_NE(dense.find(part), std::string::npos) << part << "\n" << text;
    }
}

} // namespace
} // namespace treacle
