#include "sample.hpp"

#include <array>

namespace treacle {
namespace {

using Messages = std::vector<std::string>;

std::span<const Renamed> table() {
    static const std::array entries{Renamed{"breadth", "width"}, Renamed{"parts.*.size", "length"},
        Renamed{"flank", "side"}, Renamed{"side.coats", "layers"}, Renamed{"side.colour", "red", "crimson"}};
    return entries;
}

struct Read {
    Sample sample;
    Messages notes;
};

Read read_earlier(const std::string& text, const Messages& overrides = {}) {
    auto source = document(text);
    source.accept(table());
    for (const auto& assignment : overrides) source.set(assignment);
    Read out;
    parse(source, out.sample);
    out.notes = source.notes();
    return out;
}

constexpr auto parts = "parts: [{name: rod, size: 2, box: {}}, {size: 3, box: {}}]\n";

TEST(Renamed, EarlierKeysAreReadAndNotedWithTheirPlaces) {
    const auto [sample, notes] =
        read_earlier(std::string("breadth: 0.5\n") + parts + "flank:\n  coats: 7\n  colour: crimson\n");
    EXPECT_EQ(sample.width, 0.5);
    EXPECT_EQ(sample.parts[0].length, 2);
    EXPECT_EQ(sample.parts[1].length, 3);
    EXPECT_EQ(sample.side.layers, 7);
    EXPECT_EQ(sample.side.colour, Colour::red);
    EXPECT_EQ(notes, (Messages{"scene.yaml:1: breadth is now width", "scene.yaml:2: parts.rod.size is now length",
                         "scene.yaml:2: parts.1.size is now length", "scene.yaml:3: flank is now side",
                         "scene.yaml:4: side.coats is now layers", "scene.yaml:5: side.colour: crimson is now red"}));
}

TEST(Renamed, PresentKeysAreNotNoted) {
    EXPECT_EQ(
        read_earlier("width: 0.5\nparts: [{name: rod, length: 2, box: {}}]\nside: {layers: 7, colour: red}\n").notes,
        Messages{});
}

TEST(Renamed, AKeyByBothNamesIsAnError) {
    try {
        read_earlier("width: 0.5\nparts: []\nbreadth: 0.6\n");
        FAIL() << "accepted";
    } catch (const InputError& error) {
        ASSERT_EQ(error.diagnostics().size(), 1U) << error.what();
        EXPECT_EQ(error.diagnostics()[0].text(),
            "scene.yaml:3: breadth is now width, which is given as well; it is at scene.yaml:1; leave breadth out.");
    }
}

TEST(Renamed, OverridesMayHaveEarlierNamesAndWinOverTheFile) {
    const auto [sample, notes] = read_earlier("width: 0.5\nparts: [{name: rod, length: 2, box: {}}]\n",
        {"breadth=0.75", "parts.rod.size=4", "flank.coats=8", "side={coats: 9}", "side.colour=crimson"});
    EXPECT_EQ(sample.width, 0.75);
    EXPECT_EQ(sample.parts[0].length, 4);
    EXPECT_EQ(sample.side.layers, 9);
    EXPECT_EQ(notes,
        (Messages{"--set breadth=0.75: breadth is now width",
            "--set parts.rod.size=4: parts.rod.size is now parts.rod.length",
            "--set flank.coats=8: flank.coats is now side.layers", "--set side={coats: 9}: side.coats is now layers",
            "--set side.colour=crimson: side.colour: crimson is now red"}));
}

TEST(Renamed, PathsTakeThePresentNames) {
    EXPECT_EQ(present_path("flank.coats", table()), "side.layers");
    EXPECT_EQ(present_path("parts.3.size", table()), "parts.3.length");
    EXPECT_EQ(present_path("size", table()), "size");
}

} // namespace
} // namespace treacle
